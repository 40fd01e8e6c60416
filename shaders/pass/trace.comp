// Glossy indirect light that leaves the surface of each pixel towards the eye, by rays traced through the field. Alpha
// is the share of rays that found an answer, 1 where none was needed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

const uint GLOSSY_BRANCH = 0x85EBCA6Bu + 3u; // the renderer's seed of this pass's random numbers

uint pixel_seed(uvec2 pixel) {
  uint seed = olx_hash2(pixel.x, pixel.y);
  return frame.seed != 0u ? olx_hash2(seed, frame.seed) : seed;
}

vec4 gather(frame_surface surface, uint seed) {
  olx_sample_settings settings = frame_settings();
  uint count = surface.bsdf.alpha > 0.0 ? frame.glossy_samples : 1u, unknown = 0u;
  vec3 sum = vec3(0.0);
  for (uint j = 0u; j < count; j++) {
    vec2 random = olx_stratified2(frame.sample_index * count + j, seed);
    float weight, half_cosine;
    olx_trace_hit hit;
    vec3 radiance = olx_glossy(settings, surface.position, surface.normal, surface.view, surface.roughness, random,
                               weight, half_cosine, hit);
    if (weight <= 0.0) continue;
    unknown += uint(hit.status == OLX_TRACE_UNKNOWN);
    sum += olx_fresnel(surface.bsdf, half_cosine) * radiance * weight;
  }
  return storable(sum / float(count), 1.0 - float(unknown) / float(count));
}

// Light of all directions alike, for rough lobes that reflect little.
bool is_dim(frame_surface surface, out vec3 light) {
  vec3 f = olx_fresnel(surface.bsdf, olx_dot(surface.view, surface.normal));
  bool dim = surface.bsdf.alpha > 0.0 && max(f.r, max(f.g, f.b)) < frame.dim_lobe;
  light = vec3(0.0);
  if (dim) light = f * olx_irradiance(frame_settings(), surface.position, surface.normal, surface.view) / OLX_PI;
  return dim;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (outside_frame(pixel)) return;
  frame_surface surface;
  vec4 result = vec4(0.0, 0.0, 0.0, 1.0);
  vec3 light;
  if (read_surface(pixel, surface) && olx_bsdf_has_specular(surface.bsdf)) {
    result = is_dim(surface, light) ? storable(light, 1.0)
                                    : gather(surface, olx_hash2(pixel_seed(uvec2(pixel)), GLOSSY_BRANCH));
  }
  imageStore(glossy_image, pixel, result);
}
