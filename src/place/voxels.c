// Cuts space into voxels, marks those that surfaces touch, and floods the connected free ones.
#include "place/voxels.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "scene/surface.h"
#include "scene/triangle_box.h"

#include <string.h>

#define MAX_VOXELS ((size_t)1 << 23)
enum { TRIANGLES_A_JOB = 1024 };

typedef struct voxel_job {
  const olx_scene *scene;
  const olx_voxels *voxels;
  float slack; // by which boxes are grown against rounding, in voxels
} voxel_job;

// Jobs may mark one voxel at once; all write the same.
static void mark(const olx_voxels *v, const int32_t c[3]) {
  uint8_t *solid = &v->solid[(size_t)c[0] + v->count[0] * ((size_t)c[1] + v->count[1] * (size_t)c[2])];
  __atomic_store_n(solid, 1, __ATOMIC_RELAXED);
}

static int32_t clamp_cell(float x, uint32_t count) {
  const float limit = (float)count - 1.0f;
  return (int32_t)olx_clamp(floorf(x), 0.0f, limit);
}

static void to_array(olx_vec3 v, float a[3]) {
  a[0] = v.x;
  a[1] = v.y;
  a[2] = v.z;
}

// Where a triangle may be: corners in voxels from the low corner, the cells around it, its plane.
typedef struct cell_triangle {
  olx_vec3 corners[3];
  int32_t low[3], high[3];
  float normal[3], offset;
  int axis; // along which the plane is most nearly flat
} cell_triangle;

static bool set_up_triangle(const voxel_job *job, uint32_t triangle, cell_triangle *t) {
  const olx_voxels *v = job->voxels;
  float low[3], high[3];
  for (int i = 0; i < 3; i++) {
    const olx_vec3 p = job->scene->positions[job->scene->indices[3 * (size_t)triangle + (size_t)i]];
    t->corners[i] = olx_scale(olx_sub(p, v->low), 1.0f / v->size);
  }
  to_array(olx_min_each(t->corners[0], olx_min_each(t->corners[1], t->corners[2])), low);
  to_array(olx_max_each(t->corners[0], olx_max_each(t->corners[1], t->corners[2])), high);
  for (int i = 0; i < 3; i++) {
    if (high[i] < -job->slack || low[i] > (float)v->count[i] + job->slack) return false;
    t->low[i] = clamp_cell(low[i] - job->slack, v->count[i]);
    t->high[i] = clamp_cell(high[i] + job->slack, v->count[i]);
  }
  const olx_vec3 n =
      olx_normalize(olx_cross(olx_sub(t->corners[1], t->corners[0]), olx_sub(t->corners[2], t->corners[0])));
  to_array(n, t->normal);
  t->offset = olx_dot(n, t->corners[0]);
  t->axis = fabsf(n.x) > fabsf(n.y) ? (fabsf(n.x) > fabsf(n.z) ? 0 : 2) : (fabsf(n.y) > fabsf(n.z) ? 1 : 2);
  return true;
}

// In the column of cells through `cell` along the triangle's axis, those that the plane passes.
static void mark_column(const voxel_job *job, const cell_triangle *t, int32_t cell[3]) {
  const int k = t->axis, i = (k + 1) % 3, j = (k + 2) % 3;
  const float half = 0.5f + job->slack, steep = t->normal[k];
  int32_t first = t->low[k], last = t->high[k];
  if (fabsf(steep) > 0.1f) {
    const float x = (float)cell[i] + 0.5f, y = (float)cell[j] + 0.5f;
    const float middle = (t->offset - t->normal[i] * x - t->normal[j] * y) / steep;
    const float reach = half * (fabsf(t->normal[i]) + fabsf(t->normal[j])) / fabsf(steep) + job->slack;
    const float low = floorf(middle - reach), high = floorf(middle + reach);
    if (low > (float)last || high < (float)first) return;
    if (low > (float)first) first = (int32_t)low;
    if (high < (float)last) last = (int32_t)high;
  }
  for (cell[k] = first; cell[k] <= last; cell[k]++) {
    const olx_vec3 centre = {(float)cell[0] + 0.5f, (float)cell[1] + 0.5f, (float)cell[2] + 0.5f};
    const olx_vec3 corners[3] = {olx_sub(t->corners[0], centre), olx_sub(t->corners[1], centre),
                                 olx_sub(t->corners[2], centre)};
    if (olx_triangle_edges_touch(corners, half)) mark(job->voxels, cell);
  }
}

