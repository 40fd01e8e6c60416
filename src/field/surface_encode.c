// Encodes the surfaces of a probe as tiles, a row of them at a time, and gathers their blocks in pools. What a tile
// becomes depends on its own texels alone, so that the result is the same on any number of threads.
#include "field/surface_encode.h"

#include "block/bc1_encode.h"
#include "block/bc4_encode.h"
#include "block/bc6h_encode.h"
#include "block/reflectance.h"
#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/parallel.h"
#include "field/texels.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK_TEXELS = OLX_BLOCK_SIDE * OLX_BLOCK_SIDE, BLOCKS = 4 }; // BLOCKS: of a tile of full resolution

// How far texels may be off in tiles of half resolution: bytes of material; shares of light, the root of the mean
// square of a tile and of each texel. A texel's light counts as at least a share of the brightest in its tile.
enum { MOST_BASE_ERROR = 2, MOST_SPECULAR_ERROR = 2 };
static const float MOST_LIGHT_ERROR = 0.0125f, MOST_TEXEL_ERROR = 0.05f, LEAST_BRIGHTNESS = 0.01f;

// The texels of a tile, row by row.
typedef struct tile_texels {
  uint32_t base[OLX_TILE_TEXELS];
  uint8_t roughness[OLX_TILE_TEXELS], reflectance[OLX_TILE_TEXELS];
  olx_vec3 light[2][OLX_TILE_TEXELS]; // direct, indirect
  float brightness[OLX_TILE_TEXELS];
  bool seen[OLX_TILE_TEXELS]; // not sky
} tile_texels;

// The texels from which a block is encoded.
typedef struct block_texels {
  uint32_t base[BLOCK_TEXELS], counted; // counted: a bit for each texel that is not sky
  uint8_t roughness[BLOCK_TEXELS], reflectance[BLOCK_TEXELS];
  olx_vec3 light[2][BLOCK_TEXELS];
  float brightness[BLOCK_TEXELS];
} block_texels;

typedef struct block_code {
  _Alignas(uint32_t) unsigned char bytes[sizeof(olx_bc6h_block)];
} block_code;

typedef struct encoding {
  const olx_surface_texels *texels;
  olx_surface_maker *maker;
  uint32_t n;
} encoding;

static void load_texel(const olx_surface_texels *t, size_t at, uint32_t i, tile_texels *tile) {
  const uint32_t specular = t->specular[at];
  tile->base[i] = t->base[at];
  tile->roughness[i] = (uint8_t)(t->base[at] >> 24);
  tile->reflectance[i] =
      olx_reflectance_pack((olx_reflectance){olx_byte_unpack_unit(specular), olx_byte_unpack_unit(specular >> 8)});
  tile->light[0][i] = olx_rgb9e5_unpack(t->direct[at]);
  tile->light[1][i] = olx_rgb9e5_unpack(t->indirect[at]);
  tile->brightness[i] = olx_max3(olx_add(tile->light[0][i], tile->light[1][i]));
  tile->seen[i] = t->distance[at] != 0x7C00u;
}

// Returns whether any texel of the tile (x, y) is not sky.
static bool load_tile(const olx_surface_texels *texels, uint32_t n, uint32_t x, uint32_t y, tile_texels *tile) {
  bool any = false;
  for (uint32_t i = 0; i < OLX_TILE_TEXELS; i++) {
    const uint32_t column = OLX_TILE_SIDE * x + i % OLX_TILE_SIDE, row = OLX_TILE_SIDE * y + i / OLX_TILE_SIDE;
    load_texel(texels, (size_t)row * n + column, i, tile);
    any |= tile->seen[i];
  }
  return any;
}

