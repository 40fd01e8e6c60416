// Tests bounces between probes, by both methods of gathering them, against known values and against the path tracer.
#include "baked_field.h"
#include "core/sampling.h"
#include "field/maps.h"
#include "light/path.h"

#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const olx_bounce_gather ways[2] = {OLX_GATHER_IRRADIANCE, OLX_GATHER_TRACED};
static const char *const names[2] = {"irradiance", "traced"};

static olx_scene *load(const char *name) {
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load(name, &scene), OLX_OK);
  return scene;
}

static olx_bake_settings small_bake(const olx_scene *scene, olx_bounce_gather way, uint32_t bounces) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.probe_light = true;
  settings.irradiance_grid = settings.grid;
  settings.radiance_size = 16;
  settings.irradiance_size = 32;
  settings.samples = 1;
  settings.bounces = bounces;
  settings.bounce_gather = way;
  return settings;
}

// Returns the mean of a probe's irradiance over its map.
static double mean_irradiance(const olx_field *field, uint32_t probe) {
  const uint32_t n = field->irradiance_n;
  double sum = 0.0;
  for (uint32_t i = 0; i < n * n; i++) {
    const size_t texel = olx_map_index(n + 2, (int32_t)(i % n), (int32_t)(i / n));
    sum += (double)olx_luminance(olx_r11g11b10f_unpack(field->irradiance[field->irradiance_texels * probe + texel]));
  }
  return sum / (n * n);
}

// With emission 1 and a reflectance of one half everywhere, surfaces reflect 1 - 1/2^(b + 1) after b bounces.
static void each_bounce_of_a_furnace_adds_half_of_the_one_before(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:furnace");
  for (uint32_t way = 0; way < 2; way++) {
    for (uint32_t bounces = 0; bounces <= 6; bounces += 2) {
      olx_bake_settings settings = small_bake(scene, ways[way], bounces);
      settings.fit = false;
      olx_bake_stats stats;
      olx_field *field = baked_field(scene, &settings, &stats);
      const double expected = (double)OLX_PI * (1.0 - 1.0 / (double)(2u << bounces));
      double mean = 0.0;
      for (uint32_t i = 0; i < field->info.irradiance.probe_count; i++) mean += mean_irradiance(field, i);
      mean /= field->info.irradiance.probe_count;
      if (fabs(mean - expected) > 0.01 * expected) {
        fail_msg("%s, %u bounces: %f, not %f", names[way], bounces, mean, expected);
      }
      assert_true(stats.unseen < 0.01);
      olx_field_close(field);
    }
  }
  olx_scene_free(scene);
}

// No probe behind the wall sees light, and no probe in front of it is used for points behind it.
static void no_bounce_goes_through_a_wall(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:two-rooms-sealed");
  for (uint32_t way = 0; way < 2; way++) {
    olx_bake_settings settings = small_bake(scene, ways[way], 4);
    settings.irradiance_size = 64;
    settings.fit = false;
    olx_field *field = baked_field(scene, &settings, NULL);
    double lit = 0.0, dark = 0.0;
    for (uint32_t i = 0; i < field->info.irradiance.probe_count; i++) {
      *(field->irradiance_positions[i].x < 0.0f ? &lit : &dark) += mean_irradiance(field, i);
    }
    print_message("%s: dark room over lit room %.2e\n", names[way], dark / lit);
    assert_true(dark <= (ways[way] == OLX_GATHER_TRACED ? 0.0 : 1e-3 * lit)); // traced rays cannot leak at all
    olx_field_close(field);
  }
  olx_scene_free(scene);
}

// --- Cornell box, 4 x 4 x 4 probes

enum { SIDE = 32, MANY = 8 };

static double indirect_light(const olx_scene *scene, const olx_field *field, uint32_t bounces) {
  olx_render_settings settings = olx_render_settings_default(field ? OLX_METHOD_FIELD : OLX_METHOD_PATH);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE;
  settings.width = settings.height = SIDE;
  settings.spp = field ? 16 : 400;
  settings.bounces = bounces;
  olx_camera camera;
  olx_image image;
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  assert_int_equal(olx_render(scene, field, &camera, &settings, NULL, &image, NULL), OLX_OK);
  double sum = 0.0;
  for (uint32_t i = 0; i < SIDE * SIDE; i++) {
    const olx_vec3 c = image.layers[OLX_LAYER_INDIRECT_DIFFUSE][i];
    sum += (double)(c.x + c.y + c.z);
  }
  olx_image_free(&image);
  return sum / (3.0 * SIDE * SIDE);
}

