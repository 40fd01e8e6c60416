// Tests what decoders of BC6H, BC1 and BC4 make of known blocks, and how much of light and materials encoders keep.
#include "block/bc1_encode.h"
#include "block/bc4_encode.h"
#include "block/bc6h_encode.h"
#include "block/reflectance.h"
#include "core/sampling.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { TEXELS = 16, ALL = 0xFFFF };

static float random_unit(uint32_t i, uint32_t which) { return olx_unit_float(olx_hash3(i, which, 91)); }

// --- Decoding BC6H

// A block, and the half floats of two of its texels.
typedef struct known_block {
  olx_bc6h_block block;
  struct {
    uint32_t texel, half[3];
  } known[2];
} known_block;

// One block of random bits for each mode, and the texels that a bit by bit reading of the format's definition gives.
static const known_block KNOWN[] = {
    // clang-format off
    {{{0x9F767C44, 0x4164D839, 0xBDE5C099, 0x5BC8FBBC}},
     {{0, {0x788C, 0x5ABD, 0x1929}}, {13, {0x7951, 0x5AF8, 0x19E0}}}},
    {{{0x77330BD9, 0xC6A53877, 0xF17FD374, 0x3FC1EA36}},
     {{1, {0x425C, 0x57AC, 0x31E4}}, {14, {0x425C, 0x57AC, 0x31E4}}}},
    {{{0x28276882, 0x1CFB10F6, 0x5F2DD97F, 0x7814E8A2}},
     {{6, {0x3222, 0x4283, 0x6D77}}, {7, {0x325D, 0x4263, 0x6D5B}}}},
    {{{0x8B33E966, 0x1A1AFE87, 0x92EDCF45, 0x3FD42359}},
     {{0, {0x7112, 0x2509, 0x788F}}, {11, {0x7104, 0x2561, 0x7895}}}},
    {{{0x377B9AAA, 0x687C966C, 0x478C281D, 0x2E9C82B1}},
     {{2, {0x0CBE, 0x2E3A, 0x1FB2}}, {12, {0x0CD2, 0x2E20, 0x201A}}}},
    {{{0xC30D8B6E, 0xCC11D357, 0x126A1E48, 0x238642EA}},
     {{2, {0x178F, 0x089E, 0x737E}}, {14, {0x1602, 0x03FC, 0x74AA}}}},
    {{{0x21DA8972, 0x00745130, 0xF8EB18B9, 0xDF1461AA}},
     {{0, {0x2107, 0x582F, 0x07FE}}, {3, {0x2617, 0x5A33, 0x0B06}}}},
    {{{0xC60A3CB6, 0x3729C619, 0xF5CAE3BF, 0xFB7FF337}},
     {{5, {0x709E, 0x10B6, 0x74FA}}, {13, {0x6FC6, 0x0CCA, 0x710E}}}},
    {{{0x2A9EBA1A, 0x4A0FE75D, 0x504B74BA, 0xF6236BF2}},
     {{6, {0x66E6, 0x1A33, 0x49D8}}, {8, {0x673D, 0x1D95, 0x4C80}}}},
    {{{0xE049549E, 0xAD864C44, 0xA02FDAA1, 0x346C6E2B}},
     {{5, {0x1078, 0x61D8, 0x3548}}, {11, {0x1819, 0x5920, 0x3B00}}}},
    {{{0x3266AA23, 0xF770C226, 0xF7108E96, 0xE4CC4132}},
     {{4, {0x28DE, 0x18E2, 0x6016}}, {12, {0x0EE9, 0x5C24, 0x433C}}}},
    {{{0x0585A007, 0x5C76F18A, 0x6A375391, 0x2A7C1880}},
     {{4, {0x4EEB, 0x6B1F, 0x52DF}}, {15, {0x4DF2, 0x6C93, 0x4F37}}}},
    {{{0x10ACFF0B, 0x54F46A69, 0x4D25DEB3, 0xD1412584}},
     {{0, {0x5CEB, 0x6748, 0x22F7}}, {9, {0x5E03, 0x65F6, 0x21BB}}}},
    {{{0xAD8D194F, 0xB52A43AB, 0x568068B9, 0x10E6D8E6}},
     {{5, {0x6CE3, 0x52E1, 0x3532}}, {9, {0x6CE4, 0x52E1, 0x3530}}}},
    // clang-format on
};

