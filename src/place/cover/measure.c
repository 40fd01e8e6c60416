// Measures how much of a scene a set of probes covers, by held-out surfels, which the placement never used.
#include "place/cover/measure.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/marks.h"
#include "place/space/space_find.h"

enum {
  HELD_OUT = 4,             // held-out surfels for each surfel of placement
  LEAST_HELD_OUT = 16000,   // the fewest held-out surfels
  MOST_HELD_OUT = 200000,   // the most held-out surfels
  TILE_POINTS = 256,        // area points per tile, where there are many
  HELD_OUT_SEED = 0x0DDBA11 // distinct from all seeds of placement
};
#define MOST_AREA ((uint64_t)1 << 21)

static uint32_t held_out_count(const olx_place_settings *settings) {
  const uint32_t wanted = HELD_OUT * settings->surfels;
  return wanted < LEAST_HELD_OUT ? LEAST_HELD_OUT : wanted > MOST_HELD_OUT ? MOST_HELD_OUT : wanted;
}

// Returns the number of rays cast from a tile's space, proportional to its voxels.
static uint32_t ray_count(const olx_space *space, const olx_place_settings *settings) {
  if (space->world->tile_total == 1) return held_out_count(settings);
  return (uint32_t)((double)HELD_OUT * settings->surfels * (double)space->start_count / OLX_SETTINGS_VOXELS);
}

static uint32_t area_count(const olx_world *world, const olx_place_settings *settings) {
  const uint64_t least = held_out_count(settings), wanted = (uint64_t)TILE_POINTS * world->tile_total;
  return (uint32_t)(wanted < least ? least : wanted < MOST_AREA ? wanted : MOST_AREA);
}

static uint32_t held_out_seed(const olx_place_settings *settings) { return olx_hash2(settings->seed, HELD_OUT_SEED); }

// Results of surfels, summed over tiles.
typedef struct tally {
  uint64_t rays, covered, visible, grazing, missed, restricted;
  uint64_t sides, sides_covered, points, points_unseen, sides_cut_off;
  uint32_t *gains; // per probe: surfels that it covers and no earlier probe does
} tally;

// The probes that a tile's surfels are tested against.
typedef struct judged {
  olx_vec3 *places;   // positions of those that are not buried
  uint32_t *probe_of; // their indices in the set
  uint32_t count;
  olx_surfels rays, area;
  uint8_t *views;   // number of probes that see each surfel well
  uint8_t *visible; // whether any probe sees a surfel at all
  uint32_t *first;
} judged;

static olx_result no_memory(void) { return olx_fail(OLX_ERROR_MEMORY, "place: out of memory"); }

static olx_result find_buried(const olx_world *world, olx_probe_set *set) {
  olx_depth *depths = olx_allocate(set->count, sizeof *depths);
  olx_vec3 *places = olx_allocate(set->count, sizeof *places);
  olx_result result = OLX_ERROR_MEMORY;
  if (depths && places) {
    for (uint32_t i = 0; i < set->count; i++) places[i] = set->probes[i].position;
    result = olx_measure_depth(world->scene, places, set->count, set->settings.threads, depths);
  } else {
    no_memory();
  }
  for (uint32_t i = 0; result == OLX_OK && i < set->count; i++) {
    set->probes[i].buried = olx_depth_is_inside(depths[i], world->outside);
    set->report.buried += set->probes[i].buried;
  }
  olx_release(depths);
  olx_release(places);
  return result;
}

static olx_result list_judged(const olx_space *space, const olx_probe_set *set, judged *j) {
  j->places = olx_allocate(set->count, sizeof *j->places);
  j->probe_of = olx_allocate(set->count, sizeof *j->probe_of);
  if (!j->places || !j->probe_of) return no_memory();
  for (uint32_t i = 0; i < set->count; i++) {
    if (set->probes[i].buried || !olx_space_is_near(space, set->probes[i].position)) continue;
    j->places[j->count] = set->probes[i].position;
    j->probe_of[j->count++] = i;
  }
  return OLX_OK;
}

