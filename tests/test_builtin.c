// Tests that the built-in scenes are closed where they should be, have their probes where they claim to, and are the
// same every time.
#include "core/hooks.h"
#include "core/sampling.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/emitters.h"
#include "scene/surface.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

typedef struct expectation {
  const char *name;
  bool closed;
  uint32_t cameras, lights, buried, probes[3];
  olx_vec3 low, high;
} expectation;

static const expectation expected[] = {
    {"cornell", false, 1, 1, 0, {2, 2, 2}, {0.0f, 0.0f, 0.0f}, {0.556f, 0.5488f, 0.5592f}},
    {"cornell-glossy", false, 1, 1, 0, {2, 2, 2}, {0.0f, 0.0f, 0.0f}, {0.556f, 0.5488f, 0.5592f}},
    {"furnace", true, 1, 1, 0, {2, 2, 2}, {-1.0f, -1.0f, -1.0f}, {1.0f, 1.0f, 1.0f}},
    {"two-rooms-sealed", true, 2, 1, 0, {4, 2, 2}, {-4.1f, 0.0f, -2.0f}, {4.1f, 3.0f, 2.0f}},
    {"two-rooms-gap", true, 3, 1, 0, {4, 2, 2}, {-4.1f, 0.0f, -2.0f}, {4.1f, 3.0f, 2.0f}},
    {"parlour", true, 2, 1, 0, {3, 2, 3}, {-2.0f, 0.0f, -2.5f}, {2.0f, 2.6f, 2.5f}},
    {"pillars", true, 2, 1, 3, {3, 2, 3}, {-3.0f, 0.0f, -3.0f}, {3.0f, 3.0f, 3.0f}},
    {"labyrinth", true, 3, 2, 0, {3, 2, 3}, {-4.0f, 0.0f, -4.0f}, {4.0f, 3.0f, 4.0f}},
    {"holodeck", true, 1, 1, 0, {1, 1, 1}, {-3.6f, 0.0f, -3.6f}, {3.6f, 3.5f, 3.6f}},
    {"area-light", true, 1, 1, 0, {4, 3, 4}, {-4.0f, 0.0f, -4.0f}, {4.0f, 4.0f, 4.0f}},
    {"temple", true, 5, 10, 0, {5, 3, 5}, {-10.0f, 0.0f, -10.0f}, {10.0f, 8.4f, 10.0f}},
    {"statue", false, 1, 1, 0, {2, 2, 2}, {-0.8f, 0.0f, -1.3f}, {0.8f, 2.56f, 0.45f}},
    {"flat", false, 3, 2, 0, {4, 2, 4}, {-3.3f, -0.25f, -2.6f}, {4.5f, 2.8f, 4.02f}},
};

#define SCENE_COUNT (sizeof expected / sizeof *expected)

static olx_scene *load(const char *name) {
  char full[64] = "builtin:";
  strcat(full, name);
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load(full, &scene), OLX_OK);
  return scene;
}

static olx_vec3 probe(const olx_grid *grid, uint32_t i) {
  const uint32_t x = i % grid->count[0], y = i / grid->count[0] % grid->count[1],
                 z = i / grid->count[0] / grid->count[1];
  return olx_add(grid->origin, olx_mul(grid->spacing, olx_v3((float)x, (float)y, (float)z)));
}

static uint32_t probe_count(const olx_grid *grid) { return grid->count[0] * grid->count[1] * grid->count[2]; }

// Returns whether a material is cloth, whose surfaces have no inside, so that both sides are seen.
static bool is_cloth(const olx_material *material) {
  const size_t length = strlen(material->name);
  return length > 6 && strcmp(material->name + length - 6, " cloth") == 0;
}

// Returns the share of directions in which the point sees a surface from behind.
static float back_face_share(const olx_scene *scene, olx_vec3 point) {
  const uint32_t n = 400;
  uint32_t behind = 0;
  for (uint32_t i = 0; i < n; i++) {
    const olx_ray ray = {point, olx_sample_sphere(olx_hammersley(i, n)), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    const olx_surface s = olx_surface_at(scene, &hit, ray.direction);
    behind += s.back_face && !is_cloth(&scene->materials[s.material]);
  }
  return (float)behind / (float)n;
}

static void names_are_listed_and_others_refused(void **state) {
  (void)state;
  for (uint32_t i = 0; i < SCENE_COUNT; i++) assert_string_equal(olx_builtin_name(i), expected[i].name);
  assert_null(olx_builtin_name(SCENE_COUNT));
  assert_null(olx_builtin_name(UINT32_MAX));
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load("builtin:atlantis", &scene), OLX_ERROR_ARGUMENT);
  assert_null(scene);
  assert_non_null(strstr(olx_last_error(), "atlantis"));
  assert_non_null(strstr(olx_last_error(), "two-rooms-sealed"));
}

