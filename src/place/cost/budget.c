// Converts a budget of bytes to a number of probes: before there are any by places in the space that matters, and then
// by the probes themselves.
#include "place/cost/budget.h"

#include "core/hooks.h"
#include "core/result.h"
#include "place/cost/field_bytes.h"

#include <octalux/limits.h>

#include <math.h>

enum {
  PLACES = 64,       // in space, from which texels are sampled before there are probes
  VOLUME_CELLS = 32, // the default of bakes
  SAMPLES = 2,       // the default of bakes
  BOUNCES = 128      // the default of bakes
};

// Returns the maps that a bake with default settings makes.
static olx_planned_maps planned(const olx_scene *scene, const olx_vec3 *positions, uint32_t count, uint32_t size) {
  return (olx_planned_maps){.scene = scene,
                            .positions = positions,
                            .count = count,
                            .size = size,
                            .samples = SAMPLES,
                            .light_samples = 1,
                            .bounces = BOUNCES};
}

// Expected size of a field of `count` probes, as bakes store it by default.
static uint64_t field_bytes(const olx_scene *scene, uint32_t count, uint32_t resolution,
                            const olx_texel_bytes *texels) {
  const olx_field_header header = {.info = {.probes.count = count,
                                            .maps = {.size = resolution, .compressed = true, .geometry_blocks = true},
                                            .select_mask = 1u << OLX_SELECT_BRICKS},
                                   .light_count = scene->light_count,
                                   .origin = {scene->origin[0], scene->origin[1], scene->origin[2]}};
  return olx_expected_bytes(&header, olx_expected_volume_bytes(scene, resolution, VOLUME_CELLS), texels);
}

static uint32_t affordable(const olx_scene *scene, const olx_place_settings *s, const olx_texel_bytes *texels) {
  uint32_t least = 0, most = OLX_PLACE_PROBES_MOST;
  while (least < most) {
    const uint32_t count = least + (most - least + 1) / 2;
    if ((double)field_bytes(scene, count, s->resolution, texels) <= s->budget_mb * 1e6) least = count;
    else most = count - 1;
  }
  return least;
}

olx_result olx_budget_count(const olx_world *world, const olx_place_settings *s, uint32_t *count) {
  const olx_scene *scene = world->scene;
  olx_vec3 places[PLACES];
  olx_texel_bytes texels = {0};
  const olx_planned_maps maps = planned(scene, places, olx_world_spread(world, PLACES, places), s->resolution);
  if (maps.count) OLX_TRY(olx_texel_bytes_sample(&maps, s->threads, &texels));
  *count = affordable(scene, s, &texels);
  if (*count) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT,
                  "place: a budget of %g MB does not hold a field of one probe of %u x %u texels, which takes %.3f MB",
                  s->budget_mb, s->resolution, s->resolution,
                  ceil((double)field_bytes(scene, 1, s->resolution, &texels) * 1e-3) * 1e-3);
}

static olx_result sample_probes(const olx_scene *scene, const olx_candidate *probes, const olx_probe_set *set,
                                olx_texel_bytes *texels) {
  olx_vec3 *positions = olx_allocate(set->count, sizeof *positions);
  if (!positions) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  for (uint32_t i = 0; i < set->count; i++) positions[i] = probes[i].place;
  const olx_planned_maps maps = planned(scene, positions, set->count, set->settings.resolution);
  const olx_result result = olx_texel_bytes_sample(&maps, set->settings.threads, texels);
  olx_release(positions);
  return result;
}

olx_result olx_budget_keep(const olx_scene *scene, const olx_candidate *probes, olx_probe_set *set) {
  const olx_place_settings *s = &set->settings;
  if (!s->field_size && !(s->budget_mb > 0.0)) return OLX_OK;
  olx_texel_bytes texels = {0};
  if (set->count) OLX_TRY(sample_probes(scene, probes, set, &texels));
  if (s->budget_mb > 0.0 && s->method != OLX_PLACE_GRID) {
    const uint32_t pinned = scene->probe_rules.pinned_count, least = pinned ? pinned : 1,
                   most = affordable(scene, s, &texels);
    if (most < set->count) set->count = most > least ? most : least;
  }
  set->report.field_bytes = field_bytes(scene, set->count, s->resolution, &texels);
  return OLX_OK;
}
