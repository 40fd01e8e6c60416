// Classic maps: what each probe stores for the classic method, irradiance probes without visibility, which light field
// probes replace (docs/format.md, "Classic maps").
#ifndef OLX_FIELD_CLASSIC_DATA_H
#define OLX_FIELD_CLASSIC_DATA_H

#include "core/vec.h"

enum { OLX_CLASSIC_TABLE_ENTRIES = OLX_CLASSIC_TABLE_SIDE * OLX_CLASSIC_TABLE_SIDE };

// The header of the classic maps, in the chunk CLAS.
typedef struct olx_classic_header {
  uint32_t size; // texels along a side of irradiance and of the first level of radiance
  uint32_t cube_size;
  uint32_t levels, table_side; // OLX_CLASSIC_LEVELS, OLX_CLASSIC_TABLE_SIDE
  float sharpness;
  uint32_t zero[11];
  // Scale (low 16 bits) and bias of F0 as half floats, row by row. Roughness runs along y and the square root of the
  // cosine along x, each from 0 in the first entry to 1 in the last.
  uint32_t table[OLX_CLASSIC_TABLE_ENTRIES];
} olx_classic_header;

_Static_assert(sizeof(olx_classic_header) == 64 + 4 * OLX_CLASSIC_TABLE_ENTRIES, "docs/format.md");

// The box that approximates a probe's surroundings when a reflection is looked up.
typedef struct olx_classic_box {
  olx_vec3 low, high; // metres
} olx_classic_box;

_Static_assert(sizeof(olx_classic_box) == 24, "docs/format.md");

// Returns the number of texels along a side of a level.
static inline uint32_t olx_classic_side(uint32_t size, uint32_t level) {
  const uint32_t side = size >> level;
  return side < OLX_CLASSIC_LEAST_SIDE ? OLX_CLASSIC_LEAST_SIDE : side;
}

// Returns the number of texels, borders included, in all levels before this one; OLX_CLASSIC_LEVELS gives the total.
static inline size_t olx_classic_first(uint32_t size, uint32_t level) {
  size_t texels = 0;
  for (uint32_t i = 0; i < level; i++) {
    const size_t stride = olx_classic_side(size, i) + 2;
    texels += stride * stride;
  }
  return texels;
}

// The classic maps of a field; `size` is 0 where there are none. Probe i owns record i of each array.
typedef struct olx_classic_maps {
  uint32_t size;
  size_t irradiance_texels, radiance_texels; // in a record
  const uint32_t *irradiance;                // R11G11B10F
  const uint32_t *radiance;                  // R11G11B10F; the levels one after the other
  size_t level_first[OLX_CLASSIC_LEVELS];
  const olx_classic_box *boxes;
  const uint32_t *table;
} olx_classic_maps;

#endif
