// Tests the octahedral map and the packed formats: exact where the formats are exact, bounded where they round.
#include "core/pack.h"
#include "core/sampling.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static const double FULL_SPHERE = 4.0 * 3.14159265358979323846;

static olx_vec3 random_direction(uint32_t i) { return olx_sample_sphere(olx_stratified2(i, 99)); }

// Returns an angle in radians, precise for small angles, where the cosine is not.
static double angle(olx_vec3 a, olx_vec3 b) {
  const double x = (double)a.y * b.z - (double)a.z * b.y, y = (double)a.z * b.x - (double)a.x * b.z,
               z = (double)a.x * b.y - (double)a.y * b.x;
  return atan2(sqrt(x * x + y * y + z * z), (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z);
}

// --- The map

static void test_directions_round_trip(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 200000; i++) {
    const olx_vec3 d = random_direction(i);
    const olx_vec2 uv = olx_octahedral_encode(d);
    assert_true(uv.x >= 0.0f && uv.x <= 1.0f && uv.y >= 0.0f && uv.y <= 1.0f);
    assert_true(angle(olx_octahedral_decode(uv), d) < 5e-7);
    assert_true(fabsf(olx_length(olx_octahedral_decode(uv)) - 1.0f) < 2e-7f);
    const olx_vec2 longer = olx_octahedral_encode(olx_scale(d, 8.0f));
    assert_true(longer.x == uv.x && longer.y == uv.y);
  }
}

static void test_places_round_trip(void **state) {
  (void)state;
  for (uint32_t n = 8; n <= 2048; n *= 4) {
    for (uint32_t i = 0; i < 20000; i++) {
      const uint32_t x = olx_hash2(i, n) % n, y = olx_hash2(n, i) % n;
      const olx_vec2 uv = olx_octahedral_encode(olx_texel_direction(x, y, n));
      assert_int_equal((uint32_t)(uv.x * (float)n), x);
      assert_int_equal((uint32_t)(uv.y * (float)n), y);
    }
  }
}

// y is at the middle of the map, x and z along its axes, and the lower half is folded outwards.
static void test_places_of_the_axes(void **state) {
  (void)state;
  const struct {
    olx_vec3 d;
    olx_vec2 uv;
  } known[] = {{{0, 1, 0}, {0.5f, 0.5f}}, {{1, 0, 0}, {1.0f, 0.5f}},  {{-1, 0, 0}, {0.0f, 0.5f}},
               {{0, 0, 1}, {0.5f, 1.0f}}, {{0, 0, -1}, {0.5f, 0.0f}}, {{0, -1, 0}, {1.0f, 1.0f}}};
  for (uint32_t i = 0; i < 6; i++) {
    const olx_vec2 uv = olx_octahedral_encode(known[i].d);
    assert_true(uv.x == known[i].uv.x && uv.y == known[i].uv.y);
    const olx_vec3 d = olx_octahedral_decode(uv);
    assert_true(d.x == known[i].d.x && d.y == known[i].d.y && d.z == known[i].d.z);
  }
  for (uint32_t corner = 0; corner < 4; corner++) {
    const olx_vec3 d = olx_octahedral_decode((olx_vec2){(float)(corner & 1u), (float)(corner >> 1)});
    assert_true(d.x == 0.0f && d.y == -1.0f && d.z == 0.0f);
  }
}

static void test_solid_angles_fill_the_sphere(void **state) {
  (void)state;
  for (uint32_t n = 8; n <= 512; n *= 2) {
    long double sum = 0.0L;
    for (uint32_t y = 0; y < n; y++) {
      for (uint32_t x = 0; x < n; x++) sum += (long double)olx_texel_solid_angle(x, y, n);
    }
    assert_true(fabs((double)sum - FULL_SPHERE) <= 1e-12 * FULL_SPHERE);
  }
}

// Integrates the solid angle of a texel, d omega = 4 du dv / |q|^3, by the midpoint rule.
static double integrated_solid_angle(uint32_t x, uint32_t y, uint32_t n, uint32_t steps) {
  double sum = 0.0;
  for (uint32_t i = 0; i < steps * steps; i++) {
    const double u = 2.0 * (x + (i % steps + 0.5) / steps) / n - 1.0,
                 v = 2.0 * (y + (i / steps + 0.5) / steps) / n - 1.0;
    const double w = 1.0 - fabs(u) - fabs(v);
    const double qx = w < 0.0 ? 1.0 - fabs(v) : u, qz = w < 0.0 ? 1.0 - fabs(u) : v;
    const double squared = qx * qx + w * w + qz * qz;
    sum += 1.0 / (squared * sqrt(squared));
  }
  return 4.0 * sum / ((double)n * n * steps * steps);
}

