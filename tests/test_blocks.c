// Tests geometry blocks: encoded planes come back within the tolerance, bounds hold, and invalid contents of a file do
// no harm.
#include "block/geometry_encode.h"
#include "core/sampling.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { TEXELS = OLX_BLOCK_TEXELS };

static const uint32_t SIZES[] = {8, 32, 128, 512, 2048};

typedef struct block_input {
  olx_block_place place;
  olx_geometry_texel texels[TEXELS];
} block_input;

static float random_unit(uint32_t i, uint32_t which) { return olx_unit_float(olx_hash3(i, which, 71)); }
static olx_vec3 random_direction(uint32_t i, uint32_t which) {
  return olx_sample_sphere((olx_vec2){random_unit(i, 2 * which), random_unit(i, 2 * which + 1)});
}

// Returns a random block of a map; every third block is on a fold.
static olx_block_place random_place(uint32_t i) {
  const uint32_t n = SIZES[i % 5], side = n / OLX_BLOCK_SIDE;
  olx_block_place place = {n, olx_hash2(i, 1) % side, olx_hash2(i, 2) % side};
  if (i % 3 == 0) {
    const uint32_t half = side / 2, along = place.x % half;
    place.x = half + (i % 2 ? along : 0) - (i % 2 ? 0 : along + 1);
    place.y = half + half - 1 - along;
  }
  return place;
}

static olx_vec3 direction_of(olx_block_place place, uint32_t texel) {
  return olx_normalize(olx_block_texel_point(place, texel));
}

static float footprint_of(olx_block_place place, uint32_t texel, float distance) {
  const uint32_t x = OLX_BLOCK_SIDE * place.x + texel % OLX_BLOCK_SIDE,
                 y = OLX_BLOCK_SIDE * place.y + texel / OLX_BLOCK_SIDE;
  return distance * sqrtf((float)olx_texel_solid_angle(x, y, place.n));
}

// Returns what a texel sees of the plane with normal n at distance h from the probe: nothing on the side that it does
// not face.
static olx_geometry_texel see_plane(olx_block_place place, uint32_t texel, olx_vec3 n, float h) {
  const float facing = -olx_dot(n, direction_of(place, texel));
  return (olx_geometry_texel){facing > 0.0f ? h / facing : INFINITY, n};
}

// Returns the normal of a plane that all texels of the block see under at least 5 degrees.
static olx_vec3 facing_normal(olx_block_place place, uint32_t i, uint32_t which) {
  for (uint32_t attempt = 0;; attempt++) {
    const olx_vec3 n = random_direction(i, which + 100 * attempt);
    float least = 1.0f;
    for (uint32_t k = 0; k < TEXELS; k++) least = olx_min(least, -olx_dot(n, direction_of(place, k)));
    if (least > 0.09f) return n;
  }
}

static olx_geometry_code encode(const block_input *in) {
  const olx_geometry_settings settings = olx_geometry_settings_default();
  return olx_geometry_encode(in->texels, in->place, &settings);
}

static olx_vec3 decode(const olx_geometry_code *code, olx_block_place place, uint32_t texel) {
  const olx_plane_pool pool = {code->planes, code->pooled};
  return olx_geometry_plane(&code->block, &pool, place, texel);
}

static uint32_t form_of(const olx_geometry_code *code) { return code->block.words[3] >> 30; }

// Returns the distance, in footprints, between the point that a texel saw and its plane.
static float miss(olx_vec3 plane, olx_block_place place, uint32_t texel, float distance) {
  const olx_vec3 point = olx_scale(direction_of(place, texel), distance);
  return fabsf(olx_plane_depth(plane, point) - 1.0f) / olx_length(plane) / footprint_of(place, texel, distance);
}

static bool is_sky(olx_vec3 plane) { return olx_dot(plane, plane) == 0.0f; }

// Asserts that all texels come back within the default tolerance.
static void assert_kept(const block_input *in, const olx_geometry_code *code) {
  assert_null(olx_geometry_check(&code->block, code->pooled));
  for (uint32_t k = 0; k < TEXELS; k++) {
    const olx_vec3 plane = decode(code, in->place, k);
    const float distance = in->texels[k].distance;
    assert_int_equal(is_sky(plane), !(distance < INFINITY));
    if (is_sky(plane)) continue;
    assert_true(miss(plane, in->place, k, distance) <= 0.2505f);
    assert_true(olx_dot(olx_plane_normal(plane), in->texels[k].normal) >= 0.7999f);
  }
}

