// Twin of src/shade/irradiance.c: irradiance interpolated from probes with prefiltered visibility (McGuire et al. 2017,
// section 5.2). The C code lists probes and weights before it reads irradiance; here each probe is added as it is
// found.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_IRRADIANCE_GLSL
#define OLX_IRRADIANCE_GLSL

#include "cage.glsl"
#include "maps.glsl"
#include "settings.glsl"


struct olx_surface_point {
  vec3 position, normal, view;
};

#ifndef OLX_OWN_MAPS // a host with maps of its own defines a function of this name before this file
vec3 olx_map_irradiance(uint probe, vec2 uv) {
  return olx_irradiance_filtered(olx_irradiance_coordinate(probe, uv));
}
#endif

// Returns the irradiance for two normals, whose coordinates are uv.xy and uv.zw.
mat2x3 olx_map_irradiance_both(uint probe, vec4 uv) {
  return mat2x3(olx_map_irradiance(probe, uv.xy), olx_map_irradiance(probe, uv.zw));
}

// Returns the mean distance in metres and the mean squared distance in square metres.
vec2 olx_map_moments(uint probe, vec3 direction) {
  vec2 uv = olx_octahedral_encode(direction);
  vec2 moments = olx_moments_filtered(olx_irradiance_coordinate(probe, uv));
  return vec2(moments.x * olx_field.distance_scale, moments.y * olx_field.distance_scale * olx_field.distance_scale);
}

// Returns an upper bound on the share of a probe's view around `offset` (from the probe) that is at least as far away
// as that.
float olx_chebyshev(uint probe, vec3 offset) {
  vec2 moments = olx_map_moments(probe, offset);
  float beyond = length(offset) - moments.x;
  if (beyond <= 0.0) return 1.0;
  float variance = max(moments.y - moments.x * moments.x, OLX_VARIANCE_FLOOR * moments.x * moments.x);
  return variance / (variance + beyond * beyond);
}

float olx_visibility(bool visibility, uint probe, vec3 from_probe, olx_surface_point p) {
  if (!visibility) return 1.0;
  float angle = OLX_TEXEL_ANGLE / min(float(olx_field.irradiance_n), OLX_BIAS_MAP_SIZE);
  from_probe += olx_normalize(p.normal + p.view) * (length(from_probe) * angle);
  float bound = olx_chebyshev(probe, from_probe);
  return bound * bound * bound;
}

float olx_probe_weight(bool visibility, uint probe, vec3 from_probe, olx_surface_point p) {
  if (!visibility) return 1.0;
  float weight = olx_visibility(visibility, probe, from_probe, p);
  float cosine = -olx_dot(olx_normalize(from_probe), p.normal);
  weight *= olx_square(0.5 * (cosine + 1.0));
  if (weight < OLX_CRUSH_BELOW) weight *= olx_square(weight / OLX_CRUSH_BELOW);
  return weight;
}

bool olx_irradiance_usable(olx_sample_settings settings, uint probe) {
  return settings.keep_buried || (olx_irradiance_probe_flags(probe) & OLX_PROBE_BURIED) == 0u;
}

// Finds the nearest probe that sees a point, among the 4 x 4 x 4 around it, for a point that its cage hardly sees.
// Returns false when none of them sees it.
bool olx_nearest_visible(olx_sample_settings settings, olx_surface_point p, olx_cage cage, out uint nearest) {
  float nearest_distance = OLX_INFINITY;
  nearest = 0u;
  for (uint i = 0u; i < 64u; i++) {
    uvec3 at = cage.base + uvec3(i & 3u, i >> 2 & 3u, i >> 4) - 1u; // a negative index wraps to a huge number
    if (any(greaterThanEqual(at, olx_field.irradiance_grid.count.xyz))) continue;
    uint probe = at.x + olx_field.irradiance_grid.count.x * (at.y + olx_field.irradiance_grid.count.y * at.z);
    if (!olx_irradiance_usable(settings, probe)) continue;
    vec3 from_probe = p.position - olx_irradiance_probe_position(probe);
    float distance = length(from_probe);
    if (distance >= nearest_distance || olx_visibility(settings.visibility, probe, from_probe, p) < 0.5) continue;
    nearest_distance = distance;
    nearest = probe;
  }
  return nearest_distance < OLX_INFINITY;
}

// Returns irradiance where the cage sees too little of the point: that of the nearest visible probe, or, if there is
// none, the mean of all probes of the cage.
mat2x3 olx_add_from_afar(olx_sample_settings settings, olx_surface_point p, olx_cage cage, vec4 uv) {
  uint nearest;
  if (olx_nearest_visible(settings, p, cage, nearest)) return olx_map_irradiance_both(nearest, uv);
  mat2x3 sum = mat2x3(0.0);
  float count = 0.0;
  for (uint corner = 0u; corner < 8u; corner++) {
    if (!olx_cage_has(cage, corner)) continue;
    uint probe = olx_cage_probe(olx_field.irradiance_grid, cage, corner);
    if (!olx_irradiance_usable(settings, probe)) continue;
    sum += olx_map_irradiance_both(probe, uv);
    count += 1.0;
  }
  return sum / max(count, 1.0);
}

// Returns irradiance for the normals `from` and `to`, with the weights that the probes around the point have for
// `from`; 0 in a field without irradiance probes.
mat2x3 olx_irradiance_both(olx_sample_settings settings, vec3 position, vec3 from, vec3 to, vec3 view) {
  olx_surface_point p = olx_surface_point(position, from, view);
  olx_cage cage = olx_cage_at(olx_field.irradiance_grid, position);
  vec4 uv = vec4(olx_octahedral_encode(from), olx_octahedral_encode(to));
  mat2x3 irradiance = mat2x3(0.0);
  if (olx_field.irradiance_grid.count.w == 0u) return irradiance;
  float sum = 0.0;
  for (uint corner = 0u; corner < 8u; corner++) {
    if (!olx_cage_has(cage, corner)) continue;
    uint probe = olx_cage_probe(olx_field.irradiance_grid, cage, corner);
    if (!olx_irradiance_usable(settings, probe)) continue;
    vec3 from_probe = position - olx_irradiance_probe_position(probe);
    float trilinear = olx_cage_weight(cage, corner);
    if (trilinear <= 0.0) continue;
    float weight = trilinear * olx_probe_weight(settings.visibility, probe, from_probe, p);
    if (weight <= 0.0) continue;
    irradiance += olx_map_irradiance_both(probe, uv) * weight;
    sum += weight;
  }
  irradiance /= max(sum, OLX_TRUSTED_WEIGHT);
  if (sum < OLX_TRUSTED_WEIGHT) {
    irradiance += olx_add_from_afar(settings, p, cage, uv) * (1.0 - sum / OLX_TRUSTED_WEIGHT);
  }
  return irradiance;
}

// Returns the indirect irradiance in W/m^2 on a surface at `position` with unit normal `normal`, seen from the
// direction `view` (unit, from the surface to the eye). Diffuse light leaving the surface is albedo * irradiance / pi.
vec3 olx_irradiance(olx_sample_settings settings, vec3 position, vec3 normal, vec3 view) {
  return olx_irradiance_both(settings, position, normal, normal, view)[0];
}

#endif
