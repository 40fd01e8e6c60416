// Moves probes to positions that see more (Wang 2018, section 3.2), by steps towards the best support probe or by Gibbs
// sampling, while the reward over the atlas grows.
#include "place/optimize.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"

#include <string.h>

enum { SUPPORTS = 8, BATCH = 256, MOST_HALVINGS = 4 };

float olx_fitness(const olx_surfel *surfel, olx_vec3 place, float diagonal) {
  const olx_vec3 way = olx_sub(place, surfel->position);
  const float along = olx_dot(way, surfel->normal), length = olx_length(way);
  if (!(along > 0.0f)) return 0.0f;
  return 0.5f * (olx_min(along / length, 1.0f) + olx_min(length / diagonal, 1.0f));
}

// Computes the fitness of every surfel, 0 where something occludes it.
static void fitness_row(const olx_space *space, const olx_surfels *surfels, olx_vec3 place, float *row) {
  const olx_scene *scene = space->scene;
  const float diagonal = olx_length(olx_sub(scene->bounds_max, scene->bounds_min));
  olx_ray rays[BATCH];
  uint32_t who[BATCH], used = 0;
  uint8_t occluded[BATCH];
  for (uint32_t i = 0; i < surfels->count; i++) {
    row[i] = olx_fitness(&surfels->items[i], place, diagonal);
    if (row[i] > 0.0f) {
      rays[used] = (olx_ray){place, olx_sub(surfels->items[i].position, place), 0.0f, 1.0f};
      who[used++] = i;
    }
    if (used < BATCH && i + 1 < surfels->count) continue;
    olx_bvh_occluded_many(scene->bvh, rays, used, true, occluded);
    for (uint32_t k = 0; k < used; k++) {
      if (occluded[k]) row[who[k]] = 0.0f;
    }
    used = 0;
  }
}

typedef struct row_maker {
  const olx_space *space;
  const olx_surfels *surfels;
  const olx_vec3 *places;
  const uint8_t *wanted; // NULL: all
  float *rows;
} row_maker;

static void row_job(void *user, uint32_t index) {
  const row_maker *m = user;
  float *row = m->rows + (size_t)m->surfels->count * index;
  if (!m->wanted || m->wanted[index]) fitness_row(m->space, m->surfels, m->places[index], row);
}

static inline double join(olx_place_reward kind, double others, float own) {
  return kind == OLX_REWARD_SUM ? others + (double)own : others > (double)own ? others : (double)own;
}

// Computes the reward of each surfel from all rows except `without`; with `count` as `without`, from all.
static void join_rows(const float *rows, uint32_t count, uint32_t surfels, uint32_t without, olx_place_reward kind,
                      double *joined) {
  memset(joined, 0, surfels * sizeof *joined);
  for (uint32_t p = 0; p < count; p++) {
    const float *row = rows + (size_t)surfels * p;
    for (uint32_t i = 0; p != without && i < surfels; i++) joined[i] = join(kind, joined[i], row[i]);
  }
}

static double mean(const double *joined, uint32_t count) {
  double sum = 0.0;
  for (uint32_t i = 0; i < count; i++) sum += joined[i];
  return count ? sum / count : 0.0;
}

static double mean_with(olx_place_reward kind, const double *others, const float *row, uint32_t count) {
  double sum = 0.0;
  for (uint32_t i = 0; i < count; i++) sum += join(kind, others[i], row[i]);
  return count ? sum / count : 0.0;
}

olx_result olx_reward(const olx_space *space, const olx_surfels *surfels, const olx_vec3 *places, uint32_t count,
                      olx_place_reward kind, uint32_t threads, double *reward) {
  float *rows = olx_allocate((size_t)surfels->count * count, sizeof *rows);
  double *joined = olx_allocate(surfels->count, sizeof *joined);
  row_maker maker = {.space = space, .surfels = surfels, .places = places, .rows = rows};
  olx_result result = OLX_ERROR_MEMORY;
  if (rows && joined) {
    result = olx_parallel_for(count, threads, row_job, &maker, NULL, 0);
    join_rows(rows, count, surfels->count, count, kind, joined);
    *reward = mean(joined, surfels->count);
  } else {
    olx_fail(result, "place: no memory for the reward of %u probes", count);
  }
  olx_release(rows);
  olx_release(joined);
  return result;
}

