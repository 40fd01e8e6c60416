// A scene's triangles, materials and textures in the GPU's memory, to be drawn by the passes beside this.
#ifndef OCTALUX_VIEWER_SCENE_UPLOAD_H
#define OCTALUX_VIEWER_SCENE_UPLOAD_H

#include "gpu_memory.h"

#include <octalux/scene.h>

// Triangles of one material, which lie together.
typedef struct scene_batch {
  uint32_t material;
  uint32_t first_triangle, triangle_count;
  bool masked;           // parts of it are absent (alpha mask)
  float low[3], high[3]; // its box, in the scene's coordinates
} scene_batch;

typedef struct gpu_scene {
  gpu_buffer vertices;  // position, u, normal, v: eight floats each
  gpu_buffer rare;      // colour, tangent and second uv of a vertex; of one alone where the scene has none of them
  gpu_buffer indices;   // three a triangle, sorted by material
  gpu_buffer materials; // as shaders/raster_shared.glsl declares them
  gpu_image *textures;  // mipmapped; the last is a white texel, for materials without
  uint32_t texture_count;
  VkSampler sampler;
  VkDescriptorSetLayout set_layout;
  VkDescriptorPool pool;
  VkDescriptorSet *sets; // one a material
  uint32_t material_count;
  scene_batch *batches;
  uint32_t batch_count;
  uint64_t triangle_count;
  uint64_t bytes; // of device memory
} gpu_scene;

// Copies everything; `content` may be freed afterwards.
bool gpu_scene_create(gpu_device *device, const olx_scene_content *content, gpu_scene *scene);
void gpu_scene_destroy(gpu_device *device, gpu_scene *scene);

// Something to draw: a scene and where it stands. The first three rows of its matrix, by rows; turns, uniform scale and
// shift only.
typedef struct draw_item {
  const gpu_scene *scene;
  float to_world[12];
} draw_item;

draw_item draw_item_in_place(const gpu_scene *scene);

#endif
