// Twin of src/select/voronoi.c: finds the nearest probe, and the Delaunay neighbours towards the place where a ray was
// lost (Wang 2018, section 4.1), from the maps and the tree as they lie in the file (docs/format.md,
// src/field/selector_data.h).
//
// SPDX-License-Identifier: MIT
#ifndef OLX_VORONOI_GLSL
#define OLX_VORONOI_GLSL

#include "maps.glsl"


struct olx_nearest {
  vec3 point;
  bool buried;
  uint probe;
  float distance; // squared
};

// Returns the bytes of a probe's code: one in fields of up to 255 probes, else two. A code with all bits set means no
// probe.
uint olx_probe_code_bytes(uint probe_count) { return probe_count <= 255u ? 1u : 2u; }

uint olx_probe_code(uint code_bytes, uint index) {
  uint at = index * code_bytes, none = code_bytes == 1u ? 0xFFu : 0xFFFFu;
  uint code = olx_word(olx_field.voronoi_first + OLX_VORONOI_HEADER_WORDS + at / 4u) >> (at % 4u * 8u) & none;
  return code == none ? OLX_NO_PROBE : code;
}

// Returns the offset of the k-d tree among the codes.
uint olx_voronoi_tree() {
  uint size = olx_word(olx_field.voronoi_first);
  return olx_field.probe_count * size * size * OLX_CHOICES;
}

// Returns the middle of the probes from begin to end - 1.
uint olx_middle(uint begin, uint end) { return begin + (end - begin) / 2u; }

void olx_consider(inout olx_nearest n, uint probe) {
  precise vec3 offset = olx_probe_position(probe) - n.point;
  float distance = olx_dot(offset, offset);
  if (distance > n.distance || (distance == n.distance && probe >= n.probe)) return;
  if (!n.buried && (olx_probe_flags(probe) & OLX_PROBE_BURIED) != 0u) return;
  n.distance = distance;
  n.probe = probe;
}

// Searches the tree: descends to the point, then visits those of the other halves that may hold a nearer probe, the
// deepest first. The C code keeps their ranges. Here, because an array would lie in memory, one bit for each depth says
// that the other half waits, another says which half was taken, and the range is found again from the root.
void olx_search_tree(inout olx_nearest n) {
  uint tree = olx_voronoi_tree(), count = olx_field.probe_count, code_bytes = olx_probe_code_bytes(count);
  uint begin = 0u, end = count, depth = 0u, waiting = 0u, upper = 0u;
  for (;;) {
    while (begin < end) {
      uint middle = olx_middle(begin, end), probe = olx_probe_code(code_bytes, tree + middle);
      if (probe >= count) break;
      olx_consider(n, probe);
      precise float gap = n.point[depth % 3u] - olx_probe_position(probe)[depth % 3u];
      waiting |= 1u << depth;
      if (gap < 0.0) end = middle;
      else begin = middle + 1u, upper |= 1u << depth;
      depth++;
    }
    bool nearer = false;
    while (waiting != 0u && !nearer) {
      depth = uint(findMSB(waiting));
      waiting &= ~(1u << depth);
      begin = 0u, end = count;
      for (uint i = 0u; i < depth; i++) {
        uint middle = olx_middle(begin, end);
        if ((upper >> i & 1u) != 0u) begin = middle + 1u;
        else end = middle;
      }
      uint middle = olx_middle(begin, end), probe = olx_probe_code(code_bytes, tree + middle);
      precise float gap = n.point[depth % 3u] - olx_probe_position(probe)[depth % 3u];
      precise float beyond = gap * gap;
      nearer = beyond <= n.distance;
      upper = (upper ^ 1u << depth) & (2u << depth) - 1u;
      if ((upper >> depth & 1u) != 0u) begin = middle + 1u;
      else end = middle;
    }
    if (!nearer) break;
    depth++;
  }
}

// Returns the probe nearest to a point, the first of several. Buried probes (inside geometry) count only when `buried`
// is set. OLX_NO_PROBE when there is none.
uint olx_voronoi_nearest(vec3 point, bool buried) {
  olx_nearest n = olx_nearest(point, buried, OLX_NO_PROBE, OLX_INFINITY);
  if (olx_field.probe_count > OLX_FEW_PROBES) {
    olx_search_tree(n);
  } else {
    for (uint i = 0u; i < olx_field.probe_count; i++) olx_consider(n, i);
  }
  return n.probe;
}

// Returns the column or row of a coordinate in 0..1, which lies within the map even for NaN.
uint olx_choice_texel(float coordinate, uint size) {
  precise float x = coordinate * float(size);
  return x > 0.0 ? min(uint(x), size - 1u) : 0u;
}

// Returns the neighbours of a probe whose directions are nearest in angle to a direction (of any length), best first;
// OLX_NO_PROBE fills the free places. Every other value is a probe of the field, whatever the file holds.
uvec4 olx_voronoi_neighbours(uint probe, vec3 direction) {
  uint size = olx_word(olx_field.voronoi_first), probes = olx_field.probe_count;
  vec2 uv = olx_octahedral_encode(direction);
  uint texel = (probe * size + olx_choice_texel(uv.y, size)) * size + olx_choice_texel(uv.x, size);
  uvec4 choices;
  for (uint i = 0u; i < OLX_CHOICES; i++) {
    uint choice = olx_probe_code(olx_probe_code_bytes(probes), texel * OLX_CHOICES + i);
    choices[i] = choice < probes ? choice : OLX_NO_PROBE;
  }
  return choices;
}

#endif
