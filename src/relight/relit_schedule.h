// Chooses what a frame of a relighter lights, without computing light: frames on the CPU and on a device light the same
// parts in the same order. What has been chosen counts as lit from then on.
#ifndef OLX_RELIGHT_RELIT_SCHEDULE_H
#define OLX_RELIGHT_RELIT_SCHEDULE_H

#include "relight/relit_turns.h"

#include <octalux/relight.h>

typedef struct olx_relit_schedule olx_relit_schedule;

// Creates the schedule of a relighter; the field and the settings must outlive it. Nothing waits until it is woken.
olx_result olx_relit_schedule_create(const olx_field *source, const olx_relight_settings *settings,
                                     olx_relit_schedule **schedule);
// Frees a schedule. NULL is allowed.
void olx_relit_schedule_free(olx_relit_schedule *schedule);

// Marks everything as out of date after lights have been set. A sample of direct light takes at most `rays` shadow rays
// from a texel and `surfel_rays` from a surfel, and more samples are needed where light is `varying`: it arrives from
// many directions.
void olx_relit_wake(olx_relit_schedule *schedule, uint32_t rays, uint32_t surfel_rays, bool varying);

// Begins a frame. Frames are counted from 1.
void olx_relit_begin_frame(olx_relit_schedule *schedule);

// ---- Turns of a frame, chosen in this order

// Chooses surfels within half of the frame's shadow rays, but one at least where some lack samples. So at least half of
// the rays are for texels while surfels still need some.
olx_relit_surfel_turns olx_relit_take_surfels(olx_relit_schedule *schedule);

// Chooses surfels whose links are followed, in sweeps over all of them until light has settled.
olx_relit_link_turns olx_relit_take_links(olx_relit_schedule *schedule);
// Records how much of the light of surfels changed and how much there is, as sums over them. Records may arrive frames
// later, but in the order of turns. They are ignored once light has settled or lights have been set again.
void olx_relit_links_followed(olx_relit_schedule *schedule, const olx_relit_link_turns *turns, double change,
                              double sum);

// Chooses tiles within the budgets of texels and of shadow rays, of which surfels have `spent` some: those first that
// have waited longest in relation to their distance.
olx_relit_tile_turns olx_relit_take_tiles(olx_relit_schedule *schedule, olx_vec3 eye, uint64_t spent);

// Chooses volume probes, in turn, that lack the present light of surfels.
olx_relit_volume_turns olx_relit_take_volume(olx_relit_schedule *schedule);

// ---- The state of a schedule

// Returns the number of frames begun.
uint32_t olx_relit_frames(const olx_relit_schedule *schedule);
// Returns how often lights were set.
uint32_t olx_relit_light_changes(const olx_relit_schedule *schedule);
// Returns the number of tiles, surfels and volume probes that wait.
uint32_t olx_relit_awake(const olx_relit_schedule *schedule);
uint32_t olx_relit_tiles_waiting(const olx_relit_schedule *schedule);
olx_relight_state olx_relit_probe_state(const olx_relit_schedule *schedule, uint32_t probe);
// Returns the frames in which parts of the maps were last written, 0: as baked. Parts are, probe after probe, each tile
// of the map and then its border.
const uint32_t *olx_relit_part_frames(const olx_relit_schedule *schedule);
// Returns the frame that last wrote to the volume, 0: as baked.
uint32_t olx_relit_volume_frame(const olx_relit_schedule *schedule);

#endif
