// Encodes what light field probes see as blocks, which fields hold in place of texels (docs/maths.md, "Blocks").
#ifndef OLX_FIELD_SURFACE_ENCODE_H
#define OLX_FIELD_SURFACE_ENCODE_H

#include "field/surface_data.h"

// The surfaces of a probe, n * n texels, row by row, without border, in the codes that field/texels.h reads.
typedef struct olx_surface_texels {
  const uint32_t *base;
  const uint16_t *specular;
  const uint32_t *direct, *indirect;
  const uint16_t *distance; // infinite for the sky
} olx_surface_texels;

// The surfaces of a probe in blocks of 4 x 4 texels, (n / 4)^2 of each kind.
typedef struct olx_surface_blocks {
  olx_bc1_block *base;
  olx_bc5_block *specular;
  olx_bc6h_block *direct, *indirect;
} olx_surface_blocks;

// Allocates the blocks of one probe. On OLX_ERROR_MEMORY there is nothing to free.
olx_result olx_surface_blocks_create(uint32_t n, olx_surface_blocks *blocks);
uint64_t olx_surface_blocks_bytes(uint32_t n);
void olx_surface_blocks_free(olx_surface_blocks *blocks);

// Encodes the surfaces of a probe. Errors of direct light are weighed relative to all light at their texel, so that an
// error in a shadow counts little where indirect light is strong.
olx_result olx_surface_encode(const olx_surface_texels *texels, uint32_t n, uint32_t threads,
                              const olx_surface_blocks *blocks);

#endif
