// The octahedral map of the sphere onto the unit square (Cigolle et al. 2014), with y as the axis (docs/maths.md).
// These are the only functions that encode and decode it. Its twin is shaders/lib/octahedral.glsl.
#ifndef OLX_CORE_OCTAHEDRAL_H
#define OLX_CORE_OCTAHEDRAL_H

#include "core/vec.h"

// Maps a direction of any finite length to [0, 1]^2; one without length to the middle.
static inline olx_vec2 olx_octahedral_encode(olx_vec3 d) {
  const float inverse = 1.0f / olx_max(OLX_LEAST_LENGTH, fabsf(d.x) + fabsf(d.y) + fabsf(d.z));
  float x = d.x * inverse, z = d.z * inverse;
  if (d.y < 0.0f) {
    const float folded_x = (1.0f - fabsf(z)) * olx_sign_not_zero(x);
    z = (1.0f - fabsf(x)) * olx_sign_not_zero(z);
    x = folded_x;
  }
  return (olx_vec2){x * 0.5f + 0.5f, z * 0.5f + 0.5f};
}

// Returns the point on the octahedron |x| + |y| + |z| = 1.
static inline olx_vec3 olx_octahedral_point(olx_vec2 uv) {
  olx_vec3 q = {uv.x * 2.0f - 1.0f, 0.0f, uv.y * 2.0f - 1.0f};
  q.y = 1.0f - fabsf(q.x) - fabsf(q.z);
  if (q.y < 0.0f) {
    const float x = (1.0f - fabsf(q.z)) * olx_sign_not_zero(q.x);
    q.z = (1.0f - fabsf(q.x)) * olx_sign_not_zero(q.z);
    q.x = x;
  }
  return q;
}

static inline olx_vec3 olx_octahedral_decode(olx_vec2 uv) { return olx_normalize(olx_octahedral_point(uv)); }

// Returns the direction through the centre of texel (x, y) of a map with n texels a side.
static inline olx_vec3 olx_texel_direction(uint32_t x, uint32_t y, uint32_t n) {
  return olx_octahedral_decode((olx_vec2){((float)x + 0.5f) / (float)n, ((float)y + 0.5f) / (float)n});
}

// Returns the exact solid angle of texel (x, y) of a map with n texels a side, n even; a texel cut by a fold is split
// there. All texels sum to 4 pi.
double olx_texel_solid_angle(uint32_t x, uint32_t y, uint32_t n);

// Returns the solid angle of a texel at a point of the map, to first order: 4 / (n^2 |q|^3).
static inline float olx_texel_solid_angle_near(olx_vec2 uv, uint32_t n) {
  const float length = olx_length(olx_octahedral_point(uv));
  return 4.0f / ((float)n * (float)n * length * length * length);
}

// Finds the texel inside the map that a texel of the one-texel border repeats; x and y are from -1 to n.
static inline void olx_border_source(int32_t x, int32_t y, int32_t n, int32_t *source_x, int32_t *source_y) {
  if (x < 0 || x >= n) {
    x = x < 0 ? -1 - x : 2 * n - 1 - x;
    y = n - 1 - y;
  }
  if (y < 0 || y >= n) {
    y = y < 0 ? -1 - y : 2 * n - 1 - y;
    x = n - 1 - x;
  }
  *source_x = x;
  *source_y = y;
}

#endif
