// Interpolates irradiance between the probes of a cage, each weighted by Chebyshev's bound on its visibility, and falls
// back on more distant probes where the cage hardly sees the point. Its twin is shaders/lib/irradiance.glsl.
#include "shade/irradiance.h"

#include <assert.h>

typedef struct surface_point {
  olx_vec3 position, normal, view;
} surface_point;

static olx_vec3 map_irradiance(const olx_irradiance_source *s, uint32_t probe, const olx_bilinear *b) {
  const size_t offset = (size_t)(s->irradiance_n + 2) * (s->irradiance_n + 2) * probe;
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < 4; i++) {
    const olx_vec3 value = s->packed_irradiance ? olx_r11g11b10f_unpack(s->packed_irradiance[offset + b->index[i]])
                                                : s->irradiance[offset + b->index[i]];
    sum = olx_madd(sum, value, b->weight[i]);
  }
  return sum;
}

// Where irradiance for a normal lies in every probe's map, or the values of the harmonics for it.
typedef struct normal_taps {
  olx_bilinear texels;
  float harmonics[OLX_HARMONICS_MOST];
} normal_taps;

static normal_taps taps_at(const olx_irradiance_source *s, olx_vec3 normal) {
  normal_taps taps;
  if (s->bands) olx_harmonics_at(normal, taps.harmonics);
  else taps.texels = olx_bilinear_at(olx_octahedral_encode(normal), s->irradiance_n);
  return taps;
}

static olx_vec3 probe_irradiance(const olx_irradiance_source *s, uint32_t probe, const normal_taps *taps) {
  if (!s->bands) return map_irradiance(s, probe, &taps->texels);
  return olx_harmonics_irradiance(s->harmonics + (size_t)s->harmonic_halves * probe, s->bands, taps->harmonics);
}

// Returns the mean distance in metres and the mean squared distance in square metres.
static olx_vec2 map_moments(const olx_irradiance_source *s, uint32_t probe, olx_vec3 direction) {
  const olx_bilinear b = olx_bilinear_at(olx_octahedral_encode(direction), s->moments_n);
  const size_t offset = (size_t)(s->moments_n + 2) * (s->moments_n + 2) * probe;
  olx_vec2 sum = {0};
  for (uint32_t i = 0; i < 4; i++) {
    olx_vec2 value;
    if (s->packed_moments) {
      const uint32_t packed = s->packed_moments[offset + b.index[i]];
      value = (olx_vec2){olx_half_unpack((uint16_t)packed), olx_half_unpack((uint16_t)(packed >> 16))};
    } else {
      value = s->moments[offset + b.index[i]];
    }
    sum.x += b.weight[i] * value.x;
    sum.y += b.weight[i] * value.y;
  }
  return (olx_vec2){sum.x * s->distance_scale, sum.y * s->distance_scale * s->distance_scale};
}

// Returns an upper bound on the share of a probe's view around the direction of `offset` that is at least as far from
// the probe as `offset` is long.
static float chebyshev(const olx_irradiance_source *s, uint32_t probe, olx_vec3 offset) {
  const olx_vec2 moments = map_moments(s, probe, offset);
  const float r = olx_length(offset), beyond = r - moments.x;
  if (beyond <= 0.0f) return 1.0f;
  const float variance = olx_max(moments.y - moments.x * moments.x, OLX_VARIANCE_FLOOR * moments.x * moments.x);
  return variance / (variance + beyond * beyond);
}

static float visibility(const olx_irradiance_source *s, uint32_t terms, uint32_t probe, olx_vec3 from_probe,
                        const surface_point *p) {
  if (!(terms & OLX_WEIGHT_CHEBYSHEV)) return 1.0f;
  if (terms & OLX_WEIGHT_BIAS) {
    const float angle = OLX_TEXEL_ANGLE / olx_min((float)s->moments_n, OLX_BIAS_MAP_SIZE); // sqrt(4 pi / n^2)
    from_probe = olx_madd(from_probe, olx_normalize(olx_add(p->normal, p->view)), olx_length(from_probe) * angle);
  }
  const float bound = chebyshev(s, probe, from_probe);
  return terms & OLX_WEIGHT_SHARPEN ? bound * bound * bound : bound;
}

