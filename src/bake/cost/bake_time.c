// Estimates how long a bake will take: bakes a few of its probes twice, with light field maps of useful size and
// without, and extrapolates the time per probe of each kind.
#include <octalux/bake.h>

#include "core/file.h"
#include "core/result.h"
#include "core/vec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { SAMPLE_SIDE = 2, LEAST_SIZE = 8, SAMPLE_SIZE = 256 };

// Returns a grid of at most SAMPLE_SIDE probes along each axis, at the middles of equal parts of the box. The ends of a
// grid are often outside the scene or in a wall, where rays cost little.
static olx_grid sample_box(olx_vec3 low, olx_vec3 high, const uint32_t count[3]) {
  olx_grid grid;
  float origin[3], spacing[3];
  const float lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
  for (uint32_t axis = 0; axis < 3; axis++) {
    const float extent = highs[axis] - lows[axis];
    grid.count[axis] = count[axis] < SAMPLE_SIDE || !(extent > 0.0f) ? 1 : SAMPLE_SIDE;
    spacing[axis] = grid.count[axis] > 1 ? extent / SAMPLE_SIDE : 0.0f;
    origin[axis] = lows[axis] + 0.5f * extent / (float)grid.count[axis];
  }
  grid.origin = olx_v3(origin[0], origin[1], origin[2]);
  grid.spacing = olx_v3(spacing[0], spacing[1], spacing[2]);
  return grid;
}

static olx_grid sample_grid(const olx_grid *grid) {
  const olx_vec3 s = grid->spacing;
  const olx_vec3 extent =
      olx_v3((float)(grid->count[0] - 1) * s.x, (float)(grid->count[1] - 1) * s.y, (float)(grid->count[2] - 1) * s.z);
  return sample_box(grid->origin, olx_add(grid->origin, extent), grid->count);
}

static olx_grid sample_probes(const olx_vec3 *probes, uint32_t count) {
  olx_vec3 low = probes[0], high = probes[0];
  for (uint32_t i = 1; i < count; i++) {
    low = olx_min_each(low, probes[i]);
    high = olx_max_each(high, probes[i]);
  }
  return sample_box(low, high, (const uint32_t[3]){count, count, count});
}

static double probes_of(const olx_grid *grid) {
  return (double)grid->count[0] * (double)grid->count[1] * (double)grid->count[2];
}

static olx_result bake_sample(const olx_scene *scene, const olx_bake_settings *settings, const olx_progress *progress,
                              olx_bake_stats *stats) {
  const char *folder = getenv("TMPDIR");
  char path[4096];
  snprintf(path, sizeof path, "%s/octalux-estimate-XXXXXX", folder && *folder ? folder : "/tmp");
  const int descriptor = mkstemp(path);
  if (descriptor < 0) return olx_fail(OLX_ERROR_FILE, "%s: cannot create a temporary file", path);
  close(descriptor);
  const olx_result result = olx_bake(scene, settings, path, progress, stats);
  unlink(path);
  return result;
}

olx_result olx_bake_estimate_seconds(const olx_scene *scene, const olx_bake_settings *settings,
                                     const olx_progress *progress, double *seconds) {
  olx_bake_settings sample = *settings;
  olx_bake_stats without, with;
  olx_bake_sizes sizes;
  *seconds = 0.0;
  const olx_result checked = olx_bake_measure(scene, settings, "", &sizes);
  if (checked != OLX_OK && !sizes.probes) return checked; // a bake that does not fit the machine still has an estimate
  sample.probes = NULL;
  sample.select_mask = 1u << OLX_SELECT_CAGE;
  sample.measure_embree = false;
  sample.memory_limit_bytes = 0;
  sample.work = (olx_bake_work){0};
  sample.grid =
      settings->probes ? sample_probes(settings->probes, settings->probe_count) : sample_grid(&settings->grid);
  if (sizes.irradiance_probes) sample.irradiance_grid = sample_grid(&settings->irradiance_grid);
  sample.radiance_size = LEAST_SIZE;
  OLX_TRY(bake_sample(scene, &sample, progress, &without));
  sample.radiance_size = settings->radiance_size < SAMPLE_SIZE ? settings->radiance_size : SAMPLE_SIZE;
  OLX_TRY(bake_sample(scene, &sample, progress, &with));
  const double size = (double)settings->radiance_size / sample.radiance_size;
  const double probes = settings->probes ? (double)settings->probe_count : probes_of(&settings->grid);
  const double light = fmax(with.seconds - with.classic_seconds - (without.seconds - without.classic_seconds), 0.0);
  const double irradiance =
      sizes.irradiance_probes ? (double)sizes.irradiance_probes / probes_of(&sample.irradiance_grid) : 1.0;
  *seconds = without.seconds * irradiance + light * size * size * probes / probes_of(&sample.grid);
  return OLX_OK;
}