static olx_vec3 support_corner(olx_vec3 centre, float half, uint32_t i) {
  return olx_madd(centre, olx_v3(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f), half);
}

olx_vec3 olx_sample_support(olx_vec3 centre, float half, const double fitness[8], const float random[7]) {
  olx_vec3 places[8];
  float values[8];
  for (uint32_t i = 0; i < 8; i++) {
    places[i] = support_corner(centre, half, i);
    values[i] = (float)fitness[i];
  }
  // Each stage keeps one point on each edge between two points of the last stage: four along x, two along y, one along
  // z.
  for (uint32_t left = 4; left > 0; left /= 2, random += 2 * left) {
    for (uint32_t i = 0; i < left; i++) {
      const float x = olx_sample_linear(values[2 * i], values[2 * i + 1], random[i]);
      places[i] = olx_mix3(places[2 * i], places[2 * i + 1], x);
      values[i] = olx_mix(values[2 * i], values[2 * i + 1], x);
    }
  }
  return places[0];
}

typedef struct optimizer {
  const olx_space *space;
  const olx_surfels *surfels;
  const olx_place_settings *settings;
  olx_task *task; // may be NULL
  olx_candidate *probes;
  uint32_t count, free_count;
  float *rows;         // fitness of each surfel, per probe
  float *support_rows; // fitness of each surfel, per support probe: SUPPORTS rows
  double *others;      // reward of each surfel without the probe that moves
  olx_candidate *best; // the best set so far
  uint8_t *halvings;   // per probe: number of halvings of its cube
  uint32_t seen;       // surfels that are seen before the probe moves
  double best_reward;
} optimizer;

// Returns the number of surfels that can be seen well and are seen, by the other probes or by `row`.
static uint32_t count_seen(const optimizer *o, const float *row) {
  uint32_t seen = 0;
  for (uint32_t i = 0; i < o->surfels->count; i++) {
    seen += o->surfels->items[i].fate == OLX_SURFEL_FIT && (o->others[i] > 0.0 || row[i] > 0.0f);
  }
  return seen;
}

static float *row_of(const optimizer *o, uint32_t probe) { return o->rows + (size_t)o->surfels->count * probe; }
static float *support_row(const optimizer *o, uint32_t i) { return o->support_rows + (size_t)o->surfels->count * i; }

static bool keeps_distance(const optimizer *o, olx_vec3 place, uint32_t without) {
  const float least = o->space->scene->probe_rules.min_distance;
  for (uint32_t i = 0; least > 0.0f && i < o->count; i++) {
    if (i != without && olx_length(olx_sub(o->probes[i].place, place)) < least) return false;
  }
  return true;
}

static bool may_stand(const optimizer *o, olx_vec3 place, uint32_t probe) {
  return olx_space_allows(o->space, place) && keeps_distance(o, place, probe);
}

// Returns half the distance to the nearest surface, at least two voxels, halved once for each time that the probe could
// not move.
static float cube_size(const optimizer *o, uint32_t probe) {
  const olx_voxels *v = &o->space->voxels;
  const size_t voxel = olx_voxel_at(v, o->probes[probe].place);
  const float room = voxel == OLX_NO_VOXEL ? 0.0f : olx_voxel_distance(v, voxel);
  return olx_max(isfinite(room) ? 0.5f * room : 0.0f, 2.0f * v->size) / (float)(1u << o->halvings[probe]);
}

// Returns whether a probe may move to a position that sees `row`. As published, it may lose surfels that only it sees;
// with the reward `best` it may not.
static bool keeps_seen(const optimizer *o, const float *row) {
  return o->settings->reward == OLX_REWARD_SUM || count_seen(o, row) >= o->seen;
}