static void scenes_hold_what_they_are_said_to_hold(void **state) {
  (void)state;
  for (uint32_t i = 0; i < SCENE_COUNT; i++) {
    const expectation *e = &expected[i];
    olx_scene *scene = load(e->name);
    const olx_scene_info info = olx_scene_describe(scene);
    assert_int_equal(info.warnings, 0);
    assert_int_equal(info.cameras, e->cameras);
    assert_int_equal(info.lights, e->lights);
    assert_true(info.has_probe_volume);
    assert_true(olx_length(olx_sub(info.bounds_min, e->low)) < 1e-5f);
    assert_true(olx_length(olx_sub(info.bounds_max, e->high)) < 1e-5f);
    olx_grid grid;
    assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
    assert_memory_equal(grid.count, e->probes, sizeof grid.count);
    assert_true(olx_emitters_group_count(scene) > 0);
    olx_scene_free(scene);
  }
}

static void hashes_are_the_same_every_time_and_differ_between_scenes(void **state) {
  (void)state;
  uint64_t hashes[SCENE_COUNT];
  for (uint32_t i = 0; i < SCENE_COUNT; i++) {
    olx_scene *first = load(expected[i].name), *second = load(expected[i].name);
    hashes[i] = olx_scene_describe(first).hash;
    assert_true(hashes[i] == olx_scene_describe(second).hash);
    for (uint32_t k = 0; k < i; k++) assert_true(hashes[k] != hashes[i]);
    olx_scene_free(first);
    olx_scene_free(second);
  }
}

static void exactly_the_expected_probes_are_inside_geometry(void **state) {
  (void)state;
  for (uint32_t i = 0; i < SCENE_COUNT; i++) {
    olx_scene *scene = load(expected[i].name);
    olx_grid grid;
    assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
    uint32_t buried = 0;
    for (uint32_t p = 0; p < probe_count(&grid); p++) {
      const float share = back_face_share(scene, probe(&grid, p));
      // Inside a solid nearly every surface is seen from behind; outside, only the open Cornell box and lights show
      // their backs.
      assert_true(share < 0.05f || share > 0.6f);
      buried += share > 0.6f;
    }
    assert_int_equal(buried, expected[i].buried);
    olx_scene_free(scene);
  }
}

static void the_buried_probes_of_the_pillars_are_those_of_the_figure(void **state) {
  (void)state;
  olx_scene *scene = load("pillars");
  olx_grid grid;
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  for (uint32_t p = 0; p < probe_count(&grid); p++) {
    const uint32_t x = p % 3, y = p / 3 % 2, z = p / 6;
    const bool center = x == 1 && z == 1, right = x == 2 && z == 0 && y == 0;
    assert_int_equal(back_face_share(scene, probe(&grid, p)) > 0.5f, center || right);
  }
  olx_scene_free(scene);
}

// Cameras of closed rooms are inside them and look at fronts of surfaces, and no reflection leads out or behind a
// surface.
static void light_stays_in_closed_rooms_and_on_the_fronts_of_surfaces(void **state) {
  (void)state;
  for (uint32_t i = 0; i < SCENE_COUNT; i++) {
    if (!expected[i].closed) continue;
    olx_scene *scene = load(expected[i].name);
    for (uint32_t c = 0; c < expected[i].cameras; c++) {
      const olx_camera camera = olx_scene_camera(scene, c);
      olx_ray ray = {camera.eye, olx_normalize(olx_sub(camera.target, camera.eye)), 0.0f, INFINITY};
      for (uint32_t step = 1; step <= 30000; step++) {
        const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
        if (hit.triangle == OLX_NO_HIT) fail_msg("%s: a ray escapes", expected[i].name);
        const olx_surface s = olx_surface_at(scene, &hit, ray.direction);
        const bool light_back = strncmp(scene->materials[s.material].name, "rectangle light", 15) == 0;
        if (s.back_face && !light_back && !is_cloth(&scene->materials[s.material]))
          fail_msg("%s: %s seen from behind at (%g, %g, %g)", expected[i].name, scene->materials[s.material].name,
                   (double)s.position.x, (double)s.position.y, (double)s.position.z);
        // The next ray starts a little before the surface, where the last ray has been: in a corner, rounding cannot
        // put it behind a wall.
        const olx_vec3 d = olx_sample_cosine(made_random(i * 8 + c, step));
        ray.origin = olx_madd(ray.origin, ray.direction, hit.t - olx_min(0.01f, 0.5f * hit.t));
        ray.direction = olx_from_basis(d, s.geometric_normal);
      }
    }
    olx_scene_free(scene);
  }
}

