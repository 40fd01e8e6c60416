// Checks Radiance images before stb_image reads them.
#ifndef OLX_SCENE_HDR_CHECK_H
#define OLX_SCENE_HDR_CHECK_H

#include <octalux/base.h>

// Returns OLX_ERROR_FORMAT for a Radiance image whose texels end early, or with a run of no texels: stb_image would
// read uninitialized memory as texels, or never end. Files of other formats pass.
olx_result olx_hdr_check(const char *path, const uint8_t *data, size_t size_bytes);

#endif
