// Tests scenes with more point and spot lights than have samples of their own: each place gets the light of its lamps
// with bounded noise, whatever a sun and other rooms have.
#include "core/sampling.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/direct_light.h"
#include "scene/scene_build.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// Lamps stand in a grid of this many columns, in cells of this size, at a height above the floor.
enum { COLUMNS = 5 };
static const float cell = 3.2f, height = 2.5f;

static void add_light(olx_scene *scene, const olx_light *light) {
  assert_int_equal(olx_scene_add_light(scene, light), OLX_OK);
}

static void add_sun(olx_scene *scene, float irradiance) {
  add_light(scene,
            &(olx_light){.type = OLX_LIGHT_SUN, .direction = {0.3f, -1.0f, 0.2f}, .emission = olx_splat(irradiance)});
}

static olx_vec3 floor_of(uint32_t lamp) {
  return olx_v3(cell * (float)(lamp % COLUMNS), 0.0f, cell * (float)(lamp / COLUMNS));
}

static void add_lamps(olx_scene *scene, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec2 r = made_random(1, i);
    const olx_vec3 off = {r.x - 0.5f, height, r.y - 0.5f};
    add_light(scene, &(olx_light){.type = OLX_LIGHT_POINT,
                                  .position = olx_add(floor_of(i), off),
                                  .emission = olx_splat(3.0f + 4.0f * made_random(2, i).x)});
  }
}

// Adds a triangle so far away that the scene's diagonal is more than 1 km.
static void add_far_triangle(olx_scene *scene, uint32_t material) {
  const olx_vec3 corners[3] = {{1000.0f, 0.0f, 0.0f}, {1001.0f, 0.0f, 0.0f}, {1000.0f, 0.0f, 1.0f}};
  const uint32_t indices[3] = {0, 1, 2};
  assert_int_equal(olx_scene_add_mesh(scene, "far", corners, NULL, NULL, 3, indices, 1, material), OLX_OK);
}

// Adds the lights in either order.
static void add_sun_and_lamps(olx_scene *scene, uint32_t lamps, bool sun_first) {
  if (sun_first) add_sun(scene, 800.0f);
  add_lamps(scene, lamps);
  if (!sun_first) add_sun(scene, 800.0f);
}

// Makes one closed hall with all lamps.
static olx_scene *hall(uint32_t lamps, bool sun_first) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t white = made_material(scene, &material);
  const float rows = (float)((lamps + COLUMNS - 1) / COLUMNS);
  made_box(scene, olx_v3(-0.5f * cell, 0.0f, -0.5f * cell),
           olx_v3(((float)COLUMNS - 0.5f) * cell, 3.0f, (rows - 0.5f) * cell), false, white);
  add_far_triangle(scene, white);
  add_sun_and_lamps(scene, lamps, sun_first);
  return made_finish(scene);
}

// Makes a closed room around each lamp.
static olx_scene *rooms(uint32_t lamps, bool sun_first) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t white = made_material(scene, &material);
  for (uint32_t i = 0; i < lamps; i++) {
    const olx_vec3 half = {1.5f, 0.0f, 1.5f}, top = {0.0f, 3.0f, 0.0f};
    made_box(scene, olx_sub(floor_of(i), half), olx_add(olx_add(floor_of(i), half), top), false, white);
  }
  add_far_triangle(scene, white);
  add_sun_and_lamps(scene, lamps, sun_first);
  return made_finish(scene);
}

