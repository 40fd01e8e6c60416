// Finds the surfels around a surface point, and their weights.
#ifndef OLX_LIGHT_SURFEL_LOOKUP_H
#define OLX_LIGHT_SURFEL_LOOKUP_H

#include "light/surfels/light_surfels.h"

typedef struct olx_surfel_lookup {
  const olx_light_surfels *surfels;
  uint32_t levels;      // bit n: there are cells of that level
  olx_cell_table cubes; // from cubes of each level to positions in `lists`
  uint32_t *lists;      // the surfels of each cube: their number, then their indices
  uint32_t list_words;  // total length of all lists
} olx_surfel_lookup;

// Builds a lookup of the first `count` surfels.
olx_result olx_surfel_lookup_create(olx_surfel_lookup *lookup, const olx_light_surfels *surfels, uint32_t count);
void olx_surfel_lookup_free(olx_surfel_lookup *lookup);

enum {
  OLX_NEIGHBOURS_FEW = 8, // fewer surfels determine a slope badly
  OLX_NEIGHBOURS_MOST = 24
};

// A linear fit at a point to the surfels around it.
typedef struct olx_surfel_weights {
  uint32_t count;
  uint32_t surfel[OLX_NEIGHBOURS_MOST];
  float weight[OLX_NEIGHBOURS_MOST]; // weights whose sum is 1: the fit's value at the point is the weighted mean
  float near[OLX_NEIGHBOURS_MOST];   // by how much each surfel counts in the fit
  olx_vec2 way[OLX_NEIGHBOURS_MOST]; // from the point to the surfel, along the surface, in units of the mean distance
} olx_surfel_weights;

// Returns the linear fit at `surface` to the surfels around it that lie on the same surface and see it. count is 0 when
// there is none. With `wide` surfels count that are up to twice as far away, provided that they lie on all sides: at
// the edge of a large cell that smaller ones adjoin, few are near.
olx_surfel_weights olx_surfel_weigh(const olx_surfel_lookup *lookup, const olx_surface *surface, bool wide);

// Returns how far values of the surfels, one each, are off their linear fit, as a root mean square.
float olx_surfel_misfit(const olx_surfel_weights *weights, const float values[OLX_NEIGHBOURS_MOST]);

#endif
