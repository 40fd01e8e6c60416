// Computes the exact Euclidean distance of every voxel to the nearest solid one (Meijster et al. 2000), one pass for
// each axis.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "place/space/voxels.h"

enum { BUNDLES = 64 };

// One pass along an axis. Lines are independent of each other; every 64th forms a bundle, which shares scratch memory.
typedef struct pass {
  const uint8_t *solid;
  uint32_t *distance;
  uint32_t count[3], lines;
  int axis;
  // Scratch for a line of a bundle: its values, and the lower envelope of their parabolas: the owner of each segment
  // and where it begins.
  uint32_t *values, *owners, *begins;
} pass;

static size_t line_start(const pass *p, uint32_t line) {
  const size_t nx = p->count[0], ny = p->count[1];
  if (p->axis == 0) return nx * line;
  if (p->axis == 1) return line % nx + nx * ny * (line / nx);
  return line;
}

// Measures along x: the squared distance to the nearest solid voxel of the row.
static void measure_row(const pass *p, size_t start) {
  const uint32_t n = p->count[0];
  uint32_t steps = OLX_FAR_VOXELS;
  for (uint32_t x = 0; x < n; x++) {
    if (p->solid[start + x]) steps = 0;
    else if (steps != OLX_FAR_VOXELS) steps++;
    p->distance[start + x] = steps;
  }
  steps = OLX_FAR_VOXELS;
  for (uint32_t x = n; x-- > 0;) {
    if (p->solid[start + x]) steps = 0;
    else if (steps != OLX_FAR_VOXELS) steps++;
    const uint32_t nearest = steps < p->distance[start + x] ? steps : p->distance[start + x];
    p->distance[start + x] = nearest == OLX_FAR_VOXELS ? nearest : nearest * nearest;
  }
}

static int64_t floor_divide(int64_t a, int64_t b) {
  const int64_t q = a / b;
  return a % b != 0 && (a < 0) != (b < 0) ? q - 1 : q;
}

// Returns the last position where the parabola of i is no farther than that of j > i.
static int64_t last_of(const uint32_t *values, int64_t i, int64_t j) {
  return floor_divide((int64_t)values[j] - values[i] + j * j - i * i, 2 * (j - i));
}

// Measures along y or z: the minimum of value[j] + (i - j)^2 over the line, by the lower envelope of those parabolas.
static void measure_line(const pass *p, size_t start, size_t stride, uint32_t *values, uint32_t *owners,
                         uint32_t *begins) {
  const uint32_t n = p->count[p->axis];
  uint32_t used = 0;
  for (uint32_t j = 0; j < n; j++) {
    values[j] = p->distance[start + stride * j];
    if (values[j] == OLX_FAR_VOXELS) continue;
    int64_t begin = 0;
    while (used > 0 && (begin = last_of(values, owners[used - 1], j) + 1) <= begins[used - 1]) used--;
    if (used == 0) begin = 0;
    if (begin >= n) continue;
    begins[used] = (uint32_t)begin;
    owners[used++] = j;
  }
  if (used == 0) return;
  uint32_t current = used - 1;
  for (uint32_t i = n; i-- > 0;) {
    while (current > 0 && begins[current] > i) current--;
    const uint32_t owner = owners[current], step = i > owner ? i - owner : owner - i;
    p->distance[start + stride * i] = values[owner] + step * step;
  }
}

static void bundle_job(void *user, uint32_t bundle) {
  const pass *p = user;
  const size_t n = p->count[p->axis], scratch = n * bundle;
  const size_t stride = p->axis == 1 ? p->count[0] : (size_t)p->count[0] * p->count[1];
  for (uint32_t line = bundle; line < p->lines; line += BUNDLES) {
    if (p->axis == 0) measure_row(p, line_start(p, line));
    else {
      measure_line(p, line_start(p, line), stride, p->values + scratch, p->owners + scratch, p->begins + scratch);
    }
  }
}

olx_result olx_distance_transform(const uint8_t *solid, const uint32_t count[3], uint32_t threads, uint32_t *distance) {
  const uint32_t longest = count[1] > count[2] ? count[1] : count[2];
  uint32_t *scratch = olx_allocate((size_t)longest * BUNDLES * 3, sizeof *scratch);
  if (!scratch) return olx_fail(OLX_ERROR_MEMORY, "place: no memory for the distance transform");
  pass p = {.solid = solid, .distance = distance, .count = {count[0], count[1], count[2]}};
  p.values = scratch;
  p.owners = scratch + (size_t)longest * BUNDLES;
  p.begins = scratch + (size_t)longest * BUNDLES * 2;
  olx_result result = OLX_OK;
  for (p.axis = 0; p.axis < 3 && result == OLX_OK; p.axis++) {
    p.lines = count[(p.axis + 1) % 3] * count[(p.axis + 2) % 3];
    result = olx_parallel_for(BUNDLES, threads, bundle_job, &p, NULL, 0);
  }
  olx_release(scratch);
  return result;
}