static void assert_halves(olx_vec3 found, const uint32_t half[3]) {
  assert_true(found.x == olx_half_unpack((uint16_t)half[0]));
  assert_true(found.y == olx_half_unpack((uint16_t)half[1]));
  assert_true(found.z == olx_half_unpack((uint16_t)half[2]));
}

static void all_modes_decode_as_defined(void **state) {
  (void)state;
  assert_int_equal(sizeof KNOWN / sizeof KNOWN[0], 14);
  for (uint32_t i = 0; i < 14; i++) {
    for (uint32_t k = 0; k < 2; k++) {
      assert_halves(olx_bc6h_texel(&KNOWN[i].block, KNOWN[i].known[k].texel), KNOWN[i].known[k].half);
    }
  }
}

// Decodes a block by hand, in the mode with two ends of ten bits (bits 00011): red from 1023 to 0, green 512 in both,
// blue from 0 to 1.
static void a_block_of_one_region_by_hand(void **state) {
  (void)state;
  uint64_t low = 3 | 1023ull << 5 | 512ull << 15 | 0ull << 25 | 0ull << 35 | 512ull << 45 | 1ull << 55;
  uint64_t high = 0;
  // Texel i has index i; bits 65 to 67 are texel 0's.
  for (uint32_t i = 1; i < TEXELS; i++) high |= (uint64_t)i << 4 * i;
  const olx_bc6h_block block = {{(uint32_t)low, (uint32_t)(low >> 32), (uint32_t)high, (uint32_t)(high >> 32)}};
  // 1023 becomes 65535, and 65535 * 31 / 64 is the largest half float; 512 becomes 512 * 64 + 32 = 32800; 1 becomes 96.
  assert_halves(olx_bc6h_texel(&block, 0), (const uint32_t[3]){0x7BFF, 32800 * 31 / 64, 0});
  assert_halves(olx_bc6h_texel(&block, 15), (const uint32_t[3]){0, 32800 * 31 / 64, 96 * 31 / 64});
  // Index 7 has a weight of 30 in 64: red is 65535 * 34 / 64 = 34815.5, blue is 96 * 30 / 64 = 45, both rounded.
  assert_halves(olx_bc6h_texel(&block, 7), (const uint32_t[3]){34815 * 31 / 64, 32800 * 31 / 64, 45 * 31 / 64});
}

static void any_bits_are_light(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    olx_bc6h_block block;
    for (uint32_t k = 0; k < 4; k++) block.words[k] = olx_hash3(i, k, 31);
    const bool reserved = (block.words[0] & 19u) == 19u;
    for (uint32_t k = 0; k < TEXELS; k++) {
      const olx_vec3 light = olx_bc6h_texel(&block, k);
      assert_true(light.x >= 0.0f && light.y >= 0.0f && light.z >= 0.0f && olx_max3(light) <= 65504.0f);
      if (reserved) assert_true(olx_max3(light) == 0.0f);
    }
  }
}

// --- Encoding light

// Returns the root mean squared error of a texel's channels, relative to its largest channel.
static float relative_error(const olx_bc6h_block *block, uint32_t texel, olx_vec3 light) {
  const olx_vec3 off = olx_sub(olx_bc6h_texel(block, texel), light);
  return olx_length(off) * 0.57735f / olx_max3(light);
}

// A block of one colour, of half floats with any brightness, comes back exactly.
static void constant_light_is_exact(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    uint32_t half[3];
    for (uint32_t c = 0; c < 3; c++) half[c] = olx_hash3(i, c, 2) % 0x7C00u;
    olx_vec3 texels[TEXELS];
    for (uint32_t k = 0; k < TEXELS; k++) {
      texels[k] = olx_v3(olx_half_unpack((uint16_t)half[0]), olx_half_unpack((uint16_t)half[1]),
                         olx_half_unpack((uint16_t)half[2]));
    }
    const olx_bc6h_block block = olx_bc6h_encode(texels, NULL, ALL);
    for (uint32_t k = 0; k < TEXELS; k++) assert_halves(olx_bc6h_texel(&block, k), half);
  }
}

