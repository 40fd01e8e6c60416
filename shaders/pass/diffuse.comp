// Computes the indirect irradiance at the surface of each pixel, by cosine-distributed rays traced through the field.
// Alpha is 1 where there is a surface.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

void gather(ivec2 pixel, frame_surface surface) {
  olx_sample_settings settings = frame_settings();
  uint count = frame.diffuse_samples, seed = pixel_seed(uvec2(pixel), OLX_DIFFUSE_BRANCH);
  vec3 sum = vec3(0.0);
  float nearness = 0.0;
  for (uint j = 0u; j < count; j++) {
    vec2 random = olx_stratified2(frame.sample_index * count + j, seed);
    vec3 direction = olx_from_basis(olx_sample_cosine(random), surface.normal);
    // The way to the eye is computed again, so that it is not kept while rays are traced.
    if (leads_inside(pixel, frame.eye.xyz - surface.position, direction)) continue;
    olx_trace_hit hit = olx_trace(settings, surface.position, direction, OLX_INFINITY);
    sum += olx_light_found(settings, hit, surface.position);
    nearness += olx_nearness(hit);
  }
  vec3 irradiance = sum * (OLX_PI / float(count));
  imageStore(irradiance_image, pixel, storable(irradiance, 1.0));
  write_sample(pixel, irradiance, nearness / float(count));
}

void main() {
  ivec2 pixel = pixel_to_trace();
  if (outside_frame(pixel)) return;
  frame_surface surface;
  bool seen = read_surface(pixel, surface);
  if (seen && any(greaterThan(olx_bsdf_diffuse(surface.bsdf, olx_dot(surface.view, surface.normal)), vec3(0.0)))) {
    gather(pixel, surface);
    return;
  }
  imageStore(irradiance_image, pixel, vec4(vec3(0.0), seen ? 1.0 : 0.0));
  write_sample(pixel, vec3(0.0), -1.0);
}