static olx_result make_room(judged *j) {
  const uint32_t most = j->rays.count > j->area.count ? j->rays.count : j->area.count;
  j->views = olx_allocate(most, 1);
  j->visible = olx_allocate(most, 1);
  j->first = olx_allocate(most, sizeof *j->first);
  return j->views && j->visible && j->first ? OLX_OK : no_memory();
}

static void free_judged(judged *j) {
  olx_release(j->places);
  olx_release(j->probe_of);
  olx_release(j->views);
  olx_release(j->visible);
  olx_release(j->first);
  olx_surfels_free(&j->rays);
  olx_surfels_free(&j->area);
}

static uint64_t count_seen(const olx_surfels *surfels, const uint8_t *views, uint32_t least) {
  uint64_t seen = 0;
  for (uint32_t i = 0; i < surfels->count; i++) seen += views[i] >= least;
  return seen;
}

static void add_rays(const judged *j, uint32_t least, tally *t) {
  t->rays += j->rays.count;
  t->visible += count_seen(&j->rays, j->visible, 1);
  for (uint32_t i = 0; i < j->rays.count; i++) {
    const olx_surfel_fate fate = j->rays.items[i].fate;
    if (j->first[i] < j->count) t->gains[j->probe_of[j->first[i]]]++;
    if (j->views[i] >= least) t->covered++;
    else if (fate == OLX_SURFEL_GRAZING) t->grazing++;
    else if (fate == OLX_SURFEL_FIT) t->missed++;
    else t->restricted++;
  }
}

static void add_area(const judged *j, uint32_t least, tally *t) {
  t->sides += j->area.count;
  t->sides_covered += count_seen(&j->area, j->views, least);
  t->points += j->area.present;
  t->points_unseen += j->area.unseen;
  t->sides_cut_off += j->area.cut_off_count;
}

static olx_result make_rays(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                            olx_surfels *rays) {
  if (space->start_count == 0) return OLX_OK;
  const uint32_t seed = olx_hash2(held_out_seed(settings), space->tile.index);
  return olx_surfels_create(space, sight, OLX_SPREAD_RAYS, ray_count(space, settings),
                            space->world->tile_total == 1 ? held_out_seed(settings) : seed, settings->threads, rays);
}

static olx_result judge(const olx_space *space, const olx_sight *sight, const olx_area_points *points, judged *j,
                        olx_probe_set *set, tally *t) {
  const uint32_t threads = set->settings.threads, least = set->settings.views, seed = held_out_seed(&set->settings);
  OLX_TRY(list_judged(space, set, j));
  OLX_TRY(make_rays(space, sight, &set->settings, &j->rays));
  OLX_TRY(olx_area_surfels(space, sight, points, threads, &j->area));
  OLX_TRY(make_room(j));
  OLX_TRY(olx_count_views(space, sight, j->places, j->count, &j->area, least, threads, j->views, NULL));
  add_area(j, least, t);
  OLX_TRY(olx_count_views(space, sight, j->places, j->count, &j->rays, least, threads, j->views, j->first));
  OLX_TRY(olx_count_views(space, NULL, j->places, j->count, &j->rays, 1, threads, j->visible, NULL));
  // A ray along an edge may hit it or not, depending on the rays it is packed with: whatever is seen well counts as
  // visible.
  for (uint32_t i = 0; i < j->rays.count; i++) j->visible[i] |= j->views[i] > 0;
  OLX_TRY(olx_surfels_ask(space, sight, j->views, least, seed, threads, &j->rays));
  add_rays(j, least, t);
  if (set->settings.marks) OLX_TRY(olx_mark_uncovered(&j->rays, j->views, space->world->tile_total, set));
  return set->settings.marks ? olx_mark_unreached(&j->area, space->world->tile_total, set) : OLX_OK;
}

