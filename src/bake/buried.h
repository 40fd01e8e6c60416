// Finding the probes that stand inside geometry.
#ifndef OLX_BAKE_BURIED_H
#define OLX_BAKE_BURIED_H

#include "scene/scene_data.h"

// Sets OLX_PROBE_BURIED in the flags (zeroed here) of probes that see mostly back faces *and* lie deeper inside surfaces
// than others: the balance of back and front faces crossed on the way out of the scene, a signed parity, exceeds the least
// among all probes and cameras. Neither suffices alone: a probe behind an open sheet sees back faces but lies no deeper,
// and one outside a room lies deeper by the count than one in it but sees fronts and sky. A room whose walls all face
// outwards shifts the balance of every probe in it alike. Both sets of probes are judged together.
olx_result olx_find_buried(const olx_scene *scene, const olx_vec3 *positions[2], const uint32_t counts[2],
                           uint8_t *flags[2], uint32_t threads, uint64_t *rays);

#endif
