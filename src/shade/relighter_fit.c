#include "core/hooks.h"
#include "core/result.h"
#include "shade/relighter.h"

#include <string.h>

// What no probe sees lies in hollows: it sends this share of what the rest does on average (docs/studies.md).
static const float UNSEEN_SHARE = 0.5f;

enum { MOST_TAPS = 16 };

static const uint32_t *words_of(const olx_relight *r, uint32_t point) {
  return r->source->relight.fit + olx_fit_words(&r->source->relight) * point;
}

void olx_relit_fit_free(olx_relit_fit *fit) {
  void *const blocks[] = {fit->texels, fit->tap_starts, fit->tap_probes, fit->tap_weights,
                          fit->cells,  fit->valid,      fit->measured,   fit->partial};
  for (uint32_t i = 0; i < sizeof blocks / sizeof *blocks; i++) olx_release(blocks[i]);
  olx_corrections_free(&fit->corrections);
  *fit = (olx_relit_fit){0};
}

static olx_result allocate(olx_relight *r, uint32_t count) {
  olx_relit_fit *f = &r->fit;
  const bool allocated = olx_corrections_allocate(&f->corrections, (size_t)r->counts[0] * OLX_CORRECTION_CELLS);
  f->texels = olx_allocate(count, sizeof *f->texels);
  f->tap_starts = olx_allocate((size_t)count + 1, sizeof *f->tap_starts);
  f->tap_probes = olx_allocate((size_t)count * MOST_TAPS, sizeof *f->tap_probes);
  f->tap_weights = olx_allocate((size_t)count * MOST_TAPS, sizeof *f->tap_weights);
  f->cells = olx_allocate(count, sizeof *f->cells);
  f->valid = olx_allocate(count, sizeof *f->valid);
  f->measured = olx_allocate_zero(count, sizeof *f->measured);
  f->partial = olx_allocate(OLX_RELIT_CHUNKS * f->corrections.unknowns, sizeof *f->partial);
  if (allocated && f->texels && f->tap_starts && f->tap_probes && f->tap_weights && f->cells && f->valid &&
      f->measured && f->partial) {
    return OLX_OK;
  }
  return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u points", count);
}

// The same texels of a map that has no border.
static olx_bilinear without_border(olx_bilinear texels, uint32_t n) {
  for (uint32_t i = 0; i < 4; i++) {
    const int32_t at = (int32_t)texels.index[i], stride = (int32_t)n + 2;
    int32_t x, y;
    olx_border_source(at % stride - 1, at / stride - 1, (int32_t)n, &x, &y);
    texels.index[i] = (size_t)y * n + (size_t)x;
  }
  return texels;
}

// Everything about a point but its light. False when its record is impossible.
static bool read_point(olx_relight *r, uint32_t point, uint32_t *taps) {
  const uint32_t *words = words_of(r, point), rays = r->source->relight.rays;
  const size_t surfaces = (r->surfaces + r->source->relight.hidden) * r->counts[0];
  olx_relit_fit *f = &r->fit;
  olx_fit_place place;
  memcpy(&place, words, sizeof place);
  f->tap_starts[point] = *taps;
  f->valid[point] = place.normal != OLX_FIT_NO_POINT;
  if (!f->valid[point]) return true;
  if (place.normal > UINT16_MAX || !olx_finite(place.position)) return false;
  for (uint32_t k = 0; k < rays; k++) {
    if (words[4 + k] >= surfaces && words[4 + k] < OLX_FIT_RAY_UNKNOWN) return false;
  }
  const olx_vec3 normal = olx_normal_unpack((uint16_t)place.normal);
  const olx_irradiance_weights weights =
      olx_irradiance_weigh(&r->irradiance, OLX_WEIGHT_ALL, false, place.position, normal, normal);
  for (uint32_t k = 0; k < weights.count; k++) {
    f->tap_probes[*taps] = weights.probe[k];
    f->tap_weights[(*taps)++] = weights.weight[k];
  }
  const olx_vec2 uv = olx_octahedral_encode(normal);
  f->texels[point] = without_border(olx_bilinear_at(uv, r->map_size), r->map_size);
  f->cells[point] = olx_correction_cells_at(uv);
  return true;
}

olx_result olx_relit_fit_create(olx_relight *r) {
  const uint32_t points = r->source->relight.points;
  if (points == 0) return OLX_OK;
  if ((uint64_t)points * r->counts[0] > 1u << 26) return olx_fail(OLX_ERROR_UNSUPPORTED, "relight: too many points");
  const uint32_t count = points * r->counts[0];
  OLX_TRY(allocate(r, count));
  uint32_t taps = 0;
  for (uint32_t i = 0; i < count; i++) {
    if (read_point(r, i, &taps)) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk FITP: point %u of probe %u is impossible", r->source->name, i % points,
                    i / points);
  }
  r->fit.tap_starts[count] = taps;
  r->fit.count = count;
  return OLX_OK;
}

