// Lays voxels over a box, floods the connected free ones, and clips rays to them.
#include "place/space/voxels.h"

#include "core/hooks.h"

#define MAX_VOXELS ((size_t)1 << 23)

void olx_voxels_fit(olx_box box, uint32_t resolution, olx_voxels *v) {
  const olx_vec3 span = olx_sub(box.max, box.min);
  const float extent[3] = {span.x, span.y, span.z};
  const float longest = olx_max(extent[0], olx_max(extent[1], extent[2]));
  v->low = box.min;
  for (uint32_t n = resolution;; n--) {
    v->size = longest / (float)n;
    v->total = 1;
    for (int i = 0; i < 3; i++) {
      const float cells = ceilf(extent[i] / v->size * (1.0f - 1e-5f));
      v->count[i] = cells < 1.0f ? 1u : (uint32_t)cells;
      v->total *= v->count[i];
    }
    if (v->total <= MAX_VOXELS || n == 1) return;
  }
}

void olx_voxels_free(olx_voxels *voxels) {
  olx_release(voxels->solid);
  olx_release(voxels->distance);
  voxels->solid = NULL;
  voxels->distance = NULL;
}

size_t olx_voxels_flood(const olx_voxels *v, size_t seed, uint32_t label, uint32_t *labels, size_t *stack) {
  size_t used = 0, found = 0;
  if (labels[seed] != 0) return 0;
  labels[seed] = label;
  stack[used++] = seed;
  const size_t stride[3] = {1, v->count[0], (size_t)v->count[0] * v->count[1]};
  while (used > 0) {
    const size_t index = stack[--used];
    uint32_t c[3];
    olx_voxel_coordinates(v, index, c);
    found++;
    for (int axis = 0; axis < 3; axis++) {
      if (c[axis] > 0 && labels[index - stride[axis]] == 0) {
        labels[index - stride[axis]] = label;
        stack[used++] = index - stride[axis];
      }
      if (c[axis] + 1 < v->count[axis] && labels[index + stride[axis]] == 0) {
        labels[index + stride[axis]] = label;
        stack[used++] = index + stride[axis];
      }
    }
  }
  return found;
}

bool olx_voxels_clip(const olx_voxels *v, olx_vec3 origin, olx_vec3 direction, float *enter, float *leave) {
  const float o[3] = {origin.x, origin.y, origin.z}, d[3] = {direction.x, direction.y, direction.z};
  const float low[3] = {v->low.x, v->low.y, v->low.z};
  for (int i = 0; i < 3; i++) {
    const float high = low[i] + v->size * (float)v->count[i];
    if (d[i] == 0.0f) {
      if (o[i] < low[i] || o[i] > high) return false;
      continue;
    }
    const float a = (low[i] - o[i]) / d[i], b = (high - o[i]) / d[i];
    *enter = olx_max(*enter, olx_min(a, b));
    *leave = olx_min(*leave, olx_max(a, b));
  }
  return *enter < *leave;
}
