// Tests how points on lights are sampled: densities sum to one, samples agree with them, and irradiance agrees with
// closed forms.
#include "core/distribution.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/direct_light.h"
#include "scene/scene_build.h"
#include "scene/spherical_triangle.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_close(double value, double expected, double relative) {
  if (!(fabs(value - expected) <= relative * fabs(expected))) fail_msg("%.9g is not %.9g", value, expected);
}

static olx_material glowing(olx_vec3 radiance, bool both_sides) {
  olx_material material = olx_material_default();
  material.emission = radiance;
  material.emits_both_sides = both_sides;
  return material;
}

// Returns the mean irradiance of n unoccluded samples of a group on a surface at `position`.
static olx_vec3 irradiance(const olx_scene *scene, uint32_t group, olx_vec3 position, olx_vec3 normal, uint32_t n) {
  double sum[3] = {0.0, 0.0, 0.0};
  for (uint32_t i = 0; i < n; i++) {
    olx_light_sample s;
    const float pick = olx_unit_float(olx_reverse_bits(i));
    if (!olx_emitters_sample(scene, group, position, olx_stratified2(i, 3), pick, &s)) continue;
    const double cosine = (double)olx_max(olx_dot(s.direction, normal), 0.0f);
    sum[0] += cosine * (double)s.emission.x;
    sum[1] += cosine * (double)s.emission.y;
    sum[2] += cosine * (double)s.emission.z;
  }
  return olx_v3((float)(sum[0] / n), (float)(sum[1] / n), (float)(sum[2] / n));
}

// Returns the form factor of a rectangle a x b seen from distance c under its corner, parallel to the surface.
static double corner_form_factor(double a, double b, double c) {
  const double x = a / c, y = b / c, rx = sqrt(1.0 + x * x), ry = sqrt(1.0 + y * y);
  return (x / rx * atan(y / rx) + y / ry * atan(x / ry)) / (2.0 * 3.14159265358979323846);
}

// Makes a sky with a spot of one texel that is `contrast` times as bright as the rest.
static olx_scene *spotted_sky(float contrast) {
  enum { WIDTH = 64, HEIGHT = 32 };
  olx_scene *scene = made_scene();
  olx_environment *e = &scene->environment;
  *e = (olx_environment){.radiance = {1.0f, 1.0f, 1.0f}, .width = WIDTH, .height = HEIGHT};
  e->texels = olx_allocate((size_t)3 * WIDTH * HEIGHT, sizeof *e->texels);
  assert_non_null(e->texels);
  for (uint32_t i = 0; i < 3 * WIDTH * HEIGHT; i++) e->texels[i] = 1.0f;
  for (uint32_t c = 0; c < 3; c++) e->texels[3 * (HEIGHT / 2 * WIDTH + WIDTH / 4) + c] = contrast;
  const olx_material material = olx_material_default();
  made_square(scene, 0.0f, made_material(scene, &material));
  return made_finish(scene);
}

