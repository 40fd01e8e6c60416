// Measures irradiance at points on surfaces, and finds the corrections of probes' maps with which interpolation comes
// closest to it, by conjugate gradients.
#include "bake/irradiance/surface_fit.h"

#include "bake/arrays.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"

#include <string.h>

enum {
  POINTS_PER_PROBE = OLX_FIT_POINTS_PER_PROBE,
  RAYS_PER_POINT = OLX_FIT_RAYS,
  POINTS_PER_JOB = OLX_BATCH_POINTS / RAYS_PER_POINT,
  STEPS = 48, // of conjugate gradients
  SALT_POINT = 0x46495450,
  SALT_RAY = 0x46495452
};

// A surface point, its measured irradiance and how it is interpolated.
typedef struct fit_point {
  olx_vec3 position, normal; // moved off the surface
  olx_vec3 direct;           // irradiance from surfaces with direct light alone; with a solution, from all light
  olx_vec3 measured;         // irradiance of the bounce that was fitted last
  olx_vec3 residual;         // measured less interpolated irradiance
  olx_irradiance_weights weights;
  olx_correction_cells cells; // around the normal
  bool valid;
} fit_point;

struct olx_surface_fit {
  olx_surface_fit_input input;
  uint32_t point_count;
  fit_point *points;
  olx_ray_hit *hits; // RAYS_PER_POINT a point
  const olx_irradiance_source *source;
  uint32_t bounce;
  olx_corrections corrections;
};

static uint32_t jobs_of(const olx_surface_fit *fit) { return fit->point_count / POINTS_PER_JOB; }

static uint64_t units_of_point(bool solved) { return solved ? 1 : RAYS_PER_POINT; }

uint64_t olx_surface_fit_units(uint32_t probe_count, bool solved) {
  return (uint64_t)probe_count * POINTS_PER_PROBE * units_of_point(solved);
}

// Returns a ray from a surface into the half space it faces, cosine distributed.
static olx_ray scattered_ray(const olx_surface *surface, uint32_t index, uint32_t seed) {
  const olx_vec3 local = olx_sample_cosine(olx_stratified2(index, seed));
  return olx_surface_ray(surface, olx_normalize(olx_from_basis(local, surface->geometric_normal)), INFINITY);
}

// Draws a surface point: the end of a ray that is scattered from a surface which the probe sees. Such points are spread
// about evenly over the area of all surfaces, including those that no probe sees.
static bool draw_point(const olx_surface_fit *fit, uint32_t index, olx_surface *surface) {
  const olx_surface_fit_input *in = &fit->input;
  const uint32_t probe = index / POINTS_PER_PROBE, i = index % POINTS_PER_PROBE;
  if (in->context->probes.irradiance.flags[probe] & OLX_PROBE_BURIED) return false;
  const uint32_t step = in->hit_count / POINTS_PER_PROBE;
  const uint32_t at = i * step + olx_hash3(olx_shade_key(in->shade, probe), i, SALT_POINT) % step;
  const olx_ray_hit *seen = &in->hits[(size_t)probe * in->hit_count + at];
  if (seen->triangle == OLX_NO_HIT) return false;
  olx_surface first;
  {
    // The gather point's side is the one that faces the probe.
    const olx_surface any = olx_surface_at(in->shade->scene, seen, olx_v3(0.0f, 1.0f, 0.0f));
    const olx_vec3 view = olx_normalize(olx_sub(any.position, in->context->probes.irradiance.positions[probe]));
    first = olx_surface_at(in->shade->scene, seen, view);
  }
  const olx_ray ray = scattered_ray(&first, i, olx_hash2(olx_shade_key(in->shade, probe), SALT_POINT));
  const olx_ray_hit hit = olx_bvh_intersect(in->shade->scene->light_bvh, &ray);
  if (hit.triangle == OLX_NO_HIT) return false;
  *surface = olx_surface_at(in->shade->scene, &hit, ray.direction);
  return olx_max3(surface->emission) <= 0.0f && olx_max3(surface->bsdf.albedo) > 0.0f;
}

