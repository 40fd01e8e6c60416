// Draws rays from the specular lobe of a surface, traces them through the field, and weights the light that they find.
// Its twin is shaders/lib/glossy.glsl.
#include "shade/glossy.h"

#include "shade/emission.h"
#include "shade/further.h"

bool olx_glossy_draw(olx_vec3 normal, olx_vec3 view, float roughness, olx_vec2 random, olx_vec3 *direction,
                     float *weight, float *half_cosine) {
  olx_vec3 tangent, bitangent;
  olx_basis(normal, &tangent, &bitangent);
  const olx_vec3 local_view = olx_v3(olx_dot(view, tangent), olx_dot(view, bitangent), olx_dot(view, normal));
  const float alpha = roughness < OLX_MIRROR_ROUGHNESS ? 0.0f : roughness * roughness;
  const olx_vec3 local = olx_ggx_sample(alpha, local_view, random, weight, half_cosine);
  if (*weight <= 0.0f) return false;
  *direction = olx_from_basis(local, normal);
  return true;
}

olx_vec3 olx_glossy(const olx_field *field, const olx_sample_settings *settings, olx_vec3 position, olx_vec3 normal,
                    olx_vec3 view, float roughness, olx_vec2 random, float *weight, float *half_cosine,
                    olx_trace_hit *hit) {
  olx_vec3 direction;
  if (!olx_glossy_draw(normal, view, roughness, random, &direction, weight, half_cosine)) {
    if (hit) *hit = (olx_trace_hit){.status = OLX_TRACE_MISS, .distance_metres = INFINITY, .probe = UINT32_MAX};
    return olx_splat(0.0f);
  }
  olx_trace_hit found = olx_trace(field, settings, position, direction, INFINITY);
  if (hit) *hit = found;
  olx_further_ray further;
  if (olx_further_draw(field, &found, direction, random, &further)) {
    const olx_trace_hit second = olx_trace(field, settings, further.origin, further.direction, INFINITY);
    found.radiance = olx_further_light(&found, &further, &second);
  }
  return olx_light_found(settings, &found, position);
}
