// Places probes in worlds of many tiles: each tile is covered on its own, given what its neighbours have, and all are
// joined.
//
// Tiles have eight colours, by the parity of their indices along each axis. Tiles of one colour do not touch, and each
// depends on probes in tiles of earlier colours alone, so that tiles of one colour may be covered in any order.
#ifndef OLX_PLACE_TILES_H
#define OLX_PLACE_TILES_H

#include "place/cover/cover.h"

enum { OLX_TILE_COLOURS = 8 };

typedef struct olx_tile_probes {
  olx_candidate *items;
  uint32_t count;
} olx_tile_probes;

typedef struct olx_tiling {
  olx_world *world;
  const olx_sight *sight;
  const olx_place_settings *settings;
  olx_tile_probes pinned, *tiles; // pinned by the description; and each tile's own
  uint32_t candidates;            // number of candidates considered
} olx_tiling;

olx_result olx_tiling_create(olx_world *world, const olx_sight *sight, const olx_place_settings *settings,
                             olx_tiling *tiling);
void olx_tiling_free(olx_tiling *tiling);

uint32_t olx_tile_colour(const olx_world *world, uint32_t tile);
// Covers what belongs to the tile, given the pinned probes and those of neighbouring tiles that have some.
olx_result olx_tiling_cover(olx_tiling *tiling, uint32_t tile);
// Joins the pinned probes and those of each tile, in order. The caller releases *probes with olx_release.
olx_result olx_tiling_join(const olx_tiling *tiling, olx_candidate **probes, uint32_t *count);

// Covers all tiles, colour by colour. `task` advances by settings->candidates.
olx_result olx_tiling_cover_all(olx_tiling *tiling, olx_task *task);

#endif
