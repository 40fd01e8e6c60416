// Thins out the probes of many tiles, which were chosen tile by tile, by a lazy greedy cover over samples of all tiles,
// whose rows are sparse.
#include "place/cover/thin.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "place/space/space_find.h"

#include <string.h>

enum {
  THIN_SEED = 0x7417,
  MOST_RAYS = 1 << 24, // approximate rays of all tiles
  SEEN_BY = 4          // most probes recorded for a surfel, in addition to the required views
};
#define DENSER 4.0     // density of rays relative to the surfels of placement
#define LEAST_LOSS 0.1 // share, of what may stay uncovered, that thinning may add

// A pair of a probe and a surfel that it sees well; surfels of all tiles are numbered.
typedef struct sighting {
  uint32_t probe, surfel;
} sighting;

typedef struct thinner {
  const olx_tiling *tiling;
  const olx_candidate *probes;
  uint32_t probe_count, surfel_count, wanted; // wanted: number of probes that may still be kept
  uint64_t uncovered, allowed;                // surfels that all probes cover and the kept ones do not
  sighting *seen;
  size_t seen_count, seen_capacity;
  size_t *first; // index of each probe's first surfel in `surfels`
  uint32_t *surfels;
  uint8_t *views;  // per surfel: views by probes that are kept
  uint8_t *kept;   // one per probe
  uint32_t *order; // of the kept probes, in the order in which they were chosen
  uint32_t order_count;
  uint32_t *gains; // per probe: surfels that it added when last counted
} thinner;

static olx_result no_memory(void) { return olx_fail(OLX_ERROR_MEMORY, "place: no memory for sightings of probes"); }

static olx_result make_room(thinner *t, size_t more) {
  if (t->seen_count + more <= t->seen_capacity) return OLX_OK;
  const size_t capacity = (t->seen_count + more) * 3 / 2;
  sighting *seen = olx_allocate(capacity, sizeof *seen);
  if (!seen) return no_memory();
  if (t->seen_count) memcpy(seen, t->seen, t->seen_count * sizeof *seen);
  olx_release(t->seen);
  t->seen = seen;
  t->seen_capacity = capacity;
  return OLX_OK;
}

// Records what a probe sees; noted[i] counts the probes recorded for surfel i. A surfel that many probes see is hardly
// ever lost, so that some of them suffice.
static olx_result note_row(thinner *t, uint32_t probe, const uint8_t *row, uint32_t count, uint8_t *noted) {
  const uint32_t most = t->tiling->settings->views + SEEN_BY - 1;
  OLX_TRY(make_room(t, count));
  for (uint32_t i = 0; i < count; i++) {
    if (!row[i] || noted[i] >= most) continue;
    noted[i]++;
    t->seen[t->seen_count++] = (sighting){probe, t->surfel_count + i};
  }
  return OLX_OK;
}

static olx_result look_in(thinner *t, const olx_space *space, const olx_surfels *surfels) {
  uint8_t *row = olx_allocate(surfels->count, 1), *noted = olx_allocate_zero(surfels->count, 1);
  olx_result result = row && noted ? OLX_OK : no_memory();
  for (uint32_t i = 0; result == OLX_OK && i < t->probe_count; i++) {
    if (!olx_space_is_near(space, t->probes[i].place)) continue;
    olx_sight_row(space, t->tiling->sight, t->probes[i].place, surfels, row);
    result = note_row(t, i, row, surfels->count, noted);
  }
  t->surfel_count += surfels->count;
  olx_release(row);
  olx_release(noted);
  return result;
}

// Returns the number of rays per voxel of a tile's space.
static double ray_density(const olx_tiling *tiling) {
  const double wanted = DENSER * (double)tiling->settings->surfels / OLX_SETTINGS_VOXELS;
  const double affordable = MOST_RAYS / (double)tiling->world->reached_count;
  return wanted < affordable ? wanted : affordable;
}

static olx_result look_at_tile(thinner *t, uint32_t tile) {
  const olx_place_settings *s = t->tiling->settings;
  olx_space space;
  olx_surfels surfels = {0};
  OLX_TRY(olx_space_open(t->tiling->world, tile, OLX_TILE_OVERLAP, s->threads, &space));
  const uint32_t rays = (uint32_t)(ray_density(t->tiling) * (double)space.start_count);
  const uint32_t seed = olx_hash3(s->seed, THIN_SEED, tile);
  olx_result result = OLX_OK;
  if (rays > 0) {
    result = olx_surfels_create(&space, t->tiling->sight, OLX_SPREAD_RAYS, rays, seed, s->threads, &surfels);
  }
  if (result == OLX_OK) result = look_in(t, &space, &surfels);
  olx_surfels_free(&surfels);
  olx_space_free(&space);
  return result;
}

