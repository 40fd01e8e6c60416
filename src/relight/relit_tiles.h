// The turns of tiles in the schedule of a relighter.
#ifndef OLX_RELIGHT_RELIT_TILES_H
#define OLX_RELIGHT_RELIT_TILES_H

#include "field/field_data.h"
#include "relight/relit_turns.h"

#include <octalux/relight.h>

// The time of a schedule.
typedef struct olx_relit_time {
  uint32_t frame;
  uint32_t solution; // number of sweeps over links that changed light
} olx_relit_time;

typedef struct olx_relit_tile_state {
  olx_relit_tile tile;
  uint32_t solution;   // the solution of surfels from which its indirect light was computed
  uint32_t last_frame; // in which it last changed or lights were set; 0: as baked
  float distance;      // mean distance in metres from the probe to what it sees; 0: it sees the sky alone
  olx_vec3 direction;  // mean direction from the probe, unit
} olx_relit_tile_state;

// A tile that waits for its turn.
typedef struct olx_relit_due {
  float urgency;
  uint32_t tile;
  bool lit; // it gets direct light, too
} olx_relit_due;

typedef struct olx_relit_tiles {
  const olx_field *source;
  float near_metres;
  uint32_t side, a_map, count;
  uint32_t rounds; // number of samples of direct light that a tile needs
  olx_relit_tile_state *states;
  olx_relit_due *due;
  olx_relit_tile *chosen; // the tiles of a frame
  uint32_t *part_frames;  // see olx_relit_part_frames
} olx_relit_tiles;

olx_result olx_relit_tiles_create(const olx_field *source, const olx_relight_settings *settings,
                                  olx_relit_tiles *tiles);
void olx_relit_tiles_free(olx_relit_tiles *tiles);

// Marks all tiles as out of date. They need more samples of direct light where it is `varying`.
void olx_relit_wake_tiles(olx_relit_tiles *tiles, olx_relit_time now, bool varying);
// Chooses at most `most` tiles. At most `most_lit` of them get direct light; where that is 0, the first
// still does if it lacks it, so that every tile has its turn.
olx_relit_tile_turns olx_relit_choose_tiles(olx_relit_tiles *tiles, olx_relit_time now, olx_vec3 eye, uint64_t most,
                                            uint64_t most_lit);

uint32_t olx_relit_count_waiting(const olx_relit_tiles *tiles, olx_relit_time now);
olx_relight_state olx_relit_map_state(const olx_relit_tiles *tiles, olx_relit_time now, uint32_t probe);

#endif
