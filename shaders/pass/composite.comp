// Adds indirect light to the host's picture: irradiance times the diffuse reflectance, and glossy light.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  frame_surface surface;
  if (!read_surface(pixel, surface)) return;
  vec4 color = imageLoad(color_image, pixel);
  if (has_flag(OLX_FRAME_DIFFUSE)) {
    vec3 reflectance = olx_bsdf_diffuse(surface.bsdf, olx_dot(surface.view, surface.normal));
    color.rgb += reflectance * imageLoad(irradiance_image, pixel).rgb / OLX_PI;
  }
  if (has_flag(OLX_FRAME_GLOSSY)) color.rgb += imageLoad(glossy_image, pixel).rgb;
  imageStore(color_image, pixel, storable(color.rgb, color.a));
}
