// Finds the texels of a bordered map that a bilinear filter reads. Coordinates are in texels of the map without border.
// Its twin is shaders/lib/bilinear.glsl.
#ifndef OLX_FIELD_BILINEAR_H
#define OLX_FIELD_BILINEAR_H

#include "core/vec.h"

#include <stddef.h>

static inline size_t olx_map_index(uint32_t stride, int32_t x, int32_t y) {
  return (size_t)(y + 1) * stride + (size_t)(x + 1);
}

// The four texels around a point of a bordered map and their bilinear weights.
typedef struct olx_bilinear {
  size_t index[4];
  float weight[4];
} olx_bilinear;

static inline olx_bilinear olx_bilinear_at(olx_vec2 uv, uint32_t n) {
  const float x = uv.x * (float)n - 0.5f, y = uv.y * (float)n - 0.5f;
  const float limit = (float)n - 1.0f;
  const float x0 = olx_clamp(floorf(x), -1.0f, limit), y0 = olx_clamp(floorf(y), -1.0f, limit);
  const float fx = olx_clamp(x - x0, 0.0f, 1.0f), fy = olx_clamp(y - y0, 0.0f, 1.0f);
  const size_t first = olx_map_index(n + 2, (int32_t)x0, (int32_t)y0);
  return (olx_bilinear){
      .index = {first, first + 1, first + n + 2, first + n + 3},
      .weight = {(1.0f - fx) * (1.0f - fy), fx * (1.0f - fy), (1.0f - fx) * fy, fx * fy},
  };
}

#endif
