// Places the probes of a scene: checks the settings, finds the space that matters, runs the chosen method and
// optimizer, and measures the result.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/field_data.h"
#include "place/cost/budget.h"
#include "place/cover/cover.h"
#include "place/cover/measure.h"
#include "place/cover/thin.h"
#include "place/grid.h"
#include "place/marks.h"
#include "place/optimize.h"
#include "place/skeleton/skeleton.h"
#include "place/space/headroom.h"
#include "place/space/space_box.h"
#include "place/space/space_find.h"

#include <octalux/limits.h>
#include <octalux/place.h>

#include <string.h>

#define VOXEL_METRES 0.25f // default size of voxels for space in tiles
// The greatest number of voxels between a floor and what is above it. A door is a third as wide as rooms are high, so
// that it is some voxels wide, and models in units other than metres get voxels in proportion.
#define VOXELS_OVERHEAD 12.0f
#define SMALL_VOXELS 160u // default number of voxels along the longest side of space that is one tile
#define OPTIMIZE_SURFELS 2048u
#define OPTIMIZE_BYTES ((uint64_t)256 << 20) // memory for the fitness of all surfels for all probes

const char *olx_place_method_name(olx_place_method method) {
  switch (method) {
  case OLX_PLACE_GRID: return "grid";
  case OLX_PLACE_SDF: return "sdf";
  case OLX_PLACE_MEDIAL: return "medial";
  case OLX_PLACE_COVER: return "cover";
  }
  return "unknown";
}

const char *olx_place_optimizer_name(olx_place_optimizer optimizer) {
  switch (optimizer) {
  case OLX_OPTIMIZE_NONE: return "none";
  case OLX_OPTIMIZE_GRADIENT: return "gradient";
  case OLX_OPTIMIZE_GIBBS: return "gibbs";
  }
  return "unknown";
}

const char *olx_place_reward_name(olx_place_reward reward) {
  switch (reward) {
  case OLX_REWARD_BEST: return "best";
  case OLX_REWARD_SUM: return "sum";
  }
  return "unknown";
}

const char *olx_probe_origin_name(olx_probe_origin origin) {
  static const char *const names[] = {"pinned", "grid", "skeleton", "space", "target", "moved"};
  return (size_t)origin < sizeof names / sizeof *names ? names[origin] : "unknown";
}

olx_place_settings olx_place_settings_default(const olx_scene *scene) {
  olx_place_settings settings = {.method = OLX_PLACE_COVER,
                                 .views = 1,
                                 .resolution = 512,
                                 .min_cosine = 0.02f,
                                 .max_footprint = 0.05f,
                                 .rounds = 50,
                                 .surfels = 14000,
                                 .candidates = 2000,
                                 .refinements = 8};
  // A grid with the scene's own counts always exists.
  if (scene) (void)olx_scene_probe_grid(scene, NULL, &settings.grid);
  return settings;
}

static bool is_within(uint32_t value, uint32_t low, uint32_t high) { return value >= low && value <= high; }

// A grid of which only a part become candidates may be as large as that of a bake.
static olx_result check_grid(const olx_place_settings *s) {
  const olx_grid *grid = &s->grid;
  const uint32_t most = s->method == OLX_PLACE_GRID ? OLX_PLACE_PROBES_MOST : OLX_BAKE_PROBES_MOST;
  const uint64_t plane = (uint64_t)grid->count[0] * grid->count[1];
  if (plane > 0 && plane <= most && is_within(grid->count[2], 1, (uint32_t)(most / plane)) &&
      olx_is_position(grid->origin) && olx_is_position(olx_grid_position(grid, (uint32_t)plane * grid->count[2] - 1))) {
    return OLX_OK;
  }
  return olx_fail(OLX_ERROR_ARGUMENT, "place: a grid of %u x %u x %u: it must hold 1 to %u probes within 2e7 m",
                  grid->count[0], grid->count[1], grid->count[2], most);
}

static olx_result check_ranges(const olx_place_settings *s) {
  const struct {
    uint32_t value, least, most;
    const char *name;
  } ranges[] = {{s->rounds, OLX_PLACE_ROUNDS_LEAST, OLX_PLACE_ROUNDS_MOST, "rounds"},
                {s->count, 0, OLX_PLACE_PROBES_MOST, "count"},
                {s->views, OLX_PLACE_VIEWS_LEAST, OLX_PLACE_VIEWS_MOST, "views"},
                {s->surfels, OLX_PLACE_SURFELS_LEAST, OLX_PLACE_SURFELS_MOST, "surfels"},
                {s->candidates, OLX_PLACE_CANDIDATES_LEAST, OLX_PLACE_CANDIDATES_MOST, "candidates"},
                {s->refinements, 0, OLX_PLACE_REFINEMENTS_MOST, "refinements"}};
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
    if (is_within(ranges[i].value, ranges[i].least, ranges[i].most)) continue;
    if (!ranges[i].least)
      return olx_fail(OLX_ERROR_ARGUMENT, "place: %s must be at most %u", ranges[i].name, ranges[i].most);
    return olx_fail(OLX_ERROR_ARGUMENT, "place: %s must be %u to %u", ranges[i].name, ranges[i].least, ranges[i].most);
  }
  return OLX_OK;
}

