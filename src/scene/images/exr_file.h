// Reads OpenEXR files through OpenEXR's C core: single-part scanline images, channel by channel.
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
  char message[256]; // the first error that OpenEXR reported
  uint32_t width, height;
  int first_row; // row number of the first row in the file
} olx_exr_file;

bool olx_is_exr(const void *data, size_t size_bytes);

// Opens a file and reads its header. Every chunk must lie inside the file, so that a short one cannot claim gigabytes.
// The caller closes it with olx_exr_close, also after a failure; `file` must not move.
olx_result olx_exr_open(const char *path, olx_exr_file *file);
void olx_exr_close(olx_exr_file *file);

// Passes every channel's name to `wants`. Wanted channels must not be subsampled or hold integers.
olx_result olx_exr_find_channels(const olx_exr_file *file, bool (*wants)(void *user, const char *channel), void *user);

// The destination of a channel's floats, from a row of the image on.
typedef struct olx_exr_target {
  float *pixels;                   // NULL: skip the channel
  int32_t pixel_bytes, line_bytes; // strides between pixels and between lines
} olx_exr_target;

olx_result olx_exr_read(olx_exr_file *file, olx_exr_target (*target)(void *user, const char *channel, uint32_t row),
                        void *user);

#endif