// Copies a quarter of a tile.
static void take_quarter(const tile_texels *tile, uint32_t quarter, block_texels *b) {
  b->counted = 0;
  for (uint32_t i = 0; i < BLOCK_TEXELS; i++) {
    const uint32_t x = quarter % 2 * OLX_BLOCK_SIDE + i % OLX_BLOCK_SIDE,
                   y = quarter / 2 * OLX_BLOCK_SIDE + i / OLX_BLOCK_SIDE, at = y * OLX_TILE_SIDE + x;
    b->base[i] = tile->base[at];
    b->roughness[i] = tile->roughness[at];
    b->reflectance[i] = tile->reflectance[at];
    for (uint32_t k = 0; k < 2; k++) b->light[k][i] = tile->light[k][at];
    b->brightness[i] = tile->brightness[at];
    b->counted |= (uint32_t)tile->seen[at] << i;
  }
}

// Sums over the texels of a group of 2 x 2 that are not sky.
typedef struct group_sums {
  uint32_t base[3], roughness, reflectance, count;
  olx_vec3 light[2];
  float brightness;
} group_sums;

static void add_texel(const tile_texels *tile, uint32_t at, group_sums *sums) {
  if (!tile->seen[at]) return;
  for (uint32_t k = 0; k < 3; k++) sums->base[k] += tile->base[at] >> 8 * k & 0xFFu;
  sums->roughness += tile->roughness[at];
  sums->reflectance += tile->reflectance[at];
  for (uint32_t k = 0; k < 2; k++) sums->light[k] = olx_add(sums->light[k], tile->light[k][at]);
  sums->brightness += tile->brightness[at];
  sums->count++;
}

static uint32_t mean_byte(uint32_t sum, uint32_t count) { return (sum + count / 2) / count; }

// Averages groups of 2 x 2 texels of a tile.
static void take_half(const tile_texels *tile, block_texels *b) {
  *b = (block_texels){.counted = 0};
  for (uint32_t i = 0; i < BLOCK_TEXELS; i++) {
    const uint32_t corner = i / OLX_BLOCK_SIDE * 2 * OLX_TILE_SIDE + i % OLX_BLOCK_SIDE * 2;
    group_sums sums = {.count = 0};
    for (uint32_t k = 0; k < 4; k++) add_texel(tile, corner + k / 2 * OLX_TILE_SIDE + k % 2, &sums);
    if (sums.count == 0) continue;
    for (uint32_t k = 0; k < 3; k++) b->base[i] |= mean_byte(sums.base[k], sums.count) << 8 * k;
    b->roughness[i] = (uint8_t)mean_byte(sums.roughness, sums.count);
    b->reflectance[i] = (uint8_t)mean_byte(sums.reflectance, sums.count);
    for (uint32_t k = 0; k < 2; k++) b->light[k][i] = olx_scale(sums.light[k], 1.0f / (float)sums.count);
    b->brightness[i] = sums.brightness / (float)sums.count;
    b->counted |= 1u << i;
  }
}

static block_code encode_block(olx_surface_map map, const block_texels *b) {
  block_code code = {{0}};
  if (map == OLX_SURFACE_BASE) {
    const olx_bc1_block block = olx_bc1_encode(b->base, b->counted);
    memcpy(code.bytes, &block, sizeof block);
  } else if (map == OLX_SURFACE_SPECULAR) {
    const olx_bc5_block block = {olx_bc4_encode(b->roughness, b->counted), olx_bc4_encode(b->reflectance, b->counted)};
    memcpy(code.bytes, &block, sizeof block);
  } else {
    const bool direct = map == OLX_SURFACE_DIRECT;
    const olx_bc6h_block block = olx_bc6h_encode(b->light[!direct], direct ? b->brightness : NULL, b->counted);
    memcpy(code.bytes, &block, sizeof block);
  }
  return code;
}

// Returns the texel of a block of half resolution that stands for texel i of its tile.
static uint32_t half_texel(uint32_t i) { return i / OLX_TILE_SIDE / 2 * OLX_BLOCK_SIDE + i % OLX_TILE_SIDE / 2; }