static olx_result check_resolution(uint32_t size) {
  if (is_within(size, OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST) && (size & (size - 1)) == 0) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "place: the resolution must be a power of two from %d to %d",
                  OLX_RADIANCE_SIZE_LEAST, OLX_RADIANCE_SIZE_MOST);
}

static olx_result check_settings(const olx_place_settings *s) {
  const struct {
    bool good;
    const char *what;
  } checks[] = {
      {(uint32_t)s->method <= OLX_PLACE_COVER, "there is no such method"},
      {(uint32_t)s->optimize <= OLX_OPTIMIZE_GIBBS, "there is no such optimizer"},
      {(uint32_t)s->reward <= OLX_REWARD_SUM, "there is no such reward"},
      {s->coverage >= 0.0f && s->coverage <= 1.0f, "coverage must be within 0 to 1"},
      {s->budget_mb >= 0.0 && s->budget_mb < 1e12, "the budget must be a number of megabytes"},
      {s->min_cosine >= 0.0f && s->min_cosine < 1.0f, "min_cosine must be at least 0 and below 1"},
      {s->max_footprint > 0.0f && s->max_footprint <= 1e6f, "max_footprint must be above 0"},
      {s->voxels == 0 || is_within(s->voxels, OLX_PLACE_VOXELS_LEAST, OLX_PLACE_VOXELS_MOST),
       "voxels must be 0, or 8 to 512"},
      {s->voxel_size >= 0.0f && s->voxel_size <= 1e6f, "voxel_size must be within 0 to 1e6 m"},
  };
  for (size_t i = 0; i < sizeof checks / sizeof *checks; i++) {
    if (!checks[i].good) return olx_fail(OLX_ERROR_ARGUMENT, "place: %s", checks[i].what);
  }
  OLX_TRY(check_ranges(s));
  OLX_TRY(check_resolution(s->resolution));
  return check_grid(s);
}

// Converts the budget to a count, except for a grid, which ignores it, and replaces a coverage of 0 by its default.
static olx_result resolve(const olx_world *world, olx_place_settings *s) {
  const uint32_t pinned = world->scene->probe_rules.pinned_count;
  if (s->budget_mb > 0.0 && s->method != OLX_PLACE_GRID) {
    uint32_t count;
    OLX_TRY(olx_budget_count(world, s, &count));
    if (s->count == 0 || count < s->count) s->count = count;
  }
  if (s->coverage <= 0.0f) s->coverage = s->count ? 1.0f : 0.999f;
  if (s->method != OLX_PLACE_GRID && s->count && pinned > s->count) {
    return olx_fail(OLX_ERROR_ARGUMENT, "place: the description pins %u probes, more than the %u that are asked for",
                    pinned, s->count);
  }
  return OLX_OK;
}

static olx_result cover_tile(const olx_space *space, const olx_sight *sight, olx_task *task,
                             const olx_place_settings *settings, olx_candidate **probes, olx_probe_set *set) {
  const olx_probe_rules *rules = &space->scene->probe_rules;
  olx_candidate *pinned = olx_allocate(rules->pinned_count, sizeof *pinned);
  if (!pinned) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  for (uint32_t i = 0; i < rules->pinned_count; i++) pinned[i] = (olx_candidate){rules->pinned[i], OLX_ORIGIN_PINNED};
  olx_cover_result found = {0};
  olx_task_stage(task, "looking from candidates");
  const olx_fixed_probes fixed = {pinned, rules->pinned_count};
  const olx_result result = olx_cover(space, sight, fixed, settings, task, &found);
  *probes = found.probes;
  set->count = found.count;
  set->report.candidates = found.candidates;
  olx_release(pinned);
  return result;
}

static olx_result fail_without_places(const olx_scene *scene) {
  const olx_probe_rules *rules = &scene->probe_rules;
  if (rules->forbidden_count == 0 && rules->min_distance <= 0.0f) {
    return olx_fail(OLX_ERROR_EMPTY,
                    "nowhere to place probes: no free place lies within the scene's bounds; a playable "
                    "box in its description can say where to look");
  }
  return olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: the forbidden boxes and the distance to surfaces that the "
                                   "description asks for leave no place");
}

static olx_result fail_unseen(void) {
  return olx_fail(OLX_ERROR_EMPTY,
                  "nowhere to place probes: from no place is any surface seen well enough, with texels no larger than "
                  "max_footprint and at a cosine of at least min_cosine");
}

