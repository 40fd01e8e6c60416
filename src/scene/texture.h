// Samples textures.
#ifndef OLX_SCENE_TEXTURE_H
#define OLX_SCENE_TEXTURE_H

#include "scene/scene_data.h"

typedef struct olx_texel {
  olx_vec3 color; // linear
  float alpha;
} olx_texel;

// Returns the texel at column x and row y, which wrap around at most once: -width <= x < 2 width.
olx_texel olx_texture_texel(const olx_texture *texture, int32_t x, int32_t y);

// Samples bilinearly with wrap-around, filtered in linear light; texel centres lie at (i + 0.5) / size.
olx_texel olx_texture_sample(const olx_texture *texture, olx_vec2 uv);

// Returns the alpha that olx_texture_sample returns, bit for bit, without the cost of the colour.
float olx_texture_alpha(const olx_texture *texture, olx_vec2 uv);

// Has the texels of a sample brought into the cache; nothing waits for them.
void olx_texture_prefetch(const olx_texture *texture, olx_vec2 uv);

#endif
