// Tests the ray caster: what it hits, what it lets through, and that packets give the same answers as single rays.
#include "core/sampling.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"
#include "scene/surface.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include <cmocka.h>

// Scatters triangles in the cube [-1, 1]^3 by hashing.
static olx_scene *strewn_scene(uint32_t triangles, uint32_t seed) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t index = made_material(scene, &material);
  for (uint32_t t = 0; t < triangles; t++) {
    olx_vec3 corners[3];
    olx_vec3 center = {0.0f, 0.0f, 0.0f};
    for (uint32_t k = 0; k < 4; k++) {
      const uint32_t h = olx_hash3(seed, t, k);
      const olx_vec3 p = {olx_unit_float(h), olx_unit_float(olx_hash(h + 1)), olx_unit_float(olx_hash(h + 2))};
      const olx_vec3 q = olx_add(olx_scale(p, 2.0f), olx_splat(-1.0f));
      if (k == 0) center = q;
      else corners[k - 1] = olx_madd(center, q, 0.2f);
    }
    const uint32_t indices[3] = {0, 1, 2};
    assert_int_equal(olx_scene_add_mesh(scene, "strewn", corners, NULL, NULL, 3, indices, 1, index), OLX_OK);
  }
  return made_finish(scene);
}

static olx_ray random_ray(uint32_t seed) {
  const olx_vec2 a = {olx_unit_float(olx_hash2(seed, 1)), olx_unit_float(olx_hash2(seed, 2))};
  const olx_vec2 b = {olx_unit_float(olx_hash2(seed, 3)), olx_unit_float(olx_hash2(seed, 4))};
  return (olx_ray){olx_scale(olx_sample_sphere(a), 1.2f), olx_sample_sphere(b), 0.0f, INFINITY};
}

// Returns the distance of the nearest hit, tested against every triangle in double precision; negative for a miss.
static double nearest_by_search(const olx_scene *scene, const olx_ray *ray) {
  double nearest = -1.0;
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    const uint32_t *i = scene->indices + 3 * (size_t)t;
    const olx_vec3 a = scene->positions[i[0]], b = scene->positions[i[1]], c = scene->positions[i[2]];
    const double e1[3] = {(double)b.x - a.x, (double)b.y - a.y, (double)b.z - a.z};
    const double e2[3] = {(double)c.x - a.x, (double)c.y - a.y, (double)c.z - a.z};
    const double d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double s[3] = {(double)ray->origin.x - a.x, (double)ray->origin.y - a.y, (double)ray->origin.z - a.z};
    const double p[3] = {d[1] * e2[2] - d[2] * e2[1], d[2] * e2[0] - d[0] * e2[2], d[0] * e2[1] - d[1] * e2[0]};
    const double q[3] = {s[1] * e1[2] - s[2] * e1[1], s[2] * e1[0] - s[0] * e1[2], s[0] * e1[1] - s[1] * e1[0]};
    const double determinant = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
    const double u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / determinant;
    const double v = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / determinant;
    const double distance = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || distance < 0.0) continue;
    if (nearest < 0.0 || distance < nearest) nearest = distance;
  }
  return nearest;
}

static void rays_hit_what_a_search_over_all_triangles_finds(void **state) {
  (void)state;
  olx_scene *scene = strewn_scene(300, 7);
  uint32_t disagreements = 0, hits = 0;
  for (uint32_t i = 0; i < 4000; i++) {
    const olx_ray ray = random_ray(i);
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    const double truth = nearest_by_search(scene, &ray);
    const bool found = hit.triangle != OLX_NO_HIT;
    assert_int_equal(olx_bvh_occluded(scene->bvh, &ray), found);
    hits += found;
    if (found != (truth >= 0.0) || (found && fabs((double)hit.t - truth) > 1e-5)) disagreements++;
  }
  assert_true(hits > 500);
  // A ray within rounding of an edge may hit or miss.
  assert_true(disagreements <= 1);
  olx_scene_free(scene);
}

static void barycentric_coordinates_give_the_hit_point(void **state) {
  (void)state;
  olx_scene *scene = strewn_scene(300, 9);
  for (uint32_t i = 0; i < 2000; i++) {
    const olx_ray ray = random_ray(i);
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    const olx_vec3 along = olx_madd(ray.origin, ray.direction, hit.t);
    assert_true(olx_length(olx_sub(along, surface.position)) < 4e-6f);
  }
  olx_scene_free(scene);
}

