// Checks whether placed probes are where they should be, without anything that placement itself uses.
//
//   placement-check [--ball METRES] SCENE RAYS PROBES.json...
//
// A ball of that radius, by default 1/800 of the scene's diagonal, is moved over a lattice in the box of playable space
// (without one, the scene's bounds) wherever it touches no surface, by exact distances to triangles. It starts at the
// cameras, or at what a camera outside the box sees of its inside. Steps are at most its diameter, so that it cannot
// jump over a surface. The result is printed as one JSON object per file of probes, each on a line:
//   reached share of probes next to which the ball can be, with nothing between
//   nearest       the least distance of a probe to a surface, in diagonals
//   closest       the least distance of two probes, in diagonals
//   back          the largest share of directions, of 4096, in which a probe sees the back of a triangle first
//   sky           the largest share in which a probe sees nothing
//   outside       probes outside the box of playable space, or, without one, outside the bounds
//   covered       share of rays, from where the ball can be in any direction, that end where a probe sees it, with a
//                 cosine of at least 0.02
//   coverable     of the rays that no probe sees, none of 400 places of the ball does either: 1 less their share
// Without a camera the ball starts at the first probe of the first file.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/sampling.h"
#include "options.h"
#include "scene/bvh.h"
#include "scene/surface.h"
#include "studies.h"

#include <octalux/place.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = BENCH_PROGRAM " placement-check";

enum { NODES_ALONG_DIAGONAL = 400, BACK_RAYS = 4096, PLACES = 400, FAR_LOOKS = 1 << 17, NODES_A_JOB = 512 };
enum { UNKNOWN, FREE, BLOCKED };
#define LEAST_COSINE 0.02f

typedef struct lattice {
  const olx_scene *scene;
  olx_vec3 low;
  float step, clearance, diagonal;
  uint32_t count[3];
  uint8_t *state;
  uint32_t *front, *next, front_count, next_count;
} lattice;

static void *take(size_t count, size_t size) {
  void *memory = olx_allocate_zero(count, size);
  if (memory) return memory;
  exit(failure(NAME, "out of memory"));
}

static void must(olx_result result) {
  if (result != OLX_OK) exit(library_failure(NAME));
}

static olx_vec3 node_place(const lattice *l, uint32_t node) {
  const olx_vec3 c = {(float)(node % l->count[0]), (float)(node / l->count[0] % l->count[1]),
                      (float)(node / l->count[0] / l->count[1])};
  return olx_madd(l->low, c, l->step);
}

static bool box_holds(const olx_box *box, olx_vec3 p, float slack) {
  return p.x >= box->min.x - slack && p.y >= box->min.y - slack && p.z >= box->min.z - slack &&
         p.x <= box->max.x + slack && p.y <= box->max.y + slack && p.z <= box->max.z + slack;
}

static uint32_t pick(uint32_t key, uint32_t count) { return (uint32_t)(((uint64_t)olx_hash(key) * count) >> 32); }

// Fits the lattice to the box.
static void start_lattice(const olx_scene *scene, const olx_box *box, float ball, lattice *l) {
  const olx_vec3 extent = olx_sub(box->max, box->min);
  const float along[3] = {extent.x, extent.y, extent.z};
  size_t total = 1;
  l->scene = scene;
  l->diagonal = olx_length(olx_sub(scene->bounds_max, scene->bounds_min));
  l->step = ball > 0.0f ? 2.0f * ball : l->diagonal / NODES_ALONG_DIAGONAL;
  l->clearance = 0.5f * l->step;
  l->low = olx_add(box->min, olx_splat(0.25f * l->step));
  for (int i = 0; i < 3; i++) total *= l->count[i] = (uint32_t)(olx_max(along[i] / l->step - 0.25f, 0.0f)) + 1;
  l->state = take(total, 1);
  l->front = take(total, sizeof *l->front);
  l->next = take(total, sizeof *l->next);
}

// Finds the nodes of the lattice around a position, up to `reach` steps away along each axis.
static uint32_t nodes_around(const lattice *l, olx_vec3 place, int32_t reach, uint32_t *nodes) {
  const olx_vec3 q = olx_scale(olx_sub(place, l->low), 1.0f / l->step);
  const int32_t at[3] = {(int32_t)floorf(q.x + 0.5f), (int32_t)floorf(q.y + 0.5f), (int32_t)floorf(q.z + 0.5f)};
  uint32_t used = 0;
  for (int32_t z = at[2] - reach; z <= at[2] + reach; z++) {
    for (int32_t y = at[1] - reach; y <= at[1] + reach; y++) {
      for (int32_t x = at[0] - reach; x <= at[0] + reach; x++) {
        if (x < 0 || y < 0 || z < 0 || x >= (int32_t)l->count[0] || y >= (int32_t)l->count[1] ||
            z >= (int32_t)l->count[2]) {
          continue;
        }
        nodes[used++] = (uint32_t)x + l->count[0] * ((uint32_t)y + l->count[1] * (uint32_t)z);
      }
    }
  }
  return used;
}

