// Groups positions by similarity (farthest seeds, then k-means) and takes one probe from each group, which keeps its
// distance from the other probes and is not buried (inside geometry).
#include "place/skeleton/cluster.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"

#include <stdlib.h>
#include <string.h>

enum {
  ROUNDS = 12,         // most iterations of Lloyd's algorithm
  MOST_UNASKED = 1024, // most clusters when no count is requested
  GRANULARITIES = 4,   // granularities tried until enough clusters are large enough
  MEMBERS_TRIED = 16,  // members of a cluster that are tried
  ITEMS_A_JOB = 256
};

static float distance2(const float *a, const float *b) {
  float sum = 0.0f;
  for (int i = 0; i < OLX_FEATURES; i++) sum += olx_square(a[i] - b[i]);
  return sum;
}

typedef struct clustering {
  const olx_cluster_item *items;
  uint32_t count, clusters, threads;
  float (*centres)[OLX_FEATURES];
  uint32_t *cluster_of;
} clustering;

static void assign_job(void *user, uint32_t index) {
  const clustering *c = user;
  const uint32_t first = index * ITEMS_A_JOB;
  for (uint32_t i = first; i < first + ITEMS_A_JOB && i < c->count; i++) {
    float least = INFINITY;
    for (uint32_t k = 0; k < c->clusters; k++) {
      const float d = distance2(c->items[i].features, c->centres[k]);
      if (d >= least) continue;
      least = d;
      c->cluster_of[i] = k;
    }
  }
}

static olx_result assign(clustering *c) {
  return olx_parallel_for((c->count + ITEMS_A_JOB - 1) / ITEMS_A_JOB, c->threads, assign_job, c, NULL, 0);
}

// Seeds with the item nearest to the mean of all, then repeatedly with the item farthest from all seeds.
static olx_result seed_clusters(clustering *c, uint32_t most, float reach, float *nearest) {
  double mean[OLX_FEATURES] = {0};
  float centre[OLX_FEATURES];
  for (uint32_t i = 0; i < c->count; i++) {
    for (int f = 0; f < OLX_FEATURES; f++) mean[f] += (double)c->items[i].features[f] / c->count;
  }
  for (int f = 0; f < OLX_FEATURES; f++) centre[f] = (float)mean[f];
  uint32_t seed = 0;
  for (uint32_t i = 0; i < c->count; i++) {
    nearest[i] = INFINITY;
    if (distance2(c->items[i].features, centre) < distance2(c->items[seed].features, centre)) seed = i;
  }
  for (c->clusters = 0; c->clusters < most;) {
    memcpy(c->centres[c->clusters++], c->items[seed].features, sizeof *c->centres);
    const float *newest = c->items[seed].features;
    for (uint32_t i = 0; i < c->count; i++) nearest[i] = olx_min(nearest[i], distance2(c->items[i].features, newest));
    for (uint32_t i = 0; i < c->count; i++) {
      if (nearest[i] > nearest[seed]) seed = i;
    }
    if (nearest[seed] <= reach * reach) break;
    OLX_TRY(olx_check_cancelled());
  }
  return OLX_OK;
}

// Moves centres to the means of their members; a centre without members is removed.
static void move_centres(clustering *c, double (*sums)[OLX_FEATURES], uint32_t *sizes) {
  memset(sums, 0, c->clusters * sizeof *sums);
  memset(sizes, 0, c->clusters * sizeof *sizes);
  for (uint32_t i = 0; i < c->count; i++) {
    sizes[c->cluster_of[i]]++;
    for (int f = 0; f < OLX_FEATURES; f++) sums[c->cluster_of[i]][f] += (double)c->items[i].features[f];
  }
  uint32_t kept = 0;
  for (uint32_t k = 0; k < c->clusters; k++) {
    if (sizes[k] == 0) continue;
    for (int f = 0; f < OLX_FEATURES; f++) c->centres[kept][f] = (float)(sums[k][f] / sizes[k]);
    kept++;
  }
  c->clusters = kept;
}

