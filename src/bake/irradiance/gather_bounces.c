// Lights irradiance probes by bounces of light between them, as published: first by direct light on all surfaces that
// they see; each further bounce comes from the irradiance of the previous bounce, or from rays through the probes.
#include "bake/irradiance/gather_bounces.h"

#include "bake/irradiance/gather_points.h"
#include "core/result.h"

static uint32_t key_of(const olx_gather *gather, uint32_t probe) { return olx_shade_key(gather->shade, probe); }

// Lights the samples of a tile and leaves their radiance in scratch->roots.
static void light_samples(const olx_gather *gather, olx_shade_scratch *scratch, uint32_t tile) {
  const olx_quadrature *q = &gather->quadrature;
  const uint32_t per_cell = olx_samples_per_cell(q), per_quarter = per_cell / 4, probe = gather->probe;
  uint32_t reflections = 0;
  olx_shade_batch_begin(&scratch->roots, gather->context->settings->light_samples);
  scratch->roots.sparing = true;
  for (uint32_t i = 0; i < OLX_BATCH_POINTS; i++) {
    const uint32_t quarter = i / per_quarter, point = tile * (OLX_BATCH_POINTS / per_quarter) + quarter;
    const bool picked = i % per_quarter == olx_picked_sample(key_of(gather, probe), point, per_quarter);
    if (scratch->hits[i].triangle == OLX_NO_HIT) continue;
    const uint32_t cell = olx_place_of(q, tile, i).cell;
    const uint32_t root = olx_shade_append(gather->shade, &scratch->roots, &scratch->hits[i], scratch->directions[i],
                                           olx_cell_seed(probe, cell), i % per_cell);
    scratch->slot[root] = i;
    scratch->roots.scattered[root] = gather->shade->reflected_lights ? 1.0f : 0.0f;
    if (!picked || !gather->shade->reflected_lights) continue;
    const float weight = olx_quarter_solid_angle(q, tile, quarter, per_quarter) / scratch->weights[i];
    olx_shade_path path = {.root = root, .from = root, .throughput = olx_splat(weight), .diffuse = true};
    scratch->paths[0][reflections++] = path;
    path.diffuse = false;
    if (scratch->roots.reflects[root]) scratch->paths[0][reflections++] = path;
  }
  olx_shade_direct(gather->shade, scratch, &scratch->roots);
  olx_shade_reflections(gather->shade, scratch, reflections, 0, OLX_REFLECT_LIGHTS);
}

// Stores the direct light of gather points, each the mean over its quarter of a cell.
static void keep_direct(const olx_gather *gather, const olx_shade_scratch *scratch, uint32_t tile) {
  const olx_quadrature *q = &gather->quadrature;
  const uint32_t per_quarter = olx_samples_per_cell(q) / 4, per_tile = OLX_BATCH_POINTS / per_quarter;
  olx_vec3 *direct = gather->traced.direct + (size_t)gather->probe * olx_gather_points(q) + tile * per_tile;
  float weights[OLX_BATCH_POINTS] = {0.0f};
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    const uint32_t i = scratch->slot[k];
    weights[i / per_quarter] += scratch->weights[i];
    direct[i / per_quarter] = olx_madd(direct[i / per_quarter], scratch->roots.radiance[k], scratch->weights[i]);
  }
  for (uint32_t point = 0; point < per_tile; point++) {
    if (weights[point] > 0.0f) direct[point] = olx_scale(direct[point], 1.0f / weights[point]);
  }
}

void olx_gather_light_tile(const olx_gather *gather, olx_shade_scratch *scratch, uint32_t tile) {
  const olx_quadrature *q = &gather->quadrature;
  light_samples(gather, scratch, tile);
  olx_vec3 *direct = gather->direct + (size_t)gather->probe * q->cells * q->cells;
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    const uint32_t i = scratch->slot[k], cell = olx_place_of(q, tile, i).cell;
    const float share = scratch->weights[i] / q->cell_solid_angle[cell];
    direct[cell] = olx_madd(direct[cell], scratch->roots.radiance[k], share);
  }
  if (gather->traces) keep_direct(gather, scratch, tile);
}

// Adds the diffuse reflection of the previous bounce's light, which rays gather.
static void add_traced(const olx_gather *gather, olx_shade_scratch *scratch, uint32_t probe) {
  olx_shade_batch *roots = &scratch->roots;
  const size_t first = (size_t)probe * olx_gather_points(&gather->quadrature);
  for (uint32_t k = 0; k < roots->count; k++) {
    const olx_vec3 irradiance = olx_traced_irradiance(&gather->traced, first + scratch->owner[k], gather->bounce - 1);
    roots->radiance[k] = olx_madd(roots->radiance[k], olx_mul(roots->diffuse[k], irradiance), 1.0f);
  }
}

