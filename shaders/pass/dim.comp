// Computes glossy indirect light of rough lobes that reflect so little towards the eye that irradiance replaces rays:
// the pixels that trace.comp leaves out.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame_irradiance.glsl"

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  irradiance_state state = begin_irradiance();
  for (uint round = 0u; round < 2u; round++) {
    frame_surface surface;
    if (!read_surface(pixel, surface) || !olx_bsdf_has_specular(surface.bsdf)) return;
    float cosine = olx_dot(surface.view, surface.normal);
    if (!olx_lobe_is_dim(surface.bsdf, cosine, frame.dim_lobe)) return;
    if (round == 0u) {
      look_up_irradiance(pixel, surface, state);
    } else {
      complete_irradiance(pixel, surface, state);
      vec3 light = olx_dim_light(surface.bsdf, cosine, state.light.irradiance);
      imageStore(glossy_image, pixel, storable(light, 1.0));
      write_sample(pixel, vec3(0.0), -1.0);
    }
  }
}
