// Measures exported irradiance volumes as an engine shows them, fitted and plain: on surfaces that probes see, for
// objects in free space, and behind a wall (docs/exporting.md has the table). The living room is looked for in
// OCTALUX_SCENES, or in ../shared/scenes.
#include "baked_field.h"
#include "engine_cubes.h"
#include "scene_files.h"
#include "tiny_scenes.h"

enum { SURFACE_TRIES = 120000, SPACE_TRIES = 40000 };

typedef struct place {
  olx_scene *scene;
  olx_field *field;
  lit_points surfaces, space;
} place;

static place make_place(const char *name, uint32_t radiance_size, const uint32_t grid[3]) {
  place p = {.scene = NULL};
  ASSERT_OK(olx_scene_load(name, &p.scene));
  olx_bake_settings settings = olx_bake_settings_default(p.scene);
  settings.radiance_size = radiance_size;
  if (grid) memcpy(settings.grid.count, grid, sizeof settings.grid.count);
  p.field = baked_field(p.scene, &settings, NULL);
  p.surfaces = lit_surfaces(p.scene, p.field, SURFACE_TRIES);
  p.space = lit_space(p.field, SPACE_TRIES);
  assert_true(p.surfaces.count > 10000 && p.space.count > 10000);
  return p;
}

static void leave_place(place *p) {
  lit_points_free(&p->surfaces);
  lit_points_free(&p->space);
  olx_field_close(p->field);
  olx_scene_free(p->scene);
}

typedef struct measured {
  double surfaces, space;
  engine_volume volume;
} measured;

static measured measure(const place *p, const olx_cubes_settings *settings, olx_cubes_info *info) {
  scene_folder folder;
  char path[300];
  assert_true(scene_folder_create(&folder));
  snprintf(path, sizeof path, "%s/volume.ktx2", folder.path);
  ASSERT_OK(olx_export_ktx2(p->field, settings, path, NULL, info));
  measured m = {.volume = engine_volume_load(path)};
  m.surfaces = engine_error(&m.volume, &p->surfaces);
  m.space = engine_error(&m.volume, &p->space);
  scene_folder_remove(&folder);
  return m;
}

// Returns the mean light of surfaces of the room without a lamp over that of the room with one.
static double light_behind_wall(const place *p, const engine_volume *volume) {
  double sums[2] = {0.0, 0.0};
  uint32_t counts[2] = {0, 0};
  for (uint32_t i = 0; i < p->surfaces.count; i++) {
    const bool dark = p->surfaces.positions[i].x > 0.0f;
    sums[dark] += (double)engine_light(volume, p->surfaces.positions[i], p->surfaces.normals[i]).y;
    counts[dark]++;
  }
  assert_true(counts[0] > 1000 && counts[1] > 1000);
  return sums[1] / counts[1] / (sums[0] / counts[0]);
}

// Prints a row of the table: surfaces and free space, plain and fitted, of both files.
static void compare(const place *p, float spacing_metres, bool has_wall) {
  olx_cubes_settings settings = olx_cubes_settings_default();
  settings.spacing_metres = spacing_metres;
  olx_cubes_info info;
  measured fitted = measure(p, &settings, &info);
  settings.fit = false;
  measured plain = measure(p, &settings, NULL);
  print_message("| %ux%ux%u | %.4f | %.4f | %.4f | %.4f |", info.size[0], info.size[1], info.size[2], plain.surfaces,
                fitted.surfaces, plain.space, fitted.space);
  if (has_wall) {
    const double leak = light_behind_wall(p, &fitted.volume), before = light_behind_wall(p, &plain.volume);
    print_message(" %.4f | %.4f |", before, leak);
    assert_true(leak < 0.04);
  }
  print_message("\n");
  // At best a thirtieth; with voxels of 1 m in the living room 0.506.
  assert_true(fitted.surfaces <= 0.52 * plain.surfaces && fitted.space <= plain.space + 0.01);
  engine_volume_free(&fitted.volume);
  engine_volume_free(&plain.volume);
}

static void sealed_rooms(void **state) {
  (void)state;
  place p = make_place("builtin:two-rooms-sealed", 64, NULL);
  compare(&p, 1.0f, true);
  compare(&p, 0.5f, true);
  compare(&p, 0.0f, true);
  compare(&p, 0.1f, true); // half the wall's thickness
  leave_place(&p);
}

static void the_living_room(void **state) {
  (void)state;
  static const uint32_t grid[3] = {2, 2, 2};
  static const char name[] = OLX_SOURCE_DIR "/scenes/living-room.json";
  setenv("OCTALUX_SCENES", OLX_SOURCE_DIR "/../shared/scenes", 0);
  olx_scene *scene;
  if (olx_scene_load(name, &scene) != OLX_OK) skip();
  olx_scene_free(scene);
  place p = make_place(name, 128, grid);
  compare(&p, 1.0f, false);
  compare(&p, 0.5f, false);
  compare(&p, 0.0f, false);
  leave_place(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sealed_rooms), cmocka_unit_test(the_living_room)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
