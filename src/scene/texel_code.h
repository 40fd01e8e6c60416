// Lossless coding of 8-bit texels: each predicted from its neighbours to the left and above, the difference Rice-coded.
// About half the bytes of what photographs take. docs/cooked.md is the specification.
#ifndef OLX_SCENE_TEXEL_CODE_H
#define OLX_SCENE_TEXEL_CODE_H

#include "scene/scene_data.h"

// A growing run of bytes. Zero-initialise; data is released with olx_release.
typedef struct olx_byte_buffer {
  uint8_t *data;
  size_t size_bytes, capacity_bytes;
} olx_byte_buffer;

// The channels that carry anything: 4; 3 when alpha is 255 everywhere; 1 when, besides, all texels are grey.
uint32_t olx_texel_channels(const olx_texture *texture);

// Append the first `channels` channels of a texture to `buffer`. False when there is no memory.
bool olx_texel_encode(const olx_texture *texture, uint32_t channels, olx_byte_buffer *buffer);

// Decode width x height texels from exactly `size_bytes` bytes into texture->texels, 4 bytes a texel. False when the
// bytes are not the code of so many texels; what has been decoded until then stays.
bool olx_texel_decode(const uint8_t *bytes, size_t size_bytes, uint32_t channels, olx_texture *texture);

#endif
