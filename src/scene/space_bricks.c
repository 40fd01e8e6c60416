// Divides a scene's bounds into bricks, and finds those that rays cross and boxes touch.
#include "scene/space_bricks.h"

// Triangles count as touching a brick within this share of its side. Rounding of rays and bricks is far below it.
static const float TOUCH = 1e-3f;

olx_space_bricks olx_space_bricks_make(olx_vec3 low, olx_vec3 high) {
  const olx_vec3 extent = olx_sub(high, low);
  const float least = 1e-6f * olx_max(olx_max3(extent), 1e-12f); // flat scenes have bricks, too
  olx_space_bricks b = {.low = low, .high = high, .side = olx_max_each(extent, olx_splat(least)), .count = {1, 1, 1}};
  for (uint32_t bricks = 1; bricks < OLX_SPACE_BRICKS; bricks *= 2) {
    float *const sides[] = {&b.side.x, &b.side.y, &b.side.z};
    uint32_t longest = 0;
    for (uint32_t i = 1; i < 3; i++) {
      if (*sides[i] > *sides[longest]) longest = i;
    }
    *sides[longest] *= 0.5f;
    b.count[longest] *= 2;
  }
  return b;
}

// The way of a ray along one axis.
typedef struct axis_walk {
  int32_t at, step, count; // brick, its change, and number of bricks
  float next, delta;       // where the ray enters the next brick, and the length between two
} axis_walk;

// Limits a range of a ray to the bricks along one axis; returns false when nothing is left.
static bool clip(float origin, float direction, float low, float high, float margin, float range[2]) {
  if (direction == 0.0f) return origin >= low - margin && origin <= high + margin;
  const float a = (low - margin - origin) / direction, b = (high + margin - origin) / direction;
  range[0] = olx_max(range[0], olx_min(a, b));
  range[1] = olx_min(range[1], olx_max(a, b));
  return range[0] <= range[1] && range[0] < INFINITY;
}

static axis_walk begin_walk(float origin, float direction, float from, float low, float side, uint32_t count) {
  const float at = floorf(((origin + direction * from) - low) / side);
  axis_walk w = {.at = (int32_t)olx_clamp(at, 0.0f, (float)count - 1.0f), .count = (int32_t)count, .next = INFINITY};
  if (direction == 0.0f) return w;
  w.step = direction > 0.0f ? 1 : -1;
  w.next = (low + side * (float)(w.at + (w.step > 0)) - origin) / direction;
  w.delta = side / fabsf(direction);
  return w;
}

static void add_brick(const axis_walk walks[3], olx_brick_set *set) {
  const uint32_t brick = (uint32_t)((walks[2].at * walks[1].count + walks[1].at) * walks[0].count + walks[0].at);
  set->words[brick / 64] |= UINT64_C(1) << brick % 64;
}

// Returns the number of the brick in which a point lies, or OLX_SPACE_BRICKS outside.
static uint32_t brick_of(const olx_space_bricks *b, olx_vec3 point) {
  const olx_vec3 way = olx_sub(point, b->low);
  const float x = way.x / b->side.x, y = way.y / b->side.y, z = way.z / b->side.z;
  if (!(x >= 0.0f && y >= 0.0f && z >= 0.0f)) return OLX_SPACE_BRICKS;
  if (!(x < (float)b->count[0] && y < (float)b->count[1] && z < (float)b->count[2])) return OLX_SPACE_BRICKS;
  return olx_space_brick(b, (uint32_t)x, (uint32_t)y, (uint32_t)z);
}

void olx_space_bricks_cross(const olx_space_bricks *b, olx_vec3 origin, olx_vec3 direction, float t_max,
                            olx_brick_set *crossed) {
  const uint32_t first = brick_of(b, origin);
  if (first < OLX_SPACE_BRICKS && first == brick_of(b, olx_madd(origin, direction, t_max))) { // most rays are short
    crossed->words[first / 64] |= UINT64_C(1) << first % 64;
    return;
  }
  float range[2] = {0.0f, t_max};
  if (!clip(origin.x, direction.x, b->low.x, b->high.x, TOUCH * b->side.x, range) ||
      !clip(origin.y, direction.y, b->low.y, b->high.y, TOUCH * b->side.y, range) ||
      !clip(origin.z, direction.z, b->low.z, b->high.z, TOUCH * b->side.z, range)) {
    return;
  }
  axis_walk walks[3] = {begin_walk(origin.x, direction.x, range[0], b->low.x, b->side.x, b->count[0]),
                        begin_walk(origin.y, direction.y, range[0], b->low.y, b->side.y, b->count[1]),
                        begin_walk(origin.z, direction.z, range[0], b->low.z, b->side.z, b->count[2])};
  for (;;) {
    add_brick(walks, crossed);
    axis_walk *nearest = walks[0].next <= walks[1].next ? &walks[0] : &walks[1];
    if (walks[2].next < nearest->next) nearest = &walks[2];
    if (!(nearest->next <= range[1]) || nearest->step == 0) return;
    nearest->at += nearest->step;
    if (nearest->at < 0 || nearest->at >= nearest->count) return;
    nearest->next += nearest->delta;
  }
}

static uint32_t brick_at(float position, float low, float side, uint32_t count) {
  return (uint32_t)olx_clamp(floorf((position - low) / side), 0.0f, (float)count - 1.0f);
}

olx_brick_range olx_space_bricks_near(const olx_space_bricks *b, olx_vec3 low, olx_vec3 high) {
  low = olx_madd(low, b->side, -TOUCH);
  high = olx_madd(high, b->side, TOUCH);
  return (olx_brick_range){
      .first = {brick_at(low.x, b->low.x, b->side.x, b->count[0]), brick_at(low.y, b->low.y, b->side.y, b->count[1]),
                brick_at(low.z, b->low.z, b->side.z, b->count[2])},
      .last = {brick_at(high.x, b->low.x, b->side.x, b->count[0]), brick_at(high.y, b->low.y, b->side.y, b->count[1]),
               brick_at(high.z, b->low.z, b->side.z, b->count[2])}};
}
