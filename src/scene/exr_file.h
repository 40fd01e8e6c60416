// Reading OpenEXR files through OpenEXR's C core: single-part images of scanlines, channel by channel.
#ifndef OLX_SCENE_EXR_FILE_H
#define OLX_SCENE_EXR_FILE_H

#include "core/file.h"

#include <OpenEXR/openexr.h>

// Largest width and height of an image.
enum { OLX_EXR_MAX_SIZE = 16384 };

typedef struct olx_exr_file {
  const char *path;
  olx_mapped_file mapped;
  exr_context_t context;
  char message[256]; // the first complaint that OpenEXR had
  uint32_t width, height;
  int first_row; // what the file numbers it
} olx_exr_file;

bool olx_is_exr(const void *data, size_t size_bytes);

// Open a file and read its header. Every chunk lies inside the file, so that a short one cannot claim gigabytes.
// Whatever comes back, olx_exr_close closes; `file` must stay where it is.
olx_result olx_exr_open(const char *path, olx_exr_file *file);
void olx_exr_close(olx_exr_file *file);

// Show every channel's name to `wants`. Those that it wants must not be subsampled nor hold integers.
olx_result olx_exr_find_channels(const olx_exr_file *file, bool (*wants)(void *user, const char *channel), void *user);

// Where the floats of a channel go, from a row of the image on.
typedef struct olx_exr_target {
  float *pixels;                   // NULL: nowhere
  int32_t pixel_bytes, line_bytes; // from one pixel, and from one line, to the next
} olx_exr_target;

olx_result olx_exr_read(olx_exr_file *file, olx_exr_target (*target)(void *user, const char *channel, uint32_t row),
                        void *user);

#endif
