// Tests which probes a bake finds to be inside geometry: those in pillars and blocks, and none for back faces alone.
#include "baked_field.h"
#include "field/texels.h"
#include "made_scenes.h"
#include "scene/scene_build.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

// Bakes a field of small maps with both kinds of probes on the same grid.
static olx_field *bake(const olx_scene *scene, olx_grid grid) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = settings.irradiance_grid = grid;
  settings.probe_light = true;
  settings.radiance_size = settings.irradiance_size = 8;
  settings.bounces = 0;
  settings.noise = 0.2f; // where there is light does not depend on it
  settings.threads = 2;
  olx_bake_stats stats;
  olx_field *field = baked_field(scene, &settings, &stats);
  const olx_field_info info = olx_field_describe(field);
  assert_int_equal(info.probes.buried, stats.buried);
  assert_int_equal(info.irradiance.buried, stats.irradiance_buried);
  return field;
}

static void buries(const olx_scene *scene, olx_grid grid, uint32_t count) {
  olx_field *field = bake(scene, grid);
  const olx_field_info info = olx_field_describe(field);
  assert_int_equal(info.probes.buried, count);
  assert_int_equal(info.irradiance.buried, count);
  olx_field_close(field);
}

static olx_scene *load(const char *name) {
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load(name, &scene), OLX_OK);
  return scene;
}

static uint32_t add_grey(olx_scene *scene) {
  olx_material material = olx_material_default();
  material.base_color = olx_splat(0.5f);
  material.metallic = 0.0f;
  material.roughness = 1.0f;
  material.emission = olx_splat(0.0f);
  return made_material(scene, &material);
}

// The grid has two probes along each axis of a room from -1 to 1.
static const olx_grid eight = {.origin = {-0.6f, -0.6f, -0.6f}, .spacing = {1.2f, 1.2f, 1.2f}, .count = {2, 2, 2}};

static void probes_in_pillars_are_found(void **state) {
  (void)state;
  olx_grid grid;
  olx_scene *scene = load("builtin:pillars");
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  assert_int_equal(grid.count[0] * grid.count[1] * grid.count[2], 18);
  buries(scene, grid, 3);
  olx_scene_free(scene);
  scene = load("builtin:cornell");
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  buries(scene, grid, 0);
  olx_scene_free(scene);
}

// The maps of buried probes are never read, so no rays are traced to gather light inside a pillar.
static void probes_in_pillars_hold_no_indirect_light(void **state) {
  (void)state;
  olx_grid grid;
  olx_scene *scene = load("builtin:pillars");
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  olx_field *field = bake(scene, grid);
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) {
    float most = 0.0f;
    for (size_t i = 0; i < field->texels; i++) most = olx_max(most, olx_max3(olx_texel_indirect(field, probe, i)));
    assert_true((most == 0.0f) == olx_field_probe_buried(field, probe));
  }
  olx_field_close(field);
  olx_scene_free(scene);
}

// Back faces alone bury no probe: tested in a room whose walls all face outwards, and before a sheet seen from behind.
static void odd_windings_bury_nobody(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const uint32_t material = add_grey(scene);
  made_box(scene, olx_splat(-1.0f), olx_splat(1.0f), true, material);
  made_finish(scene);
  buries(scene, eight, 0);
  olx_scene_free(scene);

  scene = made_scene();
  add_grey(scene);
  made_box(scene, olx_splat(-1.0f), olx_splat(1.0f), false, 0);
  // A curtain hangs close to half of the probes, which see mostly its back; its front faces the other half.
  const olx_vec3 corners[4] = {{-1, -1, -0.5f}, {1, -1, -0.5f}, {1, 1, -0.5f}, {-1, 1, -0.5f}};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  assert_int_equal(olx_scene_add_mesh(scene, "curtain", corners, NULL, NULL, 4, indices, 2, 0), OLX_OK);
  made_finish(scene);
  buries(scene, eight, 0);
  olx_scene_free(scene);
}

// A probe inside a block is buried, in rooms of either winding.
static void blocks_bury_in_any_room(void **state) {
  (void)state;
  for (uint32_t outward = 0; outward < 2; outward++) {
    olx_scene *scene = made_scene();
    add_grey(scene);
    made_box(scene, olx_splat(-1.0f), olx_splat(1.0f), outward, 0);
    made_box(scene, olx_v3(0.4f, 0.3f, 0.2f), olx_v3(0.9f, 0.8f, 0.7f), true, 0);
    made_finish(scene);
    olx_field *field = bake(scene, eight);
    const olx_field_info info = olx_field_describe(field);
    assert_int_equal(info.probes.buried, 1);
    assert_int_equal(info.irradiance.buried, 1);
    for (uint32_t i = 0; i < 8; i++) assert_int_equal(olx_field_probe_buried(field, i), i == 7);
    olx_field_close(field);
    olx_scene_free(scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(probes_in_pillars_are_found),
      cmocka_unit_test(probes_in_pillars_hold_no_indirect_light),
      cmocka_unit_test(odd_windings_bury_nobody),
      cmocka_unit_test(blocks_bury_in_any_room),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