static void skies_with_a_sun_are_uneven(void **state) {
  (void)state;
  const struct {
    float contrast;
    bool even;
  } cases[] = {{1.0f, true}, {100.0f, true}, {400.0f, false}, {20000.0f, false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    olx_scene *scene = spotted_sky(cases[i].contrast);
    assert_int_equal(olx_environment_is_even(scene), cases[i].even);
    olx_scene_free(scene);
  }
}

// Returns the mean direct irradiance of the middle of a floor by 4,096 samples.
static double floor_irradiance(const olx_scene *scene, olx_direct_kinds kinds) {
  enum { SAMPLES = 4096 };
  const olx_direct_query query = {.kinds = kinds};
  const olx_surface surface = {.position = {0.0f, 0.0f, 0.0f},
                               .geometric_normal = {0.0f, 1.0f, 0.0f},
                               .shading_normal = {0.0f, 1.0f, 0.0f},
                               .epsilon = 1e-4f};
  double sum = 0.0;
  uint64_t rays = 0;
  for (uint32_t i = 0; i < SAMPLES; i++) {
    olx_sampler sampler = {.seed = 7, .index = i};
    sum += (double)olx_direct_irradiance_of(scene, &surface, &query, &sampler, &rays).x / SAMPLES;
  }
  return sum;
}

// A floor below a square lamp of 2 m at a height of 1 m and an even sky around it.
static void the_sky_and_other_light_add_up(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material paint = olx_material_default(), lamp = glowing(olx_splat(3.0f), false);
  made_square(scene, 0.0f, made_material(scene, &paint));
  made_quad(scene, olx_v3(0, 1, 0), olx_v3(2, 0, 0), olx_v3(0, 0, 2), made_material(scene, &lamp));
  scene->environment.radiance = olx_splat(2.0f);
  made_finish(scene);
  const double share = 4.0 * corner_form_factor(1.0, 1.0, 1.0), pi = 3.14159265358979323846;
  assert_close(floor_irradiance(scene, OLX_DIRECT_BUT_SKY), 3.0 * pi * share, 0.01);
  assert_close(floor_irradiance(scene, OLX_DIRECT_SKY), 2.0 * pi * (1.0 - share), 0.01);
  assert_close(floor_irradiance(scene, OLX_DIRECT_ALL), pi * (3.0 * share + 2.0 * (1.0 - share)), 0.01);
  olx_scene_free(scene);
}

static void a_rectangle_lights_a_parallel_surface_as_the_closed_form_says(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_vec3 radiance = {17.0f, 12.0f, 4.0f};
  assert_int_equal(olx_scene_add_rect_light(scene, olx_v3(0.0f, 1.5f, 0.0f), olx_v3(2.0f, 0.0f, 0.0f),
                                            olx_v3(0.0f, 0.0f, 1.0f), radiance),
                   OLX_OK);
  made_finish(scene);
  assert_int_equal(olx_emitters_group_count(scene), 1);
  assert_true(olx_emitters_group_varies(scene, 0));
  const olx_vec3 up = {0.0f, 1.0f, 0.0f};
  const olx_vec3 below = irradiance(scene, 0, olx_splat(0.0f), up, 1 << 16);
  const double pi = 3.14159265358979323846, center = 4.0 * corner_form_factor(1.0, 0.5, 1.5);
  assert_close((double)below.x, pi * 17.0 * center, 1e-3);
  assert_close((double)below.y, pi * 12.0 * center, 1e-3);
  assert_close((double)below.z, pi * 4.0 * center, 1e-3);
  // For a point away from the middle, form factors of rectangles are added and subtracted.
  const double off = corner_form_factor(1.7, 0.8, 1.5) - corner_form_factor(1.7, -0.2, 1.5) +
                     corner_form_factor(0.3, 0.8, 1.5) - corner_form_factor(0.3, -0.2, 1.5);
  assert_close((double)irradiance(scene, 0, olx_v3(0.7f, 0.0f, 0.3f), up, 1 << 16).x, pi * 17.0 * off, 1e-3);
  // Behind a light's front, no point can be sampled.
  olx_light_sample s;
  for (uint32_t i = 0; i < 100; i++) {
    assert_false(olx_emitters_sample(scene, 0, olx_v3(0.1f, 2.0f, 0.1f), made_random(1, i), 0.3f, &s));
  }
  olx_scene_free(scene);
}

// A ray along the sample's direction meets the sampled triangle, whose density there is the sample's.
static void sampled_triangles_have_the_density_that_rays_find(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material bright = glowing(olx_splat(3.0f), false), dim = glowing(olx_v3(0.1f, 0.2f, 0.4f), true);
  const uint32_t bright_index = made_material(scene, &bright), dim_index = made_material(scene, &dim);
  made_quad(scene, olx_v3(0.0f, 2.0f, 0.0f), olx_v3(1.0f, 0.1f, 0.0f), olx_v3(0.0f, 0.2f, 1.0f), dim_index);
  made_quad(scene, olx_v3(0.0f, -2.0f, 0.0f), olx_v3(1.0f, 0.0f, 0.0f), olx_v3(0.0f, 0.0f, -1.0f), bright_index);
  made_finish(scene);
  uint32_t seen = 0;
  for (uint32_t i = 0; i < 4000; i++) {
    const olx_vec2 away = made_random(7, i);
    const olx_vec3 position = {away.x - 0.5f, 0.0f, away.y - 0.5f};
    olx_light_sample s;
    const float pick = olx_unit_float(olx_hash2(9, i));
    if (!olx_emitters_sample(scene, 0, position, made_random(8, i), pick, &s)) continue;
    const olx_ray ray = {position, s.direction, 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    // A ray to a point at the very rim may miss.
    if (hit.triangle == OLX_NO_HIT) continue;
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    assert_close((double)olx_emitters_surface_pdf(scene, &surface, position, s.direction), (double)s.pdf, 1e-4);
    assert_close((double)(s.emission.x * s.pdf), (double)surface.emission.x, 1e-4);
    assert_true(olx_length(olx_sub(s.target, surface.position)) <= 4.0f * s.epsilon_end);
    assert_false(s.delta || s.infinite);
    seen++;
  }
  assert_true(seen > 3900);
  olx_scene_free(scene);
}

static void the_density_of_emitters_all_around_integrates_to_one(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = glowing(olx_v3(1.0f, 0.5f, 0.2f), false);
  made_room(scene, olx_splat(0.0f), 2.0f, made_material(scene, &material));
  made_finish(scene);
  const olx_vec3 position = {0.3f, -0.2f, 0.4f};
  double sum = 0.0;
  const uint32_t n = 1 << 16;
  for (uint32_t i = 0; i < n; i++) {
    const olx_ray ray = {position, olx_sample_sphere(olx_stratified2(i, 5)), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    sum += (double)olx_emitters_surface_pdf(scene, &surface, position, ray.direction);
  }
  assert_close(sum / n * 4.0 * (double)OLX_PI, 1.0, 2e-3);
  // Light that is the same from everywhere gives an irradiance of pi times its radiance. The noise is least in the
  // middle.
  const olx_vec3 e = irradiance(scene, 0, olx_splat(0.0f), olx_normalize(olx_v3(1.0f, 2.0f, 3.0f)), 1 << 20);
  assert_close((double)e.x, (double)OLX_PI, 2e-3);
  assert_close((double)e.z, (double)OLX_PI * 0.2, 2e-3);
  olx_scene_free(scene);
}

static void triangles_are_drawn_by_area_times_luminance(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material bright = glowing(olx_splat(6.0f), false), dim = glowing(olx_splat(1.0f), false);
  const olx_material black = olx_material_default();
  made_quad(scene, olx_splat(0.0f), olx_v3(1.0f, 0.0f, 0.0f), olx_v3(0.0f, 1.0f, 0.0f), made_material(scene, &bright));
  made_quad(scene, olx_v3(3.0f, 0.0f, 0.0f), olx_v3(2.0f, 0.0f, 0.0f), olx_v3(0.0f, 1.0f, 0.0f),
            made_material(scene, &black));
  made_quad(scene, olx_v3(9.0f, 0.0f, 0.0f), olx_v3(2.0f, 0.0f, 0.0f), olx_v3(0.0f, 1.0f, 0.0f),
            made_material(scene, &dim));
  made_finish(scene);
  // The expected densities: powers 3, 3, 0, 0, 1, 1 over areas 1/2, 1/2, 1, 1, 1, 1.
  const double expected[6] = {0.75, 0.75, 0.0, 0.0, 0.125, 0.125};
  for (uint32_t t = 0; t < 6; t++) assert_close((double)olx_emitters_area_pdf(scene, t), expected[t], 1e-6);
  olx_scene_free(scene);
}

static void textured_emission_is_drawn_by_its_mean_and_returns_its_texels(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  olx_material textured = glowing(olx_splat(4.0f), false);
  // Each quad's texture is dark in its left half; it is wide enough to be filtered sharply.
  uint8_t texels[64 * 4];
  for (uint32_t x = 0; x < 64; x++) {
    const uint8_t value = x < 32 ? 0 : 255, texel[4] = {value, value, value, 255};
    memcpy(texels + 4 * x, texel, 4);
  }
  textured.emission_texture = made_texture(scene, 64, 1, texels, false);
  const olx_material plain = glowing(olx_splat(2.0f), false);
  const olx_vec3 x = {1.0f, 0.0f, 0.0f}, y = {0.0f, 1.0f, 0.0f};
  made_quad(scene, olx_splat(0.0f), x, y, made_material(scene, &textured));
  made_quad(scene, olx_v3(5.0f, 0.0f, 0.0f), x, y, made_material(scene, &plain));
  made_finish(scene);
  // The two triangles share the bright half as 3 : 1, and the textured quad shines half as strongly as a uniform one of
  // 4.
  assert_close((double)olx_emitters_area_pdf(scene, 0), 2.0 * 0.5 * 0.75, 0.05);
  assert_close((double)olx_emitters_area_pdf(scene, 1), 2.0 * 0.5 * 0.25, 0.05);
  assert_close((double)(olx_emitters_area_pdf(scene, 2) + olx_emitters_area_pdf(scene, 3)), 1.0, 0.02);
  for (uint32_t i = 0; i < 500; i++) {
    olx_light_sample s;
    const float pick = olx_unit_float(olx_hash2(4, i));
    if (!olx_emitters_sample(scene, 0, olx_v3(0.0f, 0.0f, 1.0f), made_random(5, i), pick, &s)) continue;
    if (s.target.x > 2.0f) continue;
    assert_true(s.target.x > -0.05f || s.target.x < -0.45f);
  }
  olx_scene_free(scene);
}

// Samples of a large texture may all miss a small lit spot, which is the scene's light all the same.
static void find_small_spot(float first_tile) {
  enum { SIDE = 2048, SPOT = 8 };
  uint8_t *texels = calloc((size_t)SIDE * SIDE, 4);
  assert_non_null(texels);
  for (uint32_t y = 300; y < 300 + SPOT; y++) memset(texels + 4 * ((size_t)y * SIDE + 1237), 255, 4 * SPOT);
  olx_scene *scene = made_scene();
  olx_material screen = glowing(olx_splat(100.0f), false);
  screen.emission_texture = made_texture(scene, SIDE, SIDE, texels, false);
  made_quad(scene, olx_splat(0.0f), olx_v3(1.0f, 0.0f, 0.0f), olx_v3(0.0f, 1.0f, 0.0f), made_material(scene, &screen));
  for (uint32_t i = 0; i < scene->vertex_count; i++) scene->uvs[i].x += first_tile;
  made_finish(scene);
  free(texels);
  assert_int_equal(olx_emitters_group_count(scene), 1);
  // The triangle with the spot has all of the light.
  const float pdf[2] = {olx_emitters_area_pdf(scene, 0), olx_emitters_area_pdf(scene, 1)};
  assert_true((pdf[0] > 0.0f) != (pdf[1] > 0.0f));
  assert_close((double)(pdf[0] + pdf[1]), 2.0, 1e-5);
  olx_scene_free(scene);
}

// It is found in any repetition of the texture, as far out as floats can tell no texel from the next.
static void a_small_spot_in_a_large_texture_is_a_light(void **state) {
  (void)state;
  find_small_spot(0.0f);
  find_small_spot(16384.0f);
}

static void sun_point_and_spot_arrive_as_defined(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, -5.0f, made_material(scene, &material));
  const olx_vec3 emission = {8.0f, 4.0f, 2.0f}, down = {0.0f, -1.0f, 0.0f};
  const olx_light lights[3] = {
      {.type = OLX_LIGHT_SUN, .direction = {0.0f, -3.0f, 0.0f}, .emission = emission},
      {.type = OLX_LIGHT_POINT, .position = {0.0f, 2.0f, 0.0f}, .emission = emission},
      {.type = OLX_LIGHT_SPOT,
       .position = {0.0f, 2.0f, 0.0f},
       .direction = down,
       .emission = emission,
       .cosine_inner = 0.95f,
       .cosine_outer = 0.8f},
  };
  for (uint32_t i = 0; i < 3; i++) assert_int_equal(olx_scene_add_light(scene, &lights[i]), OLX_OK);
  made_finish(scene);
  assert_int_equal(olx_emitters_group_count(scene), 3);
  olx_light_sample s;
  const olx_vec2 random = {0.4f, 0.6f};
  for (uint32_t i = 0; i < 3; i++) {
    assert_false(olx_emitters_group_varies(scene, i));
    assert_true(olx_emitters_sample(scene, i, olx_splat(0.0f), random, 0.5f, &s));
    assert_true(s.delta);
    assert_int_equal(s.infinite, i == 0);
    assert_close((double)s.pdf, 1.0, 0.0);
    assert_close((double)s.direction.y, 1.0, 1e-6);
    assert_close((double)s.emission.y, i == 0 ? 4.0 : 1.0, 1e-6);
  }
  // The target of a sample of the sun is outside the scene, so a ray to it crosses the whole scene.
  assert_true(olx_emitters_sample(scene, 0, olx_splat(0.0f), random, 0.5f, &s));
  assert_true(s.target.y > 2.0f);
  // Away from the axis of the spot, light is full up to cosine 0.95, a quarter in the middle and none from 0.8.
  const float cosines[4] = {0.96f, 0.875f, 0.81f, 0.79f}, shares[4] = {1.0f, 0.25f, 1.0f / 225.0f, 0.0f};
  for (uint32_t i = 0; i < 4; i++) {
    const float c = cosines[i], across = sqrtf(1.0f - c * c);
    const bool lit = olx_emitters_sample(scene, 2, olx_v3(across, 2.0f - c, 0.0f), random, 0.5f, &s);
    assert_int_equal(lit, shares[i] > 0.0f);
    if (lit) assert_close((double)s.emission.x, 8.0 * (double)shares[i], 1e-3);
  }
  olx_scene_free(scene);
}

// Adds one light more of a kind than can have groups of their own; returns the irradiance of a surface that faces up.
static double add_many(olx_scene *scene, olx_light_type type, olx_vec3 position) {
  double expected = 0.0;
  for (uint32_t i = 0; i <= OLX_MAX_LIGHT_GROUPS; i++) {
    const olx_vec2 r = made_random(3, i);
    // One is far weaker than the others.
    olx_light light = {.type = type,
                       .position = {r.x, 1.0f + r.y, r.y},
                       .direction = {r.x - 0.5f, -1.0f, r.y - 0.5f},
                       .emission = olx_splat(i == 3 ? 1e-9f : 1.0f + (float)i)};
    assert_int_equal(olx_scene_add_light(scene, &light), OLX_OK);
    light = scene->lights[scene->light_count - 1];
    const olx_vec3 way = olx_sub(light.position, position);
    expected += type == OLX_LIGHT_POINT ? (double)(light.emission.x * way.y / powf(olx_length(way), 3.0f))
                                        : (double)(light.emission.x * -light.direction.y);
  }
  return expected;
}

static void many_lights_of_a_kind_share_one_group_and_sum_up(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, -5.0f, made_material(scene, &material));
  const olx_vec3 position = {0.1f, 0.0f, 0.2f}, up = {0.0f, 1.0f, 0.0f};
  const double lamps = add_many(scene, OLX_LIGHT_POINT, position), suns = add_many(scene, OLX_LIGHT_SUN, position);
  made_finish(scene);
  assert_int_equal(olx_emitters_group_count(scene), 2);
  for (uint32_t group = 0; group < 2; group++) {
    assert_true(olx_emitters_group_varies(scene, group));
    assert_false(olx_emitters_group_is_a_sun(scene, group));
    assert_close((double)irradiance(scene, group, position, up, 1 << 14).x, group == 0 ? suns : lamps, 2e-3);
  }
  olx_scene_free(scene);
}

// Suns have their own samples beside any number of lamps, and the other way round; the faintest light is drawn.
static void kinds_of_lights_do_not_share_a_group(void **state) {
  (void)state;
  for (uint32_t kind = 0; kind < 2; kind++) {
    olx_scene *scene = made_scene();
    const olx_material material = olx_material_default();
    made_square(scene, -5.0f, made_material(scene, &material));
    add_many(scene, kind ? OLX_LIGHT_SUN : OLX_LIGHT_POINT, olx_splat(0.0f));
    const olx_light other = {.type = kind ? OLX_LIGHT_POINT : OLX_LIGHT_SUN,
                             .position = {0.0f, 1.0f, 0.0f},
                             .direction = {0.0f, -1.0f, 0.0f},
                             .emission = olx_splat(800.0f)};
    assert_int_equal(olx_scene_add_light(scene, &other), OLX_OK);
    made_finish(scene);
    assert_int_equal(olx_emitters_group_count(scene), 2);
    assert_false(olx_emitters_group_varies(scene, 0));
    assert_int_equal(olx_emitters_group_is_a_sun(scene, 0), kind == 0);
    bool faintest = false;
    for (uint32_t i = 0; i < 4096; i++) {
      olx_light_sample s;
      const float pick = ((float)i + 0.5f) / 4096.0f;
      assert_true(olx_emitters_sample(scene, 0, olx_splat(0.0f), (olx_vec2){0}, pick, &s));
      assert_int_equal(s.light, OLX_MAX_LIGHT_GROUPS + 1);
      assert_true(olx_emitters_sample(scene, 1, olx_splat(0.0f), (olx_vec2){0}, pick, &s));
      faintest |= s.light == 3;
    }
    assert_true(faintest);
    olx_scene_free(scene);
  }
}

static void a_scene_without_light_has_no_groups(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, 0.0f, made_material(scene, &material));
  made_finish(scene);
  assert_int_equal(olx_emitters_group_count(scene), 0);
  assert_false(olx_environment_lit(scene));
  assert_true(olx_environment_pdf(scene, olx_v3(0.0f, 1.0f, 0.0f)) == 0.0f);
  olx_scene_free(scene);
}

