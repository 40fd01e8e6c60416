// Encodes the geometry that light field probes see as blocks (docs/maths.md, "Blocks").
#ifndef OLX_FIELD_GEOMETRY_MAP_ENCODE_H
#define OLX_FIELD_GEOMETRY_MAP_ENCODE_H

#include "block/geometry_encode.h"
#include "core/result.h"
#include "field/geometry_map.h"

// Encodes one map at a time, and keeps its blocks and the planes to which they refer.
typedef struct olx_geometry_maker {
  olx_geometry_map map; // of the probe encoded last
  olx_geometry_code *codes;
  olx_geometry_block *blocks;
  olx_plane_code *planes;
  uint32_t most_planes;
} olx_geometry_maker;

// Creates a maker for maps of n x n texels. On OLX_ERROR_MEMORY there is nothing to free.
olx_result olx_geometry_maker_create(uint32_t n, olx_geometry_maker *maker);
uint64_t olx_geometry_maker_bytes(uint32_t n); // without planes
void olx_geometry_maker_free(olx_geometry_maker *maker);

// Returns what texel (x, y) of a map sees.
typedef olx_geometry_texel (*olx_geometry_look)(const void *user, uint32_t x, uint32_t y);

// Encodes the n x n texels that `look` returns into maker->map, on up to `threads` threads. Planes are in the order of
// blocks.
olx_result olx_geometry_maker_encode(olx_geometry_maker *maker, uint32_t n, uint32_t threads, olx_geometry_look look,
                                     const void *user);

#endif
