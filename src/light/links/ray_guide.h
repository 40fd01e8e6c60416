// Guides rays towards light: the distribution of later rays follows what the first rays of surfels brought.
//
// The surfels of a larger cell learn together. A ray is generated from a point of the unit square (olx_sample_cosine).
// The square is divided into bins, and the density of further rays in each bin is proportional to the root mean square
// of what rays there brought, which minimizes variance (Vorba et al. 2014 learn a finer density). No bin gets much
// less than a quarter of its share. Densities are rounded to powers of the square root of two before they are scaled to
// a mean of 1.
#ifndef OLX_LIGHT_RAY_GUIDE_H
#define OLX_LIGHT_RAY_GUIDE_H

#include "core/vec.h"
#include "light/surfels/light_surfels.h"

enum {
  OLX_GUIDE_SIDE = 8,                              // bins along a side of the square
  OLX_GUIDE_BINS = OLX_GUIDE_SIDE * OLX_GUIDE_SIDE // in rows of equal y
};

// What the surfels of one cell have learnt.
typedef struct olx_ray_pool {
  float density[OLX_GUIDE_BINS]; // of rays; the mean is 1
  float spread;                  // ratio of a ray's variance with this density to that without, at most 1
} olx_ray_pool;

typedef struct olx_ray_guide {
  uint32_t *pool_of; // one per surfel
  olx_ray_pool *pools;
  uint32_t pool_count;
} olx_ray_guide;

// One of the rays that are drawn in the bins of a guide's square.
typedef struct olx_ray_place {
  uint32_t bin, number; // number: within the bin
} olx_ray_place;

// Puts every surfel into a pool that has learnt nothing yet.
olx_result olx_ray_guide_create(olx_ray_guide *guide, const olx_light_surfels *surfels);
void olx_ray_guide_free(olx_ray_guide *guide);

// The light that rays of even density brought, as sums of luminance and its square.
typedef struct olx_guide_sums {
  double light, squares[OLX_GUIDE_BINS];
  uint32_t count, counts[OLX_GUIDE_BINS];
} olx_guide_sums;

// Adds the light of a ray that was generated from a point of the square.
void olx_guide_add(olx_guide_sums *sums, olx_vec2 point, float light);
// Learns the density of least variance from the sums. Without any light it is even.
void olx_guide_learn(olx_ray_pool *pool, const olx_guide_sums *sums);

// Maps evenly distributed points of the square to points with a pool's density. *density is the relative density at the
// result.
olx_vec2 olx_guide_warp(const olx_ray_pool *pool, olx_vec2 even, float *density);

// Divides about `rays` rays among bins by a pool's density, or evenly when that is NULL: each bin gets one ray or more,
// and a number that depends on its own density alone. Returns the number of all, at most OLX_GUIDE_BINS more than
// `rays`, which is at most 255.
uint32_t olx_guide_divide(const olx_ray_pool *pool, uint32_t rays, uint8_t bins[OLX_GUIDE_BINS]);
// Counts how many of `count` evenly drawn points (olx_stratified2), from index `first` on, a pool's density maps to each
// bin. The mean over seeds is the share of its density. `count` is at most 65535.
void olx_guide_count(const olx_ray_pool *pool, uint32_t seed, uint32_t first, uint32_t count,
                     uint16_t bins[OLX_GUIDE_BINS]);
// Maps a point of the unit square into a bin.
olx_vec2 olx_guide_in_bin(uint32_t bin, olx_vec2 point);

#endif