// --- Planes

static void one_plane_is_exact(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    block_input in = {.place = random_place(i)};
    const olx_vec3 n = facing_normal(in.place, i, 1);
    const float h = exp2f(40.0f * random_unit(i, 9) - 20.0f);
    for (uint32_t k = 0; k < TEXELS; k++) in.texels[k] = see_plane(in.place, k, n, h);
    const olx_geometry_code code = encode(&in);
    assert_int_equal(form_of(&code), OLX_GEOMETRY_ONE);
    for (uint32_t k = 0; k < TEXELS; k++) {
      const olx_vec3 plane = decode(&code, in.place, k);
      assert_true(miss(plane, in.place, k, in.texels[k].distance) < 2e-3f);
      assert_true(olx_dot(olx_plane_normal(plane), n) > 0.999f);
      const float distance = olx_plane_distance(plane, direction_of(in.place, k));
      assert_true(fabsf(distance / in.texels[k].distance - 1.0f) < 1e-4f);
    }
  }
}

// A block shows a silhouette: a near plane before a far one, divided by a line across the block.
static void two_planes_keep_their_texels(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    block_input in = {.place = random_place(i)};
    const olx_vec3 near = facing_normal(in.place, i, 1), far = facing_normal(in.place, i, 2);
    const float angle = 6.2831853f * random_unit(i, 30), shift = 2.0f * random_unit(i, 31) - 1.0f;
    uint32_t front = 0;
    for (uint32_t k = 0; k < TEXELS; k++) {
      const float x = (float)(k % 4) - 1.5f, y = (float)(k / 4) - 1.5f;
      front |= (uint32_t)(x * cosf(angle) + y * sinf(angle) > shift) << k;
      in.texels[k] = front >> k & 1u ? see_plane(in.place, k, near, 1.0f) : see_plane(in.place, k, far, 40.0f);
    }
    const olx_geometry_code code = encode(&in);
    if (front != 0 && front != 0xFFFFu && in.place.n >= 32) assert_int_equal(form_of(&code), OLX_GEOMETRY_TWO);
    assert_int_equal(code.pooled, 0);
    assert_kept(&in, &code);
    for (uint32_t k = 0; k < TEXELS; k++) {
      assert_true(miss(decode(&code, in.place, k), in.place, k, in.texels[k].distance) < 0.15f);
    }
  }
}

static void sky_beside_a_plane_stays_sky(void **state) {
  (void)state;
  const block_input empty = {.place = {64, 3, 5}};
  const olx_geometry_code none = encode(&empty);
  for (uint32_t k = 0; k < 4; k++) assert_int_equal(none.block.words[k], 0);
  for (uint32_t i = 0; i < 5000; i++) {
    block_input in = {.place = random_place(i)};
    const olx_vec3 n = facing_normal(in.place, i, 1);
    const uint32_t sky = olx_hash2(i, 3) & 0xFFFFu;
    for (uint32_t k = 0; k < TEXELS; k++) {
      in.texels[k] = see_plane(in.place, k, n, 3.0f);
      if (sky >> k & 1u) in.texels[k].distance = INFINITY;
    }
    const olx_geometry_code code = encode(&in);
    assert_int_equal(form_of(&code), sky ? OLX_GEOMETRY_TWO : OLX_GEOMETRY_ONE);
    assert_kept(&in, &code);
  }
}

// A block takes as many planes from the pool as it has texels, if need be.
static void finer_surfaces_go_to_the_pool(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 10000; i++) {
    block_input in = {.place = random_place(i)};
    const uint32_t count = 3 + i % 14;
    for (uint32_t k = 0; k < TEXELS; k++) {
      const uint32_t which = k < count ? k : olx_hash2(i, k) % count;
      const bool sky = which == 0 && i % 5 == 0;
      in.texels[k] = see_plane(in.place, k, facing_normal(in.place, i, 10 + which), exp2f((float)which));
      if (sky) in.texels[k].distance = INFINITY;
    }
    const olx_geometry_code code = encode(&in);
    assert_int_equal(form_of(&code), OLX_GEOMETRY_POOL);
    assert_true(code.pooled >= 3 && code.pooled <= 16);
    assert_kept(&in, &code);
  }
}

