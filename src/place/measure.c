// Measures how much of a scene a set of probes covers, by surfels that the placement never used.
#include "place/measure.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/marks.h"

enum {
  HELD_OUT = 4, // times the surfels that placement uses, within these:
  LEAST_HELD_OUT = 16000,
  MOST_HELD_OUT = 200000,
  HELD_OUT_SEED = 0x0DDBA11 // apart from all that placement draws
};

static uint32_t held_out_count(const olx_place_settings *settings) {
  const uint32_t wanted = HELD_OUT * settings->surfels;
  return wanted < LEAST_HELD_OUT ? LEAST_HELD_OUT : wanted > MOST_HELD_OUT ? MOST_HELD_OUT : wanted;
}

static uint32_t held_out_seed(const olx_place_settings *settings) { return olx_hash2(settings->seed, HELD_OUT_SEED); }

typedef struct judged {
  olx_vec3 *places;   // of the probes that are not buried
  uint32_t *probe_of; // their indices in the set
  uint32_t *gains;    // surfels that each covers and none before it
  uint32_t count;
  olx_surfels rays, area;
  uint8_t *views;   // that see a surfel well
  uint8_t *visible; // whether any sees it at all
  uint32_t *first;
} judged;

static olx_result find_buried(const olx_space *space, olx_probe_set *set, judged *j) {
  olx_depth *depths = olx_allocate(set->count, sizeof *depths);
  olx_vec3 *places = olx_allocate(set->count, sizeof *places);
  olx_result result = OLX_ERROR_MEMORY;
  if (depths && places) {
    for (uint32_t i = 0; i < set->count; i++) places[i] = set->probes[i].position;
    result = olx_measure_depth(space->scene, places, set->count, set->settings.threads, depths);
  } else {
    olx_fail(result, "place: out of memory");
  }
  for (uint32_t i = 0; result == OLX_OK && i < set->count; i++) {
    set->probes[i].buried = olx_depth_is_inside(depths[i], space->outside);
    set->report.buried += set->probes[i].buried;
    if (set->probes[i].buried) continue;
    j->places[j->count] = places[i];
    j->probe_of[j->count++] = i;
  }
  olx_release(depths);
  olx_release(places);
  return result;
}

static void tell_coverage(const judged *j, olx_probe_set *set) {
  olx_place_report *report = &set->report;
  const double share = j->rays.share;
  uint32_t covered = 0, grazing = 0, missed = 0, restricted = 0;
  for (uint32_t i = 0; i < j->rays.count; i++) {
    const olx_surfel_fate fate = j->rays.items[i].fate;
    if (j->first[i] < j->count) j->gains[j->first[i]]++;
    if (j->views[i] >= set->settings.views) covered++;
    else if (fate == OLX_SURFEL_GRAZING) grazing++;
    else if (fate == OLX_SURFEL_FIT) missed++;
    else restricted++;
  }
  for (uint32_t i = 0; i < j->count; i++) set->probes[j->probe_of[i]].gain = (float)(j->gains[i] * share);
  report->coverage = covered * share;
  report->grazing = grazing * share;
  report->missed = missed * share;
  report->restricted = restricted * share;
  report->coverable = 1.0 - report->grazing - report->restricted;
}

static double seen_share(const olx_surfels *surfels, const uint8_t *views, uint32_t least) {
  uint32_t seen = 0;
  for (uint32_t i = 0; i < surfels->count; i++) seen += views[i] >= least;
  return seen * surfels->share;
}

static olx_result make_rays(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                            olx_surfels *rays) {
  OLX_TRY(olx_surfels_create(space, sight, OLX_SPREAD_RAYS, held_out_count(settings), held_out_seed(settings),
                             settings->threads, rays));
  if (rays->count > 0) return OLX_OK;
  return olx_fail(OLX_ERROR_EMPTY, "nothing to see: no surface is seen from where probes may stand");
}

static olx_result judge(const olx_space *space, const olx_sight *sight, judged *j, olx_probe_set *set) {
  const uint32_t threads = set->settings.threads, least = set->settings.views;
  const uint32_t seed = held_out_seed(&set->settings), held_out = held_out_count(&set->settings);
  OLX_TRY(find_buried(space, set, j));
  OLX_TRY(make_rays(space, sight, &set->settings, &j->rays));
  OLX_TRY(olx_surfels_create(space, sight, OLX_SPREAD_AREA, held_out, olx_hash(seed), threads, &j->area));
  set->report.surfels = j->rays.count;
  set->report.unreachable = j->area.unreachable;
  OLX_TRY(olx_count_views(space, sight, j->places, j->count, &j->area, least, threads, j->views, NULL));
  set->report.coverage_by_area = seen_share(&j->area, j->views, least);
  OLX_TRY(olx_count_views(space, sight, j->places, j->count, &j->rays, least, threads, j->views, j->first));
  OLX_TRY(olx_count_views(space, NULL, j->places, j->count, &j->rays, 1, threads, j->visible, NULL));
  // A ray along an edge may meet it or not, as it is packed with others: what is seen well is visible.
  for (uint32_t i = 0; i < j->rays.count; i++) j->visible[i] |= j->views[i] > 0;
  set->report.visible = seen_share(&j->rays, j->visible, 1);
  OLX_TRY(olx_surfels_ask(space, sight, j->views, least, seed, threads, &j->rays));
  tell_coverage(j, set);
  return set->settings.marks ? olx_mark_uncovered(&j->rays, j->views, set) : OLX_OK;
}

static olx_result judge_coverage(const olx_space *space, const olx_sight *sight, judged *j, olx_probe_set *set,
                                 double *coverage) {
  const olx_place_settings *s = &set->settings;
  OLX_TRY(find_buried(space, set, j));
  OLX_TRY(make_rays(space, sight, s, &j->rays));
  OLX_TRY(olx_count_views(space, sight, j->places, j->count, &j->rays, s->views, s->threads, j->views, NULL));
  *coverage = seen_share(&j->rays, j->views, s->views);
  return OLX_OK;
}

// Measures the coverage alone when `coverage` is given, else everything.
static olx_result measure(const olx_space *space, const olx_sight *sight, olx_probe_set *set, double *coverage) {
  const size_t most = 2 * (size_t)held_out_count(&set->settings); // both sides of every point
  judged j = {.places = olx_allocate(set->count, sizeof *j.places),
              .probe_of = olx_allocate(set->count, sizeof *j.probe_of),
              .gains = olx_allocate_zero(set->count, sizeof *j.gains),
              .views = olx_allocate(most, 1),
              .visible = olx_allocate(most, 1),
              .first = olx_allocate(most, sizeof *j.first)};
  olx_result result = OLX_ERROR_MEMORY;
  if (!j.places || !j.probe_of || !j.gains || !j.views || !j.visible || !j.first) {
    olx_fail(result, "place: out of memory");
  } else {
    result = coverage ? judge_coverage(space, sight, &j, set, coverage) : judge(space, sight, &j, set);
  }
  olx_release(j.places);
  olx_release(j.probe_of);
  olx_release(j.gains);
  olx_release(j.views);
  olx_release(j.visible);
  olx_release(j.first);
  olx_surfels_free(&j.rays);
  olx_surfels_free(&j.area);
  return result;
}

olx_result olx_measure_probes(const olx_space *space, const olx_sight *sight, olx_probe_set *set) {
  return measure(space, sight, set, NULL);
}

olx_result olx_measure_coverage(const olx_space *space, const olx_sight *sight, olx_probe_set *set, double *coverage) {
  return measure(space, sight, set, coverage);
}