// Arrays of every length are tested, so that the last packet is filled to every degree.
static void packets_answer_as_single_rays(void **state) {
  (void)state;
  olx_scene *scene = strewn_scene(300, 11);
  enum { MOST = 77 };
  olx_ray rays[MOST];
  olx_ray_hit hits[MOST];
  uint8_t occluded[MOST];
  for (uint32_t count = 0; count <= MOST; count++) {
    const bool coherent = count % 2 == 0;
    for (uint32_t i = 0; i < count; i++) rays[i] = random_ray(1000 * count + i);
    olx_bvh_intersect_many(scene->bvh, rays, count, coherent, hits);
    olx_bvh_occluded_many(scene->bvh, rays, count, coherent, occluded);
    for (uint32_t i = 0; i < count; i++) {
      const olx_ray_hit single = olx_bvh_intersect(scene->bvh, &rays[i]);
      assert_int_equal(hits[i].triangle, single.triangle);
      assert_int_equal(occluded[i], single.triangle != OLX_NO_HIT);
      if (single.triangle == OLX_NO_HIT) continue;
      assert_true(fabsf(hits[i].t - single.t) <= 1e-5f * single.t);
      assert_true(fabsf(hits[i].u - single.u) < 1e-4f && fabsf(hits[i].v - single.v) < 1e-4f);
    }
  }
  olx_scene_free(scene);
}

static void rays_end_at_t_max_and_begin_at_t_min(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_square(scene, 0.0f, made_material(scene, &material));
  made_finish(scene);
  const struct {
    float t_min, t_max;
    bool hit, occluded;
  } cases[] = {{0.0f, 4.0f, true, true}, {0.0f, 1.9f, false, false},   {2.1f, 4.0f, false, false},
               {1.9f, 2.1f, true, true}, {0.0f, INFINITY, true, true}, {0.0f, -1.0f, false, true},
               {3.0f, 1.0f, false, true}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const olx_ray ray = {{0.2f, 2.0f, 0.3f}, {0.0f, -1.0f, 0.0f}, cases[i].t_min, cases[i].t_max};
    olx_ray_hit hit;
    uint8_t occluded;
    olx_bvh_intersect_many(scene->bvh, &ray, 1, true, &hit);
    olx_bvh_occluded_many(scene->bvh, &ray, 1, true, &occluded);
    assert_int_equal(hit.triangle != OLX_NO_HIT, cases[i].hit);
    assert_int_equal(olx_bvh_intersect(scene->bvh, &ray).triangle != OLX_NO_HIT, cases[i].hit);
    assert_int_equal(occluded, cases[i].occluded);
    assert_int_equal(olx_bvh_occluded(scene->bvh, &ray), cases[i].occluded);
  }
  // Distances are in multiples of the direction's length.
  const olx_ray slow = {{0.2f, 2.0f, 0.3f}, {0.0f, -0.25f, 0.0f}, 0.0f, INFINITY};
  assert_true(fabsf(olx_bvh_intersect(scene->bvh, &slow).t - 8.0f) < 1e-5f);
  olx_scene_free(scene);
}

// Makes a masked square above an opaque one: the masked square's right half is cut out by the texture's alpha.
static olx_scene *masked_scene(void) {
  olx_scene *scene = made_scene();
  const uint8_t texels[8] = {255, 255, 255, 255, 255, 255, 255, 0};
  const olx_material opaque = olx_material_default();
  olx_material masked = opaque;
  masked.alpha_cutoff = 0.5f;
  masked.base_color_texture = made_texture(scene, 2, 1, texels, true);
  const uint32_t opaque_index = made_material(scene, &opaque), masked_index = made_material(scene, &masked);
  made_square(scene, 1.0f, masked_index);
  made_square(scene, 0.0f, opaque_index);
  return made_finish(scene);
}

