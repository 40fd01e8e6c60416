// Finds the medial axis of free space by shrinking balls (Ma et al. 2012): for each surfel the largest ball that
// touches it and contains no other surfel.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "place/skeleton/skeleton.h"
#include "scene/bvh.h"

#include <stdlib.h>
#include <string.h>

#define LEAST_ANGLE_COSINE 0.5f // of 60 degrees, between the directions from the centre to both surfels
#define DEEPEST 0.03f           // share of the radius by which a surface may enter a ball
enum { MOST_SHRINKS = 64, BALLS_A_JOB = 64, TREE_DEPTH = 64 };

// A node of a balanced k-d tree in an array: the middle element of each range divides the range, along x, y and z in
// turn.
typedef struct tree_node {
  float at[3];
  uint32_t index;
} tree_node;

static int compare_along(const tree_node *a, const tree_node *b, int axis) {
  if (a->at[axis] != b->at[axis]) return a->at[axis] < b->at[axis] ? -1 : 1;
  return a->index < b->index ? -1 : a->index > b->index;
}
static int compare_x(const void *a, const void *b) { return compare_along(a, b, 0); }
static int compare_y(const void *a, const void *b) { return compare_along(a, b, 1); }
static int compare_z(const void *a, const void *b) { return compare_along(a, b, 2); }

static void build_tree(tree_node *nodes, uint32_t count, int axis) {
  int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
  if (count < 2) return;
  qsort(nodes, count, sizeof *nodes, compare[axis]);
  const uint32_t middle = count / 2;
  build_tree(nodes, middle, (axis + 1) % 3);
  build_tree(nodes + middle + 1, count - middle - 1, (axis + 1) % 3);
}

typedef struct range {
  uint32_t first, count;
  int axis;
  float gap2; // squared distance to the range's side of the dividing plane
} range;

// Returns the node nearest to `point` within the distance, except `own`; OLX_NO_HIT when there is none.
static uint32_t find_nearest(const tree_node *nodes, uint32_t count, olx_vec3 point, float within, uint32_t own) {
  const float p[3] = {point.x, point.y, point.z};
  range stack[TREE_DEPTH] = {{0, count, 0, 0.0f}};
  uint32_t used = 1, nearest = OLX_NO_HIT;
  float least = within * within;
  while (used > 0) {
    const range r = stack[--used];
    if (r.count == 0 || r.gap2 >= least) continue;
    const uint32_t middle = r.count / 2;
    const tree_node *n = &nodes[r.first + middle];
    const float d = olx_square(n->at[0] - p[0]) + olx_square(n->at[1] - p[1]) + olx_square(n->at[2] - p[2]);
    if (d < least && n->index != own) {
      least = d;
      nearest = n->index;
    }
    const float gap = p[r.axis] - n->at[r.axis];
    const int next = (r.axis + 1) % 3;
    const range low = {r.first, middle, next, gap > 0.0f ? gap * gap : 0.0f};
    const range high = {r.first + middle + 1, r.count - middle - 1, next, gap > 0.0f ? 0.0f : gap * gap};
    stack[used++] = gap > 0.0f ? low : high;
    stack[used++] = gap > 0.0f ? high : low;
  }
  return nearest;
}

typedef struct shrinker {
  const olx_space *space;
  const olx_surfels *surfels;
  tree_node *nodes;
  olx_medial_ball *balls; // radius 0: no ball
  float largest;
} shrinker;

static bool is_medial(const shrinker *s, const olx_medial_ball *ball, olx_vec3 first) {
  const olx_vec3 a = olx_normalize(olx_sub(first, ball->centre)), b = olx_normalize(olx_sub(ball->other, ball->centre));
  if (olx_dot(a, b) > LEAST_ANGLE_COSINE) return false;
  const float least = (1.0f - DEEPEST) * ball->radius;
  return olx_bvh_distance(s->space->scene->bvh, ball->centre, ball->radius) >= least;
}

static olx_medial_ball shrink(const shrinker *s, uint32_t index) {
  const olx_surfel *p = &s->surfels->items[index];
  const olx_ray ray = {p->position, p->normal, 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(s->space->scene->bvh, &ray);
  const bool faced = hit.triangle != OLX_NO_HIT && 0.5f * hit.t < s->largest;
  olx_medial_ball ball = {.radius = faced ? 0.5f * hit.t : s->largest, .normal = p->normal};
  bool touches = faced;
  ball.other = olx_madd(p->position, p->normal, 2.0f * ball.radius);
  for (uint32_t i = 0; i < MOST_SHRINKS; i++) {
    ball.centre = olx_madd(p->position, p->normal, ball.radius);
    const uint32_t q = find_nearest(s->nodes, s->surfels->count, ball.centre, 0.9999f * ball.radius, index);
    if (q == OLX_NO_HIT) break;
    const olx_vec3 way = olx_sub(s->surfels->items[q].position, p->position);
    const float along = olx_dot(way, p->normal);
    if (!(along > 0.0f)) break;
    ball.radius = olx_min(olx_dot(way, way) / (2.0f * along), 0.9999f * ball.radius);
    ball.other = s->surfels->items[q].position;
    ball.centre = olx_madd(p->position, p->normal, ball.radius);
    touches = true;
  }
  if (!touches || !is_medial(s, &ball, p->position)) ball.radius = 0.0f;
  return ball;
}

static void shrink_job(void *user, uint32_t index) {
  const shrinker *s = user;
  const uint32_t first = index * BALLS_A_JOB;
  for (uint32_t i = first; i < first + BALLS_A_JOB && i < s->surfels->count; i++) s->balls[i] = shrink(s, i);
}

olx_result olx_medial_balls(const olx_space *space, const olx_surfels *surfels, uint32_t threads,
                            olx_medial_ball **balls, uint32_t *count) {
  const olx_scene *scene = space->scene;
  shrinker s = {.space = space,
                .surfels = surfels,
                .nodes = olx_allocate(surfels->count, sizeof *s.nodes),
                .balls = olx_allocate(surfels->count, sizeof *s.balls),
                .largest = 0.5f * olx_length(olx_sub(scene->bounds_max, scene->bounds_min))};
  olx_result result = OLX_ERROR_MEMORY;
  *count = 0;
  if (s.nodes && s.balls) {
    for (uint32_t i = 0; i < surfels->count; i++) {
      const olx_vec3 p = surfels->items[i].position;
      s.nodes[i] = (tree_node){{p.x, p.y, p.z}, i};
    }
    build_tree(s.nodes, surfels->count, 0);
    result = olx_parallel_for((surfels->count + BALLS_A_JOB - 1) / BALLS_A_JOB, threads, shrink_job, &s, NULL, 0);
  } else {
    olx_fail(result, "place: no memory for %u balls", surfels->count);
  }
  for (uint32_t i = 0; result == OLX_OK && i < surfels->count; i++) {
    if (s.balls[i].radius > 0.0f) s.balls[(*count)++] = s.balls[i];
  }
  olx_release(s.nodes);
  if (result != OLX_OK) {
    olx_release(s.balls);
    s.balls = NULL;
  }
  *balls = s.balls;
  return result;
}

olx_result olx_area_balls(const olx_space *space, const olx_sight *sight, const olx_place_settings *settings,
                          olx_medial_ball **balls, uint32_t *count) {
  olx_surfels surfels;
  OLX_TRY(olx_surfels_create(space, sight, OLX_SPREAD_AREA, settings->surfels, settings->seed, settings->threads,
                             &surfels));
  const olx_result result = olx_medial_balls(space, &surfels, settings->threads, balls, count);
  olx_surfels_free(&surfels);
  return result;
}
