#include "core/hooks.h"
#include "vulkan/gpu_relight.h"
#include "vulkan/uploader.h"

static const char WHAT[] = "relighting on the device";

enum { LEAST_WORDS = 4, VECTOR = 3, SURFACE_WORDS = 2, SUMS = 3 };

_Static_assert(OLX_RELIGHT_GROUP == OLX_CORRECTION_CELLS, "a workgroup has the unknowns of a probe");
_Static_assert(sizeof(olx_gpu_relight_call) == OLX_CALL_WORDS * sizeof(uint32_t), "read word by word");
_Static_assert(sizeof(olx_gpu_light) == OLX_LIGHT_WORDS * sizeof(uint32_t), "std430");

// ---- What lies where

// The next `words` of a buffer that has had `used`.
static uint32_t take(uint64_t *used, uint64_t words) {
  const uint64_t first = *used;
  *used += words;
  return (uint32_t)first; // whole as long as the buffer can be bound
}

static uint64_t tap_count(const olx_relight *r) { return r->fit.count ? r->fit.tap_starts[r->fit.count] : 0; }
static uint64_t unknowns(const olx_relight *r) { return (uint64_t)r->counts[0] * OLX_CORRECTION_CELLS; }
static uint64_t cells_of(const olx_relight *r) { return (uint64_t)r->cells * r->cells; }
static uint64_t exact_texels(const olx_relight *r) { return (uint64_t)r->counts[0] * r->map_size * r->map_size; }

static uint64_t call_count(const olx_relight *r) {
  return OLX_CALL_RAYS + 2 * (uint64_t)olx_relight_chunks(r, OLX_RELIT_MOST_LIGHTS);
}

static void lay_out_state(olx_gpu_relight *c, const olx_relight *r, olx_relight_storage *state) {
  const uint64_t probes = r->counts[0];
  uint64_t used = 0;
  c->lights = take(&used, 1 + OLX_RELIT_MOST_LIGHTS * OLX_LIGHT_WORDS);
  c->jobs = take(&used, (uint64_t)r->scheduled_most * OLX_JOB_WORDS);
  c->tiles = take(&used, (uint64_t)r->tile_most * OLX_JOB_WORDS);
  c->packs = take(&used, probes);
  c->shares = take(&used, r->surfaces);
  c->moments = take(&used, VECTOR * cells_of(r));
  c->exact = take(&used, VECTOR * exact_texels(r));
  c->maps = take(&used, VECTOR * probes * r->map_texels);
  c->solution = take(&used, VECTOR * unknowns(r));
  c->gradient = take(&used, VECTOR * unknowns(r));
  c->direction = take(&used, VECTOR * unknowns(r));
  c->product = take(&used, VECTOR * unknowns(r));
  c->partial = take(&used, SUMS * VECTOR * probes);
  c->measured = take(&used, VECTOR * (uint64_t)r->fit.count);
  c->value = take(&used, VECTOR * (uint64_t)r->fit.count);
  c->changes = take(&used, 2 * probes);
  c->calls = take(&used, OLX_CALL_WORDS * call_count(r));
  state->words = OLX_RELIGHT_HEADER_WORDS + used;
}

static void lay_out_places(olx_gpu_relight *c, const olx_relight *r, olx_relight_storage *surfaces,
                           olx_relight_storage *texels) {
  const uint64_t count = r->counts[0] * r->surfaces, tile = (uint64_t)r->tile_side * r->tile_side;
  uint64_t used = SURFACE_WORDS * count;
  c->fixed_light = take(&used, VECTOR * count);
  c->varying_light = take(&used, VECTOR * count);
  surfaces->words = used;
  used = r->tile_most ? r->counts[1] * r->field.texels : LEAST_WORDS;
  c->tile_light = take(&used, VECTOR * tile * r->tile_most);
  c->tile_packed = take(&used, (tile + OLX_RELIT_TILE_BORDER) * r->tile_most);
  texels->words = used;
}

