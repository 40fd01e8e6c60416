// Twin of src/select/sight.h: decides whether a probe sees a place, by the surface that it stores in that direction.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_SIGHT_GLSL
#define OLX_SIGHT_GLSL

#include "maps.glsl"


// Returns whether the probe sees `point`: whether it lies in front of the plane of the surfel stored in its direction,
// at most `slack` footprints behind it, or nearer to the probe than the texel's surface can reach. `leaving` is the
// direction of a ray that begins at the point, or 0 without one.
bool olx_probe_sees(uint probe, vec3 point, float slack, vec3 leaving) {
  precise vec3 offset = point - olx_probe_position(probe);
  float n = float(olx_field.n);
  vec2 uv = olx_octahedral_encode(offset);
  precise vec2 texel = floor(min(uv * n, vec2(n - 1.0)));
  ivec3 map = olx_map_origin(probe);
  if (olx_geometry_in_blocks()) {
    vec3 plane = olx_block_plane(map, ivec2(texel));
    precise float behind = olx_plane_depth(plane, offset) - 1.0; // in units of the plane's distance from the probe
    precise float reach = sqrt(olx_dot(offset, offset)) * sqrt(olx_texel_solid_angle_near(uv, olx_field.n)) *
                          sqrt(olx_dot(plane, plane));
    if (behind > slack * reach) return false;
    return leaving == vec3(0.0) || behind <= -OLX_SIGHT_ABOVE * reach || !(olx_dot(plane, leaving) > 0.0);
  }
  float distance = olx_texel_distance(map, ivec2(texel)), radius = sqrt(olx_dot(offset, offset));
  if (distance >= OLX_INFINITY) return true;
  precise float footprint = distance * sqrt(olx_texel_solid_angle_near(uv, olx_field.n));
  if (radius < distance - 2.0 * footprint / OLX_SIGHT_LEAST_COSINE) return true;
  precise vec2 middle = (texel + 0.5) / n;
  vec3 centre = olx_octahedral_decode(middle);
  vec3 normal = olx_texel_normal(map, ivec2(texel));
  float cosine = max(-olx_dot(normal, centre), OLX_SIGHT_LEAST_COSINE);
  if (radius < distance - 2.0 * footprint / cosine) return true;
  precise vec3 above = offset + centre * -distance;
  float height = olx_dot(normal, above);
  if (height < -slack * footprint) return false;
  return leaving == vec3(0.0) || height >= OLX_SIGHT_ABOVE * footprint || olx_dot(normal, leaving) >= 0.0;
}

#endif
