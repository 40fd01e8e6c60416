// Fits ambient cubes by projected gradient descent with momentum (Beck and Teboulle 2009, "FISTA"). Weights are not
// negative and sum to 1, so the step for a value is one over the sum of the weights with which points read it.
#include "export/cube_fit.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

// The weight of captured values, where the surfaces of a voxel have a weight of 1 on each side: for voxels in free
// space, and for those inside geometry, where captured values are only spread from neighbours.
static const float SERVED_WEIGHT = 0.02f, INSIDE_WEIGHT = 0.002f;

enum { POINTS_PER_JOB = 4096 };

typedef struct cube_fit {
  olx_cubes *cubes;
  const olx_cube_points *points;
  olx_cube_steps steps;
  const olx_vec3 *captured;
  olx_vec3 *ahead;  // values, moved on by their momentum
  olx_vec3 *errors; // of each point: weight * (light - look-up)
  float momentum;
} cube_fit;

// Returns the light that the engine shows at a point of a grid with these values.
static olx_vec3 look_up(const olx_vec3 *values, size_t voxels, const olx_cube_steps *steps, const olx_cube_point *p) {
  olx_vec3 sum = {0};
  for (uint32_t axis = 0; axis < 3; axis++) {
    const olx_vec3 *side = values + p->sides[axis] * voxels + p->place.first;
    for (uint32_t i = 0; i < OLX_CUBE_POINT_VOXELS; i++) {
      sum = olx_madd(sum, side[steps->corner[i]], p->shares[axis] * p->place.weights[i]);
    }
  }
  return sum;
}

static void find_errors(void *user, uint32_t job) {
  const cube_fit *f = user;
  const uint32_t first = job * POINTS_PER_JOB, rest = f->points->count - first;
  for (uint32_t i = first; i < first + (rest < POINTS_PER_JOB ? rest : POINTS_PER_JOB); i++) {
    const olx_cube_point *p = &f->points->points[i];
    const olx_vec3 shown = look_up(f->ahead, f->cubes->voxels, &f->steps, p);
    f->errors[i] = olx_scale(olx_sub(p->irradiance, shown), p->weight);
  }
}

// What the points around a voxel add to its values.
typedef struct voxel_sums {
  olx_vec3 errors[OLX_CUBE_SIDES];
  float weights[OLX_CUBE_SIDES];
} voxel_sums;

static void add_points(const cube_fit *f, uint32_t first, uint32_t corner, voxel_sums *sums) {
  for (uint32_t i = f->points->starts[first]; i < f->points->starts[first + 1]; i++) {
    const olx_cube_point *p = &f->points->points[i];
    for (uint32_t axis = 0; axis < 3; axis++) {
      const float share = p->shares[axis] * p->place.weights[corner];
      sums->errors[p->sides[axis]] = olx_madd(sums->errors[p->sides[axis]], f->errors[i], share);
      sums->weights[p->sides[axis]] += share * p->weight;
    }
  }
}

// Sums over the points that read a voxel: those whose first voxel is up to one before it along each axis.
static voxel_sums gather(const cube_fit *f, uint32_t x, uint32_t y, uint32_t z) {
  const olx_cube_grid *g = &f->cubes->grid;
  voxel_sums sums = {{{0}}, {0}};
  for (uint32_t i = 0; i < OLX_CUBE_POINT_VOXELS; i++) {
    const uint32_t dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
    if (x < dx || y < dy || z < dz) continue;
    add_points(f, x - dx + g->size[0] * (y - dy + g->size[1] * (z - dz)), i, &sums);
  }
  return sums;
}

static float captured_weight(const cube_fit *f, size_t voxel) {
  return f->cubes->served[voxel] ? SERVED_WEIGHT : INSIDE_WEIGHT;
}

