// WebP images, which stb_image does not read.
#ifndef OLX_SCENE_WEBP_FILE_H
#define OLX_SCENE_WEBP_FILE_H

#include <octalux/base.h>

bool olx_is_webp(const void *data, size_t size_bytes);

// Reads an image's size from its header.
olx_result olx_webp_size(const char *path, const void *data, size_t size_bytes, int *width, int *height);

// Decodes an image of that size into *texels: R, G, B, A of 8 bits each, to be released with olx_release.
olx_result olx_webp_decode(const char *path, const void *data, size_t size_bytes, int width, int height,
                           uint8_t **texels);

#endif
