// Keeps rasterised cube maps of light field probes, and finds in them what rays from the probes hit.
#include "bake/cube_views.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/bvh.h"
#include "scene/surface.h"

enum {
  FACES = 6,
  RING = 2,                 // texels of a row that lie beyond the face
  LEAST_SIDE = 64,          // of the part of a face inside the ring
  MOST_SIDE = 2048,         //
  MOST_TOGETHER = 16,       // probes of one call
  TOGETHER_BYTES = 1 << 26, // of the cubes of one call, unless a single one takes more
  AROUND = 9                // texels around a ray
};

// A quarter of the circle spans `size` texels of an octahedral map and `side` texels of a face; each texel is sampled
// `samples` times along its side.
static uint32_t side_for(const olx_bake_settings *s, uint32_t size) {
  const uint32_t wanted = size * s->samples, side = wanted < LEAST_SIDE ? LEAST_SIDE : wanted;
  return (side > MOST_SIDE ? MOST_SIDE : side) + RING;
}

static uint64_t cube_texels(uint32_t side) { return (uint64_t)FACES * side * side; }

static uint32_t capacity_for(uint32_t side) {
  const uint64_t fit = TOGETHER_BYTES / (cube_texels(side) * sizeof(uint32_t));
  return fit > MOST_TOGETHER ? MOST_TOGETHER : fit > 1 ? (uint32_t)fit : 1;
}

uint64_t olx_cube_views_bytes(const olx_bake_settings *settings, uint32_t size) {
  if (!settings->raster) return 0;
  const uint32_t side = side_for(settings, size);
  return capacity_for(side) * (cube_texels(side) * sizeof(uint32_t) + sizeof(olx_vec3));
}

olx_result olx_cube_views_create(const olx_bake_settings *settings, uint32_t size, olx_cube_views *v) {
  *v = (olx_cube_views){.raster = settings->raster};
  if (!v->raster) return OLX_OK;
  v->side = side_for(settings, size);
  v->capacity = capacity_for(v->side);
  v->stride = settings->work.parts ? settings->work.parts : 1; // a part captures every so many of the probes
  v->triangles = olx_allocate((size_t)v->capacity * cube_texels(v->side), sizeof *v->triangles);
  v->positions = olx_allocate(v->capacity, sizeof *v->positions);
  if (v->triangles && v->positions) return OLX_OK;
  const uint32_t inner = v->side - RING;
  olx_cube_views_free(v);
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for cube maps of %u x %u texels a face", inner, inner);
}

void olx_cube_views_free(olx_cube_views *v) {
  olx_release(v->triangles);
  olx_release(v->positions);
  v->triangles = NULL;
  v->positions = NULL;
  v->count = 0;
}

static bool is_here(const olx_cube_views *v, uint32_t probe) {
  return probe >= v->first && (probe - v->first) % v->stride == 0 && (probe - v->first) / v->stride < v->count;
}

olx_result olx_cube_views_look(olx_cube_views *v, const olx_bake_context *context, uint32_t probe) {
  if (!v->raster || is_here(v, probe)) return OLX_OK;
  const olx_probe_list *probes = &context->probes.light_field;
  const double start = olx_seconds();
  v->first = probe;
  v->count = 0;
  while (v->count < v->capacity && probe < probes->count) {
    v->positions[v->count++] = probes->positions[probe];
    if (probes->count - probe <= v->stride) break;
    probe += v->stride;
  }
  const char *problem = v->raster->look(v->raster->user, v->positions, v->count, v->side, v->triangles);
  v->seconds += olx_seconds() - start;
  if (!problem) return OLX_OK;
  v->count = 0;
  return olx_fail(OLX_ERROR_GPU, "bake: %s: %s", v->raster->name, problem);
}

// Intersects a ray with a triangle, and keeps the hit when it is nearer than the one that is there.
static void intersect(const olx_scene *scene, const olx_ray *ray, uint32_t triangle, olx_ray_hit *hit) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = olx_sub(scene->positions[corner[0]], ray->origin);
  const olx_vec3 along_u = olx_sub(scene->positions[corner[1]], scene->positions[corner[0]]),
                 along_v = olx_sub(scene->positions[corner[2]], scene->positions[corner[0]]);
  const olx_vec3 across = olx_cross(ray->direction, along_v);
  const float determinant = olx_dot(along_u, across);
  if (determinant == 0.0f) return;
  const olx_vec3 moment = olx_cross(along_u, a);
  const float share = 1.0f / determinant;
  const float u = -olx_dot(a, across) * share, v = olx_dot(ray->direction, moment) * share;
  if (!(u >= 0.0f && v >= 0.0f && u + v <= 1.0f)) return;
  const float t = olx_dot(along_v, moment) * share;
  if (!(t > 0.0f && t < hit->t) || !olx_surface_present(scene, triangle, u, v)) return;
  *hit = (olx_ray_hit){triangle, t, u, v};
}

// Returns the texel of the cube that a direction passes; it never lies in the ring.
static const uint32_t *texel_along(const olx_cube_views *v, const uint32_t *cube, olx_vec3 direction) {
  const float d[3] = {direction.x, direction.y, direction.z};
  const float length[3] = {fabsf(d[0]), fabsf(d[1]), fabsf(d[2])};
  const uint32_t larger = length[1] > length[0] ? 1 : 0, axis = length[2] > length[larger] ? 2 : larger;
  const uint32_t face = 2 * axis + (d[axis] < 0.0f ? 1 : 0), inner = v->side - RING;
  const float scale = 0.5f * (float)inner / length[axis], middle = 0.5f * (float)inner;
  const uint32_t column = (uint32_t)(d[(axis + 1) % 3] * scale + middle),
                 row = (uint32_t)(d[(axis + 2) % 3] * scale + middle);
  const uint32_t last = inner - 1;
  return cube + ((size_t)face * v->side + 1 + (row < last ? row : last)) * v->side + 1 +
         (column < last ? column : last);
}

// Finds the hit of a ray among the triangles around it. Returns whether it is certain.
static bool find_hit(const olx_cube_views *v, const olx_scene *scene, const uint32_t *cube, const olx_ray *ray,
                     olx_ray_hit *hit) {
  const uint32_t *texel = texel_along(v, cube, ray->direction);
  uint32_t tried[AROUND], count = 0;
  bool sky = true;
  *hit = (olx_ray_hit){.triangle = OLX_NO_HIT, .t = INFINITY};
  for (uint32_t i = 0; i < AROUND; i++) {
    const uint32_t triangle = *(texel - v->side - 1 + (size_t)(i / 3) * v->side + i % 3);
    if (triangle >= scene->triangle_count) continue;
    sky = false;
    uint32_t k = 0;
    while (k < count && tried[k] != triangle) k++;
    if (k < count) continue;
    tried[count++] = triangle;
    intersect(scene, ray, triangle, hit);
  }
  return sky || hit->triangle != OLX_NO_HIT;
}

uint32_t olx_cube_views_intersect(const olx_cube_views *v, const olx_scene *scene, uint32_t probe, const olx_ray *rays,
                                  uint32_t count, olx_ray_hit *hits) {
  const uint32_t *cube = v->triangles + (size_t)((probe - v->first) / v->stride) * cube_texels(v->side);
  uint32_t cast = 0;
  for (uint32_t i = 0; i < count; i++) {
    if (find_hit(v, scene, cube, &rays[i], &hits[i])) continue;
    hits[i] = olx_bvh_intersect(scene->bvh, &rays[i]);
    cast++;
  }
  return cast;
}
