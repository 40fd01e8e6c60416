// Tests the light of surfels in a room that sees the sky through a small window alone: direct light, for which few even
// samples find the sky, against quadrature, and further rays against many first ones.
#include "light/scene_light.h"
#include "made_scenes.h"
#include "scene/scene_build.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const float WINDOW_X = 2.0f, WINDOW_Y = 1.4f, WINDOW_HALF = 0.15f; // plane, and centre at z = 0

// Adds the sides of the window in a wall that is `depth` thick.
static void add_sides(olx_scene *scene, float depth, uint32_t wall) {
  const float middle = WINDOW_X + 0.5f * depth, width = 2.0f * WINDOW_HALF;
  const olx_vec3 x = {depth, 0, 0}, y = {0, width, 0}, z = {0, 0, width};
  made_quad(scene, olx_v3(middle, WINDOW_Y - WINDOW_HALF, 0), z, x, wall);
  made_quad(scene, olx_v3(middle, WINDOW_Y + WINDOW_HALF, 0), x, z, wall);
  made_quad(scene, olx_v3(middle, WINDOW_Y, -WINDOW_HALF), x, y, wall);
  made_quad(scene, olx_v3(middle, WINDOW_Y, WINDOW_HALF), y, x, wall);
}

// A room of 4 x 2.5 x 4 metres below an even sky of radiance 1, with a square window in a wall that is `depth` thick.
static olx_scene *room_with_a_window(float depth) {
  olx_scene *scene = made_scene();
  olx_material paint = olx_material_default();
  paint.specular_weight = 0.0f;
  paint.base_color = olx_splat(0.7f);
  const uint32_t wall = made_material(scene, &paint);
  const float low = WINDOW_Y - WINDOW_HALF, high = WINDOW_Y + WINDOW_HALF, side = 2.0f - WINDOW_HALF;
  const olx_vec3 x = {4, 0, 0}, y = {0, 2.5f, 0}, z = {0, 0, 4};
  made_quad(scene, olx_v3(0, 0, 0), z, x, wall);
  made_quad(scene, olx_v3(0, 2.5f, 0), x, z, wall);
  made_quad(scene, olx_v3(-2, 1.25f, 0), y, z, wall);
  made_quad(scene, olx_v3(0, 1.25f, -2), x, y, wall);
  made_quad(scene, olx_v3(0, 1.25f, 2), y, x, wall);
  made_quad(scene, olx_v3(WINDOW_X, 0.5f * low, 0), z, olx_v3(0, low, 0), wall);
  made_quad(scene, olx_v3(WINDOW_X, 0.5f * (high + 2.5f), 0), z, olx_v3(0, 2.5f - high, 0), wall);
  for (int sign = -1; sign <= 1; sign += 2) {
    made_quad(scene, olx_v3(WINDOW_X, WINDOW_Y, (float)sign * (WINDOW_HALF + 0.5f * side)), olx_v3(0, 0, side),
              olx_v3(0, 2.0f * WINDOW_HALF, 0), wall);
  }
  if (depth > 0.0f) add_sides(scene, depth, wall);
  scene->environment.radiance = olx_splat(1.0f);
  return made_finish(scene);
}

// Returns the irradiance of a place from the sky through the window.
static float window_irradiance(olx_vec3 position, olx_vec3 normal) {
  enum { STEPS = 16 };
  const float step = 2.0f * WINDOW_HALF / STEPS;
  float sum = 0.0f;
  for (uint32_t i = 0; i < STEPS * STEPS; i++) {
    const olx_vec3 at = {WINDOW_X, WINDOW_Y - WINDOW_HALF + step * ((float)(i % STEPS) + 0.5f),
                         -WINDOW_HALF + step * ((float)(i / STEPS) + 0.5f)};
    const olx_vec3 way = olx_sub(at, position);
    const float square = olx_dot(way, way);
    sum += olx_max(olx_dot(way, normal), 0.0f) * olx_max(way.x, 0.0f) * step * step / (square * square);
  }
  return sum;
}

static olx_scene_light *solve(const olx_scene *scene, float noise, uint32_t bounces, uint32_t seed) {
  const olx_vec3 probe = {0.1f, 1.3f, 0.1f};
  const uint8_t flags = 0;
  olx_scene_light *light;
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.noise = noise;
  settings.bounces = bounces;
  settings.seed = seed;
  assert_int_equal(olx_scene_light_create(scene, &settings, &probe, &flags, 1, &light), OLX_OK);
  return light;
}

// Even samples find the sky in about one of a thousand tries. When surfels learnt nothing of the window first, the root
// mean square error of these was 1.9 times their mean light.
static void surfels_find_a_small_window(void **state) {
  (void)state;
  for (uint32_t seed = 0; seed < 2; seed++) {
    olx_scene *scene = room_with_a_window(0.0f);
    olx_scene_light *light = solve(scene, 1.0f, 1, seed);
    const olx_scene_light_parts parts = olx_scene_light_open(light);
    double found = 0.0, wanted = 0.0, squares = 0.0, area = 0.0;
    for (uint32_t i = 0; i < parts.visible; i++) {
      const olx_light_surfel *s = &parts.surfels->surfels[i];
      if (s->position.x > 1.0f) continue; // light varies within cells near the window
      const double truth = (double)window_irradiance(s->position, s->normal);
      const double is = (double)olx_luminance(parts.direct.all[i]), share = (double)s->side * (double)s->side;
      found += share * is;
      wanted += share * truth;
      squares += share * (is - truth) * (is - truth);
      area += share;
    }
    const double spread = sqrt(squares / area) / (wanted / area);
    print_message("all surfels %.3f of the light, RMS error %.2f of the mean\n", found / wanted, spread);
    assert_true(fabs(found / wanted - 1.0) < 0.05);
    assert_true(spread < 1.0);
    olx_scene_light_free(light);
    olx_scene_free(scene);
  }
}

// Returns the mean indirect light of surfels away from the window of a room with a thick wall. The sides of the window,
// which only rays in few directions meet, are its brightest surfaces.
static double mean_light(float noise, uint32_t seed) {
  olx_scene *scene = room_with_a_window(0.2f);
  olx_scene_light *light = solve(scene, noise, 64, seed);
  const olx_scene_light_parts parts = olx_scene_light_open(light);
  double sum = 0.0, area = 0.0;
  for (uint32_t i = 0; i < parts.visible; i++) {
    if (parts.surfels->surfels[i].position.x > 1.0f) continue;
    const double share = (double)parts.surfels->surfels[i].side * (double)parts.surfels->surfels[i].side;
    sum += share * (double)olx_luminance(parts.irradiance[i]);
    area += share;
  }
  olx_scene_light_free(light);
  olx_scene_free(scene);
  return sum / area;
}

// First rays are as many for all surfels, so their light is right on average. Further rays go where the first ones
// found light to vary. When surfels that had all missed the bright sides of the window got few, the mean was 0.91.
static void surfels_that_missed_bright_places_get_further_rays(void **state) {
  (void)state;
  double first = 0.0, all = 0.0;
  for (uint32_t seed = 0; seed < 2; seed++) {
    first += mean_light(1e6f, seed);
    all += mean_light(0.1f, seed);
    print_message("mean light %.4f of that of first rays\n", all / first);
  }
  assert_true(all / first > 0.94 && all / first < 1.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(surfels_find_a_small_window),
                                     cmocka_unit_test(surfels_that_missed_bright_places_get_further_rays)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
