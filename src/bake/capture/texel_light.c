// Reads the solved light of the scene at the surfaces that the texels of a probe see: at four texels of a block that
// lies on one plane, at every texel elsewhere. Where light has to be gathered, texels of a block that lie on one
// surface share the result.
#include "bake/capture/texel_light.h"

#include "bake/capture/texel_blocks.h"
#include "core/sampling.h"
#include "scene/bvh.h"

#include <stdlib.h>

enum {
  NOT_FOUND = OLX_BLOCK_TEXELS,
  SHARED_SHARE = 64, // texels share gathered light over this part of a map's side, or less
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

static olx_vec3 light_of(const texel_light *t, uint32_t block, const olx_surface *surface) {
  olx_vec3 irradiance;
  if (olx_scene_light_interpolate(t->light, surface, &irradiance)) return irradiance;
  return olx_scene_light_gather(t->light, surface, row_of(t, block));
}

static void interpolate(const texel_light *t, uint32_t block, const olx_surface *surface) {
  enum { LAST = OLX_BLOCK_SIDE - 1 };
  const uint32_t texels[4] = {0, LAST, OLX_BLOCK_SIDE * LAST, OLX_BLOCK_TEXELS - 1};
  olx_vec3 corner[4];
  for (uint32_t i = 0; i < 4; i++) corner[i] = light_of(t, block, &surface[texels[i]]);
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    const float x = (float)(i % OLX_BLOCK_SIDE) / (float)LAST, y = (float)(i / OLX_BLOCK_SIDE) / (float)LAST;
    const olx_vec3 top = olx_mix3(corner[0], corner[1], x), bottom = olx_mix3(corner[2], corner[3], x);
    t->irradiance[olx_block_texel(t->capture, block, i)] = olx_mix3(top, bottom, y);
  }
}

// Texels of a block whose light was gathered, and how far from each texel of the block light may be shared, in metres;
// 0 until that is asked.
typedef struct gathered_texels {
  uint32_t count;
  uint8_t texels[OLX_BLOCK_TEXELS];
  float reach[OLX_BLOCK_TEXELS];
} gathered_texels;

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

static uint32_t texels_apart(uint32_t a, uint32_t b) {
  const uint32_t columns = (uint32_t)abs((int)(a % OLX_BLOCK_SIDE) - (int)(b % OLX_BLOCK_SIDE)),
                 rows = (uint32_t)abs((int)(a / OLX_BLOCK_SIDE) - (int)(b / OLX_BLOCK_SIDE));
  return columns > rows ? columns : rows;
}

// Returns how far from a texel light may be shared.
static float reach_at(const texel_light *t, gathered_texels *g, const olx_block_surfaces *s, uint32_t texel) {
  if (!(g->reach[texel] > 0.0f)) g->reach[texel] = reach_of(t, &s->surface[texel]);
  return g->reach[texel];
}

// Returns whether two texels are within reach of each other, by the square of their distance: at the mouth of a gap
// light reaches farther outside than inside.
static bool reach(const texel_light *t, gathered_texels *g, const olx_block_surfaces *s, uint32_t a, uint32_t b,
                  float squared) {
  return squared <= olx_square(reach_at(t, g, s, a)) && squared <= olx_square(reach_at(t, g, s, b));
}

// Returns the gathered texel nearest to another of the block, less than `shared` texels from it, among those that lie
// on its surface and within reach; NOT_FOUND when there is none.
static uint32_t find_gathered(const texel_light *t, uint32_t block, gathered_texels *g, const olx_block_surfaces *s,
                              uint32_t texel) {
  const uint32_t shared = t->capture->size / SHARED_SHARE;
  uint32_t found = NOT_FOUND;
  float least = INFINITY;
  for (uint32_t i = 0; i < g->count; i++) {
    if (texels_apart(g->texels[i], texel) >= shared) continue;
    if (!olx_block_shares(t->capture, block, s, texel, g->texels[i])) continue;
    const olx_vec3 way = olx_sub(s->surface[g->texels[i]].position, s->surface[texel].position);
    const float squared = olx_dot(way, way);
    if (squared >= least || !reach(t, g, s, g->texels[i], texel, squared)) continue;
    least = squared;
    found = g->texels[i];
  }
  return found;
}

static void light_texel(const texel_light *t, uint32_t block, uint32_t i, const olx_block_surfaces *s,
                        gathered_texels *gathered) {
  olx_vec3 *irradiance = &t->irradiance[olx_block_texel(t->capture, block, i)];
  if (olx_scene_light_interpolate(t->light, &s->surface[i], irradiance)) return;
  const uint32_t found = find_gathered(t, block, gathered, s, i);
  if (found != NOT_FOUND) {
    *irradiance = t->irradiance[olx_block_texel(t->capture, block, found)];
    return;
  }
  *irradiance = olx_scene_light_gather(t->light, &s->surface[i], row_of(t, block));
  gathered->texels[gathered->count++] = (uint8_t)i;
}

static void light_block(const texel_light *t, uint32_t block) {
  olx_block_surfaces s;
  olx_block_look(t->capture, block, &s);
  if (olx_block_is_flat(t->capture, block, &s)) {
    interpolate(t, block, s.surface);
    return;
  }
  gathered_texels gathered = {0};
  for (uint32_t i = 0; i < OLX_BLOCK_TEXELS; i++) {
    if (s.seen >> i & 1u) light_texel(t, block, i, &s, &gathered);
    else t->irradiance[olx_block_texel(t->capture, block, i)] = olx_splat(0.0f);
  }
}

static void light_row(void *user, uint32_t row) {
  const texel_light *t = user;
  const uint32_t blocks = t->capture->size / OLX_BLOCK_SIDE;
  for (uint32_t x = 0; x < blocks; x++) light_block(t, row * blocks + x);
}

olx_result olx_light_texels(const olx_capture *capture, const olx_scene_light *light, olx_gather_row *rows,
                            olx_vec3 *irradiance) {
  texel_light t = {.capture = capture, .light = light, .irradiance = irradiance, .rows = rows};
  return olx_bake_for(capture->context, capture->size / OLX_BLOCK_SIDE, light_row, &t, 0);
}
