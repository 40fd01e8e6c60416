// Tests the solved light of a room behind thin panes against path tracing: light that panes pass to and fro between each
// other is neither lost nor doubled.
#include "core/sampling.h"
#include "light/path.h"
#include "light/scene_light.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"
#include "scene/surface.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

// A room of 4 x 2 x 4 metres below the sky, whose roof is this number of panes, 1.5 cm above each other. They let 39 %
// of the light through and reflect 35 % as a matte surface does.
static olx_scene *glazed_room(uint32_t panes) {
  olx_scene *scene = made_scene();
  olx_material paint = olx_material_default(), glass;
  paint.specular_weight = 0.0f;
  glass = paint;
  paint.base_color = olx_splat(0.7f);
  glass.base_color = olx_splat(0.58f);
  glass.alpha = 0.61f;
  glass.alpha_cutoff = 0.5f;
  glass.blended = true;
  const uint32_t wall = made_material(scene, &paint), pane = made_material(scene, &glass);
  const olx_vec3 x = {4, 0, 0}, y = {0, 2, 0}, z = {0, 0, 4};
  made_quad(scene, olx_v3(0, 0, 0), z, x, wall);
  made_quad(scene, olx_v3(-2, 1, 0), y, z, wall);
  made_quad(scene, olx_v3(2, 1, 0), z, y, wall);
  made_quad(scene, olx_v3(0, 1, -2), x, y, wall);
  made_quad(scene, olx_v3(0, 1, 2), y, x, wall);
  for (uint32_t i = 0; i < panes; i++) made_quad(scene, olx_v3(0, 1.9f + 0.015f * (float)i, 0), x, z, pane);
  scene->environment.radiance = olx_splat(1.0f);
  return made_finish(scene);
}

// Returns the solved indirect light of the walls, as a share of what path tracing finds.
static double solved_share(uint32_t panes) {
  enum { POINTS = 128, PATHS = 512, BOUNCES = 32 };
  olx_scene *scene = glazed_room(panes);
  const olx_vec3 probe = {0.1f, 1.1f, 0.1f};
  const uint8_t flags = 0;
  olx_scene_light *light;
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.map_size = 64;
  settings.noise = 0.005f; // with 0.02 the sums of six seeds differ by up to 3 %
  settings.bounces = BOUNCES;
  assert_int_equal(olx_scene_light_create(scene, &settings, &probe, &flags, 1, &light), OLX_OK);
  double solved = 0.0, traced = 0.0;
  uint64_t rays = 0;
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_ray ray = {probe, olx_sample_sphere(olx_hammersley(i, POINTS)), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    if (surface.position.y > 1.8f) continue;
    solved += (double)olx_luminance(olx_scene_light_irradiance(light, &surface));
    traced += (double)olx_luminance(olx_path_surface_irradiance(scene, &surface, BOUNCES + 1, PATHS, i, &rays));
  }
  olx_scene_light_free(light);
  olx_scene_free(scene);
  print_message("%u panes: %.3f of the traced light\n", panes, solved / traced);
  return solved / traced;
}

// The lower faces of two panes lie in the same cells and face the same way. The upper one glows with the light that the
// panes pass to and fro.
static void a_room_behind_panes_has_the_light_of_paths(void **state) {
  (void)state;
  for (uint32_t panes = 0; panes < 3; panes++) assert_true(fabs(solved_share(panes) - 1.0) < 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_room_behind_panes_has_the_light_of_paths)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