static void mark_triangle(const voxel_job *job, uint32_t triangle) {
  cell_triangle t;
  if (!set_up_triangle(job, triangle, &t)) return;
  const int i = (t.axis + 1) % 3, j = (t.axis + 2) % 3;
  int32_t cell[3];
  for (int32_t x = t.low[i]; x <= t.high[i]; x++) {
    for (int32_t y = t.low[j]; y <= t.high[j]; y++) {
      cell[i] = x;
      cell[j] = y;
      mark_column(job, &t, cell);
    }
  }
}

// Points of a masked triangle, three to a voxel's edge, where the surface is there.
static void mark_masked(const voxel_job *job, uint32_t triangle) {
  cell_triangle t;
  if (!set_up_triangle(job, triangle, &t)) return;
  const olx_vec3 u = olx_sub(t.corners[1], t.corners[0]), v = olx_sub(t.corners[2], t.corners[0]);
  const float longest = olx_max(olx_length(u), olx_max(olx_length(v), olx_length(olx_sub(v, u))));
  const uint32_t steps = (uint32_t)olx_clamp(ceilf(longest * 3.0f), 1.0f, 4096.0f);
  for (uint32_t i = 0; i <= steps; i++) {
    for (uint32_t j = 0; i + j <= steps; j++) {
      const float a = (float)i / (float)steps, b = (float)j / (float)steps;
      if (!olx_surface_present(job->scene, triangle, a, b)) continue;
      const olx_vec3 p = olx_madd(olx_madd(t.corners[0], u, a), v, b);
      const int32_t cell[3] = {(int32_t)floorf(p.x), (int32_t)floorf(p.y), (int32_t)floorf(p.z)};
      const uint32_t *count = job->voxels->count;
      if (cell[0] < 0 || cell[1] < 0 || cell[2] < 0) continue;
      if ((uint32_t)cell[0] < count[0] && (uint32_t)cell[1] < count[1] && (uint32_t)cell[2] < count[2]) {
        mark(job->voxels, cell);
      }
    }
  }
}

static void mark_job(void *user, uint32_t index) {
  const voxel_job *job = user;
  const olx_scene *scene = job->scene;
  const uint32_t first = index * TRIANGLES_A_JOB;
  for (uint32_t t = first; t < first + TRIANGLES_A_JOB && t < scene->triangle_count; t++) {
    if (scene->materials[scene->material_index[t]].alpha_cutoff > 0.0f) mark_masked(job, t);
    else mark_triangle(job, t);
  }
}

// The size of a voxel, grown until there are few enough of them.
static void set_up_grid(olx_box box, uint32_t resolution, olx_voxels *v) {
  float extent[3];
  to_array(olx_sub(box.max, box.min), extent);
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

olx_result olx_voxels_create(const olx_scene *scene, olx_box box, uint32_t resolution, uint32_t threads,
                             olx_voxels *voxels) {
  *voxels = (olx_voxels){0};
  set_up_grid(box, resolution, voxels);
  voxels->solid = olx_allocate_zero(voxels->total, sizeof *voxels->solid);
  voxels->distance = olx_allocate(voxels->total, sizeof *voxels->distance);
  if (!voxels->solid || !voxels->distance) {
    olx_voxels_free(voxels);
    return olx_fail(OLX_ERROR_MEMORY, "place: no memory for %zu voxels", voxels->total);
  }
  voxel_job job = {.scene = scene, .voxels = voxels, .slack = 1e-3f};
  const uint32_t jobs = (scene->triangle_count + TRIANGLES_A_JOB - 1) / TRIANGLES_A_JOB;
  olx_result result = olx_parallel_for(jobs, threads, mark_job, &job, NULL, 0);
  if (result == OLX_OK) result = olx_distance_transform(voxels->solid, voxels->count, threads, voxels->distance);
  if (result != OLX_OK) olx_voxels_free(voxels);
  return result;
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
