// Captures ambient cubes from a field's irradiance volume, and spreads them to voxels inside geometry.
#include "export/ambient_cubes.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "shade/volume_irradiance.h"

#include <string.h>

static const olx_vec3 side_normals[OLX_CUBE_SIDES] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                                      {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};

// Splits a coordinate, in voxels from the low face, into the voxel before it and the share of the next. Before the
// first centre and behind the last, light is constant.
static uint32_t split(float coordinate, uint32_t size, float *share) {
  const float at = olx_clamp(coordinate - 0.5f, 0.0f, (float)size - 1.0f);
  uint32_t before = (uint32_t)at;
  if (before + 1 >= size) before = size > 1 ? size - 2 : 0;
  *share = at - (float)before;
  return before;
}

olx_cube_place olx_cube_place_at(const olx_cube_grid *g, olx_vec3 p) {
  float fx, fy, fz;
  const uint32_t x = split((p.x - g->low.x) / g->spacing.x, g->size[0], &fx),
                 y = split((p.y - g->low.y) / g->spacing.y, g->size[1], &fy),
                 z = split((p.z - g->low.z) / g->spacing.z, g->size[2], &fz);
  olx_cube_place place = {.first = x + g->size[0] * (y + g->size[1] * z)};
  for (uint32_t i = 0; i < OLX_CUBE_POINT_VOXELS; i++) {
    place.weights[i] = (i & 1 ? fx : 1.0f - fx) * (i & 2 ? fy : 1.0f - fy) * (i & 4 ? fz : 1.0f - fz);
  }
  return place;
}

olx_cube_steps olx_cube_steps_of(const olx_cube_grid *g) {
  const uint32_t along[3] = {g->size[0] > 1 ? 1 : 0, g->size[1] > 1 ? g->size[0] : 0,
                             g->size[2] > 1 ? g->size[0] * g->size[1] : 0};
  olx_cube_steps steps;
  for (uint32_t i = 0; i < OLX_CUBE_POINT_VOXELS; i++) {
    steps.corner[i] = (i & 1 ? along[0] : 0) + (i & 2 ? along[1] : 0) + (i & 4 ? along[2] : 0);
  }
  return steps;
}

olx_result olx_cubes_create(const olx_cube_grid *grid, olx_cubes *cubes) {
  *cubes = (olx_cubes){.grid = *grid, .voxels = olx_cube_voxels(grid)};
  cubes->values = olx_allocate(OLX_CUBE_SIDES * cubes->voxels, sizeof *cubes->values);
  cubes->served = olx_allocate(cubes->voxels, sizeof *cubes->served);
  if (cubes->values && cubes->served) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY, "no memory for %zu voxels", cubes->voxels);
}

void olx_cubes_free(olx_cubes *cubes) {
  olx_release(cubes->values);
  olx_release(cubes->served);
  *cubes = (olx_cubes){.values = NULL};
}

// ---- Capture

typedef struct capture {
  const olx_field *field;
  olx_cubes *cubes;
} capture;

static void capture_voxel(const capture *c, olx_vec3 centre, size_t voxel) {
  olx_cubes *cubes = c->cubes;
  cubes->served[voxel] = true;
  for (uint32_t side = 0; side < OLX_CUBE_SIDES; side++) {
    olx_volume_light_at light;
    olx_vec3 value = {0};
    if (olx_volume_gather(c->field, centre, side_normals[side], &light)) {
      value = olx_volume_towards(&light, side_normals[side]);
    } else {
      cubes->served[voxel] = false;
    }
    cubes->values[side * cubes->voxels + voxel] = value;
  }
}

static void capture_slice(void *user, uint32_t z) {
  const capture *c = user;
  const olx_cube_grid *g = &c->cubes->grid;
  for (uint32_t y = 0; y < g->size[1]; y++) {
    for (uint32_t x = 0; x < g->size[0]; x++) {
      const olx_vec3 middle = olx_v3((float)x + 0.5f, (float)y + 0.5f, (float)z + 0.5f);
      capture_voxel(c, olx_add(g->low, olx_mul(middle, g->spacing)), x + g->size[0] * (y + (size_t)g->size[1] * z));
    }
  }
}

