// Estimates the size of a field's file: samples what depends on the scene by rays, and adds it to the layout that the
// writer will use.
#include "place/cost/field_bytes.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/brick_data.h"
#include "field/texels.h"
#include "field/volume_data.h"
#include "place/cost/rough_light.h"
#include "place/space/space_box.h"

#include <stdlib.h>
#include <string.h>

enum {
  MOST_TILES = 1024,
  SIDE = OLX_TILE_VIEW_SIDE,
  TEXELS = OLX_TILE_VIEW_TEXELS,
  BLOCKS = SIDE / OLX_BLOCK_SIDE, // along a tile
  SALT_TILES = 0x54494C45
};
// The bake's indirect light takes this many times the bytes of rough light, because it has shadows and noise; measured
// in rooms, where it takes between 0.85 and 1.18 times as many.
#define UNEVEN 1.04
// The irradiance volume takes bytes in proportion to the area of the box around space in faces of its regular cells, and
// to that of the surfaces within it, as far as there may be so many; measured in rooms.
#define VOLUME_FACE_BYTES 255.0
#define VOLUME_WALL_BYTES 250.0
#define VOLUME_BYTES 1000.0
#define VOLUME_MOST_BYTES 6.5e6
#define BRICKS_SHARE 0.75 // of their budget; the size of their cells leaves them between 0.45 and 0.97 of it

// The blocks of one kind of a tile, as a key by which equal ones are found.
typedef struct stored_blocks {
  uint64_t hash;
  uint32_t bytes, probe;
} stored_blocks;

typedef struct tile_sampling {
  const olx_planned_maps *maps;
  olx_geometry_settings settings;
  uint64_t tiles; // of all maps
  uint32_t sampled;
  atomic_uint planes, emission_tiles;
  olx_rough_light light;
  olx_tile_view *views;                    // of each sampled tile
  stored_blocks *blocks[OLX_SURFACE_MAPS]; // of each sampled tile
} tile_sampling;

static uint64_t tiles_of_map(const tile_sampling *s) {
  const uint64_t side = s->maps->size / SIDE;
  return side * side;
}

// Finds a tile's probe and the column and row of its first texel.
static olx_tile_place place_of(const tile_sampling *s, uint64_t tile) {
  const uint32_t i = (uint32_t)(tile % tiles_of_map(s)), along = s->maps->size / SIDE;
  return (olx_tile_place){(uint32_t)(tile / tiles_of_map(s)), i % along * SIDE, i / along * SIDE};
}

static uint32_t planes_in(const tile_sampling *s, uint64_t tile, const olx_tile_view *view) {
  const olx_tile_place at = place_of(s, tile);
  uint32_t planes = 0;
  for (uint32_t block = 0; block < BLOCKS * BLOCKS; block++) {
    const uint32_t bx = block % BLOCKS, by = block / BLOCKS;
    olx_geometry_texel texels[OLX_BLOCK_TEXELS];
    for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
      const uint32_t column = bx * OLX_BLOCK_SIDE + i % OLX_BLOCK_SIDE, row = by * OLX_BLOCK_SIDE + i / OLX_BLOCK_SIDE;
      texels[i] = view->geometry[row * SIDE + column];
    }
    const olx_block_place place = {s->maps->size, at.x / OLX_BLOCK_SIDE + bx, at.y / OLX_BLOCK_SIDE + by};
    planes += olx_geometry_encode(texels, place, &s->settings).pooled;
  }
  return planes;
}

static bool is_dark(const olx_tile_view *view) {
  for (uint32_t i = 0; i < TEXELS; i++) {
    if (view->emission[i]) return false;
  }
  return true;
}

static bool is_even(const olx_tile_view *view) {
  return memcmp(view->emission, view->emission + 1, (TEXELS - 1) * sizeof *view->emission) == 0;
}

// Returns whether the file stores a tile's emission. It stores none for a dark tile, nor for one that equals the tile
// before it, as in an even sky.
static bool is_stored(const tile_sampling *s, uint64_t tile, const olx_tile_view *view) {
  if (is_dark(view)) return false;
  if (tile == 0 || !is_even(view)) return true;
  olx_tile_view before;
  const olx_tile_place place = place_of(s, tile - 1);
  olx_tile_view_make(s->maps, &place, &before);
  return memcmp(before.emission, view->emission, sizeof view->emission) != 0;
}