static olx_result choose_probes(const olx_space *space, const olx_sight *sight, olx_task *task,
                                olx_place_settings *settings, olx_candidate **probes, olx_probe_set *set) {
  if (settings->method == OLX_PLACE_GRID) {
    return olx_place_grid(space->scene, &settings->grid, probes, &set->count, &set->report.rejected);
  }
  if (space->place_count == 0 && space->scene->probe_rules.pinned_count == 0) return fail_without_places(space->scene);
  olx_place_report *report = &set->report;
  if (settings->method == OLX_PLACE_SDF) {
    return olx_place_sdf(space, settings->count, settings->threads, probes, &set->count, &report->candidates);
  }
  if (settings->method == OLX_PLACE_MEDIAL) {
    return olx_place_medial(space, sight, settings, probes, &set->count, &report->candidates);
  }
  return cover_tile(space, sight, task, settings, probes, set);
}

static olx_result optimize(const olx_space *space, const olx_sight *sight, olx_task *task,
                           const olx_place_settings *settings, olx_candidate *probes, olx_probe_set *set) {
  const uint64_t affordable = OPTIMIZE_BYTES / (sizeof(float) * ((uint64_t)set->count + 1));
  uint32_t points = settings->surfels < OPTIMIZE_SURFELS ? settings->surfels : OPTIMIZE_SURFELS;
  if (affordable < points) points = (uint32_t)affordable;
  olx_surfels surfels;
  OLX_TRY(
      olx_surfels_create(space, sight, OLX_SPREAD_RAYS, points, olx_hash(settings->seed), settings->threads, &surfels));
  olx_optimization outcome = {0};
  olx_task_stage(task, "optimizing");
  olx_result result = olx_surfels_ask(space, sight, NULL, 0, settings->seed, settings->threads, &surfels);
  if (result == OLX_OK) {
    result = olx_optimize(space, &surfels, settings, task, probes, set->count, &outcome);
  }
  olx_surfels_free(&surfels);
  set->report.reward_before = outcome.reward_before;
  set->report.reward_after = outcome.reward_after;
  set->report.rounds = outcome.rounds;
  return result;
}

static olx_result list_probes(const olx_candidate *probes, olx_probe_set *set) {
  set->probes = olx_allocate_zero(set->count, sizeof *set->probes);
  if (!set->probes) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  for (uint32_t i = 0; i < set->count; i++) {
    set->probes[i] = (olx_placed_probe){.position = probes[i].place, .origin = probes[i].origin};
  }
  return OLX_OK;
}

// Measures what the probes cover before they move, by the same rays as afterwards.
static olx_result measure_before(const olx_space *space, const olx_sight *sight, const olx_candidate *probes,
                                 olx_probe_set *set) {
  olx_probe_set before = {.count = set->count, .settings = set->settings};
  olx_result result = list_probes(probes, &before);
  if (result == OLX_OK) result = olx_measure_coverage(space, sight, &before, &set->report.coverage_before);
  olx_probe_set_free(&before);
  return result;
}

static olx_result place_in(const olx_space *space, const olx_sight *sight, olx_task *task, olx_place_settings *settings,
                           olx_probe_set *set) {
  const bool moves = settings->optimize != OLX_OPTIMIZE_NONE;
  olx_candidate *probes = NULL;
  olx_result result;
  OLX_TRY_GOTO(choose_probes(space, sight, task, settings, &probes, set), done);
  if (set->count == 0) OLX_TRY_GOTO(fail_unseen(), done);
  if (moves) OLX_TRY_GOTO(measure_before(space, sight, probes, set), done);
  if (moves) OLX_TRY_GOTO(optimize(space, sight, task, settings, probes, set), done);
  OLX_TRY_GOTO(olx_budget_keep(space->scene, probes, set), done);
  OLX_TRY_GOTO(list_probes(probes, set), done);
  olx_task_stage(task, "measuring coverage");
  OLX_TRY_GOTO(olx_measure_probes(space->world, sight, set), done);
  if (settings->marks) OLX_TRY_GOTO(olx_mark_skeleton(space, sight, set), done);
done:
  olx_release(probes);
  return result;
}

static olx_result cover_tiles(olx_world *world, const olx_sight *sight, olx_task *task, olx_candidate **probes,
                              olx_probe_set *set) {
  const uint32_t limit = set->settings.count ? set->settings.count : OLX_PLACE_PROBES_MOST;
  olx_tiling tiling;
  OLX_TRY(olx_tiling_create(world, sight, &set->settings, &tiling));
  olx_result result = olx_tiling_cover_all(&tiling, task);
  if (result == OLX_OK) result = olx_tiling_join(&tiling, probes, &set->count);
  if (result == OLX_OK) result = olx_tiling_thin(&tiling, limit, *probes, &set->count);
  set->report.candidates = tiling.candidates;
  olx_tiling_free(&tiling);
  return result;
}

