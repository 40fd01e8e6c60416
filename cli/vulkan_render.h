// Renders images whose surfaces and direct light come from the CPU, and whose indirect light comes from a field on a
// Vulkan device.
#ifndef OCTALUX_CLI_VULKAN_RENDER_H
#define OCTALUX_CLI_VULKAN_RENDER_H

#include <octalux/render.h>

enum { VULKAN_PROBLEM_BYTES = 512 };

typedef struct vulkan_timing {
  char device[256];
  double upload_seconds, diffuse_seconds, glossy_seconds, denoise_seconds; // from recording to the result
  double update_seconds;                                                   // time to upload the relighter's changes
  uint64_t updated_bytes;                                                  // size of these uploads
} vulkan_timing;

typedef struct vulkan_request {
  const olx_scene *scene;
  const olx_field *field;
  const olx_relight *relight; // relighter that has changed the field's maps; NULL: none
  const olx_camera *cameras;  // one per frame
  uint32_t camera_count;
  bool denoised; // like olx_render_frames; otherwise one image, like olx_render through pixel centres
  const olx_render_settings *settings;
  bool validate; // enable the validation layers
  const olx_progress *progress;
} vulkan_request;

// Renders an image, which on success the caller frees. `problem` is empty or names an error of the device; the result
// reports all other errors, with the library's message.
olx_result vulkan_render(const vulkan_request *request, olx_image *image, olx_render_stats *stats,
                         vulkan_timing *timing, char problem[VULKAN_PROBLEM_BYTES]);

#endif
