// Indirect light before a bake has found it, roughly: as even or uneven as the bake's, which decides the bytes of its
// tiles, while its brightness is only of the right order.
#ifndef OLX_PLACE_ROUGH_LIGHT_H
#define OLX_PLACE_ROUGH_LIGHT_H

#include "place/cost/tile_view.h"

enum { OLX_ROUGH_SOURCES = 256 };

// A patch of surface that reflects light.
typedef struct olx_rough_source {
  olx_vec3 position, normal, albedo;
  olx_vec3 direct, sent; // irradiance, and what is reflected of all light, W/m^2
  float area;            // relative to the others'
} olx_rough_source;

// The patches. Zero-initialised there are none, and no light.
typedef struct olx_rough_light {
  uint32_t count;
  float closed; // share of directions in which probes see surfaces
  olx_rough_source sources[OLX_ROUGH_SOURCES];
} olx_rough_light;

// Adds what a tile sees, once it is viewed, as a patch, unless it is sky. There is room for OLX_ROUGH_SOURCES.
void olx_rough_light_add(olx_rough_light *light, const olx_planned_maps *maps, const olx_tile_place *place,
                         const olx_tile_view *view);
// Lets the patches light each other for so many bounces.
void olx_rough_light_solve(olx_rough_light *light, uint32_t bounces);
// Sets the indirect light of a tile's texels.
void olx_rough_light_set(const olx_rough_light *light, const olx_planned_maps *maps, const olx_tile_place *place,
                         olx_tile_view *view);

#endif
