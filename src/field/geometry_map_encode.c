// Encodes maps of geometry, a row of blocks at a time, and gathers the planes to which blocks refer in one pool.
#include "field/geometry_map_encode.h"

#include "core/hooks.h"
#include "core/parallel.h"

#include <string.h>

typedef struct encoding {
  const olx_geometry_maker *maker;
  olx_geometry_settings settings;
  olx_geometry_look look;
  const void *user;
  uint32_t n;
} encoding;

static void encode_row(void *user, uint32_t y) {
  const encoding *e = user;
  const uint32_t side = e->n / OLX_BLOCK_SIDE;
  for (uint32_t x = 0; x < side; x++) {
    olx_geometry_texel texels[OLX_BLOCK_TEXELS];
    for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
      texels[i] = e->look(e->user, OLX_BLOCK_SIDE * x + i % OLX_BLOCK_SIDE, OLX_BLOCK_SIDE * y + i / OLX_BLOCK_SIDE);
    }
    e->maker->codes[y * side + x] = olx_geometry_encode(texels, (olx_block_place){e->n, x, y}, &e->settings);
  }
}

static olx_result make_room(olx_geometry_maker *maker, uint32_t planes) {
  if (planes <= maker->most_planes) return OLX_OK;
  olx_release(maker->planes);
  maker->most_planes = planes + planes / 2;
  maker->planes = olx_allocate(maker->most_planes, sizeof *maker->planes);
  if (maker->planes) return OLX_OK;
  maker->most_planes = 0;
  return olx_fail(OLX_ERROR_MEMORY, "out of memory for %u planes", planes);
}

static olx_result gather(olx_geometry_maker *maker, uint32_t count) {
  uint32_t planes = 0;
  for (uint32_t i = 0; i < count; i++) planes += maker->codes[i].pooled;
  OLX_TRY(make_room(maker, planes));
  uint32_t first = 0;
  for (uint32_t i = 0; i < count; i++) {
    const olx_geometry_code *code = &maker->codes[i];
    maker->blocks[i] = code->block;
    if (!code->pooled) continue;
    maker->blocks[i].words[0] += first;
    memcpy(maker->planes + first, code->planes, code->pooled * sizeof *code->planes);
    first += code->pooled;
  }
  maker->map = (olx_geometry_map){maker->blocks, {maker->planes, planes}};
  return OLX_OK;
}

olx_result olx_geometry_maker_encode(olx_geometry_maker *maker, uint32_t n, uint32_t threads, olx_geometry_look look,
                                     const void *user) {
  encoding e = {maker, olx_geometry_settings_default(), look, user, n};
  const uint32_t side = n / OLX_BLOCK_SIDE;
  OLX_TRY(olx_parallel_for(side, threads, encode_row, &e, NULL, 0));
  return gather(maker, side * side);
}

static size_t block_count(uint32_t n) { return (size_t)(n / OLX_BLOCK_SIDE) * (n / OLX_BLOCK_SIDE); }

uint64_t olx_geometry_maker_bytes(uint32_t n) {
  return block_count(n) * (sizeof(olx_geometry_code) + sizeof(olx_geometry_block));
}

olx_result olx_geometry_maker_create(uint32_t n, olx_geometry_maker *maker) {
  *maker = (olx_geometry_maker){.codes = olx_allocate(block_count(n), sizeof *maker->codes),
                                .blocks = olx_allocate(block_count(n), sizeof *maker->blocks)};
  if (maker->codes && maker->blocks) return OLX_OK;
  olx_geometry_maker_free(maker);
  return olx_fail(OLX_ERROR_MEMORY, "out of memory for geometry of %u x %u texels", n, n);
}

void olx_geometry_maker_free(olx_geometry_maker *maker) {
  olx_release(maker->codes);
  olx_release(maker->blocks);
  olx_release(maker->planes);
  *maker = (olx_geometry_maker){0};
}
