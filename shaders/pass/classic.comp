// Lights both lobes of each pixel by classic maps, irradiance probes without visibility, for comparison.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "../lib/classic.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  frame_surface surface;
  vec4 irradiance = vec4(0.0), glossy = vec4(0.0);
  if (read_surface(pixel, surface)) {
    olx_sample_settings settings = frame_settings();
    irradiance = storable(olx_classic_irradiance(settings, surface.position, surface.normal), 1.0);
    if (olx_bsdf_has_specular(surface.bsdf)) {
      glossy = storable(olx_classic_glossy(settings, surface.position, surface.normal, surface.view, surface.roughness,
                                           surface.bsdf.f0, surface.bsdf.f90),
                        1.0);
    }
  }
  imageStore(irradiance_image, pixel, irradiance);
  imageStore(glossy_image, pixel, glossy);
}
