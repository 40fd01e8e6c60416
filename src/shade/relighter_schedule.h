// Chooses what a frame of a relighter lights, without computing light: frames on the CPU and on a device light the same
// parts in the same order. What has been chosen counts as lit from then on.
#ifndef OLX_SHADE_RELIGHTER_SCHEDULE_H
#define OLX_SHADE_RELIGHTER_SCHEDULE_H

#include "shade/relighter_parts.h"

// Chooses the surfels that get a sample of direct light within `rays` shadow rays, and puts them at the front of
// `queue`. Surfels take turns in their order, cyclically. Their `rounds` do not count the new sample yet. Returns the
// number of surfels.
uint32_t olx_relit_take_surfels(olx_relight *relight, uint64_t rays);
// Counts the new samples of the first `count` surfels of `queue`.
void olx_relit_surfels_lit(olx_relight *relight, uint32_t count);

// The surfels whose links a frame follows, from `first` on, cyclically.
typedef struct olx_relit_sweep_part {
  uint32_t first, count;
  bool ends;   // the sweep ends with this part: all surfels have had their turn
  bool dark;   // some surfel still lacked samples
  bool shines; // highlights are recomputed
} olx_relit_sweep_part;

// Chooses the surfels whose links are followed. False when light has settled and no link needs to be followed.
bool olx_relit_take_links(olx_relight *relight, olx_relit_sweep_part *part);
// Records the change of a part's light and its amount, as sums over its surfels. They may arrive frames later, but in
// the order of parts.
void olx_relit_links_followed(olx_relight *relight, const olx_relit_sweep_part *part, double change, double sum);

// Chooses the tiles of a frame, `scheduled` and `lit`, within the budgets of texels and of `rays`.
void olx_relit_schedule(olx_relight *relight, olx_vec3 eye, uint64_t rays);
// Counts the samples of the frame's tiles.
void olx_relit_tiles_lit(olx_relight *relight);

// Chooses probes of the volume, puts them at the front of `queue`, and returns their number.
uint32_t olx_relit_take_volume(olx_relight *relight);

// Returns the number of tiles, surfels and volume probes that wait.
uint32_t olx_relit_awake(const olx_relight *relight);

#endif
