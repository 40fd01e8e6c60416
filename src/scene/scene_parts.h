// Hashes of the parts of a scene on which the stages of a bake depend. A change that leaves a part's hash unchanged
// leaves everything unchanged that is computed from this part alone.
#ifndef OLX_SCENE_SCENE_PARTS_H
#define OLX_SCENE_SCENE_PARTS_H

#include "scene/space_bricks.h"

// Parts of a scene, as bits.
enum {
  OLX_PART_GEOMETRY = 1,  // where rays meet surfaces: triangles, normals of vertices, bounds, and masks
  OLX_PART_MATERIALS = 2, // how surfaces reflect and emit, and where their textures lie
  OLX_PART_LIGHTS = 4,    // lights and the environment; lamps with a surface are geometry and materials
  OLX_PART_VIEWS = 8      // cameras and boxes that limit where a viewer can be
};

typedef struct olx_scene_parts_hash {
  uint64_t geometry, materials, lights;
} olx_scene_parts_hash;

// Returns the hash of everything that affects light in the scene; names, cameras and probes do not.
uint64_t olx_scene_hash(const olx_scene *scene);

olx_scene_parts_hash olx_scene_hash_parts(const olx_scene *scene);

// Hashes of what a ray may depend on, finer than parts: each material has a slot, which it may share with others; the
// last slot is for everything that emits, with where emitting triangles are. Those who have surfels fill in two slots
// (light/links/former_surfels.h): how surfels lie, and the surfaces near lamps, 0 where no lamp has any.
enum {
  OLX_INPUT_SLOTS = 64,
  OLX_INPUT_LIGHTS = OLX_INPUT_SLOTS - 1,
  OLX_INPUT_SURFELS = OLX_INPUT_SLOTS - 2,
  OLX_INPUT_NEAR_LAMPS = OLX_INPUT_SLOTS - 3,
  OLX_INPUT_MATERIALS = OLX_INPUT_NEAR_LAMPS // number of slots of materials, which are the first
};

typedef struct olx_scene_inputs {
  uint64_t surfaces; // geometry, and which material lies where on it
  uint64_t slots[OLX_INPUT_SLOTS];
  double origin[3];
  olx_vec3 low, high; // bounds
  // The triangles in each brick of the bounds: where they are, how they are shaded, masked and textured, which material
  // they have, and their numbers. Textures and materials themselves are left out, except for masks.
  uint64_t bricks[OLX_SPACE_BRICKS];
} olx_scene_inputs;

// Fails when memory runs out.
olx_result olx_scene_hash_inputs(const olx_scene *scene, olx_scene_inputs *inputs);

// Returns the bit of a material's slot.
static inline uint64_t olx_input_of_material(uint32_t material) {
  return UINT64_C(1) << material % OLX_INPUT_MATERIALS;
}

// Returns the slots that differ, as bits.
static inline uint64_t olx_inputs_changed(const olx_scene_inputs *a, const olx_scene_inputs *b) {
  uint64_t changed = 0;
  for (uint32_t i = 0; i < OLX_INPUT_SLOTS; i++) changed |= (uint64_t)(a->slots[i] != b->slots[i]) << i;
  return changed;
}

#endif