void olx_relit_fit_measure(olx_relight *r, uint32_t probe) {
  const uint32_t points = r->source->relight.points, rays = r->source->relight.rays;
  const size_t lit = olx_relit_surface_count(r); // hidden surfaces that are not are unknown
  for (uint32_t point = points * probe; point < points * (probe + 1); point++) {
    if (!r->fit.valid[point]) continue;
    const uint32_t *ray = words_of(r, point) + 4;
    olx_vec3 sum = {0};
    uint32_t known = 0;
    for (uint32_t k = 0; k < rays; k++) {
      if (ray[k] >= lit && ray[k] != OLX_FIT_RAY_SKY) continue;
      known++;
      if (ray[k] != OLX_FIT_RAY_SKY) sum = olx_add(sum, r->radiance[ray[k]]);
    }
    const float unseen = UNSEEN_SHARE * (float)(rays - known);
    const float share = known ? ((float)known + unseen) / (float)known : 0.0f;
    r->fit.measured[point] = olx_scale(sum, share * OLX_PI / (float)rays);
  }
}

// The points of a chunk.
static uint32_t first_point(const olx_relit_fit *f, uint32_t chunk) {
  return (uint32_t)((uint64_t)f->count * chunk / OLX_RELIT_CHUNKS);
}

static olx_correction_taps taps_of(const olx_relit_fit *f, uint32_t point) {
  const uint32_t first = f->tap_starts[point];
  return (olx_correction_taps){.count = f->tap_starts[point + 1] - first,
                               .probes = f->tap_probes + first,
                               .weights = f->tap_weights + first,
                               .cells = &f->cells[point]};
}

static olx_vec3 interpolated(const olx_relight *r, uint32_t point) {
  const olx_relit_fit *f = &r->fit;
  const size_t texels = (size_t)r->map_size * r->map_size;
  olx_vec3 sum = {0};
  for (uint32_t k = f->tap_starts[point]; k < f->tap_starts[point + 1]; k++) {
    const olx_vec3 *map = r->exact + texels * f->tap_probes[k];
    for (uint32_t i = 0; i < 4; i++) {
      sum = olx_madd(sum, map[f->texels[point].index[i]], f->texels[point].weight[i] * f->tap_weights[k]);
    }
  }
  return sum;
}

// What measured irradiance still has beyond exact maps and corrections, scattered to the unknowns.
static void residual_job(void *user, uint32_t chunk) {
  olx_relight *r = user;
  olx_relit_fit *f = &r->fit;
  olx_vec3 *sums = f->partial + f->corrections.unknowns * chunk;
  memset(sums, 0, f->corrections.unknowns * sizeof *sums);
  for (uint32_t i = first_point(f, chunk); i < first_point(f, chunk + 1); i++) {
    if (!f->valid[i]) continue;
    const olx_correction_taps taps = taps_of(f, i);
    const olx_vec3 known = olx_add(interpolated(r, i), olx_corrections_predict(f->corrections.solution, &taps));
    olx_corrections_scatter(sums, &taps, olx_sub(f->measured[i], known));
  }
}

static void multiply_job(void *user, uint32_t chunk) {
  olx_relit_fit *f = &((olx_relight *)user)->fit;
  olx_vec3 *sums = f->partial + f->corrections.unknowns * chunk;
  memset(sums, 0, f->corrections.unknowns * sizeof *sums);
  for (uint32_t i = first_point(f, chunk); i < first_point(f, chunk + 1); i++) {
    if (!f->valid[i]) continue;
    const olx_correction_taps taps = taps_of(f, i);
    olx_corrections_scatter(sums, &taps, olx_corrections_predict(f->factor, &taps));
  }
}

// The chunks' sums in their order, and the penalties on `x`.
static void total(const olx_relight *r, const olx_vec3 *x, float sign, olx_vec3 *out) {
  const olx_relit_fit *f = &r->fit;
  const size_t unknowns = f->corrections.unknowns;
  memcpy(out, f->partial, unknowns * sizeof *out);
  for (uint32_t chunk = 1; chunk < OLX_RELIT_CHUNKS; chunk++) {
    const olx_vec3 *sums = f->partial + unknowns * chunk;
    for (size_t i = 0; i < unknowns; i++) out[i] = olx_add(out[i], sums[i]);
  }
  olx_corrections_penalize(&f->corrections, x, sign * (float)r->source->relight.points, out);
}

olx_result olx_relit_fit_solve(olx_relight *r, uint32_t steps) {
  olx_relit_fit *f = &r->fit;
  olx_corrections *c = &f->corrections;
  if (!f->count || steps == 0) return OLX_OK;
  const uint32_t threads = r->settings.threads;
  OLX_TRY(olx_parallel_for(OLX_RELIT_CHUNKS, threads, residual_job, r, NULL, 0));
  total(r, c->solution, -1.0f, c->gradient);
  olx_corrections_begin(c);
  for (uint32_t step = 0; step < steps; step++) {
    f->factor = c->direction;
    OLX_TRY(olx_parallel_for(OLX_RELIT_CHUNKS, threads, multiply_job, r, NULL, 0));
    total(r, c->direction, 1.0f, c->product);
    olx_corrections_step(c);
  }
  return OLX_OK;
}

olx_vec3 olx_relit_correction(const olx_relit_fit *f, uint32_t probe, olx_vec2 uv) {
  return olx_correction_at(f->corrections.solution + (size_t)probe * OLX_CORRECTION_CELLS, uv);
}
