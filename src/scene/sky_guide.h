// Guides samples of the sky towards where it is seen, such as through a window: pixels close together learn from each
// other's samples of direct light.
//
// The square of random numbers from which the environment draws directions is divided into bins, and bins are drawn in
// proportion to the root of the light that samples brought from them. Guo et al. 2018, "Primary Sample Space Path
// Guiding", guide the random numbers of whole paths; here they are two, and the grid is fixed. Samples are unbiased:
// the density is learnt between stages, and each stage draws random numbers independent of those before it.
#ifndef OLX_SCENE_SKY_GUIDE_H
#define OLX_SCENE_SKY_GUIDE_H

#include "scene/sampler.h"

// Bins along the sides of the square: across is azimuth of the environment, down is height.
enum { OLX_SKY_ACROSS = 32, OLX_SKY_DOWN = 16, OLX_SKY_BINS = OLX_SKY_ACROSS * OLX_SKY_DOWN };

typedef struct olx_sky_guide {
  uint32_t stage;                   // 0: nothing is learnt yet, and the density is even
  uint32_t found;                   // number of samples that brought light
  float light[OLX_SKY_BINS];        // luminance that samples brought, in rows
  float row_sums[OLX_SKY_DOWN + 1]; // cumulative, when stage > 0
  float column_sums[OLX_SKY_DOWN][OLX_SKY_ACROSS + 1];
} olx_sky_guide;

// Begins without knowledge.
void olx_sky_guide_begin(olx_sky_guide *guide);
// Weakens what was learnt to that of `found` samples, so that pixels of a part of the surface can learn more.
void olx_sky_guide_fade(olx_sky_guide *guide, uint32_t found);
// Prepares sample `index` of each pixel: learns before samples 1, 4, 16 and so on, unless no light was found.
void olx_sky_guide_next(olx_sky_guide *guide, uint32_t index);
// Returns the sampler of direct light for the guide's stage.
olx_sampler olx_sky_guide_sampler(const olx_sky_guide *guide, const olx_sampler *sampler);

// Adds the light that a sample brought from a point of the square.
void olx_sky_guide_add(olx_sky_guide *guide, olx_vec2 point, float luminance);

// Maps evenly distributed points of the square to points with the guide's density. *density is the relative density at
// the result; its mean is 1.
olx_vec2 olx_sky_guide_warp(const olx_sky_guide *guide, olx_vec2 even, float *density);
float olx_sky_guide_density(const olx_sky_guide *guide, olx_vec2 point);

#endif