static void place_point(const olx_surface_fit *fit, const olx_surface *surface, fit_point *point) {
  point->valid = true;
  point->position = olx_madd(surface->position, surface->geometric_normal, surface->epsilon);
  point->normal = surface->geometric_normal;
  point->weights =
      olx_irradiance_weigh(fit->source, OLX_WEIGHT_ALL, false, point->position, point->normal, point->normal);
  point->cells = olx_correction_cells_at(olx_octahedral_encode(point->normal));
}

static uint32_t ray_seed(const olx_surface_fit *fit, uint32_t point) {
  return olx_hash2(olx_shade_key(fit->input.shade, point), SALT_RAY);
}

// Appends the surfaces that a point's rays met to the batch.
static void append_hits(const olx_surface_fit *fit, uint32_t index, olx_shade_scratch *scratch) {
  const fit_point *point = &fit->points[index];
  for (uint32_t j = 0; j < RAYS_PER_POINT; j++) {
    const olx_ray_hit *hit = &fit->hits[(size_t)index * RAYS_PER_POINT + j];
    if (hit->triangle == OLX_NO_HIT) continue;
    const olx_vec3 local = olx_sample_cosine(olx_stratified2(j, ray_seed(fit, index)));
    const olx_vec3 direction = olx_normalize(olx_from_basis(local, point->normal));
    const uint32_t root =
        olx_shade_append(fit->input.shade, &scratch->roots, hit, direction, olx_hash2(ray_seed(fit, index), j), 0);
    scratch->slot[root] = index;
  }
}

// Draws one ray through the specular lobe of every point that has a narrow one; returns their count.
static uint32_t choose_reflections(olx_shade_scratch *scratch) {
  uint32_t count = 0;
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    if (!scratch->roots.reflects[k]) continue;
    scratch->paths[0][count++] = (olx_shade_path){.root = k, .from = k, .throughput = olx_splat(1.0f)};
  }
  return count;
}

// Returns the solution's irradiance at the point, about the geometric normal, as the point's rays are.
static olx_vec3 solved_irradiance(const olx_surface_fit *fit, const olx_surface *surface) {
  olx_surface flat = *surface;
  flat.shading_normal = surface->geometric_normal;
  return olx_scene_light_irradiance(fit->input.light, &flat);
}

// Draws the points of one job, casts their rays, and sums the light of surfaces that carry direct light.
static void cast_job(void *user, uint32_t job) {
  olx_surface_fit *fit = user;
  const uint32_t first = job * POINTS_PER_JOB;
  olx_shade_scratch *scratch = olx_shade_scratch_take(fit->input.shade);
  if (!scratch) return;
  uint64_t cast = POINTS_PER_JOB;
  olx_shade_batch_begin(&scratch->roots, 1);
  for (uint32_t index = first; index < first + POINTS_PER_JOB; index++) {
    fit_point *point = &fit->points[index];
    olx_surface surface;
    *point = (fit_point){.valid = false};
    if (!draw_point(fit, index, &surface)) continue;
    place_point(fit, &surface, point);
    if (fit->input.light) {
      point->direct = solved_irradiance(fit, &surface);
      continue;
    }
    for (uint32_t j = 0; j < RAYS_PER_POINT; j++) scratch->rays[j] = scattered_ray(&surface, j, ray_seed(fit, index));
    olx_bvh_intersect_many(fit->input.shade->scene->light_bvh, scratch->rays, RAYS_PER_POINT, false,
                           fit->hits + (size_t)index * RAYS_PER_POINT);
    cast += RAYS_PER_POINT;
    append_hits(fit, index, scratch);
  }
  atomic_fetch_add_explicit(&fit->input.shade->rays, cast, memory_order_relaxed);
  const uint32_t reflections = choose_reflections(scratch);
  olx_shade_direct(fit->input.shade, scratch, &scratch->roots);
  olx_shade_reflections(fit->input.shade, scratch, reflections, 0, OLX_REFLECT_LIGHTS);
  for (uint32_t k = 0; k < scratch->roots.count; k++) {
    fit_point *point = &fit->points[scratch->slot[k]];
    point->direct = olx_madd(point->direct, scratch->roots.radiance[k], OLX_PI / RAYS_PER_POINT);
  }
  olx_shade_scratch_give(fit->input.shade, scratch);
}

