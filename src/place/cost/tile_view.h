// Views single tiles of light field maps as a bake would store them, so that their bytes are known before it.
#ifndef OLX_PLACE_TILE_VIEW_H
#define OLX_PLACE_TILE_VIEW_H

#include "block/geometry_encode.h"
#include "field/surface_encode.h"
#include "place/cost/planned_maps.h"

enum { OLX_TILE_VIEW_SIDE = 8, OLX_TILE_VIEW_TEXELS = OLX_TILE_VIEW_SIDE * OLX_TILE_VIEW_SIDE };

// The geometry, the emission and the surfaces of a tile's texels, row by row.
typedef struct olx_tile_view {
  olx_geometry_texel geometry[OLX_TILE_VIEW_TEXELS];
  uint32_t emission[OLX_TILE_VIEW_TEXELS]; // as codes
  uint32_t base[OLX_TILE_VIEW_TEXELS], direct[OLX_TILE_VIEW_TEXELS], indirect[OLX_TILE_VIEW_TEXELS];
  uint16_t specular[OLX_TILE_VIEW_TEXELS], distance[OLX_TILE_VIEW_TEXELS]; // distances: only whether they are infinite
} olx_tile_view;

// A tile: its probe, and the column and row of its first texel in the map.
typedef struct olx_tile_place {
  uint32_t probe, x, y;
} olx_tile_place;

olx_vec3 olx_tile_probe_position(const olx_planned_maps *maps, uint32_t probe);

// Views a tile. Material and direct light are those of the bake; indirect light, which is not known before it, stays 0.
void olx_tile_view_make(const olx_planned_maps *maps, const olx_tile_place *place, olx_tile_view *view);

#endif
