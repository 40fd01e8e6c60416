// Finds the free space that the irradiance volume covers, and decides by rays on which side of a surface a place lies.
#include "bake/volume/volume_space.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/bvh.h"

enum { OUTSIDE = 2 }; // label of voxels

// The voxels around a place, itself first.
typedef struct voxel_range {
  int32_t low[3], high[3];
} voxel_range;

static int32_t voxel_of(float metres, float size, uint32_t count) {
  return (int32_t)olx_clamp(floorf(metres / size), 0.0f, (float)count - 1.0f);
}

static voxel_range range_of(const olx_voxels *v, olx_vec3 low, olx_vec3 high) {
  const olx_vec3 a = olx_sub(low, v->low), b = olx_sub(high, v->low);
  const float from[3] = {a.x, a.y, a.z}, to[3] = {b.x, b.y, b.z};
  voxel_range range;
  for (int axis = 0; axis < 3; axis++) {
    range.low[axis] = voxel_of(from[axis] - v->size, v->size, v->count[axis]);
    range.high[axis] = voxel_of(to[axis] + v->size, v->size, v->count[axis]);
  }
  return range;
}

static size_t voxel_index(const olx_voxels *v, int32_t x, int32_t y, int32_t z) {
  return (size_t)x + v->count[0] * ((size_t)y + v->count[1] * (size_t)z);
}

static bool is_reached(const olx_volume_space *s, size_t voxel) { return s->space.reachable[voxel] & OLX_REACHABLE; }

// Floods from the voxel of a probe or, where surfaces touch that voxel, from a neighbouring one that the probe sees.
static void flood_from(olx_volume_space *s, olx_vec3 position, uint32_t *labels, size_t *stack) {
  const olx_voxels *v = &s->space.voxels;
  if (olx_voxel_at(v, position) == OLX_NO_VOXEL) return;
  const voxel_range around = range_of(v, position, position);
  for (int32_t z = around.low[2]; z <= around.high[2]; z++) {
    for (int32_t y = around.low[1]; y <= around.high[1]; y++) {
      for (int32_t x = around.low[0]; x <= around.high[0]; x++) {
        const size_t voxel = voxel_index(v, x, y, z);
        if (labels[voxel] != 0 || !olx_bvh_is_clear(s->scene->bvh, position, olx_voxel_centre(v, voxel))) continue;
        olx_voxels_flood(v, voxel, 1, labels, stack);
      }
    }
  }
}

// Floods, from the faces of the box, the voxels that the probes' floods have not reached.
static void flood_from_outside(olx_volume_space *s, uint32_t *labels, size_t *stack) {
  const olx_voxels *v = &s->space.voxels;
  for (size_t i = 0; i < v->total; i++) {
    uint32_t c[3];
    olx_voxel_coordinates(v, i, c);
    bool face = false;
    for (int axis = 0; axis < 3; axis++) face |= c[axis] == 0 || c[axis] + 1 == v->count[axis];
    if (face && labels[i] == 0) olx_voxels_flood(v, i, OUTSIDE, labels, stack);
  }
}

static olx_result flood_from_probes(olx_volume_space *s, const olx_vec3 *positions, const uint8_t *flags,
                                    uint32_t count) {
  const size_t total = s->space.voxels.total;
  uint32_t *labels = olx_allocate(total, sizeof *labels);
  size_t *stack = olx_allocate(total, sizeof *stack);
  s->outside = olx_allocate(total, sizeof *s->outside);
  olx_result result =
      labels && stack && s->outside ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "bake: no memory for %zu voxels", total);
  if (result == OLX_OK) {
    for (size_t i = 0; i < total; i++) labels[i] = s->space.voxels.solid[i] ? UINT32_MAX : is_reached(s, i);
    for (uint32_t i = 0; i < count; i++) {
      if (flags[i] == 0) flood_from(s, positions[i], labels, stack);
    }
    for (size_t i = 0; i < total; i++) {
      if (labels[i] == 1) s->space.reachable[i] |= OLX_REACHABLE;
    }
    flood_from_outside(s, labels, stack);
    for (size_t i = 0; i < total; i++) s->outside[i] = labels[i] == OUTSIDE;
  }
  olx_release(labels);
  olx_release(stack);
  return result;
}

olx_result olx_volume_space_create(const olx_scene *scene, const olx_vec3 *positions, const uint8_t *flags,
                                   uint32_t count, uint32_t resolution, uint32_t threads, olx_volume_space *s) {
  *s = (olx_volume_space){.scene = scene};
  const olx_result result = olx_space_create(scene, resolution, threads, &s->space);
  if (result == OLX_ERROR_EMPTY) {
    s->empty = true;
    return OLX_OK;
  }
  OLX_TRY(result);
  const olx_result flooded = flood_from_probes(s, positions, flags, count);
  if (flooded != OLX_OK) olx_volume_space_free(s);
  return flooded;
}

void olx_volume_space_free(olx_volume_space *s) {
  olx_release(s->outside);
  olx_space_free(&s->space);
}

bool olx_volume_space_touches(const olx_volume_space *s, olx_vec3 low, olx_vec3 high) {
  const olx_voxels *v = &s->space.voxels;
  const voxel_range range = range_of(v, low, high);
  for (int32_t z = range.low[2]; z <= range.high[2]; z++) {
    for (int32_t y = range.low[1]; y <= range.high[1]; y++) {
      for (int32_t x = range.low[0]; x <= range.high[0]; x++) {
        if (is_reached(s, voxel_index(v, x, y, z))) return true;
      }
    }
  }
  return false;
}

static bool is_outside(const olx_volume_space *s, size_t voxel) { return s->outside[voxel]; }

// Returns whether the place is in a voxel of a kind without surfaces, or sees such a voxel beside it.
static bool belongs_to(const olx_volume_space *s, olx_vec3 place, bool (*is_kind)(const olx_volume_space *, size_t)) {
  const olx_voxels *v = &s->space.voxels;
  const size_t own = olx_voxel_at(v, place);
  if (own != OLX_NO_VOXEL && !v->solid[own]) return is_kind(s, own);
  const voxel_range around = range_of(v, place, place);
  for (int32_t z = around.low[2]; z <= around.high[2]; z++) {
    for (int32_t y = around.low[1]; y <= around.high[1]; y++) {
      for (int32_t x = around.low[0]; x <= around.high[0]; x++) {
        const size_t voxel = voxel_index(v, x, y, z);
        if (is_kind(s, voxel) && olx_bvh_is_clear(s->scene->bvh, place, olx_voxel_centre(v, voxel))) return true;
      }
    }
  }
  return false;
}

bool olx_volume_space_holds(const olx_volume_space *s, olx_vec3 place) { return belongs_to(s, place, is_reached); }

bool olx_volume_space_shuts_out(const olx_volume_space *s, olx_vec3 place) {
  if (olx_volume_space_holds(s, place)) return false;
  return olx_voxel_at(&s->space.voxels, place) == OLX_NO_VOXEL || belongs_to(s, place, is_outside);
}