// Light of which brightness varies by up to 20 % over the block, and colour a little, comes back to a hundredth.
static void smooth_light_is_right_to_a_hundredth(void **state) {
  (void)state;
  double squares = 0.0;
  for (uint32_t i = 0; i < 20000; i++) {
    const olx_vec3 light =
        olx_scale(olx_v3(0.3f + random_unit(i, 0), 0.3f + random_unit(i, 1), 0.3f + random_unit(i, 2)),
                  exp2f(20.0f * random_unit(i, 3) - 10.0f));
    const float along_x = 0.06f * random_unit(i, 4) - 0.03f, along_y = 0.06f * random_unit(i, 5) - 0.03f;
    olx_vec3 texels[TEXELS];
    for (uint32_t k = 0; k < TEXELS; k++) {
      const float change = along_x * (float)(k % 4) + along_y * (float)(k / 4);
      texels[k] = olx_mul(light, olx_v3(1.0f + change, 1.0f + 0.9f * change, 1.0f + 0.8f * change));
    }
    const olx_bc6h_block block = olx_bc6h_encode(texels, NULL, ALL);
    for (uint32_t k = 0; k < TEXELS; k++) {
      const float error = relative_error(&block, k, texels[k]);
      assert_true(error < 0.012f);
      squares += (double)(error * error);
    }
  }
  assert_true(squares / (20000.0 * TEXELS) < 1e-5);
}

// A lit floor is beside a dark step, with ratios from 1:2 to 1:100 and a gradient on each. Neither takes light of the
// other.
static void darkness_beside_light_stays_dark(void **state) {
  (void)state;
  double squares = 0.0;
  for (uint32_t i = 0; i < 20000; i++) {
    const float bright = exp2f(10.0f * random_unit(i, 0) - 3.0f),
                dark = bright * exp2f(-1.0f - 5.6f * random_unit(i, 1));
    const float angle = 6.2831853f * random_unit(i, 2), shift = 2.0f * random_unit(i, 3) - 1.0f;
    olx_vec3 texels[TEXELS];
    for (uint32_t k = 0; k < TEXELS; k++) {
      const float x = (float)(k % 4) - 1.5f, y = (float)(k / 4) - 1.5f;
      const bool lit = x * cosf(angle) + y * sinf(angle) > shift;
      const float gradient = 1.0f + 0.02f * x + 0.03f * y;
      texels[k] =
          olx_scale(lit ? olx_v3(1.0f, 0.9f, 0.7f) : olx_v3(0.6f, 0.8f, 1.0f), (lit ? bright : dark) * gradient);
    }
    const olx_bc6h_block block = olx_bc6h_encode(texels, NULL, ALL);
    for (uint32_t k = 0; k < TEXELS; k++) {
      const float error = relative_error(&block, k, texels[k]);
      assert_true(error < 0.25f);
      squares += (double)(error * error);
    }
  }
  assert_true(squares / (20000.0 * TEXELS) < 2e-3);
}

// Direct light in full shadow is 0; its error there is small relative to the other light at the point.
static void shadows_take_no_light(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    const float other = exp2f(-8.0f * random_unit(i, 1)); // indirect light; direct light has 1 where a texel is lit
    const uint32_t lit = olx_hash2(i, 4) & ALL;
    olx_vec3 texels[TEXELS];
    float brightness[TEXELS];
    for (uint32_t k = 0; k < TEXELS; k++) {
      texels[k] = lit >> k & 1u ? olx_v3(1.0f, 0.8f, 0.5f) : olx_splat(0.0f);
      brightness[k] = olx_max3(texels[k]) + other;
    }
    const olx_bc6h_block block = olx_bc6h_encode(texels, brightness, ALL);
    for (uint32_t k = 0; k < TEXELS; k++) {
      const olx_vec3 off = olx_sub(olx_bc6h_texel(&block, k), texels[k]);
      assert_true(olx_length(off) < 0.02f * brightness[k]);
    }
  }
}

