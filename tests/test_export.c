// Tests exports of made-up fields: which maps a field has, and that impossible exports are refused before anything is
// written.
#include "field_fixture.h"

#include "core/hooks.h"
#include "export/map_texels.h"

#include <octalux/export.h>
#include <octalux/render.h>

#include <unistd.h>

static olx_field *open_synthetic(const field_fixture *f, const synthetic_shape *shape) {
  olx_field *field;
  assert_int_equal(synthetic_write(f->path, shape, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  return field;
}

// Returns a bit for each map that a field has.
static uint32_t maps_of(const olx_field *field) {
  uint32_t mask = 0;
  for (olx_map map = OLX_MAP_DISTANCE; map < OLX_MAP_COUNT; map++) {
    if (olx_map_check(field, map, 0) == OLX_OK) mask |= 1u << map;
    else assert_says(olx_map_name(map));
  }
  return mask;
}

static uint32_t bits(olx_map first, olx_map last) { return (2u << last) - (1u << first); }

static void test_fields_have_the_maps_that_they_were_baked_with(void **state) {
  const uint32_t light = bits(OLX_MAP_DISTANCE, OLX_MAP_EMISSION);
  const uint32_t probe_light =
      light | bits(OLX_MAP_RADIANCE, OLX_MAP_RADIANCE) | bits(OLX_MAP_IRRADIANCE, OLX_MAP_MEAN_SQUARE_DISTANCE);
  const struct {
    const synthetic_shape *shape;
    uint32_t maps;
  } fields[] = {
      {&without_probe_light, light},
      {&small, probe_light},
      {&third_order, probe_light},
      {&classic, probe_light | bits(OLX_MAP_CLASSIC_IRRADIANCE, OLX_MAP_CLASSIC_RADIANCE_4)},
      {&relit, probe_light},
  };
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
    olx_field *field = open_synthetic(*state, fields[i].shape);
    assert_int_equal(maps_of(field), fields[i].maps);
    olx_field_close(field);
  }
}

static void test_every_texel_of_every_map_can_be_read(void **state) {
  const synthetic_shape *const shapes[] = {&small, &classic, &relit, &third_order};
  for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
    olx_field *field = open_synthetic(*state, shapes[i]);
    for (olx_map map = OLX_MAP_DISTANCE; map < OLX_MAP_COUNT; map++) {
      for (uint32_t probe = 0; olx_map_check(field, map, probe) == OLX_OK; probe++) {
        const uint32_t side = olx_map_side(field, map);
        for (uint32_t at = 0; at < side * side; at++) {
          const olx_vec3 texel = olx_map_texel(field, map, probe, at % side, at / side);
          assert_false(isnan(texel.x) || isnan(texel.y) || isnan(texel.z));
        }
      }
    }
    olx_field_close(field);
  }
}

// The exported irradiance of harmonics agrees with the runtime's in the direction of each texel.
static void test_harmonics_are_shown_as_irradiance(void **state) {
  olx_field *field = open_synthetic(*state, &third_order);
  const uint32_t side = olx_map_side(field, OLX_MAP_IRRADIANCE);
  assert_int_equal(side, third_order.irradiance_n);
  for (uint32_t at = 0; at < side * side; at++) {
    const olx_vec3 shown = olx_map_texel(field, OLX_MAP_IRRADIANCE, 4, at % side, at / side);
    const olx_vec3 said = olx_probe_irradiance(field, 4, olx_texel_direction(at % side, at / side, side));
    assert_true(fabsf(shown.x - said.x) <= 1e-5f * (1.0f + fabsf(said.x)) &&
                fabsf(shown.z - said.z) <= 1e-5f * (1.0f + fabsf(said.z)));
  }
  olx_field_close(field);
}

static void test_pictures_hold_what_the_map_holds(void **state) {
  const field_fixture *f = *state;
  char path[128];
  snprintf(path, sizeof path, "%s/a.exr", f->folder);
  olx_field *field = open_synthetic(f, &small);
  const olx_map_picture picture = {.map = OLX_MAP_INDIRECT, .probe = 3};
  uint32_t width = 0, height = 0;
  olx_image image;
  assert_int_equal(olx_export_map(field, &picture, path, &width, &height), OLX_OK);
  assert_true(width == small.n && height == small.n);
  assert_int_equal(olx_image_load(path, &image), OLX_OK);
  for (uint32_t at = 0; at < width * height; at++) {
    const olx_vec3 texel = olx_map_texel(field, OLX_MAP_INDIRECT, 3, at % width, at / width);
    assert_memory_equal(&image.layers[OLX_LAYER_BEAUTY][at], &texel, sizeof texel);
  }
  olx_image_free(&image);
  unlink(path);
  olx_field_close(field);
}

static void test_refuses_pictures_that_cannot_be(void **state) {
  const field_fixture *f = *state;
  char path[128];
  snprintf(path, sizeof path, "%s/a.exr", f->folder);
  olx_field *field = open_synthetic(f, &small);
  const struct {
    olx_map_picture picture;
    const char *message;
  } bad[] = {
      {{.map = OLX_MAP_COUNT}, "no kind of map has the number 21"},
      {{.map = OLX_MAP_DIRECT, .probe = 12}, "no probe 12: map direct is of 12 light field probes"},
      {{.map = OLX_MAP_IRRADIANCE, .probe = UINT32_MAX}, "of 6 irradiance probes"},
      {{.map = OLX_MAP_VOLUME_IRRADIANCE}, "without an irradiance volume"},
      {{.map = OLX_MAP_DIRECT, .projection = 3}, "not one of the projections"},
      {{.map = OLX_MAP_DIRECT, .projection = OLX_PROJECTION_CUBE, .size = 2049}, "a size above 2048"},
      {{.map = OLX_MAP_DIRECT, .size = 8}, "has that of its map, 16"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    assert_int_equal(olx_export_map(field, &bad[i].picture, path, NULL, NULL), OLX_ERROR_ARGUMENT);
    assert_says(bad[i].message);
    assert_int_equal(access(path, F_OK), -1);
  }
  assert_string_equal(olx_map_name(OLX_MAP_COUNT), "unknown");
  assert_string_equal(olx_map_projection_name(3), "unknown");
  olx_field_close(field);
}

static void test_models_count_what_they_show(void **state) {
  const field_fixture *f = *state;
  const synthetic_shape *const shapes[] = {&small, &without_probe_light, &least};
  char path[128];
  snprintf(path, sizeof path, "%s/a.gltf", f->folder);
  for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
    olx_field *field = open_synthetic(f, shapes[i]);
    olx_gltf_counts counts;
    assert_int_equal(olx_export_gltf(field, path, &counts), OLX_OK);
    assert_true(counts.probes == field->info.probes.count &&
                counts.irradiance_probes == field->info.irradiance.probe_count && counts.volume_probes == 0);
    size_t size_bytes;
    unsigned char *text = synthetic_read_file(path, &size_bytes);
    assert_true(size_bytes > 1000 && text[0] == '{');
    olx_release(text);
    olx_field_close(field);
  }
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_fields_have_the_maps_that_they_were_baked_with, field_set_up,
                                      field_tear_down),
      cmocka_unit_test_setup_teardown(test_every_texel_of_every_map_can_be_read, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_harmonics_are_shown_as_irradiance, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_pictures_hold_what_the_map_holds, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_pictures_that_cannot_be, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_models_count_what_they_show, field_set_up, field_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
