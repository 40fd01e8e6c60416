// Lights the texels of light field maps, tile by tile: samples direct light at each, and interpolates indirect light
// from the surfels to which the bake linked it.
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/field_file.h"
#include "field/texels.h"
#include "shade/relighter_schedule.h"

#include <string.h>

enum { SALT_TEXEL = 0x5445584C, LIGHT_SIDE = 4, TILE_SAMPLES = 4 };

// How far rays start from a surface, as a share of its distance: that distance is a half float with an error of up to
// half a unit in the last place.
static const float OFF_SURFACE = 0x1p-10f;

// Computes the weights of a block's corners for a texel.
static void site_corners(uint32_t column, uint32_t row, float corner[4]) {
  enum { LAST = OLX_RELIGHT_BLOCK - 1 };
  const float x = (float)column / (float)LAST, y = (float)row / (float)LAST;
  corner[0] = (1.0f - x) * (1.0f - y);
  corner[1] = x * (1.0f - y);
  corner[2] = (1.0f - x) * y;
  corner[3] = x * y;
}

static olx_vec3 told_by(const olx_relight *r, uint32_t site, uint32_t column, uint32_t row, const olx_vec3 *light) {
  const olx_relight_data *d = &r->source->relight;
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

olx_vec3 olx_relit_told(const olx_relight *r, uint32_t probe, uint32_t x, uint32_t y) {
  const uint32_t side = r->field.n / OLX_RELIGHT_BLOCK, column = x % OLX_RELIGHT_BLOCK, row = y % OLX_RELIGHT_BLOCK;
  const size_t at = (size_t)side * side * probe + (size_t)(y / OLX_RELIGHT_BLOCK) * side + x / OLX_RELIGHT_BLOCK;
  const olx_relight_block *block = &r->source->relight.blocks[at];
  if (block->first_site == OLX_RELIGHT_NO_SITE) return olx_splat(0.0f);
  const uint32_t which = block->which >> 2 * (row * OLX_RELIGHT_BLOCK + column) & 3u;
  return told_by(r, block->first_site + which, column, row, r->irradiance);
}

static bool is_surface(const olx_field *f, uint32_t probe, size_t texel) {
  return !olx_texel_is_sky(f, probe, texel);
}

// ---- Creation

// Computes the mean distance and direction of what a few texels of a tile see.
static void look(const olx_relight *r, olx_relit_tile *tile) {
  const olx_field *f = r->source;
  olx_vec3 sum = {0};
  float distance = 0.0f, count = 0.0f;
  for (uint32_t i = 0; i < TILE_SAMPLES * TILE_SAMPLES; i++) {
    const uint32_t step = r->tile_side / TILE_SAMPLES, x = tile->first_x + i % TILE_SAMPLES * step,
                   y = tile->first_y + i / TILE_SAMPLES * step;
    const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
    if (!is_surface(f, tile->probe, texel)) continue;
    const olx_vec3 direction = olx_texel_direction(x, y, f->n);
    sum = olx_add(sum, direction);
    distance += olx_texel_distance(f, tile->probe, texel);
    count += 1.0f;
  }
  tile->direction = olx_length(sum) > 0.0f ? olx_normalize(sum) : olx_v3(0.0f, 1.0f, 0.0f);
  tile->distance = count > 0.0f ? distance / count : r->near_metres; // other texels may still see a surface
}

static void make_tiles(olx_relight *r) {
  const uint32_t a_side = r->field.n / r->tile_side;
  for (uint32_t i = 0; i < r->tile_count; i++) {
    olx_relit_tile *tile = &r->tiles[i];
    const uint32_t at = i % r->tiles_a_probe;
    *tile = (olx_relit_tile){.probe = i / r->tiles_a_probe,
                             .first_x = at % a_side * r->tile_side,
                             .first_y = at / a_side * r->tile_side,
                             .rounds = UINT32_MAX};
    if (!(r->source->probe_flags[tile->probe] & OLX_PROBE_BURIED)) look(r, tile);
  }
}

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

olx_result olx_relit_texels_create(olx_relight *r) {
  const olx_field *f = r->source;
  const size_t texels = f->texels * f->info.probes.count;
  r->tile_side = f->n < OLX_RELIT_TILE_SIDE ? f->n : OLX_RELIT_TILE_SIDE;
  r->tiles_a_probe = (f->n / r->tile_side) * (f->n / r->tile_side);
  r->tile_count = r->tiles_a_probe * f->info.probes.count;
  r->direct_map = olx_allocate(texels, sizeof *r->direct_map);
  r->indirect_map = olx_allocate(texels, sizeof *r->indirect_map);
  r->tiles = olx_allocate(r->tile_count, sizeof *r->tiles);
  r->scheduled = olx_allocate(r->tile_count, sizeof *r->scheduled);
  r->lit = olx_allocate(r->tile_count, sizeof *r->lit);
  r->due = olx_allocate(r->tile_count, sizeof *r->due);
  r->part_frames = olx_allocate_zero((size_t)f->info.probes.count * (r->tiles_a_probe + 1), sizeof *r->part_frames);
  if (!r->direct_map || !r->indirect_map || !r->tiles || !r->scheduled || !r->lit || !r->due || !r->part_frames) {
    return olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for %u light field maps", f->info.probes.count);
  }
  keep_map(f, OLX_SURFACE_DIRECT, f->surfaces.direct, r->direct_map);
  keep_map(f, OLX_SURFACE_INDIRECT, f->surfaces.indirect, r->indirect_map);
  r->field.surfaces.direct = r->direct_map;
  r->field.surfaces.indirect = r->indirect_map;
  make_tiles(r);
  return OLX_OK;
}

void olx_relit_texels_free(olx_relight *r) {
  olx_release(r->direct_map);
  olx_release(r->indirect_map);
  olx_release(r->tiles);
  olx_release(r->scheduled);
  olx_release(r->lit);
  olx_release(r->due);
  olx_release(r->part_frames);
}

// ---- A tile

// Returns texel i of a tile in the order of its blocks of LIGHT_SIDE x LIGHT_SIDE texels, which share samples of
// lights.
static void tile_texel(const olx_relight *r, const olx_relit_tile *tile, uint32_t i, uint32_t *x, uint32_t *y) {
  const uint32_t in_block = i % (LIGHT_SIDE * LIGHT_SIDE), block = i / (LIGHT_SIDE * LIGHT_SIDE),
                 blocks = r->tile_side / LIGHT_SIDE;
  *x = tile->first_x + block % blocks * LIGHT_SIDE + in_block % LIGHT_SIDE;
  *y = tile->first_y + block / blocks * LIGHT_SIDE + in_block / LIGHT_SIDE;
}

static void light_texels(olx_relight *r, const olx_relit_tile *tile, uint32_t first, uint32_t end) {
  const olx_field *f = r->source;
  olx_relit_batch batch = {.count = 0};
  for (uint32_t i = first; i < end; i++) {
    uint32_t x, y;
    tile_texel(r, tile, i, &x, &y);
    const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
    if (!is_surface(f, tile->probe, texel)) continue;
    const olx_texel_geometry seen = olx_texel_geometry_of(f, tile->probe, texel);
    const olx_vec3 normal = seen.normal;
    const float distance = seen.distance;
    const olx_vec3 place = olx_madd(f->probe_positions[tile->probe], olx_texel_direction(x, y, f->n), distance);
    const uint32_t k = batch.count++;
    batch.position[k] = olx_madd(place, normal, OFF_SURFACE * distance);
    batch.normal[k] = normal;
    batch.seed[k] = olx_hash3(tile->probe, (tile->first_y * f->n + tile->first_x) * f->n + i / 16, SALT_TEXEL);
    batch.sequence[k] = i % 16 + 16 * tile->rounds;
    batch.slot[k] = (uint32_t)texel;
  }
  olx_relit_direct(r, &batch);
  for (uint32_t k = 0; k < batch.count; k++) {
    uint32_t *light = &r->direct_map[f->texels * tile->probe + batch.slot[k]];
    *light =
        olx_rgb9e5_pack(olx_mix3(olx_rgb9e5_unpack(*light), batch.irradiance[k], 1.0f / (float)(tile->rounds + 1)));
  }
}

static void tell_texels(olx_relight *r, const olx_relit_tile *tile) {
  const olx_field *f = r->source;
  for (uint32_t y = tile->first_y; y < tile->first_y + r->tile_side; y++) {
    for (uint32_t x = tile->first_x; x < tile->first_x + r->tile_side; x++) {
      const size_t texel = olx_map_index(f->stride, (int32_t)x, (int32_t)y);
      if (!is_surface(f, tile->probe, texel)) continue;
      r->indirect_map[f->texels * tile->probe + texel] = olx_rgb9e5_pack(olx_relit_told(r, tile->probe, x, y));
    }
  }
}

static void light_tile(void *user, uint32_t job) {
  olx_relight *r = user;
  const olx_relit_tile *tile = &r->tiles[r->scheduled[job]];
  const uint32_t texels = r->tile_side * r->tile_side;
  for (uint32_t first = 0; r->lit[job] && first < texels; first += OLX_RELIT_BATCH) {
    light_texels(r, tile, first, first + OLX_RELIT_BATCH < texels ? first + OLX_RELIT_BATCH : texels);
  }
  tell_texels(r, tile);
}

// Copies the map's edge texels in this tile to the border texels that repeat them.
static void copy_border(olx_relight *r, const olx_relit_tile *tile) {
  const olx_field *f = r->source;
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
    if ((uint32_t)from_x - tile->first_x >= r->tile_side || (uint32_t)from_y - tile->first_y >= r->tile_side) continue;
    const size_t to = map + olx_map_index(f->stride, x, y), from = map + olx_map_index(f->stride, from_x, from_y);
    r->direct_map[to] = r->direct_map[from];
    r->indirect_map[to] = r->indirect_map[from];
  }
}

