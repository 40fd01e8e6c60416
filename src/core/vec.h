// Vector maths on olx_vec3, named as in GLSL. Its twin is shaders/lib/vec.glsl.
#ifndef OLX_CORE_VEC_H
#define OLX_CORE_VEC_H

#include "shaders/octalux_shared.h"

#include <octalux/base.h>

#include <math.h>

static inline float olx_min(float a, float b) { return a < b ? a : b; }
static inline float olx_max(float a, float b) { return a > b ? a : b; }
static inline float olx_clamp(float x, float low, float high) { return olx_min(olx_max(x, low), high); }
static inline float olx_mix(float a, float b, float t) { return a + (b - a) * t; }
static inline float olx_square(float x) { return x * x; }
// Returns -1 for negative numbers, else 1 (also for 0), as the octahedral map requires.
static inline float olx_sign_not_zero(float x) { return x >= 0.0f ? 1.0f : -1.0f; }

static inline olx_vec3 olx_v3(float x, float y, float z) { return (olx_vec3){x, y, z}; }
// Reads a vector from the three floats that files store.
// Returns a component of a vector: x, y and z are 0, 1 and 2.
static inline float olx_component(olx_vec3 v, uint32_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
static inline olx_vec3 olx_load3(const float stored[3]) { return olx_v3(stored[0], stored[1], stored[2]); }
static inline void olx_store3(float stored[3], olx_vec3 v) {
  stored[0] = v.x;
  stored[1] = v.y;
  stored[2] = v.z;
}
static inline olx_vec3 olx_splat(float s) { return olx_v3(s, s, s); }
static inline olx_vec3 olx_add(olx_vec3 a, olx_vec3 b) { return olx_v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline olx_vec3 olx_sub(olx_vec3 a, olx_vec3 b) { return olx_v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline olx_vec3 olx_mul(olx_vec3 a, olx_vec3 b) { return olx_v3(a.x * b.x, a.y * b.y, a.z * b.z); }
static inline olx_vec3 olx_scale(olx_vec3 a, float s) { return olx_v3(a.x * s, a.y * s, a.z * s); }
static inline olx_vec3 olx_negate(olx_vec3 a) { return olx_v3(-a.x, -a.y, -a.z); }
// Returns a + b * s.
static inline olx_vec3 olx_madd(olx_vec3 a, olx_vec3 b, float s) {
  return olx_v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}
static inline olx_vec3 olx_mix3(olx_vec3 a, olx_vec3 b, float t) { return olx_madd(a, olx_sub(b, a), t); }
static inline float olx_dot(olx_vec3 a, olx_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline olx_vec3 olx_cross(olx_vec3 a, olx_vec3 b) {
  return olx_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline float olx_length(olx_vec3 a) { return sqrtf(olx_dot(a, a)); }
// Returns the unit vector; a vector of length 0 is returned unchanged.
static inline olx_vec3 olx_normalize(olx_vec3 a) {
  const float length = olx_length(a);
  return length > 0.0f ? olx_scale(a, 1.0f / length) : a;
}
static inline olx_vec3 olx_reflect(olx_vec3 direction, olx_vec3 normal) {
  return olx_madd(direction, normal, -2.0f * olx_dot(direction, normal));
}
static inline float olx_max3(olx_vec3 a) { return olx_max(a.x, olx_max(a.y, a.z)); }
static inline olx_vec3 olx_min_each(olx_vec3 a, olx_vec3 b) {
  return olx_v3(olx_min(a.x, b.x), olx_min(a.y, b.y), olx_min(a.z, b.z));
}
static inline olx_vec3 olx_max_each(olx_vec3 a, olx_vec3 b) {
  return olx_v3(olx_max(a.x, b.x), olx_max(a.y, b.y), olx_max(a.z, b.z));
}
// Returns the Rec.709 luminance.
static inline float olx_luminance(olx_vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
static inline bool olx_finite(olx_vec3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }
// Returns whether a position is within the limit of all positions; false for NaN.
static inline bool olx_is_position(olx_vec3 p) {
  const float limit = (float)OLX_POSITION_LIMIT_METRES;
  return fabsf(p.x) <= limit && fabsf(p.y) <= limit && fabsf(p.z) <= limit;
}

// Computes two unit vectors that complete the unit vector n to a right-handed orthonormal basis (Duff et al. 2017).
static inline void olx_basis(olx_vec3 n, olx_vec3 *tangent, olx_vec3 *bitangent) {
  const float s = n.z >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (s + n.z), b = n.x * n.y * a;
  *tangent = olx_v3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
  *bitangent = olx_v3(b, s + n.y * n.y * a, -n.y);
}
// Converts coordinates in the basis of n to world space.
static inline olx_vec3 olx_from_basis(olx_vec3 local, olx_vec3 n) {
  olx_vec3 t, b;
  olx_basis(n, &t, &b);
  return olx_add(olx_add(olx_scale(t, local.x), olx_scale(b, local.y)), olx_scale(n, local.z));
}

#endif