static void test_solid_angles_are_the_integral(void **state) {
  (void)state;
  for (uint32_t n = 2; n <= 32; n *= 4) {
    for (uint32_t i = 0; i < n * n; i++) {
      const double exact = olx_texel_solid_angle(i % n, i / n, n);
      // The midpoint rule errs by the step in cells on a fold, at most one in 32 of a texel's cells, and by its square
      // elsewhere.
      const double step = 1.0 / (32.0 * n);
      assert_true(fabs(integrated_solid_angle(i % n, i / n, n, 32) / exact - 1.0) < 2.0 * step / 32.0);
    }
  }
}

static void test_small_texels_follow_the_formula(void **state) {
  (void)state;
  double worst[2] = {0.0, 0.0};
  for (uint32_t pass = 0; pass < 2; pass++) {
    const uint32_t n = pass ? 512 : 256;
    for (uint32_t i = 0; i < n * n; i++) {
      const olx_vec2 uv = {((float)(i % n) + 0.5f) / (float)n, ((float)(i / n) + 0.5f) / (float)n};
      const double error = (double)olx_texel_solid_angle_near(uv, n) / olx_texel_solid_angle(i % n, i / n, n) - 1.0;
      worst[pass] = fmax(worst[pass], fabs(error));
    }
    assert_true(worst[pass] < 4.0 / n); // errors of first order on the folds
  }
  assert_true(worst[1] < 0.6 * worst[0]);
}

// The inverse of a sum below 2^-128 is infinite.
static void test_the_shortest_directions_stay_in_the_square(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 27; i++) {
    const float x = (float)(i % 3) - 1.0f, y = (float)(i / 3 % 3) - 1.0f, z = (float)(i / 9) - 1.0f;
    const olx_vec2 uv = olx_octahedral_encode(olx_v3(x * 1e-39f, y * 1e-39f, z * 1e-39f));
    assert_true(uv.x >= 0.0f && uv.x <= 1.0f && uv.y >= 0.0f && uv.y <= 1.0f);
  }
}

static void test_solid_angles_against_counting(void **state) {
  (void)state;
  enum { N = 8, SAMPLES = 1 << 20 };
  uint32_t hits[N * N] = {0};
  for (uint32_t i = 0; i < SAMPLES; i++) {
    const olx_vec2 random = {olx_unit_float(olx_hash2(i, 1)), olx_unit_float(olx_hash2(i, 2))};
    const olx_vec2 uv = olx_octahedral_encode(olx_sample_sphere(random));
    const uint32_t x = (uint32_t)olx_min(uv.x * N, N - 1), y = (uint32_t)olx_min(uv.y * N, N - 1);
    hits[y * N + x]++;
  }
  double chi_squared = 0.0;
  for (uint32_t i = 0; i < N * N; i++) {
    const double expected = SAMPLES * olx_texel_solid_angle(i % N, i / N, N) / FULL_SPHERE;
    chi_squared += (hits[i] - expected) * (hits[i] - expected) / expected;
  }
  assert_true(chi_squared < 103.4); // 63 degrees of freedom, exceeded once in a thousand
}

// --- The border

static olx_vec3 border_direction(int32_t x, int32_t y, int32_t n) {
  int32_t source_x, source_y;
  olx_border_source(x, y, n, &source_x, &source_y);
  assert_true(source_x >= 0 && source_x < n && source_y >= 0 && source_y < n);
  return olx_texel_direction((uint32_t)source_x, (uint32_t)source_y, (uint32_t)n);
}

static void test_inside_is_its_own_source(void **state) {
  (void)state;
  for (int32_t i = 0; i < 64; i++) {
    int32_t x, y;
    olx_border_source(i % 8, i / 8, 8, &x, &y);
    assert_int_equal(x, i % 8);
    assert_int_equal(y, i / 8);
  }
}

