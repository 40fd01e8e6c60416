// Chooses probes that cover what can be seen: a greedy weighted set cover over surfels, then moves and swaps, with
// denser samples of surfels as the uncovered share shrinks.
#include "place/cover/cover.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/cover/cover_state.h"
#include "place/cover/exchange.h"

#include <string.h>

// Below this share of uncovered surface, a denser sample is drawn to find what is missing.
#define SPARSE_UNCOVERED 0.05
// Coverage up to which the first greedy cover uses the common columns alone.
#define FIRST_COVERAGE 0.985
// Another sample decides whether the target is met. A cover therefore aims this many standard deviations of a dense
// sample's estimate above the target, and is finished when the sample shows this many, bounded below by a share of what
// may stay uncovered.
#define AIM_DEVIATIONS 2.2
#define DONE_DEVIATIONS 1.3
#define LEAST_AIM 0.3
#define MATRIX_BYTES ((uint64_t)256 << 20)

enum {
  PILOT_POINTS = 4096,
  RARE_COLUMNS = 8192,
  TARGETS = 96,      // most uncovered surfels per round for which positions are sought
  TARGET_PLACES = 2, // positions kept for each such surfel
  TARGET_TRIES = 8,  // positions tried for each such surfel
  DENSER = 8,        // size of the sample that finds what is missing, relative to the common columns
  MOVES = 10,        // positions tried around a probe
  MOST_ROUNDS = 20,
  LEAST_STEP = 8, // probes that a round may add before another dense sample is drawn, or a quarter of those placed so
                  // far
  REFINED_PROBES = 512 // bound on probes times rounds of moves
};

typedef struct cover {
  const olx_space *space;
  const olx_sight *sight;
  const olx_place_settings *settings;
  olx_fixed_probes fixed;
  olx_task *task;
  olx_cover_state state;
  uint32_t atlas_size, considered, limit; // limit of the number of probes
  double target;                          // target share of the surfels that can be covered
} cover;

// Spreads surfels so that about `wanted` of them are visible, estimated from the visible share of a small first sample.
static olx_result sample_seen(const cover *c, uint32_t wanted, uint32_t seed, olx_surfels *surfels) {
  const uint32_t threads = c->settings->threads;
  OLX_TRY(olx_surfels_create(c->space, c->sight, OLX_SPREAD_RAYS, PILOT_POINTS, seed, threads, surfels));
  const double share = (double)surfels->count / PILOT_POINTS;
  olx_surfels_free(surfels);
  const double points = share > 1.0 / 32.0 ? wanted / share : 32.0 * wanted;
  return olx_surfels_create(c->space, c->sight, OLX_SPREAD_RAYS, (uint32_t)(points < 64.0 ? 64.0 : points),
                            olx_hash(seed), threads, surfels);
}

// A max-heap of candidates by gain. Entries may be stale, because gains only fall while probes are added.
typedef struct heap {
  uint64_t *gains;
  uint32_t *order, count;
} heap;

static bool before(const heap *h, uint32_t a, uint32_t b) {
  return h->gains[a] != h->gains[b] ? h->gains[a] > h->gains[b] : a < b;
}

static void sift_down(heap *h, uint32_t at) {
  for (;;) {
    uint32_t best = at;
    for (uint32_t child = 2 * at + 1; child <= 2 * at + 2 && child < h->count; child++) {
      if (before(h, h->order[child], h->order[best])) best = child;
    }
    if (best == at) return;
    const uint32_t swapped = h->order[at];
    h->order[at] = h->order[best];
    h->order[best] = swapped;
    at = best;
  }
}

static olx_result heap_create(const cover *c, heap *h) {
  const uint32_t count = c->state.candidate_count;
  olx_gain *gains = olx_allocate(count, sizeof *gains);
  *h = (heap){.gains = olx_allocate(count, sizeof *h->gains), .order = olx_allocate(count, sizeof *h->order)};
  olx_result result = OLX_ERROR_MEMORY;
  if (gains && h->gains && h->order) result = olx_cover_gains(&c->state, gains);
  else olx_fail(result, "place: out of memory");
  for (uint32_t i = 0; result == OLX_OK && i < count; i++) {
    h->gains[i] = olx_gain_value(gains[i]);
    h->order[h->count++] = i;
  }
  for (uint32_t i = h->count / 2; i-- > 0;) sift_down(h, i);
  olx_release(gains);
  return result;
}

static void heap_free(heap *h) {
  olx_release(h->gains);
  olx_release(h->order);
}

static double uncovered_share(const cover *c) {
  const uint64_t all = c->state.common_weight * c->state.common;
  return all ? (double)olx_cover_uncovered(&c->state) / (double)all : 0.0;
}

