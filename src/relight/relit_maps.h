// The light of the texels of light field probes.
#ifndef OLX_RELIGHT_RELIT_MAPS_H
#define OLX_RELIGHT_RELIT_MAPS_H

#include "relight/relit_direct.h"
#include "relight/relit_turns.h"

typedef struct olx_relit_maps {
  const olx_field *source;
  uint32_t *direct, *indirect; // RGB9E5, W/m^2, laid out as the maps of a field
} olx_relit_maps;

// Creates maps with the light of the bake.
olx_result olx_relit_maps_create(const olx_field *source, olx_relit_maps *maps);
void olx_relit_maps_free(olx_relit_maps *maps);

// Lights the tiles whose turn it is, from lights and from the indirect irradiance of each surfel, W/m^2.
void olx_relit_light_tiles(olx_relit_maps *maps, olx_relit_direct *direct, const olx_vec3 *surfels,
                           const olx_relit_tile_turns *turns);

#endif
