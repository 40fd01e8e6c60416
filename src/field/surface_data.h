// The data that texels of light field probes store of the surfaces that they see: material, light and emission. It also has
// the scene's lights without area (docs/format.md, "Surfaces"). field/texels.h reads the texels.
#ifndef OLX_FIELD_SURFACE_DATA_H
#define OLX_FIELD_SURFACE_DATA_H

#include "block/bc1.h"
#include "block/bc4.h"
#include "block/bc6h.h"

#include "shaders/octalux_shared.h"

#include <octalux/light.h>

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

// The surfaces of a field. Material, direct and indirect light are each stored as texels or as blocks; the other
// pointer is NULL. Emission is always stored as texels.
typedef struct olx_field_surfaces {
  // Maps of texels have borders and hold `texels` of the field for each probe.
  const uint32_t *base;     // base colour and roughness
  const uint16_t *specular; // metallic and specular weight
  const uint32_t *direct;   // RGB9E5, W/m^2
  const uint32_t *indirect; // RGB9E5, W/m^2
  // Maps of blocks have no border and hold (n / 4)^2 for each probe, row by row.
  const olx_bc1_block *base_blocks;                      // the square roots of base colours
  const olx_bc5_block *specular_blocks;                  // roughness and olx_reflectance_pack
  const olx_bc6h_block *direct_blocks, *indirect_blocks; // W/m^2
  const uint32_t *emission; // tile_side^2 words a probe, row by row: 0 without emission, else 1 + the number of a tile
  const uint32_t *tiles;    // OLX_EMISSION_TILE_TEXELS texels each, row by row, RGB9E5, W/(sr m^2)
  uint32_t tile_side;       // tiles along a side of a map
  uint32_t tile_count;
  const olx_field_light *lights;
  uint32_t light_count;
} olx_field_surfaces;

// The maps that may be blocks.
typedef enum olx_surface_map {
  OLX_SURFACE_BASE = 0,
  OLX_SURFACE_SPECULAR,
  OLX_SURFACE_DIRECT,
  OLX_SURFACE_INDIRECT,
  OLX_SURFACE_MAPS
} olx_surface_map;

#endif