static float probe_weight(const olx_irradiance_source *s, uint32_t terms, uint32_t probe, olx_vec3 from_probe,
                          const surface_point *p) {
  float weight = visibility(s, terms, probe, from_probe, p);
  if (terms & OLX_WEIGHT_BACK_FACE) {
    const float cosine = -olx_dot(olx_normalize(from_probe), p->normal);
    weight *= olx_square(0.5f * (cosine + 1.0f));
  }
  if (terms & OLX_WEIGHT_CRUSH && weight < OLX_CRUSH_BELOW) weight *= olx_square(weight / OLX_CRUSH_BELOW);
  return weight;
}

// Finds the nearest probe that sees a point, among the 4 x 4 x 4 around it, for a point that its cage hardly sees.
// Returns false when none of them sees it.
static bool nearest_visible(const olx_irradiance_source *s, uint32_t terms, bool keep_buried, const surface_point *p,
                            const olx_cage *cage, uint32_t *nearest) {
  float nearest_distance = INFINITY;
  for (uint32_t i = 0; i < 64; i++) {
    const uint32_t offset[3] = {i & 3u, i >> 2 & 3u, i >> 4};
    uint32_t at[3];
    bool inside = true;
    for (uint32_t axis = 0; axis < 3; axis++) {
      at[axis] = cage->base[axis] + offset[axis] - 1u; // a negative index wraps to a huge number
      inside = inside && at[axis] < s->grid.count[axis];
    }
    if (!inside) continue;
    const uint32_t probe = at[0] + s->grid.count[0] * (at[1] + s->grid.count[1] * at[2]);
    if (!keep_buried && s->flags[probe] & OLX_PROBE_BURIED) continue;
    const olx_vec3 from_probe = olx_sub(p->position, olx_grid_position(&s->grid, probe));
    const float distance = olx_length(from_probe);
    if (distance >= nearest_distance || visibility(s, terms, probe, from_probe, p) < 0.5f) continue;
    nearest_distance = distance;
    *nearest = probe;
  }
  return nearest_distance < INFINITY;
}

// Completes the weights where the cage sees too little of the point: with the nearest visible probe, or, if there is
// none, with all probes of the cage equally.
static void add_from_afar(const olx_irradiance_source *s, uint32_t terms, bool keep_buried, const surface_point *p,
                          const olx_cage *cage, float rest, olx_irradiance_weights *weights) {
  uint32_t nearest = 0;
  if (nearest_visible(s, terms, keep_buried, p, cage, &nearest)) {
    weights->probe[weights->count] = nearest;
    weights->weight[weights->count++] = rest;
    return;
  }
  const uint32_t first = weights->count;
  for (uint32_t corner = 0; corner < 8; corner++) {
    if (!olx_cage_has(cage, corner)) continue;
    const uint32_t probe = olx_cage_probe(&s->grid, cage, corner);
    if (!keep_buried && s->flags[probe] & OLX_PROBE_BURIED) continue;
    weights->probe[weights->count++] = probe;
  }
  const float share = rest / (float)(weights->count - first);
  for (uint32_t i = first; i < weights->count; i++) weights->weight[i] = share;
}

