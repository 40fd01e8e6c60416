// Records the pass that reads diffuse light from surfaces or interpolates it between irradiance probes.
#include "vulkan/vulkan_frame.h"

static const uint32_t WORDS[] = {
#include "irradiance.spv.inc"
};
const olx_pass_code olx_irradiance_pass = {"irradiance", WORDS, sizeof WORDS};

olx_result olx_vulkan_record_irradiance(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                        const olx_vulkan_view *view, const olx_vulkan_settings *settings) {
  return olx_vulkan_record_pass(frame, OLX_PASS_IRRADIANCE, commands, view, settings, 0);
}
