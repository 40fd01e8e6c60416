// Counts the memory that solving the light of a scene will take: finds the surfels, and adds up the arrays of all later
// steps.
#include "light/light_needs.h"

#include "core/hooks.h"
#include "core/result.h"
#include "light/scene_light.h"
#include "light/solution/light_steps.h"
#include "light/solution/light_units.h"

enum { SORT_COPIES = 3 }; // of the entries of a lookup: a list that grows, or that the C library sorts

static uint64_t table_bytes(const olx_cell_table *t) {
  return t->capacity * (uint64_t)(sizeof *t->keys + sizeof *t->values);
}

static uint64_t patch_bytes(const olx_scene_light *l) {
  uint64_t links = 0;
  for (uint32_t round = 0; round < OLX_LIGHT_HIDDEN_ROUNDS; round++) links += l->patches[round].count;
  return links * (sizeof(olx_link) + sizeof(float));
}

static uint64_t point_bytes(const olx_scene_light *l) { return l->surfels.point_count * sizeof(olx_surfel_point); }

// Returns the bytes of a step's result, which has everything but points and links.
static uint64_t step_bytes(const olx_scene_light *l) {
  const uint64_t surfel = sizeof(olx_light_surfel) + sizeof(olx_fixed_light) + 2 * sizeof(float) +
                          4 * sizeof(olx_vec3) + sizeof *l->guide.pool_of +
                          OLX_LIGHT_REFINEMENTS * sizeof(uint32_t) +  // surfels of refining batches
                          2 * sizeof(olx_ray_sum) + sizeof(uint32_t); // final rays
  return l->surfels.count * surfel + l->guide.pool_count * sizeof *l->guide.pools + table_bytes(&l->surfels.table) +
         patch_bytes(l);
}

static uint64_t lookup_bytes(const olx_surfel_lookup *l) {
  return l->list_words * (uint64_t)sizeof *l->lists + table_bytes(&l->cubes);
}

// Returns the bytes of as many records as there may be, and of their lookup.
static uint64_t record_bytes(const olx_scene_light *l, const olx_surfel_lookup *visible) {
  const uint64_t record = 2 * sizeof(olx_light_surfel) + sizeof(uint32_t) + sizeof(olx_vec3);
  return OLX_LIGHT_MOST_RECORDS * (l->visible * record + lookup_bytes(visible));
}

// Returns the working memory of bounces, learning and measuring, or of sorting the largest lookup where that is more.
static uint64_t work_bytes(const olx_scene_light *l, const olx_surfel_lookup *visible) {
  const uint64_t surfel = OLX_BOUNCES_KEPT * sizeof(olx_vec3) + sizeof(double) + 2 * sizeof(float);
  const uint64_t solving = l->surfels.count * surfel + l->guide.pool_count * 2 * sizeof(olx_guide_sums);
  const uint64_t sorting =
      OLX_LIGHT_MOST_RECORDS * visible->list_words * (uint64_t)(SORT_COPIES * 2 * sizeof(uint64_t));
  return solving > sorting ? solving : sorting;
}

// Returns the bytes of all first links, and of as many more as refining may add.
static uint64_t link_bytes(const olx_scene_light *l) {
  const uint64_t more = (uint64_t)l->visible * OLX_LIGHT_REFINEMENTS * OLX_LIGHT_MOST_RAYS;
  const uint64_t links =
      l->report.links + more < l->settings.most_links ? l->report.links + more : l->settings.most_links;
  return (links > l->report.links ? links : l->report.links) * sizeof(olx_link) + l->report.links * sizeof(float);
}

static uint64_t unit_bytes(const olx_scene_light *l) {
  const uint64_t rays = l->report.links < OLX_LIGHT_UNIT_RAYS ? l->report.links : OLX_LIGHT_UNIT_RAYS;
  const uint64_t cast =
      rays * (sizeof(olx_link) + sizeof(float) + sizeof(olx_surfel_point)) + l->surfels.count * sizeof(olx_fixed_light);
  const uint64_t step = step_bytes(l), points = point_bytes(l), most = step > points ? step : points;
  return most > cast ? most : cast;
}

static void count(const olx_scene_light *l, const olx_surfel_lookup *visible, olx_light_needs *needs) {
  *needs = (olx_light_needs){.surfels = l->surfels.count,
                             .state_bytes = step_bytes(l) + point_bytes(l) + record_bytes(l, visible),
                             .lookup_bytes = lookup_bytes(visible),
                             .work_bytes = work_bytes(l, visible),
                             .link_bytes = link_bytes(l),
                             .thread_bytes = 4 * (uint64_t)OLX_LINKS_AT_A_TIME,
                             .unit_bytes = unit_bytes(l)};
}

static olx_result explore(olx_scene_light *l, olx_light_needs *needs) {
  OLX_TRY(olx_light_units_explore(l));
  OLX_TRY(olx_ray_guide_create(&l->guide, &l->surfels));
  olx_surfel_lookup visible;
  const olx_result result = olx_surfel_lookup_create(&visible, &l->surfels, l->visible);
  if (result == OLX_OK) count(l, &visible, needs);
  olx_surfel_lookup_free(&visible);
  return result;
}

olx_result olx_light_needs_find(const olx_scene *scene, const olx_scene_light_settings *settings,
                                const olx_vec3 *positions, const uint8_t *flags, uint32_t probes,
                                olx_light_needs *needs) {
  olx_scene_light *l;
  OLX_TRY(olx_scene_light_make(scene, settings, positions, flags, probes, &l));
  l->settings.store = NULL;
  const olx_result result = explore(l, needs);
  olx_scene_light_free(l);
  return result;
}
