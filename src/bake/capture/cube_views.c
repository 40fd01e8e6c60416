// Keeps rasterised cube maps of light field probes, and finds in them what rays from the probes hit.
#include "bake/capture/cube_views.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/bvh.h"
#include "scene/surface.h"

enum {
  FACES = 6,
  RING = 2,                 // texels of a row that lie beyond the face
  LEAST_SIDE = 256,         // the fewest texels along a side of a face, without the ring
  MOST_SIDE = 2048,         // the most texels along a side of a face, without the ring
  MOST_TOGETHER = 16,       // probes of one call
  TOGETHER_BYTES = 1 << 26, // of the cubes of one call, unless a single one takes more
  AROUND = 9                // texels around a ray
};

// Returns the texels along a side of a face. A quarter of the circle spans size / 2 texels of an octahedral map, each
// of which is sampled `samples` times along its side, and all texels of a face without its ring.
static uint32_t side_for(const olx_bake_settings *s, uint32_t size) {
  const uint32_t wanted = size * s->samples / 2, side = wanted < LEAST_SIDE ? LEAST_SIDE : wanted;
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

// A texel of a cube, and the face that it lies in.
typedef struct cube_place {
  uint32_t axis, column, row; // counted without the ring
  float sign;                 // of the face's direction along its axis
} cube_place;

static cube_place place_along(const olx_cube_views *v, olx_vec3 direction) {
  const float d[3] = {direction.x, direction.y, direction.z};
  const float length[3] = {fabsf(d[0]), fabsf(d[1]), fabsf(d[2])};
  const uint32_t larger = length[1] > length[0] ? 1 : 0, axis = length[2] > length[larger] ? 2 : larger;
  const uint32_t inner = v->side - RING, last = inner - 1;
  const float scale = 0.5f * (float)inner / length[axis], middle = 0.5f * (float)inner;
  const uint32_t column = (uint32_t)(d[(axis + 1) % 3] * scale + middle),
                 row = (uint32_t)(d[(axis + 2) % 3] * scale + middle);
  return (cube_place){axis, column < last ? column : last, row < last ? row : last, d[axis] < 0.0f ? -1.0f : 1.0f};
}

// Returns the direction of the middle of one of the nine texels around a place.
static olx_vec3 middle_of(const olx_cube_views *v, const cube_place *p, uint32_t i) {
  const float scale = 2.0f / (float)(v->side - RING);
  float d[3];
  d[p->axis] = p->sign;
  d[(p->axis + 1) % 3] = ((float)(p->column + i % 3) - 0.5f) * scale - 1.0f;
  d[(p->axis + 2) % 3] = ((float)(p->row + i / 3) - 0.5f) * scale - 1.0f;
  return olx_v3(d[0], d[1], d[2]);
}

// Returns how far away a triangle's plane is along a direction, in units of its length; negative: behind the origin.
static float plane_distance(const olx_scene *scene, uint32_t triangle, olx_vec3 origin, olx_vec3 direction) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]];
  const olx_vec3 normal = olx_cross(olx_sub(scene->positions[corner[1]], a), olx_sub(scene->positions[corner[2]], a));
  return olx_dot(normal, olx_sub(a, origin)) / olx_dot(normal, direction);
}

static bool share_corner(const olx_scene *scene, uint32_t a, uint32_t b) {
  for (uint32_t i = 0; i < 9; i++) {
    const olx_vec3 p = scene->positions[scene->indices[3 * (size_t)a + i / 3]],
                   q = scene->positions[scene->indices[3 * (size_t)b + i % 3]];
    if (p.x == q.x && p.y == q.y && p.z == q.z) return true;
  }
  return false;
}

// Returns whether a triangle that is seen along `direction` lies in front of a hit beside it, and may go on towards it
// by triangles that no texel shows, as round silhouettes do.
static bool may_hide(const olx_scene *scene, uint32_t triangle, olx_vec3 origin, olx_vec3 direction, uint32_t hit) {
  const float near = plane_distance(scene, triangle, origin, direction),
              far = plane_distance(scene, hit, origin, direction);
  if (far > 0.0f && far <= near * (1.0f + 0x1p-12f)) return false;
  return !share_corner(scene, triangle, hit);
}

// Finds the hit of a ray among the triangles around it. Returns whether it is certain.
static bool find_hit(const olx_cube_views *v, const olx_scene *scene, const uint32_t *cube, const olx_ray *ray,
                     olx_ray_hit *hit) {
  const cube_place p = place_along(v, ray->direction);
  const size_t face = 2 * p.axis + (p.sign < 0.0f ? 1 : 0);
  const uint32_t *texel = cube + (face * v->side + p.row) * v->side + p.column; // the first of the nine
  uint32_t tried[AROUND], seen_at[AROUND], count = 0;
  bool sky = true;
  *hit = (olx_ray_hit){.triangle = OLX_NO_HIT, .t = INFINITY};
  for (uint32_t i = 0; i < AROUND; i++) {
    const uint32_t triangle = texel[(size_t)(i / 3) * v->side + i % 3];
    if (triangle >= scene->triangle_count) continue;
    sky = false;
    uint32_t k = 0;
    while (k < count && tried[k] != triangle) k++;
    if (k < count) continue;
    seen_at[count] = i;
    tried[count++] = triangle;
    intersect(scene, ray, triangle, hit);
  }
  if (hit->triangle == OLX_NO_HIT) return sky;
  for (uint32_t k = 0; k < count; k++) {
    if (tried[k] == hit->triangle) continue;
    if (may_hide(scene, tried[k], ray->origin, middle_of(v, &p, seen_at[k]), hit->triangle)) return false;
  }
  return true;
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