static void lay_out_fit(olx_gpu_relight *c, const olx_relight *r, olx_relight_storage *fit) {
  uint64_t used = r->fit.count ? olx_fit_words(&r->source->relight) * r->fit.count : LEAST_WORDS;
  c->tap_starts = take(&used, (uint64_t)r->fit.count + 1);
  c->taps = take(&used, 2 * tap_count(r));
  c->list_starts = take(&used, unknowns(r) + 1);
  c->list = take(&used, 2 * 4 * tap_count(r));
  fit->words = used;
}

void olx_relight_lay_out(olx_vulkan_relight *v) {
  const olx_relight *r = v->relight;
  olx_gpu_relight *c = &v->constants;
  *c = (olx_gpu_relight){.probes = r->counts[0],
                         .size = r->source->relight.size,
                         .cells = r->cells,
                         .map_size = r->map_size,
                         .irradiance_n = r->field.irradiance_n,
                         .points = r->fit.count ? r->source->relight.points : 0,
                         .rays = r->source->relight.rays,
                         .light_samples = r->settings.light_samples,
                         .tile_side = r->tile_side,
                         .distance_scale = r->source->distance_scale};
  lay_out_state(c, r, &v->buffers[OLX_BUFFER_STATE]);
  lay_out_places(c, r, &v->buffers[OLX_BUFFER_SURFACES], &v->buffers[OLX_BUFFER_TEXELS]);
  lay_out_fit(c, r, &v->buffers[OLX_BUFFER_FIT]);
  v->buffers[OLX_BUFFER_RADIANCE].words = VECTOR * r->counts[0] * r->surfaces;
  v->buffers[OLX_BUFFER_PACKED].words = r->counts[0] * r->field.irradiance_texels;
  v->buffers[OLX_BUFFER_RESULTS].words = 2 * (uint64_t)r->counts[0] * v->settings.in_flight;
}

// ---- Filling

static olx_result copy_words(olx_vulkan_relight *v, olx_uploader *uploader, olx_relight_buffer to, uint32_t at,
                             const void *words, uint64_t count) {
  return olx_uploader_copy(uploader, words, count * sizeof(uint32_t), v->buffers[to].buffer,
                           (VkDeviceSize)at * sizeof(uint32_t));
}

static olx_result copy_to_state(olx_vulkan_relight *v, olx_uploader *uploader, uint32_t at, const void *words,
                                uint64_t count) {
  return copy_words(v, uploader, OLX_BUFFER_STATE, OLX_RELIGHT_HEADER_WORDS + at, words, count);
}

// Cells' moments, as vectors.
static olx_result copy_moments(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relight *r = v->relight;
  olx_vec3 *moments = olx_allocate(cells_of(r), sizeof *moments);
  if (!moments) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  for (size_t i = 0; i < cells_of(r); i++) moments[i] = olx_v3(r->moment[0][i], r->moment[1][i], r->moment[2][i]);
  const olx_result result = copy_to_state(v, uploader, v->constants.moments, moments, VECTOR * cells_of(r));
  olx_release(moments);
  return result;
}

static olx_result copy_calls(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relight *r = v->relight;
  const uint64_t count = call_count(r);
  olx_gpu_relight_call *calls = olx_allocate_zero(count, sizeof *calls);
  if (!calls) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  calls[OLX_CALL_SURFACES].kind = OLX_RELIGHT_SURFACES;
  calls[OLX_CALL_TEXELS].kind = OLX_RELIGHT_TEXELS;
  calls[OLX_CALL_RESIDUAL].kind = OLX_FIT_RESIDUAL;
  calls[OLX_CALL_MULTIPLY].kind = OLX_FIT_MULTIPLY;
  for (uint32_t norm = 0; norm < 2; norm++) {
    calls[OLX_CALL_ADVANCE + norm] = (olx_gpu_relight_call){.kind = OLX_FIT_ADVANCE, .norm = norm};
    calls[OLX_CALL_TURN + norm] = (olx_gpu_relight_call){.kind = OLX_FIT_TURN, .norm = norm};
  }
  for (uint32_t kind = 0; kind < 2; kind++) {
    for (uint32_t chunk = 0; chunk < olx_relight_chunks(r, OLX_RELIT_MOST_LIGHTS); chunk++) {
      const uint32_t first = chunk * OLX_RELIGHT_RAYS;
      calls[olx_relight_rays_call(r, kind == OLX_RELIGHT_TEXELS, chunk)] =
          (olx_gpu_relight_call){.kind = kind, .first_ray = first, .end_ray = first + OLX_RELIGHT_RAYS};
    }
  }
  const olx_result result = copy_to_state(v, uploader, v->constants.calls, calls, OLX_CALL_WORDS * count);
  olx_release(calls);
  return result;
}

