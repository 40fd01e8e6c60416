#include "core/hooks.h"
#include "core/result.h"
#include "shade/relighter.h"

#include <string.h>

// As in a bake (docs/baking.md).
static const float SIZE_PENALTY = 1e-4f;
static const float SMOOTHNESS_PENALTY = 3e-4f;

// What no probe sees lies in hollows: it sends this share of what the rest does on average (docs/results.md).
static const float UNSEEN_SHARE = 0.5f;

enum { MOST_TAPS = 16 };

static const uint32_t *words_of(const olx_relight *r, uint32_t point) {
  return r->source->relight.fit + olx_fit_words(&r->source->relight) * point;
}

void olx_relit_fit_free(olx_relit_fit *fit) {
  void *const blocks[] = {fit->texels,      fit->tap_starts, fit->tap_probes, fit->tap_weights, fit->cell,
                          fit->cell_weight, fit->valid,      fit->measured,   fit->solution,    fit->gradient,
                          fit->direction,   fit->product,    fit->partial};
  for (uint32_t i = 0; i < sizeof blocks / sizeof *blocks; i++) olx_release(blocks[i]);
  *fit = (olx_relit_fit){0};
}

static olx_result allocate(olx_relight *r, uint32_t count) {
  olx_relit_fit *f = &r->fit;
  f->unknowns = (size_t)r->counts[0] * OLX_RELIT_FIT_CELLS;
  f->texels = olx_allocate(count, sizeof *f->texels);
  f->tap_starts = olx_allocate((size_t)count + 1, sizeof *f->tap_starts);
  f->tap_probes = olx_allocate((size_t)count * MOST_TAPS, sizeof *f->tap_probes);
  f->tap_weights = olx_allocate((size_t)count * MOST_TAPS, sizeof *f->tap_weights);
  f->cell = olx_allocate(count, sizeof *f->cell);
  f->cell_weight = olx_allocate(count, sizeof *f->cell_weight);
  f->valid = olx_allocate(count, sizeof *f->valid);
  f->measured = olx_allocate_zero(count, sizeof *f->measured);
  f->solution = olx_allocate_zero(f->unknowns, sizeof *f->solution);
  f->gradient = olx_allocate(f->unknowns, sizeof *f->gradient);
  f->direction = olx_allocate(f->unknowns, sizeof *f->direction);
  f->product = olx_allocate(f->unknowns, sizeof *f->product);
  f->partial = olx_allocate(OLX_RELIT_CHUNKS * f->unknowns, sizeof *f->partial);
  if (f->texels && f->tap_starts && f->tap_probes && f->tap_weights && f->cell && f->cell_weight && f->valid &&
      f->measured && f->solution && f->gradient && f->direction && f->product && f->partial) {
    return OLX_OK;
  }
  return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u points", count);
}