// ---- Spreading

// Voxels that have light, in the order in which they got it.
typedef struct spread {
  olx_cubes *cubes;
  uint32_t *order; // of voxels
  uint32_t count;  // that have light or will have it after this round
  bool *reached;
} spread;

typedef struct neighbours {
  uint32_t count, voxels[6];
} neighbours;

static neighbours neighbours_of(const olx_cube_grid *g, uint32_t voxel) {
  neighbours n = {.count = 0};
  uint32_t step = 1, rest = voxel;
  for (uint32_t axis = 0; axis < 3; axis++) {
    const uint32_t at = rest % g->size[axis];
    if (at > 0) n.voxels[n.count++] = voxel - step;
    if (at + 1 < g->size[axis]) n.voxels[n.count++] = voxel + step;
    rest /= g->size[axis];
    step *= g->size[axis];
  }
  return n;
}

// Gives a voxel the mean of those neighbours that had light before this round.
static void take_mean(spread *s, uint32_t voxel) {
  const olx_cubes *c = s->cubes;
  const neighbours n = neighbours_of(&c->grid, voxel);
  float count = 0.0f;
  olx_vec3 sums[OLX_CUBE_SIDES] = {{0}};
  for (uint32_t i = 0; i < n.count; i++) {
    if (!s->reached[n.voxels[i]]) continue;
    count += 1.0f;
    for (uint32_t side = 0; side < OLX_CUBE_SIDES; side++) {
      sums[side] = olx_add(sums[side], c->values[side * c->voxels + n.voxels[i]]);
    }
  }
  for (uint32_t side = 0; side < OLX_CUBE_SIDES; side++) {
    c->values[side * c->voxels + voxel] = olx_scale(sums[side], 1.0f / count);
  }
}

// Lists the voxels without light beside those from `first` to `end` of the order, each once.
static void list_next(spread *s, uint32_t first, uint32_t end, bool *listed) {
  for (uint32_t i = first; i < end; i++) {
    const neighbours n = neighbours_of(&s->cubes->grid, s->order[i]);
    for (uint32_t k = 0; k < n.count; k++) {
      if (listed[n.voxels[k]]) continue;
      listed[n.voxels[k]] = true;
      s->order[s->count++] = n.voxels[k];
    }
  }
}

static void spread_rounds(spread *s, bool *listed) {
  for (uint32_t first = 0; first < s->count;) {
    const uint32_t end = s->count;
    list_next(s, first, end, listed);
    for (uint32_t i = end; i < s->count; i++) take_mean(s, s->order[i]);
    for (uint32_t i = end; i < s->count; i++) s->reached[s->order[i]] = true;
    first = end;
  }
}

static olx_result spread_light(olx_cubes *cubes) {
  spread s = {.cubes = cubes, .order = olx_allocate(cubes->voxels, sizeof *s.order)};
  s.reached = olx_allocate(cubes->voxels, sizeof *s.reached);
  bool *listed = olx_allocate(cubes->voxels, sizeof *listed);
  olx_result result = OLX_OK;
  if (!s.order || !s.reached || !listed) {
    result = olx_fail(OLX_ERROR_MEMORY, "no memory for %zu voxels", cubes->voxels);
  } else {
    memcpy(s.reached, cubes->served, cubes->voxels * sizeof *s.reached);
    memcpy(listed, cubes->served, cubes->voxels * sizeof *listed);
    for (uint32_t i = 0; i < cubes->voxels; i++) {
      if (cubes->served[i]) s.order[s.count++] = i;
    }
    spread_rounds(&s, listed);
  }
  olx_release(s.order);
  olx_release(s.reached);
  olx_release(listed);
  return result;
}

olx_result olx_cubes_capture(const olx_field *field, olx_cubes *cubes, uint32_t threads) {
  capture c = {field, cubes};
  OLX_TRY(olx_parallel_for(cubes->grid.size[2], threads, capture_slice, &c, NULL, 0));
  if (memchr(cubes->served, true, cubes->voxels)) return spread_light(cubes);
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: no voxel of %ux%ux%u has its centre in free space: take more voxels",
                  field->name, cubes->grid.size[0], cubes->grid.size[1], cubes->grid.size[2]);
}