static olx_surface surface_below(const olx_scene *scene, olx_vec3 place) {
  const olx_ray ray = {olx_add(place, olx_v3(0.0f, 1.0f, 0.0f)), olx_v3(0.0f, -1.0f, 0.0f), 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  assert_int_not_equal(hit.triangle, OLX_NO_HIT);
  return olx_surface_at(scene, &hit, ray.direction);
}

// Returns the irradiance of a floor from one lamp that nothing hides. *most receives that of a surface which faces it.
static double lamp_irradiance(const olx_light *light, olx_vec3 position, double *most) {
  const olx_vec3 way = olx_sub(light->position, position);
  const double squared = (double)olx_dot(way, way), intensity = (double)light->emission.x;
  *most = intensity / squared;
  return intensity / squared * (double)way.y / sqrt(squared);
}

typedef struct estimate {
  double mean, spread; // of single samples: standard deviation over mean
} estimate;

static estimate sample_light(const olx_scene *scene, const olx_surface *surface, uint32_t seed, uint32_t count) {
  double sum = 0.0, squares = 0.0;
  uint64_t rays = 0;
  for (uint32_t i = 0; i < count; i++) {
    olx_sampler sampler = {.seed = seed, .index = i};
    const double light = (double)olx_direct_irradiance(scene, surface, NULL, &sampler, &rays).x;
    sum += light;
    squares += light * light;
  }
  const double mean = sum / count;
  return (estimate){mean, mean > 0.0 ? sqrt(fmax(squares / count - mean * mean, 0.0)) / mean : INFINITY};
}

// What a place gets from lamps that it sees, and what it would get from all lamps if it faced each and nothing hid any.
typedef struct wanted {
  double seen, most;
} wanted;

static wanted light_wanted(const olx_scene *scene, olx_vec3 position, uint32_t only) {
  wanted w = {0};
  for (uint32_t i = 0, lamp = 0; i < scene->light_count; i++) {
    double most = 0.0;
    if (scene->lights[i].type == OLX_LIGHT_SUN) continue;
    const double light = lamp_irradiance(&scene->lights[i], position, &most);
    if (only == UINT32_MAX || only == lamp) w.seen += light;
    w.most += most;
    lamp++;
  }
  return w;
}

// The variance of a sample is at most (sum of f^2 / p) - E^2, where f is what a lamp brings and p its probability. Of a
// lamp that brings at most m, p is at least 7/8 m / M, M being the sum of all m; a far cluster counts as up to four
// times the light of its lamps or a quarter of it. So the relative standard deviation is at most sqrt(4 * 8/7 M / E).
static void check_place(const olx_scene *scene, olx_vec3 place, uint32_t only, uint32_t seed) {
  const olx_surface floor = surface_below(scene, place);
  const wanted w = light_wanted(scene, floor.position, only);
  const estimate e = sample_light(scene, &floor, seed, 1 << 12);
  if (fabs(e.mean / w.seen - 1.0) > 0.05) fail_msg("place %u has %g instead of %g", seed, e.mean, w.seen);
  assert_true(e.spread < sqrt(4.0 * 8.0 / 7.0 * w.most / w.seen));
}

static void a_hall_beside_a_sun_gets_the_light_of_all_its_lamps(void **state) {
  (void)state;
  for (uint32_t order = 0; order < 2; order++) {
    olx_scene *scene = hall(20, order == 0);
    for (uint32_t i = 0; i < 20; i += 3) {
      check_place(scene, olx_add(floor_of(i), olx_v3(0.7f, 0.0f, -0.4f)), UINT32_MAX, i);
    }
    olx_scene_free(scene);
  }
}

static void each_room_beside_a_sun_gets_the_light_of_its_lamp(void **state) {
  (void)state;
  for (uint32_t order = 0; order < 2; order++) {
    olx_scene *scene = rooms(20, order == 0);
    for (uint32_t i = 0; i < 20; i++) check_place(scene, olx_add(floor_of(i), olx_v3(0.6f, 0.0f, 0.2f)), i, i);
    olx_scene_free(scene);
  }
}

// With many clusters of lamps, too.
static void rooms_of_hundreds_of_lamps_get_the_light_of_their_own(void **state) {
  (void)state;
  olx_scene *scene = rooms(400, true);
  for (uint32_t i = 0; i < 400; i += 37) check_place(scene, olx_add(floor_of(i), olx_v3(0.6f, 0.0f, 0.2f)), i, i);
  olx_scene_free(scene);
}

static void every_lamp_is_drawn_as_often_as_it_says(void **state) {
  (void)state;
  enum { MOST = 1000, DRAWS = 1 << 18 };
  const uint32_t counts[] = {17, 100, MOST};
  for (uint32_t k = 0; k < 3; k++) {
    olx_scene *scene = hall(counts[k], true);
    static uint32_t drawn[MOST + 1];
    static double claimed[MOST + 1];
    for (uint32_t i = 0; i <= counts[k]; i++) drawn[i] = 0, claimed[i] = 0.0;
    const olx_vec3 place = olx_add(floor_of(counts[k] / 2), olx_v3(0.3f, 0.1f, 0.4f));
    for (uint32_t i = 0; i < DRAWS; i++) {
      olx_light_sample s;
      const float pick = ((float)i + 0.5f) / (float)DRAWS;
      assert_true(olx_emitters_sample(scene, 1, place, (olx_vec2){0.5f, 0.5f}, pick, &s));
      assert_true(s.delta && !s.infinite && s.pdf == 1.0f);
      double most;
      (void)lamp_irradiance(&scene->lights[s.light], place, &most);
      claimed[s.light] = most / (double)s.emission.x;
      drawn[s.light]++;
    }
    double sum = 0.0;
    for (uint32_t i = 1; i <= counts[k]; i++) {
      assert_true(claimed[i] >= 0.124 / counts[k]);
      // Two ranges of random numbers draw a lamp, and their four ends may each miss or gain one.
      assert_true(fabs((double)drawn[i] / DRAWS - claimed[i]) < 4.0 / DRAWS + 1e-5);
      sum += claimed[i];
    }
    assert_true(fabs(sum - 1.0) < 1e-4);
    olx_scene_free(scene);
  }
}

// Adds a spot at the ceiling of a cell of the hall that lights the floor below it alone.
static void add_spots(olx_scene *scene, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    add_light(scene, &(olx_light){.type = OLX_LIGHT_SPOT,
                                  .position = olx_add(floor_of(i), olx_v3(0.0f, height, 0.0f)),
                                  .direction = {0.0f, -1.0f, 0.0f},
                                  .emission = olx_splat(5.0f),
                                  .cosine_inner = 0.95f,
                                  .cosine_outer = 0.9f});
  }
}

