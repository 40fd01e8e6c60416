// Tests irradiance volumes for other engines, by a loader and a look-up made from the engine's description: light of
// each side lies where it is looked up, fitted voxels keep rooms apart, bytes are the same at any number of threads.
#include "baked_field.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "engine_cubes.h"
#include "field/field_data.h"
#include "scene_files.h"
#include "synthetic_field.h"
#include "tiny_scenes.h"

#include <unistd.h>

enum { PLACES = 4000 };

// Two rooms with a wall between them; the lamp is in one.
typedef struct rooms {
  olx_scene *scene;
  olx_field *field;
  scene_folder folder;
  char path[300];
} rooms;

static int build_rooms(void **state) {
  static rooms r;
  ASSERT_OK(olx_scene_load("builtin:two-rooms-sealed", &r.scene));
  olx_bake_settings settings = olx_bake_settings_default(r.scene);
  settings.radiance_size = 32;
  settings.noise = 0.05f;
  r.field = baked_field(r.scene, &settings, NULL);
  assert_true(scene_folder_create(&r.folder));
  snprintf(r.path, sizeof r.path, "%s/volume.ktx2", r.folder.path);
  *state = &r;
  return 0;
}

static int leave_rooms(void **state) {
  rooms *r = *state;
  scene_folder_remove(&r->folder);
  olx_field_close(r->field);
  olx_scene_free(r->scene);
  return 0;
}

static engine_volume written(const rooms *r, const olx_cubes_settings *settings, olx_cubes_info *info) {
  ASSERT_OK(olx_export_ktx2(r->field, settings, r->path, NULL, info));
  return engine_volume_load(r->path);
}

// A volume of one cell around a scene, with probes at its corners, so that light between them is linear. It may be cut
// at x = `split.offset`: then space in front of that is not free.
typedef struct one_cell {
  olx_volume_header header;
  uint32_t index;
  olx_volume_cell cell;
  olx_volume_split split;
  olx_vec3 positions[OLX_VOLUME_CORNERS];
  uint16_t irradiance[OLX_VOLUME_CORNERS * OLX_VOLUME_HALVES];
} one_cell;

// The light of a volume at a place, as coefficients of harmonics.
typedef void (*place_light)(olx_vec3 position, olx_vec3 coefficients[OLX_HARMONICS_MOST]);

static one_cell make_cell(place_light light) {
  one_cell c = {.header = {.origin = {-8, -8, -8}, .cube_metres = 16, .size = {1, 1, 1}, .cells = 1, .probes = 8},
                .index = OLX_VOLUME_CELL};
  for (uint32_t i = 0; i < OLX_VOLUME_CORNERS; i++) {
    olx_vec3 coefficients[OLX_HARMONICS_MOST] = {{0}};
    c.cell.probes[i] = i;
    c.positions[i] = olx_v3(i & 1 ? 8 : -8, i & 2 ? 8 : -8, i & 4 ? 8 : -8);
    light(c.positions[i], coefficients);
    olx_harmonics_pack(coefficients, OLX_VOLUME_BANDS, c.irradiance + (size_t)OLX_VOLUME_HALVES * i);
  }
  return c;
}

static void cut(one_cell *c, float x) {
  c->split = (olx_volume_split){.normal = {1, 0, 0}, .offset = x, .behind = c->index, .front = 0};
  c->index = OLX_VOLUME_SPLIT;
}

// Returns the field with this cell as its volume.
static olx_field field_of_cell(const rooms *r, const one_cell *c) {
  olx_field field = *r->field;
  field.volume = (olx_volume){.header = &c->header,
                              .index = &c->index,
                              .splits = &c->split,
                              .cells = &c->cell,
                              .positions = c->positions,
                              .irradiance = c->irradiance};
  return field;
}

static engine_volume written_of_cell(const rooms *r, const one_cell *c, const olx_cubes_settings *settings,
                                     olx_cubes_info *info) {
  const olx_field field = field_of_cell(r, c);
  ASSERT_OK(olx_export_ktx2(&field, settings, r->path, NULL, info));
  return engine_volume_load(r->path);
}

