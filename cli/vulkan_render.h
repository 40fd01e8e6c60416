// Indirect light for a picture whose surfaces are known, from a field on a Vulkan device.
#ifndef OCTALUX_CLI_VULKAN_RENDER_H
#define OCTALUX_CLI_VULKAN_RENDER_H

#include <octalux/render.h>

typedef struct vulkan_timing {
  char device[256];
  double upload_seconds, diffuse_seconds, glossy_seconds; // from recording to having the result
} vulkan_timing;

// Fill the indirect layers of `image`, and add them to beauty. NULL, or what went wrong.
const char *vulkan_render_indirect(const olx_field *field, const olx_gbuffer *gbuffer,
                                   const olx_render_settings *settings, bool validate, olx_image *image,
                                   vulkan_timing *timing);

#endif
