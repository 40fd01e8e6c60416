// Maintains the matrix of candidates by surfels from which a cover is chosen, the levels at which surfels are covered
// so far, and the gain of every candidate, counted in parallel.
#include "place/cover/cover_state.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/widest.h"

#include <string.h>

// The weight of a common column; a rare column has a share of this weight.
#define COMMON_WEIGHT 64u
enum { ROWS_A_JOB = 16, PIECE = 240 };

static olx_result no_memory(void) { return olx_fail(OLX_ERROR_MEMORY, "place: no memory for the visibility atlas"); }

static void settle_hopeless(olx_cover_state *s, uint32_t first) {
  for (uint32_t i = first; i < s->columns.count; i++) {
    s->settled[i] = s->columns.items[i].fate == OLX_SURFEL_FIT ? 0 : 255;
  }
}

olx_result olx_cover_state_create(const olx_space *space, const olx_sight *sight, olx_surfels *atlas, uint32_t rare,
                                  uint32_t candidates, uint32_t views, uint32_t threads, olx_cover_state *s) {
  *s = (olx_cover_state){.space = space, .sight = sight, .threads = threads, .views = views};
  s->capacity = atlas->count + rare;
  s->common = s->columns.count = atlas->count;
  s->columns.share = atlas->share;
  s->common_weight = COMMON_WEIGHT;
  s->candidate_capacity = candidates;
  s->columns.items = olx_allocate(s->capacity, sizeof *s->columns.items);
  s->settled = olx_allocate_zero(s->capacity, 1);
  s->levels = olx_allocate_zero((size_t)s->capacity * views, 1);
  s->candidates = olx_allocate(candidates, sizeof *s->candidates);
  s->unfit = olx_allocate_zero(candidates, 1);
  s->rows = olx_allocate((size_t)s->capacity * candidates, 1);
  s->seen = olx_allocate_zero((size_t)olx_cover_words(s) * candidates, sizeof *s->seen);
  if (!s->columns.items || !s->settled || !s->levels || !s->candidates || !s->unfit || !s->rows || !s->seen) {
    olx_cover_state_free(s);
    return no_memory();
  }
  memcpy(s->columns.items, atlas->items, atlas->count * sizeof *atlas->items);
  olx_surfels_free(atlas);
  settle_hopeless(s, 0);
  return OLX_OK;
}

void olx_cover_state_free(olx_cover_state *s) {
  olx_surfels_free(&s->columns);
  olx_release(s->settled);
  olx_release(s->levels);
  olx_release(s->candidates);
  olx_release(s->unfit);
  olx_release(s->rows);
  olx_release(s->seen);
  olx_release(s->picks);
  olx_release(s->pick_rows);
  *s = (olx_cover_state){0};
}

// Fills columns [first, count) for candidates and then picks.
typedef struct column_job {
  const olx_cover_state *state;
  olx_surfels part;
  uint32_t first_column, first_candidate, candidates;
} column_job;

// Sets the bits of a candidate's columns from `first` on.
static void note_seen(const olx_cover_state *s, uint32_t candidate, uint32_t first) {
  const uint8_t *row = olx_cover_row(s, candidate);
  uint64_t *seen = s->seen + (size_t)olx_cover_words(s) * candidate;
  for (uint32_t i = first; i < s->columns.count; i++) seen[i / 64] |= (uint64_t)(row[i] != 0) << i % 64;
}

static void see_job(void *user, uint32_t index) {
  const column_job *job = user;
  const olx_cover_state *s = job->state;
  const bool pick = index >= job->candidates;
  const uint32_t i = pick ? index - job->candidates : job->first_candidate + index;
  uint8_t *row = pick ? olx_cover_pick_row(s, i) : olx_cover_row(s, i);
  olx_sight_row(s->space, s->sight, pick ? s->picks[i].place : s->candidates[i].place, &job->part,
                row + job->first_column);
  if (!pick) note_seen(s, i, job->first_column);
}