static void rays_pass_through_cut_out_parts_and_keep_the_scenes_triangle_numbers(void **state) {
  (void)state;
  olx_scene *scene = masked_scene();
  enum { COUNT = 64 };
  olx_ray rays[COUNT];
  olx_ray_hit hits[COUNT];
  uint8_t occluded[COUNT];
  for (uint32_t i = 0; i < COUNT; i++) {
    // The mask's alpha, 1 in the left texel and 0 in the right, crosses one half at x = 0 and, as it wraps, at x = +-1.
    const float x = (i < COUNT / 2 ? -0.9f : 0.1f) + 0.8f * (float)(i % (COUNT / 2)) / (COUNT / 2);
    rays[i] = (olx_ray){{x, 2.0f, 0.1f}, {0.0f, -1.0f, 0.0f}, 0.0f, 1.5f};
  }
  olx_bvh_occluded_many(scene->bvh, rays, COUNT, false, occluded);
  for (uint32_t i = 0; i < COUNT; i++) {
    assert_int_equal(occluded[i], i < COUNT / 2);
    assert_int_equal(olx_bvh_occluded(scene->bvh, &rays[i]), i < COUNT / 2);
    rays[i].t_max = INFINITY;
  }
  olx_bvh_intersect_many(scene->bvh, rays, COUNT, false, hits);
  for (uint32_t i = 0; i < COUNT; i++) {
    const bool on_mask = i < COUNT / 2;
    assert_true(hits[i].triangle < scene->triangle_count);
    assert_int_equal(hits[i].triangle / 2, on_mask ? 0 : 1);
    assert_int_equal(olx_bvh_intersect(scene->bvh, &rays[i]).triangle, hits[i].triangle);
    assert_true(fabsf(hits[i].t - (on_mask ? 1.0f : 2.0f)) < 1e-5f);
  }
  olx_scene_free(scene);
}

// Of a pane that is 30 % opaque, three tenths of all rays of light meet something, the same ones alone and in packets,
// forwards and backwards. Rays that look for surfaces meet it from one half on, whole.
static void light_passes_blended_surfaces_by_their_share(void **state) {
  (void)state;
  enum { COUNT = 4096 };
  static olx_ray rays[COUNT];
  static olx_ray_hit hits[COUNT];
  static uint8_t occluded[COUNT];
  for (uint32_t i = 0; i < COUNT; i++) {
    const olx_vec2 at = olx_stratified2(i, 7);
    rays[i] = (olx_ray){{1.98f * at.x - 0.99f, 2.0f, 1.98f * at.y - 0.99f}, {0.0f, -1.0f, 0.0f}, 0.0f, 4.0f};
  }
  const float alphas[] = {0.0f, 0.3f, 0.6f, 1.0f};
  for (size_t k = 0; k < sizeof alphas / sizeof *alphas; k++) {
    olx_scene *scene = made_scene();
    olx_material pane = olx_material_default();
    pane.alpha = alphas[k];
    pane.alpha_cutoff = 0.5f;
    pane.blended = true;
    made_square(scene, 1.0f, made_material(scene, &pane));
    made_finish(scene);
    olx_bvh_intersect_many(scene->light_bvh, rays, COUNT, false, hits);
    olx_bvh_occluded_many(scene->light_bvh, rays, COUNT, true, occluded);
    uint32_t met = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
      const bool hit = hits[i].triangle != OLX_NO_HIT;
      const olx_ray back = {olx_madd(rays[i].origin, rays[i].direction, 2.0f), {0.0f, 1.0f, 0.0f}, 0.0f, 4.0f};
      assert_int_equal(occluded[i], hit);
      assert_int_equal(olx_bvh_occluded(scene->light_bvh, &rays[i]), hit);
      assert_int_equal(olx_bvh_occluded(scene->light_bvh, &back), hit);
      assert_int_equal(olx_bvh_occluded(scene->bvh, &rays[i]), alphas[k] >= 0.5f);
      assert_true(fabsf(olx_bvh_transmittance(scene->light_bvh, &rays[i]) - (1.0f - alphas[k])) < 1e-6f);
      met += hit;
    }
    // Four standard deviations of independent rays.
    const float share = (float)met / COUNT, spread = 4.0f * sqrtf(alphas[k] * (1.0f - alphas[k]) / COUNT);
    assert_true(fabsf(share - alphas[k]) <= spread);
    olx_scene_free(scene);
  }
}

// Two panes let through the product of what each does, and a wall behind them nothing.
static void panes_multiply_what_they_let_through(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  olx_material pane = olx_material_default(), wall = pane;
  pane.alpha_cutoff = 0.5f;
  pane.blended = true;
  for (uint32_t i = 0; i < 2; i++) {
    pane.alpha = i ? 0.75f : 0.5f;
    made_square(scene, 1.0f + (float)i, made_material(scene, &pane));
  }
  made_square(scene, 0.0f, made_material(scene, &wall));
  made_finish(scene);
  const struct {
    float from, to, passes;
  } ways[] = {{3, 2.5f, 1}, {3, 1.5f, 0.25f}, {3, 0.5f, 0.125f}, {0.5f, 3, 0.125f}, {3, -1, 0}};
  for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
    const olx_ray ray = {{0.3f, ways[i].from, 0.1f}, {0, ways[i].to - ways[i].from, 0}, 0.0f, 1.0f};
    assert_true(fabsf(olx_bvh_transmittance(scene->light_bvh, &ray) - ways[i].passes) < 1e-6f);
  }
  olx_scene_free(scene);
}