static void a_constant_sky_gives_pi(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, 0.0f, made_material(scene, &material));
  scene->environment.radiance = olx_v3(1.0f, 2.0f, 3.0f);
  made_finish(scene);
  assert_int_equal(olx_emitters_group_count(scene), 1);
  const olx_vec3 e = irradiance(scene, 0, olx_splat(0.0f), olx_normalize(olx_v3(0.2f, 1.0f, -0.4f)), 1 << 14);
  assert_close((double)e.x, (double)OLX_PI, 2e-3);
  assert_close((double)e.z, 3.0 * (double)OLX_PI, 2e-3);
  olx_scene_free(scene);
}

// Makes an image sky with a small sun, dark and bright areas, and a black band.
static olx_scene *sky_scene(float rotation) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, 0.0f, made_material(scene, &material));
  olx_environment *e = &scene->environment;
  *e = (olx_environment){.radiance = {0.5f, 0.5f, 0.5f}, .width = 64, .height = 32, .rotation_radians = rotation};
  e->texels = olx_allocate((size_t)e->width * e->height * 3, sizeof(float));
  assert_non_null(e->texels);
  for (uint32_t i = 0; i < e->width * e->height; i++) {
    const uint32_t x = i % e->width, y = i / e->width;
    float value = y > 25 ? 0.0f : 0.2f + olx_unit_float(olx_hash2(x, y));
    if (x == 40 && y == 6) value = 2000.0f;
    e->texels[3 * i] = value;
    e->texels[3 * i + 1] = 0.8f * value;
    e->texels[3 * i + 2] = 0.5f * value;
  }
  return made_finish(scene);
}

