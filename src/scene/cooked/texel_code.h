// Lossless coding of 8-bit texels: each is predicted from its neighbours to the left and above, and the difference
// Rice-coded. Photographs take about half their size. docs/cooked.md is the specification.
#ifndef OLX_SCENE_TEXEL_CODE_H
#define OLX_SCENE_TEXEL_CODE_H

#include "scene/scene_data.h"

// A growing buffer of bytes. Zero-initialize; release data with olx_release.
typedef struct olx_byte_buffer {
  uint8_t *data;
  size_t size_bytes, capacity_bytes;
} olx_byte_buffer;

// Returns the number of channels that carry information: 4; 3 when alpha is 255 everywhere; 1 when, in addition, all
// texels are grey.
uint32_t olx_texel_channels(const olx_texture *texture);

// Appends the first `channels` channels of a texture to `buffer`. Returns false when memory runs out.
bool olx_texel_encode(const olx_texture *texture, uint32_t channels, olx_byte_buffer *buffer);

// Decodes width x height texels from exactly `size_bytes` bytes into texture->texels, 4 bytes per texel. Returns false
// when the bytes are not the code of that many texels; texels decoded so far remain.
bool olx_texel_decode(const uint8_t *bytes, size_t size_bytes, uint32_t channels, olx_texture *texture);

#endif