// Without a fit the corrections are 0.
static olx_result copy_solution(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relight *r = v->relight;
  olx_vec3 *none = r->fit.count ? NULL : olx_allocate_zero(unknowns(r), sizeof *none);
  const olx_vec3 *solution = r->fit.count ? r->fit.corrections.solution : none;
  if (!solution) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  const olx_result result = copy_to_state(v, uploader, v->constants.solution, solution, VECTOR * unknowns(r));
  olx_release(none);
  return result;
}

static olx_result copy_state(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relight *r = v->relight;
  const olx_gpu_relight *c = &v->constants;
  const uint64_t map_words = VECTOR * r->counts[0] * r->map_texels;
  OLX_TRY(copy_words(v, uploader, OLX_BUFFER_STATE, 0, c, OLX_RELIGHT_HEADER_WORDS));
  OLX_TRY(copy_to_state(v, uploader, c->shares, r->surface_share, r->surfaces));
  OLX_TRY(copy_moments(v, uploader));
  OLX_TRY(copy_calls(v, uploader));
  OLX_TRY(copy_to_state(v, uploader, c->exact, r->exact, VECTOR * exact_texels(r)));
  OLX_TRY(copy_to_state(v, uploader, c->maps, r->maps, map_words));
  OLX_TRY(copy_solution(v, uploader));
  return copy_to_state(v, uploader, c->measured, r->fit.measured, VECTOR * (uint64_t)r->fit.count);
}

// Direct light needs no value: the first update after lights were given begins anew.
static olx_result copy_places(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relight *r = v->relight;
  const uint64_t count = r->counts[0] * r->surfaces;
  OLX_TRY(copy_words(v, uploader, OLX_BUFFER_SURFACES, 0, r->source->relight.surfaces, SURFACE_WORDS * count));
  OLX_TRY(copy_words(v, uploader, OLX_BUFFER_RADIANCE, 0, r->radiance, VECTOR * count));
  if (r->tile_most == 0) return OLX_OK;
  return copy_words(v, uploader, OLX_BUFFER_TEXELS, 0, r->source->relight.albedo, r->counts[1] * r->field.texels);
}

// ---- The fit

static void count_rows(const olx_relit_fit *f, uint32_t *starts) {
  for (uint32_t point = 0; point < f->count; point++) {
    for (uint32_t k = f->tap_starts[point]; k < f->tap_starts[point + 1]; k++) {
      const uint32_t first = f->tap_probes[k] * OLX_CORRECTION_CELLS;
      for (uint32_t i = 0; i < 4; i++) starts[first + f->cells[point].cell[i] + 1]++;
    }
  }
}

// Rows in the order of points; `ends` begin as where rows begin.
static void fill_rows(const olx_relit_fit *f, uint32_t *ends, uint32_t *entries) {
  for (uint32_t point = 0; point < f->count; point++) {
    for (uint32_t k = f->tap_starts[point]; k < f->tap_starts[point + 1]; k++) {
      const uint32_t first = f->tap_probes[k] * OLX_CORRECTION_CELLS;
      for (uint32_t i = 0; i < 4; i++) {
        uint32_t *entry = entries + 2 * (size_t)ends[first + f->cells[point].cell[i]]++;
        entry[0] = point;
        entry[1] = olx_float_bits(f->tap_weights[k] * f->cells[point].weight[i]);
      }
    }
  }
}

