// The turns of a frame: what its schedule has chosen to be lit.
#ifndef OLX_RELIGHT_RELIT_TURNS_H
#define OLX_RELIGHT_RELIT_TURNS_H

#include <octalux/base.h>

enum { OLX_RELIT_TILE_SIDE = 32 }; // at most, the side of a tile in texels of a light field map

// Surfels that get a sample of direct light, cyclically from `first` on. The first `before` of them have `round`
// samples, and the others one more.
typedef struct olx_relit_surfel_turns {
  uint32_t first, count;
  uint32_t round, before;
} olx_relit_surfel_turns;

// Surfels whose links are followed, cyclically from `first` on.
typedef struct olx_relit_link_turns {
  uint32_t first, count;  // 0 once light has settled
  bool ends;              // the sweep ends with them: all surfels have had their turn
  bool dark;              // some surfel still lacked samples of direct light
  bool stale;             // some surfel lacked samples when the sweep began
  bool shines;            // highlights are recomputed
  uint32_t light_changes; // how often lights had been set
} olx_relit_link_turns;

// A tile: a square of a light field map that is scheduled as a whole.
typedef struct olx_relit_tile {
  uint32_t probe, first_x, first_y;
  uint32_t rounds; // number of samples of its direct light
} olx_relit_tile;

// The tiles whose light a frame computes, in the state before it. All of them get indirect light, and the first `lit`
// of them a sample of direct light, too.
typedef struct olx_relit_tile_turns {
  const olx_relit_tile *tiles; // valid until tiles are chosen again
  uint32_t count, lit;
  uint32_t side; // of each tile, in texels
} olx_relit_tile_turns;

// Probes of the volume that are lit, cyclically from `first` on.
typedef struct olx_relit_volume_turns {
  uint32_t first, count;
} olx_relit_volume_turns;

// Returns the side of the tiles of maps with n texels along a side.
static inline uint32_t olx_relit_tile_side(uint32_t n) { return n < OLX_RELIT_TILE_SIDE ? n : OLX_RELIT_TILE_SIDE; }

// Returns the number of tiles of a map with n texels along a side.
static inline uint32_t olx_relit_tiles_a_map(uint32_t n) {
  return (n / olx_relit_tile_side(n)) * (n / olx_relit_tile_side(n));
}

// Returns whether a tile lies at the edge of its map, so that texels of the map's border repeat some of its own.
static inline bool olx_relit_on_edge(const olx_relit_tile *tile, uint32_t side, uint32_t n) {
  return tile->first_x == 0 || tile->first_y == 0 || tile->first_x + side == n || tile->first_y + side == n;
}

#endif
