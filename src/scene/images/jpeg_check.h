// Checks JPEGs before stb_image reads them.
#ifndef OLX_SCENE_JPEG_CHECK_H
#define OLX_SCENE_JPEG_CHECK_H

#include <octalux/base.h>

// Returns OLX_ERROR_FORMAT for a JPEG with a Huffman table of more than 256 codes, which stb_image would write beyond
// its end. Files of other formats pass.
olx_result olx_jpeg_check(const char *path, const uint8_t *data, size_t size_bytes);

#endif
