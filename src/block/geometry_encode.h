// Finds the planes of geometry blocks (docs/maths.md, "Blocks").
#ifndef OLX_BLOCK_GEOMETRY_ENCODE_H
#define OLX_BLOCK_GEOMETRY_ENCODE_H

#include "block/geometry_block.h"

// What the ray through a texel's middle meets.
typedef struct olx_geometry_texel {
  float distance;  // along the ray, in any unit; what is not above 0 and finite is sky
  olx_vec3 normal; // of the surface, unit, on the probe's side; one that is not counts as facing the probe
} olx_geometry_texel;

typedef struct olx_geometry_settings {
  float tolerance;    // footprints between a texel's point and its decoded plane, at most; default 0.25
  float least_cosine; // between its normal and that of the plane, at least; default 0.8
} olx_geometry_settings;

typedef struct olx_geometry_code {
  olx_geometry_block block;
  uint32_t pooled; // planes of the pool that the block needs; the caller adds their first number to words[0]
  olx_plane_code planes[OLX_BLOCK_TEXELS];
} olx_geometry_code;

olx_geometry_settings olx_geometry_settings_default(void);

// Encodes a block of texels, row by row. A footprint is distance times the root of the texel's solid angle. Where a
// tolerance cannot be met because numbers have no more bits, the texel gets the nearest plane there is.
olx_geometry_code olx_geometry_encode(const olx_geometry_texel texels[OLX_BLOCK_TEXELS], olx_block_place place,
                                      const olx_geometry_settings *settings);

#endif
