// Builds the pyramids over a probe's distances: the smallest and the largest distance in squares of texels, level above
// level, in tiles that keep the children of a node together.
#include "field/pyramid.h"

olx_pyramid_shape olx_pyramid_shape_of(uint32_t n, bool over_blocks) {
  olx_pyramid_shape shape = {.levels = 1};
  while (shape.levels < OLX_PYRAMID_MAX_LEVELS && 4u << olx_pyramid_shift(shape.levels) <= n) shape.levels++;
  shape.greatest_level = shape.levels > 1 ? 1 : 0;
  shape.least_level = over_blocks ? shape.greatest_level : 0;
  for (uint32_t level = shape.levels; level-- > 0;) {
    shape.side[level] = n >> olx_pyramid_shift(level);
    shape.first[level] = shape.least_nodes;
    if (level >= shape.greatest_level) shape.greatest_nodes += shape.side[level] * shape.side[level];
    if (level >= shape.least_level) shape.least_nodes += shape.side[level] * shape.side[level];
  }
  return shape;
}

// Returns the smaller or the larger of two half floats. Without their sign, half floats are ordered as integers are.
typedef uint16_t (*choice)(uint16_t a, uint16_t b);
static uint16_t smaller(uint16_t a, uint16_t b) { return a < b ? a : b; }
static uint16_t larger(uint16_t a, uint16_t b) { return a > b ? a : b; }

static inline uint16_t of_squares(const uint16_t *squares, uint32_t stride, uint32_t shift, uint32_t x, uint32_t y,
                                  choice choose) {
  const uint16_t *row = squares + ((size_t)y << shift) * stride + ((size_t)x << shift);
  uint16_t chosen = row[0] & 0x7FFFu;
  for (uint32_t j = 0; j < 1u << shift; j++, row += stride) {
    for (uint32_t i = 0; i < 1u << shift; i++) chosen = choose(chosen, row[i] & 0x7FFFu);
  }
  return chosen;
}

static inline uint16_t of_nodes(const olx_pyramid_shape *shape, const uint16_t *nodes, uint32_t level, uint32_t x,
                                uint32_t y, choice choose) {
  // The children of a node lie together in one tile, because the level below has at least four nodes a side.
  const uint16_t *below = nodes + shape->first[level - 1] +
                          olx_pyramid_index(shape->side[level - 1], x << OLX_PYRAMID_STEP, y << OLX_PYRAMID_STEP);
  uint16_t chosen = below[0];
  for (uint32_t i = 1; i < 1u << 2 * OLX_PYRAMID_STEP; i++) chosen = choose(chosen, below[i]);
  return chosen;
}

uint16_t olx_pyramid_least(const olx_pyramid_shape *shape, const olx_pyramid_base *base, const uint16_t *nodes,
                           uint32_t level, uint32_t x, uint32_t y) {
  if (level != shape->least_level) return of_nodes(shape, nodes, level, x, y, smaller);
  return of_squares(base->least, base->stride, olx_pyramid_shift(level) - base->shift, x, y, smaller);
}

uint16_t olx_pyramid_greatest(const olx_pyramid_shape *shape, const olx_pyramid_base *base, const uint16_t *nodes,
                              uint32_t level, uint32_t x, uint32_t y) {
  if (level != shape->greatest_level) return of_nodes(shape, nodes, level, x, y, larger);
  return of_squares(base->greatest, base->stride, olx_pyramid_shift(level) - base->shift, x, y, larger);
}

void olx_pyramid_make(const olx_pyramid_shape *shape, const olx_pyramid_base *base, uint16_t *least,
                      uint16_t *greatest) {
  for (uint32_t level = shape->least_level; level < shape->levels; level++) {
    const uint32_t side = shape->side[level];
    for (uint32_t y = 0; y < side; y++) {
      for (uint32_t x = 0; x < side; x++) {
        const uint32_t at = shape->first[level] + olx_pyramid_index(side, x, y);
        least[at] = olx_pyramid_least(shape, base, least, level, x, y);
        if (level < shape->greatest_level) continue;
        greatest[at] = olx_pyramid_greatest(shape, base, greatest, level, x, y);
      }
    }
  }
}
