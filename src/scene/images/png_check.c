// Checks the chunks of a PNG before stb_image decodes it: each is a length, a type, that many bytes, and a checksum.
#include "scene/images/png_check.h"

#include "core/result.h"

#include <string.h>

enum { SIGNATURE_BYTES = 8, FRAME_BYTES = 12, END_BYTES = 8 };

olx_result olx_png_check(const char *path, const uint8_t *data, size_t size_bytes) {
  if (size_bytes < SIGNATURE_BYTES || memcmp(data, "\x89PNG\r\n\x1a\n", SIGNATURE_BYTES) != 0) return OLX_OK;
  for (size_t at = SIGNATURE_BYTES; size_bytes - at >= END_BYTES;) {
    const uint8_t *chunk = data + at;
    const uint32_t length =
        (uint32_t)chunk[0] << 24 | (uint32_t)chunk[1] << 16 | (uint32_t)chunk[2] << 8 | (uint32_t)chunk[3];
    if (memcmp(chunk + 4, "IEND", 4) == 0) break;
    if (size_bytes - at < FRAME_BYTES || length > size_bytes - at - FRAME_BYTES) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: a chunk of this PNG is longer than the file", path);
    }
    at += FRAME_BYTES + length;
  }
  return OLX_OK;
}
