// Reads the solved light of the scene at what a probe's texels see: at four texels of a block that lies on one plane,
// at every texel elsewhere. Gathered light is interpolated between texels that have gathered about the same.
#include "bake/capture/texel_light.h"

#include "bake/capture/texel_blocks.h"
#include "core/sampling.h"
#include "scene/bvh.h"

#include <float.h>

enum {
  SHARED_SHARE = 64,  // texels share gathered light over a map's side divided by this, or less
  MOST_TILE_SIDE = 4, // blocks
  ROOM_RAYS = 32,
  QUADRANTS = 4,
  LAST = OLX_BLOCK_SIDE - 1,
  NEXT = 2 // how far a texel may lie from another whose light it takes, unless it lies between two
};
// The corners of a block.
#define CORNERS (1u | 1u << LAST | 1u << OLX_BLOCK_SIDE * LAST | 1u << (OLX_BLOCK_TEXELS - 1))

// Texels share gathered light over this part of the harmonic mean distance to what either of them sees, or less: light
// changes over a distance in proportion to that (Ward et al. 1988).
static const float SHARED_ROOM = 0.2f;
// Light is interpolated between texels whose light differs by at most this share of it, or this multiple of the
// standard error that is expected of them.
static const float ALIKE = 0.25f, ALIKE_ERRORS = 1.5f;

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
  olx_gathered_light light;
  float reach;
} gathered_texel;

// A square of blocks whose texels share gathered light.
typedef struct light_tile {
  uint32_t block, side; // its first block, and the blocks along its side
  olx_block_surfaces blocks[MOST_TILE_SIDE * MOST_TILE_SIDE];
  uint32_t wanted[MOST_TILE_SIDE * MOST_TILE_SIDE]; // bit i: the light of texel i of a block is read
  gathered_texel gathered[MOST_TILE_SIDE * MOST_TILE_SIDE * OLX_BLOCK_TEXELS];
  uint32_t count;
} light_tile;

// Returns the number of the k-th block of a tile in the map.
static uint32_t block_of(const texel_light *t, const light_tile *tile, uint32_t k) {
  return tile->block + k / tile->side * (t->capture->size / OLX_BLOCK_SIDE) + k % tile->side;
}

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

// The gathered texels nearest to another in each quadrant of the map around it, and the squares of their distances.
typedef struct texels_around {
  const gathered_texel *nearest[QUADRANTS];
  float squared[QUADRANTS];
} texels_around;

// Finds the gathered texels around another, less than a share of the map's side from it, among those that lie on its
// surface and within reach.
static texels_around find_around(const texel_light *t, light_tile *tile, gathered_texel *texel) {
  const uint32_t size = t->capture->size, shared = size / SHARED_SHARE, at = texel->y * size + texel->x;
  texels_around around = {.nearest = {NULL}};
  for (gathered_texel *g = tile->gathered; g < tile->gathered + tile->count; g++) {
    if (difference(g->x, texel->x) >= shared || difference(g->y, texel->y) >= shared) continue;
    const uint32_t quadrant = (g->x > texel->x) + 2 * (g->y > texel->y);
    const olx_vec3 way = olx_sub(g->surface->position, texel->surface->position);
    const float squared = olx_dot(way, way);
    if (around.nearest[quadrant] && squared >= around.squared[quadrant]) continue;
    if (!olx_texel_shares(t->capture, at, texel->surface, g->surface)) continue;
    if (!reach(t, texel, g, squared)) continue;
    around.nearest[quadrant] = g;
    around.squared[quadrant] = squared;
  }
  return around;
}

// Returns whether a texel lies between those around it, or no farther from one than it takes light of a single one.
static bool is_served(const texels_around *around, const gathered_texel *texel) {
  for (uint32_t i = 0; i < QUADRANTS; i++) {
    const gathered_texel *a = around->nearest[i];
    if (!a) continue;
    const int32_t x = (int32_t)a->x - (int32_t)texel->x, y = (int32_t)a->y - (int32_t)texel->y;
    if (x >= -NEXT && x <= NEXT && y >= -NEXT && y <= NEXT) return true;
    for (uint32_t j = i + 1; j < QUADRANTS; j++) {
      const gathered_texel *b = around->nearest[j];
      if (b && x * ((int32_t)b->x - (int32_t)texel->x) + y * ((int32_t)b->y - (int32_t)texel->y) < 0) return true;
    }
  }
  return false;
}

