// Computes the light that a texel's surface sends towards any eye, not only the probe (docs/maths.md, "Light at the end
// of a ray").
#ifndef OLX_TRACE_TEXEL_SHADE_H
#define OLX_TRACE_TEXEL_SHADE_H

#include "field/texels.h"

// The most lights without area for which a field has highlights. With more of them, specular lobes receive their light
// as from all directions alike.
enum { OLX_MOST_HIGHLIGHTS = 64 };

// Radiance in W/(sr m^2) that a surface reflects towards an eye.
typedef struct olx_texel_light {
  olx_vec3 reflected; // of the diffuse lobe, and the highlights of lights without area
  olx_vec3 lobe;      // of the specular lobe in all other light, as if it came from all directions alike
} olx_texel_light;

// Shades a texel's surface. `position` is on that surface, in metres; `direction` is the unit direction of the ray that
// found it. `vanished`: the ray went behind the surface, and no probe can follow it, so direct light is taken to be
// none. The result is 0 for the sky.
olx_texel_light olx_texel_shade(const olx_field *field, uint32_t probe, size_t texel, olx_vec3 position,
                                olx_vec3 direction, bool vanished);

#endif
