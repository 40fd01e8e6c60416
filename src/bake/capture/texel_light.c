// Reads the solved light of the scene at what a probe's texels see: at four texels of a block that lies on one plane,
// at every texel elsewhere. Where light has to be gathered, texels near each other on one surface share the result.
#include "bake/capture/texel_light.h"

#include "bake/capture/texel_blocks.h"
#include "core/sampling.h"
#include "scene/bvh.h"

enum {
  SHARED_SHARE = 64,  // texels share gathered light over a map's side divided by this, or less
  MOST_TILE_SIDE = 4, // blocks
  ROOM_RAYS = 32
};
// Texels share gathered light over this part of the harmonic mean distance to what either of them sees, or less: light
// changes over a distance in proportion to that (Ward et al. 1988).
static const float SHARED_ROOM = 0.2f;

typedef struct texel_light {
  const olx_capture *capture;
  const olx_scene_light *light;
  olx_vec3 *irradiance;
  olx_gather_row *rows; // one for each row of blocks; NULL: nothing is kept
} texel_light;

static olx_gather_row *row_of(const texel_light *t, uint32_t block) {
  return t->rows ? &t->rows[block / (t->capture->size / OLX_BLOCK_SIDE)] : NULL;
}

// A texel whose light was gathered. `reach`: how far from it light may be shared, in metres; 0 until that is asked.
typedef struct gathered_texel {
  uint32_t x, y; // in the map
  const olx_surface *surface;
  olx_vec3 irradiance;
  float reach;
} gathered_texel;

// A square of blocks whose texels share gathered light.
typedef struct light_tile {
  olx_block_surfaces blocks[MOST_TILE_SIDE * MOST_TILE_SIDE];
  gathered_texel gathered[MOST_TILE_SIDE * MOST_TILE_SIDE * OLX_BLOCK_TEXELS];
  uint32_t count;
} light_tile;

