// Finds which probes are neighbours: the edges of the Delaunay tetrahedra over their positions (Qhull).
#ifndef OLX_BAKE_DELAUNAY_H
#define OLX_BAKE_DELAUNAY_H

#include "core/vec.h"

// Neighbours of probe i are neighbour[first[i]] up to neighbour[first[i + 1]], in ascending order.
typedef struct olx_neighbours {
  size_t *first;
  uint32_t *neighbour;
} olx_neighbours;

// Finds the neighbours of every probe. Where there are no tetrahedra (fewer than five distinct positions, or all in one
// plane, to a ten-thousandth of the whole extent), every probe neighbours every other. Positions closer than a
// millionth of the whole extent count as one: such probes neighbour each other and share their other neighbours. The
// relation is symmetric. Where several triangulations are valid, as on regular grids, a joggle of the input with a
// fixed seed picks one.
olx_result olx_neighbours_create(const olx_vec3 *positions, uint32_t count, olx_neighbours *neighbours);
void olx_neighbours_free(olx_neighbours *neighbours);

#endif
