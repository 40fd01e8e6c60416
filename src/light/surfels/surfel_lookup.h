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

// Weights, which sum to 1, of the surfels from whose light a point's is interpolated.
typedef struct olx_surfel_weights {
  uint32_t count;
  uint32_t surfel[OLX_NEIGHBOURS_MOST];
  float weight[OLX_NEIGHBOURS_MOST];
} olx_surfel_weights;

// Returns the linear fit at `surface` to the surfels around it that lie on the same surface and see it. count is 0 when
// there is none.
olx_surfel_weights olx_surfel_weigh(const olx_surfel_lookup *lookup, const olx_surface *surface);

#endif
