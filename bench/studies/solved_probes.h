// The probes for which studies solve the light of a scene.
#ifndef OCTALUX_BENCH_SOLVED_PROBES_H
#define OCTALUX_BENCH_SOLVED_PROBES_H

#include "core/vec.h"

#include <octalux/scene.h>

typedef struct solved_probes {
  olx_vec3 *positions;
  uint8_t *flags; // OLX_PROBE_*; all 0
  uint32_t count;
} solved_probes;

// Loads the probes of a file, or those of the scene's grid where `path` is "-". The caller frees the arrays.
olx_result solved_probes_load(const olx_scene *scene, const char *path, solved_probes *probes);

#endif