// Sorts the surfels by probes.
static olx_result sort_sightings(thinner *t) {
  t->first = olx_allocate_zero((size_t)t->probe_count + 2, sizeof *t->first);
  t->surfels = olx_allocate(t->seen_count, sizeof *t->surfels);
  t->views = olx_allocate_zero(t->surfel_count, 1);
  t->kept = olx_allocate_zero(t->probe_count, 1);
  t->order = olx_allocate(t->probe_count, sizeof *t->order);
  t->gains = olx_allocate(t->probe_count, sizeof *t->gains);
  if (!t->first || !t->surfels || !t->views || !t->kept || !t->order || !t->gains) return no_memory();
  for (size_t i = 0; i < t->seen_count; i++) t->first[t->seen[i].probe + 2]++;
  for (uint32_t i = 2; i < t->probe_count + 2; i++) t->first[i] += t->first[i - 1];
  for (size_t i = 0; i < t->seen_count; i++) t->surfels[t->first[t->seen[i].probe + 1]++] = t->seen[i].surfel;
  olx_release(t->seen);
  t->seen = NULL;
  return OLX_OK;
}

static uint32_t gain_of(const thinner *t, uint32_t probe) {
  uint32_t gain = 0;
  for (size_t i = t->first[probe]; i < t->first[probe + 1]; i++) {
    gain += t->views[t->surfels[i]] < t->tiling->settings->views;
  }
  return gain;
}

static void keep(thinner *t, uint32_t probe) {
  const uint32_t least = t->tiling->settings->views;
  t->kept[probe] = 1;
  t->order[t->order_count++] = probe;
  for (size_t i = t->first[probe]; i < t->first[probe + 1]; i++) {
    uint8_t *views = &t->views[t->surfels[i]];
    if (*views >= least) continue;
    t->uncovered -= ++*views == least;
  }
}

// Counts the surfels that all probes together cover.
static void count_coverable(thinner *t) {
  const uint32_t least = t->tiling->settings->views;
  for (size_t i = 0; i < t->seen_count; i++) {
    uint8_t *views = &t->views[t->surfels[i]];
    if (*views < least) t->uncovered += ++*views == least;
  }
  memset(t->views, 0, t->surfel_count);
}

static bool is_done(const thinner *t) { return t->wanted == 0 || t->uncovered <= t->allowed; }

// Chooses probes greedily. Gains only fall: a probe whose gain is unchanged since it was last counted, and that no
// other exceeds, adds most. Buckets hold the probes by gain and are visited from the largest gain on.
static olx_result choose(thinner *t) {
  uint32_t most = 0;
  for (uint32_t i = 0; i < t->probe_count; i++) {
    t->gains[i] = gain_of(t, i);
    if (!t->kept[i] && t->gains[i] > most) most = t->gains[i];
  }
  for (uint32_t level = most; level > 0 && !is_done(t); level--) {
    OLX_TRY(olx_check_cancelled());
    for (uint32_t i = 0; i < t->probe_count && !is_done(t); i++) {
      if (t->kept[i] || t->gains[i] < level) continue;
      t->gains[i] = gain_of(t, i);
      if (t->gains[i] < level) continue;
      keep(t, i);
      t->wanted--;
    }
  }
  return OLX_OK;
}

// Moves the kept probes to the front in the order in which they were chosen, so that the last ones are those that add
// least, wherever they are: a budget may drop some of them (budget.h).
static olx_result sort_by_choice(const thinner *t, olx_candidate *probes) {
  olx_candidate *chosen = olx_allocate(t->order_count, sizeof *chosen);
  if (!chosen) return no_memory();
  for (uint32_t i = 0; i < t->order_count; i++) chosen[i] = probes[t->order[i]];
  memcpy(probes, chosen, t->order_count * sizeof *chosen);
  olx_release(chosen);
  return OLX_OK;
}

static olx_result thin(thinner *t, uint32_t limit, olx_candidate *probes, uint32_t *count) {
  const uint32_t pinned = t->tiling->pinned.count;
  for (uint32_t i = 0; i < t->tiling->world->tile_total; i++) OLX_TRY(look_at_tile(t, i));
  OLX_TRY(sort_sightings(t));
  count_coverable(t);
  if (t->tiling->settings->count == 0) {
    t->allowed = (uint64_t)(LEAST_LOSS * (1.0 - (double)t->tiling->settings->coverage) * (double)t->uncovered);
  }
  t->wanted = limit - pinned;
  for (uint32_t i = 0; i < pinned; i++) keep(t, i);
  OLX_TRY(choose(t));
  *count = t->order_count;
  if (t->tiling->settings->budget_mb > 0.0) return sort_by_choice(t, probes);
  uint32_t used = 0;
  for (uint32_t i = 0; i < t->probe_count; i++) {
    if (t->kept[i]) probes[used++] = probes[i];
  }
  return OLX_OK;
}

olx_result olx_tiling_thin(const olx_tiling *tiling, uint32_t limit, olx_candidate *probes, uint32_t *count) {
  thinner t = {.tiling = tiling, .probes = probes, .probe_count = *count};
  const olx_result result = thin(&t, limit, probes, count);
  olx_release(t.seen);
  olx_release(t.first);
  olx_release(t.surfels);
  olx_release(t.views);
  olx_release(t.kept);
  olx_release(t.order);
  olx_release(t.gains);
  return result;
}
