// Tests direct light of lamps that lie exactly on a surface, as spots recessed into a ceiling: the surface does not
// shadow them, and what hangs right below does.
#include "scene/direct_light.h"

#include "core/sampling.h"
#include "light/surfels/lamp_light.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { POINTS = 1000 };

// A room's size in place of 2 m, and where its middle is.
typedef struct setting {
  float scale;
  olx_vec3 offset;
} setting;

// Offsets are of tens of rooms: a float resolves a millionth of a room there.
static const setting settings[] = {
    {1.0f, {0.0f, 0.0f, 0.0f}},     {0.01f, {0.0f, 0.0f, 0.0f}},    {1000.0f, {0.0f, 0.0f, 0.0f}},
    {1.0f, {17.3f, -5.1f, 33.7f}},  {0.01f, {0.21f, 0.33f, -0.1f}}, {1000.0f, {-2e4f, 7e3f, 1.1e4f}},
    {1.0f, {-20.7f, 31.9f, 0.05f}},
};

static olx_vec3 placed(const setting *s, float x, float y, float z) {
  return olx_madd(s->offset, olx_v3(x, y, z), s->scale);
}

static void add_level(olx_scene *scene, const setting *s, olx_vec3 center, float size, bool up, uint32_t material) {
  const olx_vec3 along = {size * s->scale, 0.0f, 0.0f}, across = {0.0f, 0.0f, size * s->scale};
  made_quad(scene, placed(s, center.x, center.y, center.z), up ? across : along, up ? along : across, material);
}

// Makes a floor at y = 0 and a ceiling at y = 1 that a lamp at (0.1, 1, 0.2) lies on; `blocked`: with a plate 1 cm
// below the lamp, as wide as the cone there and wider.
static olx_scene *room(const setting *s, olx_light_type type, bool blocked) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t white = made_material(scene, &material);
  add_level(scene, s, olx_v3(0.0f, 0.0f, 0.0f), 2.0f, true, white);
  add_level(scene, s, olx_v3(0.0f, 1.0f, 0.0f), 2.0f, false, white);
  if (blocked) add_level(scene, s, olx_v3(0.1f, 0.99f, 0.2f), 0.2f, false, white);
  const olx_light light = {.type = type,
                           .position = placed(s, 0.1f, 1.0f, 0.2f),
                           .direction = {0.0f, -1.0f, 0.0f},
                           .emission = olx_splat(1.0f),
                           .cosine_inner = 0.3f,
                           .cosine_outer = 0.2f};
  assert_int_equal(olx_scene_add_light(scene, &light), OLX_OK);
  return made_finish(scene);
}

// Returns how many of the floor's points, which all lie in the cone, the lamp lights.
static uint32_t lit_points(const olx_scene *scene, const setting *s) {
  uint32_t lit = 0;
  for (uint32_t i = 0; i < POINTS; i++) {
    const olx_vec2 at = olx_hammersley(i, POINTS);
    const olx_ray down = {
        placed(s, 1.9f * at.x - 0.95f, 0.5f, 1.9f * at.y - 0.95f), {0.0f, -1.0f, 0.0f}, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &down);
    assert_int_not_equal(hit.triangle, OLX_NO_HIT);
    const olx_surface floor = olx_surface_at(scene, &hit, down.direction);
    olx_sampler sampler = {.index = i};
    uint64_t rays = 0;
    lit += olx_max3(olx_direct_irradiance(scene, &floor, NULL, &sampler, &rays)) > 0.0f;
  }
  return lit;
}

static void a_lamp_on_a_ceiling_lights_the_whole_floor(void **state) {
  (void)state;
  for (uint32_t k = 0; k < sizeof settings / sizeof *settings; k++) {
    for (uint32_t type = 0; type < 2; type++) {
      olx_scene *scene = room(&settings[k], type ? OLX_LIGHT_POINT : OLX_LIGHT_SPOT, false);
      const uint32_t lit = lit_points(scene, &settings[k]);
      if (lit != POINTS) fail_msg("setting %u, type %u: %u of %u points are lit", k, type, lit, POINTS);
      olx_scene_free(scene);
    }
  }
}

static void a_plate_right_below_the_lamp_shadows_it(void **state) {
  (void)state;
  for (uint32_t k = 0; k < sizeof settings / sizeof *settings; k++) {
    olx_scene *scene = room(&settings[k], OLX_LIGHT_SPOT, true);
    assert_int_equal(lit_points(scene, &settings[k]), 0);
    olx_scene_free(scene);
  }
}

// Lamps lie on a sloping ceiling, above or below it as rounding has it. The rays that look for their fixtures pass the
// ceiling and find the plate that hangs below each.
static void fixtures_of_lamps_on_a_slope_are_found(void **state) {
  (void)state;
  enum { LAMPS = 64 };
  for (uint32_t k = 0; k < sizeof settings / sizeof *settings; k++) {
    const setting *s = &settings[k];
    olx_scene *scene = made_scene();
    const olx_material material = olx_material_default();
    const uint32_t white = made_material(scene, &material);
    add_level(scene, s, olx_v3(0.0f, 0.0f, 0.0f), 2.0f, true, white);
    const olx_vec3 along = olx_scale(olx_v3(2.0f, 0.62f, 0.0f), s->scale), across = {0.0f, 0.0f, 2.0f * s->scale};
    made_quad(scene, placed(s, 0.0f, 1.0f, 0.0f), along, across, white);
    for (uint32_t i = 0; i < LAMPS; i++) {
      const olx_vec2 at = made_random(7, i);
      const float x = 1.8f * at.x - 0.9f, z = 1.8f * at.y - 0.9f;
      const olx_light light = {.type = OLX_LIGHT_SPOT,
                               .position = placed(s, x, 1.0f + 0.31f * x, z),
                               .direction = {0.0f, -1.0f, 0.0f},
                               .emission = olx_splat(1.0f),
                               .cosine_inner = 0.9f,
                               .cosine_outer = 0.8f};
      add_level(scene, s, olx_v3(x + 0.02f, 0.95f + 0.31f * x, z), 0.03f, true, white);
      assert_int_equal(olx_scene_add_light(scene, &light), OLX_OK);
    }
    made_finish(scene);
    olx_near_lamps lamps;
    assert_int_equal(olx_lamp_light_create(&lamps, scene, scene->lights, scene->light_count), OLX_OK);
    assert_non_null(lamps.radius);
    for (uint32_t i = 0; i < LAMPS; i++) assert_true(lamps.radius[i] > 0.05f * s->scale);
    olx_near_lamps_free(&lamps);
    olx_scene_free(scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_lamp_on_a_ceiling_lights_the_whole_floor),
      cmocka_unit_test(a_plate_right_below_the_lamp_shadows_it),
      cmocka_unit_test(fixtures_of_lamps_on_a_slope_are_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
