// Spherical harmonics of the bands 0, 1 and 2 as plain polynomials of a unit direction (docs/maths.md, "Spherical
// harmonics"): 1; y, z, x; xy, yz, 3 z^2 - 1, xz, x^2 - y^2. Constant factors are left to the coefficients.
// Its twin is shaders/lib/harmonics.glsl.
#ifndef OLX_CORE_HARMONICS_H
#define OLX_CORE_HARMONICS_H

#include "core/vec.h"

static inline uint32_t olx_harmonics_count(uint32_t bands) { return bands * bands; }

// Evaluates all harmonics in a direction.
static inline void olx_harmonics_at(olx_vec3 d, float values[OLX_HARMONICS_MOST]) {
  values[0] = 1.0f;
  values[1] = d.y;
  values[2] = d.z;
  values[3] = d.x;
  values[4] = d.x * d.y;
  values[5] = d.y * d.z;
  values[6] = 3.0f * d.z * d.z - 1.0f;
  values[7] = d.x * d.z;
  values[8] = d.x * d.x - d.y * d.y;
}

// Returns the factor by which the harmonics of a band, 0 to 2, of radiance become those of irradiance (Ramamoorthi and
// Hanrahan 2001).
static inline float olx_harmonics_cosine(uint32_t band) {
  return band == 0 ? OLX_PI : band == 1 ? 2.0f / 3.0f * OLX_PI : 0.25f * OLX_PI;
}

// Returns the mean of a harmonic's square over the sphere.
static inline float olx_harmonics_mean_square(uint32_t index) {
  return index == 0   ? 1.0f
         : index < 4  ? 1.0f / 3.0f
         : index == 6 ? 4.0f / 5.0f
         : index == 8 ? 4.0f / 15.0f
                      : 1.0f / 15.0f;
}

#endif