// A step over the edge of the map is a step on the sphere no longer than the steps along the edge and inside it.
static void test_border_continues_the_sphere(void **state) {
  (void)state;
  for (int32_t n = 8; n <= 128; n *= 2) {
    double longest = 0.0;
    for (int32_t y = 0; y < n; y++) {
      for (int32_t x = 1; x < n; x++) {
        longest = fmax(longest, angle(border_direction(x, y, n), border_direction(x - 1, y, n)));
      }
    }
    for (int32_t i = 0; i < n; i++) {
      const double over[4] = {angle(border_direction(-1, i, n), border_direction(0, i, n)),
                              angle(border_direction(n, i, n), border_direction(n - 1, i, n)),
                              angle(border_direction(i, -1, n), border_direction(i, 0, n)),
                              angle(border_direction(i, n, n), border_direction(i, n - 1, n))};
      for (uint32_t side = 0; side < 4; side++) assert_true(over[side] <= longest * 1.0001);
    }
    // All texels around a corner touch the direction -y.
    const int32_t ends[2] = {-1, n};
    for (uint32_t corner = 0; corner < 4; corner++) {
      assert_true(angle(border_direction(ends[corner & 1], ends[corner >> 1], n), olx_v3(0, -1, 0)) < longest);
    }
  }
}

// Filters a smooth function, stored with its border, bilinearly. It must have one value where two points of the edge
// are one direction: (0, v) and (0, 1 - v), and so on.
static float filtered(const float *map, int32_t n, float u, float v) {
  const float x = u * (float)n + 0.5f, y = v * (float)n + 0.5f; // coordinates in the bordered map
  const int32_t x0 = (int32_t)olx_min(x, (float)n), y0 = (int32_t)olx_min(y, (float)n);
  const float fx = x - (float)x0, fy = y - (float)y0, *row = map + y0 * (n + 2) + x0;
  return olx_mix(olx_mix(row[0], row[1], fx), olx_mix(row[n + 2], row[n + 3], fx), fy);
}

static void test_filtering_has_no_seam(void **state) {
  (void)state;
  enum { N = 16 };
  float map[(N + 2) * (N + 2)];
  for (int32_t y = -1; y <= N; y++) {
    for (int32_t x = -1; x <= N; x++) {
      const olx_vec3 d = border_direction(x, y, N);
      map[(y + 1) * (N + 2) + x + 1] = d.x + 2.0f * d.y * d.z - 0.5f * d.z;
    }
  }
  for (uint32_t i = 0; i <= 1000; i++) {
    const float v = (float)i / 1000.0f;
    assert_true(fabsf(filtered(map, N, 0.0f, v) - filtered(map, N, 0.0f, 1.0f - v)) < 1e-5f);
    assert_true(fabsf(filtered(map, N, 1.0f, v) - filtered(map, N, 1.0f, 1.0f - v)) < 1e-5f);
    assert_true(fabsf(filtered(map, N, v, 0.0f) - filtered(map, N, 1.0f - v, 0.0f)) < 1e-5f);
    assert_true(fabsf(filtered(map, N, v, 1.0f) - filtered(map, N, 1.0f - v, 1.0f)) < 1e-5f);
  }
  const float bottom = filtered(map, N, 0.0f, 0.0f);
  assert_true(fabsf(filtered(map, N, 1.0f, 0.0f) - bottom) < 1e-5f);
  assert_true(fabsf(filtered(map, N, 0.0f, 1.0f) - bottom) < 1e-5f);
  assert_true(fabsf(filtered(map, N, 1.0f, 1.0f) - bottom) < 1e-5f);
}

// --- Normals

static void test_normal_axes_are_exact(void **state) {
  (void)state;
  const olx_vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (uint32_t i = 0; i < 6; i++) {
    const olx_vec3 n = olx_normal_unpack(olx_normal_pack(axes[i]));
    assert_true(n.x == axes[i].x && n.y == axes[i].y && n.z == axes[i].z);
  }
}

static void test_normal_codes_round_trip(void **state) {
  (void)state;
  for (uint32_t code = 0; code < 65536; code++) {
    if ((code & 0xFF) == 255 || code >> 8 == 255) continue;
    const olx_vec3 n = olx_normal_unpack((uint16_t)code);
    const uint16_t again = olx_normal_pack(n);
    assert_true((again & 0xFF) < 255 && again >> 8 < 255);
    // On the edge of the map two codes represent one direction; elsewhere the same code comes back.
    assert_true(angle(olx_normal_unpack(again), n) < 3e-7);
    const uint32_t u = code & 0xFF, v = code >> 8;
    if (u > 0 && u < 254 && v > 0 && v < 254) assert_int_equal(again, code);
  }
}

