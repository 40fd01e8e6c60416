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
  b.per_side = olx_v3(1.0f / b.side.x, 1.0f / b.side.y, 1.0f / b.side.z);
  return b;
}

// Returns a place in units of a brick's sides, counted from the lowest corner of all bricks.
static olx_vec3 in_bricks(const olx_space_bricks *b, olx_vec3 point) {
  return olx_mul(olx_sub(point, b->low), b->per_side);
}

// Returns the number of the brick in which a place lies, or OLX_SPACE_BRICKS outside.
static uint32_t brick_of(const olx_space_bricks *b, olx_vec3 at) {
  if (!(at.x >= 0.0f && at.y >= 0.0f && at.z >= 0.0f)) return OLX_SPACE_BRICKS;
  if (!(at.x < (float)b->count[0] && at.y < (float)b->count[1] && at.z < (float)b->count[2])) return OLX_SPACE_BRICKS;
  return olx_space_brick(b, (uint32_t)at.x, (uint32_t)at.y, (uint32_t)at.z);
}

static void add_brick(uint32_t brick, olx_brick_set *set) { set->words[brick / 64] |= UINT64_C(1) << brick % 64; }

// The way of a ray along one axis, in units of bricks.
typedef struct axis_walk {
  float origin, direction, inverse; // inverse: of direction
  int32_t left, step;               // bricks ahead until the last, and what one more adds to a brick's number
  float next, delta;                // where the ray enters the next brick, and the length between two
} axis_walk;

// Prepares the way along an axis. A ray that hardly moves along it, so that its direction cannot be inverted, counts as
// standing still there.
static axis_walk axis_of(float origin, float direction) {
  if (fabsf(direction) < 1e-30f) return (axis_walk){.origin = origin};
  return (axis_walk){.origin = origin, .direction = direction, .inverse = 1.0f / direction};
}

// Limits a range of a ray to the bricks along one axis; returns false when nothing is left.
static bool clip(const axis_walk *w, uint32_t count, float range[2]) {
  if (w->direction == 0.0f) return w->origin >= -TOUCH && w->origin <= (float)count + TOUCH;
  const float a = (-TOUCH - w->origin) * w->inverse, b = ((float)count + TOUCH - w->origin) * w->inverse;
  range[0] = olx_max(range[0], olx_min(a, b));
  range[1] = olx_min(range[1], olx_max(a, b));
  return range[0] <= range[1] && range[0] < INFINITY;
}

// Begins the way of a ray that enters the bricks at `from`; returns the brick there along this axis. `stride` is what
// the next brick along it adds to the number of a brick.
static uint32_t begin_walk(axis_walk *w, float from, uint32_t count, uint32_t stride) {
  const int32_t at = (int32_t)olx_clamp(w->origin + w->direction * from, 0.0f, (float)count - 1.0f);
  w->next = INFINITY;
  if (w->direction == 0.0f) return (uint32_t)at;
  const bool ahead = w->direction > 0.0f;
  w->left = ahead ? (int32_t)count - 1 - at : at;
  w->step = ahead ? (int32_t)stride : -(int32_t)stride;
  w->next = ((float)(at + ahead) - w->origin) * w->inverse;
  w->delta = fabsf(w->inverse);
  return (uint32_t)at;
}

void olx_space_bricks_cross(const olx_space_bricks *b, olx_vec3 origin, olx_vec3 direction, float t_max,
                            olx_brick_set *crossed) {
  const olx_vec3 o = in_bricks(b, origin), d = olx_mul(direction, b->per_side);
  const uint32_t first = brick_of(b, o);
  if (first < OLX_SPACE_BRICKS && first == brick_of(b, olx_madd(o, d, t_max))) { // most rays are short
    add_brick(first, crossed);
    return;
  }
  axis_walk x = axis_of(o.x, d.x), y = axis_of(o.y, d.y), z = axis_of(o.z, d.z);
  float range[2] = {0.0f, t_max};
  if (!clip(&x, b->count[0], range) || !clip(&y, b->count[1], range) || !clip(&z, b->count[2], range)) return;
  const uint32_t row = b->count[0], layer = row * b->count[1];
  uint32_t brick = begin_walk(&x, range[0], b->count[0], 1);
  brick += row * begin_walk(&y, range[0], b->count[1], row);
  brick += layer * begin_walk(&z, range[0], b->count[2], layer);
  for (;;) {
    add_brick(brick, crossed);
    axis_walk *nearest = x.next <= y.next ? &x : &y;
    if (z.next < nearest->next) nearest = &z;
    if (!(nearest->next <= range[1]) || nearest->left-- == 0) return;
    brick += (uint32_t)nearest->step;
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