static void both_ways_come_to_the_path_tracers_light(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  static const uint32_t counts[2] = {4, MANY};
  static const double most[2] = {0.03, 0.04};
  for (uint32_t i = 0; i < 2; i++) {
    // MANY bounces are compared with an infinite number of them: those after the eighth add less than a thousandth.
    const double truth = indirect_light(scene, NULL, counts[i] == MANY ? OLX_BOUNCES_INFINITE : counts[i] + 1);
    for (uint32_t way = 0; way < 2; way++) {
      olx_bake_settings settings = small_bake(scene, ways[way], counts[i]);
      assert_int_equal(olx_scene_probe_grid(scene, (const uint32_t[3]){4, 4, 4}, &settings.grid), OLX_OK);
      settings.irradiance_grid = settings.grid;
      olx_field *field = baked_field(scene, &settings, NULL);
      const double bias = indirect_light(scene, field, 0) / truth - 1.0;
      print_message("%s, %u bounces: %+.2f %%\n", names[way], counts[i], 100.0 * bias);
      assert_true(fabs(bias) <= most[i]);
      olx_field_close(field);
    }
  }
  olx_scene_free(scene);
}

// Compares the irradiance that probes hold, without fitting, with what the path tracer finds at their positions. So it
// measures the bounces alone, without the interpolation of a picture.
static void both_ways_fill_probes_as_paths_do(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  static const uint32_t counts[2] = {1, MANY};
  enum { NORMALS = 8, PATHS = 600 };
  for (uint32_t i = 0; i < 2; i++) {
    double truth = 0.0;
    for (uint32_t way = 0; way < 2; way++) {
      olx_bake_settings settings = small_bake(scene, ways[way], counts[i]);
      assert_int_equal(olx_scene_probe_grid(scene, (const uint32_t[3]){4, 4, 4}, &settings.grid), OLX_OK);
      settings.irradiance_grid = settings.grid;
      settings.fit = false;
      olx_field *field = baked_field(scene, &settings, NULL);
      double held = 0.0;
      for (uint32_t k = 0; k < field->info.irradiance.probe_count * NORMALS; k++) {
        const uint32_t probe = k / NORMALS, n = field->irradiance_n;
        if (field->irradiance_flags[probe] & OLX_PROBE_BURIED) continue;
        const olx_vec3 normal = olx_sample_sphere(olx_hammersley(k % NORMALS, NORMALS));
        const olx_bilinear texels = olx_bilinear_at(olx_octahedral_encode(normal), n);
        for (uint32_t t = 0; t < 4; t++) {
          const uint32_t code = field->irradiance[field->irradiance_texels * probe + texels.index[t]];
          held += (double)(texels.weight[t] * olx_luminance(olx_r11g11b10f_unpack(code)));
        }
        if (way > 0) continue;
        const uint32_t bounces = counts[i] == MANY ? OLX_BOUNCES_INFINITE : counts[i] + 1;
        truth += (double)olx_luminance(
            olx_path_irradiance(scene, field->irradiance_positions[probe], normal, 0.0f, bounces, PATHS, k));
      }
      print_message("%s, %u bounces: probes hold %+.2f %%\n", names[way], counts[i], 100.0 * (held / truth - 1.0));
      // Interpolated irradiance is too bright near walls, and more so with every bounce; traced rays have no such bias.
      if (ways[way] == OLX_GATHER_TRACED) assert_true(fabs(held / truth - 1.0) <= 0.01);
      else assert_true(held > 1.02 * truth && held < 1.1 * truth);
      olx_field_close(field);
    }
  }
  olx_scene_free(scene);
}

static void bytes_do_not_depend_on_threads(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell-glossy");
  const olx_bake_settings settings = small_bake(scene, OLX_GATHER_TRACED, 2);
  baked_field_at_any_threads(scene, &settings);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_bounce_of_a_furnace_adds_half_of_the_one_before),
      cmocka_unit_test(no_bounce_goes_through_a_wall),
      cmocka_unit_test(both_ways_come_to_the_path_tracers_light),
      cmocka_unit_test(both_ways_fill_probes_as_paths_do),
      cmocka_unit_test(bytes_do_not_depend_on_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