// Stores the light that rays of the next bounce will gather.
static void keep_traced(const olx_gather *gather, const olx_shade_scratch *scratch, uint32_t probe) {
  const size_t first = (size_t)probe * olx_gather_points(&gather->quadrature);
  olx_vec3 *light = olx_traced_light(&gather->traced, gather->bounce);
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    const size_t point = first + scratch->owner[k];
    light[point] = olx_add(gather->traced.direct[point], scratch->roots.radiance[k]);
  }
}

// Computes the light of one batch of a probe's gather points.
static void bounce_job(void *user, uint32_t index) {
  const olx_gather *gather = user;
  const olx_quadrature *q = &gather->quadrature;
  const uint32_t points = olx_gather_points(q), batches = points / OLX_BATCH_POINTS, probe = index / batches;
  const uint32_t per_cell = olx_samples_per_cell(q), per_quarter = per_cell / 4;
  const uint32_t first = index % batches * OLX_BATCH_POINTS, per_tile = OLX_BATCH_POINTS / per_quarter;
  const size_t cell_base = (size_t)probe * q->cells * q->cells;
  olx_shade_scratch *scratch = olx_shade_scratch_take(gather->shade);
  if (!scratch) return;
  uint32_t reflections = 0;
  olx_shade_batch_begin(&scratch->roots, 1);
  for (uint32_t k = 0; k < OLX_BATCH_POINTS; k++) {
    const uint32_t point = first + k, tile = point / per_tile, quarter = point % per_tile;
    const uint32_t i = quarter * per_quarter + olx_picked_sample(key_of(gather, probe), point, per_quarter);
    const olx_sample_place p = olx_place_of(q, tile, i);
    if (k % 4 == 0) gather->total[cell_base + p.cell] = gather->direct[cell_base + p.cell];
    const olx_ray_hit *hit = &gather->hits[(size_t)probe * points + point];
    if (hit->triangle == OLX_NO_HIT) continue;
    const uint32_t root =
        olx_shade_append(gather->shade, &scratch->roots, hit, olx_sample_direction(q, key_of(gather, probe), p),
                         olx_cell_seed(probe, p.cell), i % per_cell);
    scratch->slot[root] = p.cell;
    scratch->owner[root] = point;
    scratch->weights[root] = olx_quarter_solid_angle(q, tile, quarter, per_quarter) / q->cell_solid_angle[p.cell];
    if (!scratch->roots.reflects[root]) continue;
    scratch->paths[0][reflections++] = (olx_shade_path){.root = root, .from = root, .throughput = olx_splat(1.0f)};
  }
  if (gather->traces) add_traced(gather, scratch, probe);
  else olx_shade_diffuse(gather->shade, &scratch->roots, gather->bounce - 1);
  olx_shade_reflections(gather->shade, scratch, reflections, gather->bounce, OLX_REFLECT_BOUNCES);
  if (gather->traces) keep_traced(gather, scratch, probe);
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    olx_vec3 *cell = &gather->total[cell_base + scratch->slot[k]];
    *cell = olx_madd(*cell, scratch->roots.radiance[k], scratch->weights[k]);
  }
  olx_shade_scratch_give(gather->shade, scratch);
}

olx_result olx_gather_bounce(olx_gather *gather, uint32_t bounce) {
  olx_task_stage(&gather->context->task, "bounces");
  gather->bounce = bounce;
  const uint32_t batches = olx_gather_points(&gather->quadrature) / OLX_BATCH_POINTS;
  OLX_TRY(
      olx_bake_for(gather->context, olx_gather_probes(gather)->count * batches, bounce_job, gather, OLX_BATCH_POINTS));
  return olx_shade_check_memory(gather->shade);
}

olx_result olx_gather_link(olx_gather *gather) {
  if (!gather->traces) return OLX_OK;
  olx_task_stage(&gather->context->task, "rays between surfaces");
  return olx_traced_bounce_link(&gather->traced);
}

static double total(const olx_gather *gather, uint32_t bounce) {
  const olx_vec3 *maps = gather->maps.irradiance[bounce % (OLX_KEPT_BOUNCES + 1)];
  const size_t count = (size_t)olx_gather_probes(gather)->count * (gather->maps.size + 2) * (gather->maps.size + 2);
  double sum = 0.0;
  for (size_t i = 0; i < count; i++) sum += (double)olx_luminance(maps[i]);
  return sum;
}

bool olx_gather_brought_light(const olx_gather *gather, uint32_t bounce) {
  const double now = total(gather, bounce);
  return now - total(gather, bounce - 1) >= 0x1p-10 * now;
}

void olx_gather_skip(olx_gather *gather, uint32_t bounces) {
  const uint64_t points = (uint64_t)olx_gather_probes(gather)->count * olx_gather_points(&gather->quadrature);
  olx_task_advance(&gather->context->task, bounces * points);
}
