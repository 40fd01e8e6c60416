// Twin of src/shade/glossy.c: one ray's estimate of the light that a GGX lobe gathers.
#ifndef OLX_GLOSSY_GLSL
#define OLX_GLOSSY_GLSL

#include "bsdf.glsl"
#include "trace.glsl"

// Traces the reflection drawn by `random` (two numbers in [0, 1)) and returns its radiance. `weight` receives the BRDF
// times cosine over the pdf for Fresnel reflectance 1 (0: the reflection lies below the surface, and no ray was
// traced), `half_cosine` the angle for Fresnel (view . half), and `hit` what the ray found.
vec3 olx_glossy(olx_sample_settings settings, vec3 position, vec3 normal, vec3 view, float roughness, vec2 random,
                out float weight, out float half_cosine, out olx_trace_hit hit) {
  vec3 tangent, bitangent;
  olx_basis(normal, tangent, bitangent);
  vec3 local_view = vec3(olx_dot(view, tangent), olx_dot(view, bitangent), olx_dot(view, normal));
  float alpha = roughness < OLX_MIRROR_ROUGHNESS ? 0.0 : roughness * roughness;
  vec3 local = olx_ggx_sample(alpha, local_view, random, weight, half_cosine);
  if (weight <= 0.0) {
    vec3 none = vec3(0.0);
    hit = olx_trace_hit(OLX_TRACE_MISS, OLX_INFINITY, none, none, none, false, OLX_NO_PROBE, 0.0, 0u, 0u);
    return vec3(0.0);
  }
  hit = olx_trace(settings, position, olx_from_basis(local, normal), OLX_INFINITY);
  return hit.emitter && !settings.emitters ? vec3(0.0) : hit.radiance;
}

#endif