static void test_normal_error_is_bounded(void **state) {
  (void)state;
  enum { SAMPLES = 1000000 };
  double worst = 0.0, sum = 0.0;
  for (uint32_t i = 0; i < SAMPLES; i++) {
    const olx_vec3 d = random_direction(i);
    const double error = angle(olx_normal_unpack(olx_normal_pack(d)), d);
    worst = fmax(worst, error);
    sum += error;
  }
  const double degrees = 180.0 / 3.14159265358979323846;
  print_message("normals in two bytes: mean %.4f, most %.4f degrees\n", sum / SAMPLES * degrees, worst * degrees);
  assert_true(sum / SAMPLES * degrees < 0.32);
  assert_true(worst * degrees < 0.64);
}

// --- Half floats

static double half_value(uint32_t code) {
  const uint32_t exponent = code >> 10 & 31, mantissa = code & 1023;
  const double magnitude = exponent ? ldexp(1024.0 + mantissa, (int)exponent - 25) : ldexp(mantissa, -24);
  return code & 0x8000 ? -magnitude : magnitude;
}

static void test_half_codes_round_trip(void **state) {
  (void)state;
  for (uint32_t code = 0; code < 65536; code++) {
    const float value = olx_half_unpack((uint16_t)code);
    const uint16_t again = olx_half_pack(value);
    if ((code & 0x7FFF) > 0x7C00) {
      assert_true(isnan(value));
      assert_true((again & 0x7FFF) > 0x7C00);
      continue;
    }
    if ((code & 0x7FFF) == 0x7C00) assert_true(isinf(value) && (signbit(value) != 0) == (code >= 0x8000));
    else assert_true((double)value == half_value(code) && (signbit(value) != 0) == (code >= 0x8000));
    assert_int_equal(again, code);
  }
}

// Returns the code whose value is nearest, the even one of two; `largest` is the greatest finite code.
static uint32_t nearest_code(double f, uint32_t largest, double (*value)(uint32_t)) {
  uint32_t low = 0, high = largest;
  while (low < high) { // finds the last code whose value is not above f
    const uint32_t middle = (low + high + 1) / 2;
    if (value(middle) <= f) low = middle;
    else high = middle - 1;
  }
  if (low == largest) return low;
  const double below = f - value(low), above = value(low + 1) - f;
  return below < above || (below == above && low % 2 == 0) ? low : low + 1;
}

// Visits floats around every code: the code itself, halfway to the next, and one unit in the last place to either side
// of both.
static void for_floats_around(uint32_t largest, double (*value)(uint32_t), void (*visit)(float f)) {
  for (uint32_t code = 0; code < largest; code++) {
    const float exact = (float)value(code), halfway = (float)(0.5 * (value(code) + value(code + 1)));
    visit(exact);
    visit(nextafterf(exact, INFINITY));
    visit(nextafterf(halfway, 0.0f));
    visit(halfway);
    visit(nextafterf(halfway, INFINITY));
    visit(nextafterf((float)value(code + 1), 0.0f));
  }
}

static void visit_half(float f) {
  const uint32_t expected = nearest_code((double)f, 0x7BFF, half_value);
  assert_int_equal(olx_half_pack(f), expected);
  assert_int_equal(olx_half_pack(-f), expected | 0x8000);
}

static void test_half_rounds_to_nearest(void **state) {
  (void)state;
  for_floats_around(0x7BFF, half_value, visit_half);
  for (uint32_t i = 0; i < 500000; i++) {
    const float f = olx_bits_float(olx_hash(i) & 0x7FFFFFFF);
    if (f < 65504.0f) visit_half(f);
  }
}

static void test_half_special_values(void **state) {
  (void)state;
  assert_int_equal(olx_half_pack(0.0f), 0);
  assert_int_equal(olx_half_pack(-0.0f), 0x8000);
  assert_int_equal(olx_half_pack(1.0f), 0x3C00);
  assert_int_equal(olx_half_pack(65504.0f), 0x7BFF);
  assert_int_equal(olx_half_pack(nextafterf(65520.0f, 0.0f)), 0x7BFF);
  assert_int_equal(olx_half_pack(65520.0f), 0x7C00);
  assert_int_equal(olx_half_pack(3e38f), 0x7C00);
  assert_int_equal(olx_half_pack(INFINITY), 0x7C00);
  assert_int_equal(olx_half_pack(-INFINITY), 0xFC00);
  assert_true((olx_half_pack(NAN) & 0x7FFF) > 0x7C00);
  assert_int_equal(olx_half_pack(0x1p-24f), 1);
  assert_int_equal(olx_half_pack(0x1p-25f), 0); // a tie goes to the even code
  assert_int_equal(olx_half_pack(nextafterf(0x1p-25f, 1.0f)), 1);
  assert_int_equal(olx_half_pack(1e-45f), 0);
}