// Spheres have many sizes, so that texels see patches from nearly flat to a whole sphere.
static void curved_surfaces_keep_to_the_tolerance(void **state) {
  (void)state;
  uint32_t pooled = 0;
  for (uint32_t i = 0; i < 20000; i++) {
    block_input in = {.place = random_place(i)};
    const olx_vec3 middle = olx_scale(direction_of(in.place, i % TEXELS), 2.0f);
    const float radius = 1.9f * exp2f(-10.0f * random_unit(i, 5));
    for (uint32_t k = 0; k < TEXELS; k++) {
      const olx_vec3 d = direction_of(in.place, k);
      const float along = olx_dot(d, middle), root = radius * radius - olx_dot(middle, middle) + along * along;
      in.texels[k].distance = INFINITY;
      if (root <= 0.0f || along / sqrtf(root) < 1.0f) continue;
      in.texels[k].distance = along - sqrtf(root);
      in.texels[k].normal = olx_normalize(olx_sub(olx_scale(d, in.texels[k].distance), middle));
    }
    const olx_geometry_code code = encode(&in);
    pooled += form_of(&code) == OLX_GEOMETRY_POOL;
    assert_kept(&in, &code);
  }
  assert_true(pooled > 1000 && pooled < 19000);
}

// Decodes planes by hand: the block is in the quarter x, z > 0 of a map of 8 x 8 texels, with its middle 4 of 8 half
// texels from the map's along both axes, on the fold.
static void coded_planes_mean_what_is_written(void **state) {
  (void)state;
  const olx_block_place place = {8, 1, 1};
  // a = 2^14, b = c = 0, exponent 66: inverse depth 4 * 2^14 * 2^(66 - 82) = 1 everywhere, so x + y + z = 1.
  const olx_vec3 even = olx_plane_decode((olx_plane_code){{1u << 14, 66u << 15}}, place);
  assert_true(even.x == 1.0f && even.y == 1.0f && even.z == 1.0f);
  // b = 2^10, c = -2^11: 2^16 + 2^10 u - 2^11 v, u and v half texels from the block's middle. In the middle of the map,
  // at u = v = -4, 2^16 - 2^12 + 2^13 are m.y; 8 further along x another 2^13 make m.x, and 8 along z -2^14 make m.z.
  const olx_plane_code code = {{1u << 14 | 1u << 27, ((uint32_t)-2048 & 0x7FFFu) | 66u << 15}};
  const olx_vec3 plane = olx_plane_decode(code, place);
  const float unit = 0x1p-16f;
  assert_true(plane.y == (65536.0f - 4096.0f + 8192.0f) * unit);
  assert_true(plane.x == plane.y + 8192.0f * unit);
  assert_true(plane.z == plane.y - 16384.0f * unit);
  // For the same code in the opposite block, x and z change their signs, and so do their slopes.
  const olx_vec3 opposite = olx_plane_decode(code, (olx_block_place){8, 0, 0});
  assert_true(opposite.y == (65536.0f + 4096.0f - 8192.0f) * unit);
  assert_true(opposite.x == -(opposite.y - 8192.0f * unit) && opposite.z == -(opposite.y + 16384.0f * unit));
  // Two planes: the texels of the second are bits 22 to 29 of the last two words.
  const olx_geometry_block two = {
      {1u << 14, 1u << 15, 66u << 15 | 0x81u << 22, 66u << 15 | 0x01u << 22 | OLX_GEOMETRY_TWO << 30}};
  for (uint32_t k = 0; k < TEXELS; k++) {
    const bool second = k == 0 || k == 7 || k == 8;
    assert_true(olx_geometry_plane_of(&two, (olx_plane_code){{0, 0}}, place, k).y == (second ? 2.0f : 1.0f));
  }
}

// Whether a point is hidden is decided without a division.
static void depth_tells_before_from_behind(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    const olx_block_place place = random_place(i);
    const olx_vec3 n = facing_normal(place, i, 1), plane = olx_scale(n, -1.0f / 5.0f);
    const olx_vec3 d = direction_of(place, i % TEXELS);
    const float distance = olx_plane_distance(plane, d);
    assert_true(olx_plane_depth(plane, olx_scale(d, 0.9999f * distance)) < 1.0f);
    assert_true(olx_plane_depth(plane, olx_scale(d, 1.0001f * distance)) > 1.0f);
    assert_true(olx_plane_depth(olx_splat(0.0f), olx_scale(d, 1e18f)) < 1.0f);
  }
}

