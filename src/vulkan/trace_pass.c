// Records the pass that traces glossy rays through the field, and the pass that lights dim lobes by irradiance instead.
#include "vulkan/vulkan_frame.h"

static const uint32_t WORDS[] = {
#include "trace.spv.inc"
};
const olx_pass_code olx_trace_pass = {"trace", WORDS, sizeof WORDS};

static const uint32_t DIM_WORDS[] = {
#include "dim.spv.inc"
};
const olx_pass_code olx_dim_pass = {"dim", DIM_WORDS, sizeof DIM_WORDS};

// Records both dispatches without a barrier between them, because they write different pixels.
olx_result olx_vulkan_record_glossy(const olx_vulkan_frame *frame, VkCommandBuffer commands,
                                    const olx_vulkan_view *view, const olx_vulkan_settings *settings) {
  OLX_TRY(olx_vulkan_record_rays(frame, OLX_PASS_TRACE, OLX_VULKAN_LOBE_GLOSSY, commands, view, settings));
  if (!(olx_vulkan_dim_lobe(settings) > 0.0f)) return OLX_OK;
  const bool denoised = settings->denoise.lobes & OLX_VULKAN_LOBE_GLOSSY;
  return olx_vulkan_record_pass(frame, OLX_PASS_DIM, commands, view, settings, denoised ? OLX_FRAME_SAMPLE : 0u);
}