// Returns the value of a candidate beside the picks. Where coverage determines the number of probes, a candidate that
// covers nothing more has no value.
static uint64_t worth(const cover *c, uint32_t candidate, double allowed) {
  if (c->state.unfit[candidate]) return 0;
  const olx_gain gain = olx_cover_gain(&c->state, olx_cover_row(&c->state, candidate));
  return allowed >= 0.0 && gain.covered == 0 ? 0 : olx_gain_value(gain);
}

// Adds the best candidate repeatedly, until there are `limit` probes, at most `allowed` of the surface is uncovered, or
// no candidate has value. *exhausted, which may be NULL, becomes true in the last case.
static olx_result add_greedily(cover *c, uint32_t limit, double allowed, bool *exhausted) {
  olx_cover_state *s = &c->state;
  heap h;
  olx_result result = heap_create(c, &h);
  while (result == OLX_OK && h.count > 0 && s->pick_count < limit && uncovered_share(c) > allowed) {
    OLX_TRY_GOTO(olx_check_cancelled(), done);
    const uint32_t best = h.order[0];
    const uint64_t gain = worth(c, best, allowed);
    if (gain < h.gains[best]) {
      h.gains[best] = gain;
      sift_down(&h, 0);
      continue;
    }
    if (gain == 0) {
      if (exhausted) *exhausted = true;
      break;
    }
    s->unfit[best] = !olx_cover_keeps_distance(s, s->candidates[best].place, s->pick_count) ||
                     olx_space_is_inside_geometry(c->space, s->candidates[best].place);
    if (s->unfit[best]) continue;
    result = olx_cover_pick(s, s->candidates[best], olx_cover_row(s, best));
  }
done:
  heap_free(&h);
  return result;
}

// Proposes positions around a probe, closer in later rounds.
static uint32_t propose_moves(const cover *c, uint32_t pick, uint32_t round, olx_candidate *moves) {
  const olx_vec3 from = c->state.picks[pick].place;
  const size_t voxel = olx_voxel_at(&c->space->voxels, from);
  const float room = voxel == OLX_NO_VOXEL ? 0.0f : olx_voxel_distance(&c->space->voxels, voxel);
  const float reach = olx_max(isfinite(room) ? room : 0.0f, 4.0f * c->space->voxels.size) / (float)(1u << (round & 3u));
  uint32_t count = 0;
  for (uint32_t i = 0; i < MOVES; i++) {
    const uint32_t key = olx_hash3(c->settings->seed + 0x5EEDu * round, pick, i);
    const olx_vec2 random = {olx_unit_float(olx_hash(key)), olx_unit_float(olx_hash(key + 1u))};
    const float length = reach * (0.25f + olx_unit_float(olx_hash(key + 2u)));
    const olx_vec3 place = olx_madd(from, olx_sample_sphere(random), length);
    if (!olx_space_allows(c->space, place) || !olx_cover_keeps_distance(&c->state, place, pick)) continue;
    moves[count++] = (olx_candidate){place, OLX_ORIGIN_MOVED};
  }
  return count;
}

typedef struct refiner {
  const olx_cover_state *state;
  olx_cover_open open;
  uint64_t least; // weight that another position must cover
  olx_gain *gains;
  olx_candidate moves[MOVES];
  olx_gain move_gains[MOVES];
  uint8_t *move_rows;
} refiner;

static uint8_t *move_row(const refiner *r, uint32_t i) { return r->move_rows + (size_t)r->state->capacity * i; }

static void look_job(void *user, uint32_t index) {
  refiner *r = user;
  r->move_gains[index] = olx_cover_look(r->state, &r->open, r->moves[index].place, r->least, move_row(r, index));
}

// Moves a probe to the candidate or nearby position that adds most to the coverage of the others. It stays unless the
// new position covers no less.
static olx_result refine_probe(cover *c, refiner *r, uint32_t pick, uint32_t round) {
  olx_cover_state *s = &c->state;
  olx_cover_set_levels(s, pick, pick);
  olx_cover_find_open(s, &r->open);
  const olx_gain now = olx_cover_gain(s, olx_cover_pick_row(s, pick));
  olx_gain best = now;
  olx_candidate probe = s->picks[pick];
  const uint8_t *row = NULL;
  const uint32_t moves = propose_moves(c, pick, round, r->moves);
  r->least = now.covered;
  OLX_TRY(olx_cover_gains_from(s, &r->open, r->least, r->gains));
  OLX_TRY(olx_parallel_for(moves, s->threads, look_job, r, NULL, 0));
  for (uint32_t i = 0; i < s->candidate_count + moves; i++) {
    const bool move = i >= s->candidate_count;
    const uint32_t nth = move ? i - s->candidate_count : i;
    const olx_gain gain = move ? r->move_gains[nth] : r->gains[nth];
    if (gain.covered < now.covered || olx_gain_value(gain) <= olx_gain_value(best)) continue;
    const olx_candidate *there = move ? &r->moves[nth] : &s->candidates[nth];
    if (!olx_cover_keeps_distance(s, there->place, pick) || olx_space_is_inside_geometry(c->space, there->place))
      continue;
    best = gain;
    probe = *there;
    row = move ? move_row(r, nth) : olx_cover_row(s, nth);
  }
  if (!row) return OLX_OK;
  s->picks[pick] = probe;
  memcpy(olx_cover_pick_row(s, pick), row, s->columns.count);
  return OLX_OK;
}

