// A relighter (octalux/relight.h) and its parts: lights, the schedule, and the light of surfels, of maps and of the
// irradiance volume. Surfels get direct light, links carry light between them, and surfels light the texels of light
// field probes and the volume.
#ifndef OLX_RELIGHT_RELIGHTER_H
#define OLX_RELIGHT_RELIGHTER_H

#include "relight/relit_maps.h"
#include "relight/relit_schedule.h"
#include "relight/relit_surfels.h"
#include "relight/relit_volume.h"

struct olx_relight {
  const olx_field *source; // the baked field
  olx_field field;         // a copy of it with the relighter's lights, maps and volume
  olx_relight_settings settings;
  olx_relit_lights lights;
  olx_relit_direct direct;
  olx_relit_schedule *schedule;
  olx_relit_surfels surfels;
  olx_relit_maps maps;
  olx_relit_volume volume;
  bool on_device; // frames are made on a device
};

// Hands the frames of a relighter to a device, which makes them by the schedule that is returned and changes nothing
// else of the relighter. The schedule belongs to the relighter.
olx_relit_schedule *olx_relit_hand_over(olx_relight *relight);

// Returns whether the relighter has made frames, or has handed them over.
bool olx_relit_has_begun(const olx_relight *relight);

#endif
