// Encodes the surfaces of a probe a row of blocks at a time. A block depends on its own texels alone, so that the
// result is the same on any number of threads.
#include "field/surface_encode.h"

#include "block/bc1_encode.h"
#include "block/bc4_encode.h"
#include "block/bc6h_encode.h"
#include "block/reflectance.h"
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "field/texels.h"

enum { TEXELS = OLX_BLOCK_SIDE * OLX_BLOCK_SIDE };

// The texels from which a block is encoded.
typedef struct block_texels {
  uint32_t base[TEXELS], counted; // counted: a bit for each texel that is not sky
  uint8_t roughness[TEXELS], reflectance[TEXELS];
  olx_vec3 direct[TEXELS], indirect[TEXELS];
  float brightness[TEXELS];
} block_texels;

typedef struct encoding {
  const olx_surface_texels *texels;
  const olx_surface_blocks *blocks;
  uint32_t n;
} encoding;

static void load_texel(const olx_surface_texels *t, size_t at, uint32_t i, block_texels *b) {
  const uint32_t specular = t->specular[at];
  b->base[i] = t->base[at];
  b->roughness[i] = (uint8_t)(t->base[at] >> 24);
  b->reflectance[i] =
      olx_reflectance_pack((olx_reflectance){olx_byte_unpack_unit(specular), olx_byte_unpack_unit(specular >> 8)});
  b->direct[i] = olx_rgb9e5_unpack(t->direct[at]);
  b->indirect[i] = olx_rgb9e5_unpack(t->indirect[at]);
  b->brightness[i] = olx_max3(olx_add(b->direct[i], b->indirect[i]));
  b->counted |= (uint32_t)(t->distance[at] != 0x7C00u) << i;
}

static void encode_block(const encoding *e, uint32_t x, uint32_t y) {
  block_texels b;
  b.counted = 0;
  for (uint32_t i = 0; i < TEXELS; i++) {
    const uint32_t column = OLX_BLOCK_SIDE * x + i % OLX_BLOCK_SIDE, row = OLX_BLOCK_SIDE * y + i / OLX_BLOCK_SIDE;
    load_texel(e->texels, (size_t)row * e->n + column, i, &b);
  }
  const size_t at = (size_t)y * (e->n / OLX_BLOCK_SIDE) + x;
  e->blocks->base[at] = olx_bc1_encode(b.base, b.counted);
  e->blocks->specular[at] =
      (olx_bc5_block){olx_bc4_encode(b.roughness, b.counted), olx_bc4_encode(b.reflectance, b.counted)};
  e->blocks->direct[at] = olx_bc6h_encode(b.direct, b.brightness, b.counted);
  e->blocks->indirect[at] = olx_bc6h_encode(b.indirect, NULL, b.counted);
}

static void encode_row(void *user, uint32_t y) {
  const encoding *e = user;
  for (uint32_t x = 0; x < e->n / OLX_BLOCK_SIDE; x++) encode_block(e, x, y);
}

olx_result olx_surface_encode(const olx_surface_texels *texels, uint32_t n, uint32_t threads,
                              const olx_surface_blocks *blocks) {
  encoding e = {texels, blocks, n};
  return olx_parallel_for(n / OLX_BLOCK_SIDE, threads, encode_row, &e, NULL, 0);
}

static size_t block_count(uint32_t n) { return (size_t)(n / OLX_BLOCK_SIDE) * (n / OLX_BLOCK_SIDE); }

uint64_t olx_surface_blocks_bytes(uint32_t n) {
  return block_count(n) * (sizeof(olx_bc1_block) + sizeof(olx_bc5_block) + 2 * sizeof(olx_bc6h_block));
}

olx_result olx_surface_blocks_create(uint32_t n, olx_surface_blocks *b) {
  const size_t count = block_count(n);
  *b = (olx_surface_blocks){olx_allocate(count, sizeof *b->base), olx_allocate(count, sizeof *b->specular),
                            olx_allocate(count, sizeof *b->direct), olx_allocate(count, sizeof *b->indirect)};
  if (b->base && b->specular && b->direct && b->indirect) return OLX_OK;
  olx_surface_blocks_free(b);
  return olx_fail(OLX_ERROR_MEMORY, "out of memory for blocks of %u x %u texels", n, n);
}

void olx_surface_blocks_free(olx_surface_blocks *b) {
  olx_release(b->base);
  olx_release(b->specular);
  olx_release(b->direct);
  olx_release(b->indirect);
  *b = (olx_surface_blocks){0};
}
