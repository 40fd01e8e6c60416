// Space divided into voxels: which of them a surface touches, their distances to these, and flooding.
#ifndef OLX_PLACE_VOXELS_H
#define OLX_PLACE_VOXELS_H

#include "scene/scene_data.h"

// Squared distance, in voxels, when no voxel is solid.
#define OLX_FAR_VOXELS UINT32_MAX
#define OLX_NO_VOXEL SIZE_MAX

// A grid of voxels. Voxel (x, y, z) has index x + count[0] * (y + count[1] * z); its low corner is low + (x, y, z) *
// size.
typedef struct olx_voxels {
  olx_vec3 low;
  float size;        // metres along an edge
  uint32_t count[3]; // each at least 1
  size_t total;
  uint8_t *solid;     // 1 where a surface touches the voxel or its border, otherwise 0
  uint32_t *distance; // squared, in voxels, from centre to centre of the nearest solid voxel; exact. 0 in solid voxels
} olx_voxels;

// Lays voxels over the box, `resolution` along its longest side, fewer when there would be more than 2^23 of them.
// Allocates no memory. The box needs an extent above 0 along at least one axis.
void olx_voxels_fit(olx_box box, uint32_t resolution, olx_voxels *voxels);
void olx_voxels_free(olx_voxels *voxels);

// Computes the exact Euclidean distance transform (Meijster et al. 2000): squared distances to the nearest cell with
// solid != 0.
olx_result olx_distance_transform(const uint8_t *solid, const uint32_t count[3], uint32_t threads, uint32_t *distance);

// Returns the voxel that holds the point; OLX_NO_VOXEL outside.
static inline size_t olx_voxel_at(const olx_voxels *v, olx_vec3 p) {
  const olx_vec3 q = olx_scale(olx_sub(p, v->low), 1.0f / v->size);
  if (!(q.x >= 0.0f && q.y >= 0.0f && q.z >= 0.0f)) return OLX_NO_VOXEL;
  if (!(q.x < (float)v->count[0] && q.y < (float)v->count[1] && q.z < (float)v->count[2])) return OLX_NO_VOXEL;
  return (size_t)q.x + v->count[0] * ((size_t)q.y + v->count[1] * (size_t)q.z);
}

static inline void olx_voxel_coordinates(const olx_voxels *v, size_t index, uint32_t xyz[3]) {
  xyz[0] = (uint32_t)(index % v->count[0]);
  xyz[1] = (uint32_t)(index / v->count[0] % v->count[1]);
  xyz[2] = (uint32_t)(index / v->count[0] / v->count[1]);
}

static inline olx_vec3 olx_voxel_centre(const olx_voxels *v, size_t index) {
  uint32_t c[3];
  olx_voxel_coordinates(v, index, c);
  return olx_madd(v->low, olx_v3((float)c[0] + 0.5f, (float)c[1] + 0.5f, (float)c[2] + 0.5f), v->size);
}

// Returns whether a march can go on from t by a step: far from where it began, a step may be less than a float resolves.
static inline bool olx_march_goes_on(float t, float step) { return t + step > t; }

// Returns the distance in metres from the voxel's centre to the nearest solid voxel's centre; the surface itself is at
// most size * sqrt(3) / 2 nearer or farther. Infinite without solid voxels.
static inline float olx_voxel_distance(const olx_voxels *v, size_t index) {
  return v->distance[index] == OLX_FAR_VOXELS ? INFINITY : v->size * sqrtf((float)v->distance[index]);
}

// Labels with `label` every voxel that is 0 in `labels` and connected with `seed` through faces of such voxels. Returns
// their number. `stack` has room for `total` indices.
size_t olx_voxels_flood(const olx_voxels *voxels, size_t seed, uint32_t label, uint32_t *labels, size_t *stack);

// Clips [enter, leave], in lengths of `direction`, to where the ray is within the voxels. Returns false when it never
// is.
bool olx_voxels_clip(const olx_voxels *voxels, olx_vec3 origin, olx_vec3 direction, float *enter, float *leave);

#endif
