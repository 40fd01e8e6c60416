// Builds the Voronoi selector (Wang 2018, section 4.1): for each direction from a probe, the Delaunay neighbours
// nearest in angle, and a k-d tree by which the nearest probe is found.
#include "bake/selectors/voronoi_build.h"

#include "bake/selectors/delaunay.h"
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/result.h"
#include "field/selector_data.h"

#include <stdlib.h>
#include <string.h>

// Cosines are rounded down to multiples of 1 / COSINE_STEPS. Of neighbours with equal cosines the nearer one comes
// first.
static const float COSINE_STEPS = 65536.0f;

typedef struct voronoi_build {
  const olx_selector_input *input;
  const uint32_t *live;      // probes that are not buried
  const olx_vec3 *positions; // of those
  const olx_neighbours *neighbours;
  void *codes;
  uint32_t code_bytes;
} voronoi_build;

typedef struct candidate {
  float cosine, distance; // rounded cosine of the angle from the texel; squared metres
  uint32_t probe;
} candidate;

static bool is_better(const candidate *a, const candidate *b) {
  if (a->cosine != b->cosine) return a->cosine > b->cosine;
  if (a->distance != b->distance) return a->distance < b->distance;
  return a->probe < b->probe;
}

// Inserts a candidate among the best, in order.
static void consider(candidate best[OLX_CHOICES], uint32_t *known, candidate c) {
  if (*known == OLX_CHOICES && !is_better(&c, &best[OLX_CHOICES - 1])) return;
  uint32_t at = *known < OLX_CHOICES ? (*known)++ : OLX_CHOICES - 1;
  for (; at > 0 && is_better(&c, &best[at - 1]); at--) best[at] = best[at - 1];
  best[at] = c;
}

static void fill_texel(const voronoi_build *b, uint32_t i, uint32_t texel) {
  const olx_vec3 direction = olx_texel_direction(texel % OLX_VORONOI_SIZE, texel / OLX_VORONOI_SIZE, OLX_VORONOI_SIZE);
  candidate best[OLX_CHOICES];
  uint32_t known = 0;
  for (size_t e = b->neighbours->first[i]; e < b->neighbours->first[i + 1]; e++) {
    const uint32_t other = b->neighbours->neighbour[e];
    const olx_vec3 offset = olx_sub(b->positions[other], b->positions[i]);
    const float distance = olx_dot(offset, offset);
    // A probe in the same place sees the same: last.
    const float cosine = distance > 0.0f ? olx_dot(direction, offset) / sqrtf(distance) : -2.0f;
    consider(best, &known, (candidate){floorf(cosine * COSINE_STEPS), distance, b->live[other]});
  }
  const size_t first = ((size_t)b->live[i] * OLX_VORONOI_SIZE * OLX_VORONOI_SIZE + texel) * OLX_CHOICES;
  for (uint32_t k = 0; k < known; k++) olx_probe_code_store(b->codes, b->code_bytes, first + k, best[k].probe);
}

static void fill_map(void *user, uint32_t i) {
  for (uint32_t texel = 0; texel < OLX_VORONOI_SIZE * OLX_VORONOI_SIZE; texel++) fill_texel(user, i, texel);
}

// A probe and its coordinate along the axis by which it is being sorted.
typedef struct tree_entry {
  float coordinate;
  uint32_t probe;
} tree_entry;

static int compare_entries(const void *left, const void *right) {
  const tree_entry *a = left, *b = right;
  if (a->coordinate != b->coordinate) return a->coordinate < b->coordinate ? -1 : 1;
  return a->probe < b->probe ? -1 : a->probe > b->probe;
}

static void sort_tree(const olx_selector_input *input, tree_entry *entries, uint32_t begin, uint32_t end,
                      uint32_t axis) {
  if (end - begin < 2) return;
  for (uint32_t i = begin; i < end; i++) {
    entries[i].coordinate = olx_component(input->positions[entries[i].probe], axis);
  }
  qsort(entries + begin, end - begin, sizeof *entries, compare_entries);
  const uint32_t middle = olx_middle(begin, end), next = (axis + 1) % 3;
  sort_tree(input, entries, begin, middle, next);
  sort_tree(input, entries, middle + 1, end, next);
}

// The tree holds buried probes, too, for lookups that do not leave them out.
static olx_result fill_tree(const voronoi_build *b) {
  const uint32_t count = b->input->count;
  tree_entry *entries = olx_allocate(count, sizeof *entries);
  if (!entries) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the order of %u probes", count);
  for (uint32_t i = 0; i < count; i++) entries[i].probe = i;
  sort_tree(b->input, entries, 0, count, 0);
  const size_t tree = (size_t)count * OLX_VORONOI_SIZE * OLX_VORONOI_SIZE * OLX_CHOICES;
  for (uint32_t i = 0; i < count; i++) olx_probe_code_store(b->codes, b->code_bytes, tree + i, entries[i].probe);
  olx_release(entries);
  return OLX_OK;
}

static olx_result fill(voronoi_build *b, uint32_t *live, olx_vec3 *positions) {
  const olx_selector_input *input = b->input;
  uint32_t count = 0;
  OLX_TRY(fill_tree(b));
  for (uint32_t i = 0; i < input->count; i++) {
    if (input->flags[i] & OLX_PROBE_BURIED) continue;
    positions[count] = input->positions[i];
    live[count++] = i;
  }
  if (count == 0) return OLX_OK;
  olx_neighbours neighbours;
  OLX_TRY(olx_neighbours_create(positions, count, &neighbours));
  b->live = live;
  b->positions = positions;
  b->neighbours = &neighbours;
  const olx_result result = olx_parallel_for(count, input->threads, fill_map, b, input->task, 0);
  olx_neighbours_free(&neighbours);
  return result;
}

olx_result olx_voronoi_build(const olx_selector_input *input, void **data, size_t *size_bytes) {
  if (input->count > OLX_MAX_CODED_PROBES) {
    return olx_fail(OLX_ERROR_ARGUMENT, "bake: the selector 'voronoi' takes at most %d probes, not %u",
                    OLX_MAX_CODED_PROBES, input->count);
  }
  voronoi_build b = {.input = input, .code_bytes = olx_probe_code_bytes(input->count)};
  const size_t codes = (size_t)input->count * (OLX_VORONOI_SIZE * OLX_VORONOI_SIZE * OLX_CHOICES + 1);
  *size_bytes = sizeof(olx_voronoi_header) + codes * b.code_bytes;
  *data = olx_allocate(*size_bytes, 1);
  uint32_t *live = olx_allocate(input->count, sizeof *live);
  olx_vec3 *positions = olx_allocate(input->count, sizeof *positions);
  olx_result result = OLX_ERROR_MEMORY;
  if (*data && live && positions) {
    memset(*data, 0xFF, *size_bytes); // no probe anywhere
    olx_voronoi_header *header = *data;
    *header = (olx_voronoi_header){.size = OLX_VORONOI_SIZE};
    b.codes = header + 1;
    result = fill(&b, live, positions);
  } else {
    result = olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the neighbours of %u probes", input->count);
  }
  olx_release(live);
  olx_release(positions);
  if (result == OLX_OK) return OLX_OK;
  olx_release(*data);
  *data = NULL;
  return result;
}
