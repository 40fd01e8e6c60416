// Computes the indirect irradiance at the surface of each pixel: for static surfaces from texels, else from the
// irradiance volume. Alpha is 1 where there is a surface.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_irradiance.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  frame_surface surface;
  vec4 result = vec4(0.0);
  if (read_surface(pixel, surface)) {
    result = storable(frame_irradiance(pixel, surface), 1.0);
  }
  imageStore(irradiance_image, pixel, result);
}