olx_result olx_cover_add_candidates(olx_cover_state *s, const olx_candidate *list, uint32_t count, olx_task *task) {
  const uint32_t room = s->candidate_capacity - s->candidate_count, first = s->candidate_count;
  const uint32_t added = count < room ? count : room;
  memcpy(s->candidates + first, list, added * sizeof *list);
  s->candidate_count += added;
  column_job job = {.state = s, .part = s->columns, .first_candidate = first, .candidates = added};
  return olx_parallel_for(added, s->threads, see_job, &job, task, 1);
}

olx_result olx_cover_renew(olx_cover_state *s, const olx_surfels *sample, const uint8_t *views) {
  olx_cover_set_levels(s, s->pick_count, s->pick_count);
  const uint8_t *least = s->levels + (size_t)s->capacity * (s->views - 1);
  for (uint32_t i = 0; i < s->columns.count; i++) {
    if (least[i] == 0) s->settled[i] = 255;
  }
  column_job job = {.state = s, .first_column = s->columns.count, .candidates = s->candidate_count};
  uint32_t lacking = 0, taken = 0;
  const uint32_t room = s->capacity - s->columns.count;
  for (uint32_t i = 0; i < sample->count; i++) {
    lacking += views[i] < s->views && sample->items[i].fate == OLX_SURFEL_FIT;
  }
  // Where there is no room for all, an evenly spaced subset is kept, each with a larger weight.
  const uint32_t kept = lacking < room ? lacking : room;
  for (uint32_t i = 0, nth = 0; i < sample->count && taken < kept; i++) {
    if (views[i] >= s->views || sample->items[i].fate != OLX_SURFEL_FIT) continue;
    if ((uint64_t)nth++ * kept / lacking < taken) continue;
    s->columns.items[s->columns.count++] = sample->items[i];
    taken++;
  }
  const double share = sample->share * (kept ? (double)lacking / kept : 1.0);
  s->rare_weight = (uint64_t)(COMMON_WEIGHT * share / s->columns.share + 0.5);
  if (s->rare_weight == 0) s->rare_weight = 1;
  settle_hopeless(s, job.first_column);
  job.part = (olx_surfels){.count = s->columns.count - job.first_column, .items = s->columns.items + job.first_column};
  return olx_parallel_for(job.candidates + s->pick_count, s->threads, see_job, &job, NULL, 0);
}

static olx_result make_room_for_pick(olx_cover_state *s) {
  if (s->pick_count < s->pick_capacity) return OLX_OK;
  const uint32_t capacity = s->pick_capacity ? 2 * s->pick_capacity : 32;
  olx_candidate *picks = olx_allocate(capacity, sizeof *picks);
  uint8_t *rows = olx_allocate((size_t)s->capacity * capacity, 1);
  if (!picks || !rows) {
    olx_release(picks);
    olx_release(rows);
    return no_memory();
  }
  if (s->pick_count) {
    memcpy(picks, s->picks, s->pick_count * sizeof *picks);
    memcpy(rows, s->pick_rows, (size_t)s->capacity * s->pick_count);
  }
  olx_release(s->picks);
  olx_release(s->pick_rows);
  s->picks = picks;
  s->pick_rows = rows;
  s->pick_capacity = capacity;
  return OLX_OK;
}

// Inserts a row into the levels: each value pushes down the value that it displaces.
static void raise_levels(olx_cover_state *s, const uint8_t *row) {
  for (uint32_t i = 0; i < s->columns.count; i++) {
    uint8_t q = row[i];
    for (uint32_t v = 0; v < s->views && q; v++) {
      uint8_t *level = &s->levels[(size_t)s->capacity * v + i];
      const uint8_t before = *level;
      if (q <= before) continue;
      *level = q;
      q = before;
    }
  }
}

olx_result olx_cover_pick(olx_cover_state *s, olx_candidate probe, const uint8_t *row) {
  OLX_TRY(make_room_for_pick(s));
  s->picks[s->pick_count] = probe;
  memcpy(olx_cover_pick_row(s, s->pick_count), row, s->columns.count);
  raise_levels(s, row);
  s->pick_count++;
  return OLX_OK;
}

