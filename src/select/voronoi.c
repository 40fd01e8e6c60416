// Finds the nearest probe by a k-d tree, and the Delaunay neighbours whose directions are nearest in angle to the place
// where a ray was lost. Its twin is shaders/lib/voronoi.glsl.
#include "select/voronoi.h"

#include "core/octahedral.h"

enum { MAX_DEPTH = 17 };

typedef struct nearest {
  const olx_field *field;
  olx_vec3 point;
  bool buried;
  uint32_t probe;
  float distance; // squared
} nearest;

static void consider(nearest *n, uint32_t probe) {
  const olx_vec3 offset = olx_sub(n->field->probe_positions[probe], n->point);
  const float distance = olx_dot(offset, offset);
  if (distance > n->distance || (distance == n->distance && probe >= n->probe)) return;
  if (!n->buried && (n->field->probe_flags[probe] & OLX_PROBE_BURIED)) return;
  n->distance = distance;
  n->probe = probe;
}

// A part of the tree that lies beyond a plane at a squared distance.
typedef struct tree_range {
  uint32_t begin, end, axis;
  float beyond;
} tree_range;

// Searches the tree: descends to the point, keeping the other halves for later, then visits those that may hold a
// nearer probe. Rounding is monotone, so no probe beyond a plane has a smaller distance than the plane.
static void search_tree(nearest *n) {
  const void *codes = olx_voronoi_codes(n->field);
  const size_t tree = olx_voronoi_tree(n->field);
  const uint32_t count = n->field->info.probes.count, code_bytes = olx_probe_code_bytes(count);
  tree_range later[MAX_DEPTH + 1] = {{0, count, 0, 0.0f}};
  for (uint32_t waiting = 1; waiting > 0;) {
    tree_range range = later[--waiting];
    if (range.beyond > n->distance) continue;
    while (range.begin < range.end) {
      const uint32_t middle = olx_middle(range.begin, range.end), next = (range.axis + 1) % 3;
      const uint32_t probe = olx_probe_code(codes, code_bytes, tree + middle);
      if (probe >= count) break;
      consider(n, probe);
      const float gap =
          olx_component(n->point, range.axis) - olx_component(n->field->probe_positions[probe], range.axis);
      const bool low_first = gap < 0.0f;
      later[waiting++] = low_first ? (tree_range){middle + 1, range.end, next, gap * gap}
                                   : (tree_range){range.begin, middle, next, gap * gap};
      range =
          low_first ? (tree_range){range.begin, middle, next, 0.0f} : (tree_range){middle + 1, range.end, next, 0.0f};
    }
  }
}

uint32_t olx_voronoi_nearest(const olx_field *field, olx_vec3 point, bool buried) {
  nearest n = {.field = field, .point = point, .buried = buried, .probe = OLX_NO_PROBE, .distance = INFINITY};
  if (field->info.probes.count > OLX_FEW_PROBES) {
    search_tree(&n);
  } else {
    for (uint32_t i = 0; i < field->info.probes.count; i++) consider(&n, i);
  }
  return n.probe;
}

// Returns the column or row of a coordinate in 0..1; 0 for NaN.
static uint32_t choice_texel(float coordinate, uint32_t size) {
  const float x = coordinate * (float)size;
  return x >= (float)size ? size - 1 : x > 0.0f ? (uint32_t)x : 0;
}

void olx_voronoi_neighbours(const olx_field *field, uint32_t probe, olx_vec3 direction, uint32_t choices[OLX_CHOICES]) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  const uint32_t size = header->size, probes = field->info.probes.count;
  const olx_vec2 uv = olx_octahedral_encode(direction);
  const size_t texel = ((size_t)probe * size + choice_texel(uv.y, size)) * size + choice_texel(uv.x, size);
  for (uint32_t i = 0; i < OLX_CHOICES; i++) {
    const uint32_t choice =
        olx_probe_code(olx_voronoi_codes(field), olx_probe_code_bytes(probes), texel * OLX_CHOICES + i);
    choices[i] = choice < probes ? choice : OLX_NO_PROBE;
  }
}
