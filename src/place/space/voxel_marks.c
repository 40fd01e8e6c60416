// Finds which cubes of a lattice the triangles of a scene touch, by separating axes, many triangles at a time.
#include "place/space/voxel_marks.h"

#include "core/parallel.h"
#include "scene/surface.h"
#include "scene/triangle_box.h"

enum {
  TRIANGLES_A_JOB = 1024,
  MOST_STEPS = 4096 // between sample points along an edge of a masked triangle
};

typedef struct mark_job {
  const olx_scene *scene;
  const olx_lattice *lattice;
  bool whole; // alpha masks are ignored
  olx_mark_cell mark;
  void *user;
} mark_job;

static int32_t clamp_cell(float x, uint32_t count) {
  const float limit = (float)count - 1.0f;
  return (int32_t)olx_clamp(floorf(x), 0.0f, limit);
}

static void to_array(olx_vec3 v, float a[3]) {
  a[0] = v.x;
  a[1] = v.y;
  a[2] = v.z;
}

// A triangle in cells: its corners in voxels from the low corner, the cells around it, its plane.
typedef struct cell_triangle {
  olx_vec3 corners[3];
  int32_t low[3], high[3];
  float normal[3], offset;
  int axis; // axis nearest to the plane's normal
} cell_triangle;

static bool set_up_triangle(const mark_job *job, uint32_t triangle, cell_triangle *t) {
  const olx_lattice *v = job->lattice;
  float low[3], high[3];
  for (int i = 0; i < 3; i++) {
    const olx_vec3 p = job->scene->positions[job->scene->indices[3 * (size_t)triangle + (size_t)i]];
    t->corners[i] = olx_scale(olx_sub(p, v->low), 1.0f / v->size);
  }
  to_array(olx_min_each(t->corners[0], olx_min_each(t->corners[1], t->corners[2])), low);
  to_array(olx_max_each(t->corners[0], olx_max_each(t->corners[1], t->corners[2])), high);
  for (int i = 0; i < 3; i++) {
    if (high[i] < -job->lattice->slack || low[i] > (float)v->count[i] + job->lattice->slack) return false;
    t->low[i] = clamp_cell(low[i] - job->lattice->slack, v->count[i]);
    t->high[i] = clamp_cell(high[i] + job->lattice->slack, v->count[i]);
  }
  const olx_vec3 n =
      olx_normalize(olx_cross(olx_sub(t->corners[1], t->corners[0]), olx_sub(t->corners[2], t->corners[0])));
  to_array(n, t->normal);
  t->offset = olx_dot(n, t->corners[0]);
  t->axis = fabsf(n.x) > fabsf(n.y) ? (fabsf(n.x) > fabsf(n.z) ? 0 : 2) : (fabsf(n.y) > fabsf(n.z) ? 1 : 2);
  return true;
}

// Marks the cells that the plane passes, in the column through `cell` along the triangle's axis.
static void mark_column(const mark_job *job, const cell_triangle *t, int32_t cell[3]) {
  const int k = t->axis, i = (k + 1) % 3, j = (k + 2) % 3;
  const float half = 0.5f + job->lattice->slack, steep = t->normal[k];
  int32_t first = t->low[k], last = t->high[k];
  if (fabsf(steep) > 0.1f) {
    const float x = (float)cell[i] + 0.5f, y = (float)cell[j] + 0.5f;
    const float middle = (t->offset - t->normal[i] * x - t->normal[j] * y) / steep;
    const float reach = half * (fabsf(t->normal[i]) + fabsf(t->normal[j])) / fabsf(steep) + job->lattice->slack;
    const float low = floorf(middle - reach), high = floorf(middle + reach);
    if (low > (float)last || high < (float)first) return;
    if (low > (float)first) first = (int32_t)low;
    if (high < (float)last) last = (int32_t)high;
  }
  for (cell[k] = first; cell[k] <= last; cell[k]++) {
    const olx_vec3 centre = {(float)cell[0] + 0.5f, (float)cell[1] + 0.5f, (float)cell[2] + 0.5f};
    const olx_vec3 corners[3] = {olx_sub(t->corners[0], centre), olx_sub(t->corners[1], centre),
                                 olx_sub(t->corners[2], centre)};
    if (olx_triangle_edges_touch(corners, half)) job->mark(job->user, cell);
  }
}

static void mark_triangle(const mark_job *job, uint32_t triangle) {
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

// Marks the cells of sample points of a masked triangle, three per voxel's edge, where the surface is opaque. One that
// is too long for so many points counts as opaque everywhere.
static void mark_masked(const mark_job *job, uint32_t triangle) {
  cell_triangle t;
  if (!set_up_triangle(job, triangle, &t)) return;
  const olx_vec3 u = olx_sub(t.corners[1], t.corners[0]), v = olx_sub(t.corners[2], t.corners[0]);
  const float longest = olx_max(olx_length(u), olx_max(olx_length(v), olx_length(olx_sub(v, u))));
  if (longest * 3.0f > (float)MOST_STEPS) {
    mark_triangle(job, triangle);
    return;
  }
  const uint32_t steps = (uint32_t)olx_max(ceilf(longest * 3.0f), 1.0f);
  for (uint32_t i = 0; i <= steps; i++) {
    for (uint32_t j = 0; i + j <= steps; j++) {
      const float a = (float)i / (float)steps, b = (float)j / (float)steps;
      if (!olx_surface_present(job->scene, triangle, a, b)) continue;
      const olx_vec3 p = olx_madd(olx_madd(t.corners[0], u, a), v, b);
      const int32_t cell[3] = {(int32_t)floorf(p.x), (int32_t)floorf(p.y), (int32_t)floorf(p.z)};
      const uint32_t *count = job->lattice->count;
      if (cell[0] < 0 || cell[1] < 0 || cell[2] < 0) continue;
      if ((uint32_t)cell[0] < count[0] && (uint32_t)cell[1] < count[1] && (uint32_t)cell[2] < count[2]) {
        job->mark(job->user, cell);
      }
    }
  }
}

static void triangles_job(void *user, uint32_t index) {
  const mark_job *job = user;
  const olx_scene *scene = job->scene;
  const uint32_t first = index * TRIANGLES_A_JOB;
  for (uint32_t t = first; t < first + TRIANGLES_A_JOB && t < scene->triangle_count; t++) {
    if (!job->whole && scene->materials[scene->material_index[t]].alpha_cutoff > 0.0f) mark_masked(job, t);
    else mark_triangle(job, t);
  }
}

olx_result olx_mark_cells(const olx_scene *scene, const olx_lattice *lattice, bool whole, uint32_t threads,
                          olx_mark_cell mark, void *user) {
  mark_job job = {scene, lattice, whole, mark, user};
  const uint32_t jobs = (scene->triangle_count + TRIANGLES_A_JOB - 1) / TRIANGLES_A_JOB;
  return olx_parallel_for(jobs, threads, triangles_job, &job, NULL, 0);
}