void olx_cover_set_levels(olx_cover_state *s, uint32_t without, uint32_t without_too) {
  for (uint32_t v = 0; v < s->views; v++) memcpy(s->levels + (size_t)s->capacity * v, s->settled, s->columns.count);
  for (uint32_t i = 0; i < s->pick_count; i++) {
    if (i != without && i != without_too) raise_levels(s, olx_cover_pick_row(s, i));
  }
}

// Adds gains in blocks whose sums fit narrow integers, of which a vector register holds many.
static void add_gain(const uint8_t *row, const uint8_t *level, uint32_t count, uint64_t weight, olx_gain *gain) {
  uint64_t covered = 0, quality = 0;
  for (uint32_t first = 0; first < count; first += PIECE) {
    const uint32_t left = count - first, end = first + (left < PIECE ? left : PIECE);
    uint16_t better = 0;
    uint8_t first_seen = 0;
    for (uint32_t i = first; i < end; i++) {
      const uint8_t highest = row[i] > level[i] ? row[i] : level[i];
      better = (uint16_t)(better + (uint8_t)(highest - level[i]));
      first_seen = (uint8_t)(first_seen + ((row[i] != 0) & (level[i] == 0)));
    }
    covered += first_seen;
    quality += better;
  }
  gain->covered += weight * covered;
  gain->quality += weight * quality;
}

olx_gain olx_cover_gain(const olx_cover_state *s, const uint8_t *row) {
  const uint8_t *least = s->levels + (size_t)s->capacity * (s->views - 1);
  olx_gain gain = {0};
  add_gain(row, least, s->common, s->common_weight, &gain);
  add_gain(row + s->common, least + s->common, s->columns.count - s->common, s->rare_weight, &gain);
  return gain;
}

typedef struct gain_job {
  const olx_cover_state *state;
  olx_gain *gains;
} gain_job;

static void gains_job(void *user, uint32_t index) {
  const gain_job *job = user;
  const uint32_t first = index * ROWS_A_JOB;
  for (uint32_t i = first; i < first + ROWS_A_JOB && i < job->state->candidate_count; i++) {
    job->gains[i] = job->state->unfit[i] ? (olx_gain){0} : olx_cover_gain(job->state, olx_cover_row(job->state, i));
  }
}

olx_result olx_cover_gains(const olx_cover_state *s, olx_gain *gains) {
  gain_job job = {s, gains};
  return olx_parallel_for((s->candidate_count + ROWS_A_JOB - 1) / ROWS_A_JOB, s->threads, gains_job, &job, NULL, 0);
}

olx_result olx_cover_open_create(const olx_cover_state *s, olx_cover_open *open) {
  *open = (olx_cover_open){.columns = {.items = olx_allocate(s->capacity, sizeof *open->columns.items)},
                           .index = olx_allocate(s->capacity, sizeof *open->index),
                           .bits = olx_allocate(s->capacity, sizeof *open->bits)};
  if (open->columns.items && open->index && open->bits) return OLX_OK;
  olx_cover_open_free(open);
  return no_memory();
}

void olx_cover_open_free(olx_cover_open *open) {
  olx_surfels_free(&open->columns);
  olx_release(open->index);
  olx_release(open->bits);
  open->index = NULL;
  open->bits = NULL;
}

void olx_cover_find_open(const olx_cover_state *s, olx_cover_open *open) {
  const uint8_t *least = s->levels + (size_t)s->capacity * (s->views - 1);
  open->columns.count = open->common = 0;
  for (uint32_t i = 0; i < s->columns.count; i++) {
    if (least[i] != 0) continue;
    open->columns.items[open->columns.count] = s->columns.items[i];
    open->index[open->columns.count++] = i;
    open->common += i < s->common;
  }
  olx_cover_pack(open);
}

void olx_cover_pack(olx_cover_open *open) {
  open->bit_words = 0;
  for (uint32_t k = 0; k < open->columns.count; k++) {
    if (k == open->common) open->common_words = open->bit_words;
    const uint32_t word = open->index[k] / 64;
    if (k == 0 || k == open->common || open->bits[open->bit_words - 1].word != word)
      open->bits[open->bit_words++] = (struct olx_cover_bits){.word = word};
    open->bits[open->bit_words - 1].mask |= (uint64_t)1 << open->index[k] % 64;
  }
  if (open->common == open->columns.count) open->common_words = open->bit_words;
}