static void the_density_of_an_image_sky_integrates_to_one(void **state) {
  (void)state;
  olx_scene *scene = sky_scene(1.0f);
  double sum = 0.0, light = 0.0;
  const uint32_t n = 1 << 20;
  for (uint32_t i = 0; i < n; i++) {
    const olx_vec3 d = olx_sample_sphere(olx_hammersley(i, n));
    const double pdf = (double)olx_environment_pdf(scene, d);
    const double radiance = (double)olx_environment_radiance(scene, d).x;
    // Every direction with light can be sampled.
    assert_true(pdf > 0.0 || radiance == 0.0);
    sum += pdf;
    light += radiance;
  }
  assert_close(sum / n * 4.0 * (double)OLX_PI, 1.0, 5e-3);
  // The samples' mean is the integral of the radiance, with little noise in spite of the strong sun.
  double drawn = 0.0;
  const uint32_t samples = 1 << 14;
  for (uint32_t i = 0; i < samples; i++) {
    olx_light_sample s;
    // A sample may be black, since texels at the border of the black band are black in part.
    if (!olx_emitters_sample(scene, 0, olx_splat(0.0f), olx_stratified2(i, 1), 0.0f, &s)) continue;
    assert_true(s.infinite && !s.delta);
    assert_close((double)olx_length(s.direction), 1.0, 1e-5);
    drawn += (double)s.emission.x;
  }
  assert_close(drawn / samples, light / n * 4.0 * (double)OLX_PI, 1e-2);
  olx_scene_free(scene);
}

