#include "core/hooks.h"
#include "core/result.h"
#include "shade/relighter.h"

#include <string.h>

// What a probe waits with after lights have changed: more than any share.
static const float ALL_CHANGED = 1e9f;
static const float LEAST_RATE = 0.125f;
// Probes darker than this share of the brightest count as that bright: changes in the dark wake nobody.
static const float DARK = 0.02f;

enum { SHARE_SAMPLES = 128 };

bool olx_relit_awake(const olx_relight *r, const olx_relit_probe *probe) {
  if (probe->buried) return false;
  return probe->pending > r->settings.sleep || (r->varying && probe->rounds > 0 && probe->rounds < OLX_RELIT_ROUNDS);
}

void olx_relit_wake_all(olx_relight *r) {
  r->level = 0.0f;
  for (uint32_t i = 0; i < r->counts[0]; i++) r->level = olx_max(r->level, r->mean[i]);
  for (uint32_t kind = 0; kind < 2; kind++) {
    for (uint32_t i = 0; i < r->counts[kind]; i++) {
      olx_relit_probe *probe = &r->probes[kind][i];
      if (!olx_relit_awake(r, probe)) probe->woke_frame = r->frame;
      probe->pending = ALL_CHANGED;
      probe->rounds = 0;
      probe->tiles = 0;
    }
  }
  r->current = UINT32_MAX;
}

// How often a probe is updated against the nearest ones.
static float rate_of(const olx_relight *r, const olx_relit_probe *probe, olx_vec3 eye) {
  const float distance = olx_length(olx_sub(probe->position, eye));
  float rate = 1.0f;
  for (float reach = r->near_metres; distance > reach && rate > LEAST_RATE; reach *= 2.0f) rate *= 0.5f;
  return rate;
}

static uint32_t waited(const olx_relight *r, const olx_relit_probe *probe) {
  return r->frame - (probe->last_frame > probe->woke_frame ? probe->last_frame : probe->woke_frame);
}

// The one that has waited longest for its rate. Waiting adds up without limit, so that every probe has its turn.
static uint32_t most_urgent(const olx_relight *r, uint32_t kind, olx_vec3 eye) {
  uint32_t best = UINT32_MAX;
  float most = 0.0f;
  for (uint32_t i = 0; i < r->counts[kind]; i++) {
    const olx_relit_probe *probe = &r->probes[kind][i];
    if ((kind == 0 && r->in_frame[i]) || !olx_relit_awake(r, probe)) continue;
    const float urgency = (float)(waited(r, probe) + 1) * rate_of(r, probe, eye);
    if (urgency <= most) continue;
    most = urgency;
    best = i;
  }
  return best;
}

static void schedule_irradiance(olx_relight *r, olx_vec3 eye) {
  memset(r->in_frame, 0, r->counts[0] * sizeof *r->in_frame);
  r->scheduled_count = 0;
  while (r->scheduled_count < r->scheduled_most) {
    const uint32_t probe = most_urgent(r, 0, eye);
    if (probe == UINT32_MAX) return;
    r->scheduled[r->scheduled_count++] = probe;
    r->in_frame[probe] = true;
    r->probes[0][probe].pending = 0.0f;
  }
}

static void schedule_radiance(olx_relight *r, olx_vec3 eye) {
  r->tile_count = 0;
  while (r->tile_count < r->tile_most) {
    if (r->current == UINT32_MAX) {
      r->current = most_urgent(r, 1, eye);
      if (r->current == UINT32_MAX) return;
      r->probes[1][r->current].pending = 0.0f;
    }
    olx_relit_probe *probe = &r->probes[1][r->current];
    r->tiles[r->tile_count++] = (olx_relit_tile){r->current, probe->tiles++};
    if (probe->tiles < r->tiles_a_probe) continue;
    probe->tiles = 0;
    probe->rounds = OLX_RELIT_ROUNDS;
    probe->updates++;
    probe->last_frame = r->frame;
    r->current = UINT32_MAX;
  }
}

void olx_relit_schedule(olx_relight *r, olx_vec3 eye) {
  schedule_irradiance(r, eye);
  schedule_radiance(r, eye);
}