// Rays aimed exactly at edges and corners of a closed mesh hit it.
static void no_ray_slips_between_triangles(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t index = made_material(scene, &material);
  enum { SIDE = 8 };
  olx_vec3 corners[(SIDE + 1) * (SIDE + 1)];
  uint32_t indices[SIDE * SIDE * 6], *next = indices;
  for (uint32_t j = 0; j <= SIDE; j++) {
    for (uint32_t i = 0; i <= SIDE; i++) {
      const float bump = 0.3f * olx_unit_float(olx_hash2(i, j));
      corners[j * (SIDE + 1) + i] = olx_v3((float)i / 3.0f - 1.0f, bump, (float)j / 7.0f - 0.5f);
    }
  }
  for (uint32_t j = 0; j < SIDE; j++) {
    for (uint32_t i = 0; i < SIDE; i++) {
      const uint32_t a = j * (SIDE + 1) + i, b = a + 1, c = a + SIDE + 1, d = c + 1;
      const uint32_t quad[6] = {a, c, d, a, d, b};
      memcpy(next, quad, sizeof quad);
      next += 6;
    }
  }
  const uint32_t vertices = (SIDE + 1) * (SIDE + 1);
  assert_int_equal(olx_scene_add_mesh(scene, "sheet", corners, NULL, NULL, vertices, indices, SIDE * SIDE * 2, index),
                   OLX_OK);
  made_finish(scene);
  for (uint32_t n = 0; n < 20000; n++) {
    const uint32_t t = n % (SIDE * SIDE * 2);
    const olx_vec3 a = corners[indices[3 * t]], b = corners[indices[3 * t + 2]];
    const olx_vec3 target = olx_mix3(a, b, n % 3 == 0 ? 0.0f : olx_unit_float(olx_hash(n)));
    // Points near the sheet's rim are left out, since edges there have a triangle on one side only.
    if (target.x < -0.99f || target.x > 1.66f || target.z < -0.49f || target.z > 0.64f) continue;
    const olx_vec3 origin = {olx_unit_float(olx_hash2(n, 5)), 3.0f, olx_unit_float(olx_hash2(n, 6)) - 0.5f};
    const olx_ray ray = {origin, olx_normalize(olx_sub(target, origin)), 0.0f, INFINITY};
    assert_true(olx_bvh_intersect(scene->bvh, &ray).triangle != OLX_NO_HIT);
  }
  olx_scene_free(scene);
}

static void scenes_do_not_know_of_each_other(void **state) {
  (void)state;
  olx_scene *first = strewn_scene(50, 1), *second = strewn_scene(5, 2);
  const olx_ray ray = random_ray(12);
  const olx_ray_hit before = olx_bvh_intersect(first->bvh, &ray);
  olx_scene_free(second);
  const olx_ray_hit after = olx_bvh_intersect(first->bvh, &ray);
  assert_memory_equal(&before, &after, sizeof before);
  olx_scene_free(first);
}

static void floating_point_modes_stay_as_they_are(void **state) {
  (void)state;
#if defined(__SSE__)
  const unsigned int before = _mm_getcsr() & 0xFFC0u;
  olx_scene *scene = strewn_scene(2000, 3);
  assert_int_equal(_mm_getcsr() & 0xFFC0u, before);
  const olx_ray ray = random_ray(1);
  olx_bvh_intersect(scene->bvh, &ray);
  assert_int_equal(_mm_getcsr() & 0xFFC0u, before);
  olx_scene_free(scene);
#else
  skip();
#endif
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rays_hit_what_a_search_over_all_triangles_finds),
      cmocka_unit_test(barycentric_coordinates_give_the_hit_point),
      cmocka_unit_test(packets_answer_as_single_rays),
      cmocka_unit_test(rays_end_at_t_max_and_begin_at_t_min),
      cmocka_unit_test(rays_pass_through_cut_out_parts_and_keep_the_scenes_triangle_numbers),
      cmocka_unit_test(light_passes_blended_surfaces_by_their_share),
      cmocka_unit_test(panes_multiply_what_they_let_through),
      cmocka_unit_test(no_ray_slips_between_triangles),
      cmocka_unit_test(scenes_do_not_know_of_each_other),
      cmocka_unit_test(floating_point_modes_stay_as_they_are),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