enum { REACH = 3, AROUND = (2 * REACH + 1) * (2 * REACH + 1) * (2 * REACH + 1) };

static void enter_node(lattice *l, olx_vec3 from, uint32_t node) {
  if (l->state[node] != UNKNOWN || !olx_bvh_is_clear(l->scene->bvh, from, node_place(l, node))) return;
  l->state[node] = BLOCKED; // blocked until the node is tested, which happens once
  l->next[l->next_count++] = node;
}

// Starts the flood at nodes that a position sees nearby or, from outside the box, anywhere.
static void enter_at(lattice *l, const olx_box *box, olx_vec3 place) {
  uint32_t nodes[AROUND];
  const uint32_t count = box_holds(box, place, 0.0f) ? nodes_around(l, place, REACH, nodes) : 0;
  const uint32_t total = l->count[0] * l->count[1] * l->count[2];
  for (uint32_t i = 0; i < count; i++) enter_node(l, place, nodes[i]);
  for (uint32_t i = 0; count == 0 && i < FAR_LOOKS; i++) enter_node(l, place, pick(i, total));
}

static void free_job(void *user, uint32_t index) {
  const lattice *l = user;
  const uint32_t first = index * NODES_A_JOB;
  for (uint32_t i = first; i < first + NODES_A_JOB && i < l->next_count; i++) {
    const float distance = olx_bvh_distance(l->scene->bvh, node_place(l, l->next[i]), l->clearance);
    l->state[l->next[i]] = distance >= l->clearance ? FREE : BLOCKED;
  }
}

static void add_neighbours(lattice *l, uint32_t node) {
  const uint32_t c[3] = {node % l->count[0], node / l->count[0] % l->count[1], node / l->count[0] / l->count[1]};
  const uint32_t stride[3] = {1, l->count[0], l->count[0] * l->count[1]};
  for (int axis = 0; axis < 3; axis++) {
    const uint32_t both[2] = {c[axis] > 0 ? node - stride[axis] : node,
                              c[axis] + 1 < l->count[axis] ? node + stride[axis] : node};
    for (int k = 0; k < 2; k++) {
      if (l->state[both[k]] != UNKNOWN) continue;
      l->state[both[k]] = BLOCKED; // blocked until the node is tested, which happens once
      l->next[l->next_count++] = both[k];
    }
  }
}

// Floods in waves, whose new nodes are tested together.
static void flood(lattice *l) {
  while (l->next_count > 0) {
    must(olx_parallel_for((l->next_count + NODES_A_JOB - 1) / NODES_A_JOB, 0, free_job, l, NULL, 0));
    l->front_count = 0;
    for (uint32_t i = 0; i < l->next_count; i++) {
      if (l->state[l->next[i]] == FREE) l->front[l->front_count++] = l->next[i];
    }
    l->next_count = 0;
    for (uint32_t i = 0; i < l->front_count; i++) add_neighbours(l, l->front[i]);
  }
}

static bool is_reached(const lattice *l, olx_vec3 place) {
  uint32_t nodes[AROUND];
  const uint32_t count = nodes_around(l, place, REACH, nodes);
  for (uint32_t i = 0; i < count; i++) {
    if (l->state[nodes[i]] == FREE && olx_bvh_is_clear(l->scene->bvh, place, node_place(l, nodes[i]))) return true;
  }
  return false;
}

static olx_vec3 doubled_area(const olx_scene *scene, uint32_t triangle) {
  const uint32_t *corner = scene->indices + 3 * (size_t)triangle;
  const olx_vec3 a = scene->positions[corner[0]];
  return olx_cross(olx_sub(scene->positions[corner[1]], a), olx_sub(scene->positions[corner[2]], a));
}