static void sampled_sky_directions_have_the_density_that_is_asked_for(void **state) {
  (void)state;
  olx_scene *scene = sky_scene(-2.0f);
  uint32_t agree = 0, drawn = 0;
  for (uint32_t i = 0; i < 4000; i++) {
    olx_light_sample s;
    if (!olx_emitters_sample(scene, 0, olx_splat(0.0f), made_random(2, i), 0.0f, &s)) continue;
    drawn++;
    const double pdf = (double)olx_environment_pdf(scene, s.direction);
    agree += fabs(pdf - (double)s.pdf) <= 1e-4 * (double)s.pdf;
  }
  // Rounding may move a direction on the border of two texels into the other texel.
  assert_true(drawn > 3950 && agree >= drawn - 10);
  olx_scene_free(scene);
}

static void rotation_turns_the_sky_about_y(void **state) {
  (void)state;
  const float angle = 0.7f, c = cosf(angle), w = sinf(angle);
  olx_scene *still = sky_scene(0.0f), *turned = sky_scene(angle);
  for (uint32_t i = 0; i < 200; i++) {
    const olx_vec3 d = olx_sample_sphere(made_random(6, i));
    // The rotation is right-handed about +y: z turns towards x.
    const olx_vec3 there = {c * d.x + w * d.z, d.y, c * d.z - w * d.x};
    const float a = olx_environment_radiance(still, d).x, b = olx_environment_radiance(turned, there).x;
    assert_true(fabsf(a - b) <= 1e-3f * (1.0f + a));
  }
  // The image's middle is towards +x, its first row towards +y.
  const olx_environment *e = &still->environment;
  const olx_vec3 high = olx_environment_radiance(still, olx_v3(1e-4f, 1.0f, 0.0f));
  const size_t middle = e->width / 2;
  const float expected = 0.25f * (e->texels[3 * middle] + e->texels[3 * (middle - 1)]);
  assert_close((double)high.x, (double)expected, 1e-2);
  olx_scene_free(still);
  olx_scene_free(turned);
}