void olx_relit_pass_on(olx_relight *r) {
  const float texels = (float)(r->map_size * r->map_size);
  for (uint32_t i = 0; i < r->counts[0]; i++) r->level = olx_max(r->level, r->mean[i]);
  for (uint32_t i = 0; i < r->counts[0]; i++) {
    const float light = olx_max(r->mean[i], DARK * r->level);
    r->changed[i] = light > 0.0f ? r->changed[i] / (light * texels) : 0.0f;
  }
  for (uint32_t row = 0; row < r->counts[0] + r->counts[1]; row++) {
    const bool radiance = row >= r->counts[0];
    olx_relit_probe *probe = &r->probes[radiance][radiance ? row - r->counts[0] : row];
    const bool was_awake = olx_relit_awake(r, probe);
    for (uint32_t k = r->shares.starts[row]; k < r->shares.starts[row + 1]; k++) {
      probe->pending += r->shares.share[k] * r->changed[r->shares.probes[k]];
    }
    if (!was_awake && olx_relit_awake(r, probe)) probe->woke_frame = r->frame;
  }
}

// A place that the probe sees; false in the sky.
static bool sampled_place(const olx_relight *r, uint32_t row, uint32_t sample, olx_vec3 *place, olx_vec3 *normal,
                          olx_vec3 *direction) {
  const olx_field *f = r->source;
  float distance;
  if (row < r->counts[0]) {
    const uint32_t n = f->relight.size, i = (uint32_t)(r->surfaces * sample / SHARE_SAMPLES) + n / 2;
    const olx_surface_sample *s = &f->relight.surfaces[r->surfaces * row + i % r->surfaces];
    *direction = olx_surface_direction(i % n, i / n % n, n);
    *normal = olx_normal_unpack(s->normal);
    distance = olx_half_unpack(s->distance) * f->distance_scale;
    *place = olx_madd(f->irradiance_positions[row], *direction, distance);
  } else {
    const uint32_t n = f->n, probe = row - r->counts[0], i = (uint32_t)((size_t)n * n * sample / SHARE_SAMPLES) + n / 2,
                   x = i % n, y = i / n % n;
    const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
    *direction = olx_texel_direction(x, y, n);
    *normal = olx_normal_unpack(f->normal[f->texels * probe + texel]);
    distance = olx_texel_distance(f, probe, texel);
    *place = olx_madd(f->probe_positions[probe], *direction, distance);
  }
  return distance < INFINITY;
}

// Sums, for one probe, the weights with which irradiance probes answer for what it sees.
static void sum_weights(const olx_relight *r, uint32_t row, float *weights) {
  memset(weights, 0, r->counts[0] * sizeof *weights);
  for (uint32_t sample = 0; sample < SHARE_SAMPLES; sample++) {
    olx_vec3 place, normal, direction;
    if (!sampled_place(r, row, sample, &place, &normal, &direction)) continue;
    const olx_irradiance_weights taps =
        olx_irradiance_weigh(&r->irradiance, OLX_WEIGHT_ALL, false, place, normal, olx_negate(direction));
    for (uint32_t k = 0; k < taps.count; k++) weights[taps.probe[k]] += taps.weight[k] / SHARE_SAMPLES;
  }
}

olx_result olx_relit_find_shares(olx_relight *r) {
  const uint32_t rows = r->counts[0] + r->counts[1];
  const size_t most = (size_t)rows * (r->counts[0] < 256 ? r->counts[0] : 256);
  float *weights = olx_allocate(r->counts[0], sizeof *weights);
  r->shares.starts = olx_allocate(rows + 1, sizeof *r->shares.starts);
  r->shares.probes = olx_allocate(most, sizeof *r->shares.probes);
  r->shares.share = olx_allocate(most, sizeof *r->shares.share);
  if (!weights || !r->shares.starts || !r->shares.probes || !r->shares.share) {
    olx_release(weights);
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory");
  }
  uint32_t count = 0;
  for (uint32_t row = 0; row < rows; row++) {
    r->shares.starts[row] = count;
    sum_weights(r, row, weights);
    for (uint32_t i = 0; i < r->counts[0] && count < r->shares.starts[row] + 256; i++) {
      if (weights[i] <= 0.0f) continue;
      r->shares.probes[count] = i;
      r->shares.share[count++] = weights[i];
    }
  }
  r->shares.starts[rows] = count;
  olx_release(weights);
  return OLX_OK;
}
