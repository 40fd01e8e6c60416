// Places probes on a regular grid, except at points that the scene's rules forbid.
#include "place/grid.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"

static bool keeps_distance(const olx_candidate *probes, uint32_t count, olx_vec3 place, float least) {
  for (uint32_t i = 0; least > 0.0f && i < count; i++) {
    if (olx_length(olx_sub(probes[i].place, place)) < least) return false;
  }
  return true;
}

olx_result olx_place_grid(const olx_scene *scene, const olx_grid *grid, olx_candidate **probes, uint32_t *count,
                          uint32_t *rejected) {
  const olx_probe_rules *rules = &scene->probe_rules;
  const uint64_t total = (uint64_t)grid->count[0] * grid->count[1] * grid->count[2];
  *count = *rejected = 0;
  *probes = olx_allocate((size_t)total + rules->pinned_count, sizeof **probes);
  if (!*probes) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %llu probes", (unsigned long long)total);
  for (uint32_t i = 0; i < rules->pinned_count; i++) {
    (*probes)[(*count)++] = (olx_candidate){rules->pinned[i], OLX_ORIGIN_PINNED};
  }
  olx_result result = OLX_OK;
  for (uint64_t i = 0; i < total && result == OLX_OK; i++) {
    const olx_vec3 cell = {(float)(i % grid->count[0]), (float)(i / grid->count[0] % grid->count[1]),
                           (float)(i / grid->count[0] / grid->count[1])};
    const olx_vec3 place = olx_add(grid->origin, olx_mul(cell, grid->spacing));
    if (olx_rules_allow(scene, place) && keeps_distance(*probes, *count, place, rules->min_distance)) {
      (*probes)[(*count)++] = (olx_candidate){place, OLX_ORIGIN_GRID};
    } else {
      ++*rejected;
    }
    result = olx_check_cancelled();
  }
  if (result == OLX_OK && *count > 0) return OLX_OK;
  olx_release(*probes);
  *probes = NULL;
  if (result != OLX_OK) return result;
  return olx_fail(OLX_ERROR_EMPTY, "no probe is left: the description forbids all %u points of the grid", *rejected);
}
