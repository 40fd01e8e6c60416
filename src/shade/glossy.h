// The rays that gather glossy light.
#ifndef OLX_SHADE_GLOSSY_H
#define OLX_SHADE_GLOSSY_H

#include "core/bsdf.h"

#include <octalux/sample.h>

// Draws the ray that olx_glossy traces for these arguments; false when it lies below the surface, and then *weight is
// 0.
bool olx_glossy_draw(olx_vec3 normal, olx_vec3 view, float roughness, olx_vec2 random, olx_vec3 *direction,
                     float *weight, float *half_cosine);

#endif
