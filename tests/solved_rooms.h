// The light of made rooms, solved from one probe near their middle.
#ifndef OLX_TESTS_SOLVED_ROOMS_H
#define OLX_TESTS_SOLVED_ROOMS_H

#include "light/scene_light.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static inline olx_scene_light *solve_room(const olx_scene *scene, float noise) {
  const olx_vec3 probe = {0.3f, 0.1f, 0.2f};
  const uint8_t flag = 0;
  olx_scene_light_settings settings = olx_scene_light_settings_default();
  settings.map_size = 64;
  settings.noise = noise;
  settings.threads = 2;
  olx_scene_light *light;
  assert_int_equal(olx_scene_light_create(scene, &settings, &probe, &flag, 1, &light), OLX_OK);
  return light;
}

#endif