// Returns the k-th sampled tile: one of each of equal parts of all tiles, or every tile.
static uint64_t tile_of(const tile_sampling *s, uint32_t k) {
  if (s->tiles == s->sampled) return k;
  const double place = (double)k + (double)olx_unit_float(olx_hash2(k, SALT_TILES));
  const uint64_t tile = (uint64_t)(place * (double)s->tiles / (double)s->sampled);
  return tile < s->tiles ? tile : s->tiles - 1;
}

// Notes the blocks that a tile's surfaces take.
static void note_surfaces(tile_sampling *s, uint32_t k, uint32_t probe, const olx_tile_view *view) {
  const olx_surface_texels texels = {view->base, view->specular, view->direct, view->indirect, view->distance};
  olx_surface_tile tile;
  olx_surface_tile_encode(&texels, SIDE, 0, 0, &tile);
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    const uint32_t bytes = tile.count[map] * olx_surface_block_bytes(map);
    s->blocks[map][k] = (stored_blocks){olx_content_hash(tile.blocks[map], bytes), bytes, probe};
  }
}

static void view_sampled(void *user, uint32_t k) {
  tile_sampling *s = user;
  const uint64_t tile = tile_of(s, k);
  const olx_tile_place place = place_of(s, tile);
  olx_tile_view_make(s->maps, &place, &s->views[k]);
  atomic_fetch_add_explicit(&s->planes, planes_in(s, tile, &s->views[k]), memory_order_relaxed);
  if (is_stored(s, tile, &s->views[k])) atomic_fetch_add_explicit(&s->emission_tiles, 1, memory_order_relaxed);
}

static void encode_sampled(void *user, uint32_t k) {
  tile_sampling *s = user;
  const olx_tile_place place = place_of(s, tile_of(s, k));
  olx_rough_light_set(&s->light, s->maps, &place, &s->views[k]);
  note_surfaces(s, k, place.probe, &s->views[k]);
}

static void find_light(tile_sampling *s) {
  const uint32_t step = (s->sampled + OLX_ROUGH_SOURCES - 1) / OLX_ROUGH_SOURCES;
  uint32_t seen = 0;
  for (uint32_t k = 0; k < s->sampled; k += step, seen++) {
    const olx_tile_place place = place_of(s, tile_of(s, k));
    olx_rough_light_add(&s->light, s->maps, &place, &s->views[k]);
  }
  s->light.closed = (float)s->light.count / (float)seen;
  olx_rough_light_solve(&s->light, s->maps->bounces);
}

static int by_hash(const void *a, const void *b) {
  const stored_blocks *x = a, *y = b;
  if (x->hash != y->hash) return x->hash < y->hash ? -1 : 1;
  if (x->bytes != y->bytes) return x->bytes < y->bytes ? -1 : 1;
  return x->probe < y->probe ? -1 : x->probe > y->probe;
}

// Returns the bytes of equal blocks that `count` of the sampled tiles have. A probe stores them once. Where not all of
// its tiles are sampled, they are taken to be spread over all probes alike: blocks that a share p of the tiles has
// occur in a probe of n tiles with the probability 1 - (1 - p)^n. Blocks that one tile has are taken to repeat nowhere.
static double bytes_of_equal(const tile_sampling *s, const stored_blocks *blocks, uint32_t count) {
  const double a_probe = (double)tiles_of_map(s), share = (double)count / s->sampled;
  uint32_t probes = 1;
  for (uint32_t i = 1; i < count; i++) probes += blocks[i].probe != blocks[i - 1].probe;
  if (s->tiles == s->sampled || count == 1) return (double)probes * blocks->bytes;
  return (1.0 - pow(1.0 - share, a_probe)) * blocks->bytes * s->sampled / a_probe;
}

// Returns the bytes of blocks that a map's tiles add to its pool, for a sampled tile on average.
static double new_bytes(const tile_sampling *s, stored_blocks *blocks) {
  double bytes = 0.0;
  qsort(blocks, s->sampled, sizeof *blocks, by_hash);
  for (uint32_t i = 0; i < s->sampled;) {
    uint32_t end = i + 1;
    while (end < s->sampled && blocks[end].hash == blocks[i].hash && blocks[end].bytes == blocks[i].bytes) end++;
    bytes += bytes_of_equal(s, &blocks[i], end - i);
    i = end;
  }
  return bytes / s->sampled;
}