// Light that is 3 + x, 5 + 2 y and 9 + 4 z for a normal (x, y, z), everywhere: different on each side and channel.
static void light_by_direction(olx_vec3 position, olx_vec3 c[OLX_HARMONICS_MOST]) {
  (void)position;
  c[0] = olx_v3(3.0f, 5.0f, 9.0f);
  c[3].x = 1.0f;
  c[1].y = 2.0f;
  c[2].z = 4.0f;
}

// Light that is 20 + x, 20 + 2 y and 20 + z at the place (x, y, z), whatever the normal.
static void light_by_place(olx_vec3 position, olx_vec3 c[OLX_HARMONICS_MOST]) {
  c[0] = olx_v3(20.0f + position.x, 20.0f + 2.0f * position.y, 20.0f + position.z);
}

static olx_vec3 linear_at(olx_vec3 p) { return olx_v3(20.0f + p.x, 20.0f + 2.0f * p.y, 20.0f + p.z); }

// RGB9E5 keeps eight bits of the greatest channel.
static void assert_light(olx_vec3 found, olx_vec3 irradiance, float tolerance) {
  const olx_vec3 off = olx_sub(olx_scale(found, OLX_PI), irradiance);
  if (olx_length(off) <= tolerance * olx_max3(irradiance)) return;
  fail_msg("found pi * (%g %g %g) in place of (%g %g %g)", (double)found.x, (double)found.y, (double)found.z,
           (double)irradiance.x, (double)irradiance.y, (double)irradiance.z);
}

// In a texture of 3 x (2 * 5) x (3 * 4) texels the axes are a third each, faces along them before those against them.
static void texels_of_each_side_lie_where_the_layout_says(void **state) {
  const one_cell cell = make_cell(light_by_direction);
  const olx_cubes_settings settings = {.size = {3, 5, 4}, .fit = false};
  engine_volume v = written_of_cell(*state, &cell, &settings, NULL);
  assert_true(v.size[0] == 3 && v.size[1] == 10 && v.size[2] == 12);
  for (uint32_t i = 0; i < 3 * 10 * 12; i++) {
    const uint32_t axis = i / 30 / 4, against = i / 3 % 10 / 5;
    const float sign = against ? -1.0f : 1.0f;
    const olx_vec3 expected = olx_v3(3.0f + (axis == 0 ? sign : 0.0f), 5.0f + (axis == 1 ? 2.0f * sign : 0.0f),
                                     9.0f + (axis == 2 ? 4.0f * sign : 0.0f));
    assert_light(v.texels[i], expected, 1.0f / 256);
  }
  engine_volume_free(&v);
}

static void a_place_is_looked_up_where_it_is(void **state) {
  const one_cell cell = make_cell(light_by_place);
  const olx_cubes_settings settings = {.size = {16, 7, 9}, .fit = false};
  engine_volume v = written_of_cell(*state, &cell, &settings, NULL);
  for (uint32_t i = 0; i < PLACES; i++) {
    float at[3];
    for (uint32_t axis = 0; axis < 3; axis++) { // within the outermost centres, beyond which light is constant
      const float inner = (float)v.scale[axis] * (1.0f - 1.0f / (float)settings.size[axis]);
      at[axis] = (float)v.translation[axis] + inner * (olx_unit_float(olx_hash3(i, axis, 0)) - 0.5f);
    }
    const olx_vec3 place = olx_load3(at);
    assert_light(engine_light(&v, place, olx_sample_sphere(olx_stratified2(i, 5))), linear_at(place), 1.0f / 256);
  }
  engine_volume_free(&v);
}

// Where no free space is, plain voxels have the light of the nearest free space.
static void voxels_inside_geometry_have_light(void **state) {
  one_cell cell = make_cell(light_by_direction);
  cut(&cell, -1.0f);
  const olx_cubes_settings settings = {.size = {8, 5, 4}, .fit = false};
  olx_cubes_info info;
  engine_volume v = written_of_cell(*state, &cell, &settings, &info);
  assert_int_equal(info.inside, 5 * 5 * 4); // centres are half a metre from 0, and whole metres from there
  for (uint32_t y = 0; y < v.size[1] * v.size[2]; y++) {
    for (uint32_t x = 1; x < 8; x++) assert_memory_equal(&v.texels[8 * y + x], &v.texels[8 * y], sizeof *v.texels);
  }
  assert_light(v.texels[0], olx_v3(4.0f, 5.0f, 9.0f), 1.0f / 256);
  engine_volume_free(&v);
}