OLX_WIDEST static uint64_t count_bits(const struct olx_cover_bits *bits, uint32_t words, const uint64_t *seen) {
  uint64_t count = 0;
  for (uint32_t k = 0; k < words; k++) count += (uint64_t)__builtin_popcountll(seen[bits[k].word] & bits[k].mask);
  return count;
}

uint64_t olx_cover_candidate_weight(const olx_cover_state *s, const olx_cover_open *open, uint32_t candidate) {
  const uint64_t *seen = s->seen + (size_t)olx_cover_words(s) * candidate;
  const uint32_t common = open->common_words;
  return s->common_weight * count_bits(open->bits, common, seen) +
         s->rare_weight * count_bits(open->bits + common, open->bit_words - common, seen);
}

uint64_t olx_cover_open_weight(const olx_cover_state *s, const olx_cover_open *open, const uint8_t *row) {
  uint64_t common = 0, rare = 0;
  for (uint32_t k = 0; k < open->common; k++) common += row[open->index[k]] != 0;
  for (uint32_t k = open->common; k < open->columns.count; k++) rare += row[open->index[k]] != 0;
  return common * s->common_weight + rare * s->rare_weight;
}

typedef struct gain_from_job {
  const olx_cover_state *state;
  const olx_cover_open *open;
  uint64_t least;
  olx_gain *gains;
} gain_from_job;

static olx_gain gain_from(const gain_from_job *job, uint32_t candidate) {
  const olx_cover_state *s = job->state;
  const uint64_t covered = olx_cover_candidate_weight(s, job->open, candidate);
  return covered < job->least ? (olx_gain){.covered = covered} : olx_cover_gain(s, olx_cover_row(s, candidate));
}

static void gains_from_job(void *user, uint32_t index) {
  const gain_from_job *job = user;
  const uint32_t first = index * ROWS_A_JOB;
  for (uint32_t i = first; i < first + ROWS_A_JOB && i < job->state->candidate_count; i++) {
    job->gains[i] = job->state->unfit[i] ? (olx_gain){0} : gain_from(job, i);
  }
}

olx_result olx_cover_gains_from(const olx_cover_state *s, const olx_cover_open *open, uint64_t least, olx_gain *gains) {
  gain_from_job job = {s, open, least, gains};
  return olx_parallel_for((s->candidate_count + ROWS_A_JOB - 1) / ROWS_A_JOB, s->threads, gains_from_job, &job, NULL,
                          0);
}

olx_gain olx_cover_look(const olx_cover_state *s, const olx_cover_open *open, olx_vec3 place, uint64_t least,
                        uint8_t *row) {
  olx_sight_row(s->space, s->sight, place, &open->columns, row);
  uint64_t common = 0, rare = 0;
  for (uint32_t k = 0; k < open->common; k++) common += row[k] != 0;
  for (uint32_t k = open->common; k < open->columns.count; k++) rare += row[k] != 0;
  const uint64_t covered = common * s->common_weight + rare * s->rare_weight;
  if (covered < least) return (olx_gain){.covered = covered};
  olx_sight_row(s->space, s->sight, place, &s->columns, row);
  return olx_cover_gain(s, row);
}

static uint64_t weight_of(const olx_cover_state *s, uint32_t column) {
  return column < s->common ? s->common_weight : s->rare_weight;
}

uint64_t olx_cover_uncovered(const olx_cover_state *s) {
  const uint8_t *least = s->levels + (size_t)s->capacity * (s->views - 1);
  uint64_t sum = 0;
  for (uint32_t i = 0; i < s->columns.count; i++) sum += least[i] == 0 ? weight_of(s, i) : 0;
  return sum;
}

bool olx_cover_keeps_distance(const olx_cover_state *s, olx_vec3 place, uint32_t without) {
  const float least = s->space->scene->probe_rules.min_distance;
  for (uint32_t i = 0; least > 0.0f && i < s->pick_count; i++) {
    if (i != without && olx_length(olx_sub(place, s->picks[i].place)) < least) return false;
  }
  return true;
}
