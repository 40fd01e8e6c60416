// Checks the chunk that holds an octree: its size when a field is opened, and every node and every choice of a leaf
// when it is verified, so that no lookup leaves the tree.
#include "core/result.h"
#include "field/selector_data.h"

olx_result olx_octree_check(const olx_field *field) {
  const olx_octree_header *header = field->select_data[OLX_SELECT_OCTREE];
  const size_t size_bytes = field->select_bytes[OLX_SELECT_OCTREE];
  const uint32_t probes = field->info.probes.count;
  OLX_TRY(olx_coded_probes_check(probes, "OCTR", field->name));
  if (size_bytes < sizeof *header) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk OCTR: no header", field->name);
  if (header->levels < 1 || header->levels > OLX_OCTREE_MAX_LEVELS || header->inner_nodes > OLX_OCTREE_MAX_INNER ||
      header->zero[0] || header->zero[1]) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk OCTR: %u levels, %u inner nodes, or reserved bytes", field->name,
                    header->levels, header->inner_nodes);
  }
  const uint64_t nodes = 1 + 8 * (uint64_t)header->inner_nodes, leaves = 1 + 7 * (uint64_t)header->inner_nodes;
  if (size_bytes != sizeof *header + nodes * 4 + leaves * OLX_CHOICES * olx_probe_code_bytes(probes)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk OCTR: %zu bytes do not hold %u inner nodes", field->name, size_bytes,
                    header->inner_nodes);
  }
  return OLX_OK;
}

// Checks the nodes. They are stored level by level, so each has exactly one valid value: inner nodes take the blocks of
// children in order, and leaves count up. A tree that passes has no cycle, and every node is reached exactly once.
static olx_result verify_nodes(const olx_field *field, const olx_octree_header *header) {
  const uint32_t *nodes = (const uint32_t *)(header + 1);
  uint32_t inner = 0, leaves = 0, level = 0, level_end = 1;
  for (uint32_t i = 0; i < 1 + 8 * header->inner_nodes; i++) {
    if (i == level_end) {
      level_end = 1 + 8 * inner;
      level++;
    }
    const bool is_leaf = (nodes[i] & OLX_OCTREE_LEAF) != 0;
    const uint32_t expected = is_leaf ? OLX_OCTREE_LEAF | leaves++ : 1 + 8 * inner++;
    if (nodes[i] != expected || inner > header->inner_nodes || (!is_leaf && level == header->levels)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk OCTR: node %u on level %u holds %#x", field->name, i, level,
                      nodes[i]);
    }
  }
  return OLX_OK;
}

olx_result olx_octree_verify(const olx_field *field) {
  const olx_octree_header *header = field->select_data[OLX_SELECT_OCTREE];
  OLX_TRY(verify_nodes(field, header));
  const uint32_t probes = field->info.probes.count, leaves = 1 + 7 * header->inner_nodes;
  const void *codes = (const uint32_t *)(header + 1) + 1 + 8 * header->inner_nodes;
  for (size_t leaf = 0; leaf < leaves; leaf++) {
    uint32_t choices[OLX_CHOICES];
    for (uint32_t k = 0; k < OLX_CHOICES; k++) {
      choices[k] = olx_probe_code(codes, olx_probe_code_bytes(probes), leaf * OLX_CHOICES + k);
    }
    if (!olx_choices_are_sound(choices, probes)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk OCTR: leaf %zu names what is no choice (%u %u %u %u)", field->name,
                      leaf, choices[0], choices[1], choices[2], choices[3]);
    }
  }
  return OLX_OK;
}
