// Glossy indirect light that leaves the surface of each pixel towards the eye, by rays traced through the field. Alpha
// is the share of rays that found an answer, 1 where none was needed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

// No factor between incident and reflected light is below this, so that dividing by it is harmless.
const float LEAST_FRESNEL = 0.01;

void gather(ivec2 pixel, frame_surface surface) {
  olx_sample_settings settings = frame_settings();
  uint seed = pixel_seed(uvec2(pixel), GLOSSY_BRANCH);
  uint count = surface.bsdf.alpha > 0.0 ? frame.glossy_samples : 1u, unknown = 0u;
  vec3 sum = vec3(0.0);
  float nearness = 0.0;
  for (uint j = 0u; j < count; j++) {
    vec2 random = olx_stratified2(frame.sample_index * count + j, seed);
    float weight, half_cosine;
    olx_trace_hit hit;
    vec3 radiance = olx_glossy(settings, surface.position, surface.normal, surface.view, surface.roughness, random,
                               weight, half_cosine, hit);
    if (weight <= 0.0) continue;
    unknown += uint(hit.status == OLX_TRACE_UNKNOWN);
    nearness += olx_nearness(hit);
    if (hit.emitter && !olx_emission_counts(settings, hit, surface.position)) continue;
    sum += olx_fresnel(surface.bsdf, half_cosine) * radiance * weight;
  }
  vec3 light = sum / float(count);
  imageStore(glossy_image, pixel, storable(light, 1.0 - float(unknown) / float(count)));
  vec3 fresnel = olx_fresnel(surface.bsdf, olx_dot(surface.view, surface.normal));
  write_sample(pixel, light / max(fresnel, vec3(LEAST_FRESNEL)), nearness / float(count));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  frame_surface surface;
  vec4 result = vec4(0.0, 0.0, 0.0, 1.0);
  if (read_surface(pixel, surface) && olx_bsdf_has_specular(surface.bsdf)) {
    float cosine = olx_dot(surface.view, surface.normal);
    if (!olx_lobe_is_dim(surface.bsdf, cosine, frame.dim_lobe)) {
      gather(pixel, surface);
      return;
    }
    vec3 irradiance = olx_irradiance(frame_settings(), surface.position, surface.normal, surface.view);
    result = storable(olx_dim_light(surface.bsdf, cosine, irradiance), 1.0);
  }
  imageStore(glossy_image, pixel, result);
  write_sample(pixel, vec3(0.0), -1.0);
}
