// Twin of src/select/bricks.h: finds the probes that see a place, from the bricks as they lie in the file
// (docs/format.md).
//
// SPDX-License-Identifier: MIT
#ifndef OLX_BRICKS_GLSL
#define OLX_BRICKS_GLSL

#include "maps.glsl"


// Returns where the list of the cell around a point begins; a point outside all cells gets the list of the nearest one.
uint olx_bricks_list(vec3 point) {
  uint first = olx_field.bricks_first;
  vec3 origin = uintBitsToFloat(uvec3(olx_word(first), olx_word(first + 1u), olx_word(first + 2u)));
  uvec3 size = uvec3(olx_word(first + 4u), olx_word(first + 5u), olx_word(first + 6u));
  precise float per_metre = 1.0 / uintBitsToFloat(olx_word(first + 3u));
  precise vec3 place = (point - origin) * per_metre;
  uvec3 at = uvec3(clamp(place, vec3(0.0), vec3(size * OLX_BRICK_SIDE - 1u)));
  uvec3 brick = at / OLX_BRICK_SIDE, cell = at % OLX_BRICK_SIDE;
  uint cells = OLX_BRICK_HEADER_WORDS + size.x * size.y * size.z;
  uint list = olx_word(first + OLX_BRICK_HEADER_WORDS + (brick.z * size.y + brick.y) * size.x + brick.x);
  if ((list & OLX_BRICK_DIVIDED) != 0u) {
    uint c = (cell.z * OLX_BRICK_SIDE + cell.y) * OLX_BRICK_SIDE + cell.x;
    uint word = cells + (list & ~OLX_BRICK_DIVIDED) * OLX_BRICK_CELL_WORDS + c / 2u;
    list = olx_word(first + word) >> (c % 2u * 16u) & 0xFFFFu;
  }
  return cells + olx_word(first + 7u) * OLX_BRICK_CELL_WORDS + list * OLX_BRICK_LIST_WORDS;
}

// Returns the i-th probe of a list, OLX_BRICK_NO_PROBE beyond its end.
uint olx_bricks_probe(uint list, uint i) {
  return olx_word(olx_field.bricks_first + list + i / 2u) >> (i % 2u * 16u) & 0xFFFFu;
}

#endif
