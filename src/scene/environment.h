// Light from infinitely far away: its radiance, and importance sampling of directions.
#ifndef OLX_SCENE_ENVIRONMENT_H
#define OLX_SCENE_ENVIRONMENT_H

#include "scene/scene_data.h"

// Cumulative sums for sampling texels of the environment's image; empty without an image, where directions are uniform.
typedef struct olx_environment_sampler {
  bool lit;
  float mean;         // luminance of radiance over all directions
  bool even;          // light comes from a large part of all directions, not from a few small places such as a sun
  float *row_sums;    // height + 1
  float *column_sums; // width + 1 per row
} olx_environment_sampler;

olx_result olx_environment_sampler_create(const olx_environment *environment, olx_environment_sampler *sampler);
void olx_environment_sampler_free(olx_environment_sampler *sampler);

// Samples the image bilinearly; column 0 begins at -x, the middle of the image is +x, +z lies at three quarters.
olx_vec3 olx_environment_lookup(const olx_environment *environment, olx_vec3 direction);

// Samples a direction; *pdf is its density over solid angle.
olx_vec3 olx_environment_draw(const olx_environment *environment, const olx_environment_sampler *sampler,
                              olx_vec2 random, float *pdf);
// Returns the point of the square, as `random`, from which olx_environment_draw draws that direction.
olx_vec2 olx_environment_point(const olx_environment *environment, const olx_environment_sampler *sampler,
                               olx_vec3 direction);
float olx_environment_density(const olx_environment *environment, const olx_environment_sampler *sampler,
                              olx_vec3 direction);

#endif