static bool on_edge(const olx_relight *r, const olx_relit_tile *tile) {
  return tile->first_x == 0 || tile->first_y == 0 || tile->first_x + r->tile_side == r->field.n ||
         tile->first_y + r->tile_side == r->field.n;
}

void olx_relit_tiles_lit(olx_relight *r) {
  for (uint32_t i = 0; i < r->scheduled_count; i++) {
    const uint32_t number = r->scheduled[i];
    olx_relit_tile *tile = &r->tiles[number];
    uint32_t *parts = r->part_frames + (size_t)tile->probe * (r->tiles_a_probe + 1);
    tile->rounds += r->lit[i];
    tile->solution = r->solution;
    tile->last_frame = r->frame;
    parts[number % r->tiles_a_probe] = r->frame;
    if (on_edge(r, tile)) parts[r->tiles_a_probe] = r->frame;
  }
}

void olx_relit_light_tiles(olx_relight *r) {
  if (r->scheduled_count == 0) return;
  olx_parallel_for(r->scheduled_count, r->settings.threads, light_tile, r, NULL, 0);
  for (uint32_t i = 0; i < r->scheduled_count; i++) {
    const olx_relit_tile *tile = &r->tiles[r->scheduled[i]];
    if (on_edge(r, tile)) copy_border(r, tile);
  }
  olx_relit_tiles_lit(r);
}
