// What a Radiance image must hold before stb_image may read it.
#ifndef OLX_SCENE_HDR_CHECK_H
#define OLX_SCENE_HDR_CHECK_H

#include <octalux/base.h>

// OLX_ERROR_FORMAT for a Radiance image whose texels end early, or with a run of no texels: stb_image would take what
// happens to lie in memory for texels, or never end. Whatever is no Radiance image passes.
olx_result olx_hdr_check(const char *path, const uint8_t *data, size_t size_bytes);

#endif
