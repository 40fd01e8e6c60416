// Improves a finished cover by exchanging two of its probes for two candidates at once, which finds gains that no
// single move achieves.
#include "place/cover/exchange.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"

#include <string.h>

enum { PAIRS = 32, POLISH = 3, ROWS_A_JOB = 64 };

typedef struct exchanger {
  olx_cover_state *state;
  olx_cover_open open; // columns that the other picks leave open
  olx_cover_open left; // columns of `open` that the other one of the pair leaves open
  uint64_t *weights;   // weight of `left` that each candidate covers
  uint32_t first, second;
} exchanger;

static void weigh_job(void *user, uint32_t index) {
  const exchanger *e = user;
  const olx_cover_state *s = e->state;
  for (uint32_t i = index * ROWS_A_JOB; i < (index + 1) * ROWS_A_JOB && i < s->candidate_count; i++) {
    e->weights[i] = s->unfit[i] ? 0 : olx_cover_candidate_weight(s, &e->left, i);
  }
}

// Finds the open columns that a row does not cover.
static void leave(exchanger *e, const uint8_t *row) {
  e->left.columns.count = e->left.common = 0;
  for (uint32_t k = 0; k < e->open.columns.count; k++) {
    if (row && row[e->open.index[k]] != 0) continue;
    e->left.index[e->left.columns.count++] = e->open.index[k];
    e->left.common += k < e->open.common;
  }
}

static bool keeps_distance(const exchanger *e, uint32_t candidate, const olx_vec3 *other) {
  const olx_cover_state *s = e->state;
  const float least = s->space->scene->probe_rules.min_distance;
  const olx_vec3 place = s->candidates[candidate].place;
  if (least <= 0.0f) return true;
  if (other && olx_length(olx_sub(place, *other)) < least) return false;
  for (uint32_t i = 0; i < s->pick_count; i++) {
    if (i == e->first || i == e->second) continue;
    if (olx_length(olx_sub(place, s->picks[i].place)) < least) return false;
  }
  return true;
}

// Finds the candidate that covers most of what `other` leaves open and keeps its distance from it; candidate_count when
// none covers any.
static olx_result find_best(exchanger *e, uint32_t other, uint32_t *best) {
  olx_cover_state *s = e->state;
  const bool alone = other == s->candidate_count;
  leave(e, alone ? NULL : olx_cover_row(s, other));
  olx_cover_pack(&e->left);
  OLX_TRY(olx_parallel_for((s->candidate_count + ROWS_A_JOB - 1) / ROWS_A_JOB, s->threads, weigh_job, e, NULL, 0));
  const olx_vec3 *beside = alone ? NULL : &s->candidates[other].place;
  for (;;) {
    *best = s->candidate_count;
    for (uint32_t i = 0; i < s->candidate_count; i++) {
      if (e->weights[i] > (*best == s->candidate_count ? 0 : e->weights[*best])) *best = i;
    }
    if (*best == s->candidate_count) return OLX_OK;
    s->unfit[*best] = olx_space_is_inside_geometry(s->space, s->candidates[*best].place);
    if (!s->unfit[*best] && keeps_distance(e, *best, beside)) return OLX_OK;
    e->weights[*best] = 0;
  }
}

static uint64_t pair_weight(exchanger *e, const uint8_t *first, const uint8_t *second) {
  leave(e, NULL);
  const uint64_t weight = olx_cover_open_weight(e->state, &e->left, first);
  leave(e, first);
  return weight + olx_cover_open_weight(e->state, &e->left, second);
}

static void replace(olx_cover_state *s, uint32_t pick, uint32_t candidate) {
  s->picks[pick] = s->candidates[candidate];
  memcpy(olx_cover_pick_row(s, pick), olx_cover_row(s, candidate), s->columns.count);
}

// Exchanges a pair: starts with the best candidate alone and the best beside it, then alternately improves each beside
// the other.
static olx_result exchange_pair(exchanger *e) {
  olx_cover_state *s = e->state;
  const uint32_t none = s->candidate_count;
  olx_cover_set_levels(s, e->first, e->second);
  olx_cover_find_open(s, &e->open);
  const uint64_t now = pair_weight(e, olx_cover_pick_row(s, e->first), olx_cover_pick_row(s, e->second));
  uint32_t one = none, two = none;
  OLX_TRY(find_best(e, none, &one));
  for (int i = 0; i < POLISH && one != none; i++) {
    uint32_t other;
    OLX_TRY(find_best(e, one, &other));
    if (other == none) return OLX_OK;
    if (i > 0 && other == two) break;
    two = one;
    one = other;
  }
  if (one == none || pair_weight(e, olx_cover_row(s, one), olx_cover_row(s, two)) <= now) return OLX_OK;
  replace(s, e->first, one);
  replace(s, e->second, two);
  return OLX_OK;
}

static olx_result exchange_pairs(exchanger *e, uint32_t pinned, uint32_t seed) {
  olx_cover_state *s = e->state;
  const uint32_t movable = s->pick_count - pinned, pairs = movable * (movable - 1) / 2;
  for (uint32_t i = 0; i < PAIRS && i < pairs; i++) {
    const uint32_t a = (uint32_t)(((uint64_t)olx_hash3(seed, i, 0) * movable) >> 32);
    const uint32_t b = (uint32_t)(((uint64_t)olx_hash3(seed, i, 1) * (movable - 1)) >> 32);
    e->first = pinned + a;
    e->second = pinned + (b < a ? b : b + 1);
    OLX_TRY(exchange_pair(e));
  }
  return OLX_OK;
}

olx_result olx_cover_exchange(olx_cover_state *s, uint32_t pinned, uint32_t seed) {
  if (s->views > 1 || s->pick_count < pinned + 2) return OLX_OK;
  exchanger e = {.state = s, .weights = olx_allocate(s->candidate_count, sizeof *e.weights)};
  e.left.index = olx_allocate(s->capacity, sizeof *e.left.index);
  e.left.bits = olx_allocate(s->capacity, sizeof *e.left.bits);
  olx_result result = OLX_ERROR_MEMORY;
  if (e.weights && e.left.index && e.left.bits) result = olx_cover_open_create(s, &e.open);
  else olx_fail(result, "place: out of memory");
  if (result == OLX_OK) result = exchange_pairs(&e, pinned, seed);
  olx_cover_set_levels(s, s->pick_count, s->pick_count);
  olx_cover_open_free(&e.open);
  olx_release(e.left.index);
  olx_release(e.left.bits);
  olx_release(e.weights);
  return result;
}