static double surface_bytes(const tile_sampling *s) {
  double bytes = 0.0;
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    const double share = new_bytes(s, s->blocks[map]);
    bytes += map == OLX_SURFACE_INDIRECT ? UNEVEN * share : share;
  }
  return bytes / TEXELS;
}

static olx_result sample_all(tile_sampling *s, uint32_t threads, olx_texel_bytes *bytes) {
  OLX_TRY(olx_parallel_for(s->sampled, threads, view_sampled, s, NULL, 0));
  find_light(s);
  OLX_TRY(olx_parallel_for(s->sampled, threads, encode_sampled, s, NULL, 0));
  const double texels = (double)s->sampled * TEXELS;
  bytes->planes = (double)atomic_load(&s->planes) * sizeof(olx_plane_code) / texels;
  bytes->emission = (double)atomic_load(&s->emission_tiles) * sizeof(uint32_t) * TEXELS / texels;
  bytes->surfaces = surface_bytes(s);
  return OLX_OK;
}

olx_result olx_texel_bytes_sample(const olx_planned_maps *maps, uint32_t threads, olx_texel_bytes *bytes) {
  tile_sampling s = {.maps = maps, .settings = olx_geometry_settings_default()};
  s.tiles = maps->count * tiles_of_map(&s);
  s.sampled = s.tiles < MOST_TILES ? (uint32_t)s.tiles : MOST_TILES;
  stored_blocks *blocks = olx_allocate((size_t)OLX_SURFACE_MAPS * s.sampled, sizeof *blocks);
  s.views = olx_allocate(s.sampled, sizeof *s.views);
  olx_result result = OLX_OK;
  if (!blocks || !s.views) {
    result = olx_fail(OLX_ERROR_MEMORY, "out of memory for %u tiles", s.sampled);
  } else {
    for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) s.blocks[map] = blocks + (size_t)map * s.sampled;
    result = sample_all(&s, threads, bytes);
  }
  olx_release(blocks);
  olx_release(s.views);
  return result;
}

static double area_of(const olx_scene *scene) {
  double area = 0.0;
  for (uint32_t i = 0; i < scene->triangle_count; i++) {
    const uint32_t *corner = scene->indices + 3 * (size_t)i;
    const olx_vec3 a = scene->positions[corner[0]], b = scene->positions[corner[1]], c = scene->positions[corner[2]];
    area += 0.5 * (double)olx_length(olx_cross(olx_sub(b, a), olx_sub(c, a)));
  }
  return area;
}

double olx_expected_volume_bytes(const olx_scene *scene, uint32_t map_size, uint32_t most_cells) {
  olx_box box;
  if (most_cells == 0 || olx_space_box(scene, &box) != OLX_OK) return 0.0;
  const olx_vec3 side = olx_sub(box.max, box.min);
  const float cell = olx_volume_least_metres(olx_max3(side), olx_volume_cells_along(map_size, most_cells));
  const double faces = 2.0 * (double)(side.x * side.y + side.y * side.z + side.z * side.x),
               walls = fmin(fmax(area_of(scene) - faces, 0.0), faces), face = (double)cell * (double)cell;
  return fmin(VOLUME_BYTES + (VOLUME_FACE_BYTES * faces + VOLUME_WALL_BYTES * walls) / face, VOLUME_MOST_BYTES);
}

uint64_t olx_expected_bytes(const olx_field_header *header, double volume_bytes, const olx_texel_bytes *texels) {
  const olx_field_info *info = &header->info;
  const uint64_t maps = olx_light_field_map_bytes(info->probes.count, info->maps.size);
  olx_field_layout layout;
  olx_field_lay_out(header, &layout);
  double extra = volume_bytes;
  const bool lists_differ = info->probes.count > 1;
  if (lists_differ && info->select_mask & 1u << OLX_SELECT_BRICKS)
    extra += BRICKS_SHARE * (double)olx_bricks_budget(maps);
  const double a_texel = texels->emission + (info->maps.geometry_blocks ? texels->planes : 0.0) +
                         (info->maps.compressed ? texels->surfaces : 0.0);
  return layout.file_bytes +
         (uint64_t)(extra + a_texel * (double)info->probes.count * info->maps.size * info->maps.size);
}
