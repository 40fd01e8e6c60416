// Draws the further ray of glossy light and computes its contribution. Its twin is shaders/lib/further.glsl.
#include "shade/further.h"

#include "core/sampling.h"
#include "shade/emission.h"

bool olx_further_draw(const olx_field *field, const olx_trace_hit *hit, olx_vec3 direction, olx_vec2 random,
                      olx_further_ray *ray) {
  if (!(hit->lobe.x + hit->lobe.y + hit->lobe.z > 0.0f)) return false;
  const olx_bsdf bsdf = olx_texel_material(field, hit->probe, hit->texel);
  const olx_vec3 view = olx_negate(direction);
  const float cosine = olx_dot(view, hit->normal);
  if (!(cosine > 0.0f) || bsdf.alpha > olx_square(OLX_MOST_ROUGHNESS)) return false;
  if (olx_max3(olx_fresnel(&bsdf, cosine)) < OLX_LEAST_REFLECTANCE) return false;
  olx_vec3 tangent, bitangent;
  olx_basis(hit->normal, &tangent, &bitangent);
  const uint32_t seed = olx_hash3(olx_float_bits(random.x), olx_float_bits(random.y), OLX_SALT_FURTHER);
  const olx_vec2 drawn = {olx_unit_float(seed), olx_unit_float(olx_hash(seed))};
  float weight, half_cosine;
  const olx_vec3 local = olx_ggx_sample(bsdf.alpha, olx_v3(olx_dot(view, tangent), olx_dot(view, bitangent), cosine),
                                        drawn, &weight, &half_cosine);
  ray->origin = olx_madd(hit->position, hit->normal, OLX_START_FOOTPRINTS * hit->footprint_metres);
  ray->direction = olx_from_basis(local, hit->normal);
  ray->weight = olx_scale(olx_fresnel(&bsdf, half_cosine), weight);
  return weight > 0.0f;
}

olx_vec3 olx_further_light(const olx_trace_hit *first, const olx_further_ray *ray, const olx_trace_hit *found) {
  if (found->status == OLX_TRACE_UNKNOWN && found->probe == UINT32_MAX) return first->radiance;
  olx_vec3 light = found->radiance;
  if (olx_emission_faces(found, ray->origin)) light = olx_add(light, found->emission);
  return olx_add(olx_sub(first->radiance, first->lobe), olx_mul(ray->weight, light));
}
