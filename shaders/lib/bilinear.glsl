// Twin of src/field/bilinear.h: finds the texels of a map that a bilinear filter reads.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_BILINEAR_GLSL
#define OLX_BILINEAR_GLSL

// The four texels around a point of a map, and their bilinear weights.
struct olx_bilinear {
  uvec4 texel;
  vec4 weight;
};

// In a map of n x n texels with its border.
olx_bilinear olx_bilinear_at(vec2 uv, uint n) {
  precise vec2 at = uv * float(n) - 0.5;
  vec2 first = clamp(floor(at), vec2(-1.0), vec2(float(n) - 1.0)), part = clamp(at - first, vec2(0.0), vec2(1.0));
  uint index = uint(int(first.y) + 1) * (n + 2u) + uint(int(first.x) + 1);
  return olx_bilinear(uvec4(index, index + 1u, index + n + 2u, index + n + 3u),
                      vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y,
                           part.x * part.y));
}

#endif
