// Estimates the size of a field's file: samples what depends on the scene by rays, and adds it to the layout that the
// writer will use.
#include "place/field_bytes.h"

#include "block/geometry_encode.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/brick_data.h"
#include "field/volume_data.h"
#include "place/space_find.h"
#include "scene/bvh.h"
#include "scene/emitters.h"

#include <string.h>

enum {
  MOST_TILES = 1024,
  SIDE = OLX_EMISSION_TILE,
  TEXELS = OLX_EMISSION_TILE_TEXELS,
  BLOCKS = SIDE / OLX_BLOCK_SIDE, // along a tile
  SALT_TILES = 0x54494C45
};
// The irradiance volume takes bytes in proportion to the area of space in faces of its smallest cells, as far as there
// may be so many; measured in rooms.
#define VOLUME_FACE_BYTES 210.0
#define VOLUME_BYTES 1000.0
#define VOLUME_MOST_BYTES 6.5e6
#define BRICKS_SHARE 0.68 // of their budget; the size of their cells leaves them between 0.45 and 0.9 of it

// The geometry and the emission of a tile's texels, row by row.
typedef struct tile_view {
  olx_geometry_texel geometry[TEXELS];
  uint32_t emission[TEXELS]; // as codes
} tile_view;

typedef struct tile_sampling {
  const olx_planned_maps *maps;
  olx_geometry_settings settings;
  uint64_t tiles; // of all maps
  uint32_t sampled;
  atomic_uint planes, emission_tiles;
} tile_sampling;

static uint64_t tiles_of_map(const tile_sampling *s) {
  const uint64_t side = s->maps->size / SIDE;
  return side * side;
}

static olx_vec3 position_of(const olx_planned_maps *maps, uint32_t probe) {
  return maps->positions ? maps->positions[probe] : olx_grid_position(maps->grid, probe);
}

static void view_texel(const olx_scene *scene, const olx_ray *ray, const olx_ray_hit *hit, tile_view *view,
                       uint32_t i) {
  if (hit->triangle == OLX_NO_HIT) {
    view->geometry[i] = (olx_geometry_texel){.distance = INFINITY};
    view->emission[i] = olx_rgb9e5_pack(olx_environment_radiance(scene, ray->direction));
    return;
  }
  const olx_surface surface = olx_surface_at(scene, hit, ray->direction);
  view->geometry[i] = (olx_geometry_texel){hit->t, surface.geometric_normal};
  view->emission[i] = olx_rgb9e5_pack(surface.emission);
}

// Finds the column and the row of a tile's first texel in its map.
static void corner_of(const tile_sampling *s, uint64_t tile, uint32_t *x, uint32_t *y) {
  const uint32_t i = (uint32_t)(tile % tiles_of_map(s)), along = s->maps->size / SIDE;
  *x = i % along * SIDE;
  *y = i / along * SIDE;
}

