// Decides whether a probe sees a place, by the surface that it stores in that direction.
// Its twin is shaders/lib/sight.glsl.
#ifndef OLX_SELECT_SIGHT_H
#define OLX_SELECT_SIGHT_H

#include "field/maps.h"

// Returns the side of a texel of an n x n map at distance 1: the square root of its mean solid angle.
static inline float olx_mean_texel_angle(uint32_t n) { return OLX_TEXEL_ANGLE / (float)n; }

// Implements olx_probe_sees for a field of geometry blocks: `offset` from the probe falls into texel (x, y) at uv, and
// the texel's plane decides.
static inline bool olx_plane_sees(const olx_field *field, uint32_t probe, olx_vec3 offset, olx_vec2 uv, uint32_t x,
                                  uint32_t y, float slack, const olx_vec3 *leaving) {
  const olx_vec3 plane = olx_block_plane(field, probe, x, y);
  const float behind = olx_plane_depth(plane, offset) - 1.0f; // in units of the plane's distance from the probe
  const float footprint = olx_length(offset) * sqrtf(olx_texel_solid_angle_near(uv, field->n)) * olx_length(plane);
  if (behind > slack * footprint) return false;
  return !leaving || behind <= -OLX_SIGHT_ABOVE * footprint || !(olx_dot(plane, *leaving) > 0.0f);
}

// Returns whether the probe sees `point`: whether it lies in front of the plane of the surfel stored in its direction,
// at most `slack` footprints behind it, or nearer to the probe than the texel's surface can reach. `leaving` is NULL or
// the direction of a ray that begins at the point. Then a point on the surface counts only when the ray leaves towards
// the probe, because a ray into the surface has begun on the other side of something thin.
static inline bool olx_probe_sees(const olx_field *field, uint32_t probe, olx_vec3 point, float slack,
                                  const olx_vec3 *leaving) {
  const olx_vec3 offset = olx_sub(point, field->probe_positions[probe]);
  const float n = (float)field->n;
  const olx_vec2 uv = olx_octahedral_encode(offset);
  const float x = floorf(olx_min(uv.x * n, n - 1.0f)), y = floorf(olx_min(uv.y * n, n - 1.0f));
  if (field->geometry) return olx_plane_sees(field, probe, offset, uv, (uint32_t)x, (uint32_t)y, slack, leaving);
  const size_t texel = olx_map_index(field->stride, (int32_t)x, (int32_t)y);
  const float distance = olx_texel_distance(field, probe, texel), radius = olx_length(offset);
  if (distance == INFINITY) return true;
  const float footprint = distance * sqrtf(olx_texel_solid_angle_near(uv, field->n));
  if (radius < distance - 2.0f * footprint / OLX_SIGHT_LEAST_COSINE) return true;
  const olx_vec3 centre = olx_octahedral_decode((olx_vec2){(x + 0.5f) / n, (y + 0.5f) / n});
  const olx_vec3 normal = olx_texel_normal(field, probe, texel);
  const float cosine = olx_max(-olx_dot(normal, centre), OLX_SIGHT_LEAST_COSINE);
  if (radius < distance - 2.0f * footprint / cosine) return true;
  const float height = olx_dot(normal, olx_madd(offset, centre, -distance));
  if (height < -slack * footprint) return false;
  return !leaving || height >= OLX_SIGHT_ABOVE * footprint || olx_dot(normal, *leaving) >= 0.0f;
}

// Decides for several pairs of a probe and a place whether the probe sees the place, by olx_probe_sees; `leaving` is
// NULL or has a direction for each pair.
void olx_probes_see(const olx_field *field, uint32_t count, const uint32_t *probes, const olx_vec3 *points, float slack,
                    const olx_vec3 *leaving, bool *sees);

#endif