static void place_cells(olx_relit_fit *f, uint32_t point, olx_vec2 uv) {
  const float x = uv.x * OLX_RELIT_FIT_SIDE - 0.5f, y = uv.y * OLX_RELIT_FIT_SIDE - 0.5f;
  const int32_t x0 = (int32_t)floorf(x), y0 = (int32_t)floorf(y);
  const float fx = x - (float)x0, fy = y - (float)y0;
  for (int32_t k = 0; k < 4; k++) {
    int32_t sx, sy;
    olx_border_source(x0 + (k & 1), y0 + (k >> 1), OLX_RELIT_FIT_SIDE, &sx, &sy);
    f->cell[point][k] = (uint16_t)(sy * OLX_RELIT_FIT_SIDE + sx);
    f->cell_weight[point][k] = (k & 1 ? fx : 1.0f - fx) * (k >> 1 ? fy : 1.0f - fy);
  }
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
  const size_t surfaces = r->surfaces * r->counts[0];
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
  place_cells(f, point, uv);
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
  for (uint32_t point = points * probe; point < points * (probe + 1); point++) {
    if (!r->fit.valid[point]) continue;
    const uint32_t *ray = words_of(r, point) + 4;
    olx_vec3 sum = {0};
    uint32_t known = 0;
    for (uint32_t k = 0; k < rays; k++) {
      if (ray[k] == OLX_FIT_RAY_UNKNOWN) continue;
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

static olx_vec3 predict(const olx_relit_fit *f, uint32_t point, const olx_vec3 *x) {
  olx_vec3 sum = {0};
  for (uint32_t k = f->tap_starts[point]; k < f->tap_starts[point + 1]; k++) {
    const olx_vec3 *cells = x + (size_t)f->tap_probes[k] * OLX_RELIT_FIT_CELLS;
    for (uint32_t i = 0; i < 4; i++) {
      sum = olx_madd(sum, cells[f->cell[point][i]], f->tap_weights[k] * f->cell_weight[point][i]);
    }
  }
  return sum;
}

static void scatter(const olx_relit_fit *f, uint32_t point, olx_vec3 value, olx_vec3 *unknowns) {
  for (uint32_t k = f->tap_starts[point]; k < f->tap_starts[point + 1]; k++) {
    olx_vec3 *cells = unknowns + (size_t)f->tap_probes[k] * OLX_RELIT_FIT_CELLS;
    for (uint32_t i = 0; i < 4; i++) {
      olx_vec3 *cell = &cells[f->cell[point][i]];
      *cell = olx_madd(*cell, value, f->tap_weights[k] * f->cell_weight[point][i]);
    }
  }
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
  olx_vec3 *sums = f->partial + f->unknowns * chunk;
  memset(sums, 0, f->unknowns * sizeof *sums);
  for (uint32_t i = first_point(f, chunk); i < first_point(f, chunk + 1); i++) {
    if (!f->valid[i]) continue;
    const olx_vec3 known = olx_add(interpolated(r, i), predict(f, i, f->solution));
    scatter(f, i, olx_sub(f->measured[i], known), sums);
  }
}

static void multiply_job(void *user, uint32_t chunk) {
  olx_relit_fit *f = &((olx_relight *)user)->fit;
  olx_vec3 *sums = f->partial + f->unknowns * chunk;
  memset(sums, 0, f->unknowns * sizeof *sums);
  for (uint32_t i = first_point(f, chunk); i < first_point(f, chunk + 1); i++) {
    if (f->valid[i]) scatter(f, i, predict(f, i, f->factor), sums);
  }
}

// Adds the penalties' part of the normal equations.
static void penalize(const olx_vec3 *x, float strength, olx_vec3 *product) {
  for (int32_t cy = 0; cy < OLX_RELIT_FIT_SIDE; cy++) {
    for (int32_t cx = 0; cx < OLX_RELIT_FIT_SIDE; cx++) {
      const size_t c = (size_t)(cy * OLX_RELIT_FIT_SIDE + cx);
      product[c] = olx_madd(product[c], x[c], SIZE_PENALTY * strength);
      for (int32_t axis = 0; axis < 2; axis++) {
        int32_t sx, sy;
        olx_border_source(cx + (axis == 0), cy + (axis == 1), OLX_RELIT_FIT_SIDE, &sx, &sy);
        const size_t next = (size_t)(sy * OLX_RELIT_FIT_SIDE + sx);
        const olx_vec3 step = olx_scale(olx_sub(x[c], x[next]), SMOOTHNESS_PENALTY * strength);
        product[c] = olx_add(product[c], step);
        product[next] = olx_sub(product[next], step);
      }
    }
  }
}

// The chunks' sums in their order, and the penalties on `x`.
static void total(const olx_relight *r, const olx_vec3 *x, float sign, olx_vec3 *out) {
  const olx_relit_fit *f = &r->fit;
  const float strength = sign * (float)r->source->relight.points;
  memcpy(out, f->partial, f->unknowns * sizeof *out);
  for (uint32_t chunk = 1; chunk < OLX_RELIT_CHUNKS; chunk++) {
    const olx_vec3 *sums = f->partial + f->unknowns * chunk;
    for (size_t i = 0; i < f->unknowns; i++) out[i] = olx_add(out[i], sums[i]);
  }
  for (size_t first = 0; first < f->unknowns; first += OLX_RELIT_FIT_CELLS) penalize(x + first, strength, out + first);
}

typedef struct dot3 {
  double x, y, z;
} dot3;

static dot3 dot_each(const olx_vec3 *a, const olx_vec3 *b, size_t count) {
  dot3 sum = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < count; i++) {
    sum.x += (double)a[i].x * (double)b[i].x;
    sum.y += (double)a[i].y * (double)b[i].y;
    sum.z += (double)a[i].z * (double)b[i].z;
  }
  return sum;
}

static olx_vec3 ratio(dot3 a, dot3 b) {
  return olx_v3(b.x > 0.0 ? (float)(a.x / b.x) : 0.0f, b.y > 0.0 ? (float)(a.y / b.y) : 0.0f,
                b.z > 0.0 ? (float)(a.z / b.z) : 0.0f);
}

olx_result olx_relit_fit_solve(olx_relight *r, uint32_t steps) {
  olx_relit_fit *f = &r->fit;
  if (!f->count || steps == 0) return OLX_OK;
  const uint32_t threads = r->settings.threads;
  OLX_TRY(olx_parallel_for(OLX_RELIT_CHUNKS, threads, residual_job, r, NULL, 0));
  total(r, f->solution, -1.0f, f->gradient);
  memcpy(f->direction, f->gradient, f->unknowns * sizeof *f->direction);
  dot3 norm = dot_each(f->gradient, f->gradient, f->unknowns);
  for (uint32_t step = 0; step < steps; step++) {
    f->factor = f->direction;
    OLX_TRY(olx_parallel_for(OLX_RELIT_CHUNKS, threads, multiply_job, r, NULL, 0));
    total(r, f->direction, 1.0f, f->product);
    const olx_vec3 length = ratio(norm, dot_each(f->direction, f->product, f->unknowns));
    for (size_t i = 0; i < f->unknowns; i++) {
      f->solution[i] = olx_add(f->solution[i], olx_mul(length, f->direction[i]));
      f->gradient[i] = olx_sub(f->gradient[i], olx_mul(length, f->product[i]));
    }
    const dot3 next = dot_each(f->gradient, f->gradient, f->unknowns);
    const olx_vec3 keep = ratio(next, norm);
    norm = next;
    for (size_t i = 0; i < f->unknowns; i++) {
      f->direction[i] = olx_add(f->gradient[i], olx_mul(keep, f->direction[i]));
    }
  }
  return OLX_OK;
}

olx_vec3 olx_relit_correction(const olx_relit_fit *f, uint32_t probe, olx_vec2 uv) {
  const float x = uv.x * OLX_RELIT_FIT_SIDE - 0.5f, y = uv.y * OLX_RELIT_FIT_SIDE - 0.5f;
  const int32_t x0 = (int32_t)floorf(x), y0 = (int32_t)floorf(y);
  const float fx = x - (float)x0, fy = y - (float)y0;
  olx_vec3 sum = {0};
  for (int32_t k = 0; k < 4; k++) {
    int32_t sx, sy;
    olx_border_source(x0 + (k & 1), y0 + (k >> 1), OLX_RELIT_FIT_SIDE, &sx, &sy);
    const olx_vec3 cell = f->solution[(size_t)probe * OLX_RELIT_FIT_CELLS + (size_t)(sy * OLX_RELIT_FIT_SIDE + sx)];
    sum = olx_madd(sum, cell, (k & 1 ? fx : 1.0f - fx) * (k >> 1 ? fy : 1.0f - fy));
  }
  return sum;
}
