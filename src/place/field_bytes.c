// Estimates the size of a field's file: samples what depends on the scene by rays, and adds it to the layout that the
// writer will use.
#include "place/field_bytes.h"

#include "block/geometry_encode.h"
#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/octahedral.h"
#include "core/pack.h"
#include "core/parallel.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/brick_data.h"
#include "field/surface_encode.h"
#include "field/texels.h"
#include "field/volume_data.h"
#include "place/space/space_find.h"
#include "scene/bvh.h"
#include "scene/direct_light.h"
#include "scene/emitters.h"

#include <stdlib.h>
#include <string.h>

enum {
  MOST_TILES = 1024,
  SIDE = OLX_EMISSION_TILE,
  TEXELS = OLX_EMISSION_TILE_TEXELS,
  BLOCKS = SIDE / OLX_BLOCK_SIDE, // along a tile
  LIGHT_SAMPLES = 4,              // of direct light a texel, as bakes take by default
  STORED = OLX_SURFACE_INDIRECT,  // kinds of maps of surfaces whose blocks are encoded to know their number
  SALT_TILES = 0x54494C45
};
// The share of tiles whose indirect light takes full resolution, where they show one plane and where they do not;
// measured in rooms. Before a bake it is not known.
#define FULL_SHARE_FLAT 32.0     // divided by the texels along a side of a map,
#define FULL_SHARE_MOST_FLAT 0.6 // and at most this
#define FULL_SHARE_EDGE 0.9
// Indirect light is taken as this share of the brightest direct light in a tile, because errors of direct light are
// weighed relative to all light.
#define INDIRECT_SHARE 0.1f
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
  uint32_t base[TEXELS], direct[TEXELS], indirect[TEXELS];
  uint16_t specular[TEXELS], distance[TEXELS]; // of distances only whether they are infinite
} tile_view;

// The blocks of one kind of a tile, as a key by which equal ones are found.
typedef struct stored_blocks {
  uint64_t hash;
  uint32_t bytes;
} stored_blocks;

typedef struct tile_sampling {
  const olx_planned_maps *maps;
  olx_geometry_settings settings;
  uint64_t tiles; // of all maps
  uint32_t sampled;
  atomic_uint planes, emission_tiles, flat_tiles, edge_tiles;
  stored_blocks *blocks[STORED]; // of each sampled tile
} tile_sampling;

static uint64_t tiles_of_map(const tile_sampling *s) {
  const uint64_t side = s->maps->size / SIDE;
  return side * side;
}

static olx_vec3 position_of(const olx_planned_maps *maps, uint32_t probe) {
  return maps->positions ? maps->positions[probe] : olx_grid_position(maps->grid, probe);
}

// Looks at a texel's material and at the light that reaches it directly.
static void view_surface(const olx_scene *scene, const olx_surface *surface, tile_view *view, uint32_t i) {
  const olx_texel_material_codes codes =
      olx_material_pack(surface->base_color, surface->roughness, surface->metallic, surface->bsdf.dielectric_weight);
  olx_vec3 direct = olx_splat(0.0f);
  uint64_t rays = 0;
  for (uint32_t k = 0; k < LIGHT_SAMPLES; k++) {
    const uint32_t half = i / SIDE / 2 * SIDE + i % SIDE / 2; // texels of a group divide samples among themselves
    olx_sampler sampler = {.seed = olx_hash2(half, SALT_TILES),
                           .index = (i / SIDE % 2 * 2 + i % 2) * LIGHT_SAMPLES + k};
    direct = olx_add(direct, olx_direct_irradiance(scene, surface, &sampler, &rays));
  }
  view->base[i] = codes.base;
  view->specular[i] = codes.specular;
  view->direct[i] = olx_rgb9e5_pack(olx_scale(direct, 1.0f / LIGHT_SAMPLES));
}

