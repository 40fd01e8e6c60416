// Tests the look-up of wide specular lobes: surfaces are found where they are, and light is that of traced rays.
#include "analytic_field.h"
#include "baked_field.h"
#include "core/sampling.h"
#include "shade/wide_lobe.h"
#include "tiny_scenes.h"

static const analytic_scene room = {.room = {{-1, -1, -1}, {1, 1, 1}}};
static const olx_grid grid = {.origin = {-0.4f, -0.4f, -0.4f}, .spacing = {0.8f, 0.8f, 0.8f}, .count = {2, 2, 2}};

static float random_number(uint32_t a, uint32_t b) { return olx_unit_float(olx_hash2(a, b)); }

// Returns how far the point is from the nearest wall of the room.
static float off_walls(olx_vec3 p) { return fabsf(olx_max(olx_max(fabsf(p.x), fabsf(p.y)), fabsf(p.z)) - 1.0f); }

// Returns how far a point found in a texel may lie off the walls: beyond an edge of the room by the texel's extent on
// its plane, and along the ray by half a footprint's height over that plane. A texel is at most 1.5 times as wide as the
// mean one, and its diagonal 1.42 times as long as its side.
static float texel_reach(const olx_field *field, olx_vec3 direction, const olx_trace_hit *hit) {
  const olx_vec3 way = olx_normalize(olx_sub(hit->position, field->probe_positions[hit->probe]));
  return hit->footprint_metres *
         (1.5f * 1.42f / fabsf(olx_dot(way, hit->normal)) + 0.5f / fabsf(olx_dot(direction, hit->normal)));
}

// In an empty room, which every probe sees whole, the surface in any direction is found to within a texel.
static void expect_walls(const olx_field *field) {
  enum { RAYS = 2000 };
  uint32_t found = 0;
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_vec3 origin = {1.8f * random_number(i, 0) - 0.9f, 1.8f * random_number(i, 1) - 0.9f,
                             1.8f * random_number(i, 2) - 0.9f};
    const olx_vec3 direction = olx_octahedral_decode((olx_vec2){random_number(i, 3), random_number(i, 4)});
    const uint32_t probe = i % field->info.probes.count;
    olx_trace_hit hit;
    if (!olx_lobe_find(field, probe, origin, direction, 2.0f * random_number(i, 5), &hit)) continue;
    found++;
    assert_int_equal(hit.status, OLX_TRACE_HIT);
    assert_true(off_walls(hit.position) <= texel_reach(field, direction, &hit));
    assert_true(olx_length(olx_sub(hit.position, olx_madd(origin, direction, hit.distance_metres))) < 1e-4f);
  }
  assert_true(found >= RAYS * 95 / 100);
}

static void test_walls_of_a_room_are_found(void **state) {
  (void)state;
  olx_field *field = analytic_field_make(&room, &grid, 64, 16);
  expect_walls(field);
  analytic_field_block_geometry(field);
  expect_walls(field);
  analytic_field_free(field);
}

// What a box hides from a probe is not found through that probe.
static void test_a_point_behind_a_box_is_not_found(void **state) {
  (void)state;
  const analytic_scene with_box = {
      .room = {{-1, -1, -1}, {1, 1, 1}}, .box_count = 1, .boxes = {{{-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}}}};
  olx_field *field = analytic_field_make(&with_box, &grid, 64, 16);
  // The first probe is at (-0.4, -0.4, -0.4); the box covers the middle of the far corner.
  const olx_vec3 origin = {0.5f, 0.5f, 0.5f}, direction = olx_normalize(olx_v3(1.0f, 0.9f, 0.8f));
  olx_trace_hit hit;
  assert_false(olx_lobe_find(field, 0, origin, direction, 0.4f, &hit));
  assert_true(olx_lobe_find(field, (uint32_t)field->info.probes.count - 1, origin, direction, 0.4f, &hit));
  assert_true(off_walls(hit.position) <= texel_reach(field, direction, &hit));
  analytic_field_free(field);
}

static double glossy_mean(const olx_scene *scene, const olx_field *field, uint32_t rays, uint32_t reads) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = settings.height = 24;
  settings.spp = 4;
  settings.glossy_samples = rays;
  settings.lobe_reads = reads;
  const olx_camera camera = tiny_camera(olx_v3(0.5f, 0.3f, 0.6f), olx_v3(-0.4f, -0.6f, -0.5f), 70);
  olx_image image = tiny_render(scene, field, &camera, &settings);
  const double mean = tiny_mean(&image, OLX_LAYER_INDIRECT_GLOSSY);
  olx_image_free(&image);
  return mean;
}

// In a closed room of one material that emits evenly, light hardly varies, so that directions that are looked up bring
// what rays bring.
static void test_even_light_is_that_of_rays(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  olx_material walls = tiny_plastic(0.5f, 0.6f);
  walls.emission = olx_splat(1.0f);
  tiny_box(scene, &walls);
  scene = tiny_finish(scene);
  olx_bake_settings wanted = olx_bake_settings_default(scene);
  wanted.radiance_size = 32;
  wanted.bounces = 1;
  wanted.noise = 0.1f;
  olx_field *field = baked_field(scene, &wanted, NULL);
  const double traced = glossy_mean(scene, field, 64, 0), looked_up = glossy_mean(scene, field, 1, 64);
  assert_true(traced > 0.01);
  if (fabs(looked_up - traced) > 0.01 * traced) fail_msg("%g looked up, %g traced", looked_up, traced);
  olx_field_close(field);
  olx_scene_free(scene);
}

static void test_settings_out_of_range_are_refused(void **state) {
  (void)state;
  olx_scene *scene = tiny_furnace(0.5f, 1.0f);
  olx_bake_settings wanted = olx_bake_settings_default(scene);
  wanted.radiance_size = 16;
  wanted.bounces = 0;
  olx_field *field = baked_field(scene, &wanted, NULL);
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.lobe_reads = OLX_MOST_LOBE_READS + 1;
  const olx_camera camera = tiny_camera(olx_v3(0.5f, 0.3f, 0.6f), olx_v3(-0.4f, -0.6f, -0.5f), 70);
  olx_image image;
  assert_int_equal(olx_render(scene, field, &camera, &settings, NULL, &image, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "directions of a lobe"));
  olx_field_close(field);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_walls_of_a_room_are_found),
      cmocka_unit_test(test_a_point_behind_a_box_is_not_found),
      cmocka_unit_test(test_even_light_is_that_of_rays),
      cmocka_unit_test(test_settings_out_of_range_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
