// The host's one pass: the scene's triangles into depth, normal, albedo, material, and color with emitted and direct
// light.
#ifndef SURFACE_PASS_H
#define SURFACE_PASS_H

#include "gpu.h"

enum { SURFACE_NORMAL, SURFACE_ALBEDO, SURFACE_MATERIAL, SURFACE_COLOR, SURFACE_DEPTH, SURFACE_IMAGES };

typedef struct surface_camera { // the push constants
  float world_to_clip[16];
  float eye[4];
} surface_camera;

typedef struct surface_pass {
  VkExtent2D size;
  gpu_buffer vertices, indices;
  gpu_image images[SURFACE_IMAGES];
  VkRenderPass render_pass;
  VkFramebuffer framebuffer;
  VkDescriptorSetLayout set_layout;
  VkDescriptorPool pool;
  VkDescriptorSet set; // vertices and indices, for shadow rays
  VkPipelineLayout layout;
  VkPipeline pipeline;
} surface_pass;

// Returns the layout in which the pass leaves an image, ready for compute shaders: GENERAL for color, read-only for the
// others.
VkImageLayout surface_layout(uint32_t image);

// Makes the pass, with field_set as set 1. With own_diffuse, its shader also adds indirect diffuse light to color.
surface_pass surface_pass_make(const gpu *g, VkExtent2D size, VkDescriptorSetLayout field_set, bool own_diffuse);
void surface_pass_free(const gpu *g, surface_pass *pass);

// Records the pass. The depth range is reversed: 0 where there is no surface. Later compute shaders may read and write
// its images.
void surface_pass_record(const gpu *g, const surface_pass *pass, const surface_camera *camera,
                         VkDescriptorSet field_set);

#endif
