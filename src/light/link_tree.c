// Joins surfels into nodes, cell by cell from the smallest size to the largest, so that links can be merged.
#include "light/link_tree.h"

#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"

#include <stdlib.h>

// A surfel at which no link ends still counts this much of one.
static const float LEAST_WEIGHT = 1e-3f;

// A leaf or node that may be joined with others of its cell.
typedef struct tree_item {
  uint64_t key;    // of the cell at the level that is joined, and the face that its normal points through
  uint64_t finest; // key of its middle's finest cell
  uint32_t number, surfel; // surfel: that stands for it
  float weight;
} tree_item;

typedef struct tree_build {
  const olx_light_surfels *surfels;
  olx_link_tree *tree;
  tree_item *items; // not joined yet
  uint32_t count;
  uint32_t member_count;
} tree_build;

static uint64_t key_at(uint64_t finest, uint32_t level) {
  const uint64_t cell = olx_cell_at_level(finest, level), bins = (1u << OLX_CELL_BIN_BITS) - 1;
  return (cell & ~bins) | (cell & bins) / OLX_CELL_BINS_A_FACE;
}

static int by_key(const void *a, const void *b) {
  const tree_item *p = a, *q = b;
  if (p->key != q->key) return p->key < q->key ? -1 : 1;
  return p->number < q->number ? -1 : p->number > q->number;
}

// How much of the light of all surfaces ends at each surfel: surfels that gather it count by their area, so that what merged links
// bring is too much nowhere without being too little elsewhere.
static void weigh(const olx_light_surfels *surfels, const olx_light_links *links, float *weights) {
  for (uint32_t i = 0; i < surfels->count; i++) weights[i] = LEAST_WEIGHT * olx_square(surfels->surfels[i].side);
  for (uint32_t k = 0; k < links->batch_count; k++) {
    const olx_link_batch *batch = &links->batches[k];
    for (uint32_t n = 0; n < batch->count; n++) {
      const uint32_t surfel = olx_link_surfel(batch, n);
      const float share = olx_square(surfels->surfels[surfel].side) / links->worth[surfel];
      for (uint32_t i = 0; i < batch->rays; i++) {
        const olx_link *link = &batch->links[(size_t)n * batch->rays + i];
        if (olx_link_brings_light(link)) {
          weights[olx_link_end(link)] += share * olx_luminance(olx_rgb9e5_unpack(link->weight));
        }
      }
    }
  }
}

// A node of items first to before end, which see each other.
static tree_item join(tree_build *b, const tree_item *items, uint32_t count) {
  olx_link_tree *t = b->tree;
  tree_item node = items[0];
  float weight = 0.0f, most = 0.0f;
  for (uint32_t i = 0; i < count; i++) weight += items[i].weight;
  for (uint32_t i = 0; i < count; i++) {
    t->members[b->member_count] = items[i].number;
    t->shares[b->member_count++] = items[i].weight / weight;
    t->parents[items[i].number] = t->count;
    if (items[i].weight <= most) continue;
    most = items[i].weight;
    node = items[i];
  }
  node.number = t->count;
  node.weight = weight;
  t->parents[t->count] = OLX_TREE_NONE;
  t->starts[++t->count - t->leaves] = b->member_count;
  return node;
}

static bool sees(const tree_build *b, const tree_item *a, const tree_item *other) {
  return olx_light_surfels_beside(b->surfels, &b->surfels->surfels[a->surfel], &b->surfels->surfels[other->surfel]);
}

// Joins the items of one cell: those that see the first of them, then those of the rest that see the first of these, and so on.
static uint32_t join_cell(tree_build *b, tree_item *items, uint32_t count) {
  uint32_t kept = 0;
  for (uint32_t first = 0; first < count;) {
    uint32_t end = first + 1;
    for (uint32_t i = end; i < count; i++) {
      if (!sees(b, &items[first], &items[i])) continue;
      const tree_item item = items[i];
      items[i] = items[end];
      items[end++] = item;
    }
    const tree_item joined = end == first + 1 ? items[first] : join(b, items + first, end - first);
    items[kept++] = joined;
    first = end;
  }
  return kept;
}