static void view_tile(const tile_sampling *s, uint64_t tile, tile_view *view) {
  const olx_vec3 position = position_of(s->maps, (uint32_t)(tile / tiles_of_map(s)));
  uint32_t x, y;
  corner_of(s, tile, &x, &y);
  olx_ray rays[TEXELS];
  olx_ray_hit hits[TEXELS];
  for (uint32_t i = 0; i < TEXELS; i++) {
    rays[i] = (olx_ray){position, olx_texel_direction(x + i % SIDE, y + i / SIDE, s->maps->size), 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(s->maps->scene->bvh, rays, TEXELS, true, hits);
  for (uint32_t i = 0; i < TEXELS; i++) view_texel(s->maps->scene, &rays[i], &hits[i], view, i);
}

static uint32_t planes_in(const tile_sampling *s, uint64_t tile, const tile_view *view) {
  uint32_t planes = 0, x, y;
  corner_of(s, tile, &x, &y);
  for (uint32_t block = 0; block < BLOCKS * BLOCKS; block++) {
    const uint32_t bx = block % BLOCKS, by = block / BLOCKS;
    olx_geometry_texel texels[OLX_BLOCK_TEXELS];
    for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
      const uint32_t column = bx * OLX_BLOCK_SIDE + i % OLX_BLOCK_SIDE, row = by * OLX_BLOCK_SIDE + i / OLX_BLOCK_SIDE;
      texels[i] = view->geometry[row * SIDE + column];
    }
    const olx_block_place place = {s->maps->size, x / OLX_BLOCK_SIDE + bx, y / OLX_BLOCK_SIDE + by};
    planes += olx_geometry_encode(texels, place, &s->settings).pooled;
  }
  return planes;
}

static bool is_dark(const tile_view *view) {
  for (uint32_t i = 0; i < TEXELS; i++) {
    if (view->emission[i]) return false;
  }
  return true;
}

static bool is_even(const tile_view *view) {
  return memcmp(view->emission, view->emission + 1, (TEXELS - 1) * sizeof *view->emission) == 0;
}

// Returns whether the file stores a tile's emission. It stores none for a dark tile, nor for one that equals the tile
// before it, as in an even sky.
static bool is_stored(const tile_sampling *s, uint64_t tile, const tile_view *view) {
  if (is_dark(view)) return false;
  if (tile == 0 || !is_even(view)) return true;
  tile_view before;
  view_tile(s, tile - 1, &before);
  return memcmp(before.emission, view->emission, sizeof view->emission) != 0;
}

// Returns the k-th sampled tile: one of each of equal parts of all tiles, or every tile.
static uint64_t tile_of(const tile_sampling *s, uint32_t k) {
  if (s->tiles == s->sampled) return k;
  const double place = (double)k + (double)olx_unit_float(olx_hash2(k, SALT_TILES));
  const uint64_t tile = (uint64_t)(place * (double)s->tiles / (double)s->sampled);
  return tile < s->tiles ? tile : s->tiles - 1;
}

static void sample_tile(void *user, uint32_t k) {
  tile_sampling *s = user;
  const uint64_t tile = tile_of(s, k);
  tile_view view;
  view_tile(s, tile, &view);
  atomic_fetch_add_explicit(&s->planes, planes_in(s, tile, &view), memory_order_relaxed);
  if (is_stored(s, tile, &view)) atomic_fetch_add_explicit(&s->emission_tiles, 1, memory_order_relaxed);
}

olx_result olx_texel_bytes_sample(const olx_planned_maps *maps, uint32_t threads, olx_texel_bytes *bytes) {
  tile_sampling s = {.maps = maps, .settings = olx_geometry_settings_default()};
  s.tiles = maps->count * tiles_of_map(&s);
  s.sampled = s.tiles < MOST_TILES ? (uint32_t)s.tiles : MOST_TILES;
  OLX_TRY(olx_parallel_for(s.sampled, threads, sample_tile, &s, NULL, 0));
  const double texels = (double)s.sampled * TEXELS;
  bytes->planes = (double)atomic_load(&s.planes) * sizeof(olx_plane_code) / texels;
  bytes->emission = (double)atomic_load(&s.emission_tiles) * sizeof(uint32_t) * TEXELS / texels;
  return OLX_OK;
}

double olx_expected_volume_bytes(const olx_scene *scene, uint32_t map_size, uint32_t most_cells) {
  olx_box box;
  if (most_cells == 0 || olx_space_box(scene, &box) != OLX_OK) return 0.0;
  const olx_vec3 side = olx_sub(box.max, box.min);
  const float cell = olx_volume_least_metres(olx_max3(side), olx_volume_cells_along(map_size, most_cells));
  const float area = 2.0f * (side.x * side.y + side.y * side.z + side.z * side.x);
  return fmin(VOLUME_BYTES + VOLUME_FACE_BYTES * (double)(area / (cell * cell)), VOLUME_MOST_BYTES);
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
  const double a_texel = texels->emission + (info->maps.geometry_blocks ? texels->planes : 0.0);
  return layout.file_bytes +
         (uint64_t)(extra + a_texel * (double)info->probes.count * info->maps.size * info->maps.size);
}
