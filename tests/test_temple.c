// Tests that the temple has the features it was built for: galleries to walk on, stairs to climb and to go under, round
// pillars, decorated walls, glossy materials, lamps, and cloth with two sides.
#include "core/sampling.h"
#include "made_scenes.h"
#include "place_fixtures.h"
#include "scene/bvh.h"
#include "scene/surface.h"

#include <octalux/place.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

typedef struct sight {
  float distance;
  olx_vec3 position;
  const char *material;
  olx_surface surface;
} sight;

static int load_temple(void **state) {
  olx_scene *temple;
  if (olx_scene_load("builtin:temple", &temple) != OLX_OK) return 1;
  *state = temple;
  return 0;
}

static int free_temple(void **state) {
  olx_scene_free(*state);
  return 0;
}

static sight look(const olx_scene *temple, olx_vec3 from, olx_vec3 direction) {
  const olx_ray ray = {from, olx_normalize(direction), 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(temple->bvh, &ray);
  if (hit.triangle == OLX_NO_HIT)
    fail_msg("a ray from (%g, %g, %g) leads out", (double)from.x, (double)from.y, (double)from.z);
  const olx_surface s = olx_surface_at(temple, &hit, ray.direction);
  return (sight){hit.t, s.position, temple->materials[s.material].name, s};
}

static bool sees(const olx_scene *temple, olx_vec3 a, olx_vec3 b) {
  const olx_vec3 way = olx_sub(b, a);
  return look(temple, a, way).distance > olx_length(way);
}

// Returns the position mirrored into one of the hall's four quarters.
static olx_vec3 mirrored(uint32_t quarter, float x, float y, float z) {
  return olx_v3(quarter & 1 ? -x : x, y, quarter & 2 ? -z : z);
}

static const olx_vec3 down = {0.0f, -1.0f, 0.0f}, up = {0.0f, 1.0f, 0.0f};

// From every position that a visitor can reach, rays in all directions end on a surface.
static void no_ray_leads_out(void **state) {
  const olx_scene *temple = *state;
  const olx_vec3 places[] = {{0.0f, 1.7f, 0.0f},  {8.8f, 4.6f, 9.2f},  {-8.8f, 4.6f, 0.0f}, {6.5f, 0.8f, 5.0f},
                             {9.0f, 1.5f, -9.5f}, {-5.0f, 3.0f, 5.0f}, {0.0f, 8.3f, 9.0f},  {9.2f, 7.9f, -9.5f}};
  for (uint32_t p = 0; p < sizeof places / sizeof *places; p++) {
    for (uint32_t i = 0; i < 20000; i++) {
      const sight s = look(temple, places[p], olx_sample_sphere(olx_hammersley(i, 20000)));
      assert_true(!s.surface.back_face || strstr(s.material, " cloth"));
    }
  }
}

// On the galleries there is floor below, more than two metres of air above, and a parapet between 0.5 and 1.2 m high.
static void one_can_stand_on_the_galleries(void **state) {
  const olx_scene *temple = *state;
  for (uint32_t q = 0; q < 4; q++) {
    for (float z = 0.3f; z < 9.8f; z += 0.5f) {
      const olx_vec3 head = mirrored(q, 8.9f, 4.7f, z);
      const sight floor = look(temple, head, down);
      assert_true(fabsf(floor.position.y - 3.0f) < 1e-5f);
      assert_string_equal(floor.material, "gallery floor");
      assert_true(look(temple, head, up).position.y > 8.0f);
    }
    for (float z = 0.3f; z < 9.8f; z += 0.5f) {
      if (z > 2.0f && z < 8.7f) continue; // the stairs and the pillars are here
      const olx_vec3 inward = mirrored(q, -1.0f, 0.0f, 0.0f);
      assert_true(fabsf(look(temple, mirrored(q, 8.5f, 3.5f, z), inward).position.x) > 7.4f);
      assert_true(fabsf(look(temple, mirrored(q, 8.5f, 4.2f, z), inward).position.x) < 7.0f ||
                  look(temple, mirrored(q, 8.5f, 4.2f, z), inward).distance > 10.0f);
    }
  }
}

static void fifteen_steps_lead_to_each_gallery(void **state) {
  const olx_scene *temple = *state;
  for (uint32_t q = 0; q < 4; q++) {
    for (uint32_t step = 0; step < 15; step++) {
      const float x = 3.5f + 0.26f * ((float)step + 0.5f), height = 0.2f * (float)(step + 1);
      const sight tread = look(temple, mirrored(q, x, height + 1.9f, 5.0f), down);
      assert_true(fabsf(tread.position.y - height) < 1e-5f);
      assert_string_equal(tread.material, "stair stone");
      const sight riser = look(temple, mirrored(q, x - 0.26f, height - 0.1f, 5.0f), mirrored(q, 1.0f, 0.0f, 0.0f));
      assert_true(fabsf(fabsf(riser.position.x) - (3.5f + 0.26f * (float)step)) < 1e-5f);
    }
    // The way leads from the corridor up the stairs and through the arch onto the gallery.
    assert_true(sees(temple, mirrored(q, 0.0f, 1.7f, 5.0f), mirrored(q, 5.0f, 2.9f, 5.0f)));
    assert_true(sees(temple, mirrored(q, 5.0f, 2.9f, 5.0f), mirrored(q, 8.8f, 4.7f, 5.0f)));
  }
}

// Under a flight of stairs the slab rises towards the gallery, and a way leads out between the flights and at the
// hall's end.
static void one_can_go_under_the_stairs(void **state) {
  const olx_scene *temple = *state;
  for (uint32_t q = 0; q < 4; q++) {
    for (float x = 4.5f; x < 7.3f; x += 0.4f) {
      for (float z = 2.7f; z < 8.2f; z += 0.5f) {
        const olx_vec3 place = mirrored(q, x, 0.3f, z);
        const float clear = (x - 7.4f) * 0.2f / 0.26f + 2.75f;
        assert_true(fabsf(look(temple, place, up).position.y - clear) < 1e-3f);
        assert_true(look(temple, place, down).position.y == 0.0f);
        assert_true(sees(temple, place, mirrored(q, x, 0.3f, 0.5f)));
        assert_true(sees(temple, place, mirrored(q, x, 0.3f, 9.5f)));
      }
    }
    assert_true(sees(temple, mirrored(q, 6.5f, 1.2f, 0.2f), mirrored(q, 0.0f, 1.2f, 0.2f)));
    assert_true(sees(temple, mirrored(q, 6.5f, 1.2f, 9.5f), mirrored(q, 1.5f, 1.2f, 9.5f)));
    assert_true(sees(temple, mirrored(q, 6.5f, 1.2f, 5.0f), mirrored(q, 9.5f, 1.2f, 5.0f)));
  }
}

// There are two rows of pillars on each side: points around each shaft are on one circle, and its shading normals point
// away from the axis.
static void the_pillars_of_both_rows_are_round(void **state) {
  const olx_scene *temple = *state;
  const float rows[2] = {2.7f, 7.75f}, heights[2] = {4.0f, 6.0f}, along[2] = {2.5f, 7.5f};
  for (uint32_t i = 0; i < 16; i++) {
    const uint32_t row = i >> 2 & 1;
    const olx_vec3 axis = mirrored(i, rows[row], heights[row], along[i >> 3]);
    float least = INFINITY, most = 0.0f;
    for (uint32_t k = 0; k < 64; k++) {
      const float phi = 2.0f * OLX_PI * ((float)k + 0.3f) / 64.0f;
      const olx_vec3 out = olx_v3(cosf(phi), 0.0f, sinf(phi));
      // Directions in which the arcades' walls join the upper pillars are left out.
      if (row == 1 && fabsf(out.z) > 0.7f) continue;
      const sight s = look(temple, olx_madd(axis, out, 0.9f), olx_scale(out, -1.0f));
      assert_non_null(strstr(s.material, " pillar"));
      const float radius = 0.9f - s.distance;
      least = olx_min(least, radius);
      most = olx_max(most, radius);
      const olx_vec3 flat = olx_normalize(olx_v3(s.surface.shading_normal.x, 0.0f, s.surface.shading_normal.z));
      assert_true(olx_dot(flat, out) > 0.9999f);
    }
    assert_true(least > 0.2f && most - least < 0.006f * most);
  }
}

// Along the walls between the pillars depths differ, because of arches, pilasters and panels.
static void the_walls_are_decorated(void **state) {
  const olx_scene *temple = *state;
  const struct {
    olx_vec3 from, direction;
  } walls[] = {{{8.7f, 1.2f, 0.0f}, {1.0f, 0.0f, 0.0f}},
               {{8.7f, 4.5f, 0.0f}, {1.0f, 0.0f, 0.0f}},
               {{5.5f, 5.0f, 0.0f}, {1.0f, 0.0f, 0.0f}},
               {{8.7f, 5.0f, 0.0f}, {-1.0f, 0.0f, 0.0f}}};
  for (uint32_t q = 0; q < 4; q++) {
    for (uint32_t w = 0; w < 4; w++) {
      uint32_t steps = 0;
      float before = -1.0f;
      for (float z = 0.0f; z < 9.8f; z += 0.02f) {
        const olx_vec3 from = mirrored(q, walls[w].from.x, walls[w].from.y, z);
        const float distance = look(temple, from, mirrored(q, walls[w].direction.x, 0.0f, 0.0f)).distance;
        steps += before >= 0.0f && fabsf(distance - before) > 0.04f;
        before = distance;
      }
      assert_true(steps >= 8);
    }
  }
}

static void materials_are_glossy_in_many_ways_and_lamps_are_many(void **state) {
  const olx_scene *temple = *state;
  uint32_t glossy = 0, metals = 0;
  float smoothest = 1.0f, roughest = 0.0f;
  for (uint32_t m = 0; m < temple->material_count; m++) {
    const olx_material *material = &temple->materials[m];
    if (material->specular_weight == 0.0f) continue;
    glossy++;
    metals += material->metallic == 1.0f;
    smoothest = olx_min(smoothest, material->roughness);
    roughest = olx_max(roughest, material->roughness);
  }
  assert_true(glossy >= 10 && metals >= 2 && smoothest < 0.15f && roughest > 0.6f);
  assert_true(olx_scene_describe(temple).lights >= 8);
  assert_true(temple->triangle_count >= 10000 && temple->triangle_count <= 60000);
}

// Rays from both sides meet a banner at the same point, one at its front and one at its back.
static void cloth_has_two_sides_and_no_thickness(void **state) {
  const olx_scene *temple = *state;
  for (uint32_t q = 0; q < 4; q++) {
    for (float z = 4.3f; z < 5.8f; z += 0.25f) {
      const olx_vec3 inner = mirrored(q, 1.5f, 5.5f, z), outer = mirrored(q, 4.0f, 5.5f, z);
      const sight a = look(temple, inner, olx_sub(outer, inner)), b = look(temple, outer, olx_sub(inner, outer));
      assert_non_null(strstr(a.material, " cloth"));
      assert_string_equal(a.material, b.material);
      assert_true(olx_length(olx_sub(a.position, b.position)) < 1e-4f);
      assert_true(a.surface.back_face != b.surface.back_face);
      assert_true(olx_dot(a.surface.shading_normal, b.surface.shading_normal) < -0.99f);
    }
  }
}

// Returns the share of points on the undersides of all four flights of stairs that some probe sees.
static float share_seen_under_stairs(const olx_scene *temple, const olx_probe_set *set) {
  enum { POINTS = 4000 };
  uint32_t seen = 0;
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec2 u = olx_hammersley(i, POINTS);
    const sight slab = look(temple, mirrored(i, 4.2f + 3.1f * u.x, 0.05f, 2.6f + 5.6f * u.y), up);
    const olx_vec3 point = olx_madd(slab.position, up, -0.002f);
    bool found = false;
    for (uint32_t p = 0; p < set->count && !found; p++) {
      const olx_vec3 probe = set->probes[p].position;
      found = olx_dot(olx_sub(probe, point), slab.surface.geometric_normal) > 0.0f && sees(temple, point, probe);
    }
    seen += found;
  }
  return (float)seen / POINTS;
}