static void distributions_draw_in_proportion_and_never_what_has_no_weight(void **state) {
  (void)state;
  const float weights[6] = {0.0f, 1.0f, 0.0f, 3.0f, 4.0f, 0.0f};
  float sums[7];
  assert_true(olx_distribution_build(weights, 6, sums));
  uint32_t drawn[6] = {0};
  for (uint32_t i = 0; i < 8000; i++) {
    float rest;
    drawn[olx_distribution_draw(sums, 6, ((float)i + 0.5f) / 8000.0f, &rest)]++;
    assert_true(rest >= 0.0f && rest < 1.0f);
  }
  const uint32_t expected[6] = {0, 1000, 0, 3000, 4000, 0};
  assert_memory_equal(drawn, expected, sizeof expected);
  assert_int_equal(olx_distribution_draw(sums, 6, 0.0f, NULL), 1);
  assert_int_equal(olx_distribution_draw(sums, 6, 0x1.fffffep-1f, NULL), 4);
  const float nothing[2] = {0.0f, 0.0f};
  assert_false(olx_distribution_build(nothing, 2, sums));
}

// Returns the relative spread (standard deviation over mean) of single samples' unoccluded irradiance.
static double spread(const olx_scene *scene, olx_vec3 position, olx_vec3 normal) {
  const uint32_t n = 20000;
  double sum = 0.0, squares = 0.0;
  for (uint32_t i = 0; i < n; i++) {
    olx_light_sample s;
    const float pick = olx_unit_float(olx_hash2(11, i));
    if (!olx_emitters_sample(scene, 0, position, made_random(12, i), pick, &s)) continue;
    const double light = (double)(s.emission.x * olx_max(olx_dot(s.direction, normal), 0.0f));
    sum += light, squares += light * light;
  }
  return sqrt(squares / n - sum * sum / n / n) / (sum / n);
}

