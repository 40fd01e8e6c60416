// Pictures whose surfaces and direct light the CPU renders, and whose indirect light comes from a field on a Vulkan
// device.
#ifndef OCTALUX_CLI_VULKAN_RENDER_H
#define OCTALUX_CLI_VULKAN_RENDER_H

#include <octalux/render.h>

enum { VULKAN_PROBLEM_BYTES = 512 };

typedef struct vulkan_timing {
  char device[256];
  double upload_seconds, diffuse_seconds, glossy_seconds, denoise_seconds; // from recording to having the result
  double update_seconds;                                                   // of copying what the relighter changed
  uint64_t updated_bytes;                                                  // by that
} vulkan_timing;

typedef struct vulkan_request {
  const olx_scene *scene;
  const olx_field *field;
  const olx_relight *relight; // that has changed the field's maps; NULL: none
  const olx_camera *cameras;  // one a frame
  uint32_t camera_count;
  bool denoised; // as olx_render_frames does; else one picture, as olx_render does through pixel centres
  const olx_render_settings *settings;
  bool validate; // turn the validation layers on
  const olx_progress *progress;
} vulkan_request;

// On success the image is the caller's to free. problem: empty, or what went wrong on the device; the result reports
// everything else, with a message of the library's.
olx_result vulkan_render(const vulkan_request *request, olx_image *image, olx_render_stats *stats,
                         vulkan_timing *timing, char problem[VULKAN_PROBLEM_BYTES]);

#endif
