// Finds buried probes: those inside geometry.
#ifndef OLX_BAKE_BURIED_H
#define OLX_BAKE_BURIED_H

#include "bake/probe_sets.h"

// Sets OLX_PROBE_BURIED in the flags of probes that are inside geometry, as place/space/inside.h defines it: probes
// that see mostly back faces *and* lie deeper inside surfaces than what is known to be free.
olx_result olx_find_buried(const olx_scene *scene, olx_probe_sets *probes, uint32_t threads, uint64_t *rays);

#endif
