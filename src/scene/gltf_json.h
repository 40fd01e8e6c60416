// What Assimp 5.2 drops from glTF files or reads wrongly, read from the file's own JSON; and checks that keep malformed
// files away from it.
#ifndef OLX_SCENE_GLTF_JSON_H
#define OLX_SCENE_GLTF_JSON_H

#include "scene/affine.h"

#include <cjson/cJSON.h>

typedef struct olx_gltf olx_gltf;

// Read the JSON of a .gltf or .glb file, and refuse files that contradict themselves or need an extension that is not
// supported. Extensions that are ignored become warnings of the scene.
olx_result olx_gltf_open(const char *path, olx_scene *scene, olx_gltf **gltf);
// NULL is allowed.
void olx_gltf_close(olx_gltf *gltf);

// KHR_materials_emissive_strength and KHR_materials_specular of a material, by Assimp's index and name.
void olx_gltf_material_extensions(const olx_gltf *gltf, uint32_t assimp_index, const char *name,
                                  float *emissive_strength, float *specular_weight);

// Nodes, which Assimp keeps in the file's order but in floats: the numbers of the roots and of a node's children, the node of a
// number (NULL when there is none), and where a node is moved to.
const cJSON *olx_gltf_roots(const olx_gltf *gltf);
const cJSON *olx_gltf_children(const cJSON *node);
const cJSON *olx_gltf_node(const olx_gltf *gltf, const cJSON *number);
void olx_gltf_translation(const cJSON *node, double translation[3]);

// Append the cameras and the KHR_lights_punctual of the file's scene.
olx_result olx_gltf_add_cameras_and_lights(const olx_gltf *gltf, const olx_affine *placement, olx_scene *scene);

#endif