static void interpolate(const olx_surface_fit *fit, fit_point *point, olx_vec3 measured) {
  const olx_irradiance_source *source = fit->source;
  const olx_bilinear texels = olx_bilinear_at(olx_octahedral_encode(point->normal), source->irradiance_n);
  const size_t map = (size_t)(source->irradiance_n + 2) * (source->irradiance_n + 2);
  olx_vec3 sum = {0};
  for (uint32_t k = 0; k < point->weights.count; k++) {
    const olx_vec3 *texel = source->irradiance + map * point->weights.probe[k];
    for (uint32_t i = 0; i < 4; i++) {
      sum = olx_madd(sum, texel[texels.index[i]], texels.weight[i] * point->weights.weight[k]);
    }
  }
  point->measured = measured;
  point->residual = olx_sub(measured, sum);
}

// Measures the irradiance of a job's points with the light of earlier bounces, and the difference from what is
// interpolated.
static void measure_job(void *user, uint32_t job) {
  olx_surface_fit *fit = user;
  const uint32_t first = job * POINTS_PER_JOB;
  olx_shade_scratch *scratch = olx_shade_scratch_take(fit->input.shade);
  if (!scratch) return;
  uint32_t reflections = 0;
  const bool bounces = fit->bounce > 0 && !fit->input.light;
  olx_shade_batch_begin(&scratch->roots, 1);
  olx_vec3 measured[POINTS_PER_JOB];
  for (uint32_t i = 0; i < POINTS_PER_JOB; i++) {
    measured[i] = fit->points[first + i].direct;
    if (bounces && fit->points[first + i].valid) append_hits(fit, first + i, scratch);
  }
  if (bounces) {
    reflections = choose_reflections(scratch);
    olx_shade_diffuse(fit->input.shade, &scratch->roots, fit->bounce - 1);
    olx_shade_reflections(fit->input.shade, scratch, reflections, fit->bounce, OLX_REFLECT_BOUNCES);
    for (uint32_t k = 0; k < scratch->roots.count; k++) {
      olx_vec3 *sum = &measured[scratch->slot[k] - first];
      *sum = olx_madd(*sum, scratch->roots.radiance[k], OLX_PI / RAYS_PER_POINT);
    }
  }
  for (uint32_t i = 0; i < POINTS_PER_JOB; i++) {
    if (fit->points[first + i].valid) interpolate(fit, &fit->points[first + i], measured[i]);
  }
  olx_shade_scratch_give(fit->input.shade, scratch);
}

static olx_correction_taps taps_of(const fit_point *point) {
  const olx_irradiance_weights *w = &point->weights;
  return (olx_correction_taps){.count = w->count, .probes = w->probe, .weights = w->weight, .cells = &point->cells};
}

static void multiply(const olx_surface_fit *fit, const olx_vec3 *x, olx_vec3 *product) {
  memset(product, 0, fit->corrections.unknowns * sizeof *product);
  for (uint32_t i = 0; i < fit->point_count; i++) {
    if (!fit->points[i].valid) continue;
    const olx_correction_taps taps = taps_of(&fit->points[i]);
    olx_corrections_scatter(product, &taps, olx_corrections_predict(x, &taps));
  }
  olx_corrections_penalize(&fit->corrections, x, POINTS_PER_PROBE, product);
}

