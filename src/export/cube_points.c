// Collects points on surfaces and in free space, with the light that fields store there, for fitting ambient cubes.
#include "export/cube_points.h"

#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/texels.h"
#include "shade/volume_irradiance.h"

#include <string.h>

enum {
  MOST_OF_VOXEL = 64, // points of surfaces for each voxel of the grid, at most
  MOST_POINTS = 1 << 18,
  LEAST_SIDE = 4,
  SPACE_OF_VOXEL = 16, // points of free space
  MOST_SPACE = 1 << 17,
  SPACE_JOB_POINTS = 1024,
  SALT_SPACE = 0x43554245
};

// The weight of free space in a voxel, where the weight of the voxel's surfaces is 1.
static const float SPACE_WEIGHT = 0.035f;

typedef struct collection {
  const olx_field *field;
  const olx_cube_grid *grid;
  uint32_t step, side;    // every step-th texel of a map is read, side^2 of them
  uint32_t space;         // points that are drawn in free space
  olx_cube_point *points; // side^2 a probe, then those in free space; a weight of 0: there is none
} collection;

static olx_cube_point point_at(const olx_cube_grid *grid, olx_vec3 position, olx_vec3 normal, olx_vec3 irradiance) {
  const float coordinates[3] = {normal.x, normal.y, normal.z};
  olx_cube_point point = {
      .place = olx_cube_place_at(grid, position), .irradiance = irradiance, .weight = 1.0f, .surface = true};
  for (uint32_t axis = 0; axis < 3; axis++) {
    point.sides[axis] = olx_cube_side(axis, coordinates[axis]);
    point.shares[axis] = olx_square(coordinates[axis]);
  }
  return point;
}

static olx_cube_point read_point(const collection *c, uint32_t probe, uint32_t x, uint32_t y) {
  const olx_field *field = c->field;
  const size_t texel = olx_map_index(field->stride, (int32_t)x, (int32_t)y);
  const olx_texel_geometry seen = olx_texel_geometry_of(field, probe, texel);
  if (!(seen.distance < INFINITY) || !olx_finite(seen.normal)) return (olx_cube_point){.weight = 0.0f};
  const olx_vec3 way = olx_texel_direction(x, y, field->n);
  return point_at(c->grid, olx_madd(field->probe_positions[probe], way, seen.distance), seen.normal,
                  olx_texel_indirect(field, probe, texel));
}

static void read_probe(void *user, uint32_t probe) {
  const collection *c = user;
  olx_cube_point *points = c->points + (size_t)c->side * c->side * probe;
  const bool buried = c->field->probe_flags[probe] & OLX_PROBE_BURIED;
  for (uint32_t i = 0; i < c->side * c->side; i++) {
    points[i].weight = 0.0f;
    if (buried) continue;
    points[i] = read_point(c, probe, i % c->side * c->step + c->step / 2, i / c->side * c->step + c->step / 2);
  }
}

// Draws a place in the box, in free space or not, and a normal.
static olx_cube_point draw_point(const collection *c, uint32_t i) {
  const olx_cube_grid *g = c->grid;
  const olx_vec3 size = olx_mul(olx_v3((float)g->size[0], (float)g->size[1], (float)g->size[2]), g->spacing);
  float random[5];
  for (uint32_t k = 0; k < 5; k++) random[k] = olx_unit_float(olx_hash3(i, k, SALT_SPACE));
  const olx_vec3 position = olx_add(g->low, olx_mul(size, olx_load3(random)));
  const olx_vec3 normal = olx_sample_sphere((olx_vec2){random[3], random[4]});
  olx_volume_light_at light;
  if (!olx_volume_gather(c->field, position, normal, &light)) return (olx_cube_point){.weight = 0.0f};
  olx_cube_point point = point_at(g, position, normal, olx_volume_towards(&light, normal));
  point.surface = false;
  return point;
}

static void draw_points(void *user, uint32_t job) {
  const collection *c = user;
  olx_cube_point *points = c->points + (size_t)c->side * c->side * c->field->info.probes.count;
  const uint32_t first = job * SPACE_JOB_POINTS;
  for (uint32_t i = first; i < first + SPACE_JOB_POINTS && i < c->space; i++) points[i] = draw_point(c, i);
}

