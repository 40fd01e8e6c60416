// Twin of src/field/texels.h: reads what a texel of a light field probe holds of the surface that it sees. Its distance and
// its normal are read by maps.glsl.
#ifndef OLX_TEXELS_GLSL
#define OLX_TEXELS_GLSL

#include "maps.glsl"

// Irradiance in W/m^2 of light that has at least one surface between emitter and texel; 0 for the sky.
vec3 olx_texel_indirect(ivec3 origin, ivec2 texel) {
  return texelFetch(olx_indirect_maps, origin + ivec3(texel, 0), 0).rgb;
}

#endif
