// The irradiance pass, which here writes how often it reads the field's images instead of light: filtered reads of the
// irradiance volume, and texels of light field maps.
#version 460
#extension GL_GOOGLE_include_directive : require

uint filtered = 0u, fetched = 0u;

vec4 counted_read(sampler2DArray maps, vec3 at, float lod) {
  filtered++;
  return textureLod(maps, at, lod);
}

vec4 counted_fetch(sampler2DArray maps, ivec3 at, int lod) {
  fetched++;
  return texelFetch(maps, at, lod);
}

uvec4 counted_fetch(usampler2DArray maps, ivec3 at, int lod) {
  fetched++;
  return texelFetch(maps, at, lod);
}

vec4 counted_fetch(sampler2D host_image, ivec2 at, int lod) { return texelFetch(host_image, at, lod); }

#define textureLod counted_read
#define texelFetch counted_fetch
#include "shaders/pass/frame_irradiance.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  irradiance_state state = begin_irradiance();
  bool found = true;
  for (uint round = 0u; round < 2u; round++) {
    frame_surface surface;
    found = read_surface(pixel, surface);
    if (!found) break;
    if (round == 0u) look_up_irradiance(pixel, surface, state);
    else complete_irradiance(pixel, surface, state);
  }
  // The light is written as well, since compilers would otherwise remove the reads.
  imageStore(irradiance_image, pixel,
             vec4(float(filtered), float(fetched), state.light.irradiance.r, found ? 1.0 : 0.0));
}