static olx_result refine(cover *c, uint32_t round, uint32_t fixed) {
  olx_cover_state *s = &c->state;
  refiner r = {.state = s,
               .gains = olx_allocate(s->candidate_count, sizeof *r.gains),
               .move_rows = olx_allocate((size_t)s->capacity * MOVES, 1)};
  olx_result result = OLX_ERROR_MEMORY;
  if (r.gains && r.move_rows) result = olx_cover_open_create(s, &r.open);
  else olx_fail(result, "place: out of memory");
  for (uint32_t i = fixed; result == OLX_OK && i < s->pick_count; i++) result = refine_probe(c, &r, i, round);
  olx_cover_set_levels(s, s->pick_count, s->pick_count);
  olx_cover_open_free(&r.open);
  olx_release(r.gains);
  olx_release(r.move_rows);
  return result;
}

// Adds positions that see surfels which no probe covers.
static olx_result add_targets(cover *c, const olx_surfels *sample, const uint8_t *views, uint32_t seed) {
  olx_candidate *list = olx_allocate(TARGETS * TARGET_PLACES, sizeof *list);
  if (!list) return olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  uint32_t lacking = 0, nth = 0, targets = 0, count = 0;
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < sample->count; i++) lacking += views[i] < c->state.views;
  for (uint32_t i = 0; i < sample->count && result == OLX_OK; i++) {
    if (views[i] >= c->state.views || (uint64_t)nth++ * TARGETS < (uint64_t)targets * lacking) continue;
    olx_vec3 places[TARGET_TRIES];
    const uint32_t found =
        olx_surfel_vantages(c->space, c->sight, &sample->items[i], olx_hash2(seed, i), TARGET_TRIES, places);
    for (uint32_t k = 0, kept = 0; k < found && kept < TARGET_PLACES && targets < TARGETS; k++) {
      if (olx_space_is_inside_geometry(c->space, places[k])) continue;
      list[count++] = (olx_candidate){places[k], OLX_ORIGIN_TARGET};
      kept++;
    }
    targets++;
    result = olx_check_cancelled();
  }
  c->considered += count;
  if (result == OLX_OK) result = olx_cover_add_candidates(&c->state, list, count, NULL);
  olx_release(list);
  return result;
}

// Adds the uncovered part of a denser sample. *covered is the sample's share of what can be covered.
static olx_result look_closer(cover *c, uint32_t seed, double *covered) {
  olx_surfels sample;
  olx_cover_state *s = &c->state;
  OLX_TRY(sample_seen(c, c->atlas_size * DENSER, seed, &sample));
  uint8_t *views = olx_allocate(sample.count, 1);
  olx_vec3 *places = olx_allocate(s->pick_count, sizeof *places);
  olx_result result = OLX_ERROR_MEMORY;
  if (views && places) {
    for (uint32_t i = 0; i < s->pick_count; i++) places[i] = s->picks[i].place;
    result = olx_count_views(c->space, c->sight, places, s->pick_count, &sample, s->views, s->threads, views, NULL);
  } else {
    olx_fail(result, "place: out of memory");
  }
  if (result == OLX_OK) result = olx_surfels_ask(c->space, c->sight, views, s->views, seed, s->threads, &sample);
  uint32_t fit = 0, seen = 0;
  for (uint32_t i = 0; result == OLX_OK && i < sample.count; i++) {
    fit += sample.items[i].fate == OLX_SURFEL_FIT;
    seen += views[i] >= s->views;
  }
  *covered = fit ? (double)seen / fit : 1.0;
  if (result == OLX_OK) result = olx_cover_renew(s, &sample, views);
  if (result == OLX_OK) result = add_targets(c, &sample, views, seed);
  olx_release(views);
  olx_release(places);
  olx_surfels_free(&sample);
  return result;
}

static olx_result pick_fixed(cover *c) {
  olx_cover_state *s = &c->state;
  uint8_t *row = olx_allocate(s->columns.count, 1);
  olx_result result = row ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "place: out of memory");
  for (uint32_t i = 0; result == OLX_OK && i < c->fixed.count; i++) {
    OLX_TRY_GOTO(olx_check_cancelled(), done);
    olx_sight_row(c->space, c->sight, c->fixed.items[i].place, &s->columns, row);
    result = olx_cover_pick(s, c->fixed.items[i], row);
  }
