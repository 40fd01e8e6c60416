// Guides rays towards light: the distribution of later rays follows what the first rays of surfels brought.
//
// Surfels of a larger cell learn together. A ray is made from a point of the unit square (olx_sample_cosine); the
// square is cut into bins, and the density of further rays in each is in proportion to the root mean square of what
// rays there brought, which is the density of least variance (Vorba et al. 2014 learn a finer one). No bin gets less
// than a quarter of its share.
#ifndef OLX_LIGHT_RAY_GUIDE_H
#define OLX_LIGHT_RAY_GUIDE_H

#include "core/vec.h"
#include "light/light_surfels.h"

enum {
  OLX_GUIDE_SIDE = 8,                              // bins along a side of the square
  OLX_GUIDE_BINS = OLX_GUIDE_SIDE * OLX_GUIDE_SIDE // in rows of equal y
};

// What the surfels of one cell have learnt.
typedef struct olx_ray_pool {
  float density[OLX_GUIDE_BINS]; // of rays, 1 in the mean
  float spread;                  // variance of a ray by this density over that of a ray by none, at most 1
} olx_ray_pool;

typedef struct olx_ray_guide {
  uint32_t *pool_of; // a surfel's
  olx_ray_pool *pools;
  uint32_t pool_count;
} olx_ray_guide;

// Puts every surfel into a pool that has learnt nothing yet.
olx_result olx_ray_guide_create(olx_ray_guide *guide, const olx_light_surfels *surfels);
void olx_ray_guide_free(olx_ray_guide *guide);

// What rays of even density brought, in sums of luminance and its square.
typedef struct olx_guide_sums {
  double light, squares[OLX_GUIDE_BINS];
  uint32_t count, counts[OLX_GUIDE_BINS];
} olx_guide_sums;

// Adds the light that a ray brought which was made from a point of the square.
void olx_guide_add(olx_guide_sums *sums, olx_vec2 point, float light);
// Learns the density of least variance for rays that bring as much as these sums say. Where they brought nothing it is
// even.
void olx_guide_learn(olx_ray_pool *pool, const olx_guide_sums *sums);

// Takes evenly spread points of the square to points of a pool's density. *density is how many times denser they lie
// there.
olx_vec2 olx_guide_warp(const olx_ray_pool *pool, olx_vec2 even, float *density);

#endif
