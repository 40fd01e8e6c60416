// Ranks the probes for one cell of bricks: greedily adds the probe that sees the cell's points best, so that later
// probes in a list cover what the earlier ones do not see.
#include "bake/selectors/bricks_rank.h"

// Factor on a sample's weight for further probes once a probe that sees it perfectly (quality 1) is listed.
static const float COVERED = 0.4f;
static const float LEAST_COSINE = 0.1f;

uint32_t olx_brick_candidates(const olx_selector_input *input, olx_vec3 middle,
                              uint32_t candidates[OLX_BRICK_CANDIDATES]) {
  float distances[OLX_BRICK_CANDIDATES];
  uint32_t count = 0;
  for (uint32_t probe = 0; probe < input->count; probe++) {
    if (input->flags[probe] & OLX_PROBE_BURIED) continue;
    const olx_vec3 offset = olx_sub(input->positions[probe], middle);
    const float distance = olx_dot(offset, offset);
    if (count == OLX_BRICK_CANDIDATES && distance >= distances[count - 1]) continue;
    uint32_t at = count < OLX_BRICK_CANDIDATES ? count++ : count - 1;
    for (; at > 0 && distances[at - 1] > distance; at--) {
      distances[at] = distances[at - 1];
      candidates[at] = candidates[at - 1];
    }
    distances[at] = distance;
    candidates[at] = probe;
  }
  return count;
}

// Returns how finely a probe samples a surface point: the inverse of a texel's area there, or 0 when the probe does not
// see it.
static float quality(const olx_probe_views *views, uint32_t probe, const olx_brick_sample *sample) {
  const olx_vec3 towards = olx_sub(views->input->positions[probe], sample->position);
  const float squared = olx_max(olx_dot(towards, towards), 1e-12f * olx_square(views->input->distance_scale));
  float cosine = 1.0f;
  if (olx_dot(sample->normal, sample->normal) > 0.0f) {
    cosine = olx_dot(sample->normal, towards) / sqrtf(squared);
    if (cosine <= 0.0f) return 0.0f;
    cosine = olx_max(cosine, LEAST_COSINE);
  }
  return olx_view_sees(views, probe, sample->position) ? cosine / squared : 0.0f;
}

void olx_brick_rank(const olx_probe_views *views, const uint32_t *candidates, uint32_t candidate_count,
                    const olx_brick_sample *samples, uint32_t sample_count, uint16_t list[OLX_BRICK_PROBES]) {
  float qualities[OLX_BRICK_SAMPLES][OLX_BRICK_CANDIDATES], left[OLX_BRICK_SAMPLES];
  for (uint32_t s = 0; s < sample_count; s++) {
    float best = 0.0f;
    for (uint32_t c = 0; c < candidate_count; c++) {
      qualities[s][c] = quality(views, candidates[c], &samples[s]);
      best = olx_max(best, qualities[s][c]);
    }
    const float scale = best > 0.0f ? 1.0f / best : 0.0f;
    for (uint32_t c = 0; c < candidate_count; c++) qualities[s][c] *= scale;
    left[s] = samples[s].weight;
  }
  bool listed[OLX_BRICK_CANDIDATES] = {false};
  uint32_t count = 0;
  for (; count < OLX_BRICK_PROBES; count++) {
    uint32_t best = 0;
    float most = 0.0f;
    for (uint32_t c = 0; c < candidate_count; c++) {
      float gain = 0.0f;
      for (uint32_t s = 0; s < sample_count; s++) gain += left[s] * qualities[s][c];
      if (listed[c] || gain <= most) continue;
      most = gain;
      best = c;
    }
    if (most == 0.0f) break;
    listed[best] = true;
    list[count] = (uint16_t)candidates[best];
    for (uint32_t s = 0; s < sample_count; s++) left[s] *= 1.0f - (1.0f - COVERED) * qualities[s][best];
  }
  for (; count < OLX_BRICK_PROBES; count++) list[count] = OLX_BRICK_NO_PROBE;
}
