// The structures by which selectors find probes, as they lie in the file (docs/format.md).
#ifndef OLX_FIELD_SELECTOR_DATA_H
#define OLX_FIELD_SELECTOR_DATA_H

#include "core/vec.h"
#include "field/field_data.h"

#define OLX_NO_PROBE UINT32_MAX

enum {
  OLX_MAX_CODED_PROBES = 65535,
  OLX_CHOICES = 4 // probes that a texel or a leaf names, best first
};

// Probes are named by a byte each where 255 probes are the most, else by two; all bits set name none.
static inline uint32_t olx_probe_code_bytes(uint32_t probe_count) { return probe_count <= 255 ? 1 : 2; }

static inline uint32_t olx_probe_code(const void *codes, uint32_t code_bytes, size_t index) {
  const uint32_t code = code_bytes == 1 ? ((const uint8_t *)codes)[index] : ((const uint16_t *)codes)[index];
  return code == (code_bytes == 1 ? 0xFFu : 0xFFFFu) ? OLX_NO_PROBE : code;
}

static inline void olx_probe_code_store(void *codes, uint32_t code_bytes, size_t index, uint32_t probe) {
  if (code_bytes == 1) ((uint8_t *)codes)[index] = (uint8_t)probe;
  else ((uint16_t *)codes)[index] = (uint16_t)probe;
}

// VORO: this, then for each probe an octahedral map of size x size texels, row by row: OLX_CHOICES codes each. Then the
// codes of all probes in the order of a k-d tree: the middle one of a range splits it, along the axes in turn.
typedef struct olx_voronoi_header {
  uint32_t size; // a power of two, 4 to 64
  uint32_t zero[3];
} olx_voronoi_header;

_Static_assert(sizeof(olx_voronoi_header) == 16, "docs/format.md");

// OCTR: this, then the nodes, level by level from the root: a u32 each. An inner node holds the index of the first of
// its eight children, which follow each other (bit 0 of a child is the upper half in x, 1 in y, 2 in z): the nth inner
// node holds 1 + 8 n. A leaf holds OLX_OCTREE_LEAF and how many leaves come before it. Then OLX_CHOICES codes a leaf.
typedef struct olx_octree_header {
  uint32_t levels;      // of subdivision at most, 1 to 10: the smallest leaves are 1 / 2^levels of the root
  uint32_t inner_nodes; // so there are 1 + 8 inner_nodes nodes, 1 + 7 inner_nodes of them leaves
  uint32_t zero[2];
} olx_octree_header;

#define OLX_OCTREE_LEAF 0x80000000u
#define OLX_OCTREE_MAX_LEVELS 10u
#define OLX_OCTREE_MAX_INNER ((1u << 28) - 1)

_Static_assert(sizeof(olx_octree_header) == 16, "docs/format.md");

// The side of the root: a cube whose low corner is that of the scene.
static inline float olx_octree_side(olx_vec3 scene_min, olx_vec3 scene_max) {
  return olx_max3(olx_sub(scene_max, scene_min));
}

static inline const void *olx_voronoi_codes(const olx_field *field) {
  return (const olx_voronoi_header *)field->select_data[OLX_SELECT_VORONOI] + 1;
}

// Where the k-d tree begins among the codes.
static inline size_t olx_voronoi_tree(const olx_field *field) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  return (size_t)field->info.probe_count * header->size * header->size * OLX_CHOICES;
}

// The middle of the probes from begin to end - 1.
static inline uint32_t olx_middle(uint32_t begin, uint32_t end) { return begin + (end - begin) / 2; }

static inline float olx_coordinate(olx_vec3 v, uint32_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// What opening a field checks: sizes, in no time. The runtime stays inside the structure whatever it holds.
olx_result olx_voronoi_check(const olx_field *field);
olx_result olx_octree_check(const olx_field *field);

// What verifying a field checks: everything in it.
olx_result olx_voronoi_verify(const olx_field *field);
olx_result olx_octree_verify(const olx_field *field);

// Whether choices as they lie in the file are probes of the field, none twice, and none follows after one that is none.
bool olx_choices_are_sound(const uint32_t choices[OLX_CHOICES], uint32_t probe_count);

#endif
