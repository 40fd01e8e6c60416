// Twin of src/shade/further.c: the further ray of glossy light, a single ray that follows the specular lobe of the
// surface that a ray hit, where that surface is smooth and reflects much (docs/maths.md, "Light at the end of a ray").
//
// SPDX-License-Identifier: MIT
#ifndef OLX_FURTHER_GLSL
#define OLX_FURTHER_GLSL

#include "emission.glsl"
#include "sampling.glsl"
#include "texels.glsl"

struct olx_further_ray {
  vec3 origin, direction;
  vec3 weight; // factor for the light that it finds
};

// Draws the further ray from the surface that a ray along `direction` hit; false where that surface is not worth one.
// `random` is the pair of numbers from which the first ray was drawn.
bool olx_further_draw(olx_trace_hit hit, vec3 direction, vec2 random, out olx_further_ray ray) {
  ray = olx_further_ray(vec3(0.0), vec3(0.0), vec3(0.0));
  bool drawn = hit.lobe.x + hit.lobe.y + hit.lobe.z > 0.0;
  if (drawn) {
    olx_bsdf bsdf = olx_texel_material(olx_map_origin(hit.probe), hit.texel);
    vec3 view = -direction;
    float cosine = olx_dot(view, hit.normal);
    vec3 reflectance = olx_fresnel(bsdf, cosine);
    drawn = cosine > 0.0 && bsdf.alpha <= olx_square(OLX_MOST_ROUGHNESS) &&
            max(reflectance.x, max(reflectance.y, reflectance.z)) >= OLX_LEAST_REFLECTANCE;
    if (drawn) {
      vec3 tangent, bitangent;
      olx_basis(hit.normal, tangent, bitangent);
      uint seed = olx_hash3(floatBitsToUint(random.x), floatBitsToUint(random.y), OLX_SALT_FURTHER);
      float weight, half_cosine;
      vec3 local = olx_ggx_sample(bsdf.alpha, vec3(olx_dot(view, tangent), olx_dot(view, bitangent), cosine),
                                  vec2(olx_unit_float(seed), olx_unit_float(olx_hash(seed))), weight, half_cosine);
      precise vec3 origin = hit.position + hit.normal * (OLX_START_FOOTPRINTS * hit.footprint_metres);
      ray.origin = origin;
      ray.direction = olx_from_basis(local, hit.normal);
      ray.weight = olx_fresnel(bsdf, half_cosine) * weight;
      drawn = weight > 0.0;
    }
  }
  return drawn;
}

// Returns the light that replaces the first hit's `lobe` once the further ray has found something. Emission counts
// here, because the first hit's `lobe` included direct light.
vec3 olx_further_light(vec3 lobe, olx_further_ray ray, olx_trace_hit found) {
  vec3 light = found.radiance + (olx_emission_faces(found, ray.origin) ? found.emission : vec3(0.0));
  return found.status == OLX_TRACE_UNKNOWN && found.probe == OLX_NO_PROBE ? lobe : ray.weight * light;
}

#endif
