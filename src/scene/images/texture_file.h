// Decodes image files: textures (JPEG, PNG, WebP, TGA, BMP) and environments (Radiance .hdr, OpenEXR).
#ifndef OLX_SCENE_TEXTURE_FILE_H
#define OLX_SCENE_TEXTURE_FILE_H

#include "scene/scene_data.h"

typedef enum olx_texture_use {
  OLX_TEXTURE_COLOR,   // sRGB-encoded colour, alpha in A
  OLX_TEXTURE_OPAQUE,  // the same with an alpha of 1
  OLX_TEXTURE_DATA,    // linear values
  OLX_TEXTURE_COVERAGE // R becomes the image's alpha channel where it has one that varies
} olx_texture_use;

// Decodes an image from a file, or from `size_bytes` at `data` when that is not NULL (`path` is then used only in
// messages). The caller owns texture->texels.
olx_result olx_texture_load(const char *path, const void *data, size_t size_bytes, olx_texture_use use,
                            olx_texture *texture);

// Finds the number of texels of an image, from its header alone. Fails where olx_texture_load would fail because of the
// header.
olx_result olx_texture_measure(const char *path, const void *data, size_t size_bytes, uint64_t *texels);

// Decodes a latitude-longitude .hdr or .exr image, distinguished by content, into width, height and texels of
// `environment`. Texels that are negative or not finite become 0 and are counted in *repaired. An image beyond the
// scene's limit of texels is rejected.
olx_result olx_environment_load(const char *path, const olx_scene *scene, olx_environment *environment,
                                uint64_t *repaired);

#endif
