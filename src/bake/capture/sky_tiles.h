// Guides for samples of the sky at the texels of a probe, one for each tile of its map: most of a room sees the sky
// through windows alone, which even samples rarely find.
#ifndef OLX_BAKE_SKY_TILES_H
#define OLX_BAKE_SKY_TILES_H

#include "bake/capture/capture.h"
#include "scene/sky_guide.h"

enum { OLX_SKY_TILES = 8 }; // along a side of a map

// Learns the guides of the probe that was captured last (OLX_SKY_TILES^2 of them, in rows) from samples of some of its
// texels, which nothing else uses. Adds the rays that it casts to *rays. The result depends on the probe, the scene and
// the settings alone.
olx_result olx_sky_tiles_learn(const olx_capture *capture, olx_sky_guide *guides, atomic_uint_fast64_t *rays);

// Returns the tile of a texel.
static inline uint32_t olx_sky_tile_of(uint32_t size, uint32_t x, uint32_t y) {
  return y * OLX_SKY_TILES / size * OLX_SKY_TILES + x * OLX_SKY_TILES / size;
}

#endif
