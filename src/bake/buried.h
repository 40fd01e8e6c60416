// Finds buried probes: those inside geometry.
#ifndef OLX_BAKE_BURIED_H
#define OLX_BAKE_BURIED_H

#include "scene/scene_data.h"

// Sets OLX_PROBE_BURIED in the flags of probes that are inside geometry, as place/inside.h defines it: probes that see mostly back
// faces *and* lie deeper inside surfaces than what is known to be free.
olx_result olx_find_buried(const olx_scene *scene, const olx_vec3 *positions[2], const uint32_t counts[2],
                           uint8_t *flags[2], uint32_t threads, uint64_t *rays);

#endif
