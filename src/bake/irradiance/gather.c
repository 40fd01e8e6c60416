// Casts rays from irradiance probes, integrates the radiance and the distances they find, fits irradiance to surfaces,
// and writes the maps. Light comes from the solution for the whole scene, or from bounces between the probes.
#include "bake/irradiance/gather.h"

#include "bake/arrays.h"
#include "bake/irradiance/border.h"
#include "bake/irradiance/gather_bounces.h"
#include "bake/irradiance/gather_points.h"
#include "bake/irradiance/harmonics_fit.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "light/ray_light.h"
#include "scene/bvh.h"

#include <string.h>

enum {
  SOLVED_POINTS = 64, // gather points across which light samples are stratified
  SALT_SOLVED = 0x534F4C56,
  BEAMS = 1024, // samples of the surfaces near lamps, a probe
  SALT_BEAM = 0x4245414D
};

static uint32_t key_of(const olx_gather *gather, uint32_t probe) { return olx_shade_key(gather->shade, probe); }

static void cast_tile(const olx_gather *gather, olx_shade_scratch *scratch, uint32_t tile) {
  const olx_quadrature *q = &gather->quadrature;
  const olx_vec3 origin = olx_gather_probes(gather)->positions[gather->probe];
  for (uint32_t i = 0; i < OLX_BATCH_POINTS; i++) {
    const olx_sample_place p = olx_place_of(q, tile, i);
    scratch->directions[i] = olx_sample_direction(q, key_of(gather, gather->probe), p);
    scratch->weights[i] = q->sample_solid_angle[p.y * q->sample_size + p.x];
    scratch->rays[i] = (olx_ray){origin, scratch->directions[i], 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(gather->shade->scene->light_bvh, scratch->rays, OLX_BATCH_POINTS, true, scratch->hits);
  atomic_fetch_add_explicit(&gather->shade->rays, OLX_BATCH_POINTS, memory_order_relaxed);
}

static void sum_distances(const olx_gather *gather, const olx_shade_scratch *scratch, uint32_t tile) {
  const olx_quadrature *q = &gather->quadrature;
  const uint32_t per_cell = q->sample_size / q->distance_cells;
  for (uint32_t i = 0; i < OLX_BATCH_POINTS; i++) {
    const olx_sample_place p = olx_place_of(q, tile, i);
    const uint32_t c = p.y / per_cell * q->distance_cells + p.x / per_cell;
    const bool sky = scratch->hits[i].triangle == OLX_NO_HIT;
    const float r = sky ? 1.0f : olx_min(scratch->hits[i].t / gather->context->distance_scale, 1.0f);
    const float share = scratch->weights[i] / q->distance_weight[c];
    gather->distances[c].x += share * r;
    gather->distances[c].y += share * r * r;
  }
}

static void keep_hits(const olx_gather *gather, const olx_shade_scratch *scratch, uint32_t tile) {
  const olx_quadrature *q = &gather->quadrature;
  const uint32_t probe = gather->probe, per_quarter = olx_samples_per_cell(q) / 4;
  const uint32_t points = OLX_BATCH_POINTS / per_quarter, first = tile * points;
  olx_ray_hit *hits = gather->hits + (size_t)probe * olx_gather_points(q) + first;
  for (uint32_t i = 0; i < points; i++) {
    hits[i] = scratch->hits[i * per_quarter + olx_picked_sample(key_of(gather, probe), first + i, per_quarter)];
  }
}

static void look_job(void *user, uint32_t tile) {
  const olx_gather *gather = user;
  olx_shade_scratch *scratch = olx_shade_scratch_take(gather->shade);
  if (!scratch) return;
  cast_tile(gather, scratch, tile);
  sum_distances(gather, scratch, tile);
  keep_hits(gather, scratch, tile);
  if (!gather->light) olx_gather_light_tile(gather, scratch, tile);
  olx_shade_scratch_give(gather->shade, scratch);
}

static size_t bordered(uint32_t n) { return (size_t)(n + 2) * (n + 2); }

static void moments_job(void *user, uint32_t row) {
  const olx_gather *gather = user;
  const uint32_t n = gather->quadrature.irradiance_size, stride = n + 2;
  olx_vec2 *map = gather->moments + gather->probe * bordered(n) + stride + 1;
  olx_quadrature_moments(&gather->quadrature, gather->distances, row, map, stride);
}

olx_result olx_gather_look(olx_gather *gather) {
  const olx_quadrature *q = &gather->quadrature;
  olx_task_stage(&gather->context->task, gather->light ? "irradiance probes" : "direct light");
  for (uint32_t probe = 0; probe < olx_gather_probes(gather)->count; probe++) {
    gather->probe = probe;
    memset(gather->distances, 0, (size_t)q->distance_cells * q->distance_cells * sizeof(olx_vec2));
    OLX_TRY(olx_bake_for(gather->context, olx_gather_tiles(q), look_job, gather, OLX_BATCH_POINTS));
    OLX_TRY(olx_shade_check_memory(gather->shade));
    OLX_TRY(olx_bake_for(gather->context, q->irradiance_size / OLX_BLOCK_ROWS, moments_job, gather, 0));
    olx_fill_border(gather->moments + probe * bordered(q->irradiance_size), q->irradiance_size, sizeof(olx_vec2));
  }
  return OLX_OK;
}

// The cell that holds a gather point, and the point's share of it.
typedef struct point_place {
  olx_sample_place sample;
  float share;
} point_place;

static point_place place_of_point(const olx_gather *gather, uint32_t probe, uint32_t point) {
  const olx_quadrature *q = &gather->quadrature;
  const uint32_t per_quarter = olx_samples_per_cell(q) / 4, per_tile = OLX_BATCH_POINTS / per_quarter;
  const uint32_t tile = point / per_tile, quarter = point % per_tile;
  const uint32_t i = quarter * per_quarter + olx_picked_sample(key_of(gather, probe), point, per_quarter);
  const olx_sample_place p = olx_place_of(q, tile, i);
  return (point_place){p, olx_quarter_solid_angle(q, tile, quarter, per_quarter) / q->cell_solid_angle[p.cell]};
}

// Looks up the solved light of SOLVED_POINTS gather points of a probe, which fill whole cells.
static void solved_job(void *user, uint32_t index) {
  const olx_gather *gather = user;
  const olx_quadrature *q = &gather->quadrature;
  const uint32_t points = olx_gather_points(q), jobs = points / SOLVED_POINTS, probe = index / jobs;
  const uint32_t first = index % jobs * SOLVED_POINTS, key = key_of(gather, probe);
  const uint32_t bounces = olx_scene_light_bounces(gather->light);
  olx_vec3 *cells = gather->total + (size_t)probe * q->cells * q->cells;
  uint64_t rays = 0;
  for (uint32_t point = first; point < first + SOLVED_POINTS; point++) {
    const point_place p = place_of_point(gather, probe, point);
    olx_vec3 *cell = &cells[p.sample.cell];
    if (point % 4 == 0) *cell = olx_splat(0.0f);
    const olx_ray_hit *hit = &gather->hits[(size_t)probe * points + point];
    if (hit->triangle == OLX_NO_HIT) continue;
    const olx_ray ray = {olx_gather_probes(gather)->positions[probe], olx_sample_direction(q, key, p.sample), 0.0f,
                         INFINITY};
    olx_sampler sampler = {.seed = olx_hash3(key, first, SALT_SOLVED), .index = point - first};
    const olx_vec3 light =
        olx_ray_light_but_near_lamps(gather->shade->scene, gather->light, bounces, &ray, hit, &sampler, &rays);
    *cell = olx_madd(*cell, light, p.share);
  }
  atomic_fetch_add_explicit(&gather->shade->rays, rays, memory_order_relaxed);
}

// Adds the light of surfaces near lamps, which solved_job leaves out, to the cells of a probe.
static void beams_job(void *user, uint32_t probe) {
  const olx_gather *gather = user;
  const olx_quadrature *q = &gather->quadrature;
  const olx_vec3 position = olx_gather_probes(gather)->positions[probe];
  const uint32_t seed = olx_hash2(key_of(gather, probe), SALT_BEAM);
  olx_vec3 *cells = gather->total + (size_t)probe * q->cells * q->cells;
  uint64_t rays = 0;
  for (uint32_t i = 0; i < BEAMS; i++) {
    olx_sampler sampler = {.seed = seed, .index = i};
    olx_lamp_beam beam;
    if (!olx_scene_light_beam(gather->shade->scene, gather->light, position, &sampler, &beam, &rays)) continue;
    const olx_vec2 uv = olx_octahedral_encode(beam.direction);
    const uint32_t x = (uint32_t)(uv.x * (float)q->cells), y = (uint32_t)(uv.y * (float)q->cells), last = q->cells - 1;
    const uint32_t cell = (y < last ? y : last) * q->cells + (x < last ? x : last);
    cells[cell] = olx_madd(cells[cell], beam.irradiance, 1.0f / ((float)BEAMS * q->cell_solid_angle[cell]));
  }
  atomic_fetch_add_explicit(&gather->shade->rays, rays, memory_order_relaxed);
}

olx_result olx_gather_solved(olx_gather *gather) {
  const uint32_t jobs = olx_gather_points(&gather->quadrature) / SOLVED_POINTS,
                 probes = olx_gather_probes(gather)->count;
  OLX_TRY(olx_bake_for(gather->context, probes * jobs, solved_job, gather, SOLVED_POINTS));
  if (olx_scene_light_bounces(gather->light) == 0) return OLX_OK;
  return olx_bake_for(gather->context, probes, beams_job, gather, 0);
}

static const olx_vec3 *cells_of(const olx_gather *gather, uint32_t probe) {
  const olx_vec3 *radiance = gather->light || gather->bounce > 0 ? gather->total : gather->direct;
  return radiance + (size_t)probe * gather->quadrature.cells * gather->quadrature.cells;
}

static olx_vec3 *bounce_maps(const olx_gather *gather, uint32_t bounce) {
  return gather->maps.irradiance[bounce % (OLX_KEPT_BOUNCES + 1)];
}

static void irradiance_job(void *user, uint32_t index) {
  const olx_gather *gather = user;
  const uint32_t n = gather->maps.size, rows = n / OLX_BLOCK_ROWS, probe = index / rows, stride = n + 2;
  olx_vec3 *map = bounce_maps(gather, gather->bounce) + probe * bordered(n) + stride + 1;
  olx_quadrature_irradiance(&gather->quadrature, cells_of(gather, probe), n, index % rows, map, stride);
}

olx_result olx_gather_irradiance(olx_gather *gather, uint32_t bounce) {
  gather->bounce = bounce;
  const uint32_t n = gather->maps.size;
  OLX_TRY(olx_bake_for(gather->context, olx_gather_probes(gather)->count * (n / OLX_BLOCK_ROWS), irradiance_job, gather,
                       0));
  for (uint32_t probe = 0; probe < olx_gather_probes(gather)->count; probe++) {
    olx_fill_border(bounce_maps(gather, bounce) + probe * bordered(n), n, sizeof(olx_vec3));
  }
  return OLX_OK;
}

static olx_vec3 corrected(const olx_gather *gather, uint32_t probe, uint32_t x, uint32_t y, uint32_t n,
                          olx_vec3 value) {
  const olx_vec2 uv = {((float)x + 0.5f) / (float)n, ((float)y + 0.5f) / (float)n};
  return olx_max_each(olx_add(value, olx_surface_fit_correction(gather->fit, probe, uv)), olx_splat(0.0f));
}

static void correct_job(void *user, uint32_t probe) {
  const olx_gather *gather = user;
  const uint32_t n = gather->maps.size, stride = n + 2;
  olx_vec3 *map = bounce_maps(gather, gather->bounce) + probe * bordered(n);
  for (uint32_t y = 0; y < n; y++) {
    for (uint32_t x = 0; x < n; x++) {
      olx_vec3 *texel = &map[(y + 1) * stride + x + 1];
      *texel = corrected(gather, probe, x, y, n, *texel);
    }
  }
  olx_fill_border(map, n, sizeof(olx_vec3));
}

olx_result olx_gather_fit(olx_gather *gather, uint32_t bounce) {
  if (!gather->fit) {
    olx_task_stage(&gather->context->task, "surfaces");
    const olx_surface_fit_input input = {.context = gather->context,
                                         .shade = gather->shade,
                                         .hits = gather->hits,
                                         .hit_count = olx_gather_points(&gather->quadrature),
                                         .light = gather->light};
    OLX_TRY(olx_surface_fit_create(&input, olx_bounce_source(&gather->maps, bounce), &gather->fit));
  }
  gather->bounce = bounce;
  OLX_TRY(olx_surface_fit_solve(gather->fit, olx_bounce_source(&gather->maps, bounce), bounce));
  return olx_bake_for(gather->context, olx_gather_probes(gather)->count, correct_job, gather, 0);
}

static void final_job(void *user, uint32_t row) {
  const olx_gather *gather = user;
  const uint32_t n = gather->quadrature.irradiance_size;
  olx_quadrature_irradiance(&gather->quadrature, cells_of(gather, gather->probe), n, row, gather->irradiance, n);
}

// Computes one probe's final map, without correction.
static olx_result make_final(olx_gather *gather, uint32_t probe) {
  gather->probe = probe;
  const uint32_t rows = gather->quadrature.irradiance_size / OLX_BLOCK_ROWS;
  return olx_bake_for(gather->context, rows, final_job, gather, 0);
}

// Projects all probes' final irradiance onto spherical harmonics and fits it to surfaces.
static olx_result make_harmonics(olx_gather *gather) {
  const uint32_t bands = gather->projection.bands, count = olx_harmonics_count(bands);
  gather->harmonics = olx_allocate((size_t)olx_gather_probes(gather)->count * count, sizeof *gather->harmonics);
  if (!gather->harmonics) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for spherical harmonics");
  for (uint32_t probe = 0; probe < olx_gather_probes(gather)->count; probe++) {
    OLX_TRY(make_final(gather, probe));
    olx_project(&gather->projection, gather->irradiance, gather->harmonics + (size_t)probe * count);
  }
  return gather->fit ? olx_harmonics_fit(gather->fit, bands, gather->harmonics, olx_gather_probes(gather)->count)
                     : OLX_OK;
}

// Packs one probe's final irradiance as the file stores it: at most a word per texel.
static olx_result pack_irradiance(olx_gather *gather, uint32_t probe, uint32_t *packed) {
  const uint32_t n = gather->quadrature.irradiance_size, bands = gather->projection.bands;
  if (gather->harmonics) {
    const olx_vec3 *coefficients = gather->harmonics + (size_t)probe * olx_harmonics_count(bands);
    olx_harmonics_pack(coefficients, bands, (uint16_t *)packed);
    return OLX_OK;
  }
  OLX_TRY(make_final(gather, probe));
  for (uint32_t i = 0; i < n * n; i++) {
    const olx_vec3 exact = gather->irradiance[i];
    packed[i] = olx_r11g11b10f_pack(gather->fit ? corrected(gather, probe, i % n, i / n, n, exact) : exact);
  }
  return OLX_OK;
}

size_t olx_gather_record_words(const olx_gather *gather) {
  return 2 * (size_t)gather->quadrature.irradiance_size * gather->quadrature.irradiance_size;
}

olx_result olx_gather_finish(olx_gather *gather) {
  return gather->context->settings->irradiance_form == OLX_IRRADIANCE_OCTAHEDRAL || gather->harmonics
             ? OLX_OK
             : make_harmonics(gather);
}

olx_result olx_gather_pack(olx_gather *gather, uint32_t probe, uint32_t *record) {
  const uint32_t n = gather->quadrature.irradiance_size;
  const size_t texels = (size_t)n * n;
  const olx_vec2 *moments = gather->moments + probe * bordered(n) + n + 3;
  OLX_TRY(pack_irradiance(gather, probe, record));
  for (uint32_t i = 0; i < texels; i++) {
    const olx_vec2 m = moments[i / n * (n + 2) + i % n];
    record[texels + i] = olx_half_pack(m.x) | (uint32_t)olx_half_pack(m.y) << 16;
  }
  return OLX_OK;
}

enum { GATHER_ARRAYS = 6 + OLX_KEPT_BOUNCES + 1 };

// Returns the number of maps that are stored: one for each bounce, up to as many as later bounces read.
static uint32_t kept_maps(bool solved, uint32_t bounces) {
  if (solved) return 1;
  return bounces < OLX_KEPT_BOUNCES ? bounces + 1 : OLX_KEPT_BOUNCES + 1;
}

static uint32_t list_arrays(olx_gather *g, const olx_quadrature *q, bool solved, uint32_t bounces,
                            olx_array_row rows[GATHER_ARRAYS]) {
  const uint64_t probes = olx_gather_probes(g)->count, cells = (uint64_t)q->cells * q->cells, size = q->irradiance_size;
  const uint64_t map = bordered(size < 64 ? q->irradiance_size : 64);
  uint32_t count = 0;
  rows[count++] = (olx_array_row){&g->hits, probes * olx_gather_points(q), sizeof *g->hits, false};
  if (!solved) rows[count++] = (olx_array_row){&g->direct, probes * cells, sizeof *g->direct, true};
  rows[count++] =
      (olx_array_row){&g->distances, (uint64_t)q->distance_cells * q->distance_cells, sizeof *g->distances, false};
  rows[count++] = (olx_array_row){&g->moments, probes * bordered(q->irradiance_size), sizeof *g->moments, false};
  rows[count++] = (olx_array_row){&g->irradiance, size * size, sizeof *g->irradiance, false};
  if (solved || bounces > 0) rows[count++] = (olx_array_row){&g->total, probes * cells, sizeof *g->total, false};
  for (uint32_t k = 0; k < kept_maps(solved, bounces); k++) {
    rows[count++] = (olx_array_row){&g->maps.irradiance[k], probes * map, sizeof *g->maps.irradiance[k], false};
  }
  return count;
}

uint64_t olx_gather_bytes(const olx_gather *gather, uint32_t irradiance_size, uint32_t bounces, bool solved,
                          bool fits) {
  const olx_quadrature q = olx_quadrature_shape(irradiance_size);
  olx_gather unmade = *gather;
  olx_array_row rows[GATHER_ARRAYS];
  const uint32_t bands = olx_irradiance_bands(gather->context->settings->irradiance_form),
                 count = list_arrays(&unmade, &q, solved, bounces, rows);
  uint64_t bytes = olx_arrays_bytes(rows, count);
  if (fits) bytes += olx_surface_fit_bytes(olx_gather_probes(gather)->count, solved);
  if (bands)
    bytes += (uint64_t)olx_gather_probes(gather)->count * olx_harmonics_count(bands) * sizeof *gather->harmonics;
  if (gather->traces && bounces > 0)
    bytes += olx_traced_bounce_bytes(olx_gather_probes(gather)->count, olx_gather_points(&q));
  return bytes;
}

// Describes the maps of bounces to their readers, once they are allocated.
static void describe_maps(olx_gather *gather, const olx_grid *grid, uint32_t irradiance_size, uint32_t kept) {
  olx_bounce_maps *maps = &gather->maps;
  maps->size = irradiance_size < 64 ? irradiance_size : 64;
  for (uint32_t k = 0; k < kept; k++) {
    maps->sources[k] = (olx_irradiance_source){.grid = *grid,
                                               .flags = olx_gather_probes(gather)->flags,
                                               .distance_scale = gather->context->distance_scale,
                                               .irradiance_n = maps->size,
                                               .moments_n = irradiance_size,
                                               .irradiance = maps->irradiance[k],
                                               .moments = gather->moments};
  }
  gather->shade->bounces = maps;
}

olx_result olx_gather_create(olx_gather *gather, const olx_grid *grid, uint32_t irradiance_size, uint32_t bounces) {
  OLX_TRY(olx_quadrature_create(irradiance_size, &gather->quadrature));
  const uint32_t bands = olx_irradiance_bands(gather->context->settings->irradiance_form);
  if (bands) OLX_TRY(olx_projection_create(bands, irradiance_size, &gather->projection));
  const uint32_t probes = olx_gather_probes(gather)->count;
  olx_array_row rows[GATHER_ARRAYS];
  const bool complete =
      olx_arrays_allocate(rows, list_arrays(gather, &gather->quadrature, gather->light, bounces, rows));
  describe_maps(gather, grid, irradiance_size, kept_maps(gather->light, bounces));
  if (!complete) {
    olx_gather_free(gather); // olx_gather_free resets the number of probes
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for %u irradiance probes", probes);
  }
  gather->traces = gather->traces && bounces > 0;
  if (!gather->traces) return OLX_OK;
  gather->traced = (olx_traced_bounce){.context = gather->context,
                                       .shade = gather->shade,
                                       .quadrature = &gather->quadrature,
                                       .grid = &gather->maps.sources[0].grid,
                                       .hits = gather->hits};
  return olx_traced_bounce_create(&gather->traced);
}

void olx_gather_free(olx_gather *gather) {
  olx_quadrature_free(&gather->quadrature);
  olx_projection_free(&gather->projection);
  olx_surface_fit_free(gather->fit);
  olx_traced_bounce_free(&gather->traced);
  olx_release(gather->hits);
  olx_release(gather->direct);
  olx_release(gather->total);
  olx_release(gather->distances);
  olx_release(gather->moments);
  olx_release(gather->irradiance);
  olx_release(gather->harmonics);
  for (uint32_t k = 0; k <= OLX_KEPT_BOUNCES; k++) olx_release(gather->maps.irradiance[k]);
  *gather = (olx_gather){0};
}

uint64_t olx_gather_units(const olx_gather *gather, uint32_t bounces, bool solved) {
  const olx_quadrature *q = &gather->quadrature;
  const uint64_t samples = (uint64_t)q->sample_size * q->sample_size;
  const uint64_t traced = gather->traces ? (uint64_t)OLX_BOUNCE_RAYS * olx_gather_points(q) : 0;
  const uint64_t passes = solved ? 1 : bounces;
  return olx_gather_probes(gather)->count * (samples + traced + passes * olx_gather_points(q));
}