// Interpolates between the gathered texels around another; returns false where they do not determine its light.
static bool interpolate_around(const texels_around *around, const gathered_texel *texel, olx_vec3 *irradiance) {
  if (!is_served(around, texel)) return false;
  olx_vec3 sum = {0}, least = olx_splat(INFINITY), most = olx_splat(0.0f);
  float weights = 0.0f, error = 0.0f;
  for (uint32_t i = 0; i < QUADRANTS; i++) {
    const gathered_texel *g = around->nearest[i];
    if (!g) continue;
    const float weight = 1.0f / olx_max(around->squared[i], FLT_MIN);
    sum = olx_madd(sum, g->light.irradiance, weight);
    weights += weight;
    least = olx_min_each(least, g->light.irradiance);
    most = olx_max_each(most, g->light.irradiance);
    error = olx_max(error, g->light.error);
  }
  *irradiance = olx_scale(sum, 1.0f / weights);
  const float allowed = olx_max(ALIKE, ALIKE_ERRORS * error), middle = 0.5f * olx_luminance(olx_add(most, least));
  return olx_luminance(olx_sub(most, least)) <= allowed * middle;
}

// Lights texel i of the k-th block of a tile.
static void light_texel(const texel_light *t, light_tile *tile, uint32_t k, uint32_t i) {
  const uint32_t block = block_of(t, tile, k), at = olx_block_texel(t->capture, block, i), size = t->capture->size;
  const olx_surface *surface = &tile->blocks[k].surface[i];
  gathered_texel texel = {.x = at % size, .y = at / size, .surface = surface};
  olx_vec3 *irradiance = &t->irradiance[at];
  if (olx_scene_light_interpolate(t->light, surface, irradiance)) return;
  const texels_around around = find_around(t, tile, &texel);
  if (interpolate_around(&around, &texel, irradiance)) return;
  texel.light = olx_scene_light_gather(t->light, surface, row_of(t, block));
  *irradiance = texel.light.irradiance;
  tile->gathered[tile->count++] = texel;
}

// Returns how often a side is halved until this place is the first or the last of a part.
static uint32_t fineness(uint32_t place, uint32_t side) {
  uint32_t halvings = 0;
  for (uint32_t part = side; place % part != 0 && place % part != part - 1; part /= 2) halvings++;
  return halvings;
}

// Lights the texels of a tile whose light is read, the coarsest first, so that finer ones lie between them.
static void light_texels(const texel_light *t, light_tile *tile) {
  const uint32_t side = tile->side * OLX_BLOCK_SIDE;
  for (uint32_t level = 0; side >> level > 1; level++) {
    for (uint32_t at = 0; at < side * side; at++) {
      const uint32_t x = at % side, y = at / side, fine_x = fineness(x, side), fine_y = fineness(y, side);
      const uint32_t k = y / OLX_BLOCK_SIDE * tile->side + x / OLX_BLOCK_SIDE;
      const uint32_t i = y % OLX_BLOCK_SIDE * OLX_BLOCK_SIDE + x % OLX_BLOCK_SIDE;
      if ((fine_x > fine_y ? fine_x : fine_y) == level && tile->wanted[k] >> i & 1u) light_texel(t, tile, k, i);
    }
  }
}

// Interpolates between the corners of a block that lies on one plane.
static void interpolate(const texel_light *t, uint32_t block) {
  const uint32_t texels[4] = {0, LAST, OLX_BLOCK_SIDE * LAST, OLX_BLOCK_TEXELS - 1};
  olx_vec3 corner[4];
  for (uint32_t i = 0; i < 4; i++) corner[i] = t->irradiance[olx_block_texel(t->capture, block, texels[i])];
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const float x = (float)(i % OLX_BLOCK_SIDE) / (float)LAST, y = (float)(i / OLX_BLOCK_SIDE) / (float)LAST;
    const olx_vec3 top = olx_mix3(corner[0], corner[1], x), bottom = olx_mix3(corner[2], corner[3], x);
    t->irradiance[olx_block_texel(t->capture, block, i)] = olx_mix3(top, bottom, y);
  }
}

static void light_tile_at(const texel_light *t, light_tile *tile) {
  const uint32_t blocks = tile->side * tile->side;
  tile->count = 0;
  for (uint32_t k = 0; k < blocks; k++) {
    const uint32_t block = block_of(t, tile, k);
    olx_block_surfaces *s = &tile->blocks[k];
    olx_block_look(t->capture, block, s);
    tile->wanted[k] = olx_block_is_flat(t->capture, block, s) ? CORNERS : s->seen;
    for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
      t->irradiance[olx_block_texel(t->capture, block, i)] = olx_splat(0.0f);
    }
  }
  light_texels(t, tile);
  for (uint32_t k = 0; k < blocks; k++) {
    if (tile->wanted[k] != tile->blocks[k].seen) interpolate(t, block_of(t, tile, k));
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
  tile.side = side;
  for (uint32_t first = 0; first < blocks; first += side) {
    tile.block = row * side * blocks + first;
    light_tile_at(t, &tile);
  }
}

olx_result olx_light_texels(const olx_capture *capture, const olx_scene_light *light, olx_gather_row *rows,
                            olx_vec3 *irradiance) {
  texel_light t = {.capture = capture, .light = light, .irradiance = irradiance, .rows = rows};
  return olx_bake_for(capture->context, capture->size / OLX_BLOCK_SIDE / tile_side(capture), light_tile_row, &t, 0);
}