static void solve(olx_surface_fit *fit) {
  olx_corrections *c = &fit->corrections;
  memset(c->solution, 0, c->unknowns * sizeof *c->solution);
  memset(c->gradient, 0, c->unknowns * sizeof *c->gradient);
  for (uint32_t i = 0; i < fit->point_count; i++) {
    if (!fit->points[i].valid) continue;
    const olx_correction_taps taps = taps_of(&fit->points[i]);
    olx_corrections_scatter(c->gradient, &taps, fit->points[i].residual);
  }
  olx_corrections_begin(c);
  for (uint32_t step = 0; step < STEPS; step++) {
    multiply(fit, c->direction, c->product);
    olx_corrections_step(c);
  }
}

static uint32_t list_arrays(olx_surface_fit *fit, bool solved, olx_array_row rows[2]) {
  const uint64_t points = fit->point_count;
  rows[0] = (olx_array_row){&fit->points, points, sizeof *fit->points, false};
  rows[1] = (olx_array_row){&fit->hits, points * RAYS_PER_POINT, sizeof *fit->hits, false};
  return solved ? 1 : 2;
}

uint64_t olx_surface_fit_bytes(uint32_t probe_count, bool solved) {
  olx_surface_fit fit = {.point_count = probe_count * POINTS_PER_PROBE};
  olx_array_row rows[2];
  return olx_arrays_bytes(rows, list_arrays(&fit, solved, rows)) +
         olx_corrections_bytes((size_t)probe_count * OLX_CORRECTION_CELLS);
}

olx_result olx_surface_fit_create(const olx_surface_fit_input *input, const olx_irradiance_source *source,
                                  olx_surface_fit **out) {
  olx_surface_fit *fit = olx_allocate_zero(1, sizeof *fit);
  *out = fit;
  if (!fit) return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory");
  fit->input = *input;
  fit->source = source;
  fit->point_count = input->context->probes.irradiance.count * POINTS_PER_PROBE;
  olx_array_row rows[2];
  const bool solved = input->light;
  const bool listed = olx_arrays_allocate(rows, list_arrays(fit, solved, rows));
  const size_t unknowns = (size_t)input->context->probes.irradiance.count * OLX_CORRECTION_CELLS;
  const bool allocated = olx_corrections_allocate(&fit->corrections, unknowns);
  if (!listed || !allocated) {
    return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for fitting %u irradiance probes",
                    input->context->probes.irradiance.count);
  }
  OLX_TRY(olx_bake_for(input->context, jobs_of(fit), cast_job, fit, POINTS_PER_JOB * units_of_point(solved)));
  return olx_shade_check_memory(fit->input.shade);
}

void olx_surface_fit_free(olx_surface_fit *fit) {
  if (!fit) return;
  olx_release(fit->points);
  olx_release(fit->hits);
  olx_corrections_free(&fit->corrections);
  olx_release(fit);
}

olx_result olx_surface_fit_solve(olx_surface_fit *fit, const olx_irradiance_source *source, uint32_t bounce) {
  fit->source = source;
  fit->bounce = bounce;
  OLX_TRY(olx_bake_for(fit->input.context, jobs_of(fit), measure_job, fit, 0));
  OLX_TRY(olx_shade_check_memory(fit->input.shade));
  solve(fit);
  return OLX_OK;
}

olx_vec3 olx_surface_fit_correction(const olx_surface_fit *fit, uint32_t probe, olx_vec2 uv) {
  return olx_correction_at(fit->corrections.solution + (size_t)probe * OLX_CORRECTION_CELLS, uv);
}

bool olx_surface_fit_measurement(const olx_surface_fit *fit, uint32_t index, olx_surface_measurement *measurement) {
  const fit_point *point = &fit->points[index];
  *measurement = (olx_surface_measurement){point->normal, point->measured, &point->weights};
  return point->valid;
}
