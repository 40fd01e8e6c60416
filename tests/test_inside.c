// Tests which points are inside geometry: placement and baking agree on it, and probes can be placed in every scene in
// which a grid can be baked.
#include "baked_field.h"
#include "field/field_data.h"
#include "scene_files.h"
#include "tiny_scenes.h"

#include <octalux/bake.h>
#include <octalux/place.h>

// Makes a closed box of two metres, its faces wound to be seen from outside, or from inside.
static olx_scene *closed_box(const scene_folder *folder, bool outwards, const char *more) {
  const char *faces = outwards ? "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
                               : "f 3 4 2 1\nf 6 8 7 5\nf 2 6 5 1\nf 7 8 4 3\nf 5 7 3 1\nf 4 8 6 2\n";
  char text[1024];
  snprintf(text, sizeof text, "v -1 -1 -1\nv -1 -1 1\nv -1 1 -1\nv -1 1 1\nv 1 -1 -1\nv 1 -1 1\nv 1 1 -1\nv 1 1 1\n%s",
           faces);
  (void)scene_folder_write_text(folder, "box.obj", text);
  snprintf(text, sizeof text, "{\"model\": \"box.obj\", \"environment\": {\"radiance\": [1, 1, 1]}%s}", more);
  olx_scene *scene = NULL;
  ASSERT_OK(olx_scene_load(scene_folder_write_text(folder, "box.json", text), &scene));
  return scene;
}

static olx_bake_settings tiny_bake(const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = settings.irradiance_size = 8;
  settings.samples = 1;
  settings.bounces = 0;
  settings.light = OLX_LIGHT_REFERENCE; // light does not matter here, so the cheapest solver will do
  settings.reference_paths = 1;
  settings.fit = false;
  return settings;
}

// Bakes the placed probes, and asserts that bake and placement agree on each probe whether it is free.
static uint32_t assert_same_probes_free(const olx_scene *scene, const olx_probe_set *set, olx_grid irradiance_grid) {
  olx_vec3 *positions = olx_allocate(set->count, sizeof *positions);
  for (uint32_t i = 0; i < set->count; i++) positions[i] = set->probes[i].position;
  olx_bake_settings settings = tiny_bake(scene);
  settings.probes = positions;
  settings.probe_count = set->count;
  settings.irradiance_grid = irradiance_grid;
  olx_field *field = baked_field(scene, &settings, NULL);
  uint32_t buried = 0;
  for (uint32_t i = 0; i < set->count; i++) {
    assert_int_equal(olx_field_probe_buried(field, i), set->probes[i].buried);
    buried += set->probes[i].buried;
  }
  olx_field_close(field);
  olx_release(positions);
  return buried;
}

static olx_place_settings quick_place(const olx_scene *scene) {
  olx_place_settings settings = olx_place_settings_default(scene);
  settings.voxels = 32;
  settings.surfels = 512;
  settings.candidates = 64;
  settings.count = 4;
  return settings;
}

static void a_closed_box_is_placed_in_however_it_is_wound(void **state) {
  for (int outwards = 0; outwards < 2; outwards++) {
    olx_scene *scene = closed_box(*state, outwards, "");
    const olx_place_settings settings = quick_place(scene);
    olx_probe_set set;
    ASSERT_OK(olx_place(scene, &settings, NULL, &set));
    assert_true(set.count > 0);
    assert_int_equal(assert_same_probes_free(scene, &set, tiny_bake(scene).irradiance_grid), 0);
    olx_probe_set_free(&set);
    olx_scene_free(scene);
  }
}

