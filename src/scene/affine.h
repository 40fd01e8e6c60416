// Affine transforms in double precision, which place the content of files in a scene.
#ifndef OLX_SCENE_AFFINE_H
#define OLX_SCENE_AFFINE_H

#include "scene/import/import.h"

typedef struct olx_affine {
  double m[3][4]; // rows; the last column is the translation
} olx_affine;

// Returns the product a b, which applies b first.
static inline olx_affine olx_affine_multiply(const olx_affine *a, const olx_affine *b) {
  olx_affine product;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      double sum = column == 3 ? a->m[row][3] : 0.0;
      for (int k = 0; k < 3; ++k) sum += a->m[row][k] * b->m[k][column];
      product.m[row][column] = sum;
    }
  }
  return product;
}

static inline olx_vec3 olx_affine_vector(const olx_affine *a, olx_vec3 v) {
  double r[3];
  for (int row = 0; row < 3; ++row) {
    r[row] = a->m[row][0] * (double)v.x + a->m[row][1] * (double)v.y + a->m[row][2] * (double)v.z;
  }
  return olx_v3((float)r[0], (float)r[1], (float)r[2]);
}

static inline olx_vec3 olx_affine_point(const olx_affine *a, olx_vec3 p) {
  double r[3];
  for (int row = 0; row < 3; ++row) {
    r[row] = a->m[row][0] * (double)p.x + a->m[row][1] * (double)p.y + a->m[row][2] * (double)p.z + a->m[row][3];
  }
  return olx_v3((float)r[0], (float)r[1], (float)r[2]);
}

// Returns the cofactor matrix, which transforms normals up to their length and keeps their side under mirroring.
static inline olx_affine olx_affine_normals(const olx_affine *a) {
  olx_affine n = {{{0}}};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
      n.m[row][column] = a->m[r1][c1] * a->m[r2][c2] - a->m[r1][c2] * a->m[r2][c1];
    }
  }
  return n;
}

static inline double olx_affine_determinant(const olx_affine *a) {
  const olx_affine n = olx_affine_normals(a);
  return a->m[0][0] * n.m[0][0] + a->m[0][1] * n.m[0][1] + a->m[0][2] * n.m[0][2];
}

// Returns a rotation by a quaternion, which need not be unit, with scale on its right and a translation.
static inline olx_affine olx_affine_from_trs(const double t[3], const double q[4], const double s[3]) {
  const double length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], k = length2 > 0.0 ? 2.0 / length2 : 0.0;
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  const double r[3][3] = {{1 - k * (y * y + z * z), k * (x * y - z * w), k * (x * z + y * w)},
                          {k * (x * y + z * w), 1 - k * (x * x + z * z), k * (y * z - x * w)},
                          {k * (x * z - y * w), k * (y * z + x * w), 1 - k * (x * x + y * y)}};
  olx_affine a;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) a.m[row][column] = r[row][column] * s[column];
    a.m[row][3] = t[row];
  }
  return a;
}

// Returns the transform of a placement into the local frame of a scene with that origin.
static inline olx_affine olx_affine_from_placement(const olx_placement *placement, const double origin[3]) {
  const double half = 0.5 * 3.14159265358979323846 / 180.0, none[3] = {0, 0, 0}, one[3] = {1, 1, 1};
  const double ax = half * (double)placement->rotate_degrees.x, ay = half * (double)placement->rotate_degrees.y;
  const double az = half * (double)placement->rotate_degrees.z;
  const double t[3] = {placement->translate[0] - origin[0], placement->translate[1] - origin[1],
                       placement->translate[2] - origin[2]};
  const double s[3] = {(double)placement->scale, (double)placement->scale, (double)placement->scale};
  const olx_affine rx = olx_affine_from_trs(none, (const double[4]){sin(ax), 0, 0, cos(ax)}, s);
  const olx_affine ry = olx_affine_from_trs(none, (const double[4]){0, sin(ay), 0, cos(ay)}, one);
  const olx_affine rz = olx_affine_from_trs(t, (const double[4]){0, 0, sin(az), cos(az)}, one);
  const olx_affine ryx = olx_affine_multiply(&ry, &rx);
  return olx_affine_multiply(&rz, &ryx);
}

#endif