// --- Bounds

// The bounds of a block contain every inverse depth that it decodes to.
static void bounds_hold_all_that_is_decoded(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 5000; i++) {
    const olx_block_place place = random_place(i);
    olx_plane_code planes[16];
    for (uint32_t k = 0; k < 32; k++) planes[k / 2].words[k % 2] = olx_hash3(i, k, 17);
    olx_geometry_block block = {{0, 0x76543210u, 0xFEDCBA98u, OLX_GEOMETRY_POOL << 30}};
    const olx_plane_pool pool = {planes, 16};
    if (i % 3 == 1)
      block =
          (olx_geometry_block){{olx_hash2(i, 4), olx_hash2(i, 5), olx_hash2(i, 6), 1u << 30 | olx_hash2(i, 7) >> 2}};
    if (i % 3 == 2) {
      const olx_vec3 m = olx_scale(random_direction(i, 8), exp2f(20.0f * random_unit(i, 9)));
      block = (olx_geometry_block){{olx_float_bits(m.x), olx_float_bits(m.y), olx_float_bits(m.z), 0}};
    }
    const olx_block_bounds bounds = olx_geometry_bounds(&block, &pool, place);
    for (uint32_t k = 0; k < 64; k++) {
      const uint32_t texel = k % TEXELS;
      const olx_vec2 inside = {random_unit(i, 200 + 2 * k), random_unit(i, 201 + 2 * k)};
      const olx_vec2 uv = {(float)(4 * place.x + texel % 4) / (float)place.n + inside.x / (float)place.n,
                           (float)(4 * place.y + texel / 4) / (float)place.n + inside.y / (float)place.n};
      const float inverse = olx_dot(olx_geometry_plane(&block, &pool, place, texel), olx_octahedral_point(uv));
      assert_true(olx_max(inverse, 0.0f) >= bounds.least && inverse <= bounds.greatest);
    }
    if (i % 3 != 0) continue;
    block.words[3] |= olx_geometry_nearest_code(&block, &pool, place);
    assert_null(olx_geometry_check(&block, pool.count));
    const float nearest = olx_geometry_nearest(&block);
    assert_true(nearest >= bounds.greatest && nearest <= bounds.greatest * (1.0f + 0x1p-22f));
  }
}

// --- Invalid blocks and texels

static void any_bits_decode(void **state) {
  (void)state;
  const olx_plane_code planes[3] = {{{1, 2}}, {{UINT32_MAX, UINT32_MAX}}, {{0x80000000u, 0x7FFFFFFFu}}};
  const olx_plane_pool pool = {planes, 3};
  uint32_t refused = 0;
  for (uint32_t i = 0; i < 20000; i++) {
    olx_geometry_block block;
    for (uint32_t k = 0; k < 4; k++) block.words[k] = olx_hash3(i, k, 23);
    if (i % 4 == 1) block.words[0] = i % 8; // indices near the end of the pool
    const olx_block_place place = random_place(i);
    const char *problem = olx_geometry_check(&block, pool.count);
    for (uint32_t k = 0; k < TEXELS; k++) {
      const olx_vec3 plane = olx_geometry_plane(&block, &pool, place, k);
      const uint32_t at = olx_geometry_pooled(&block, k);
      if (!problem) assert_true(olx_finite(plane) && (at == OLX_NO_PLANE || at < pool.count));
      (void)olx_plane_distance(plane, direction_of(place, k));
    }
    (void)olx_geometry_bounds(&block, &pool, place);
    refused += problem != NULL;
  }
  assert_true(refused > 10000 && refused < 20000);
}

