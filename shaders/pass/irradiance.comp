// Computes the indirect irradiance at the surface of each pixel: for static surfaces from texels, else from the
// irradiance volume. Alpha is 1 where there is a surface.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_irradiance.glsl"

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
  imageStore(irradiance_image, pixel, found ? storable(state.light.irradiance, 1.0) : vec4(0.0));
}