static void odd_light_becomes_light(void **state) {
  (void)state;
  const float odd[] = {NAN, INFINITY, -INFINITY, -1.0f, 1e-45f, 1e38f, 0.0f, 70000.0f};
  for (uint32_t i = 0; i < 20000; i++) {
    olx_vec3 texels[TEXELS];
    float brightness[TEXELS];
    for (uint32_t k = 0; k < TEXELS; k++) {
      const uint32_t what = olx_hash3(i, k, 5);
      texels[k] = olx_v3(random_unit(i, k), random_unit(i, k + 16), what & 8u ? odd[what % 8] : 0.5f);
      if (what & 64u) texels[k].x = odd[(what >> 8) % 8];
      brightness[k] = what & 512u ? odd[(what >> 12) % 8] : 1.0f;
    }
    const olx_bc6h_block block =
        olx_bc6h_encode(texels, i % 2 ? brightness : NULL, i % 5 ? ALL : olx_hash2(i, 6) & ALL);
    for (uint32_t k = 0; k < TEXELS; k++) assert_true(olx_max3(olx_bc6h_texel(&block, k)) <= 65504.0f);
  }
  olx_vec3 bright[TEXELS];
  for (uint32_t k = 0; k < TEXELS; k++) bright[k] = olx_splat(INFINITY);
  const olx_bc6h_block most = olx_bc6h_encode(bright, NULL, ALL);
  assert_true(olx_bc6h_texel(&most, 5).x == 65504.0f);
}

// Texels that do not count have no influence; a block without any texel that counts is black.
static void texels_that_do_not_count_have_no_say(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 5000; i++) {
    const uint32_t counted = olx_hash2(i, 1) & ALL;
    olx_vec3 a[TEXELS], b[TEXELS];
    for (uint32_t k = 0; k < TEXELS; k++) {
      a[k] = b[k] = olx_scale(olx_v3(random_unit(i, k), random_unit(i, 20 + k), 1.0f), 1.0f + (float)(k / 4));
      if (!(counted >> k & 1u)) b[k] = k % 2 ? olx_splat(NAN) : olx_splat(1000.0f);
    }
    const olx_bc6h_block first = olx_bc6h_encode(a, NULL, counted), second = olx_bc6h_encode(b, NULL, counted);
    assert_memory_equal(&first, &second, sizeof first);
  }
  const olx_vec3 light[TEXELS] = {{1, 1, 1}};
  const olx_bc6h_block none = olx_bc6h_encode(light, NULL, 0);
  for (uint32_t k = 0; k < TEXELS; k++) assert_true(olx_max3(olx_bc6h_texel(&none, k)) == 0.0f);
}

// --- Materials

// Decodes a block by hand: its ends are 31, 0, 0 and 0, 0, 31 of five bits; indices 0 to 3 are both ends, one third and
// two thirds of the way.
static void bc1_by_hand(void **state) {
  (void)state;
  const olx_bc1_block block = {{31u << 11 | 31u << 16, 0xE4u}};
  const uint32_t expected[4] = {0x0000FFu, 0xFF0000u, 0x5500AAu, 0xAA0055u};
  for (uint32_t k = 0; k < 4; k++) assert_int_equal(olx_bc1_texel(&block, k), expected[k]);
  // With the smaller number first, the others are the mean and black.
  const olx_bc1_block three = {{31u | 31u << 27, 0xE4u}};
  const uint32_t others[4] = {0xFF0000u, 0x0000FFu, 0x800080u, 0};
  for (uint32_t k = 0; k < 4; k++) assert_int_equal(olx_bc1_texel(&three, k), others[k]);
}

static uint32_t most_off(uint32_t a, uint32_t b) {
  uint32_t most = 0;
  for (uint32_t c = 0; c < 3; c++) {
    const uint32_t off = (uint32_t)abs((int32_t)(a >> 8 * c & 255u) - (int32_t)(b >> 8 * c & 255u));
    most = off > most ? off : most;
  }
  return most;
}

static void one_colour_is_kept_to_two_steps(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    const uint32_t color = i < 256 ? i * 0x010101u : olx_hash2(i, 1) & 0xFFFFFFu;
    uint32_t texels[TEXELS];
    // The high byte is not a part of the colour.
    for (uint32_t k = 0; k < TEXELS; k++) texels[k] = color | olx_hash2(i, k) << 24;
    const olx_bc1_block block = olx_bc1_encode(texels, ALL);
    for (uint32_t k = 0; k < TEXELS; k++) assert_true(most_off(olx_bc1_texel(&block, k), color) <= 2);
  }
}

