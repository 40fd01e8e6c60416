// The cells of the irradiance volume and the places of its probes, from geometry alone.
#ifndef OLX_BAKE_VOLUME_CELLS_H
#define OLX_BAKE_VOLUME_CELLS_H

#include "bake/volume/volume_sides.h"
#include "core/parallel.h"

typedef struct olx_volume_cells {
  void *data; // the structure of field/volume_data.h; NULL where there is no free space
  size_t size_bytes;
  olx_vec3 *positions; // of probes
  uint32_t probe_count, cell_count;
} olx_volume_cells;

// Divides `space` into cells. `along` is the greatest number of cells near surfaces along the longest side of the space;
// they are larger where otherwise there would be more than `most_cells`, and of half that side where their surfaces
// would hardly see the probes that light them.
olx_result olx_volume_cells_create(const olx_volume_space *space, uint32_t along, uint32_t most_cells, uint32_t threads,
                                   olx_volume_cells *cells);
void olx_volume_cells_free(olx_volume_cells *cells);

#endif
