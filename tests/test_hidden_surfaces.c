// Merging the ends of rays that no probe sees: what is one surface, which of them stay, and that places suffice.
#include "bake/hidden_surfaces.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/sampling.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { RAYS = 600, MOST = 24, FIRST = 1000 };

static const olx_vec3 UP = {0.0f, 1.0f, 0.0f};

typedef struct merged {
  olx_ray_end ends[RAYS];
  uint32_t rays[RAYS];
  olx_hidden_surface surfaces[MOST];
} merged;

// At the origin, surfaces of a tenth of the distance.
static void merge(merged *m, uint32_t count, uint32_t most) {
  const olx_hidden_input input = {.ends = m->ends,
                                  .rays = m->rays,
                                  .count = count,
                                  .angle = 0.1f,
                                  .least_length = 1e-3f,
                                  .first = FIRST,
                                  .most = most};
  assert_true(olx_hidden_merge(&input, m->surfaces));
}

static void add_end(merged *m, uint32_t i, olx_vec3 position, olx_vec3 normal, float albedo) {
  m->ends[i] = (olx_ray_end){position, normal, olx_splat(albedo)};
  m->rays[i] = OLX_FIT_RAY_UNKNOWN;
}

static void near_ends_in_one_plane_are_one_surface(void **unused) {
  (void)unused;
  merged m;
  add_end(&m, 0, olx_v3(2.0f, 0.0f, 0.0f), UP, 0.25f); // ten of which 0.2 m is the size
  add_end(&m, 1, olx_v3(2.1f, 0.0f, 0.1f), UP, 0.75f);
  add_end(&m, 2, olx_v3(2.3f, 0.0f, 0.0f), UP, 0.5f);                        // too far
  add_end(&m, 3, olx_v3(2.05f, 0.0f, 0.0f), olx_v3(1.0f, 0.0f, 0.0f), 0.5f); // another side
  add_end(&m, 4, olx_v3(2.0f, 0.15f, 0.0f), UP, 0.5f);                       // a step above
  add_end(&m, 5, olx_v3(2.25f, 0.0f, 0.0f), UP, 0.25f);                      // nearer to the third
  m.rays[6] = 17;
  m.rays[7] = OLX_FIT_RAY_SKY;
  merge(&m, 8, MOST);
  const uint32_t expected[8] = {FIRST, FIRST, FIRST + 1, FIRST + 2, FIRST + 3, FIRST + 1, 17, OLX_FIT_RAY_SKY};
  assert_memory_equal(m.rays, expected, sizeof expected);
  assert_memory_equal(&m.surfaces[0].position, &m.ends[0].position, sizeof(olx_vec3));
  assert_int_equal(m.surfaces[0].normal, olx_normal_pack(UP));
  assert_int_equal(m.surfaces[0].albedo, olx_r11g11b10f_pack(olx_splat(0.5f)));
  assert_int_equal(m.surfaces[1].albedo, olx_r11g11b10f_pack(olx_splat(0.375f)));
  for (uint32_t i = 4; i < MOST; i++) assert_int_equal(m.surfaces[i].normal, OLX_FIT_NO_POINT);
}

static void ends_at_the_probe_are_surfaces_too(void **unused) {
  (void)unused;
  merged m;
  for (uint32_t i = 0; i < 40; i++) add_end(&m, i, olx_v3(0.0f, 0.0f, 1e-4f * (float)i), UP, 0.5f);
  merge(&m, 40, 2);
  for (uint32_t i = 0; i < 40; i++) assert_true(m.rays[i] == FIRST || m.rays[i] == FIRST + 1);
}

// A floor of 6 x 6 m, whose surfaces grow until places suffice.
static void surfaces_grow_until_they_fit(void **unused) {
  (void)unused;
  merged m;
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_vec2 at = olx_stratified2(i, 7);
    add_end(&m, i, olx_v3(6.0f * at.x - 3.0f, -2.0f, 6.0f * at.y - 3.0f), UP, 0.5f);
  }
  merge(&m, RAYS, MOST);
  uint32_t used = 0;
  for (uint32_t i = 0; i < MOST; i++) used += m.surfaces[i].normal != OLX_FIT_NO_POINT;
  assert_true(used > MOST / 3);
  for (uint32_t i = 0; i < RAYS; i++) {
    assert_true(m.rays[i] >= FIRST && m.rays[i] < FIRST + used);
    const olx_vec3 away = olx_sub(m.surfaces[m.rays[i] - FIRST].position, m.ends[i].position);
    assert_true(olx_length(away) < 3.0f); // of 36 square metres each of 24 would have 1.5
  }
}

// Normals all around are more surfaces than places, however large they are.
static void what_finds_no_place_stays_unknown(void **unused) {
  (void)unused;
  merged m;
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_vec3 normal = olx_sample_sphere(olx_stratified2(i, 3));
    add_end(&m, i, olx_scale(normal, 2.0f), normal, 0.5f);
  }
  merge(&m, RAYS, 3);
  uint32_t left = 0;
  for (uint32_t i = 0; i < RAYS; i++) {
    left += m.rays[i] == OLX_FIT_RAY_UNKNOWN;
    assert_true(m.rays[i] == OLX_FIT_RAY_UNKNOWN || (m.rays[i] >= FIRST && m.rays[i] < FIRST + 3));
  }
  assert_true(left > RAYS / 2 && left < RAYS);
  for (uint32_t i = 0; i < 3; i++) assert_true(m.surfaces[i].normal != OLX_FIT_NO_POINT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(near_ends_in_one_plane_are_one_surface),
      cmocka_unit_test(ends_at_the_probe_are_surfaces_too),
      cmocka_unit_test(surfaces_grow_until_they_fit),
      cmocka_unit_test(what_finds_no_place_stays_unknown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
