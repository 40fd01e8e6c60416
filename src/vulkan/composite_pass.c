// Records the pass that adds indirect light to the host's image: irradiance times the diffuse reflectance of the
// surface, and glossy light unchanged.
#include "vulkan/vulkan_frame.h"

static const uint32_t WORDS[] = {
#include "composite.spv.inc"
};
const olx_pass_code olx_composite_pass = {"composite", WORDS, sizeof WORDS};

olx_result olx_vulkan_record_composite(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                       const olx_vulkan_view *view, const olx_vulkan_settings *settings, uint32_t add) {
  if (add & ~(uint32_t)(OLX_VULKAN_ADD_DIFFUSE | OLX_VULKAN_ADD_GLOSSY)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the composite pass cannot add %#x", add);
  }
  OLX_TRY(olx_vulkan_check_pass(frame, OLX_PASS_COMPOSITE, settings));
  const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT};
  frame->field->context.vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                              VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1, &barrier, 0, NULL, 0, NULL);
  const uint32_t flags =
      (add & OLX_VULKAN_ADD_DIFFUSE ? OLX_FRAME_DIFFUSE : 0u) | (add & OLX_VULKAN_ADD_GLOSSY ? OLX_FRAME_GLOSSY : 0u);
  return olx_vulkan_record_pass(frame, OLX_PASS_COMPOSITE, commands, view, settings, flags);
}