static void look_around(const olx_scene *scene, olx_vec3 place, double *back, double *sky) {
  uint32_t backs = 0, misses = 0;
  for (uint32_t i = 0; i < BACK_RAYS; i++) {
    const olx_ray ray = {place, olx_sample_sphere(olx_hammersley(i, BACK_RAYS)), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    misses += hit.triangle == OLX_NO_HIT;
    backs += hit.triangle != OLX_NO_HIT && olx_dot(doubled_area(scene, hit.triangle), ray.direction) > 0.0f;
  }
  *back = (double)backs / BACK_RAYS;
  *sky = (double)misses / BACK_RAYS;
}

typedef struct spots {
  olx_vec3 *places;
  uint32_t count;
} spots;

// Returns the ball's positions that count: within playable space, or the bounds.
static spots list_places(const lattice *l, const olx_box *box) {
  const size_t total = (size_t)l->count[0] * l->count[1] * l->count[2];
  spots s = {.places = take(total, sizeof *s.places)};
  for (size_t i = 0; i < total; i++) {
    const olx_vec3 place = node_place(l, (uint32_t)i);
    if (l->state[i] == FREE && box_holds(box, place, 0.0f)) s.places[s.count++] = place;
  }
  return s;
}

static bool sees_well(const olx_scene *scene, olx_vec3 place, olx_vec3 point, olx_vec3 normal) {
  const olx_vec3 way = olx_sub(place, point);
  return olx_dot(way, normal) >= LEAST_COSINE * olx_length(way) && olx_bvh_is_clear(scene->bvh, place, point);
}

typedef struct coverage_job {
  const olx_scene *scene;
  const olx_probe_set *set;
  const olx_vec3 *sorted; // positions of the probes, sorted by x
  spots from;
  uint8_t *outcome; // per ray: 0 none, 1 covered, 2 could be covered, 3 could not
} coverage_job;

// Tests probes sorted by x, from the nearest to the point outwards on alternating sides.
static bool is_covered(const coverage_job *job, olx_vec3 point, olx_vec3 normal) {
  const olx_vec3 *places = job->sorted;
  uint32_t below = 0, above = job->set->count;
  while (below < above) {
    const uint32_t middle = (below + above) / 2;
    if (places[middle].x < point.x) below = middle + 1;
    else above = middle;
  }
  while (below > 0 || above < job->set->count) {
    if (below > 0 && sees_well(job->scene, places[--below], point, normal)) return true;
    if (above < job->set->count && sees_well(job->scene, places[above++], point, normal)) return true;
  }
  return false;
}

static void cover_job(void *user, uint32_t index) {
  const coverage_job *job = user;
  const olx_scene *scene = job->scene;
  const olx_vec3 start = job->from.places[pick(3 * index + 1, job->from.count)];
  const olx_vec2 random = {olx_unit_float(olx_hash(3 * index + 2)), olx_unit_float(olx_hash(3 * index + 3))};
  const olx_ray ray = {start, olx_sample_sphere(random), 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  if (hit.triangle == OLX_NO_HIT) return;
  olx_vec3 normal = olx_normalize(doubled_area(scene, hit.triangle));
  if (olx_dot(normal, ray.direction) > 0.0f) normal = olx_negate(normal);
  const olx_vec3 point =
      olx_madd(olx_madd(start, ray.direction, hit.t), normal, olx_surface_epsilon(scene, hit.triangle));
  job->outcome[index] = 3;
  if (is_covered(job, point, normal)) {
    job->outcome[index] = 1;
    return;
  }
  if (sees_well(scene, start, point, normal)) job->outcome[index] = 2;
  for (uint32_t i = 0; i < PLACES && job->outcome[index] == 3; i++) {
    const olx_vec3 place = job->from.places[pick(index * PLACES + i, job->from.count)];
    if (sees_well(scene, place, point, normal)) job->outcome[index] = 2;
  }
}

static int compare_x(const void *a, const void *b) {
  const float x = ((const olx_vec3 *)a)->x, y = ((const olx_vec3 *)b)->x;
  return (x > y) - (x < y);
}

static olx_vec3 *sort_places(const olx_probe_set *set) {
  olx_vec3 *places = take(set->count, sizeof *places);
  for (uint32_t i = 0; i < set->count; i++) places[i] = set->probes[i].position;
  qsort(places, set->count, sizeof *places, compare_x);
  return places;
}

static void check_coverage(const lattice *l, const olx_box *box, const olx_probe_set *set, uint32_t rays) {
  olx_vec3 *sorted = sort_places(set);
  coverage_job job = {
      .scene = l->scene, .set = set, .sorted = sorted, .from = list_places(l, box), .outcome = take(rays, 1)};
  uint32_t counts[4] = {0};
  if (job.from.count > 0) must(olx_parallel_for(rays, 0, cover_job, &job, NULL, 0));
  for (uint32_t i = 0; i < rays; i++) counts[job.outcome[i]]++;
  const double all = counts[1] + counts[2] + counts[3];
  printf(", \"places\": %u, \"rays\": %.0f, \"covered\": %.6f, \"coverable\": %.6f", job.from.count, all,
         all > 0.0 ? counts[1] / all : 0.0, all > 0.0 ? 1.0 - counts[3] / all : 0.0);
  olx_release(sorted);
  olx_release(job.from.places);
  olx_release(job.outcome);
}

typedef struct probe_look {
  double back, sky;
} probe_look;

typedef struct look_job {
  const olx_scene *scene;
  const olx_probe_set *set;
  probe_look *looks;
} look_job;

static void look_from_probe(void *user, uint32_t index) {
  const look_job *job = user;
  look_around(job->scene, job->set->probes[index].position, &job->looks[index].back, &job->looks[index].sky);
}

static void check_probes(const lattice *l, const olx_box *box, const olx_probe_set *set) {
  uint32_t reached = 0, outside = 0;
  double worst_back = 0.0, worst_sky = 0.0;
  float nearest = INFINITY, closest = INFINITY;
  look_job job = {l->scene, set, take(set->count, sizeof *job.looks)};
  must(olx_parallel_for(set->count, 0, look_from_probe, &job, NULL, 0));
  for (uint32_t i = 0; i < set->count; i++) {
    const olx_vec3 p = set->probes[i].position;
    worst_back = job.looks[i].back > worst_back ? job.looks[i].back : worst_back;
    worst_sky = job.looks[i].sky > worst_sky ? job.looks[i].sky : worst_sky;
    reached += is_reached(l, p);
    outside += !box_holds(box, p, 1e-5f * l->diagonal);
    nearest = olx_min(nearest, olx_bvh_distance(l->scene->bvh, p, nearest));
    for (uint32_t k = 0; k < i; k++) closest = olx_min(closest, olx_length(olx_sub(p, set->probes[k].position)));
  }
  olx_release(job.looks);
  printf("\"probes\": %u, \"reached\": %.6f, \"nearest\": %.6f, \"closest\": %.6f, \"back\": %.4f, \"sky\": %.4f, "
         "\"outside\": %u",
         set->count, (double)reached / set->count, (double)(nearest / l->diagonal),
         set->count > 1 ? (double)(closest / l->diagonal) : 1.0, worst_back, worst_sky, outside);
}

// Moves the ball everywhere it can reach.
static void explore(lattice *l, const olx_box *box, const char *first_path) {
  const olx_scene *scene = l->scene;
  for (uint32_t i = 0; i < scene->camera_count; i++) enter_at(l, box, scene->cameras[i].eye);
  if (scene->camera_count == 0) {
    olx_probe_set set;
    must(olx_probe_set_load(first_path, scene->origin, &set));
    enter_at(l, box, set.probes[0].position);
    olx_probe_set_free(&set);
  }
  flood(l);
}

static void check_file(const lattice *l, const olx_box *box, const char *path, uint32_t rays) {
  olx_probe_set set;
  must(olx_probe_set_load(path, l->scene->origin, &set));
  putchar('{');
  check_probes(l, box, &set);
  check_coverage(l, box, &set, rays);
  puts("}");
  olx_probe_set_free(&set);
}

static int check(const char *name, int rays, float ball, int count, char **paths) {
  olx_scene *scene = NULL;
  must(olx_scene_load(name, &scene));
  const olx_box bounds = {scene->bounds_min, scene->bounds_max};
  const olx_box *box = scene->probe_rules.has_playable ? &scene->probe_rules.playable : &bounds;
  lattice l = {0};
  start_lattice(scene, box, ball, &l);
  explore(&l, box, paths[0]);
  for (int i = 0; i < count; i++) check_file(&l, box, paths[i], (uint32_t)rays);
  olx_release(l.state);
  olx_release(l.front);
  olx_release(l.next);
  olx_scene_free(scene);
  return 0;
}

int study_placement_check(int argc, char **argv) {
  const bool sized = strcmp(argv[1], "--ball") == 0;
  if (sized && argc < 6) return usage_error(NAME, "--ball METRES is followed by SCENE RAYS PROBES.json...");
  const float ball = sized ? strtof(argv[2], NULL) : 0.0f;
  char **given = argv + (sized ? 3 : 1);
  const int rays = atoi(given[1]);
  if (sized && !(ball > 0.0f)) return usage_error(NAME, "'%s' is not a radius in metres", argv[2]);
  if (rays < 1) return usage_error(NAME, "'%s' is not a number of rays", given[1]);
  return check(given[0], rays, ball, argc - (sized ? 5 : 3), given + 2);
}
