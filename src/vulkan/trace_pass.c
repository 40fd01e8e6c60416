#include "vulkan/gpu_frame.h"

static const uint32_t WORDS[] = {
#include "trace.spv.inc"
};
const olx_pass_code olx_trace_pass = {"trace", WORDS, sizeof WORDS};

olx_result olx_vulkan_record_glossy(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                    const olx_vulkan_view *view, const olx_vulkan_settings *settings) {
  return olx_vulkan_record_rays(frame, OLX_PASS_TRACE, OLX_VULKAN_LOBE_GLOSSY, commands, view, settings);
}