static void the_cornell_box_is_open_in_front_alone(void **state) {
  (void)state;
  olx_scene *scene = load("cornell");
  const olx_vec3 inside = {0.278f, 0.45f, 0.1f};
  for (uint32_t i = 0; i < 20000; i++) {
    const olx_vec3 d = olx_sample_sphere(made_random(1, i));
    const olx_ray ray = {inside, d, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_vec3 at_front = olx_madd(inside, d, -inside.z / d.z);
    const bool leaves = d.z < 0.0f && at_front.x > 0.0f && at_front.x < 0.5528f + 0.0032f * at_front.y / 0.5488f &&
                        at_front.y > 0.0f && at_front.y < 0.5488f;
    assert_int_equal(hit.triangle == OLX_NO_HIT, leaves);
  }
  // The red wall is on the left of the picture, the green one on the right, and the light above.
  const olx_ray left = {{0.278f, 0.4f, 0.3f}, {1.0f, 0.0f, 0.0f}, 0.0f, INFINITY};
  const olx_ray right = {{0.278f, 0.4f, 0.3f}, {-1.0f, 0.0f, 0.0f}, 0.0f, INFINITY};
  const olx_ray up = {{0.278f, 0.4f, 0.3f}, {0.0f, 1.0f, 0.0f}, 0.0f, INFINITY};
  const olx_ray_hit hits[3] = {olx_bvh_intersect(scene->bvh, &left), olx_bvh_intersect(scene->bvh, &right),
                               olx_bvh_intersect(scene->bvh, &up)};
  assert_true(olx_surface_at(scene, &hits[0], left.direction).bsdf.albedo.x == 0.63f);
  assert_true(olx_surface_at(scene, &hits[1], right.direction).bsdf.albedo.y == 0.45f);
  const olx_vec3 emission = olx_surface_at(scene, &hits[2], up.direction).emission;
  assert_true(emission.x == 17.0f && emission.y == 12.0f && emission.z == 4.0f);
  olx_scene_free(scene);
}

// Returns how many of n diffuse walks that begin on the lit room's side enter the other room.
static uint32_t walks_that_cross(const char *name) {
  olx_scene *scene = load(name);
  uint32_t crossed = 0;
  for (uint32_t w = 0; w < 2000; w++) {
    olx_ray ray = {{-2.0f, 1.5f, 0.0f}, olx_sample_sphere(made_random(w, 0)), 0.0f, INFINITY};
    for (uint32_t step = 1; step < 20; step++) {
      const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
      assert_true(hit.triangle != OLX_NO_HIT);
      const olx_surface s = olx_surface_at(scene, &hit, ray.direction);
      if (s.position.x > 0.14f) {
        crossed++;
        break;
      }
      ray = olx_surface_ray(&s, olx_from_basis(olx_sample_cosine(made_random(w, step)), s.geometric_normal), INFINITY);
    }
  }
  olx_scene_free(scene);
  return crossed;
}

static void light_crosses_the_gap_but_not_the_sealed_wall(void **state) {
  (void)state;
  assert_int_equal(walks_that_cross("two-rooms-sealed"), 0);
  assert_int_equal(walks_that_cross("two-rooms-sealed:0.03"), 0);
  const uint32_t usual = walks_that_cross("two-rooms-gap"), narrow = walks_that_cross("two-rooms-gap:0.2");
  assert_true(usual > 100);
  assert_int_equal(walks_that_cross("two-rooms-gap:0.8"), usual);
  assert_true(narrow > 0 && 2 * narrow < usual);
  assert_true(walks_that_cross("two-rooms-gap:3.9") > 2 * usual);
  olx_scene *scene = NULL;
  for (const char *const *name = (const char *const[]){"0", "4", "-1", "", "wide", "0.4m", "nan", NULL}; *name;
       name++) {
    char full[64];
    snprintf(full, sizeof full, "builtin:two-rooms-gap:%s", *name);
    assert_int_equal(olx_scene_load(full, &scene), OLX_ERROR_ARGUMENT);
    assert_non_null(strstr(olx_last_error(), "not within 0.01 to 3.99"));
  }
}

static void a_sealed_wall_may_be_thin_and_stands_off_the_middle(void **state) {
  (void)state;
  olx_scene *scene = load("two-rooms-sealed:0.03");
  const olx_ray there = {{-1.0f, 1.5f, -1.0f}, {1.0f, 0.0f, 0.0f}, 0.0f, INFINITY};
  const olx_ray back = {{1.0f, 1.5f, -1.0f}, {-1.0f, 0.0f, 0.0f}, 0.0f, INFINITY};
  assert_true(fabsf(olx_bvh_intersect(scene->bvh, &there).t - 1.137f) < 1e-5f);
  assert_true(fabsf(olx_bvh_intersect(scene->bvh, &back).t - 0.833f) < 1e-5f);
  olx_scene_free(scene);
  for (const char *const *name = (const char *const[]){"0", "1.1", "-1", "", "nan", NULL}; *name; name++) {
    char full[64];
    snprintf(full, sizeof full, "builtin:two-rooms-sealed:%s", *name);
    assert_int_equal(olx_scene_load(full, &scene), OLX_ERROR_ARGUMENT);
    assert_non_null(strstr(olx_last_error(), "not within 0.01 to 1"));
  }
}

static void the_wall_between_the_rooms_is_thick_and_stands_between_probe_columns(void **state) {
  (void)state;
  olx_scene *scene = load("two-rooms-sealed");
  const olx_ray ray = {{-1.0f, 1.5f, -1.0f}, {1.0f, 0.0f, 0.0f}, 0.0f, INFINITY};
  const olx_ray_hit near = olx_bvh_intersect(scene->bvh, &ray);
  assert_true(fabsf(near.t - 0.9f) < 1e-5f);
  const olx_ray back = {{1.0f, 1.5f, -1.0f}, {-1.0f, 0.0f, 0.0f}, 0.0f, INFINITY};
  assert_true(fabsf(olx_bvh_intersect(scene->bvh, &back).t - 0.9f) < 1e-5f);
  olx_grid grid;
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  assert_true(grid.origin.x + grid.spacing.x < -0.1f && grid.origin.x + 2.0f * grid.spacing.x > 0.1f);
  olx_scene_free(scene);
}

// With emission 1 and albedo one half everywhere, radiance sums to 2 along every path.
static void every_path_in_the_furnace_carries_two(void **state) {
  (void)state;
  olx_scene *scene = load("furnace");
  for (uint32_t w = 0; w < 500; w++) {
    olx_ray ray = {{0.8f, 0.5f, 0.9f}, olx_sample_sphere(made_random(w, 0)), 0.0f, INFINITY};
    float throughput = 1.0f, radiance = 0.0f;
    for (uint32_t step = 1; step < 30; step++) {
      const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
      assert_true(hit.triangle != OLX_NO_HIT);
      const olx_surface s = olx_surface_at(scene, &hit, ray.direction);
      radiance += throughput * s.emission.x;
      throughput *= s.bsdf.albedo.x;
      ray = olx_surface_ray(&s, olx_from_basis(olx_sample_cosine(made_random(w, step)), s.geometric_normal), INFINITY);
    }
    assert_true(fabsf(radiance - 2.0f) < 1e-5f);
  }
  olx_scene_free(scene);
}

// The hall is star-shaped, so its one probe sees every point of it.
static void the_probe_of_the_holodeck_sees_everything(void **state) {
  (void)state;
  olx_scene *scene = load("holodeck");
  olx_grid grid;
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    for (uint32_t i = 0; i < 50; i++) {
      const olx_vec2 uv = olx_sample_triangle(made_random(t, i));
      const olx_ray_hit hit = {.triangle = t, .u = uv.x, .v = uv.y};
      const uint32_t *index = scene->indices + 3 * (size_t)t;
      const olx_vec3 a = scene->positions[index[0]];
      const olx_surface s = olx_surface_at(scene, &hit, olx_sub(a, grid.origin));
      assert_false(s.back_face);
      const olx_ray ray = olx_surface_ray_to(&s, grid.origin, 0.0f);
      // The ceiling straight above the lamp is in its shadow.
      if (s.position.y > 3.49f && fabsf(s.position.x) < 0.8f && fabsf(s.position.z) < 0.8f) continue;
      assert_false(olx_bvh_occluded(scene->bvh, &ray));
    }
  }
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(names_are_listed_and_others_refused),
      cmocka_unit_test(scenes_hold_what_they_are_said_to_hold),
      cmocka_unit_test(hashes_are_the_same_every_time_and_differ_between_scenes),
      cmocka_unit_test(exactly_the_expected_probes_are_inside_geometry),
      cmocka_unit_test(the_buried_probes_of_the_pillars_are_those_of_the_figure),
      cmocka_unit_test(light_stays_in_closed_rooms_and_on_the_fronts_of_surfaces),
      cmocka_unit_test(the_cornell_box_is_open_in_front_alone),
      cmocka_unit_test(light_crosses_the_gap_but_not_the_sealed_wall),
      cmocka_unit_test(a_sealed_wall_may_be_thin_and_stands_off_the_middle),
      cmocka_unit_test(the_wall_between_the_rooms_is_thick_and_stands_between_probe_columns),
      cmocka_unit_test(every_path_in_the_furnace_carries_two),
      cmocka_unit_test(the_probe_of_the_holodeck_sees_everything),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
