// Bricks: cells of space that list the probes which see them. The structure lies in the file as it is read
// (docs/format.md). src/bake builds it, and src/select looks it up.
#ifndef OLX_FIELD_BRICK_DATA_H
#define OLX_FIELD_BRICK_DATA_H

#include "shaders/octalux_shared.h"

#include <octalux/field.h>

enum {
  OLX_BRICK_CELLS = OLX_BRICK_SIDE * OLX_BRICK_SIDE * OLX_BRICK_SIDE,
  OLX_BRICK_MOST_LISTS = 1 << 16
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

// Returns the bytes of light field maps of size^2 texels, which the sizes of selectors are compared with.
static inline uint64_t olx_light_field_map_bytes(uint64_t probes, uint64_t size) {
  enum { TEXEL_BYTES = 8 }; // radiance, normal, distance
  return probes * (size + 2) * (size + 2) * TEXEL_BYTES;
}

// Returns the most bytes that a bake gives to bricks beside `map_bytes` of maps: 4 % of them, with a small lower bound
// and an upper bound of 4 MB.
static inline uint64_t olx_bricks_budget(uint64_t map_bytes) {
  const uint64_t share = map_bytes / 25, least = 4096, most = 4000000;
  return share < least ? least : share > most ? most : share;
}

// Checks all of a structure and points into it. `name` begins the message.
olx_result olx_bricks_open(const void *data, size_t size_bytes, uint32_t probe_count, const char *name,
                           olx_bricks *bricks);

#endif