// Irradiance probes outside the walls must not decide whether probes inside, where the camera is, are buried.
static void probes_elsewhere_bury_none(void **state) {
  olx_scene *scene = closed_box(*state, true, ", \"cameras\": [{\"eye\": [0, 0, 0.5], \"target\": [0, 0, -1]}]");
  const olx_place_settings settings = quick_place(scene);
  olx_probe_set set;
  ASSERT_OK(olx_place(scene, &settings, NULL, &set));
  const olx_grid around = {.origin = {-3.0f, 0.0f, 0.0f}, .spacing = {3.0f, 0.0f, 0.0f}, .count = {3, 1, 1}};
  assert_int_equal(assert_same_probes_free(scene, &set, around), 0);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// Makes a room whose wall has a hole, within a closed hull: the space between them is behind surfaces although it sees
// no sky.
static olx_scene *room_in_a_hull(const scene_folder *folder) {
  (void)scene_folder_write_text(
      folder, "hull.obj",
      "v -1 -1 -1\nv -1 -1 1\nv -1 1 -1\nv -1 1 1\nv 1 -1 -1\nv 1 -1 1\nv 1 1 -1\nv 1 1 1\n"
      "v 1 -0.3 -0.3\nv 1 -0.3 0.3\nv 1 0.3 -0.3\nv 1 0.3 0.3\n"
      "f 3 4 2 1\nf 2 6 5 1\nf 7 8 4 3\nf 5 7 3 1\nf 4 8 6 2\nf 6 8 12 10\nf 8 7 11 12\nf 7 5 9 11\nf 5 6 10 9\n"
      "v -2 -2 -2\nv -2 -2 2\nv -2 2 -2\nv -2 2 2\nv 2 -2 -2\nv 2 -2 2\nv 2 2 -2\nv 2 2 2\n"
      "f 13 14 16 15\nf 17 19 20 18\nf 13 17 18 14\nf 15 16 20 19\nf 13 15 19 17\nf 14 18 20 16\n");
  const char *text = "{\"model\": \"hull.obj\", \"environment\": {\"radiance\": [1, 1, 1]},"
                     " \"cameras\": [{\"eye\": [0, 0, 0.5], \"target\": [0, 0, -1]}]}";
  olx_scene *scene = NULL;
  ASSERT_OK(olx_scene_load(scene_folder_write_text(folder, "hull.json", text), &scene));
  return scene;
}

static void space_behind_walls_gets_no_probes(void **state) {
  olx_scene *scene = room_in_a_hull(*state);
  olx_place_settings settings = olx_place_settings_default(scene);
  settings.voxels = 64;
  settings.surfels = 2048;
  settings.candidates = 256;
  settings.resolution = 256;
  olx_probe_set set;
  ASSERT_OK(olx_place(scene, &settings, NULL, &set));
  assert_true(set.report.coverage > 0.99);
  assert_true(set.count <= 4);
  for (uint32_t i = 0; i < set.count; i++) {
    const olx_vec3 p = set.probes[i].position;
    assert_true(fabsf(p.x) < 1.1f && fabsf(p.y) < 1.0f && fabsf(p.z) < 1.0f);
  }
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// Asserts that placement and baking find the same probes of a grid over a whole scene to be inside solids.
static void assert_grid_agrees(const char *name, const uint32_t counts[3], bool some) {
  olx_scene *scene = NULL;
  ASSERT_OK(olx_scene_load(name, &scene));
  olx_place_settings settings = olx_place_settings_default(scene);
  settings.method = OLX_PLACE_GRID;
  settings.voxels = 48;
  settings.surfels = 512;
  ASSERT_OK(olx_scene_probe_grid(scene, counts, &settings.grid));
  olx_probe_set set;
  ASSERT_OK(olx_place(scene, &settings, NULL, &set));
  const uint32_t buried = assert_same_probes_free(scene, &set, settings.grid);
  assert_true(buried > 0 || !some);
  assert_true(buried < set.count);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

static void placing_and_baking_agree_in_built_in_scenes(void **state) {
  (void)state;
  assert_grid_agrees("builtin:pillars", NULL, true);
  assert_grid_agrees("builtin:temple", (const uint32_t[3]){6, 4, 6}, false);
}

static void placing_and_baking_agree_in_an_apartment(void **state) {
  (void)state;
  char folder[512];
  if (!scene_files_real("small-house", folder, sizeof folder)) skip();
  folder[strlen(folder) - strlen("/small-house")] = 0;
  setenv("OCTALUX_SCENES", folder, 1);
  assert_grid_agrees(OLX_SOURCE_DIR "/scenes/small-house.json", (const uint32_t[3]){5, 3, 5}, false);
}

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_set_up, scene_folder_tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(a_closed_box_is_placed_in_however_it_is_wound),
      WITH_FOLDER(probes_elsewhere_bury_none),
      WITH_FOLDER(space_behind_walls_gets_no_probes),
      cmocka_unit_test(placing_and_baking_agree_in_built_in_scenes),
      cmocka_unit_test(placing_and_baking_agree_in_an_apartment),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
