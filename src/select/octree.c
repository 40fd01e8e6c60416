// Descends the octree to the leaf that holds a point, and reads the probes that were baked into it.
#include "select/octree.h"

// Returns the voxel of the finest level along one axis; the first one for NaN.
static uint32_t voxel_at(float position, float low, float scale, uint32_t count) {
  const float x = (position - low) * scale;
  return x >= (float)count ? count - 1 : x > 0.0f ? (uint32_t)x : 0;
}

uint32_t olx_octree_leaf(const olx_field *field, olx_vec3 point) {
  const olx_octree_header *header = field->select_data[OLX_SELECT_OCTREE];
  const uint32_t *nodes = (const uint32_t *)(header + 1);
  const uint32_t node_count = 1 + 8 * header->inner_nodes, side = 1u << header->levels;
  const olx_vec3 low = field->info.scene.bounds_min;
  const float scale = (float)side / olx_octree_side(low, field->info.scene.bounds_max);
  const uint32_t x = voxel_at(point.x, low.x, scale, side), y = voxel_at(point.y, low.y, scale, side),
                 z = voxel_at(point.z, low.z, scale, side);
  uint32_t node = nodes[0];
  for (uint32_t level = header->levels; !(node & OLX_OCTREE_LEAF);) {
    if (level == 0) return OLX_NO_LEAF;
    level--;
    const uint32_t child = node + (x >> level & 1u) + 2 * (y >> level & 1u) + 4 * (z >> level & 1u);
    if (child >= node_count) return OLX_NO_LEAF;
    node = nodes[child];
  }
  const uint32_t leaf = node & ~OLX_OCTREE_LEAF;
  return leaf < 1 + 7 * header->inner_nodes ? leaf : OLX_NO_LEAF;
}

void olx_octree_choices(const olx_field *field, uint32_t leaf, uint32_t choices[OLX_CHOICES]) {
  const olx_octree_header *header = field->select_data[OLX_SELECT_OCTREE];
  const void *codes = (const uint32_t *)(header + 1) + 1 + 8 * header->inner_nodes;
  const uint32_t probes = field->info.probes.count;
  for (uint32_t i = 0; i < OLX_CHOICES; i++) {
    const uint32_t choice = leaf == OLX_NO_LEAF
                                ? OLX_NO_PROBE
                                : olx_probe_code(codes, olx_probe_code_bytes(probes), (size_t)leaf * OLX_CHOICES + i);
    choices[i] = choice < probes ? choice : OLX_NO_PROBE;
  }
}
