// Measures the noise of a solution, and counts the rays that lower it to the bound.
#ifndef OLX_LIGHT_LIGHT_NOISE_H
#define OLX_LIGHT_LIGHT_NOISE_H

#include "light/solution/light_solution.h"

// Estimates the standard error of interpolated light around each visible surfel, relative to the light there, and its
// RMS for the report. It contains what the surfel's rays may have missed, and those of its surroundings have met.
olx_result olx_light_noise_measure(olx_scene_light *light);
// Returns the standard deviation of the light that one ray of a visible surfel brings, drawn evenly, relative to all
// light there, by the same estimate.
float olx_scene_light_deviation(const olx_scene_light *light, uint32_t surfel);
// Returns the number of further guided rays that lower a visible surfel's noise to the bound: 0, or first_rays times a
// power of two, at most `most`.
uint32_t olx_light_rays_wanted(const olx_scene_light *light, uint32_t surfel, uint32_t most);

#endif
