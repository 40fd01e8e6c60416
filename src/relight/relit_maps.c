// Lights the texels of light field maps, tile by tile: samples direct light at each, and interpolates indirect light
// from the surfels to which the bake linked it.
#include "relight/relit_maps.h"

#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/field_file.h"
#include "field/texels.h"

#include <string.h>

enum { LIT_TEXELS = OLX_LIT_SIDE * OLX_LIT_SIDE }; // of a block whose samples of lights are stratified together

// Computes the weights of a block's corners for a texel.
static void site_corners(uint32_t column, uint32_t row, float corner[4]) {
  enum { LAST = OLX_RELIGHT_BLOCK - 1 };
  const float x = (float)column / (float)LAST, y = (float)row / (float)LAST;
  corner[0] = (1.0f - x) * (1.0f - y);
  corner[1] = x * (1.0f - y);
  corner[2] = (1.0f - x) * y;
  corner[3] = x * y;
}

static olx_vec3 told_by(const olx_relight_data *d, uint32_t site, uint32_t column, uint32_t row,
                        const olx_vec3 *light) {
  float corner[4];
  site_corners(column, row, corner);
  olx_vec3 sum = {0};
  for (uint32_t i = d->entry_starts[site]; i < d->entry_starts[site + 1]; i++) {
    const uint8_t *w = d->entries[i].weights;
    const float weight =
        corner[0] * (float)w[0] + corner[1] * (float)w[1] + corner[2] * (float)w[2] + corner[3] * (float)w[3];
    sum = olx_madd(sum, light[d->entries[i].surfel], weight * (1.0f / 255.0f));
  }
  return sum;
}

// Returns the indirect irradiance of a texel, interpolated from that of the surfels of its site, W/m^2.
static olx_vec3 interpolated(const olx_field *f, const olx_vec3 *surfels, uint32_t probe, uint32_t x, uint32_t y) {
  const uint32_t side = f->n / OLX_RELIGHT_BLOCK, column = x % OLX_RELIGHT_BLOCK, row = y % OLX_RELIGHT_BLOCK;
  const size_t at = (size_t)side * side * probe + (size_t)(y / OLX_RELIGHT_BLOCK) * side + x / OLX_RELIGHT_BLOCK;
  const olx_relight_block *block = &f->relight.blocks[at];
  if (block->first_site == OLX_RELIGHT_NO_SITE) return olx_splat(0.0f);
  const uint32_t which = block->which >> 2 * (row * OLX_RELIGHT_BLOCK + column) & 3u;
  return told_by(&f->relight, block->first_site + which, column, row, surfels);
}

// ---- Creation

// Copies baked light into a map of texels, from texels or blocks, because relit maps are always texels.
static void keep_map(const olx_field *f, olx_surface_map map, const uint32_t *texels, uint32_t *kept) {
  const size_t count = f->texels * f->info.probes.count;
  if (texels) {
    memcpy(kept, texels, count * sizeof *kept);
    return;
  }
  for (uint32_t i = 0; i < f->info.probes.count * f->stride; i++) {
    olx_surface_row(f, map, i / f->stride, i % f->stride, kept + (size_t)i * f->stride);
  }
}

olx_result olx_relit_maps_create(const olx_field *f, olx_relit_maps *maps) {
  const size_t texels = f->texels * f->info.probes.count;
  *maps = (olx_relit_maps){.source = f,
                           .direct = olx_allocate(texels, sizeof *maps->direct),
                           .indirect = olx_allocate(texels, sizeof *maps->indirect)};
  if (!maps->direct || !maps->indirect) {
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u light field maps", f->info.probes.count);
  }
  keep_map(f, OLX_SURFACE_DIRECT, f->surfaces.direct, maps->direct);
  keep_map(f, OLX_SURFACE_INDIRECT, f->surfaces.indirect, maps->indirect);
  return OLX_OK;
}

void olx_relit_maps_free(olx_relit_maps *maps) {
  olx_release(maps->direct);
  olx_release(maps->indirect);
}

// ---- A tile

// Returns texel i of a tile in the order of its blocks of LIT_TEXELS, which share samples of lights.
static void tile_texel(uint32_t side, const olx_relit_tile *tile, uint32_t i, uint32_t *x, uint32_t *y) {
  const uint32_t in_block = i % LIT_TEXELS, block = i / LIT_TEXELS, blocks = side / OLX_LIT_SIDE;
  *x = tile->first_x + block % blocks * OLX_LIT_SIDE + in_block % OLX_LIT_SIDE;
  *y = tile->first_y + block / blocks * OLX_LIT_SIDE + in_block / OLX_LIT_SIDE;
}