// Returns how far from a surface point others share its light.
static float reach_of(const texel_light *t, const olx_surface *surface) {
  const olx_vec3 origin =
      olx_madd(olx_add(surface->position, surface->inward), surface->geometric_normal, surface->epsilon);
  olx_ray rays[ROOM_RAYS];
  olx_ray_hit hits[ROOM_RAYS];
  float inverse = 0.0f;
  for (uint32_t i = 0; i < ROOM_RAYS; i++) {
    const olx_vec3 local = olx_sample_cosine(olx_hammersley(i, ROOM_RAYS));
    rays[i] = (olx_ray){origin, olx_from_basis(local, surface->geometric_normal), 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(t->capture->context->scene->light_bvh, rays, ROOM_RAYS, true, hits);
  for (uint32_t i = 0; i < ROOM_RAYS; i++) {
    if (hits[i].triangle != OLX_NO_HIT) inverse += 1.0f / olx_max(hits[i].t, surface->epsilon);
  }
  return SHARED_ROOM * ROOM_RAYS / inverse;
}

static uint32_t difference(uint32_t a, uint32_t b) { return a > b ? a - b : b - a; }

// Returns whether two texels are within reach of each other, by the square of their distance: at the mouth of a gap
// light reaches farther outside than inside.
static bool reach(const texel_light *t, gathered_texel *a, gathered_texel *b, float squared) {
  if (!(a->reach > 0.0f)) a->reach = reach_of(t, a->surface);
  if (squared > olx_square(a->reach)) return false;
  if (!(b->reach > 0.0f)) b->reach = reach_of(t, b->surface);
  return squared <= olx_square(b->reach);
}

// Returns the gathered texel nearest to another of the tile, less than a share of the map's side from it, among those
// that lie on its surface and within reach; NULL when there is none.
static const gathered_texel *find_gathered(const texel_light *t, light_tile *tile, gathered_texel *texel) {
  const uint32_t size = t->capture->size, shared = size / SHARED_SHARE, at = texel->y * size + texel->x;
  const gathered_texel *found = NULL;
  float least = INFINITY;
  for (gathered_texel *g = tile->gathered; g < tile->gathered + tile->count; g++) {
    if (difference(g->x, texel->x) >= shared || difference(g->y, texel->y) >= shared) continue;
    const olx_vec3 way = olx_sub(g->surface->position, texel->surface->position);
    const float squared = olx_dot(way, way);
    if (squared >= least || !olx_texel_shares(t->capture, at, texel->surface, g->surface)) continue;
    if (!reach(t, texel, g, squared)) continue;
    least = squared;
    found = g;
  }
  return found;
}

// Returns the light of a texel of a block.
static olx_vec3 light_of(const texel_light *t, uint32_t block, uint32_t i, const olx_surface *surface,
                         light_tile *tile) {
  const uint32_t at = olx_block_texel(t->capture, block, i), side = t->capture->size;
  gathered_texel texel = {.x = at % side, .y = at / side, .surface = surface};
  if (olx_scene_light_interpolate(t->light, surface, &texel.irradiance)) return texel.irradiance;
  const gathered_texel *found = find_gathered(t, tile, &texel);
  if (found) return found->irradiance;
  texel.irradiance = olx_scene_light_gather(t->light, surface, row_of(t, block));
  tile->gathered[tile->count++] = texel;
  return texel.irradiance;
}

static void interpolate(const texel_light *t, uint32_t block, const olx_surface *surface, light_tile *tile) {
  enum { LAST = OLX_BLOCK_SIDE - 1 };
  const uint32_t texels[4] = {0, LAST, OLX_BLOCK_SIDE * LAST, OLX_BLOCK_TEXELS - 1};
  olx_vec3 corner[4];
  for (uint32_t i = 0; i < 4; i++) corner[i] = light_of(t, block, texels[i], &surface[texels[i]], tile);
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const float x = (float)(i % OLX_BLOCK_SIDE) / (float)LAST, y = (float)(i / OLX_BLOCK_SIDE) / (float)LAST;
    const olx_vec3 top = olx_mix3(corner[0], corner[1], x), bottom = olx_mix3(corner[2], corner[3], x);
    t->irradiance[olx_block_texel(t->capture, block, i)] = olx_mix3(top, bottom, y);
  }
}

// Lights a block. `s` lives as long as the tile.
static void light_block(const texel_light *t, uint32_t block, olx_block_surfaces *s, light_tile *tile) {
  olx_block_look(t->capture, block, s);
  if (olx_block_is_flat(t->capture, block, s)) {
    interpolate(t, block, s->surface, tile);
    return;
  }
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const bool seen = s->seen >> i & 1u;
    t->irradiance[olx_block_texel(t->capture, block, i)] =
        seen ? light_of(t, block, i, &s->surface[i], tile) : olx_splat(0.0f);
  }
}

// Returns the number of blocks along a tile: those over which texels share light.
static uint32_t tile_side(const olx_capture *capture) {
  const uint32_t side = capture->size / SHARED_SHARE / OLX_BLOCK_SIDE;
  return side < 1 ? 1 : side < MOST_TILE_SIDE ? side : MOST_TILE_SIDE;
}

static void light_tile_row(void *user, uint32_t row) {
  const texel_light *t = user;
  const uint32_t blocks = t->capture->size / OLX_BLOCK_SIDE, side = tile_side(t->capture);
  light_tile tile;
  for (uint32_t first = 0; first < blocks; first += side) {
    tile.count = 0;
    for (uint32_t i = 0; i < side * side; i++) {
      light_block(t, (row * side + i / side) * blocks + first + i % side, &tile.blocks[i], &tile);
    }
  }
}

olx_result olx_light_texels(const olx_capture *capture, const olx_scene_light *light, olx_gather_row *rows,
                            olx_vec3 *irradiance) {
  texel_light t = {.capture = capture, .light = light, .irradiance = irradiance, .rows = rows};
  return olx_bake_for(capture->context, capture->size / OLX_BLOCK_SIDE / tile_side(capture), light_tile_row, &t, 0);
}
