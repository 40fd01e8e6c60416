// Computes how much memory solving the light of a scene takes, as found by the steps that distribute surfels.
#ifndef OLX_LIGHT_LIGHT_NEEDS_H
#define OLX_LIGHT_LIGHT_NEEDS_H

#include "light/solution/light_settings.h"

// Upper bounds in bytes, except `surfels`.
typedef struct olx_light_needs {
  uint32_t surfels;
  uint64_t state_bytes;  // kept until the field is written, without links
  uint64_t lookup_bytes; // the lookup of visible surfels that relighting builds
  uint64_t work_bytes;   // held besides state_bytes while light is solved, without links
  uint64_t link_bytes;   // links and what rays bring without them, where they are in memory
  uint64_t thread_bytes; // links that a thread leaves in memory, where they are in files
  uint64_t unit_bytes;   // the largest result that a store receives
} olx_light_needs;

// Finds surfels as olx_scene_light_create does, and forgets them: their number follows from no setting. Takes the time
// and the memory of those steps. settings->store is ignored.
olx_result olx_light_needs_find(const olx_scene *scene, const olx_scene_light_settings *settings,
                                const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                                olx_light_needs *needs);

#endif
