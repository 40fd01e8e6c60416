// Fills arrays of a solution, as units where there is a store: each unit is a range of elements and the number of rays
// that it cast.
#include "light/solution/light_ranges.h"

#include "core/result.h"

typedef struct range_stage {
  olx_scene_light *light;
  const olx_light_ranges *ranges;
  uint64_t rays; // rays that the last unit cast
} range_stage;

// A unit's part of the array.
typedef struct range {
  uint8_t *elements; // NULL when memory ran out
  uint32_t first, end;
} range;

static range range_of(const range_stage *s, uint32_t unit) {
  range r = {.first = s->ranges->first(s->light, unit), .end = s->ranges->first(s->light, unit + 1)};
  uint8_t *array = s->ranges->array(s->light);
  if (array) r.elements = array + r.first * s->ranges->element_bytes;
  return r;
}

static olx_result out_of_memory(const range_stage *s) {
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for the stage %s", s->ranges->name);
}

static olx_result fill_range(void *user, uint32_t unit) {
  range_stage *s = user;
  const range r = range_of(s, unit);
  s->rays = 0;
  if (!r.elements) return out_of_memory(s);
  OLX_TRY(s->ranges->fill(s->light, r.first, r.end, &s->rays));
  if (!olx_unit_store_is_part(s->light->settings.store)) s->light->report.rays += s->rays;
  return OLX_OK;
}

static void save_range(void *user, uint32_t unit, olx_byte_writer *to) {
  const range_stage *s = user;
  const range r = range_of(s, unit);
  olx_bytes_put(to, &s->rays, 1, sizeof s->rays);
  olx_bytes_put(to, r.elements, r.end - r.first, s->ranges->element_bytes);
}

static olx_result load_range(void *user, uint32_t unit, olx_byte_reader *from) {
  const range_stage *s = user;
  const range r = range_of(s, unit);
  uint64_t rays = 0;
  if (!r.elements) return out_of_memory(s);
  olx_bytes_copy(from, &rays, 1, sizeof rays);
  olx_bytes_copy(from, r.elements, r.end - r.first, s->ranges->element_bytes);
  s->light->report.rays += rays;
  return OLX_OK;
}

static olx_unit_stage stage_of(range_stage *s) {
  const olx_light_ranges *r = s->ranges;
  const uint32_t round = r->round(s->light), units = r->units(s->light);
  return (olx_unit_stage){r->name, round, units, s, fill_range, save_range, load_range, OLX_PARTS_ALL};
}

olx_result olx_light_ranges_fill(olx_scene_light *l, const olx_light_ranges *ranges) {
  range_stage s = {.light = l, .ranges = ranges};
  const olx_unit_stage stage = stage_of(&s);
  if (!l->settings.store) {
    if (!ranges->array(l)) return out_of_memory(&s);
    return ranges->fill(l, ranges->first(l, 0), ranges->first(l, stage.count), &l->report.rays);
  }
  const olx_result result = olx_units_make(l->settings.store, &stage);
  return result == OLX_ERROR_INCOMPLETE ? olx_units_await(l->settings.store, &stage) : result;
}

olx_result olx_light_ranges_load(olx_scene_light *l, const olx_light_ranges *ranges) {
  range_stage s = {.light = l, .ranges = ranges};
  const olx_unit_stage stage = stage_of(&s);
  return olx_unit_store_is_part(l->settings.store) ? olx_units_load(l->settings.store, &stage) : OLX_OK;
}