static void placed_probes_see_beneath_the_stairs_as_all_else(void **state) {
  const olx_scene *temple = *state;
  olx_place_settings settings = quick_settings(temple, OLX_PLACE_COVER);
  settings.voxels = 120;
  settings.surfels = 8000;
  settings.candidates = 1000;
  settings.coverage = 0.998f;
  olx_probe_set set = place(temple, &settings);
  print_message("%u probes see %.3f %%, and %.3f %% under the stairs\n", set.count, 100.0 * set.report.coverage,
                100.0 * (double)share_seen_under_stairs(temple, &set));
  assert_true(set.report.coverage > 0.995);
  assert_true(share_seen_under_stairs(temple, &set) > 0.99f);
  assert_int_equal(set.report.buried, 0);
  olx_probe_set_free(&set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_ray_leads_out),
      cmocka_unit_test(one_can_stand_on_the_galleries),
      cmocka_unit_test(fifteen_steps_lead_to_each_gallery),
      cmocka_unit_test(one_can_go_under_the_stairs),
      cmocka_unit_test(the_pillars_of_both_rows_are_round),
      cmocka_unit_test(the_walls_are_decorated),
      cmocka_unit_test(materials_are_glossy_in_many_ways_and_lamps_are_many),
      cmocka_unit_test(cloth_has_two_sides_and_no_thickness),
      cmocka_unit_test(placed_probes_see_beneath_the_stairs_as_all_else),
  };
  return cmocka_run_group_tests(tests, load_temple, free_temple);
}
