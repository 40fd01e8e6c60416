// Encodes what light field probes see as blocks, which fields hold in place of texels (docs/maths.md, "Blocks").
#ifndef OLX_FIELD_SURFACE_ENCODE_H
#define OLX_FIELD_SURFACE_ENCODE_H

#include "field/surface_data.h"

// The surfaces of a probe, n * n texels, row by row, without border, as field/texels.h reads them.
typedef struct olx_surface_texels {
  const uint32_t *base;
  const uint16_t *specular;
  const uint32_t *direct, *indirect;
  const uint16_t *distance; // tells what is sky
} olx_surface_texels;

// The surfaces of a probe in blocks of 4 x 4 texels, (n / 4)^2 of each kind.
typedef struct olx_surface_blocks {
  olx_bc1_block *base;
  olx_bc5_block *specular;
  olx_bc6h_block *direct, *indirect;
} olx_surface_blocks;

// OLX_ERROR_MEMORY, and then there is nothing to free.
olx_result olx_surface_blocks_create(uint32_t n, olx_surface_blocks *blocks);
uint64_t olx_surface_blocks_bytes(uint32_t n);
void olx_surface_blocks_free(olx_surface_blocks *blocks);

// Errors of direct light count relative to all light that its texel gets, so that darkness has to be dark only beside
// what else lights it.
olx_result olx_surface_encode(const olx_surface_texels *texels, uint32_t n, uint32_t threads,
                              const olx_surface_blocks *blocks);

#endif
