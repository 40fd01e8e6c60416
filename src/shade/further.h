// The one further ray with which glossy light follows the specular lobe of the surface that a ray found, where that
// surface is smooth and reflects much (docs/maths.md, "Light at the end of a ray").
#ifndef OLX_SHADE_FURTHER_H
#define OLX_SHADE_FURTHER_H

#include "field/texels.h"

#include <octalux/sample.h>

typedef struct olx_further_ray {
  olx_vec3 origin, direction;
  olx_vec3 weight; // of the light that it finds
} olx_further_ray;

// Whether the surface that a ray along `direction` found is worth a further ray, and that ray. `random`: the numbers
// from which the first ray was drawn.
bool olx_further_draw(const olx_field *field, const olx_trace_hit *hit, olx_vec3 direction, olx_vec2 random,
                      olx_further_ray *ray);

// Light that the surface reflects along the first ray once the further one has found something: that takes the place of
// first->lobe. What emits counts here, since the surface's direct light from there is what the lobe reflects.
olx_vec3 olx_further_light(const olx_trace_hit *first, const olx_further_ray *ray, const olx_trace_hit *found);

#endif
