// Reads WebP images with libwebp, which is safe on hostile files: lossy and lossless ones, with and without alpha.
// Animations are refused.
#include "scene/images/webp_file.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

#include <webp/decode.h>

bool olx_is_webp(const void *data, size_t size_bytes) {
  const uint8_t *bytes = data;
  return size_bytes >= 12 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0;
}

olx_result olx_webp_size(const char *path, const void *data, size_t size_bytes, int *width, int *height) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data, size_bytes, &features) != VP8_STATUS_OK) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: the header of this WebP image is damaged", path);
  }
  if (features.has_animation) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: an animated WebP image is no texture", path);
  }
  *width = features.width;
  *height = features.height;
  return OLX_OK;
}

olx_result olx_webp_decode(const char *path, const void *data, size_t size_bytes, int width, int height,
                           uint8_t **texels) {
  const size_t row_bytes = (size_t)width * 4, all_bytes = row_bytes * (size_t)height;
  uint8_t *decoded = olx_allocate((size_t)height, row_bytes);
  if (!decoded) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  if (!WebPDecodeRGBAInto(data, size_bytes, decoded, all_bytes, (int)row_bytes)) {
    olx_release(decoded);
    return olx_fail(OLX_ERROR_FORMAT, "%s: cannot decode this WebP image", path);
  }
  *texels = decoded;
  return OLX_OK;
}
