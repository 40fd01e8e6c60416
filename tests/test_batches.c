// Tests that queries of many points at once give the same results as a query for each point, to the last bit.
#include "baked_field.h"

#include "core/sampling.h"

#include <octalux/sample.h>

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { POINTS = 300 };

// Points of a box, on its surfaces and elsewhere.
typedef struct points {
  olx_vec3 positions[POINTS], normals[POINTS], shading[POINTS], views[POINTS];
  float roughness[POINTS];
  olx_vec2 random[POINTS];
} points;

static float draw(uint32_t i, uint32_t what) { return olx_unit_float(olx_hash3(i, what, 5)); }

static void draw_points(const olx_field_info *info, points *p) {
  const olx_vec3 size = olx_sub(info->scene.bounds_max, info->scene.bounds_min);
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec3 place = olx_v3(draw(i, 0), i % 2 ? 0.0f : draw(i, 1), draw(i, 2));
    p->positions[i] = olx_add(info->scene.bounds_min, olx_mul(size, place));
    p->normals[i] = i % 2 ? olx_v3(0.0f, 1.0f, 0.0f) : olx_sample_sphere((olx_vec2){draw(i, 3), draw(i, 4)});
    p->shading[i] = olx_normalize(olx_madd(p->normals[i], olx_v3(1.0f, 0.0f, 0.0f), 0.3f * draw(i, 5)));
    p->views[i] = olx_sample_sphere((olx_vec2){draw(i, 6), draw(i, 7)});
    p->roughness[i] = draw(i, 8);
    p->random[i] = (olx_vec2){draw(i, 9), draw(i, 10)};
  }
}

static olx_field *box_field(void) {
  olx_scene *scene;
  assert_int_equal(olx_scene_load("builtin:cornell-glossy", &scene), OLX_OK);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = 32;
  settings.noise = 0.3f;
  settings.probe_light = true;
  olx_field *field = baked_field(scene, &settings, NULL);
  olx_scene_free(scene);
  return field;
}

// Asserts that irradiance probes and the volume light many points as they light each, and that they light most of them.
static void assert_irradiance_batches(const olx_field *field, const points *p) {
  static olx_vec3 probes[POINTS], volume[POINTS];
  const olx_sample_settings settings = olx_sample_settings_default();
  uint32_t lit = 0;
  olx_irradiance_points(field, &settings, POINTS, p->positions, p->normals, p->views, probes);
  olx_volume_irradiance_points(field, POINTS, p->positions, p->normals, volume);
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec3 by_probes = olx_irradiance(field, &settings, p->positions[i], p->normals[i], p->views[i]);
    const olx_vec3 by_volume = olx_volume_irradiance(field, p->positions[i], p->normals[i]);
    assert_memory_equal(&probes[i], &by_probes, sizeof by_probes);
    assert_memory_equal(&volume[i], &by_volume, sizeof by_volume);
    lit += by_probes.x > 0.0f && by_volume.x > 0.0f;
  }
  assert_true(lit > POINTS / 2);
}

static void test_batches_say_what_single_calls_say(void **state) {
  (void)state;
  static points p;
  static olx_vec3 irradiance[POINTS], radiance[POINTS];
  static float weights[POINTS], half_cosines[POINTS];
  olx_field *field = box_field();
  const olx_field_info info = olx_field_describe(field);
  const olx_sample_settings settings = olx_sample_settings_default();
  uint32_t lit = 0, traced = 0;
  draw_points(&info, &p);
  olx_surface_irradiance_points(field, &settings, POINTS, p.positions, p.normals, p.shading, p.views, irradiance);
  olx_glossy_rays(field, &settings, POINTS, p.positions, p.normals, p.views, p.roughness, p.random, radiance, weights,
                  half_cosines);
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec3 one =
        olx_surface_irradiance(field, &settings, p.positions[i], p.normals[i], p.shading[i], p.views[i]);
    assert_memory_equal(&irradiance[i], &one, sizeof one);
    lit += one.x > 0.0f;
    float weight, half_cosine = 0.0f;
    const olx_vec3 glossy = olx_glossy(field, &settings, p.positions[i], p.normals[i], p.views[i], p.roughness[i],
                                       p.random[i], &weight, &half_cosine, NULL);
    assert_memory_equal(&radiance[i], &glossy, sizeof glossy);
    assert_memory_equal(&weights[i], &weight, sizeof weight);
    if (weight > 0.0f) assert_memory_equal(&half_cosines[i], &half_cosine, sizeof half_cosine);
    traced += weight > 0.0f;
  }
  assert_true(lit > POINTS / 3 && traced > POINTS / 5 && traced < POINTS);
  assert_irradiance_batches(field, &p);
  olx_field_close(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_batches_say_what_single_calls_say)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
