// Classic maps: what original irradiance probes, the method that light field probes replace, keep at each irradiance
// probe (docs/format.md, "Classic maps").
#ifndef OLX_FIELD_CLASSIC_DATA_H
#define OLX_FIELD_CLASSIC_DATA_H

#include "core/vec.h"

enum {
  OLX_CLASSIC_LEVELS = 5, // of prefiltered radiance, for roughness 0, 1/4, 1/2, 3/4, 1
  OLX_CLASSIC_LEAST_SIDE = 8,
  OLX_CLASSIC_TABLE_SIDE = 64,
  OLX_CLASSIC_TABLE_ENTRIES = OLX_CLASSIC_TABLE_SIDE * OLX_CLASSIC_TABLE_SIDE
};

// CLAS.
typedef struct olx_classic_header {
  uint32_t size; // texels along a side of irradiance and of the first level of radiance
  uint32_t cube_size;
  uint32_t levels, table_side; // OLX_CLASSIC_LEVELS, OLX_CLASSIC_TABLE_SIDE
  float sharpness;
  uint32_t zero[11];
  // Scale (low 16 bits) and bias of F0, halves: row by row, roughness along y, the root of the cosine along x, each
  // from 0 in the first to 1 in the last entry.
  uint32_t table[OLX_CLASSIC_TABLE_ENTRIES];
} olx_classic_header;

_Static_assert(sizeof(olx_classic_header) == 64 + 4 * OLX_CLASSIC_TABLE_ENTRIES, "docs/format.md");

// What a probe's surroundings are taken for when a reflection is looked up.
typedef struct olx_classic_box {
  olx_vec3 low, high; // metres
} olx_classic_box;

_Static_assert(sizeof(olx_classic_box) == 24, "docs/format.md");

// Texels along a side of a level.
static inline uint32_t olx_classic_side(uint32_t size, uint32_t level) {
  const uint32_t side = size >> level;
  return side < OLX_CLASSIC_LEAST_SIDE ? OLX_CLASSIC_LEAST_SIDE : side;
}

// Texels, with their borders, of the levels before this one; of all of them for OLX_CLASSIC_LEVELS.
static inline size_t olx_classic_first(uint32_t size, uint32_t level) {
  size_t texels = 0;
  for (uint32_t i = 0; i < level; i++) {
    const size_t stride = olx_classic_side(size, i) + 2;
    texels += stride * stride;
  }
  return texels;
}

// The maps of a field, `size` 0 where there are none. Probe i has the records i of each.
typedef struct olx_classic_maps {
  uint32_t size;
  size_t irradiance_texels, radiance_texels; // a record
  const uint32_t *irradiance;                // R11G11B10F
  const uint32_t *radiance;                  // the same; the levels one after the other
  size_t level_first[OLX_CLASSIC_LEVELS];
  const olx_classic_box *boxes;
  const uint32_t *table;
} olx_classic_maps;

#endif
