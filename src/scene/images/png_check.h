// Checks PNGs before stb_image reads them.
#ifndef OLX_SCENE_PNG_CHECK_H
#define OLX_SCENE_PNG_CHECK_H

#include <octalux/base.h>

// Returns OLX_ERROR_FORMAT for a PNG with a chunk that is longer than the file: stb_image would allocate as much memory
// as the chunk claims, up to 2 GiB. Files of other formats pass.
olx_result olx_png_check(const char *path, const uint8_t *data, size_t size_bytes);

#endif
