// Records the drawing of a scene's batches of triangles, except those outside the view.
#include "scene_draw.h"

#include "gpu_pipeline.h"

#include <string.h>

static const VkShaderStageFlags STAGES = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

_Static_assert(sizeof(draw_constants) == 128, "what every device has room for");

bool scene_draw_layout(gpu_device *d, VkDescriptorSetLayout set_layout, VkPipelineLayout *layout) {
  return gpu_layout_create(d, "a pipeline layout", &set_layout, 1, STAGES, sizeof(draw_constants), layout);
}

// Returns whether a batch's box lies wholly outside one of the planes of a view: left, right, top, bottom, behind.
static bool outside(const scene_batch *batch, const float to_world[12], const float m[16]) {
  uint32_t everywhere = 0x1Fu;
  for (uint32_t corner = 0; corner < 8; corner++) {
    float p[3], clip[4];
    for (uint32_t k = 0; k < 3; k++) p[k] = corner >> k & 1u ? batch->high[k] : batch->low[k];
    float w[3];
    for (uint32_t k = 0; k < 3; k++) {
      const float *row = to_world + 4 * k;
      w[k] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    }
    for (uint32_t k = 0; k < 4; k++) clip[k] = m[k] * w[0] + m[4 + k] * w[1] + m[8 + k] * w[2] + m[12 + k];
    const uint32_t beyond = (clip[0] < -clip[3] ? 1u : 0u) | (clip[0] > clip[3] ? 2u : 0u) |
                            (clip[1] < -clip[3] ? 4u : 0u) | (clip[1] > clip[3] ? 8u : 0u) |
                            (clip[3] <= 0.0f ? 16u : 0u);
    everywhere &= beyond;
  }
  return everywhere != 0;
}

void scene_draw_record(const gpu_device *d, VkCommandBuffer commands, VkPipelineLayout layout,
                       const float world_to_clip[16], olx_vec3 eye, const draw_item *items, uint32_t count,
                       uint32_t kinds) {
  draw_constants constants = {.eye = {eye.x, eye.y, eye.z}};
  memcpy(constants.world_to_clip, world_to_clip, sizeof constants.world_to_clip);
  for (uint32_t i = 0; i < count; i++) {
    const gpu_scene *scene = items[i].scene;
    memcpy(constants.to_world, items[i].to_world, sizeof constants.to_world);
    for (uint32_t b = 0; b < scene->batch_count; b++) {
      const scene_batch *batch = &scene->batches[b];
      if (!(kinds & (batch->masked ? DRAW_MASKED : DRAW_OPAQUE))) continue;
      if (outside(batch, items[i].to_world, world_to_clip)) continue;
      constants.material = batch->material;
      d->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &scene->sets[batch->material],
                               0, NULL);
      d->CmdPushConstants(commands, layout, STAGES, 0, sizeof constants, &constants);
      d->CmdDraw(commands, 3 * batch->triangle_count, 1, 3 * batch->first_triangle, 0);
    }
  }
}