// When two materials meet in a block, each keeps its colour to the rounding of 5 bits.
static void two_colours_are_kept(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    const uint32_t colors[2] = {olx_hash2(i, 1) & 0xFFFFFFu, olx_hash2(i, 2) & 0xFFFFFFu}, mask = olx_hash2(i, 3);
    uint32_t texels[TEXELS];
    for (uint32_t k = 0; k < TEXELS; k++) texels[k] = colors[mask >> k & 1u];
    const olx_bc1_block block = olx_bc1_encode(texels, ALL);
    for (uint32_t k = 0; k < TEXELS; k++) assert_true(most_off(olx_bc1_texel(&block, k), texels[k]) <= 5);
  }
}

// Decodes blocks by hand: ends 7 and 0 give every number between them; ends 0 and 5 give those between them, and 0 and
// 255.
static void bc4_by_hand(void **state) {
  (void)state;
  const uint64_t indices = 0xFAC688ull; // texel i has index i: 0 1 2 3 4 5 6 7, in three bits each
  const uint64_t down = 7ull | indices << 16, up = 0ull | 5ull << 8 | indices << 16;
  const olx_bc4_block first = {{(uint32_t)down, (uint32_t)(down >> 32)}},
                      second = {{(uint32_t)up, (uint32_t)(up >> 32)}};
  const uint32_t of_eight[8] = {7, 0, 6, 5, 4, 3, 2, 1}, of_six[8] = {0, 5, 1, 2, 3, 4, 0, 255};
  for (uint32_t k = 0; k < 8; k++) {
    assert_int_equal(olx_bc4_texel(&first, k), of_eight[k]);
    assert_int_equal(olx_bc4_texel(&second, k), of_six[k]);
  }
}

static void bytes_are_kept_to_half_a_step(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    const uint32_t low = olx_hash2(i, 1) % 256, high = low + olx_hash2(i, 2) % (256 - low),
                   counted = olx_hash2(i, 3) & ALL;
    uint8_t texels[TEXELS];
    double plain = 0.0, found = 0.0;
    for (uint32_t k = 0; k < TEXELS; k++) {
      const uint32_t random = olx_hash3(i, k, 4);
      texels[k] = (uint8_t)(i % 2 ? low + random % (high - low + 1) : random & 1u ? low : high);
    }
    const olx_bc4_block block = olx_bc4_encode(texels, counted);
    const double step = (double)(high - low) / 7.0;
    for (uint32_t k = 0; k < TEXELS; k++) {
      if (!(counted >> k & 1u)) continue;
      const double off = fabs((double)olx_bc4_texel(&block, k) - texels[k]);
      if (i % 2 == 0) assert_true(off == 0.0); // blocks of only two numbers are exact
      found += off * off;
      plain += (0.5 * step + 0.5) * (0.5 * step + 0.5);
    }
    assert_true(found <= plain);
  }
}

static void reflectance_keeps_metals_and_weights(void **state) {
  (void)state;
  for (uint32_t code = 0; code < 256; code++)
    assert_int_equal(olx_reflectance_pack(olx_reflectance_unpack(code)), code);
  for (uint32_t i = 0; i <= 1000; i++) {
    const float share = (float)i / 1000.0f;
    const olx_reflectance weight = olx_reflectance_unpack(olx_reflectance_pack((olx_reflectance){0.0f, share})),
                          metal = olx_reflectance_unpack(olx_reflectance_pack((olx_reflectance){share, 1.0f}));
    assert_true(weight.metallic == 0.0f && fabsf(weight.specular_weight - share) <= 0.004f);
    assert_true(metal.specular_weight == 1.0f && fabsf(metal.metallic - share) <= 0.004f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_modes_decode_as_defined),
      cmocka_unit_test(a_block_of_one_region_by_hand),
      cmocka_unit_test(any_bits_are_light),
      cmocka_unit_test(constant_light_is_exact),
      cmocka_unit_test(smooth_light_is_right_to_a_hundredth),
      cmocka_unit_test(darkness_beside_light_stays_dark),
      cmocka_unit_test(shadows_take_no_light),
      cmocka_unit_test(odd_light_becomes_light),
      cmocka_unit_test(texels_that_do_not_count_have_no_say),
      cmocka_unit_test(bc1_by_hand),
      cmocka_unit_test(one_colour_is_kept_to_two_steps),
      cmocka_unit_test(two_colours_are_kept),
      cmocka_unit_test(bc4_by_hand),
      cmocka_unit_test(bytes_are_kept_to_half_a_step),
      cmocka_unit_test(reflectance_keeps_metals_and_weights),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
