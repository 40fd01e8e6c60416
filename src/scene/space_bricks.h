// Bricks: a scene's bounds divided into a fixed number of boxes. What a ray finds depends only on geometry in the
// bricks that it crosses, so that after an edit of geometry elsewhere it finds the same.
#ifndef OLX_SCENE_SPACE_BRICKS_H
#define OLX_SCENE_SPACE_BRICKS_H

#include "scene/scene_data.h"

enum { OLX_BRICK_WORDS = 4, OLX_SPACE_BRICKS = 64 * OLX_BRICK_WORDS };

// A set of bricks, one bit each.
typedef struct olx_brick_set {
  uint64_t words[OLX_BRICK_WORDS];
} olx_brick_set;

typedef struct olx_space_bricks {
  olx_vec3 low, high; // corners of all bricks, metres
  olx_vec3 side;      // of a brick, metres
  olx_vec3 per_side;  // 1 / side
  uint32_t count[3];  // powers of two whose product is OLX_SPACE_BRICKS
} olx_space_bricks;

// Divides a box so that bricks are as close to cubes as halving allows.
olx_space_bricks olx_space_bricks_make(olx_vec3 low, olx_vec3 high);

// Adds the bricks that a ray crosses from its origin to `t_max`, in lengths of `direction`; t_max may be INFINITY.
// Where rounding decides between two bricks, either is added: bricks overlap by far more (olx_space_bricks_near).
void olx_space_bricks_cross(const olx_space_bricks *bricks, olx_vec3 origin, olx_vec3 direction, float t_max,
                            olx_brick_set *crossed);

// A range of bricks, by their places along the axes.
typedef struct olx_brick_range {
  uint32_t first[3], last[3];
} olx_brick_range;

// Returns the bricks that a box touches or comes within a thousandth of their side.
olx_brick_range olx_space_bricks_near(const olx_space_bricks *bricks, olx_vec3 low, olx_vec3 high);

static inline uint32_t olx_space_brick(const olx_space_bricks *bricks, uint32_t x, uint32_t y, uint32_t z) {
  return (z * bricks->count[1] + y) * bricks->count[0] + x;
}

static inline bool olx_brick_sets_meet(const olx_brick_set *a, const olx_brick_set *b) {
  uint64_t both = 0;
  for (uint32_t i = 0; i < OLX_BRICK_WORDS; i++) both |= a->words[i] & b->words[i];
  return both != 0;
}

// A record of the bricks that rays cross.
typedef struct olx_ray_log {
  olx_space_bricks bricks;
  olx_brick_set crossed;
} olx_ray_log;

static inline void olx_ray_log_add(olx_ray_log *log, olx_vec3 origin, olx_vec3 direction, float t_max) {
  olx_space_bricks_cross(&log->bricks, origin, direction, t_max, &log->crossed);
}

#endif