// A spot that does not light a place takes no more than its least share of the samples. Places between spots are dark.
static void spots_are_drawn_where_they_shine(void **state) {
  (void)state;
  enum { SPOTS = 400 };
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, -5.0f, made_material(scene, &material));
  add_spots(scene, SPOTS);
  made_finish(scene);
  for (uint32_t i = 0; i < SPOTS; i += 7) {
    uint32_t lit = 0;
    for (uint32_t k = 0; k < 4096; k++) {
      const float pick = ((float)k + 0.5f) / 4096.0f;
      olx_light_sample s;
      const olx_vec3 between = olx_add(floor_of(i), olx_v3(0.5f * cell, 0.0f, 0.5f * cell));
      assert_false(olx_emitters_sample(scene, 0, between, (olx_vec2){0}, pick, &s));
      if (!olx_emitters_sample(scene, 0, floor_of(i), (olx_vec2){0}, pick, &s)) continue;
      assert_int_equal(s.light, i);
      lit++;
    }
    // Seven eighths go to clusters. The spot's own is near, and no far one shines there.
    assert_true(lit >= 4096 / 8 * 7 - 1);
  }
  olx_scene_free(scene);
}

// Lamps at one place, one at the very place that is lit, and black ones.
static void degenerate_lamps_break_nothing(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, 0.0f, made_material(scene, &material));
  for (uint32_t i = 0; i < 40; i++) {
    add_light(scene, &(olx_light){.type = OLX_LIGHT_POINT,
                                  .position = {0.0f, i < 30 ? 1.0f : 0.0f, 0.0f},
                                  .emission = olx_splat(i % 3 ? 1.0f : 0.0f)});
  }
  made_finish(scene);
  double sum = 0.0;
  for (uint32_t i = 0; i < 4096; i++) {
    olx_light_sample s;
    if (!olx_emitters_sample(scene, 0, olx_splat(0.0f), (olx_vec2){0}, ((float)i + 0.5f) / 4096.0f, &s)) continue;
    assert_true(olx_finite(s.emission));
    sum += (double)s.emission.x / 4096.0;
  }
  assert_true(isfinite(sum));
  const olx_vec3 place = {0.0f, 0.5f, 0.0f};
  sum = 0.0;
  for (uint32_t i = 0; i < 4096; i++) {
    olx_light_sample s;
    if (!olx_emitters_sample(scene, 0, place, (olx_vec2){0}, ((float)i + 0.5f) / 4096.0f, &s)) continue;
    sum += (double)s.emission.x / 4096.0;
  }
  // 26 of the lamps shine, half a metre away.
  assert_true(fabs(sum / (26.0 * 4.0) - 1.0) < 0.01);
  olx_scene_free(scene);
}

static void suns_are_known_however_many_lamps_there_are(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, 0.0f, made_material(scene, &material));
  add_sun_and_lamps(scene, 20, true);
  made_finish(scene);
  const olx_surface floor = surface_below(scene, olx_v3(0.2f, 0.0f, 0.1f));
  uint64_t rays = 0;
  const olx_vec3 sun = olx_direct_irradiance_of_suns(scene, &floor, &rays);
  const float expected = -800.0f * scene->lights[0].direction.y;
  assert_true(fabsf(sun.x / expected - 1.0f) < 1e-5f);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_hall_beside_a_sun_gets_the_light_of_all_its_lamps),
      cmocka_unit_test(each_room_beside_a_sun_gets_the_light_of_its_lamp),
      cmocka_unit_test(rooms_of_hundreds_of_lamps_get_the_light_of_their_own),
      cmocka_unit_test(every_lamp_is_drawn_as_often_as_it_says),
      cmocka_unit_test(spots_are_drawn_where_they_shine),
      cmocka_unit_test(degenerate_lamps_break_nothing),
      cmocka_unit_test(suns_are_known_however_many_lamps_there_are),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
