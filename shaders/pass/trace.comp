// Computes glossy indirect light that leaves the surface of each pixel towards the eye, by rays traced through the
// field, and by one further ray from each smooth surface that a ray hit. Both are traced at one place in the code,
// because compilers inline the whole search there. Alpha is the share of rays that were resolved, 1 where none was
// needed. Pixels whose lobe is dim are left to dim.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

// The sums over a pixel's rays.
struct gathered {
  vec3 light;
  float nearness;
  uint unknown;
};

// The further ray that waits to be traced, from a surface that a pixel's ray hit, and its weight for the pixel.
struct waiting_ray {
  bool waits;
  olx_further_ray ray;
  vec3 lobe; // the light that it replaces
};

// Traces one ray and adds its light: the waiting one, or else one drawn by the pixel's surface, which may leave another
// waiting.
void trace_ray(ivec2 pixel, frame_surface surface, vec2 random, inout waiting_ray next, inout gathered sum) {
  olx_sample_settings settings = frame_settings();
  bool further = next.waits;
  if (!further) {
    float weight, half_cosine;
    vec3 direction;
    if (!olx_glossy_draw(surface.normal, surface.view, surface.roughness, random, direction, weight, half_cosine))
      return;
    if (leads_inside(pixel, surface.view, direction)) return;
    next.ray = olx_further_ray(surface.position, direction, olx_fresnel(surface.bsdf, half_cosine) * weight);
  }
  olx_trace_hit hit = olx_trace(settings, next.ray.origin, next.ray.direction, OLX_INFINITY);
  if (further) {
    sum.light += olx_further_light(next.lobe, next.ray, hit);
    next.waits = false;
  } else {
    sum.unknown += uint(hit.status == OLX_TRACE_UNKNOWN);
    sum.nearness += olx_nearness(hit);
    vec3 reflected = next.ray.weight, light = olx_light_found(settings, hit, next.ray.origin);
    next.waits = olx_further_draw(hit, next.ray.direction, random, next.ray);
    next.ray.weight *= reflected;
    next.lobe = reflected * hit.lobe;
    sum.light += reflected * (next.waits ? light - hit.lobe : light);
  }
}

void write_gathered(ivec2 pixel, frame_surface surface, gathered sum, uint count) {
  vec3 light = sum.light / float(count);
  imageStore(glossy_image, pixel, storable(light, 1.0 - float(sum.unknown) / float(count)));
  vec3 fresnel = olx_fresnel(surface.bsdf, olx_dot(surface.view, surface.normal));
  write_sample(pixel, light / max(fresnel, vec3(OLX_LEAST_FRESNEL)), sum.nearness / float(count));
}

void main() {
  ivec2 pixel = pixel_to_trace();
  if (outside_frame(pixel)) return;
  gathered sum = gathered(vec3(0.0), 0.0, 0u);
  vec3 none = vec3(0.0);
  waiting_ray next = waiting_ray(false, olx_further_ray(none, none, none), none);
  // The surface is read again for each ray, and once more after the last, so that less is kept while rays are traced.
  for (uint j = 0u;; j += uint(!next.waits)) {
    frame_surface surface;
    if (!read_surface(pixel, surface) || !olx_bsdf_has_specular(surface.bsdf)) {
      imageStore(glossy_image, pixel, vec4(0.0, 0.0, 0.0, 1.0));
      write_sample(pixel, vec3(0.0), -1.0);
      return;
    }
    if (olx_lobe_is_dim(surface.bsdf, olx_dot(surface.view, surface.normal), frame.dim_lobe)) return;
    uint count = surface.bsdf.alpha > 0.0 ? frame.glossy_samples : 1u;
    if (j == count) {
      write_gathered(pixel, surface, sum, count);
      return;
    }
    vec2 random = olx_stratified2(frame.sample_index * count + j, pixel_seed(uvec2(pixel), OLX_GLOSSY_BRANCH));
    trace_ray(pixel, surface, random, next, sum);
  }
}