static void lamps_nearby_are_drawn_with_little_noise(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_vec3 x = {1.0f, 0.0f, 0.0f}, z = {0.0f, 0.0f, 1.0f}, radiance = olx_splat(5.0f);
  assert_int_equal(olx_scene_add_rect_light(scene, olx_v3(0.0f, 0.4f, 0.0f), x, z, radiance), OLX_OK);
  assert_int_equal(olx_scene_add_rect_light(scene, olx_v3(20.0f, 0.4f, 0.0f), x, z, radiance), OLX_OK);
  made_finish(scene);
  const olx_vec3 up = {0.0f, 1.0f, 0.0f};
  // If lamps were sampled by power alone, the far lamp would take half of the samples, and the spread would exceed 1.
  assert_true(spread(scene, olx_splat(0.0f), up) < 0.25);
  // The spread stays bounded almost at the lamp's surface, where a density over area has no bound.
  assert_true(spread(scene, olx_v3(0.1f, 0.39f, 0.1f), up) < 1.0);
  const double factor = corner_form_factor(0.6, 0.6, 0.01) + 2.0 * corner_form_factor(0.6, 0.4, 0.01) +
                        corner_form_factor(0.4, 0.4, 0.01);
  const olx_vec3 e = irradiance(scene, 0, olx_v3(0.1f, 0.39f, 0.1f), up, 1 << 16);
  assert_close((double)e.x, 3.14159265358979323846 * 5.0 * factor, 1e-2);
  olx_scene_free(scene);
}

static void a_spherical_triangle_has_the_area_of_its_angles(void **state) {
  (void)state;
  const olx_vec3 octant[3] = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
  assert_close((double)olx_spherical_triangle_area(octant), 0.5 * 3.14159265358979323846, 1e-6);
  const olx_vec3 wide[3] = {
      {1.0f, 0.0f, 0.0f}, {-0.5f, 0.8660254f, 0.0f}, olx_normalize(olx_v3(-0.5f, -0.8660254f, 0.01f))};
  assert_close((double)olx_spherical_triangle_area(wide), 2.0 * 3.14159265358979323846, 0.02);
}

