// The data that texels of light field probes store of the surfaces that they see: material, light and emission. It also
// has the scene's lights without area (docs/format.md, "Surfaces"). field/texels.h reads the texels.
#ifndef OLX_FIELD_SURFACE_DATA_H
#define OLX_FIELD_SURFACE_DATA_H

#include "block/bc1.h"
#include "block/bc4.h"
#include "block/bc6h.h"

#include "shaders/octalux_shared.h"

#include <octalux/light.h>

enum { OLX_TILE_TEXELS = OLX_TILE_SIDE * OLX_TILE_SIDE, OLX_TILE_MOST_BLOCKS = 1 << OLX_TILE_FORM_SHIFT };
enum { OLX_EMISSION_TILE_TEXELS = OLX_EMISSION_TILE * OLX_EMISSION_TILE, OLX_FIELD_MOST_LIGHTS = 1 << 20 };

// A light without area (octalux/light.h) as the chunk LITE and devices pack it. Values that its type does not use are
// 0.
typedef struct olx_field_light {
  uint32_t type; // OLX_LIGHT_SUN, _POINT or _SPOT
  olx_vec3 position, direction, emission;
  float cosine_inner, cosine_outer;
  uint32_t zero[4];
} olx_field_light;

_Static_assert(sizeof(olx_field_light) == OLX_FIELD_LIGHT_WORDS * sizeof(uint32_t), "docs/format.md");

// The maps that may be stored as tiles.
typedef enum olx_surface_map {
  OLX_SURFACE_BASE = 0, // olx_bc1_block: the square roots of base colours
  OLX_SURFACE_SPECULAR, // olx_bc5_block: roughness and olx_reflectance_pack
  OLX_SURFACE_DIRECT,   // olx_bc6h_block: W/m^2
  OLX_SURFACE_INDIRECT, // olx_bc6h_block: W/m^2
  OLX_SURFACE_MAPS
} olx_surface_map;

// Maps of one kind as tiles: (n / 8)^2 words for each probe, row by row (OLX_TILE_*), and the pool of the blocks that
// they name.
typedef struct olx_tiled_maps {
  const uint32_t *words;
  const void *blocks;
  uint32_t count; // of blocks in the pool
} olx_tiled_maps;

// Returns the bytes of a block in the pool of a kind of map.
static inline uint32_t olx_surface_block_bytes(olx_surface_map map) {
  return map == OLX_SURFACE_BASE ? sizeof(olx_bc1_block) : sizeof(olx_bc6h_block);
}

// Returns the bytes of the blocks of so many texels where every tile has full resolution and none equals another.
static inline uint64_t olx_surface_most_bytes(uint64_t texels) {
  uint64_t bytes = 0;
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) bytes += olx_surface_block_bytes(map);
  return texels / (OLX_BLOCK_SIDE * OLX_BLOCK_SIDE) * bytes;
}

// Returns the number of blocks that a tile names; 0 for the sky.
static inline uint32_t olx_tile_blocks(uint32_t word) {
  const uint32_t form = word >> OLX_TILE_FORM_SHIFT;
  return form == OLX_TILE_HALF ? 1 : form == OLX_TILE_FULL ? 4 : 0;
}

static inline uint32_t olx_tile_first(uint32_t word) { return word & ((1u << OLX_TILE_FORM_SHIFT) - 1u); }

// The surfaces of a field. Either all of material, direct and indirect light is stored as texels, or all as tiles; the
// other pointers are NULL. Emission is always stored as texels.
typedef struct olx_field_surfaces {
  // Maps of texels have borders and hold `texels` of the field for each probe.
  const uint32_t *base;     // base colour and roughness
  const uint16_t *specular; // metallic and specular weight
  const uint32_t *direct;   // RGB9E5, W/m^2
  const uint32_t *indirect; // RGB9E5, W/m^2
  olx_tiled_maps tiled[OLX_SURFACE_MAPS];
  const uint32_t *emission; // tile_side^2 words a probe, row by row: 0 without emission, else 1 + the number of a tile
  const uint32_t *tiles;    // OLX_EMISSION_TILE_TEXELS texels each, row by row, RGB9E5, W/(sr m^2)
  uint32_t tile_side;       // tiles along a side of a map
  uint32_t tile_count;
  const olx_field_light *lights;
  uint32_t light_count;
} olx_field_surfaces;

#endif