olx_irradiance_weights olx_irradiance_weigh(const olx_irradiance_source *s, uint32_t terms, bool keep_buried,
                                            olx_vec3 position, olx_vec3 normal, olx_vec3 view) {
  const surface_point p = {position, normal, view};
  const olx_cage cage = olx_cage_at(&s->grid, position);
  olx_irradiance_weights weights = {.count = 0};
  if (!s->flags) return weights; // the field has no irradiance probes
  float sum = 0.0f;
  for (uint32_t corner = 0; corner < 8; corner++) {
    if (!olx_cage_has(&cage, corner)) continue;
    const uint32_t probe = olx_cage_probe(&s->grid, &cage, corner);
    if (!keep_buried && s->flags[probe] & OLX_PROBE_BURIED) continue;
    const olx_vec3 from_probe = olx_sub(position, olx_grid_position(&s->grid, probe));
    const float trilinear = terms & OLX_WEIGHT_TRILINEAR ? olx_cage_weight(&cage, corner) : 1.0f;
    if (trilinear <= 0.0f) continue;
    const float weight = trilinear * probe_weight(s, terms, probe, from_probe, &p);
    if (weight <= 0.0f) continue;
    weights.probe[weights.count] = probe;
    weights.weight[weights.count++] = weight;
    sum += weight;
  }
  const float scale = 1.0f / olx_max(sum, OLX_TRUSTED_WEIGHT);
  for (uint32_t i = 0; i < weights.count; i++) weights.weight[i] *= scale;
  if (sum < OLX_TRUSTED_WEIGHT) {
    add_from_afar(s, terms, keep_buried, &p, &cage, 1.0f - sum / OLX_TRUSTED_WEIGHT, &weights);
  }
  return weights;
}

static olx_vec3 weighted_irradiance(const olx_irradiance_source *s, const olx_irradiance_weights *weights,
                                    olx_vec3 normal) {
  const normal_taps taps = taps_at(s, normal);
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < weights->count; i++) {
    sum = olx_madd(sum, probe_irradiance(s, weights->probe[i], &taps), weights->weight[i]);
  }
  return s->bands ? olx_max_each(sum, olx_splat(0.0f)) : sum; // the ringing of probes may cancel: only the sum is cut
}

olx_vec3 olx_irradiance_terms(const olx_irradiance_source *s, uint32_t terms, bool keep_buried, olx_vec3 position,
                              olx_vec3 normal, olx_vec3 view) {
  const olx_irradiance_weights weights = olx_irradiance_weigh(s, terms, keep_buried, position, normal, view);
  return weighted_irradiance(s, &weights, normal);
}

static uint32_t terms_of(const olx_sample_settings *settings) {
  return settings->visibility == OLX_VISIBILITY_NONE ? OLX_WEIGHT_TRILINEAR : OLX_WEIGHT_ALL;
}

void olx_irradiance_both(const olx_irradiance_source *s, const olx_sample_settings *settings, olx_vec3 position,
                         const olx_vec3 normals[2], olx_vec3 view, olx_vec3 irradiance[2]) {
  const olx_irradiance_weights weights =
      olx_irradiance_weigh(s, terms_of(settings), settings->keep_buried, position, normals[0], view);
  for (uint32_t i = 0; i < 2; i++) irradiance[i] = weighted_irradiance(s, &weights, normals[i]);
}

olx_vec3 olx_irradiance_from(const olx_irradiance_source *source, const olx_sample_settings *settings,
                             olx_vec3 position, olx_vec3 normal, olx_vec3 view) {
  return olx_irradiance_terms(source, terms_of(settings), settings->keep_buried, position, normal, view);
}

olx_irradiance_source olx_irradiance_source_of(const olx_field *field) {
  return (olx_irradiance_source){
      .grid = field->info.irradiance.grid,
      .flags = field->irradiance_flags,
      .distance_scale = field->distance_scale,
      .irradiance_n = field->irradiance_n,
      .moments_n = field->irradiance_n,
      .packed_irradiance = field->irradiance,
      .packed_moments = field->moments,
      .harmonics = field->harmonics,
      .bands = field->bands,
      .harmonic_halves = field->harmonic_halves,
  };
}

olx_vec3 olx_irradiance(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position, olx_vec3 normal,
                        olx_vec3 view) {
  const olx_irradiance_source source = olx_irradiance_source_of(field);
  return olx_irradiance_from(&source, settings, position, normal, view);
}

olx_vec3 olx_probe_irradiance(const olx_field *field, uint32_t index, olx_vec3 normal) {
  assert(field);
  if (index >= field->info.irradiance.probe_count) return olx_splat(0.0f);
  const olx_irradiance_source source = olx_irradiance_source_of(field);
  const normal_taps taps = taps_at(&source, normal);
  return probe_irradiance(&source, index, &taps);
}
