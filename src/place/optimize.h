// Moves probes to positions that see surfaces better (Wang 2018, section 3.2).
#ifndef OLX_PLACE_OPTIMIZE_H
#define OLX_PLACE_OPTIMIZE_H

#include "core/parallel.h"
#include "place/cover/candidates.h"
#include "place/cover/surfels.h"

enum { OLX_ROUND_UNITS = 100 }; // units of progress per round

typedef struct olx_optimization {
  double reward_before, reward_after; // `reward_after` is never less than `reward_before`
  uint32_t rounds;                    // number of rounds that were run
} olx_optimization;

// Returns the fitness, within [0, 1], of one surfel seen from a position without occlusion: the mean of the cosine at
// the surfel and the distance in diagonals of the scene (equation 3.2); 0 when it faces away.
float olx_fitness(const olx_surfel *surfel, olx_vec3 place, float diagonal);

// Computes the reward of positions over an atlas: the mean over surfels of the fitness of the best position, or of the
// sum over all positions.
olx_result olx_reward(const olx_space *space, const olx_surfels *surfels, const olx_vec3 *places, uint32_t count,
                      olx_place_reward kind, uint32_t threads, double *reward);

// Returns a position in the cube of half side `half` around `centre`, drawn axis by axis between the support probes at
// its corners (Figure 3.10). Corner i lies at +half along x if i & 1, y if i & 2, z if i & 4. random: four numbers for
// x, two for y and one for z, within [0, 1).
olx_vec3 olx_sample_support(olx_vec3 centre, float half, const double fitness[8], const float random[7]);

// Moves the probes that are not pinned, as the settings request. The caller owns the atlas.
olx_result olx_optimize(const olx_space *space, const olx_surfels *surfels, const olx_place_settings *settings,
                        olx_task *task, olx_candidate *probes, uint32_t count, olx_optimization *outcome);

#endif