// Moves the values of a voxel to where the quadratic bound of the error about `ahead` is least, but not below 0.
static void move_voxel(const cube_fit *f, const voxel_sums *sums, size_t voxel) {
  const float kept = captured_weight(f, voxel);
  for (uint32_t side = 0; side < OLX_CUBE_SIDES; side++) {
    const size_t at = side * f->cubes->voxels + voxel;
    const olx_vec3 from = f->ahead[at], before = f->cubes->values[at];
    const olx_vec3 gain = olx_madd(sums->errors[side], olx_sub(f->captured[at], from), kept);
    const olx_vec3 now = olx_max_each(olx_madd(from, gain, 1.0f / (sums->weights[side] + kept)), olx_splat(0.0f));
    f->cubes->values[at] = now;
    f->ahead[at] = olx_madd(now, olx_sub(now, before), f->momentum);
  }
}

static void move_slice(void *user, uint32_t z) {
  const cube_fit *f = user;
  const olx_cube_grid *g = &f->cubes->grid;
  for (uint32_t y = 0; y < g->size[1]; y++) {
    for (uint32_t x = 0; x < g->size[0]; x++) {
      const voxel_sums sums = gather(f, x, y, z);
      move_voxel(f, &sums, x + g->size[0] * (y + (size_t)g->size[1] * z));
    }
  }
}

static olx_result run_rounds(cube_fit *f, uint32_t threads, olx_task *task) {
  const uint32_t jobs = (f->points->count + POINTS_PER_JOB - 1) / POINTS_PER_JOB;
  float t = 1.0f;
  for (uint32_t round = 0; round < OLX_CUBE_FIT_ROUNDS; round++) {
    const float next = 0.5f + sqrtf(0.25f + t * t);
    f->momentum = (t - 1.0f) / next;
    t = next;
    OLX_TRY(olx_parallel_for(jobs, threads, find_errors, f, task, 0));
    OLX_TRY(olx_parallel_for(f->cubes->grid.size[2], threads, move_slice, f, task, 0));
    if (task) olx_task_advance(task, 1);
  }
  return OLX_OK;
}

olx_result olx_cubes_fit(olx_cubes *cubes, const olx_cube_points *points, uint32_t threads, olx_task *task) {
  const size_t values = OLX_CUBE_SIDES * cubes->voxels, bytes = values * sizeof(olx_vec3);
  olx_vec3 *captured = olx_allocate(bytes, 1);
  cube_fit f = {.cubes = cubes, .points = points, .steps = olx_cube_steps_of(&cubes->grid), .captured = captured};
  f.ahead = olx_allocate(bytes, 1);
  f.errors = olx_allocate(points->count, sizeof *f.errors);
  olx_result result = OLX_OK;
  if (!captured || !f.ahead || !f.errors) {
    result = olx_fail(OLX_ERROR_MEMORY, "no memory to fit %zu voxels", cubes->voxels);
  } else {
    memcpy(captured, cubes->values, bytes);
    memcpy(f.ahead, cubes->values, bytes);
    result = run_rounds(&f, threads, task);
  }
  olx_release(captured);
  olx_release(f.ahead);
  olx_release(f.errors);
  return result;
}

olx_cubes_errors olx_cubes_compare(const olx_cubes *cubes, const olx_cube_points *points) {
  const olx_cube_steps steps = olx_cube_steps_of(&cubes->grid);
  double squares = 0.0, all = 0.0;
  olx_cubes_errors errors = {.points = 0};
  for (uint32_t i = 0; i < points->count; i++) {
    const olx_cube_point *p = &points->points[i];
    if (!p->surface) continue;
    const olx_vec3 off = olx_sub(p->irradiance, look_up(cubes->values, cubes->voxels, &steps, p));
    squares += (double)(p->weight * olx_dot(off, off));
    all += (double)(p->weight * olx_dot(p->irradiance, p->irradiance));
    errors.points++;
  }
  errors.relative_mse = all > 0.0 ? squares / all : 0.0;
  return errors;
}