// Directions sampled from a triangle are inside it, and each part of it receives its share.
static void spherical_triangles_are_sampled_evenly(void **state) {
  (void)state;
  for (uint32_t k = 0; k < 50; k++) {
    olx_vec3 corners[3];
    for (uint32_t i = 0; i < 3; i++) corners[i] = olx_sample_sphere(made_random(20 + i, k));
    const float whole = olx_spherical_triangle_area(corners);
    if (whole < 0.03f) continue;
    // This is the part on b's side of the bisector from c to the middle of ab.
    const olx_vec3 middle = olx_normalize(olx_add(corners[0], corners[1]));
    const olx_vec3 part[3] = {middle, corners[1], corners[2]};
    const olx_vec3 plane = olx_cross(middle, corners[2]);
    const float side = olx_dot(plane, corners[1]);
    const olx_vec3 inside = olx_add(olx_add(corners[0], corners[1]), corners[2]);
    uint32_t in_part = 0;
    const uint32_t n = 4096;
    for (uint32_t i = 0; i < n; i++) {
      const olx_vec3 d = olx_spherical_triangle_sample(corners, olx_hammersley(i, n));
      assert_true(fabsf(olx_length(d) - 1.0f) < 1e-5f);
      for (uint32_t e = 0; e < 3; e++) {
        const olx_vec3 edge = olx_cross(corners[e], corners[(e + 1) % 3]);
        assert_true(olx_dot(edge, d) * (olx_dot(edge, inside) > 0.0f ? 1.0f : -1.0f) > -2e-4f);
      }
      in_part += olx_dot(plane, d) * side > 0.0f;
    }
    const float share = olx_spherical_triangle_area(part) / whole;
    assert_true(fabsf((float)in_part / (float)n - share) < 0.01f);
  }
}

// Corners and random numbers at the ends of their ranges give unit vectors.
static void slivers_are_sampled_without_breaking(void **state) {
  (void)state;
  const olx_vec3 slivers[][3] = {
      {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, olx_normalize(olx_v3(1.0f, 1.0f, 1e-4f))},
      {{1.0f, 0.0f, 0.0f}, olx_normalize(olx_v3(-1.0f, 1e-3f, 0.0f)), {0.0f, 0.0f, 1.0f}},
      {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 1.0f, 0.0f}},
  };
  const float ends[] = {0.0f, 1e-7f, 0.5f, 0x1.fffffep-1f};
  for (size_t k = 0; k < sizeof slivers / sizeof *slivers; k++) {
    for (uint32_t i = 0; i < 16; i++) {
      const olx_vec3 d = olx_spherical_triangle_sample(slivers[k], (olx_vec2){ends[i & 3], ends[i >> 2]});
      assert_true(fabsf(olx_length(d) - 1.0f) < 1e-4f);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_rectangle_lights_a_parallel_surface_as_the_closed_form_says),
      cmocka_unit_test(sampled_triangles_have_the_density_that_rays_find),
      cmocka_unit_test(the_density_of_emitters_all_around_integrates_to_one),
      cmocka_unit_test(lamps_nearby_are_drawn_with_little_noise),
      cmocka_unit_test(a_spherical_triangle_has_the_area_of_its_angles),
      cmocka_unit_test(spherical_triangles_are_sampled_evenly),
      cmocka_unit_test(slivers_are_sampled_without_breaking),
      cmocka_unit_test(triangles_are_drawn_by_area_times_luminance),
      cmocka_unit_test(textured_emission_is_drawn_by_its_mean_and_returns_its_texels),
      cmocka_unit_test(a_small_spot_in_a_large_texture_is_a_light),
      cmocka_unit_test(sun_point_and_spot_arrive_as_defined),
      cmocka_unit_test(many_lights_of_a_kind_share_one_group_and_sum_up),
      cmocka_unit_test(kinds_of_lights_do_not_share_a_group),
      cmocka_unit_test(a_scene_without_light_has_no_groups),
      cmocka_unit_test(a_constant_sky_gives_pi),
      cmocka_unit_test(skies_with_a_sun_are_uneven),
      cmocka_unit_test(the_sky_and_other_light_add_up),
      cmocka_unit_test(the_density_of_an_image_sky_integrates_to_one),
      cmocka_unit_test(sampled_sky_directions_have_the_density_that_is_asked_for),
      cmocka_unit_test(rotation_turns_the_sky_about_y),
      cmocka_unit_test(distributions_draw_in_proportion_and_never_what_has_no_weight),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
