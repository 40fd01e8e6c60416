// Sums links in the nodes of a tree and divides nodes, the heaviest first, as long as there is room for their members.
#include "light/merged_links.h"

#include "core/hooks.h"
#include "core/result.h"

#include <stdlib.h>

// Nodes that bring less than this share of all are not divided.
static const float LEAST_SHARE = 1.0f / 1024.0f;

olx_result olx_link_merger_create(olx_link_merger *m, const olx_link_tree *tree) {
  *m = (olx_link_merger){.tree = tree,
                         .weights = olx_allocate_zero(tree->count, sizeof *m->weights),
                         .directions = olx_allocate_zero(tree->count, sizeof *m->directions),
                         .named = olx_allocate_zero(tree->count, sizeof *m->named),
                         .numbers = olx_allocate(tree->count, sizeof *m->numbers)};
  if (m->weights && m->directions && m->named && m->numbers) return OLX_OK;
  olx_link_merger_free(m);
  return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for merging links of %u surfels", tree->leaves);
}

void olx_link_merger_free(olx_link_merger *m) {
  olx_release(m->weights);
  olx_release(m->directions);
  olx_release(m->named);
  olx_release(m->numbers);
  *m = (olx_link_merger){0};
}

static void name(olx_link_merger *m, uint32_t number) {
  if (m->named[number]) return;
  m->named[number] = true;
  m->numbers[m->count++] = number;
}

void olx_link_merger_add(olx_link_merger *m, uint32_t surfel, olx_vec3 weight, olx_vec3 direction) {
  name(m, surfel);
  m->weights[surfel] = olx_add(m->weights[surfel], weight);
  m->directions[surfel] = olx_madd(m->directions[surfel], direction, olx_luminance(weight));
}

static int by_number(const void *a, const void *b) {
  const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return p < q ? -1 : p > q;
}

// Adds up what members bring in their nodes. Members come before nodes.
static void sum_nodes(olx_link_merger *m) {
  const uint32_t *parents = m->tree->parents;
  for (uint32_t i = 0; i < m->count; i++) {
    if (parents[m->numbers[i]] != OLX_TREE_NONE) name(m, parents[m->numbers[i]]);
  }
  if (m->count > 0) qsort(m->numbers, m->count, sizeof *m->numbers, by_number);
  for (uint32_t i = 0; i < m->count; i++) {
    const uint32_t number = m->numbers[i], parent = parents[number];
    if (parent == OLX_TREE_NONE) continue;
    m->weights[parent] = olx_add(m->weights[parent], m->weights[number]);
    m->directions[parent] = olx_add(m->directions[parent], m->directions[number]);
  }
}

static olx_merged_link link_to(const olx_link_merger *m, uint32_t number) {
  const olx_vec3 direction = m->directions[number];
  const float length = olx_length(direction);
  return (olx_merged_link){number, m->weights[number],
                           length > 0.0f ? olx_scale(direction, 1.0f / length) : olx_splat(0.0f)};
}

static float brings(const olx_merged_link *link) { return olx_luminance(link->weight); }

// The place for another link: a new one, or that of the lightest where there is no room and it weighs less.
static void put(olx_merged_link *links, uint32_t *count, uint32_t most, olx_merged_link link) {
  if (*count < most) {
    links[(*count)++] = link;
    return;
  }
  uint32_t lightest = 0;
  for (uint32_t i = 1; i < most; i++) {
    if (brings(&links[i]) < brings(&links[lightest])) lightest = i;
  }
  if (brings(&link) > brings(&links[lightest])) links[lightest] = link;
}

// The nodes that belong to no other.
static uint32_t take_roots(const olx_link_merger *m, uint32_t most, olx_merged_link *links, float *total) {
  uint32_t count = 0;
  *total = 0.0f;
  for (uint32_t i = 0; i < m->count; i++) {
    if (m->tree->parents[m->numbers[i]] != OLX_TREE_NONE) continue;
    const olx_merged_link link = link_to(m, m->numbers[i]);
    *total += brings(&link);
    put(links, &count, most, link);
  }
  return count;
}

// The heaviest link to a node of several that brings more than `least` and less than `below`; count where there is none.
static uint32_t heaviest(const olx_link_merger *m, const olx_merged_link *links, uint32_t count, float least, float below) {
  uint32_t found = count;
  for (uint32_t i = 0; i < count; i++) {
    if (links[i].from < m->tree->leaves || brings(&links[i]) <= least || brings(&links[i]) >= below) continue;
    least = brings(&links[i]);
    found = i;
  }
  return found;
}

// Puts the members of a node in its place; false where there is no room for them.
static bool divide(const olx_link_merger *m, olx_merged_link *links, uint32_t *count, uint32_t most, uint32_t at) {
  const olx_link_tree *t = m->tree;
  const uint32_t node = links[at].from - t->leaves;
  uint32_t members = 0;
  for (uint32_t i = t->starts[node]; i < t->starts[node + 1]; i++) members += m->named[t->members[i]];
  if (*count + members - 1 > most) return false;
  links[at] = links[--*count];
  for (uint32_t i = t->starts[node]; i < t->starts[node + 1]; i++) {
    if (m->named[t->members[i]]) links[(*count)++] = link_to(m, t->members[i]);
  }
  return true;
}

static void clear(olx_link_merger *m) {
  for (uint32_t i = 0; i < m->count; i++) {
    const uint32_t number = m->numbers[i];
    m->weights[number] = m->directions[number] = olx_splat(0.0f);
    m->named[number] = false;
  }
  m->count = 0;
}

uint32_t olx_link_merger_take(olx_link_merger *m, uint32_t most, olx_merged_link *links) {
  sum_nodes(m);
  float total, kept = 0.0f;
  uint32_t count = take_roots(m, most, links, &total);
  float below = INFINITY;
  for (uint32_t at; (at = heaviest(m, links, count, LEAST_SHARE * total, below)) < count;) {
    const float weight = brings(&links[at]);
    if (!divide(m, links, &count, most, at)) below = weight;
  }
  for (uint32_t i = 0; i < count; i++) kept += brings(&links[i]);
  if (kept > 0.0f && kept < total) {
    for (uint32_t i = 0; i < count; i++) links[i].weight = olx_scale(links[i].weight, total / kept);
  }
  clear(m);
  return count;
}