// Returns the side that a point's normal is nearest to.
static uint32_t main_side(const olx_cube_point *p) {
  const uint32_t axis =
      p->shares[0] >= p->shares[1] ? (p->shares[0] >= p->shares[2] ? 0 : 2) : (p->shares[1] >= p->shares[2] ? 1 : 2);
  return p->sides[axis];
}

// Divides the weight of surfaces, and that of free space, between points of one voxel with the same main side.
static void share_weights(olx_cube_point *points, uint32_t count) {
  float counts[2][OLX_CUBE_SIDES] = {{0}};
  for (uint32_t i = 0; i < count; i++) counts[points[i].surface][main_side(&points[i])] += 1.0f;
  for (uint32_t i = 0; i < count; i++) {
    points[i].weight = (points[i].surface ? 1.0f : SPACE_WEIGHT) / counts[points[i].surface][main_side(&points[i])];
  }
}

// Sorts what was read by first voxels; points of one voxel keep their order.
static void sort_points(const collection *c, size_t read, olx_cube_points *sorted, size_t voxels) {
  memset(sorted->starts, 0, (voxels + 1) * sizeof *sorted->starts);
  for (size_t i = 0; i < read; i++) {
    if (c->points[i].weight > 0.0f) sorted->starts[c->points[i].place.first + 1]++;
  }
  for (size_t i = 0; i < voxels; i++) sorted->starts[i + 1] += sorted->starts[i];
  sorted->count = sorted->starts[voxels];
  for (size_t i = read; i-- > 0;) { // backwards, from each voxel's end, which becomes its start
    if (!(c->points[i].weight > 0.0f)) continue;
    sorted->points[--sorted->starts[c->points[i].place.first + 1]] = c->points[i];
  }
  memmove(sorted->starts, sorted->starts + 1, voxels * sizeof *sorted->starts);
  sorted->starts[voxels] = sorted->count;
  for (size_t i = 0; i < voxels; i++) {
    share_weights(sorted->points + sorted->starts[i], sorted->starts[i + 1] - sorted->starts[i]);
  }
}

static size_t smaller(size_t a, size_t b) { return a < b ? a : b; }

static collection plan_collection(const olx_field *field, const olx_cube_grid *grid, size_t voxels) {
  collection c = {.field = field, .grid = grid, .step = 1, .side = field->n};
  const size_t most = smaller(MOST_OF_VOXEL * voxels, MOST_POINTS);
  while (c.side > LEAST_SIDE && (size_t)c.side * c.side * field->info.probes.count > most) {
    c.side /= 2;
    c.step *= 2;
  }
  c.space = (uint32_t)smaller(SPACE_OF_VOXEL * voxels, MOST_SPACE);
  return c;
}

static olx_result read_all(collection *c, uint32_t threads) {
  const uint32_t jobs = (c->space + SPACE_JOB_POINTS - 1) / SPACE_JOB_POINTS;
  OLX_TRY(olx_parallel_for(c->field->info.probes.count, threads, read_probe, c, NULL, 0));
  return olx_parallel_for(jobs, threads, draw_points, c, NULL, 0);
}

olx_result olx_cube_points_collect(const olx_field *field, const olx_cube_grid *grid, uint32_t threads,
                                   olx_cube_points *points) {
  const size_t voxels = olx_cube_voxels(grid);
  collection c = plan_collection(field, grid, voxels);
  const size_t most = (size_t)c.side * c.side * field->info.probes.count + c.space;
  c.points = olx_allocate(most, sizeof *c.points);
  *points = (olx_cube_points){.points = olx_allocate(most, sizeof *points->points)};
  points->starts = olx_allocate(voxels + 1, sizeof *points->starts);
  olx_result result = OLX_OK;
  if (!c.points || !points->points || !points->starts) {
    result = olx_fail(OLX_ERROR_MEMORY, "%s: no memory for %zu points", field->name, most);
  } else {
    result = read_all(&c, threads);
    if (result == OLX_OK) sort_points(&c, most, points, voxels);
  }
  olx_release(c.points);
  return result;
}

void olx_cube_points_free(olx_cube_points *points) {
  olx_release(points->points);
  olx_release(points->starts);
  *points = (olx_cube_points){.count = 0};
}
