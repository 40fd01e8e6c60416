// What a frame of a relighter lights, apart from its light itself: frames on the CPU and on a device take the same
// parts in the same order. What is taken counts as lit from then on.
#ifndef OLX_SHADE_RELIGHTER_SCHEDULE_H
#define OLX_SHADE_RELIGHTER_SCHEDULE_H

#include "shade/relighter_parts.h"

// Chooses the surfels that get a sample of direct light within `rays` shadow rays, and puts them at the front of
// `queue`. Surfels take turns in their order, the first after the last. Their `rounds` do not count the new sample yet.
// Returns how many.
uint32_t olx_relit_take_surfels(olx_relight *relight, uint64_t rays);
// Counts the samples of the first `count` of `queue`.
void olx_relit_surfels_lit(olx_relight *relight, uint32_t count);

// Surfels whose links are followed in a frame, from `first` on and from the beginning again.
typedef struct olx_relit_sweep_part {
  uint32_t first, count;
  bool ends;   // the sweep: then all surfels have had their turn
  bool dark;   // some surfel lacked samples
  bool shines; // highlights are found anew
} olx_relit_sweep_part;

// False when light has arrived and no link needs to be followed.
bool olx_relit_take_links(olx_relight *relight, olx_relit_sweep_part *part);
// Notes by how much the light of a part changed and how much there was, as sums over its surfels. They may be known
// frames later; parts come in their order.
void olx_relit_links_followed(olx_relight *relight, const olx_relit_sweep_part *part, double change, double sum);

// Chooses the tiles of a frame, `scheduled` and `lit`, within the budgets of texels and of `rays`.
void olx_relit_schedule(olx_relight *relight, olx_vec3 eye, uint64_t rays);
// Counts the tiles of the frame.
void olx_relit_tiles_lit(olx_relight *relight);

// Chooses probes of the volume, puts them at the front of `queue`, and returns how many they are.
uint32_t olx_relit_take_volume(olx_relight *relight);

// Tiles, surfels and volume probes that wait.
uint32_t olx_relit_awake(const olx_relight *relight);

#endif
