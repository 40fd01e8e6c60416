// The triangles of a scene on a device, in the order in which cube maps draw them, and the alpha masks of its
// materials.
#ifndef OCTALUX_CAPTURE_CUBE_SCENE_H
#define OCTALUX_CAPTURE_CUBE_SCENE_H

#include "gpu_pipeline.h"

#include <octalux/scene.h>

// Triangles that are drawn together or not at all: they are opaque, or of one masked material.
typedef struct cube_chunk {
  uint32_t first, count; // triangles, in the order of drawing
  uint32_t mask;         // index of the mask; CUBE_OPAQUE for opaque triangles
  float low[3], high[3];
} cube_chunk;

#define CUBE_OPAQUE UINT32_MAX

// A material with an alpha mask.
typedef struct cube_mask {
  gpu_set set;
  uint32_t flags; // as of shaders/cube_shared.glsl
  float alpha, alpha_cutoff;
} cube_mask;

typedef struct cube_scene {
  gpu_buffer positions, indices, order, uvs, alphas;
  gpu_image *textures; // those of masks; the last one is white
  uint32_t texture_count;
  VkSampler sampler;
  gpu_set opaque; // also the layout of the masks' sets
  cube_mask *masks;
  uint32_t mask_count;
  cube_chunk *chunks; // opaque ones first, then mask by mask
  uint32_t chunk_count;
} cube_scene;

// Uploads the triangles of a scene. After a failure, too, cube_scene_destroy is to be called.
bool cube_scene_create(gpu_device *device, const olx_scene_content *content, cube_scene *scene);
void cube_scene_destroy(gpu_device *device, cube_scene *scene);

#endif