static void impossible_blocks_are_refused(void **state) {
  (void)state;
  const uint32_t nan = 0x7FC00000u, tiny = 1;
  const olx_geometry_block bad[] = {{{nan, 0, 0, 0}},
                                    {{0, 0x7F800000u, 0, 0}},
                                    {{0, 0, tiny, 0}}, // devices may flush this number to 0
                                    {{0, 0, 0, 1}},    // reserved bits are set
                                    {{0, 0, 1u << 30, OLX_GEOMETRY_TWO << 30}},
                                    {{7, 0, 0, OLX_GEOMETRY_POOL << 30}},           // beyond the pool's end
                                    {{0, 0, 0x70000000u, OLX_GEOMETRY_POOL << 30}}, // one texel's index is beyond
                                    {{UINT32_MAX, 2, 0, OLX_GEOMETRY_POOL << 30}},  // the sum of indices overflows
                                    {{0, 0, 0, 3u << 30}}};                         // a form that is unknown
  for (uint32_t i = 0; i < sizeof bad / sizeof bad[0]; i++) assert_non_null(olx_geometry_check(&bad[i], 7));
  assert_null(olx_geometry_check(&(olx_geometry_block){{0, 0x66666666u, 6, OLX_GEOMETRY_POOL << 30}}, 7));
}

// Blocks are valid whatever values texels have, and texels with ordinary values are kept.
static void odd_texels_are_taken(void **state) {
  (void)state;
  const float odd[] = {NAN, INFINITY, -INFINITY, -1.0f, 0.0f, 1e-40f, 1e38f, 1e-30f, 3.0f};
  for (uint32_t i = 0; i < 20000; i++) {
    block_input in = {.place = random_place(i)};
    const olx_vec3 n = facing_normal(in.place, i, 1);
    for (uint32_t k = 0; k < TEXELS; k++) {
      in.texels[k] = see_plane(in.place, k, n, 2.0f);
      const uint32_t what = olx_hash3(i, k, 3);
      if (what % 4 == 0) in.texels[k].distance = odd[(what >> 4) % 9];
      if (what % 8 == 1) in.texels[k].normal = olx_scale(n, odd[(what >> 4) % 9]);
      if (what % 16 == 2) in.texels[k].normal = olx_v3(odd[(what >> 4) % 9], odd[(what >> 8) % 9], 0.0f);
    }
    const olx_geometry_code code = encode(&in);
    assert_null(olx_geometry_check(&code.block, code.pooled));
    for (uint32_t k = 0; k < TEXELS; k++) {
      const olx_vec3 plane = decode(&code, in.place, k);
      assert_true(olx_finite(plane));
      const float distance = in.texels[k].distance;
      assert_int_equal(is_sky(plane), !(distance > 0.0f && distance < INFINITY));
      if (distance > 1e-9f && distance < 1e9f) assert_true(miss(plane, in.place, k, distance) <= 0.2505f);
    }
  }
}

static void the_same_texels_give_the_same_bytes(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 2000; i++) {
    block_input in = {.place = random_place(i)}, other;
    for (uint32_t k = 0; k < TEXELS; k++) {
      in.texels[k] =
          see_plane(in.place, k, facing_normal(in.place, i, k % (1 + i % 4)), 1.0f + (float)(k % (1 + i % 4)));
      if (i % 7 == k % 7) in.texels[k].distance = INFINITY;
    }
    other = in;
    for (uint32_t k = 0; k < TEXELS; k++) {
      if (!(in.texels[k].distance < INFINITY)) other.texels[k] = (olx_geometry_texel){-1.0f, olx_splat(NAN)};
    }
    const olx_geometry_code a = encode(&in), b = encode(&other);
    assert_memory_equal(&a.block, &b.block, sizeof a.block);
    assert_int_equal(a.pooled, b.pooled);
    assert_memory_equal(a.planes, b.planes, a.pooled * sizeof a.planes[0]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_plane_is_exact),
      cmocka_unit_test(two_planes_keep_their_texels),
      cmocka_unit_test(sky_beside_a_plane_stays_sky),
      cmocka_unit_test(finer_surfaces_go_to_the_pool),
      cmocka_unit_test(curved_surfaces_keep_to_the_tolerance),
      cmocka_unit_test(coded_planes_mean_what_is_written),
      cmocka_unit_test(depth_tells_before_from_behind),
      cmocka_unit_test(bounds_hold_all_that_is_decoded),
      cmocka_unit_test(any_bits_decode),
      cmocka_unit_test(impossible_blocks_are_refused),
      cmocka_unit_test(odd_texels_are_taken),
      cmocka_unit_test(the_same_texels_give_the_same_bytes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
