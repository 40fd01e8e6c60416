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
  OLX_POOL_LEVELS = 3,                             // surfels learn together in cells this many levels above their own
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

// Numbers the cells `levels` above those of the surfels, or the largest cells where there are not so many levels.
// pool_of[i] receives the number of surfel i's.
olx_result olx_pool_surfels(const olx_light_surfels *surfels, uint32_t levels, uint32_t *pool_of, uint32_t *count);
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

// Divides rays among bins by a pool's density, or evenly when that is NULL: each bin gets a power of two of them, so
// that they are evenly distributed within it, and all together are `rays`, a power of two from OLX_GUIDE_BINS to 32768.
// The bin with the fewest rays for its density is doubled first, as long as there are rays left.
void olx_guide_divide(const olx_ray_pool *pool, uint32_t rays, uint16_t bins[OLX_GUIDE_BINS]);

// The points of a (0, 2)-sequence over the square by bins: of every 64 consecutive points one lies in each bin, so that
// point `number` of a bin is a point of the sequence, whatever number of points other bins have. Where all bins have
// the same number of points, these form the sequence's beginning, with its even distribution.
typedef struct olx_bin_sequence {
  uint32_t seed;
  uint8_t x[OLX_GUIDE_SIDE], y[OLX_GUIDE_SIDE]; // digits before scrambling of each column and row
} olx_bin_sequence;

olx_bin_sequence olx_bin_sequence_make(uint32_t seed);
// Returns the index in the sequence of a bin's point `number`, which is below 2^26.
uint32_t olx_bin_sequence_index(const olx_bin_sequence *sequence, uint32_t bin, uint32_t number);
// Returns a point of the sequence.
olx_vec2 olx_bin_sequence_point(const olx_bin_sequence *sequence, uint32_t index);

#endif