// The tiles of a frame, and where their light comes from.
typedef struct tile_job {
  olx_relit_maps *maps;
  olx_relit_direct *direct;
  const olx_vec3 *surfels;
  const olx_relit_tile_turns *turns;
} tile_job;

static void light_texels(const tile_job *j, const olx_relit_tile *tile, uint32_t first, uint32_t end) {
  const olx_field *f = j->maps->source;
  olx_relit_batch batch = {.count = 0};
  for (uint32_t i = first; i < end; i++) {
    uint32_t x, y;
    tile_texel(j->turns->side, tile, i, &x, &y);
    const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
    if (olx_texel_is_sky(f, tile->probe, texel)) continue;
    const olx_texel_geometry seen = olx_texel_geometry_of(f, tile->probe, texel);
    const olx_vec3 normal = seen.normal;
    const float distance = seen.distance;
    const olx_vec3 place = olx_madd(f->probe_positions[tile->probe], olx_texel_direction(x, y, f->n), distance);
    const uint32_t k = batch.count++;
    batch.position[k] = olx_madd(place, normal, OLX_OFF_SURFACE * distance);
    batch.normal[k] = normal;
    batch.seed[k] =
        olx_hash3(tile->probe, (tile->first_y * f->n + tile->first_x) * f->n + i / LIT_TEXELS, OLX_SALT_TEXEL);
    batch.sequence[k] = i % LIT_TEXELS + LIT_TEXELS * tile->rounds;
    batch.slot[k] = (uint32_t)texel;
  }
  olx_relit_light(j->direct, &batch);
  for (uint32_t k = 0; k < batch.count; k++) {
    uint32_t *light = &j->maps->direct[f->texels * tile->probe + batch.slot[k]];
    *light =
        olx_rgb9e5_pack(olx_mix3(olx_rgb9e5_unpack(*light), batch.irradiance[k], 1.0f / (float)(tile->rounds + 1)));
  }
}

static void tell_texels(const tile_job *j, const olx_relit_tile *tile) {
  const olx_field *f = j->maps->source;
  for (uint32_t y = tile->first_y; y < tile->first_y + j->turns->side; y++) {
    for (uint32_t x = tile->first_x; x < tile->first_x + j->turns->side; x++) {
      const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
      if (olx_texel_is_sky(f, tile->probe, texel)) continue;
      j->maps->indirect[f->texels * tile->probe + texel] =
          olx_rgb9e5_pack(interpolated(f, j->surfels, tile->probe, x, y));
    }
  }
}

static void light_tile(void *user, uint32_t job) {
  const tile_job *j = user;
  const olx_relit_tile *tile = &j->turns->tiles[job];
  const uint32_t texels = j->turns->side * j->turns->side;
  for (uint32_t first = 0; job < j->turns->lit && first < texels; first += OLX_RELIT_BATCH) {
    light_texels(j, tile, first, first + OLX_RELIT_BATCH < texels ? first + OLX_RELIT_BATCH : texels);
  }
  tell_texels(j, tile);
}

// Copies the map's edge texels in this tile to the border texels that repeat them.
static void copy_border(olx_relit_maps *maps, const olx_relit_tile *tile, uint32_t tile_side) {
  const olx_field *f = maps->source;
  const int32_t n = (int32_t)f->n;
  const size_t map = f->texels * tile->probe;
  for (int32_t i = 0; i < 4 * (n + 1); i++) {
    const int32_t along = i % (n + 1) - 1, side = i / (n + 1);
    const int32_t x = side == 0   ? along
                      : side == 1 ? n
                      : side == 2 ? along + 1
                                  : -1,
                  y = side == 0   ? -1
                      : side == 1 ? along
                      : side == 2 ? n
                                  : along + 1;
    int32_t from_x, from_y;
    olx_border_source(x, y, n, &from_x, &from_y);
    if ((uint32_t)from_x - tile->first_x >= tile_side || (uint32_t)from_y - tile->first_y >= tile_side) continue;
    const size_t to = map + olx_map_index(f->stride, x, y), from = map + olx_map_index(f->stride, from_x, from_y);
    maps->direct[to] = maps->direct[from];
    maps->indirect[to] = maps->indirect[from];
  }
}

void olx_relit_light_tiles(olx_relit_maps *maps, olx_relit_direct *direct, const olx_vec3 *surfels,
                           const olx_relit_tile_turns *turns) {
  tile_job j = {maps, direct, surfels, turns};
  if (turns->count == 0) return;
  olx_parallel_for(turns->count, direct->lights->settings->threads, light_tile, &j, NULL, 0);
  for (uint32_t i = 0; i < turns->count; i++) {
    const olx_relit_tile *tile = &turns->tiles[i];
    if (olx_relit_on_edge(tile, turns->side, maps->source->n)) copy_border(maps, tile, turns->side);
  }
}
