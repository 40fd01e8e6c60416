// Writes a 3D texture of RGB9E5 texels as KTX 2.0.
#ifndef OLX_EXPORT_KTX2_FILE_H
#define OLX_EXPORT_KTX2_FILE_H

#include <octalux/base.h>

typedef struct olx_ktx2_texture {
  uint32_t size[3];       // texels along x, y and z, each at least 1
  const uint32_t *texels; // olx_rgb9e5_pack; x fastest, then y, then z
  const char *key, *text; // an entry of text of the file's own; `key` comes after "KTXwriter" in the order of bytes
  bool zstd;              // compress the texels by Zstandard
} olx_ktx2_texture;

// Writes the texture in order, without mipmaps. file_bytes may be NULL.
olx_result olx_ktx2_write(const olx_ktx2_texture *texture, const char *path, uint64_t *file_bytes);

#endif