// The box of the transform has the scene's bounds with a margin, or as many whole voxels as reach over them.
static void the_transform_covers_the_scene(void **state) {
  const rooms *r = *state;
  const olx_scene_content scene = olx_scene_get_content(r->scene);
  const float low[3] = {scene.bounds_min.x, scene.bounds_min.y, scene.bounds_min.z},
              high[3] = {scene.bounds_max.x, scene.bounds_max.y, scene.bounds_max.z};
  const olx_cubes_settings all[] = {
      olx_cubes_settings_default(), {.size = {2, 3, 4}}, {.spacing_metres = 0.7f}, {.spacing_metres = 100.0f}};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    olx_cubes_info info;
    engine_volume v = written(r, &all[i], &info);
    assert_true(v.size[0] == info.size[0] && v.size[1] == 2 * info.size[1] && v.size[2] == 3 * info.size[2]);
    for (uint32_t axis = 0; axis < 3; axis++) {
      assert_true(fabs(v.translation[axis] - info.translation[axis]) < 1e-12);
      assert_true(fabs(v.scale[axis] - info.scale[axis]) < 1e-12);
      assert_true(v.translation[axis] - 0.5 * v.scale[axis] < (double)low[axis]);
      assert_true(v.translation[axis] + 0.5 * v.scale[axis] > (double)high[axis]);
      if (all[i].spacing_metres > 0.0f) {
        assert_true(fabs(v.scale[axis] / info.size[axis] - (double)all[i].spacing_metres) < 1e-6);
        assert_true((double)(high[axis] - low[axis]) * (1 + 1e-2) > v.scale[axis] - (double)all[i].spacing_metres);
      }
    }
    if (i == 0) assert_int_equal(info.size[0], 32); // along the longest side
    engine_volume_free(&v);
  }
}

// Compares light on surfaces that the fit was not given, and for objects in the air.
static void fitted_voxels_are_nearer_to_surfaces(void **state) {
  const rooms *r = *state;
  lit_points surfaces = lit_surfaces(r->scene, r->field, PLACES), space = lit_space(r->field, PLACES);
  assert_true(surfaces.count > PLACES / 4 && space.count > PLACES / 2);
  static const uint32_t sizes[][3] = {{16, 6, 8}, {21, 8, 11}};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    olx_cubes_settings settings = olx_cubes_settings_default();
    memcpy(settings.size, sizes[i], sizeof settings.size);
    olx_cubes_info info;
    engine_volume fitted = written(r, &settings, &info);
    settings.fit = false;
    engine_volume plain = written(r, &settings, NULL);
    const double error = engine_error(&fitted, &surfaces), before = engine_error(&plain, &surfaces);
    const double air = engine_error(&fitted, &space), air_before = engine_error(&plain, &space);
    print_message("%ux%ux%u: surfaces %.4f, %.4f before the fit; air %.4f, %.4f\n", sizes[i][0], sizes[i][1],
                  sizes[i][2], error, before, air, air_before);
    assert_true(error <= 0.5 * before && air <= air_before + 0.01);
    assert_true(info.written_error <= 0.5 * info.captured_error);
    engine_volume_free(&fitted);
    engine_volume_free(&plain);
  }
  lit_points_free(&surfaces);
  lit_points_free(&space);
}

