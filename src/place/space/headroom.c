// Measures how high the rooms of a scene are: casts rays upwards from points of all surfaces that face up, and takes
// the median of the distances to what they hit.
#include "place/space/headroom.h"

#include "core/hooks.h"
#include "core/sampling.h"
#include "scene/bvh.h"
#include "scene/surface.h"

#include <stdlib.h>

enum { SAMPLES = 1024 };
// Floors are no steeper than this angle's cosine; when fewer rays than this share hit anything, the height is unknown.
static const float LEAST_UP = 0.9f, LEAST_HITS = 0.1f;

// Returns the area of a triangle that faces up, seen from above and doubled; 0 of others.
static double floor_area(const olx_scene *scene, uint32_t triangle) {
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0);
  const olx_vec3 n =
      olx_cross(olx_sub(olx_scene_corner(scene, triangle, 1), a), olx_sub(olx_scene_corner(scene, triangle, 2), a));
  return n.y > LEAST_UP * olx_length(n) ? (double)n.y : 0.0;
}

static bool cast_up(const olx_scene *scene, uint32_t triangle, uint32_t sample, float *distance) {
  const olx_vec3 a = olx_scene_corner(scene, triangle, 0), u = olx_sub(olx_scene_corner(scene, triangle, 1), a),
                 v = olx_sub(olx_scene_corner(scene, triangle, 2), a);
  float s = olx_unit_float(olx_hash2(sample, 1)), t = olx_unit_float(olx_hash2(sample, 2));
  if (s + t > 1.0f) {
    s = 1.0f - s;
    t = 1.0f - t;
  }
  const olx_ray ray = {.origin = olx_madd(olx_madd(a, u, s), v, t),
                       .direction = {0.0f, 1.0f, 0.0f},
                       .t_min = 4.0f * olx_surface_epsilon(scene, triangle),
                       .t_max = INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  *distance = hit.t;
  return hit.triangle != OLX_NO_HIT;
}

static int compare_floats(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

float olx_headroom(const olx_scene *scene) {
  double all = 0.0, passed = 0.0;
  float hits[SAMPLES];
  uint32_t count = 0, sample = 0;
  for (uint32_t t = 0; t < scene->triangle_count; t++) all += floor_area(scene, t);
  // Samples lie at even steps of the area that triangles have together, in their order.
  for (uint32_t t = 0; t < scene->triangle_count && sample < SAMPLES; t++) {
    passed += floor_area(scene, t);
    while (sample < SAMPLES && ((double)sample + 0.5) / SAMPLES * all < passed) {
      count += cast_up(scene, t, sample, &hits[count]);
      sample++;
    }
  }
  if ((float)count < LEAST_HITS * SAMPLES) return 0.0f;
  qsort(hits, count, sizeof *hits, compare_floats);
  return hits[count / 2];
}
