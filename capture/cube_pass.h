// Draws one face of a cube around a probe: the index of the triangle that is nearest in each direction.
#ifndef OCTALUX_CAPTURE_CUBE_PASS_H
#define OCTALUX_CAPTURE_CUBE_PASS_H

#include "cube_scene.h"

enum { CUBE_FACES = 6 };

// Pipelines, and images of one face, with the ring of texels beyond its edges.
typedef struct cube_pass {
  uint32_t side; // texels along the images
  float near;    // metres: what is closer to the probe is not drawn
  gpu_image triangles, depth;
  VkRenderPass render_pass;
  VkFramebuffer framebuffer;
  VkPipelineLayout layout;
  VkPipeline opaque, masked;
} cube_pass;

// Creates the pass for faces of `side` texels. After a failure, too, cube_pass_destroy is to be called.
bool cube_pass_create(gpu_device *device, const cube_scene *scene, uint32_t side, float near, cube_pass *pass);
void cube_pass_destroy(gpu_device *device, cube_pass *pass);

// Records the drawing of a face (numbered as olx_bake_raster.look does) around `eye`, and a copy of its texels to
// `buffer` at `offset` in bytes.
void cube_pass_record(const gpu_device *device, const cube_pass *pass, const cube_scene *scene, olx_vec3 eye,
                      uint32_t face, const gpu_buffer *buffer, VkDeviceSize offset);

#endif
