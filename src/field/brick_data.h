// Bricks: cells of space that list the probes which see them. The structure lies in the file as it is read
// (docs/format.md). src/bake builds it, and src/select looks it up.
#ifndef OLX_FIELD_BRICK_DATA_H
#define OLX_FIELD_BRICK_DATA_H

#include "shaders/octalux_shared.h"

#include <octalux/field.h>

enum {
  OLX_BRICK_CELLS = OLX_BRICK_SIDE * OLX_BRICK_SIDE * OLX_BRICK_SIDE,
  OLX_BRICK_MOST_LISTS = 1 << 16,
  OLX_BRICK_MOST_PROBES = OLX_BRICK_NO_PROBE
};

typedef struct olx_bricks_header {
  float origin[3];
  float cell_metres; // side of a cell
  uint32_t size[3];  // bricks along each axis
  uint32_t divided;  // number of bricks that have cells of their own
  uint32_t lists;
  uint32_t zero[7];
} olx_bricks_header;

_Static_assert(sizeof(olx_bricks_header) == OLX_BRICK_HEADER_WORDS * sizeof(uint32_t), "docs/format.md");

// Pointers into the structure. Lists hold probes, best first; every number is in range once olx_bricks_open has passed.
typedef struct olx_bricks {
  const olx_bricks_header *header; // NULL: the field has none
  const uint32_t *index;           // number of a brick's list, or OLX_BRICK_DIVIDED and its number among the divided
  const uint32_t *cells;           // of a divided brick: OLX_BRICK_CELL_WORDS, two list numbers a word, low half first
  const uint32_t *lists;           // of a list: OLX_BRICK_LIST_WORDS, two probes a word, low half first
} olx_bricks;

// Checks all of a structure and points into it. `name` begins the message.
olx_result olx_bricks_open(const void *data, size_t size_bytes, uint32_t probe_count, const char *name,
                           olx_bricks *bricks);

#endif
