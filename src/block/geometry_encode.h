// Finds the planes of geometry blocks (docs/maths.md, "Blocks").
#ifndef OLX_BLOCK_GEOMETRY_ENCODE_H
#define OLX_BLOCK_GEOMETRY_ENCODE_H

#include "block/geometry_block.h"

// What the ray through a texel's middle hits.
typedef struct olx_geometry_texel {
  float distance;  // along the ray, in any unit; sky unless above 0 and finite
  olx_vec3 normal; // of the surface, unit, on the probe's side; if not a unit vector, the surface faces the probe
} olx_geometry_texel;

typedef struct olx_geometry_settings {
  float tolerance;    // greatest distance between a texel's point and its decoded plane in footprints; default 0.25
  float least_cosine; // least cosine between a texel's normal and that of its plane; default 0.8
} olx_geometry_settings;

typedef struct olx_geometry_code {
  olx_geometry_block block;
  uint32_t pooled; // planes of the pool that the block needs; the caller adds their first number to words[0]
  olx_plane_code planes[OLX_BLOCK_TEXELS];
} olx_geometry_code;

olx_geometry_settings olx_geometry_settings_default(void);

// Encodes a block of texels, row by row. A footprint is distance times the square root of the texel's solid angle.
// Where the bits of the codes do not suffice for the tolerance, the texel gets the nearest plane.
olx_geometry_code olx_geometry_encode(const olx_geometry_texel texels[OLX_BLOCK_TEXELS], olx_block_place place,
                                      const olx_geometry_settings *settings);

#endif
