// Ranks the probes that a cell of space lists.
#ifndef OLX_BAKE_BRICKS_RANK_H
#define OLX_BAKE_BRICKS_RANK_H

#include "bake/selectors/probe_views.h"
#include "field/brick_data.h"

// A point at which rays start, end, or get stuck.
typedef struct olx_brick_sample {
  olx_vec3 position;
  olx_vec3 normal; // surface normal; 0 in free space
  float weight;
} olx_brick_sample;

enum { OLX_BRICK_SAMPLES = 64, OLX_BRICK_CANDIDATES = 128 };

// Finds the candidates for a brick: the probes nearest to its middle, except buried ones. Returns their number.
uint32_t olx_brick_candidates(const olx_selector_input *input, olx_vec3 middle,
                              uint32_t candidates[OLX_BRICK_CANDIDATES]);

// Fills a list with the candidates that see most of the samples best. Each further candidate counts less for samples
// that the listed ones already see well. OLX_BRICK_NO_PROBE fills the rest. At most OLX_BRICK_SAMPLES samples.
void olx_brick_rank(const olx_probe_views *views, const uint32_t *candidates, uint32_t candidate_count,
                    const olx_brick_sample *samples, uint32_t sample_count, uint16_t list[OLX_BRICK_PROBES]);

#endif
