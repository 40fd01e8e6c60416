// The random numbers of one camera sample or path: each pair of dimensions has its own Owen-scrambled sequence over the
// samples.
#ifndef OLX_SCENE_SAMPLER_H
#define OLX_SCENE_SAMPLER_H

#include "core/sampling.h"

typedef struct olx_sampler {
  uint32_t seed;  // seed of the pixel
  uint32_t index; // index of the sample in the pixel
  uint32_t dimension;
} olx_sampler;

// Beyond this many dimensions stratification no longer lowers the error, and independent numbers are cheaper.
#define OLX_STRATIFIED_DIMENSIONS 24

static inline olx_vec2 olx_sampler_next2(olx_sampler *s) {
  const uint32_t seed = olx_hash2(s->seed, s->dimension++);
  if (s->dimension <= OLX_STRATIFIED_DIMENSIONS) return olx_stratified2(s->index, seed);
  const uint32_t bits = olx_hash2(seed, s->index);
  return (olx_vec2){olx_unit_float(bits), olx_unit_float(olx_hash(bits ^ 0x5BD1E995u))};
}

static inline float olx_sampler_next(olx_sampler *s) {
  const uint32_t seed = olx_hash2(s->seed, s->dimension++);
  if (s->dimension <= OLX_STRATIFIED_DIMENSIONS) return olx_stratified(s->index, seed);
  return olx_unit_float(olx_hash2(seed, s->index));
}

// Returns an independent sampler for a second path that leaves the same camera sample.
static inline olx_sampler olx_sampler_split(const olx_sampler *s, uint32_t branch) {
  return (olx_sampler){.seed = olx_hash2(s->seed, OLX_SALT_BRANCH + branch), .index = s->index};
}

#endif