// Computes the rows of the support probes at positions that allow a probe, and the reward of each resulting set; 0
// elsewhere.
static olx_result try_supports(optimizer *o, uint32_t probe, float half, olx_vec3 places[SUPPORTS],
                               double rewards[SUPPORTS]) {
  uint8_t wanted[SUPPORTS];
  for (uint32_t i = 0; i < SUPPORTS; i++) {
    places[i] = support_corner(o->probes[probe].place, half, i);
    wanted[i] = may_stand(o, places[i], probe);
  }
  row_maker maker = {o->space, o->surfels, places, wanted, o->support_rows};
  OLX_TRY(olx_parallel_for(SUPPORTS, o->settings->threads, row_job, &maker, o->task, 0));
  for (uint32_t i = 0; i < SUPPORTS; i++) {
    rewards[i] = wanted[i] ? mean_with(o->settings->reward, o->others, support_row(o, i), o->surfels->count) : 0.0;
  }
  return OLX_OK;
}

static void move_probe(optimizer *o, uint32_t probe, olx_vec3 place, const float *row, double reward) {
  o->probes[probe] = (olx_candidate){place, OLX_ORIGIN_MOVED};
  memcpy(row_of(o, probe), row, o->surfels->count * sizeof *row);
  if (reward <= o->best_reward) return;
  o->best_reward = reward;
  memcpy(o->best, o->probes, o->count * sizeof *o->best);
}

// Moves a probe to its best support probe when that increases the reward; otherwise halves the cube.
static olx_result step_gradient(optimizer *o, uint32_t probe, double now, bool *moved) {
  olx_vec3 places[SUPPORTS];
  double rewards[SUPPORTS];
  if (o->halvings[probe] > MOST_HALVINGS) return OLX_OK;
  *moved = true;
  OLX_TRY(try_supports(o, probe, cube_size(o, probe), places, rewards));
  for (;;) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < SUPPORTS; i++) best = rewards[i] > rewards[best] ? i : best;
    if (!(rewards[best] > now)) break;
    if (keeps_seen(o, support_row(o, best)) && !olx_space_is_inside_geometry(o->space, places[best])) {
      move_probe(o, probe, places[best], support_row(o, best), rewards[best]);
      return OLX_OK;
    }
    rewards[best] = 0.0;
  }
  o->halvings[probe]++;
  return OLX_OK;
}

// Moves a probe to a position drawn by what the support probes add to the others, accepted with the ratio of the
// rewards.
static olx_result step_gibbs(optimizer *o, uint32_t probe, uint32_t round, double now) {
  olx_vec3 places[SUPPORTS];
  double rewards[SUPPORTS];
  float random[SUPPORTS];
  const float half = cube_size(o, probe);
  const double base = mean(o->others, o->surfels->count);
  OLX_TRY(try_supports(o, probe, half, places, rewards));
  for (uint32_t i = 0; i < SUPPORTS; i++) {
    rewards[i] = rewards[i] > base ? rewards[i] - base : 0.0;
    random[i] = olx_unit_float(olx_hash3(olx_hash2(o->settings->seed, round), probe, i));
  }
  const olx_vec3 place = olx_sample_support(o->probes[probe].place, half, rewards, random);
  if (!may_stand(o, place, probe) || olx_space_is_inside_geometry(o->space, place)) return OLX_OK;
  fitness_row(o->space, o->surfels, place, support_row(o, 0));
  if (!keeps_seen(o, support_row(o, 0))) return OLX_OK;
  const double reward = mean_with(o->settings->reward, o->others, support_row(o, 0), o->surfels->count);
  if ((double)random[SUPPORTS - 1] * now < reward) move_probe(o, probe, place, support_row(o, 0), reward);
  return OLX_OK;
}

