// Casts rays against the scene's triangles (Embree). Rays pass through masked-out parts of alpha-masked surfaces. A
// scene has two handles of one structure: rays of `bvh` find what probes see and places can be in, those of `light_bvh`
// follow light, which passes blended surfaces in part (olx_surface_stops_light).
#ifndef OLX_SCENE_BVH_H
#define OLX_SCENE_BVH_H

#include "scene/ray.h"
#include "scene/space_bricks.h"

struct olx_bvh {
  struct olx_bvh_tree *tree;
  // Receives the bricks that single rays cross: to the hit of olx_bvh_intersect, and to t_max of olx_bvh_occluded.
  // Packets and distances are not recorded. NULL: nothing is. A copy of the handle with a log of its own records the
  // rays of one user while others use the original; it is not to be freed.
  olx_ray_log *log;
  bool follows_light; // of light_bvh
};

// The Embree version and instruction set in use: results differ between them.
typedef struct olx_bvh_engine {
  uint32_t version;         // 31305 is 3.13.5
  const char *instructions; // "sse2", "sse4.2", "avx", "avx2", "avx512": the instruction set in use
} olx_bvh_engine;

olx_bvh_engine olx_bvh_describe(const olx_bvh *bvh);

// Builds scene->bvh and scene->light_bvh with the instructions that scene->load names. Returns OLX_ERROR_UNSUPPORTED
// where the processor lacks them.
olx_result olx_bvh_create(olx_scene *scene);
// Frees both.
void olx_bvh_free(olx_scene *scene);

olx_ray_hit olx_bvh_intersect(const olx_bvh *bvh, const olx_ray *ray);
bool olx_bvh_occluded(const olx_bvh *bvh, const olx_ray *ray);
// Returns the share of light that passes along a ray of light_bvh: 0 where it meets an opaque surface, else the product
// of 1 - alpha of all blended surfaces on its way. It is the mean of what rays find that are occluded or not, without
// their noise.
float olx_bvh_transmittance(const olx_bvh *bvh, const olx_ray *ray);
// Returns whether nothing lies between two points.
static inline bool olx_bvh_is_clear(const olx_bvh *bvh, olx_vec3 from, olx_vec3 to) {
  return !olx_bvh_occluded(bvh, &(olx_ray){from, olx_sub(to, from), 0.0f, 1.0f});
}

// Returns the distance in metres from the point to the nearest triangle (masked parts included); `limit` when none is
// nearer.
float olx_bvh_distance(const olx_bvh *bvh, olx_vec3 point, float limit);

// Intersects many rays in packets of 16. `coherent` promises that neighbours in the array have similar origins and
// directions.
void olx_bvh_intersect_many(const olx_bvh *bvh, const olx_ray *rays, uint32_t count, bool coherent, olx_ray_hit *hits);
// Tests many rays for occlusion: occluded[i] becomes 1 or 0. Rays with t_max < t_min are skipped and yield 1.
void olx_bvh_occluded_many(const olx_bvh *bvh, const olx_ray *rays, uint32_t count, bool coherent, uint8_t *occluded);

#endif
