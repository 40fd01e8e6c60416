// Casting rays against the scene's triangles (Embree). Masked-out parts of alpha-masked surfaces are passed through.
#ifndef OLX_SCENE_BVH_H
#define OLX_SCENE_BVH_H

#include "scene/ray.h"
#include "scene/scene_data.h"

olx_result olx_bvh_create(const olx_scene *scene, olx_bvh **bvh);
void olx_bvh_free(olx_bvh *bvh);

olx_ray_hit olx_bvh_intersect(const olx_bvh *bvh, const olx_ray *ray);
bool olx_bvh_occluded(const olx_bvh *bvh, const olx_ray *ray);

// Metres from the point to the nearest triangle (masked parts included), `limit` when none is nearer.
float olx_bvh_distance(const olx_bvh *bvh, olx_vec3 point, float limit);

// Many rays at once, in packets of 16. `coherent` promises that neighbours in the array start and go much alike.
void olx_bvh_intersect_many(const olx_bvh *bvh, const olx_ray *rays, uint32_t count, bool coherent, olx_ray_hit *hits);
// occluded[i] becomes 1 or 0. Rays with t_max < t_min are skipped and come back as 1.
void olx_bvh_occluded_many(const olx_bvh *bvh, const olx_ray *rays, uint32_t count, bool coherent, uint8_t *occluded);

#endif
