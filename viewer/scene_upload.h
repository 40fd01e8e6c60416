// A scene's triangles, materials and textures in GPU memory, drawn by the passes in this folder.
#ifndef OCTALUX_VIEWER_SCENE_UPLOAD_H
#define OCTALUX_VIEWER_SCENE_UPLOAD_H

#include "gpu_memory.h"

#include <octalux/scene.h>

// The consecutive triangles of one material.
typedef struct scene_batch {
  uint32_t material;
  uint32_t first_triangle, triangle_count;
  bool masked;           // parts of it are cut out (alpha mask)
  float low[3], high[3]; // bounds, in the scene's coordinates
} scene_batch;

typedef struct gpu_scene {
  gpu_buffer vertices;  // position, u, normal, v: eight floats each
  gpu_buffer rare;      // colour, tangent and second uv of each vertex; a single element where the scene has none of
                        // them
  gpu_buffer indices;   // three per triangle, sorted by material
  gpu_buffer materials; // with the layout of shaders/raster_shared.glsl
  gpu_image *textures;  // mipmapped; the last is a white texel, for materials without textures
  uint32_t texture_count;
  VkSampler sampler;
  VkDescriptorSetLayout set_layout;
  VkDescriptorPool pool;
  VkDescriptorSet *sets; // one per material
  uint32_t material_count;
  scene_batch *batches;
  uint32_t batch_count;
  uint64_t triangle_count;
  uint64_t bytes; // size in device memory
} gpu_scene;

// Copies everything; `content` may be freed afterwards.
bool gpu_scene_create(gpu_device *device, const olx_scene_content *content, gpu_scene *scene);
void gpu_scene_destroy(gpu_device *device, gpu_scene *scene);

// An item to draw: a scene and its transform, the first three rows of a matrix, row by row; only rotation, uniform
// scale and translation.
typedef struct draw_item {
  const gpu_scene *scene;
  float to_world[12];
} draw_item;

draw_item draw_item_in_place(const gpu_scene *scene);

#endif
