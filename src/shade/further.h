// The further ray of glossy light: a single ray that follows the specular lobe of the surface that a ray hit, where
// that surface is smooth and reflects much (docs/maths.md, "Light at the end of a ray").
#ifndef OLX_SHADE_FURTHER_H
#define OLX_SHADE_FURTHER_H

#include "field/texels.h"

#include <octalux/sample.h>

typedef struct olx_further_ray {
  olx_vec3 origin, direction;
  olx_vec3 weight; // factor for the light that it finds
} olx_further_ray;

// Draws the further ray from the surface that a ray along `direction` hit; false where that surface is not worth one.
// `random` is the pair of numbers from which the first ray was drawn.
bool olx_further_draw(const olx_field *field, const olx_trace_hit *hit, olx_vec3 direction, olx_vec2 random,
                      olx_further_ray *ray);

// Returns the light that the surface reflects along the first ray, given what the further ray found; it replaces
// first->lobe. Emission counts here, because first->lobe included direct light.
olx_vec3 olx_further_light(const olx_trace_hit *first, const olx_further_ray *ray, const olx_trace_hit *found);

#endif
