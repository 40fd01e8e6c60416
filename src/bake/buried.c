// Marks probes that are inside geometry as buried, by the depth that place/space/inside.h measures for each of them.
#include "bake/buried.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/field_data.h"
#include "place/space/inside.h"

static olx_result judge(const olx_scene *scene, olx_probe_list *probes, int32_t outside, uint32_t threads,
                        uint64_t *rays) {
  olx_depth *depths = olx_allocate(probes->count, sizeof *depths);
  if (!depths) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u probes", probes->count);
  const olx_result result = olx_measure_depth(scene, probes->positions, probes->count, threads, depths);
  for (uint32_t i = 0; result == OLX_OK && i < probes->count; i++) {
    probes->flags[i] = olx_depth_is_inside(depths[i], outside) ? OLX_PROBE_BURIED : 0;
    *rays += depths[i].rays;
  }
  olx_release(depths);
  return result;
}

olx_result olx_find_buried(const olx_scene *scene, olx_probe_sets *probes, uint32_t threads, uint64_t *rays) {
  int32_t outside;
  OLX_TRY(olx_find_outside(scene, threads, &outside, rays));
  OLX_TRY(judge(scene, &probes->light_field, outside, threads, rays));
  return judge(scene, &probes->irradiance, outside, threads, rays);
}