static void bytes_do_not_depend_on_threads(void **state) {
  const rooms *r = *state;
  static const uint32_t threads[] = {1, 2, 5};
  unsigned char *first = NULL;
  size_t first_bytes = 0;
  for (uint32_t i = 0; i < sizeof threads / sizeof *threads; i++) {
    olx_cubes_settings settings = olx_cubes_settings_default();
    settings.spacing_metres = 0.6f;
    settings.threads = threads[i];
    ASSERT_OK(olx_export_ktx2(r->field, &settings, r->path, NULL, NULL));
    size_t size_bytes;
    unsigned char *bytes = synthetic_read_file(r->path, &size_bytes);
    if (first) {
      assert_int_equal(size_bytes, first_bytes);
      assert_memory_equal(bytes, first, first_bytes);
      olx_release(bytes);
    } else {
      first = bytes;
      first_bytes = size_bytes;
    }
  }
  olx_release(first);
}

static void zstandard_keeps_every_texel(void **state) {
  const rooms *r = *state;
  olx_cubes_settings settings = olx_cubes_settings_default();
  settings.spacing_metres = 0.5f;
  olx_cubes_info plain, packed;
  engine_volume a = written(r, &settings, &plain);
  settings.zstd = true;
  engine_volume b = written(r, &settings, &packed);
  assert_true(!a.compressed && b.compressed && packed.file_bytes < plain.file_bytes);
  assert_memory_equal(a.texels, b.texels, (size_t)a.size[0] * a.size[1] * a.size[2] * sizeof *a.texels);
  engine_volume_free(&a);
  engine_volume_free(&b);
}

static bool stop_at_once(void *user, const char *stage, float done) {
  (void)user, (void)stage, (void)done;
  return false;
}

static void refusals_say_why_and_leave_no_file(void **state) {
  const rooms *r = *state;
  char path[300];
  snprintf(path, sizeof path, "%s/refused.ktx2", r->folder.path);
  static const struct {
    olx_cubes_settings settings;
    const char *message;
  } bad[] = {
      {{.size = {0, 4, 4}}, "0x4x4 voxels: each at least 1"},
      {{.size = {2049, 1, 1}}, "at most 2048x1024x682"},
      {{.size = {1, 1025, 1}}, "at most 2048x1024x682"},
      {{.size = {1, 1, 683}}, "at most 2048x1024x682"},
      {{.size = {1024, 1024, 2}}, "at most 1048576 in all"},
      {{.spacing_metres = 1e-4f}, "in all"},
      {{.spacing_metres = -1.0f}, "voxels of -1 m"},
      {{.spacing_metres = INFINITY}, "voxels of inf m"},
      {{.spacing_metres = 1.0f, .size = {1, 1, 1}}, "either a size or a spacing"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_int_equal(olx_export_ktx2(r->field, &bad[i].settings, path, NULL, NULL), OLX_ERROR_ARGUMENT);
    if (!strstr(olx_last_error(), bad[i].message)) fail_msg("'%s' in place of '%s'", olx_last_error(), bad[i].message);
  }
  const olx_cubes_settings settings = olx_cubes_settings_default();
  const olx_progress stopping = {.report = stop_at_once};
  assert_int_equal(olx_export_ktx2(r->field, &settings, path, &stopping, NULL), OLX_ERROR_CANCELLED);
  one_cell cell = make_cell(light_by_direction);
  cut(&cell, -10.0f); // nowhere
  olx_field field = field_of_cell(r, &cell);
  assert_int_equal(olx_export_ktx2(&field, &settings, path, NULL, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "no voxel of 32x12x16 has its centre in free space"));
  field.volume.header = NULL;
  assert_int_equal(olx_export_ktx2(&field, &settings, path, NULL, NULL), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "baked without an irradiance volume"));
  assert_int_equal(access(path, F_OK), -1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(texels_of_each_side_lie_where_the_layout_says),
      cmocka_unit_test(a_place_is_looked_up_where_it_is),
      cmocka_unit_test(voxels_inside_geometry_have_light),
      cmocka_unit_test(the_transform_covers_the_scene),
      cmocka_unit_test(fitted_voxels_are_nearer_to_surfaces),
      cmocka_unit_test(bytes_do_not_depend_on_threads),
      cmocka_unit_test(zstandard_keeps_every_texel),
      cmocka_unit_test(refusals_say_why_and_leave_no_file),
  };
  return cmocka_run_group_tests(tests, build_rooms, leave_rooms);
}
