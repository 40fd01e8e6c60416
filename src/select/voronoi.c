#include "select/voronoi.h"

#include "core/octahedral.h"

uint32_t olx_voronoi_nearest(const olx_field *field, olx_vec3 point, bool buried) {
  uint32_t nearest = OLX_NO_PROBE;
  float least = INFINITY;
  for (uint32_t i = 0; i < field->info.probe_count; i++) {
    const olx_vec3 offset = olx_sub(field->probe_positions[i], point);
    const float distance = olx_dot(offset, offset);
    if (distance >= least || (!buried && (field->probe_flags[i] & OLX_PROBE_BURIED))) continue;
    least = distance;
    nearest = i;
  }
  return nearest;
}

// Column or row of a coordinate in 0..1; 0 for NaN.
static uint32_t texel_at(float coordinate, uint32_t size) {
  const float x = coordinate * (float)size;
  return x >= (float)size ? size - 1 : x > 0.0f ? (uint32_t)x : 0;
}

void olx_voronoi_neighbours(const olx_field *field, uint32_t probe, olx_vec3 direction, uint32_t choices[OLX_CHOICES]) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  const uint32_t size = header->size, probes = field->info.probe_count;
  const olx_vec2 uv = olx_octahedral_encode(direction);
  const size_t texel = ((size_t)probe * size + texel_at(uv.y, size)) * size + texel_at(uv.x, size);
  for (uint32_t i = 0; i < OLX_CHOICES; i++) {
    const uint32_t choice = olx_probe_code(header + 1, olx_probe_code_bytes(probes), texel * OLX_CHOICES + i);
    choices[i] = choice < probes ? choice : OLX_NO_PROBE;
  }
}