static uint32_t level_of(const olx_cell_grid *grid, float side) {
  int exponent;
  frexpf(side / grid->finest, &exponent);
  return (uint32_t)(exponent - 1);
}

// Items that are no larger than the cells of a level, joined in these; larger surfels wait.
static void join_level(tree_build *b, uint32_t level) {
  for (uint32_t i = 0; i < b->count; i++) {
    tree_item *item = &b->items[i];
    const bool waits =
        item->number < b->tree->leaves && level_of(&b->surfels->grid, b->surfels->surfels[item->number].side) > level;
    item->key = waits ? UINT64_MAX : key_at(item->finest, level);
  }
  qsort(b->items, b->count, sizeof *b->items, by_key);
  uint32_t kept = 0;
  for (uint32_t first = 0, end; first < b->count; first = end) {
    for (end = first + 1; end < b->count && b->items[end].key == b->items[first].key;) end++;
    const uint32_t joined =
        b->items[first].key == UINT64_MAX ? end - first : join_cell(b, b->items + first, end - first);
    for (uint32_t i = 0; i < joined; i++) b->items[kept++] = b->items[first + i];
  }
  b->count = kept;
}

static olx_result allocate(olx_link_tree *t, uint32_t leaves) {
  const size_t most = 2 * (size_t)leaves + 1; // every node has two members or more
  t->leaves = t->count = leaves;
  t->parents = olx_allocate(most, sizeof *t->parents);
  t->starts = olx_allocate_zero(most, sizeof *t->starts);
  t->members = olx_allocate(most, sizeof *t->members);
  t->shares = olx_allocate(most, sizeof *t->shares);
  if (t->parents && t->starts && t->members && t->shares) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for a tree over %u surfels", leaves);
}

static olx_result build(olx_link_tree *t, const olx_light_surfels *s, const olx_light_links *links) {
  OLX_TRY(allocate(t, s->count));
  float *weights = olx_allocate(s->count, sizeof *weights);
  tree_build b = {.surfels = s, .tree = t, .items = olx_allocate(s->count, sizeof *b.items), .count = s->count};
  olx_result result = OLX_OK;
  if (weights && b.items) {
    weigh(s, links, weights);
    for (uint32_t i = 0; i < s->count; i++) {
      t->parents[i] = OLX_TREE_NONE;
      b.items[i] = (tree_item){.finest = s->surfels[i].point.key, .number = i, .surfel = i, .weight = weights[i]};
    }
    for (uint32_t level = 0; level < OLX_CELL_LEVELS; level++) join_level(&b, level);
  } else {
    result = olx_fail(OLX_ERROR_MEMORY, "light: out of memory for a tree over %u surfels", s->count);
  }
  olx_release(weights);
  olx_release(b.items);
  return result;
}

olx_result olx_link_tree_create(olx_link_tree *t, const olx_light_surfels *surfels, const olx_light_links *links) {
  *t = (olx_link_tree){0};
  const olx_result result = build(t, surfels, links);
  if (result != OLX_OK) olx_link_tree_free(t);
  return result;
}

void olx_link_tree_free(olx_link_tree *t) {
  olx_release(t->parents);
  olx_release(t->starts);
  olx_release(t->members);
  olx_release(t->shares);
  *t = (olx_link_tree){0};
}

void olx_link_tree_sum(const olx_link_tree *t, olx_vec3 *values) {
  for (uint32_t node = t->leaves; node < t->count; node++) {
    olx_vec3 sum = {0};
    for (uint32_t i = t->starts[node - t->leaves]; i < t->starts[node - t->leaves + 1]; i++) {
      sum = olx_madd(sum, values[t->members[i]], t->shares[i]);
    }
    values[node] = sum;
  }
}