// Renumbers the clusters that have members from 0, in order.
static void drop_empty(clustering *c, uint32_t *sizes) {
  memset(sizes, 0, c->clusters * sizeof *sizes);
  for (uint32_t i = 0; i < c->count; i++) sizes[c->cluster_of[i]] = 1;
  uint32_t used = 0;
  for (uint32_t k = 0; k < c->clusters; k++) {
    const uint32_t own = sizes[k];
    sizes[k] = used;
    used += own;
  }
  for (uint32_t i = 0; i < c->count; i++) c->cluster_of[i] = sizes[c->cluster_of[i]];
  c->clusters = used;
}

olx_result olx_cluster(const olx_cluster_item *items, uint32_t count, uint32_t wanted, uint32_t threads,
                       uint32_t *cluster_of, uint32_t *clusters) {
  const uint32_t asked = wanted ? wanted : MOST_UNASKED, most = asked < count ? asked : count;
  clustering c = {.items = items, .count = count, .threads = threads, .cluster_of = cluster_of};
  c.centres = olx_allocate(most, sizeof *c.centres);
  double(*sums)[OLX_FEATURES] = olx_allocate(most, sizeof *sums);
  uint32_t *sizes = olx_allocate(most, sizeof *sizes);
  float *nearest = olx_allocate(count, sizeof *nearest);
  olx_result result = OLX_ERROR_MEMORY;
  *clusters = 0;
  if (c.centres && sums && sizes && nearest) {
    result = OLX_OK;
    if (count > 0) result = seed_clusters(&c, most, wanted ? 0.0f : OLX_CLUSTER_REACH, nearest);
    for (uint32_t round = 0; round < ROUNDS && result == OLX_OK; round++) {
      result = assign(&c);
      if (result == OLX_OK && round + 1 < ROUNDS) move_centres(&c, sums, sizes);
    }
    if (result == OLX_OK) drop_empty(&c, sizes);
    *clusters = c.clusters;
  } else {
    olx_fail(result, "place: no memory for %u clusters", most);
  }
  olx_release(c.centres);
  olx_release(sums);
  olx_release(sizes);
  olx_release(nearest);
  return result;
}

// A member and its distance to its cluster's mean. When sorted, each cluster is a run that starts with the nearest.
typedef struct member {
  uint32_t cluster, item;
  float distance2;
} member;

typedef struct group {
  uint32_t first, size;
} group;

static int compare_members(const void *a, const void *b) {
  const member *x = a, *y = b;
  if (x->cluster != y->cluster) return x->cluster < y->cluster ? -1 : 1;
  if (x->distance2 != y->distance2) return x->distance2 < y->distance2 ? -1 : 1;
  return x->item < y->item ? -1 : x->item > y->item;
}

static int compare_groups(const void *a, const void *b) {
  const group *x = a, *y = b;
  if (x->size != y->size) return x->size > y->size ? -1 : 1;
  return x->first < y->first ? -1 : x->first > y->first;
}

typedef struct picker {
  const olx_space *space;
  const olx_cluster_item *items;
  member *members;
  group *groups;
  double (*means)[3];
  uint32_t *cluster_of;
  uint32_t count, clusters;
  olx_candidate *probes;
  uint32_t probe_count;
} picker;

static void sort_members(picker *p) {
  memset(p->means, 0, p->clusters * sizeof *p->means);
  memset(p->groups, 0, p->clusters * sizeof *p->groups);
  for (uint32_t i = 0; i < p->count; i++) {
    double *mean = p->means[p->cluster_of[i]];
    p->groups[p->cluster_of[i]].size++;
    mean[0] += (double)p->items[i].place.x;
    mean[1] += (double)p->items[i].place.y;
    mean[2] += (double)p->items[i].place.z;
  }
  for (uint32_t i = 0; i < p->count; i++) {
    const uint32_t k = p->cluster_of[i];
    const double size = p->groups[k].size;
    const olx_vec3 mean = {(float)(p->means[k][0] / size), (float)(p->means[k][1] / size),
                           (float)(p->means[k][2] / size)};
    const olx_vec3 way = olx_sub(p->items[i].place, mean);
    p->members[i] = (member){k, i, olx_dot(way, way)};
  }
  qsort(p->members, p->count, sizeof *p->members, compare_members);
  for (uint32_t k = 0, first = 0; k < p->clusters; first += p->groups[k++].size) p->groups[k].first = first;
  qsort(p->groups, p->clusters, sizeof *p->groups, compare_groups);
}

