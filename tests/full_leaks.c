// Compares the field with the baseline where walls are between probes: the dissertation's rooms (chapter 5) and the
// leak figures of McGuire et al. 2017. Both methods have the same probes, the same light, and the same camera.
#include "baked_field.h"

#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

enum { WIDTH = 32, HEIGHT = 24, BOUNCES = 2 };

typedef struct place {
  olx_scene *scene;
  olx_field *field;
} place;

static place make(const char *name) {
  place p = {NULL, NULL};
  assert_int_equal(olx_scene_load(name, &p.scene), OLX_OK);
  olx_bake_settings settings = olx_bake_settings_default(p.scene);
  settings.irradiance_grid = settings.grid; // 16 probes in the dissertation's rooms, as published
  settings.radiance_size = 32;
  settings.irradiance_size = 64;
  settings.bounces = BOUNCES;
  settings.classic = true;
  settings.classic_size = 64;
  settings.classic_cube_size = 64;
  p.field = baked_field(p.scene, &settings, NULL);
  return p;
}

static void give_back(place *p) {
  olx_field_close(p->field);
  olx_scene_free(p->scene);
}

static olx_image picture(const place *p, olx_method method, const char *view, uint32_t seed) {
  olx_render_settings settings = olx_render_settings_default(method);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  settings.spp = method == OLX_METHOD_PATH ? 256 : 16;
  settings.bounces = BOUNCES + 1;
  settings.seed = seed;
  olx_camera camera;
  olx_image image;
  assert_int_equal(olx_scene_find_camera(p->scene, view, &camera), OLX_OK);
  assert_int_equal(olx_render(p->scene, p->field, &camera, &settings, NULL, &image, NULL), OLX_OK);
  return image;
}

// Returns the mean of the indirect light that a camera sees.
static double indirect_light(const place *p, olx_method method, const char *view) {
  olx_image image = picture(p, method, view, 0);
  double sum = 0.0;
  for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
    const olx_vec3 c = image.layers[OLX_LAYER_INDIRECT_DIFFUSE][i];
    sum += (double)(c.x + c.y + c.z);
  }
  olx_image_free(&image);
  return sum / (3.0 * WIDTH * HEIGHT);
}

static void the_sealed_rooms_leak_is_a_hundredth_of_the_baselines(void **state) {
  (void)state;
  place p = make("builtin:two-rooms-sealed");
  const double field = indirect_light(&p, OLX_METHOD_FIELD, "dark"),
               classic = indirect_light(&p, OLX_METHOD_CLASSIC, "dark"),
               lit = indirect_light(&p, OLX_METHOD_PATH, "lit");
  print_message("dark room over lit room: field %.6f, classic %.4f\n", field / lit, classic / lit);
  assert_true(classic > 0.1 * lit); // without visibility the wall leaks
  assert_true(field <= 0.01 * classic);
  give_back(&p);
}

static void light_passes_a_gap_as_it_grows(void **state) {
  (void)state;
  static const char *const gaps[] = {"0.2", "0.4", "0.8", "1.6"};
  double before = 0.0, truth_before = 0.0;
  for (uint32_t i = 0; i < 4; i++) {
    char name[64];
    snprintf(name, sizeof name, "builtin:two-rooms-gap:%s", gaps[i]);
    place p = make(name);
    const double field = indirect_light(&p, OLX_METHOD_FIELD, "dark"),
                 classic = indirect_light(&p, OLX_METHOD_CLASSIC, "dark"),
                 truth = indirect_light(&p, OLX_METHOD_PATH, "dark");
    print_message("a gap of %s m: far room %.5f, field %+.1f %%, classic %+.1f %%\n", gaps[i], truth,
                  100.0 * (field / truth - 1.0), 100.0 * (classic / truth - 1.0));
    assert_true(field > 0.85 * truth && field < 1.15 * truth); // a wide bound, since maps have only 32^2 texels
    assert_true(field > before && truth > truth_before);
    before = field;
    truth_before = truth;
    give_back(&p);
  }
}

// Mean squared errors against the path tracer, less the reference's noise, which the difference of two references
// gives.
typedef struct errors {
  double field, classic;
} errors;

static double squared_difference(const olx_image *a, const olx_image *b) {
  olx_metrics metrics;
  assert_int_equal(olx_compare(a, b, OLX_LAYER_INDIRECT_DIFFUSE, &metrics), OLX_OK);
  return metrics.mse;
}

static errors judge(const place *p, const char *view) {
  olx_image truth[2] = {picture(p, OLX_METHOD_PATH, view, 1), picture(p, OLX_METHOD_PATH, view, 2)};
  olx_image field = picture(p, OLX_METHOD_FIELD, view, 0), classic = picture(p, OLX_METHOD_CLASSIC, view, 0);
  const double noise = 0.5 * squared_difference(&truth[0], &truth[1]);
  errors e = {0.0, 0.0};
  for (uint32_t i = 0; i < 2; i++) {
    e.field += 0.5 * (squared_difference(&field, &truth[i]) - noise);
    e.classic += 0.5 * (squared_difference(&classic, &truth[i]) - noise);
    olx_image_free(&truth[i]);
  }
  olx_image_free(&field);
  olx_image_free(&classic);
  return e;
}

static void assert_a_third(const char *name, const char *const *views) {
  place p = make(name);
  errors sum = {0.0, 0.0};
  for (; *views; views++) {
    const errors e = judge(&p, *views);
    print_message("%s, %s: MSE of indirect light %.2e, classic %.2e: %.3f of it\n", name, *views, e.field, e.classic,
                  e.field / e.classic);
    sum.field += e.field;
    sum.classic += e.classic;
  }
  assert_true(sum.field <= sum.classic / 3.0);
  give_back(&p);
}

static void leak_figures_have_a_third_of_the_baselines_error(void **state) {
  (void)state;
  assert_a_third("builtin:pillars", (const char *const[]){"corner", "side", NULL});
  assert_a_third("builtin:labyrinth", (const char *const[]){"chamber", "door", "ring", NULL});
  assert_a_third("builtin:two-rooms-sealed", (const char *const[]){"lit", "dark", NULL});
  assert_a_third("builtin:two-rooms-gap", (const char *const[]){"lit", "dark", "both", NULL});
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_sealed_rooms_leak_is_a_hundredth_of_the_baselines),
      cmocka_unit_test(light_passes_a_gap_as_it_grows),
      cmocka_unit_test(leak_figures_have_a_third_of_the_baselines_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
