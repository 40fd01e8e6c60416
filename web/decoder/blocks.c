// Decodes blocks to texels in browsers whose devices cannot: src/block, compiled to WebAssembly (web/build.mjs). Texels
// equal those of texture units except for rounding.
#include "block/bc1.h"
#include "block/bc4.h"
#include "block/bc6h.h"

#define EXPORT(name) __attribute__((export_name(#name)))

extern unsigned char __heap_base;

// Returns the address where a caller may put blocks, followed by room for texels; memory grows from here.
EXPORT(heap) void *heap(void) { return &__heap_base; }

// Returns the index of texel i of block b in a map with `side` blocks in a row.
static uint32_t place(uint32_t side, uint32_t b, uint32_t i) {
  return (b / side * 4 + i / 4) * (4 * side) + b % side * 4 + i % 4;
}

// Decodes to RGBA of 8 bits.
EXPORT(decode_bc1) void decode_bc1(const olx_bc1_block *blocks, uint32_t side, uint32_t count, uint32_t *texels) {
  for (uint32_t i = 0; i < 16 * count; i++) {
    texels[place(side, i / 16, i % 16)] = olx_bc1_texel(&blocks[i / 16], i % 16) | 0xFF000000u;
  }
}

// Decodes to RG of 8 bits.
EXPORT(decode_bc5) void decode_bc5(const olx_bc5_block *blocks, uint32_t side, uint32_t count, uint16_t *texels) {
  for (uint32_t i = 0; i < 16 * count; i++) {
    texels[place(side, i / 16, i % 16)] = olx_bc5_texel(&blocks[i / 16], i % 16);
  }
}

// Decodes to RGBA of half floats.
EXPORT(decode_bc6h) void decode_bc6h(const olx_bc6h_block *blocks, uint32_t side, uint32_t count, uint16_t *texels) {
  for (uint32_t i = 0; i < 16 * count; i++) {
    const olx_vec3 light = olx_bc6h_texel(&blocks[i / 16], i % 16);
    uint16_t *texel = &texels[4 * place(side, i / 16, i % 16)];
    texel[0] = olx_half_pack(light.x);
    texel[1] = olx_half_pack(light.y);
    texel[2] = olx_half_pack(light.z);
    texel[3] = 0x3C00; // 1 as a half float
  }
}
