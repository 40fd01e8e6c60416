// What the texels of light field probes hold of the surfaces that they see: material, light, emission, and the lights
// of the scene that have no area (docs/format.md, "Surfaces"). field/texels.h reads them.
#ifndef OLX_FIELD_SURFACE_DATA_H
#define OLX_FIELD_SURFACE_DATA_H

#include "block/bc1.h"
#include "block/bc4.h"
#include "block/bc6h.h"

#include "shaders/octalux_shared.h"

enum {
  OLX_EMISSION_TILE = 8, // texels along a side of a tile of emission
  OLX_EMISSION_TILE_TEXELS = OLX_EMISSION_TILE * OLX_EMISSION_TILE,
  OLX_FIELD_MOST_LIGHTS = 1 << 20
};

typedef enum olx_field_light_type { OLX_FIELD_SUN = 0, OLX_FIELD_POINT = 1, OLX_FIELD_SPOT = 2 } olx_field_light_type;

// LITE: a light without area. What a type does not use is 0.
typedef struct olx_field_light {
  uint32_t type;                    // olx_field_light_type
  olx_vec3 position;                // metres: point, spot
  olx_vec3 direction;               // of travel, unit: sun, spot
  olx_vec3 emission;                // sun: irradiance on a surface facing it; point, spot: radiant intensity
  float cosine_inner, cosine_outer; // spot: full light inside, none outside, smooth between
  uint32_t zero[4];
} olx_field_light;

_Static_assert(sizeof(olx_field_light) == 64, "docs/format.md");

// The surfaces of a field: each of material, direct and indirect light as texels or as blocks, whichever is not NULL.
// Emission is always as texels.
typedef struct olx_field_surfaces {
  // Maps of texels have borders, `texels` of the field for each probe.
  const uint32_t *base;     // base colour and roughness
  const uint16_t *specular; // metallic and specular weight
  const uint32_t *direct;   // RGB9E5, W/m^2
  const uint32_t *indirect; // RGB9E5, W/m^2
  // Maps of blocks have none: (n / 4)^2 for each probe, row by row.
  const olx_bc1_block *base_blocks;                      // the roots of base colours
  const olx_bc5_block *specular_blocks;                  // roughness and olx_reflectance_pack
  const olx_bc6h_block *direct_blocks, *indirect_blocks; // W/m^2
  const uint32_t *emission; // tile_side^2 words a probe, rows of tiles: 0, or 1 and the number of a tile
  const uint32_t *tiles;    // OLX_EMISSION_TILE_TEXELS texels each, rows, RGB9E5, W/(sr m^2)
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