static olx_result place_in_tiles(olx_world *world, const olx_sight *sight, olx_task *task, olx_probe_set *set) {
  const olx_place_settings *settings = &set->settings;
  olx_candidate *probes = NULL;
  olx_result result;
  olx_task_stage(task, "covering tiles");
  if (settings->method == OLX_PLACE_GRID) {
    result = olx_place_grid(world->scene, &settings->grid, &probes, &set->count, &set->report.rejected);
  } else {
    result = cover_tiles(world, sight, task, &probes, set);
  }
  if (result == OLX_OK && set->count == 0) {
    result = world->reached_count > 0 ? fail_unseen() : fail_without_places(world->scene);
  }
  if (result == OLX_OK) result = olx_budget_keep(world->scene, probes, set);
  if (result == OLX_OK) result = list_probes(probes, set);
  olx_release(probes);
  OLX_TRY(result);
  olx_task_stage(task, "measuring coverage");
  return olx_measure_probes(world, sight, set);
}

static olx_result place_in_world(olx_world *world, olx_task *task, olx_probe_set *set) {
  olx_place_settings *s = &set->settings;
  const olx_sight sight = olx_sight_create(olx_world_diagonal(world), s->min_cosine, s->max_footprint, s->resolution);
  set->report.space_voxels = world->reached_count;
  set->report.voxel_metres = world->lattice.size;
  set->report.tiles = world->tile_total;
  if (world->tile_total > 1) return place_in_tiles(world, &sight, task, set);
  olx_space space;
  OLX_TRY(olx_space_open(world, 0, 0, s->threads, &space));
  const olx_result result = place_in(&space, &sight, task, s, set);
  olx_space_free(&space);
  return result;
}

// Finds the space that matters: in one tile, or in many where one would make voxels too coarse and the method supports
// tiles.
static olx_result find_space(const olx_scene *scene, const olx_place_settings *s, olx_world *world) {
  olx_box box;
  OLX_TRY(olx_space_box(scene, &box));
  const olx_vec3 extent = olx_sub(box.max, box.min);
  const bool sized = s->voxel_size > 0.0f;
  const float size = sized ? s->voxel_size : olx_max(VOXEL_METRES, olx_headroom(scene) / VOXELS_OVERHEAD),
              along = olx_max3(extent) / size;
  const bool tiled = s->optimize == OLX_OPTIMIZE_NONE && (s->method == OLX_PLACE_COVER || s->method == OLX_PLACE_GRID);
  if (s->voxels) return olx_world_create_small(scene, s->voxels, s->threads, world);
  if (along > (float)SMALL_VOXELS && tiled) return olx_world_create_tiled(scene, size, s->threads, world);
  uint32_t resolution = SMALL_VOXELS;
  if (sized) resolution = (uint32_t)olx_clamp(ceilf(along), 1.0f, (float)OLX_PLACE_VOXELS_MOST);
  return olx_world_create_small(scene, resolution, s->threads, world);
}

static olx_result find_space_and_place(const olx_scene *scene, olx_task *task, olx_probe_set *set) {
  olx_world world;
  OLX_TRY(find_space(scene, &set->settings, &world));
  olx_result result = resolve(&world, &set->settings);
  if (result == OLX_OK) result = place_in_world(&world, task, set);
  olx_world_free(&world);
  return result;
}

olx_result olx_place(const olx_scene *scene, const olx_place_settings *settings, const olx_progress *progress,
                     olx_probe_set *set) {
  const double start = olx_seconds();
  *set = (olx_probe_set){.settings = *settings, .scene_hash = scene->hash};
  memcpy(set->origin, scene->origin, sizeof set->origin);
  OLX_TRY(check_settings(settings));
  // Units of progress: one per candidate of a cover.
  const uint64_t covering = settings->method == OLX_PLACE_COVER ? settings->candidates : 0;
  const uint64_t moving = settings->optimize == OLX_OPTIMIZE_NONE ? 0 : (uint64_t)settings->rounds * OLX_ROUND_UNITS;
  olx_task task;
  olx_task_begin(&task, progress, "finding space", covering + moving);
  olx_result result = find_space_and_place(scene, &task, set);
  // An interrupted search reports its cancellation rather than an empty result.
  if (atomic_load(&task.cancelled)) result = olx_fail(OLX_ERROR_CANCELLED, "cancelled during %s", task.stage);
  olx_task_end(&task);
  if (result != OLX_OK) olx_probe_set_free(set);
  set->report.seconds = olx_seconds() - start;
  return result;
}

void olx_probe_set_free(olx_probe_set *set) {
  olx_release(set->probes);
  olx_release(set->marks);
  set->probes = NULL;
  set->marks = NULL;
  set->count = set->mark_count = 0;
}
