// Light that leaves the surface of a texel towards an eye of the caller's, not that of the probe (docs/maths.md, "Light
// at the end of a ray").
#ifndef OLX_TRACE_TEXEL_SHADE_H
#define OLX_TRACE_TEXEL_SHADE_H

#include "field/texels.h"

// Fields with more lights without area have no highlights of single lights; their specular lobes get that light as
// matte ones do.
enum { OLX_MOST_HIGHLIGHTS = 16 };

// Light in W/(sr m^2) that a surface reflects towards an eye.
typedef struct olx_texel_light {
  olx_vec3 reflected; // through the diffuse lobe, and the highlights of lights without area
  olx_vec3 lobe;      // what the specular lobe makes of all other light, as if it came from all directions alike
} olx_texel_light;

// `position`: metres, on the texel's surface; `direction`: of the ray that found it, unit. 0 for the sky.
olx_texel_light olx_texel_shade(const olx_field *field, uint32_t probe, size_t texel, olx_vec3 position,
                                olx_vec3 direction);

#endif