static olx_result copy_transpose(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relit_fit *f = &v->relight->fit;
  const size_t rows = unknowns(v->relight), entries = 4 * tap_count(v->relight);
  uint32_t *starts = olx_allocate_zero(rows + 1, sizeof *starts), *ends = olx_allocate(rows + 1, sizeof *ends),
           *list = olx_allocate(entries * 2, sizeof *list);
  olx_result result = OLX_OK;
  if (!starts || !ends || !list) result = olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  if (result == OLX_OK) {
    count_rows(f, starts);
    for (size_t i = 0; i < rows; i++) starts[i + 1] += starts[i];
    memcpy(ends, starts, (rows + 1) * sizeof *ends);
    fill_rows(f, ends, list);
    result = copy_words(v, uploader, OLX_BUFFER_FIT, v->constants.list_starts, starts, rows + 1);
  }
  if (result == OLX_OK) result = copy_words(v, uploader, OLX_BUFFER_FIT, v->constants.list, list, 2 * entries);
  olx_release(starts);
  olx_release(ends);
  olx_release(list);
  return result;
}

// Pairs of a probe and its weight.
static olx_result copy_taps(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relit_fit *f = &v->relight->fit;
  const size_t count = tap_count(v->relight);
  uint32_t *taps = olx_allocate(2 * count, sizeof *taps);
  if (!taps) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  for (size_t i = 0; i < count; i++) {
    taps[2 * i] = f->tap_probes[i];
    taps[2 * i + 1] = olx_float_bits(f->tap_weights[i]);
  }
  const olx_result result = copy_words(v, uploader, OLX_BUFFER_FIT, v->constants.taps, taps, 2 * count);
  olx_release(taps);
  return result;
}

// Points with their rays, a probe at a time. Hidden surfaces are not lit here: rays to them are unknown.
static olx_result copy_points(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relight *r = v->relight;
  const olx_relight_maps *maps = &r->source->relight;
  const size_t words = olx_fit_words(maps), count = words * maps->points, surfaces = r->surfaces * r->counts[0];
  uint32_t *copy = olx_allocate(count, sizeof *copy);
  if (!copy) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", WHAT);
  olx_result result = OLX_OK;
  for (uint32_t probe = 0; probe < r->counts[0] && result == OLX_OK; probe++) {
    memcpy(copy, maps->fit + count * probe, count * sizeof *copy);
    for (size_t i = 0; i < count; i++) {
      if (i % words >= 4 && copy[i] >= surfaces && copy[i] != OLX_FIT_RAY_SKY) copy[i] = OLX_FIT_RAY_UNKNOWN;
    }
    result = copy_words(v, uploader, OLX_BUFFER_FIT, (uint32_t)(count * probe), copy, count);
  }
  olx_release(copy);
  return result;
}

static olx_result copy_fit(olx_vulkan_relight *v, olx_uploader *uploader) {
  const olx_relit_fit *f = &v->relight->fit;
  if (!f->count) return OLX_OK;
  OLX_TRY(copy_points(v, uploader));
  OLX_TRY(copy_words(v, uploader, OLX_BUFFER_FIT, v->constants.tap_starts, f->tap_starts, (uint64_t)f->count + 1));
  OLX_TRY(copy_taps(v, uploader));
  return copy_transpose(v, uploader);
}

olx_result olx_relight_fill(olx_vulkan_relight *v) {
  olx_uploader uploader;
  olx_result result = olx_uploader_begin(&v->gpu->context, &uploader);
  if (result == OLX_OK) result = copy_state(v, &uploader);
  if (result == OLX_OK) result = copy_places(v, &uploader);
  if (result == OLX_OK) result = copy_fit(v, &uploader);
  if (result == OLX_OK) result = olx_uploader_finish(&uploader);
  olx_uploader_end(&uploader);
  return result;
}