static bool material_fits(olx_surface_map map, const tile_texels *tile, const block_code *code) {
  const bool base = map == OLX_SURFACE_BASE;
  const int most = base ? MOST_BASE_ERROR : MOST_SPECULAR_ERROR;
  for (uint32_t i = 0; i < OLX_TILE_TEXELS; i++) {
    if (!tile->seen[i]) continue;
    const uint32_t decoded = base ? olx_bc1_texel((const olx_bc1_block *)(const void *)code->bytes, half_texel(i))
                                  : olx_bc5_texel((const olx_bc5_block *)(const void *)code->bytes, half_texel(i)),
                   wanted = base ? tile->base[i] : tile->roughness[i] | (uint32_t)tile->reflectance[i] << 8;
    for (uint32_t shift = 0; shift < (base ? 24u : 16u); shift += 8) {
      if (abs((int)(decoded >> shift & 0xFFu) - (int)(wanted >> shift & 0xFFu)) > most) return false;
    }
  }
  return true;
}

// Returns that to which errors of a texel's light are relative.
static float brightness_of(olx_surface_map map, const tile_texels *tile, uint32_t i) {
  return map == OLX_SURFACE_DIRECT ? tile->brightness[i] : olx_max3(tile->light[1][i]);
}

static bool light_fits(olx_surface_map map, const tile_texels *tile, const block_code *code) {
  const olx_bc6h_block *block = (const olx_bc6h_block *)(const void *)code->bytes;
  float most = 0.0f, sum = 0.0f;
  uint32_t count = 0;
  for (uint32_t i = 0; i < OLX_TILE_TEXELS; i++) {
    if (tile->seen[i]) most = olx_max(most, brightness_of(map, tile, i));
  }
  for (uint32_t i = 0; i < OLX_TILE_TEXELS; i++) {
    if (!tile->seen[i]) continue;
    const olx_vec3 off = olx_sub(olx_bc6h_texel(block, half_texel(i)), tile->light[map == OLX_SURFACE_INDIRECT][i]);
    const float scale = olx_max(brightness_of(map, tile, i), LEAST_BRIGHTNESS * most), square = olx_dot(off, off) / 3;
    if (!(square <= olx_square(MOST_TEXEL_ERROR * scale))) return false;
    sum += scale > 0.0f ? square / olx_square(scale) : 0.0f;
    count++;
  }
  return sum <= olx_square(MOST_LIGHT_ERROR) * (float)count;
}

static bool fits(olx_surface_map map, const tile_texels *tile, const block_code *code) {
  return map < OLX_SURFACE_DIRECT ? material_fits(map, tile, code) : light_fits(map, tile, code);
}

void olx_surface_tile_encode(const olx_surface_texels *texels, uint32_t n, uint32_t x, uint32_t y,
                             olx_surface_tile *tile) {
  tile_texels all;
  block_texels half, quarters[BLOCKS];
  memset(tile->count, 0, sizeof tile->count);
  if (!load_tile(texels, n, x, y, &all)) return;
  take_half(&all, &half);
  for (uint32_t i = 0; i < BLOCKS; i++) take_quarter(&all, i, &quarters[i]);
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    const uint32_t bytes = olx_surface_block_bytes(map);
    const block_code one = encode_block(map, &half);
    tile->count[map] = fits(map, &all, &one) ? 1 : BLOCKS;
    for (uint32_t i = 0; i < tile->count[map]; i++) {
      const block_code code = tile->count[map] == 1 ? one : encode_block(map, &quarters[i]);
      memcpy(tile->blocks[map] + (size_t)i * bytes, code.bytes, bytes);
    }
  }
}

// Stores a tile's form alone as its word, and its blocks in their room.
static void encode_tile(const encoding *e, uint32_t x, uint32_t y) {
  const size_t at = (size_t)y * (e->n / OLX_TILE_SIDE) + x;
  olx_surface_tile tile;
  olx_surface_tile_encode(e->texels, e->n, x, y, &tile);
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    const uint32_t bytes = olx_surface_block_bytes(map), count = tile.count[map];
    memcpy(e->maker->blocks[map] + at * BLOCKS * bytes, tile.blocks[map], (size_t)count * bytes);
    e->maker->words[map][at] = (count == 0 ? 0 : count == 1 ? OLX_TILE_HALF : OLX_TILE_FULL) << OLX_TILE_FORM_SHIFT;
  }
}

