#include "bake/buried.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/field_data.h"
#include "place/inside.h"

#include <string.h>

static void judge(const olx_scene *scene, const olx_depth *depths, const uint32_t counts[2], uint8_t *flags[2],
                  uint64_t *rays) {
  const size_t total = (size_t)counts[0] + counts[1] + scene->camera_count;
  int32_t least = INT32_MAX;
  for (size_t i = 0; i < total; i++) {
    if (depths[i].depth < least) least = depths[i].depth;
    *rays += depths[i].rays;
  }
  for (uint32_t set = 0; set < 2; set++) {
    const uint32_t first = set * counts[0];
    for (uint32_t i = 0; i < counts[set]; i++) {
      flags[set][i] = olx_depth_is_inside(depths[first + i], least) ? OLX_PROBE_BURIED : 0;
    }
  }
}

olx_result olx_find_buried(const olx_scene *scene, const olx_vec3 *positions[2], const uint32_t counts[2],
                           uint8_t *flags[2], uint32_t threads, uint64_t *rays) {
  const uint32_t probes = counts[0] + counts[1], total = probes + scene->camera_count;
  olx_vec3 *all = olx_allocate(total, sizeof *all);
  olx_depth *depths = olx_allocate(total, sizeof *depths);
  olx_result result = OLX_ERROR_MEMORY;
  if (all && depths) {
    memcpy(all, positions[0], counts[0] * sizeof *all);
    memcpy(all + counts[0], positions[1], counts[1] * sizeof *all);
    for (uint32_t i = 0; i < scene->camera_count; i++) all[probes + i] = scene->cameras[i].eye;
    result = olx_measure_depth(scene, all, total, threads, depths);
    if (result == OLX_OK) judge(scene, depths, counts, flags, rays);
  } else {
    result = olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u probes", total);
  }
  olx_release(depths);
  olx_release(all);
  return result;
}
