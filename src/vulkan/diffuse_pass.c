// Records the pass that traces cosine-distributed rays through the field for diffuse light.
#include "vulkan/vulkan_frame.h"

static const uint32_t WORDS[] = {
#include "diffuse.spv.inc"
};
const olx_pass_code olx_diffuse_pass = {"diffuse", WORDS, sizeof WORDS};

olx_result olx_vulkan_record_diffuse(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                     const olx_vulkan_view *view, const olx_vulkan_settings *settings) {
  return olx_vulkan_record_rays(frame, OLX_PASS_DIFFUSE, OLX_VULKAN_LOBE_DIFFUSE, commands, view, settings);
}
