// Twin of src/shade/glossy.c: estimates by one ray the light that a GGX lobe gathers.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_GLOSSY_GLSL
#define OLX_GLOSSY_GLSL

#include "bsdf.glsl"
#include "further.glsl"
#include "trace.glsl"

// Draws a reflection by `random` (two numbers in [0, 1)). `weight` receives the BRDF times cosine over the pdf for
// Fresnel reflectance 1, and `half_cosine` the cosine for Fresnel (view . half). Returns false, with a weight of 0,
// when the reflection lies below the surface.
bool olx_glossy_draw(vec3 normal, vec3 view, float roughness, vec2 random, out vec3 direction, out float weight,
                     out float half_cosine) {
  vec3 tangent, bitangent;
  olx_basis(normal, tangent, bitangent);
  vec3 local_view = vec3(olx_dot(view, tangent), olx_dot(view, bitangent), olx_dot(view, normal));
  float alpha = roughness < OLX_MIRROR_ROUGHNESS ? 0.0 : roughness * roughness;
  vec3 local = olx_ggx_sample(alpha, local_view, random, weight, half_cosine);
  direction = olx_from_basis(local, normal);
  return weight > 0.0;
}

// Traces the reflection drawn by olx_glossy_draw and returns its light. `hit` receives what the ray found; no ray is
// traced below the surface. Rays are traced at one place in the code, because compilers inline the whole search there.
vec3 olx_glossy(olx_sample_settings settings, vec3 position, vec3 normal, vec3 view, float roughness, vec2 random,
                out float weight, out float half_cosine, out olx_trace_hit hit) {
  hit = olx_unknown_hit(OLX_TRACE_MISS, OLX_INFINITY);
  olx_further_ray ray = olx_further_ray(position, vec3(0.0), vec3(1.0));
  vec3 light = vec3(0.0), lobe = vec3(0.0);
  bool further = false;
  bool more = olx_glossy_draw(normal, view, roughness, random, ray.direction, weight, half_cosine);
  while (more) {
    olx_trace_hit found = olx_trace(settings, ray.origin, ray.direction, OLX_INFINITY);
    if (further) {
      light += olx_further_light(lobe, ray, found);
      more = false;
    } else {
      hit = found;
      light = olx_light_found(settings, hit, position);
      more = olx_further_draw(hit, ray.direction, random, ray);
      lobe = hit.lobe;
      if (more) light -= lobe;
      further = true;
    }
  }
  return light;
}

#endif