static olx_result judge_tile(olx_world *world, uint32_t tile, const olx_sight *sight, const olx_area_points *points,
                             olx_probe_set *set, tally *t) {
  olx_space space;
  judged j = {0};
  OLX_TRY(olx_space_open(world, tile, world->tile_total > 1 ? OLX_TILE_OVERLAP : 0, set->settings.threads, &space));
  const olx_result result = judge(&space, sight, points, &j, set, t);
  free_judged(&j);
  olx_space_free(&space);
  return result;
}

static double share(uint64_t part, uint64_t all) { return all ? (double)part / (double)all : 0.0; }

static void report_tally(const tally *t, double metres2, olx_probe_set *set) {
  olx_place_report *report = &set->report;
  for (uint32_t i = 0; i < set->count; i++) set->probes[i].gain = (float)share(t->gains[i], t->rays);
  report->surfels = t->rays;
  report->coverage = share(t->covered, t->rays);
  report->visible = share(t->visible, t->rays);
  report->grazing = share(t->grazing, t->rays);
  report->missed = share(t->missed, t->rays);
  report->restricted = share(t->restricted, t->rays);
  report->coverable = 1.0 - report->grazing - report->restricted;
  report->coverage_by_area = share(t->sides_covered, t->sides);
  report->unreachable = share(t->points_unseen, t->points);
  report->reached_m2 = (double)t->sides * metres2;
  report->unreached_m2 = (double)t->sides_cut_off * metres2;
}

static olx_result fail_without_surfaces(void) {
  return olx_fail(OLX_ERROR_EMPTY, "nothing to see: no surface is seen from where probes may stand");
}

static olx_result judge_tiles(olx_world *world, const olx_sight *sight, const olx_area_points *points,
                              olx_probe_set *set) {
  tally t = {.gains = olx_allocate_zero(set->count, sizeof *t.gains)};
  olx_result result = t.gains ? OLX_OK : no_memory();
  for (uint32_t i = 0; result == OLX_OK && i < world->tile_total; i++) {
    result = olx_check_cancelled();
    if (result == OLX_OK) result = judge_tile(world, i, sight, points, set, &t);
  }
  if (result == OLX_OK) report_tally(&t, points->metres2, set);
  if (result == OLX_OK && t.rays == 0) result = fail_without_surfaces();
  olx_release(t.gains);
  return result;
}

olx_result olx_measure_probes(olx_world *world, const olx_sight *sight, olx_probe_set *set) {
  const uint32_t seed = olx_hash(held_out_seed(&set->settings));
  olx_area_points points;
  OLX_TRY(find_buried(world, set));
  OLX_TRY(olx_area_points_create(world, area_count(world, &set->settings), seed, &points));
  const olx_result result = judge_tiles(world, sight, &points, set);
  olx_area_points_free(&points);
  return result;
}

static olx_result judge_coverage(const olx_space *space, const olx_sight *sight, judged *j, olx_probe_set *set,
                                 double *coverage) {
  const olx_place_settings *s = &set->settings;
  OLX_TRY(find_buried(space->world, set));
  OLX_TRY(list_judged(space, set, j));
  OLX_TRY(make_rays(space, sight, s, &j->rays));
  if (j->rays.count == 0) return fail_without_surfaces();
  OLX_TRY(make_room(j));
  OLX_TRY(olx_count_views(space, sight, j->places, j->count, &j->rays, s->views, s->threads, j->views, NULL));
  *coverage = share(count_seen(&j->rays, j->views, s->views), j->rays.count);
  return OLX_OK;
}

olx_result olx_measure_coverage(const olx_space *space, const olx_sight *sight, olx_probe_set *set, double *coverage) {
  judged j = {0};
  const olx_result result = judge_coverage(space, sight, &j, set, coverage);
  free_judged(&j);
  return result;
}