// --- R11G11B10F

static double small_value(uint32_t code, uint32_t bits) {
  const uint32_t exponent = code >> bits, mantissa = code & ((1u << bits) - 1);
  return exponent ? ldexp((1u << bits) + mantissa, (int)exponent - 15 - (int)bits) : ldexp(mantissa, -14 - (int)bits);
}
static double value11(uint32_t code) { return small_value(code, 6); }
static double value10(uint32_t code) { return small_value(code, 5); }

static void test_color_codes_round_trip(void **state) {
  (void)state;
  for (uint32_t code = 0; code < 31u << 6; code++) {
    assert_true((double)olx_small_float_unpack(code, 6) == value11(code));
    assert_int_equal(olx_small_float_pack((float)value11(code), 6), code);
  }
  for (uint32_t code = 0; code < 31u << 5; code++) {
    assert_true((double)olx_small_float_unpack(code, 5) == value10(code));
    assert_int_equal(olx_small_float_pack((float)value10(code), 5), code);
  }
  for (uint32_t i = 0; i < 1000000; i++) {
    const uint32_t random = olx_hash(i);
    const uint32_t r = random % (31u << 6), g = (random >> 11) % (31u << 6), b = (random >> 20) % (31u << 5);
    const uint32_t packed = r | g << 11 | b << 22;
    const olx_vec3 c = olx_r11g11b10f_unpack(packed);
    assert_true((double)c.x == value11(r) && (double)c.y == value11(g) && (double)c.z == value10(b));
    assert_int_equal(olx_r11g11b10f_pack(c), packed);
  }
}

static void visit_color11(float f) {
  assert_int_equal(olx_small_float_pack(f, 6), nearest_code((double)f, (31u << 6) - 1, value11));
}
static void visit_color10(float f) {
  assert_int_equal(olx_small_float_pack(f, 5), nearest_code((double)f, (31u << 5) - 1, value10));
}

static void test_color_rounds_to_nearest(void **state) {
  (void)state;
  for_floats_around((31u << 6) - 1, value11, visit_color11);
  for_floats_around((31u << 5) - 1, value10, visit_color10);
  for (uint32_t i = 0; i < 500000; i++) {
    const float f = olx_bits_float(olx_hash(i) & 0x7FFFFFFF);
    if (!(f < INFINITY)) continue;
    visit_color11(f);
    visit_color10(f);
  }
}

static void test_color_special_values(void **state) {
  (void)state;
  const uint32_t largest = olx_r11g11b10f_pack(olx_splat(INFINITY));
  const olx_vec3 most = olx_r11g11b10f_unpack(largest);
  assert_true(most.x == 65024.0f && most.y == 65024.0f && most.z == 64512.0f);
  assert_int_equal(olx_r11g11b10f_pack(olx_splat(3e38f)), largest);
  assert_int_equal(olx_r11g11b10f_pack(olx_splat(65535.0f)), largest);
  assert_int_equal(olx_r11g11b10f_pack(olx_splat(NAN)), 0);
  assert_int_equal(olx_r11g11b10f_pack(olx_splat(-1.0f)), 0);
  assert_int_equal(olx_r11g11b10f_pack(olx_splat(-INFINITY)), 0);
  assert_int_equal(olx_r11g11b10f_pack(olx_splat(0.0f)), 0);
  assert_int_equal(olx_r11g11b10f_pack(olx_v3(1.0f, 0.0f, 0.0f)), 0x3C0);
  assert_int_equal(olx_r11g11b10f_pack(olx_v3(0.0f, 1.0f, 0.0f)), 0x3C0u << 11);
  assert_int_equal(olx_r11g11b10f_pack(olx_v3(0.0f, 0.0f, 1.0f)), 0x1E0u << 22);
}

// --- RGB9E5

static double shared_value(uint32_t mantissa, uint32_t exponent) { return ldexp(mantissa, (int)exponent - 24); }

