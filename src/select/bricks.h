// Finds the probes that see a place, from the bricks (docs/maths.md, "Choosing probes").
// Its twin is shaders/lib/bricks.glsl.
#ifndef OLX_SELECT_BRICKS_H
#define OLX_SELECT_BRICKS_H

#include "core/vec.h"
#include "field/brick_data.h"

// Returns the list of the cell around a point; a point outside all cells gets the list of the nearest one.
static inline const uint32_t *olx_bricks_list(const olx_bricks *bricks, olx_vec3 point) {
  const olx_bricks_header *h = bricks->header;
  const float place[3] = {point.x - h->origin[0], point.y - h->origin[1], point.z - h->origin[2]};
  const float per_metre = 1.0f / h->cell_metres;
  uint32_t brick[3], part[3];
  for (uint32_t axis = 0; axis < 3; axis++) {
    const uint32_t last = h->size[axis] * OLX_BRICK_SIDE - 1;
    const uint32_t i = (uint32_t)olx_clamp(place[axis] * per_metre, 0.0f, (float)last);
    brick[axis] = i / OLX_BRICK_SIDE;
    part[axis] = i % OLX_BRICK_SIDE;
  }
  const size_t at = ((size_t)brick[2] * h->size[1] + brick[1]) * h->size[0] + brick[0];
  uint32_t list = bricks->index[at];
  if (list & OLX_BRICK_DIVIDED) {
    const uint32_t c = (part[2] * OLX_BRICK_SIDE + part[1]) * OLX_BRICK_SIDE + part[0];
    const size_t word = (size_t)(list & ~OLX_BRICK_DIVIDED) * OLX_BRICK_CELL_WORDS + c / 2;
    list = bricks->cells[word] >> (c % 2 * 16) & 0xFFFFu;
  }
  return bricks->lists + (size_t)list * OLX_BRICK_LIST_WORDS;
}

// Returns the i-th probe of a list, OLX_BRICK_NO_PROBE beyond its end.
static inline uint32_t olx_bricks_probe(const uint32_t *list, uint32_t i) {
  return list[i / 2] >> (i % 2 * 16) & 0xFFFFu;
}

#endif
