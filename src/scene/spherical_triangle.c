// Computes the solid angle of a spherical triangle, and samples directions uniformly from it (Arvo 1995).
#include "scene/spherical_triangle.h"

float olx_spherical_triangle_area(const olx_vec3 corners[3]) {
  const olx_vec3 a = corners[0], b = corners[1], c = corners[2];
  const float volume = fabsf(olx_dot(a, olx_cross(b, c)));
  return 2.0f * atan2f(volume, 1.0f + olx_dot(a, b) + olx_dot(b, c) + olx_dot(c, a));
}

// Returns the component of v perpendicular to the unit vector `axis`, normalized.
static olx_vec3 across(olx_vec3 v, olx_vec3 axis) { return olx_normalize(olx_madd(v, axis, -olx_dot(v, axis))); }

olx_vec3 olx_spherical_triangle_sample(const olx_vec3 corners[3], olx_vec2 random) {
  const olx_vec3 a = corners[0], b = corners[1], c = corners[2];
  const olx_vec3 to_b = across(b, a), to_c = across(c, a);
  const float cosine_alpha = olx_clamp(olx_dot(to_b, to_c), -1.0f, 1.0f);
  const float sine_alpha = sqrtf(olx_max(1.0f - cosine_alpha * cosine_alpha, 1e-12f));
  // Moves corner c along its edge to a until the triangle has the drawn share of its area.
  const float angle = random.x * olx_spherical_triangle_area(corners) - acosf(cosine_alpha);
  const float s = sinf(angle), t = cosf(angle);
  const float u = t - cosine_alpha, v = s + sine_alpha * olx_dot(a, b);
  const float divisor = (v * s + u * t) * sine_alpha;
  const float q = divisor == 0.0f ? 1.0f : olx_clamp(((v * t - u * s) * cosine_alpha - v) / divisor, -1.0f, 1.0f);
  const olx_vec3 moved = olx_madd(olx_scale(a, q), to_c, sqrtf(olx_max(0.0f, 1.0f - q * q)));
  // A point on the arc from b to the moved corner.
  const float z = 1.0f - random.y * (1.0f - olx_dot(moved, b));
  return olx_normalize(olx_madd(olx_scale(b, z), across(moved, b), sqrtf(olx_max(0.0f, 1.0f - z * z))));
}