// Returns whether every surfel that can be seen well is seen at all.
static bool covers_everything(optimizer *o) {
  join_rows(o->rows, o->count, o->surfels->count, o->count, OLX_REWARD_BEST, o->others);
  for (uint32_t i = 0; i < o->surfels->count; i++) {
    if (o->surfels->items[i].fate == OLX_SURFEL_FIT && o->others[i] <= 0.0) return false;
  }
  return true;
}

static olx_result run_round(optimizer *o, uint32_t round, bool *moved) {
  const uint32_t surfels = o->surfels->count;
  for (uint32_t probe = 0; probe < o->count; probe++) {
    if (o->probes[probe].origin == OLX_ORIGIN_PINNED) continue;
    join_rows(o->rows, o->count, surfels, probe, o->settings->reward, o->others);
    const double now = mean_with(o->settings->reward, o->others, row_of(o, probe), surfels);
    o->seen = count_seen(o, row_of(o, probe));
    if (o->settings->optimize == OLX_OPTIMIZE_GRADIENT) {
      OLX_TRY(step_gradient(o, probe, now, moved));
    } else {
      OLX_TRY(step_gibbs(o, probe, round, now));
      *moved = true;
    }
  }
  return OLX_OK;
}

static olx_result run(optimizer *o, const olx_vec3 *places, olx_optimization *outcome) {
  const uint32_t surfels = o->surfels->count;
  row_maker maker = {.space = o->space, .surfels = o->surfels, .places = places, .rows = o->rows};
  OLX_TRY(olx_parallel_for(o->count, o->settings->threads, row_job, &maker, NULL, 0));
  join_rows(o->rows, o->count, surfels, o->count, o->settings->reward, o->others);
  outcome->reward_before = o->best_reward = mean(o->others, surfels);
  memcpy(o->best, o->probes, o->count * sizeof *o->best);
  bool moved = o->free_count > 0, covered = covers_everything(o);
  while (moved && !covered && outcome->rounds < o->settings->rounds) {
    moved = false;
    OLX_TRY(run_round(o, outcome->rounds++, &moved));
    if (o->task) olx_task_advance(o->task, OLX_ROUND_UNITS);
    covered = covers_everything(o);
  }
  // A set that covers everything ends the search, unless its reward is less than the first one's.
  join_rows(o->rows, o->count, surfels, o->count, o->settings->reward, o->others);
  const double last = mean(o->others, surfels);
  const bool keep_last = covered && last >= outcome->reward_before;
  outcome->reward_after = keep_last ? last : o->best_reward;
  if (!keep_last) memcpy(o->probes, o->best, o->count * sizeof *o->best);
  return OLX_OK;
}

olx_result olx_optimize(const olx_space *space, const olx_surfels *surfels, const olx_place_settings *settings,
                        olx_task *task, olx_candidate *probes, uint32_t count, olx_optimization *outcome) {
  *outcome = (olx_optimization){0};
  optimizer o = {
      .space = space, .surfels = surfels, .settings = settings, .task = task, .probes = probes, .count = count};
  for (uint32_t i = 0; i < count; i++) o.free_count += probes[i].origin != OLX_ORIGIN_PINNED;
  o.rows = olx_allocate((size_t)surfels->count * count, sizeof *o.rows);
  o.support_rows = olx_allocate((size_t)surfels->count * SUPPORTS, sizeof *o.support_rows);
  o.others = olx_allocate(surfels->count, sizeof *o.others);
  o.best = olx_allocate(count, sizeof *o.best);
  o.halvings = olx_allocate_zero(count, 1);
  olx_vec3 *places = olx_allocate(count, sizeof *places);
  olx_result result = OLX_ERROR_MEMORY;
  if (o.rows && o.support_rows && o.others && o.best && o.halvings && places) {
    for (uint32_t i = 0; i < count; i++) places[i] = probes[i].place;
    result = run(&o, places, outcome);
  } else {
    olx_fail(result, "place: no memory to optimize %u probes", count);
  }
  olx_release(o.rows);
  olx_release(o.support_rows);
  olx_release(o.others);
  olx_release(o.best);
  olx_release(o.halvings);
  olx_release(places);
  return result;
}