static void encode_row(void *user, uint32_t y) {
  const encoding *e = user;
  for (uint32_t x = 0; x < e->n / OLX_TILE_SIDE; x++) encode_tile(e, x, y);
}

static size_t tile_count(uint32_t n) { return (size_t)(n / OLX_TILE_SIDE) * (n / OLX_TILE_SIDE); }

// Returns the number of places in the table of known tiles, a power of two.
static size_t known_count(uint32_t n) { return 2 * tile_count(n); }

// Finds a tile before this one with the same form and blocks, or notes this one. Returns the earlier one's word, or 0.
static uint32_t find_equal(olx_surface_maker *maker, olx_surface_map map, size_t tile, size_t places) {
  const uint32_t word = maker->words[map][tile], bytes = olx_surface_block_bytes(map), count = olx_tile_blocks(word);
  const unsigned char *room = maker->blocks[map] + tile * BLOCKS * bytes;
  size_t place = (size_t)olx_content_hash(room, (size_t)count * bytes) & (places - 1);
  for (; maker->known[place]; place = (place + 1) & (places - 1)) {
    const uint32_t other = maker->words[map][maker->known[place] - 1];
    if (other >> OLX_TILE_FORM_SHIFT == word >> OLX_TILE_FORM_SHIFT &&
        memcmp(maker->blocks[map] + (size_t)olx_tile_first(other) * bytes, room, (size_t)count * bytes) == 0) {
      return other;
    }
  }
  maker->known[place] = (uint32_t)tile + 1;
  return 0;
}

// Moves the blocks of tiles together, each set of equal ones once, and completes the words.
static void gather(olx_surface_maker *maker, olx_surface_map map, uint32_t n) {
  const uint32_t bytes = olx_surface_block_bytes(map);
  unsigned char *blocks = maker->blocks[map];
  uint32_t used = 0;
  memset(maker->known, 0, known_count(n) * sizeof *maker->known);
  for (size_t tile = 0; tile < tile_count(n); tile++) {
    uint32_t *word = &maker->words[map][tile];
    if (!*word) continue;
    const uint32_t equal = find_equal(maker, map, tile, known_count(n)), count = olx_tile_blocks(*word);
    if (equal) {
      *word = equal;
      continue;
    }
    memmove(blocks + (size_t)used * bytes, blocks + tile * BLOCKS * bytes, (size_t)count * bytes);
    *word |= used;
    used += count;
  }
  maker->maps[map] = (olx_tiled_maps){maker->words[map], blocks, used};
}

olx_result olx_surface_maker_encode(olx_surface_maker *maker, const olx_surface_texels *texels, uint32_t n,
                                    uint32_t threads) {
  encoding e = {texels, maker, n};
  OLX_TRY(olx_parallel_for(n / OLX_TILE_SIDE, threads, encode_row, &e, NULL, 0));
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) gather(maker, map, n);
  return OLX_OK;
}

uint64_t olx_surface_maker_bytes(uint32_t n) {
  uint64_t bytes = known_count(n) * sizeof(uint32_t);
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    bytes += tile_count(n) * (sizeof(uint32_t) + BLOCKS * (uint64_t)olx_surface_block_bytes(map));
  }
  return bytes;
}

olx_result olx_surface_maker_create(uint32_t n, olx_surface_maker *maker) {
  *maker = (olx_surface_maker){.known = olx_allocate(known_count(n), sizeof *maker->known)};
  bool complete = maker->known != NULL;
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    maker->words[map] = olx_allocate(tile_count(n), sizeof *maker->words[map]);
    maker->blocks[map] = olx_allocate(tile_count(n) * BLOCKS, olx_surface_block_bytes(map));
    complete &= maker->words[map] && maker->blocks[map];
  }
  if (complete) return OLX_OK;
  olx_surface_maker_free(maker);
  return olx_fail(OLX_ERROR_MEMORY, "out of memory for tiles of %u x %u texels", n, n);
}

void olx_surface_maker_free(olx_surface_maker *maker) {
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    olx_release(maker->words[map]);
    olx_release(maker->blocks[map]);
  }
  olx_release(maker->known);
  *maker = (olx_surface_maker){0};
}
