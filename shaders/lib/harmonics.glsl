// Twin of src/core/harmonics.h: spherical harmonics of the bands 0, 1 and 2 as polynomials of a unit direction.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_HARMONICS_GLSL
#define OLX_HARMONICS_GLSL


void olx_harmonics_at(vec3 d, out float values[9]) {
  values = float[](1.0, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3.0 * d.z * d.z - 1.0, d.x * d.z, d.x * d.x - d.y * d.y);
}

#endif