done:
  olx_release(row);
  return result;
}

// Returns the weight that may stay uncovered so that another sample also meets the target.
static double with_margin(const cover *c, double deviations) {
  const double allowed = 1.0 - c->target, deviation = sqrt(allowed / ((double)c->atlas_size * DENSER));
  const double least = LEAST_AIM * allowed, aim = allowed - deviations * deviation;
  return aim > least ? aim : least;
}

// Limits the probes of a round when coverage determines their number: otherwise each of a sample's last surfels would
// get a probe of its own.
static uint32_t next_limit(const cover *c, double allowed) {
  const uint32_t now = c->state.pick_count, step = now / 4 > LEAST_STEP ? now / 4 : LEAST_STEP;
  return allowed < 0.0 || c->limit - now < step ? c->limit : now + step;
}

static olx_result choose(cover *c) {
  const uint32_t fixed = c->fixed.count;
  // With a requested count, probes that only improve quality are added once nothing is left to cover.
  const double allowed = c->settings->count && c->target >= 1.0 ? -1.0 : with_margin(c, AIM_DEVIATIONS);
  OLX_TRY(pick_fixed(c));
  bool exhausted = false;
  OLX_TRY(add_greedily(c, c->limit, 1.0 - FIRST_COVERAGE > allowed ? 1.0 - FIRST_COVERAGE : allowed, &exhausted));
  uint32_t refined = 0;
  for (uint32_t round = 0; round < MOST_ROUNDS; round++) {
    const bool full = c->state.pick_count >= c->limit;
    if (full && round >= c->settings->refinements) break;
    if (exhausted || uncovered_share(c) < SPARSE_UNCOVERED) {
      double covered;
      OLX_TRY(look_closer(c, olx_hash2(c->settings->seed, 100u + round), &covered));
      if (!full && allowed >= 0.0 && 1.0 - covered <= with_margin(c, DONE_DEVIATIONS)) break;
    }
    exhausted = false;
    OLX_TRY(add_greedily(c, next_limit(c, allowed), allowed, &exhausted));
    if (c->state.pick_count == 0) break; // nothing is seen well, and further rounds would not change that
    refined += c->state.pick_count - fixed;
    if (round >= c->settings->refinements || refined > REFINED_PROBES) continue;
    OLX_TRY(olx_cover_exchange(&c->state, fixed, olx_hash2(c->settings->seed, 200u + round)));
    OLX_TRY(refine(c, round, fixed));
  }
  return OLX_OK;
}

static olx_result prepare(cover *c) {
  const olx_place_settings *settings = c->settings;
  // Adds the fixed probes and the positions found for uncovered surfels to the candidates.
  const uint32_t most = settings->candidates + MOST_ROUNDS * TARGETS * TARGET_PLACES;
  const uint64_t affordable = MATRIX_BYTES / most;
  c->atlas_size = settings->surfels < affordable ? settings->surfels : (uint32_t)affordable;
  olx_surfels atlas;
  OLX_TRY(sample_seen(c, c->atlas_size, settings->seed, &atlas));
  olx_result result = olx_surfels_ask(c->space, c->sight, NULL, 0, settings->seed, settings->threads, &atlas);
  if (result == OLX_OK && atlas.count == 0) {
    result = olx_fail(OLX_ERROR_EMPTY, "nothing to see: no surface is seen from where probes may stand");
  }
  if (result == OLX_OK) {
    result = olx_cover_state_create(c->space, c->sight, &atlas, RARE_COLUMNS, most, settings->views, settings->threads,
                                    &c->state);
  }
  olx_surfels_free(&atlas);
  return result;
}

olx_result olx_cover(const olx_space *space, const olx_sight *sight, olx_fixed_probes fixed,
                     const olx_place_settings *settings, olx_task *task, olx_cover_result *found) {
  cover c = {.space = space, .sight = sight, .settings = settings, .fixed = fixed, .task = task};
  c.limit = settings->count ? settings->count : 65536;
  c.target = (double)settings->coverage;
  *found = (olx_cover_result){0};
  olx_candidate *candidates = NULL;
  olx_result result;
  OLX_TRY_GOTO(prepare(&c), done);
  OLX_TRY_GOTO(
      olx_candidates_create(space, &settings->grid, settings->candidates, settings->seed, &candidates, &c.considered),
      done);
  OLX_TRY_GOTO(olx_cover_add_candidates(&c.state, candidates, c.considered, task), done);
  OLX_TRY_GOTO(choose(&c), done);
  found->probes = c.state.picks;
  found->count = c.state.pick_count;
  found->candidates = c.considered;
  c.state.picks = NULL;
done:
  olx_release(candidates);
  olx_cover_state_free(&c.state);
  return result;
}
