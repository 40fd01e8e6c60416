// The one-texel border of working maps.
#ifndef OLX_BAKE_BORDER_H
#define OLX_BAKE_BORDER_H

#include "core/octahedral.h"

#include <string.h>

// Fills a map's border with the texels that it repeats. A texel has `size_bytes` bytes.
static inline void olx_fill_border(void *map, uint32_t n, size_t size_bytes) {
  const int32_t side = (int32_t)n, stride = side + 2;
  char *texels = map;
  for (int32_t i = -1; i <= side; i++) {
    const int32_t edge[4][2] = {{i, -1}, {i, side}, {-1, i}, {side, i}};
    for (uint32_t e = 0; e < 4; e++) {
      int32_t x, y;
      olx_border_source(edge[e][0], edge[e][1], side, &x, &y);
      memcpy(texels + (size_t)((edge[e][1] + 1) * stride + edge[e][0] + 1) * size_bytes,
             texels + (size_t)((y + 1) * stride + x + 1) * size_bytes, size_bytes);
    }
  }
}

#endif