static bool keeps_distance(const picker *p, olx_vec3 place) {
  const float least = olx_max(p->space->scene->probe_rules.min_distance, p->space->voxels.size);
  for (uint32_t i = 0; i < p->probe_count; i++) {
    if (olx_length(olx_sub(p->probes[i].place, place)) < least) return false;
  }
  return true;
}

// Picks the member nearest to the mean that may be a probe, if any.
static void pick_member(picker *p, const group *g) {
  for (uint32_t i = g->first, tried = 0; i < g->first + g->size && tried < MEMBERS_TRIED; i++) {
    const olx_vec3 place = p->items[p->members[i].item].place;
    if (!olx_space_allows(p->space, place) || !keeps_distance(p, place)) continue;
    tried++;
    if (olx_space_is_inside_geometry(p->space, place)) continue;
    p->probes[p->probe_count++] = (olx_candidate){place, OLX_ORIGIN_SKELETON};
    return;
  }
}

static olx_result pick(picker *p, uint32_t wanted, uint32_t threads) {
  const olx_probe_rules *rules = &p->space->scene->probe_rules;
  const uint32_t free_probes = wanted > rules->pinned_count ? wanted - rules->pinned_count : 0;
  uint32_t granularity = free_probes;
  for (uint32_t i = 0; i < rules->pinned_count; i++) {
    p->probes[i] = (olx_candidate){rules->pinned[i], OLX_ORIGIN_PINNED};
  }
  p->probe_count = rules->pinned_count;
  if (wanted && free_probes == 0) return OLX_OK;
  for (uint32_t round = 0; round < GRANULARITIES; round++) {
    p->probe_count = rules->pinned_count;
    OLX_TRY(olx_cluster(p->items, p->count, granularity, threads, p->cluster_of, &p->clusters));
    sort_members(p);
    for (uint32_t k = 0; k < p->clusters && (wanted == 0 || p->probe_count < wanted); k++) {
      if (p->groups[k].size * (double)p->clusters < OLX_CLUSTER_LEAST * p->count) break;
      pick_member(p, &p->groups[k]);
    }
    if (wanted == 0 || p->probe_count >= wanted || p->clusters < granularity) break;
    granularity += wanted - p->probe_count;
  }
  return OLX_OK;
}

olx_result olx_place_clusters(const olx_space *space, const olx_cluster_item *items, uint32_t count, uint32_t wanted,
                              uint32_t threads, olx_candidate **probes, uint32_t *probe_count) {
  picker p = {.space = space,
              .items = items,
              .count = count,
              .members = olx_allocate(count, sizeof *p.members),
              .groups = olx_allocate(count, sizeof *p.groups),
              .means = olx_allocate(count, sizeof *p.means),
              .cluster_of = olx_allocate(count, sizeof *p.cluster_of),
              .probes = olx_allocate((size_t)count + space->scene->probe_rules.pinned_count, sizeof *p.probes)};
  olx_result result = OLX_ERROR_MEMORY;
  if (p.members && p.groups && p.means && p.cluster_of && p.probes) result = pick(&p, wanted, threads);
  else olx_fail(result, "place: no memory for %u places", count);
  olx_release(p.members);
  olx_release(p.groups);
  olx_release(p.means);
  olx_release(p.cluster_of);
  *probes = p.probes;
  *probe_count = p.probe_count;
  return result;
}