static void test_shared_exponent_round_trip(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 1000000; i++) {
    const uint32_t random = olx_hash(i), exponent = i % 32;
    // One mantissa has its highest bit set, as packing makes it; with exponent 0 none needs it.
    const uint32_t first = (random & 0x1FFu) | (exponent ? 0x100u : 0u), g = random >> 9 & 0x1FFu,
                   b = random >> 18 & 0x1FFu;
    const uint32_t packed = first | g << 9 | b << 18 | exponent << 27;
    const olx_vec3 c = olx_rgb9e5_unpack(packed);
    assert_true((double)c.x == shared_value(first, exponent) && (double)c.y == shared_value(g, exponent) &&
                (double)c.z == shared_value(b, exponent));
    assert_int_equal(olx_rgb9e5_pack(c), packed);
  }
}

// The largest component decides the exponent; all are rounded to the nearest multiple of its step.
static void test_shared_exponent_rounds_to_nearest(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 500000; i++) {
    const float most = 65408.0f * powf(0.5f, 45.0f * olx_unit_float(olx_hash(i)));
    const olx_vec3 c = {most * olx_unit_float(olx_hash2(i, 1)), most, most * olx_unit_float(olx_hash2(i, 2))};
    const olx_vec3 stored = olx_rgb9e5_unpack(olx_rgb9e5_pack(c));
    // A step is the largest component's power of two over 256, or twice that where rounding reaches the next power.
    const float step = fmaxf(ldexpf(1.0f, ilogbf(stored.y > 0.0f ? fmaxf(stored.y, most) : most) - 8), 0x1p-24f);
    assert_true(fabsf(stored.x - c.x) <= 0.5f * step && fabsf(stored.y - c.y) <= 0.5f * step &&
                fabsf(stored.z - c.z) <= 0.5f * step);
  }
}

static void test_shared_exponent_special_values(void **state) {
  (void)state;
  const uint32_t largest = olx_rgb9e5_pack(olx_splat(INFINITY));
  assert_int_equal(largest, 0xFFFFFFFFu);
  assert_true(olx_rgb9e5_unpack(largest).x == OLX_RGB9E5_MOST);
  assert_int_equal(olx_rgb9e5_pack(olx_splat(3e38f)), largest);
  assert_int_equal(olx_rgb9e5_pack(olx_splat(NAN)), 0);
  assert_int_equal(olx_rgb9e5_pack(olx_splat(-1.0f)), 0);
  assert_int_equal(olx_rgb9e5_pack(olx_splat(-INFINITY)), 0);
  assert_int_equal(olx_rgb9e5_pack(olx_splat(0.0f)), 0);
  assert_int_equal(olx_rgb9e5_pack(olx_splat(1e-45f)), 0);
  assert_int_equal(olx_rgb9e5_pack(olx_v3(1.0f, 0.0f, 0.0f)), 16u << 27 | 256u);
  assert_int_equal(olx_rgb9e5_pack(olx_v3(0.0f, 1.0f, 0.0f)), 16u << 27 | 256u << 9);
  assert_int_equal(olx_rgb9e5_pack(olx_v3(NAN, -2.0f, 1.0f)), 16u << 27 | 256u << 18);
  // 511.75 steps are rounded up to a whole power of two.
  assert_int_equal(olx_rgb9e5_pack(olx_splat(1.9990234375f)), 17u << 27 | 256u | 256u << 9 | 256u << 18);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_directions_round_trip),
      cmocka_unit_test(test_places_round_trip),
      cmocka_unit_test(test_places_of_the_axes),
      cmocka_unit_test(test_solid_angles_fill_the_sphere),
      cmocka_unit_test(test_solid_angles_are_the_integral),
      cmocka_unit_test(test_small_texels_follow_the_formula),
      cmocka_unit_test(test_the_shortest_directions_stay_in_the_square),
      cmocka_unit_test(test_solid_angles_against_counting),
      cmocka_unit_test(test_inside_is_its_own_source),
      cmocka_unit_test(test_border_continues_the_sphere),
      cmocka_unit_test(test_filtering_has_no_seam),
      cmocka_unit_test(test_normal_axes_are_exact),
      cmocka_unit_test(test_normal_codes_round_trip),
      cmocka_unit_test(test_normal_error_is_bounded),
      cmocka_unit_test(test_half_codes_round_trip),
      cmocka_unit_test(test_half_rounds_to_nearest),
      cmocka_unit_test(test_half_special_values),
      cmocka_unit_test(test_color_codes_round_trip),
      cmocka_unit_test(test_color_rounds_to_nearest),
      cmocka_unit_test(test_color_special_values),
      cmocka_unit_test(test_shared_exponent_round_trip),
      cmocka_unit_test(test_shared_exponent_rounds_to_nearest),
      cmocka_unit_test(test_shared_exponent_special_values),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
