// The matrix from which a cover is chosen: candidates by surfels, and what the chosen ones cover.
//
// Its columns are surfels: common ones, a sample of all that is visible, followed by rare ones, which a much denser
// sample found uncovered. When rare columns are added, the uncovered common columns are *settled*, which excludes them.
// The remaining common columns and the rare ones, each with the share it represents, together form an unbiased sample
// again, dense where coverage is missing.
#ifndef OLX_PLACE_COVER_STATE_H
#define OLX_PLACE_COVER_STATE_H

#include "place/cover/candidates.h"
#include "place/cover/visibility.h"

typedef struct olx_cover_state {
  const olx_space *space;
  const olx_sight *sight;
  uint32_t threads, views;
  olx_surfels columns; // count: columns in use; share: of a common column
  uint32_t capacity, common;
  uint64_t common_weight, rare_weight;
  uint8_t *settled; // per column: 255 when it no longer counts, otherwise 0
  olx_candidate *candidates;
  uint8_t *rows;  // qualities, candidates by capacity
  uint64_t *seen; // a bit per quality above 0, candidates by olx_cover_words
  uint8_t *unfit; // per candidate: 1 when it may not be chosen
  uint32_t candidate_count, candidate_capacity;
  olx_candidate *picks;
  uint8_t *pick_rows;
  uint32_t pick_count, pick_capacity;
  uint8_t *levels; // `views` by capacity: the best qualities of each column so far, descending
} olx_cover_state;

// The gain of adding a row to the picks.
typedef struct olx_gain {
  uint64_t covered; // total weight of columns that become covered
  uint64_t quality; // weight times improvement of quality
} olx_gain;

// Coverage takes precedence over quality: this much quality, of 255, outweighs a covered column's weight.
#define OLX_COVER_FACTOR 8000u
static inline uint64_t olx_gain_value(olx_gain g) { return g.covered * OLX_COVER_FACTOR + g.quality; }

// Creates a state, which takes the surfels of `atlas`, with room for `candidates` candidates and `rare` columns.
// Columns that cannot be covered are settled.
olx_result olx_cover_state_create(const olx_space *space, const olx_sight *sight, olx_surfels *atlas, uint32_t rare,
                                  uint32_t candidates, uint32_t views, uint32_t threads, olx_cover_state *state);
void olx_cover_state_free(olx_cover_state *state);

// Appends candidates, as many as there is room for, and computes their rows.
olx_result olx_cover_add_candidates(olx_cover_state *state, const olx_candidate *list, uint32_t count, olx_task *task);
// Settles the uncovered columns, and appends those surfels of `sample` that too few probes see according to `views` and
// that can be covered, as far as there is room.
olx_result olx_cover_renew(olx_cover_state *state, const olx_surfels *sample, const uint8_t *views);

static inline uint8_t *olx_cover_row(const olx_cover_state *s, uint32_t candidate) {
  return s->rows + (size_t)s->capacity * candidate;
}
static inline uint32_t olx_cover_words(const olx_cover_state *s) { return (s->capacity + 63) / 64; }
static inline uint8_t *olx_cover_pick_row(const olx_cover_state *s, uint32_t pick) {
  return s->pick_rows + (size_t)s->capacity * pick;
}

// Appends a candidate to the picks and copies its row.
olx_result olx_cover_pick(olx_cover_state *state, olx_candidate probe, const uint8_t *row);
// Sets the levels to those of all picks except two (pick_count: none).
void olx_cover_set_levels(olx_cover_state *state, uint32_t without, uint32_t without_too);
olx_gain olx_cover_gain(const olx_cover_state *state, const uint8_t *row);
// Computes the gains of all candidates.
olx_result olx_cover_gains(const olx_cover_state *state, olx_gain *gains);

// The columns that the levels leave uncovered, compacted: most candidates can be judged by these few.
typedef struct olx_cover_open {
  olx_surfels columns; // copies of the open columns
  uint32_t *index;     // index of each column in the state
  uint32_t common;     // number of common columns, which come first
  // The open columns as masks of the words of olx_cover_state.seen that have any; filled by olx_cover_pack.
  struct olx_cover_bits {
    uint64_t mask;
    uint32_t word;
  } * bits;
  uint32_t bit_words, common_words;
} olx_cover_open;

// Allocates room for all columns, and collects the open ones.
olx_result olx_cover_open_create(const olx_cover_state *state, olx_cover_open *open);
void olx_cover_open_free(olx_cover_open *open);
void olx_cover_find_open(const olx_cover_state *state, olx_cover_open *open);
void olx_cover_pack(olx_cover_open *open);

// Computes the gains of the candidates that cover at least `least` of the open columns; for the others only `covered`.
olx_result olx_cover_gains_from(const olx_cover_state *state, const olx_cover_open *open, uint64_t least,
                                olx_gain *gains);
// Returns the row of a position and its gain, if it covers at least `least`; otherwise only `covered`.
olx_gain olx_cover_look(const olx_cover_state *state, const olx_cover_open *open, olx_vec3 place, uint64_t least,
                        uint8_t *row);
// Returns the total weight of the columns that are not covered.
uint64_t olx_cover_uncovered(const olx_cover_state *state);

// Returns the weight of the packed open columns that a candidate covers.
uint64_t olx_cover_candidate_weight(const olx_cover_state *state, const olx_cover_open *open, uint32_t candidate);
// Returns the weight of the open columns that a row covers, whether packed or not.
uint64_t olx_cover_open_weight(const olx_cover_state *state, const olx_cover_open *open, const uint8_t *row);

// Returns whether a probe at a position keeps its distance from all picks except `without`. Whether it is buried
// (inside geometry) is not checked.
bool olx_cover_keeps_distance(const olx_cover_state *state, olx_vec3 place, uint32_t without);

#endif