static void view_texel(const olx_scene *scene, const olx_ray *ray, const olx_ray_hit *hit, tile_view *view,
                       uint32_t i) {
  if (hit->triangle == OLX_NO_HIT) {
    view->geometry[i] = (olx_geometry_texel){.distance = INFINITY};
    view->emission[i] = olx_rgb9e5_pack(olx_environment_radiance(scene, ray->direction));
    view->distance[i] = 0x7C00u;
    return;
  }
  const olx_surface surface = olx_surface_at(scene, hit, ray->direction);
  view->geometry[i] = (olx_geometry_texel){hit->t, surface.geometric_normal};
  view->emission[i] = olx_rgb9e5_pack(surface.emission);
  view_surface(scene, &surface, view, i);
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
  *view = (tile_view){.base = {0}};
  for (uint32_t i = 0; i < TEXELS; i++) view_texel(s->maps->scene, &rays[i], &hits[i], view, i);
  float most = 0.0f;
  for (uint32_t i = 0; i < TEXELS; i++) most = olx_max(most, olx_max3(olx_rgb9e5_unpack(view->direct[i])));
  for (uint32_t i = 0; i < TEXELS; i++) view->indirect[i] = olx_rgb9e5_pack(olx_splat(INDIRECT_SHARE * most));
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

// Returns whether all texels of a tile lie on one plane, within the precision of half its resolution.
static bool is_flat(const tile_sampling *s, uint64_t tile, const tile_view *view) {
  uint32_t x, y;
  corner_of(s, tile, &x, &y);
  const olx_geometry_texel *first = &view->geometry[0];
  const olx_vec3 corner = olx_scale(olx_texel_direction(x, y, s->maps->size), first->distance);
  for (uint32_t i = 0; i < TEXELS; i++) {
    const olx_geometry_texel *t = &view->geometry[i];
    if (t->distance == INFINITY) return false;
    const olx_vec3 at = olx_scale(olx_texel_direction(x + i % SIDE, y + i / SIDE, s->maps->size), t->distance);
    const float off = fabsf(olx_dot(olx_sub(at, corner), first->normal));
    if (olx_dot(t->normal, first->normal) < 0.98f || off > 4.0f * first->distance / (float)s->maps->size) return false;
  }
  return true;
}

// Notes the blocks that a tile's surfaces take. Returns whether it is not sky alone.
static bool sample_surfaces(tile_sampling *s, uint32_t k, const tile_view *view) {
  const olx_surface_texels texels = {view->base, view->specular, view->direct, view->indirect, view->distance};
  olx_surface_tile tile;
  olx_surface_tile_encode(&texels, SIDE, 0, 0, &tile);
  for (uint32_t map = 0; map < STORED; map++) {
    const uint32_t bytes = tile.count[map] * olx_surface_block_bytes(map);
    s->blocks[map][k] = (stored_blocks){olx_content_hash(tile.blocks[map], bytes), bytes};
  }
  return tile.count[0] != 0;
}

static void sample_tile(void *user, uint32_t k) {
  tile_sampling *s = user;
  const uint64_t tile = tile_of(s, k);
  tile_view view;
  view_tile(s, tile, &view);
  atomic_fetch_add_explicit(&s->planes, planes_in(s, tile, &view), memory_order_relaxed);
  if (is_stored(s, tile, &view)) atomic_fetch_add_explicit(&s->emission_tiles, 1, memory_order_relaxed);
  if (!sample_surfaces(s, k, &view)) return;
  atomic_fetch_add_explicit(is_flat(s, tile, &view) ? &s->flat_tiles : &s->edge_tiles, 1, memory_order_relaxed);
}

static int by_hash(const void *a, const void *b) {
  const stored_blocks *x = a, *y = b;
  if (x->hash != y->hash) return x->hash < y->hash ? -1 : 1;
  return x->bytes < y->bytes ? -1 : x->bytes > y->bytes;
}

// Returns the bytes of blocks that a map's tiles add to its pool, for a sampled tile on average. Where all tiles are
// sampled, these are the different ones. Otherwise the share of new ones among many more tiles is that of the blocks
// that occur once (Good, "The population frequencies of species", Biometrika 1953, equation 9).
static double new_bytes(const tile_sampling *s, stored_blocks *blocks) {
  const bool all = s->tiles == s->sampled;
  double bytes = 0.0;
  qsort(blocks, s->sampled, sizeof *blocks, by_hash);
  for (uint32_t i = 0; i < s->sampled;) {
    uint32_t end = i + 1;
    while (end < s->sampled && by_hash(&blocks[i], &blocks[end]) == 0) end++;
    if (all || end == i + 1) bytes += blocks[i].bytes;
    i = end;
  }
  return bytes / s->sampled;
}

static double surface_bytes(const tile_sampling *s) {
  const double flat = atomic_load(&s->flat_tiles), edge = atomic_load(&s->edge_tiles),
               flat_share = fmin(FULL_SHARE_FLAT / s->maps->size, FULL_SHARE_MOST_FLAT),
               full = flat_share * flat + FULL_SHARE_EDGE * edge;
  double bytes = (flat + edge + 3.0 * full) * sizeof(olx_bc6h_block) / s->sampled;
  for (uint32_t map = 0; map < STORED; map++) bytes += new_bytes(s, s->blocks[map]);
  return bytes / TEXELS;
}

static olx_result sample_all(tile_sampling *s, uint32_t threads, olx_texel_bytes *bytes) {
  OLX_TRY(olx_parallel_for(s->sampled, threads, sample_tile, s, NULL, 0));
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
  stored_blocks *blocks = olx_allocate((size_t)STORED * s.sampled, sizeof *blocks);
  if (!blocks) return olx_fail(OLX_ERROR_MEMORY, "out of memory for %u tiles", s.sampled);
  for (uint32_t map = 0; map < STORED; map++) s.blocks[map] = blocks + (size_t)map * s.sampled;
  const olx_result result = sample_all(&s, threads, bytes);
  olx_release(blocks);
  return result;
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
  const double a_texel = texels->emission + (info->maps.geometry_blocks ? texels->planes : 0.0) +
                         (info->maps.compressed ? texels->surfaces : 0.0);
  return layout.file_bytes +
         (uint64_t)(extra + a_texel * (double)info->probes.count * info->maps.size * info->maps.size);
}
