// Computes the exact solid angle of a texel of an octahedral map, as a sum of spherical triangles.
#include "core/octahedral.h"

typedef struct point {
  double x, y, z;
} point;

static point corner(uint32_t x, uint32_t y, uint32_t n) {
  const double u = 2.0 * x / n - 1.0, v = 2.0 * y / n - 1.0;
  point q = {u, 1.0 - fabs(u) - fabs(v), v};
  if (q.y < 0.0) {
    q.x = (1.0 - fabs(v)) * (u >= 0.0 ? 1.0 : -1.0);
    q.z = (1.0 - fabs(u)) * (v >= 0.0 ? 1.0 : -1.0);
  }
  return q;
}

// Returns the solid angle of a spherical triangle (Van Oosterom and Strackee 1983).
static double triangle_solid_angle(point a, point b, point c) {
  const double la = sqrt(a.x * a.x + a.y * a.y + a.z * a.z), lb = sqrt(b.x * b.x + b.y * b.y + b.z * b.z),
               lc = sqrt(c.x * c.x + c.y * c.y + c.z * c.z);
  const double volume = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  const double ab = a.x * b.x + a.y * b.y + a.z * b.z, bc = b.x * c.x + b.y * c.y + b.z * c.z,
               ca = c.x * a.x + c.y * a.y + c.z * a.z;
  return fabs(2.0 * atan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb));
}

double olx_texel_solid_angle(uint32_t x, uint32_t y, uint32_t n) {
  // On the outer boundary, several corners have the same direction but differ in the sign of zero; mirroring into the
  // quadrant u, v >= 0 keeps all corners on one side.
  const uint32_t h = n / 2, i = x >= h ? x - h : h - 1 - x, j = y >= h ? y - h : h - 1 - y;
  const point a = corner(h + i, h + j, n), b = corner(h + i + 1, h + j, n), c = corner(h + i, h + j + 1, n),
              d = corner(h + i + 1, h + j + 1, n);
  // The fold u + v = 1 runs along the diagonal b-c.
  return triangle_solid_angle(a, b, c) + triangle_solid_angle(b, d, c);
}
