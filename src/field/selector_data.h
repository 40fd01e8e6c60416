// The structures by which selectors find probes, as they lie in the file (docs/format.md).
#ifndef OLX_FIELD_SELECTOR_DATA_H
#define OLX_FIELD_SELECTOR_DATA_H

#include "core/vec.h"
#include "field/coded_probes.h"
#include "field/field_data.h"

// Returns the bytes of a probe's code: one in fields of up to 255 probes, else two. A code with all bits set means no
// probe.
static inline uint32_t olx_probe_code_bytes(uint32_t probe_count) { return probe_count <= 255 ? 1 : 2; }

static inline uint32_t olx_probe_code(const void *codes, uint32_t code_bytes, size_t index) {
  const uint32_t code = code_bytes == 1 ? ((const uint8_t *)codes)[index] : ((const uint16_t *)codes)[index];
  return code == (code_bytes == 1 ? 0xFFu : 0xFFFFu) ? OLX_NO_PROBE : code;
}

static inline void olx_probe_code_store(void *codes, uint32_t code_bytes, size_t index, uint32_t probe) {
  if (code_bytes == 1) ((uint8_t *)codes)[index] = (uint8_t)probe;
  else ((uint16_t *)codes)[index] = (uint16_t)probe;
}

// The header of VORO. After it comes, for each probe, an octahedral map of size x size texels, row by row, OLX_CHOICES
// codes each. Then come the codes of all probes in the order of a k-d tree: the middle probe of a range splits it,
// along the axes in turn.
typedef struct olx_voronoi_header {
  uint32_t size; // a power of two, 4 to 64
  uint32_t zero[3];
} olx_voronoi_header;

_Static_assert(sizeof(olx_voronoi_header) == OLX_VORONOI_HEADER_WORDS * sizeof(uint32_t), "docs/format.md");

// The header of OCTR. After it come the nodes, level by level from the root, a u32 each. An inner node holds the index
// of the first of its eight children, which follow each other (bit 0 of a child is the upper half in x, 1 in y, 2 in
// z); the nth inner node holds 1 + 8 n. A leaf holds OLX_OCTREE_LEAF and the number of leaves before it. Last come
// OLX_CHOICES codes a leaf.
typedef struct olx_octree_header {
  uint32_t levels;      // the most subdivisions, 1 to 10: the smallest leaves are 1 / 2^levels of the root
  uint32_t inner_nodes; // so there are 1 + 8 inner_nodes nodes, 1 + 7 inner_nodes of them leaves
  uint32_t zero[2];
} olx_octree_header;

#define OLX_OCTREE_LEAF 0x80000000u
#define OLX_OCTREE_MAX_LEVELS 10u
#define OLX_OCTREE_MAX_INNER ((1u << 28) - 1)

_Static_assert(sizeof(olx_octree_header) == 16, "docs/format.md");

// Returns the side of the root: a cube whose low corner is that of the scene.
static inline float olx_octree_side(olx_vec3 scene_min, olx_vec3 scene_max) {
  return olx_max3(olx_sub(scene_max, scene_min));
}

static inline const void *olx_voronoi_codes(const olx_field *field) {
  return (const olx_voronoi_header *)field->select_data[OLX_SELECT_VORONOI] + 1;
}

// Returns the offset of the k-d tree among the codes.
static inline size_t olx_voronoi_tree(const olx_field *field) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  return (size_t)field->info.probes.count * header->size * header->size * OLX_CHOICES;
}

// Returns the middle of the probes from begin to end - 1.
static inline uint32_t olx_middle(uint32_t begin, uint32_t end) { return begin + (end - begin) / 2; }

// Checks the sizes of the structure when a field is opened, in constant time. The runtime's reads stay inside the
// structure whatever it holds.
olx_result olx_voronoi_check(const olx_field *field);
olx_result olx_octree_check(const olx_field *field);

// Checks every code of the structure when a field is verified.
olx_result olx_voronoi_verify(const olx_field *field);
olx_result olx_octree_verify(const olx_field *field);

// Returns whether stored choices name probes of the field, none twice, with empty places only at the end.
bool olx_choices_are_sound(const uint32_t choices[OLX_CHOICES], uint32_t probe_count);

#endif
