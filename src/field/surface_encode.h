// Encodes what light field probes see as tiles of blocks, which fields hold in place of texels (docs/maths.md,
// "Tiles").
#ifndef OLX_FIELD_SURFACE_ENCODE_H
#define OLX_FIELD_SURFACE_ENCODE_H

#include "core/result.h"
#include "field/surface_data.h"

// The surfaces of a probe, n * n texels, row by row, without border, in the codes that field/texels.h reads.
typedef struct olx_surface_texels {
  const uint32_t *base;
  const uint16_t *specular;
  const uint32_t *direct, *indirect;
  const uint16_t *distance; // infinite for the sky
} olx_surface_texels;

// Encodes one probe at a time, and keeps its tiles, with pools of their own in which equal blocks are stored once.
typedef struct olx_surface_maker {
  olx_tiled_maps maps[OLX_SURFACE_MAPS]; // of the probe encoded last
  uint32_t *words[OLX_SURFACE_MAPS];
  unsigned char *blocks[OLX_SURFACE_MAPS]; // room for four a tile
  uint32_t *known;                         // 1 + the number of a tile whose blocks are stored, by their hash
} olx_surface_maker;

// The blocks of one tile: 0 where it is sky, else 1 or 4 of each kind.
typedef struct olx_surface_tile {
  uint32_t count[OLX_SURFACE_MAPS];
  _Alignas(uint32_t) unsigned char blocks[OLX_SURFACE_MAPS][4 * sizeof(olx_bc6h_block)];
} olx_surface_tile;

// Encodes the tile (x, y) of a map of n x n texels.
void olx_surface_tile_encode(const olx_surface_texels *texels, uint32_t n, uint32_t x, uint32_t y,
                             olx_surface_tile *tile);

// Creates a maker for maps of n x n texels. On OLX_ERROR_MEMORY there is nothing to free.
olx_result olx_surface_maker_create(uint32_t n, olx_surface_maker *maker);
uint64_t olx_surface_maker_bytes(uint32_t n);
void olx_surface_maker_free(olx_surface_maker *maker);

// Encodes the surfaces of a probe into maker->maps, on up to `threads` threads. A tile has half the resolution where no
// texel loses more by it than its light's noise or its material's rounding: never across edges. Errors of direct light
// are weighed relative to all light at their texel, so that an error in a shadow counts little where indirect light is
// strong.
olx_result olx_surface_maker_encode(olx_surface_maker *maker, const olx_surface_texels *texels, uint32_t n,
                                    uint32_t threads);

#endif
