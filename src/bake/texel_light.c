// Reads the solved light of the scene at what the texels of a probe see: at four texels of a block that lies on one plane, at
// every texel elsewhere. Where it has to be gathered, texels of a block that lie on one surface share the result.
#include "bake/texel_light.h"

#include "core/octahedral.h"

#include <stdlib.h>

enum {
  BLOCK = 4,
  NOT_FOUND = BLOCK * BLOCK,
  SHARED_SHARE = 64 // texels share gathered light over this part of a map's side, or less
};

// How far a texel of a block may lie from the plane of its first, in footprints, and how far their normals may part.
static const float FLAT_FOOTPRINTS = 0.25f, FLAT_COSINE = 0.999f;
// How far a texel may lie from the plane of another whose gathered light it shares, in footprints, and how far their normals
// may part.
static const float SHARED_FOOTPRINTS = 1.0f, SHARED_COSINE = 0.9f;

typedef struct texel_light {
  const olx_capture *capture;
  const olx_scene_light *light;
  olx_vec3 *irradiance;
} texel_light;

static uint32_t texel_of(const texel_light *t, uint32_t block, uint32_t i) {
  const uint32_t blocks = t->capture->size / BLOCK;
  const uint32_t x = block % blocks * BLOCK + i % BLOCK, y = block / blocks * BLOCK + i / BLOCK;
  return y * t->capture->size + x;
}

static olx_surface surface_of(const texel_light *t, uint32_t texel) {
  const olx_capture *c = t->capture;
  const olx_scene *scene = c->scene;
  const olx_ray_hit *hit = &c->hits[texel];
  olx_surface surface = olx_surface_at(scene, hit, olx_texel_direction(texel % c->size, texel / c->size, c->size));
  surface.shading_normal = olx_surface_vertex_normal(scene, hit, &surface);
  return surface;
}

// Whether all texels of a block lie on the plane of the first.
static bool is_flat(const texel_light *t, uint32_t block, const olx_surface surface[BLOCK * BLOCK]) {
  const float distance = t->capture->hits[texel_of(t, block, 0)].t;
  const float tolerance = FLAT_FOOTPRINTS * 2.0f * distance / (float)t->capture->size;
  for (uint32_t i = 1; i < BLOCK * BLOCK; i++) {
    const olx_vec3 step = olx_sub(surface[i].position, surface[0].position);
    if (fabsf(olx_dot(step, surface[0].geometric_normal)) > tolerance) return false;
    if (olx_dot(surface[i].shading_normal, surface[0].shading_normal) < FLAT_COSINE) return false;
    if (olx_dot(surface[i].geometric_normal, surface[0].geometric_normal) < FLAT_COSINE) return false;
  }
  return true;
}

static void interpolate(const texel_light *t, uint32_t block, const olx_surface surface[BLOCK * BLOCK]) {
  enum { LAST = BLOCK - 1 };
  const olx_vec3 corner[4] = {olx_scene_light_irradiance(t->light, &surface[0]),
                              olx_scene_light_irradiance(t->light, &surface[LAST]),
                              olx_scene_light_irradiance(t->light, &surface[BLOCK * LAST]),
                              olx_scene_light_irradiance(t->light, &surface[BLOCK * BLOCK - 1])};
  for (uint32_t i = 0; i < BLOCK * BLOCK; i++) {
    const float x = (float)(i % BLOCK) / (float)LAST, y = (float)(i / BLOCK) / (float)LAST;
    const olx_vec3 top = olx_mix3(corner[0], corner[1], x), bottom = olx_mix3(corner[2], corner[3], x);
    t->irradiance[texel_of(t, block, i)] = olx_mix3(top, bottom, y);
  }
}

// Texels of a block whose light was gathered.
typedef struct gathered_texels {
  uint32_t count;
  uint8_t texels[BLOCK * BLOCK];
} gathered_texels;

static uint32_t texels_apart(uint32_t a, uint32_t b) {
  const uint32_t columns = (uint32_t)abs((int)(a % BLOCK) - (int)(b % BLOCK)),
                 rows = (uint32_t)abs((int)(a / BLOCK) - (int)(b / BLOCK));
  return columns > rows ? columns : rows;
}

// The gathered texel nearest to another of the block, less than `shared` texels from it, among those that lie on its surface;
// NOT_FOUND when there is none.
static uint32_t find_gathered(const gathered_texels *g, const olx_surface surface[BLOCK * BLOCK], uint32_t texel,
                              uint32_t shared, float footprint) {
  uint32_t found = NOT_FOUND;
  float least = INFINITY;
  const olx_surface *point = &surface[texel];
  for (uint32_t i = 0; i < g->count; i++) {
    if (texels_apart(g->texels[i], texel) >= shared) continue;
    const olx_surface *other = &surface[g->texels[i]];
    const olx_vec3 way = olx_sub(other->position, point->position);
    if (olx_dot(other->geometric_normal, point->geometric_normal) < SHARED_COSINE) continue;
    if (olx_dot(other->shading_normal, point->shading_normal) < SHARED_COSINE) continue;
    if (fabsf(olx_dot(way, point->geometric_normal)) > SHARED_FOOTPRINTS * footprint) continue;
    const float squared = olx_dot(way, way);
    if (squared >= least) continue;
    least = squared;
    found = g->texels[i];
  }
  return found;
}

static void light_texel(const texel_light *t, uint32_t block, uint32_t i, const olx_surface surface[BLOCK * BLOCK],
                        gathered_texels *gathered) {
  const uint32_t texel = texel_of(t, block, i);
  olx_vec3 *irradiance = &t->irradiance[texel];
  if (olx_scene_light_interpolate(t->light, &surface[i], irradiance)) return;
  const float footprint = 2.0f * t->capture->hits[texel].t / (float)t->capture->size;
  const uint32_t found = find_gathered(gathered, surface, i, t->capture->size / SHARED_SHARE, footprint);
  if (found != NOT_FOUND) {
    *irradiance = t->irradiance[texel_of(t, block, found)];
    return;
  }
  *irradiance = olx_scene_light_gather(t->light, &surface[i]);
  gathered->texels[gathered->count++] = (uint8_t)i;
}

static void light_block(const texel_light *t, uint32_t block) {
  olx_surface surface[BLOCK * BLOCK];
  bool whole = true;
  for (uint32_t i = 0; i < BLOCK * BLOCK; i++) {
    const uint32_t texel = texel_of(t, block, i);
    if (t->capture->hits[texel].triangle == OLX_NO_HIT) {
      whole = false;
      t->irradiance[texel] = olx_splat(0.0f);
    } else {
      surface[i] = surface_of(t, texel);
    }
  }
  if (whole && is_flat(t, block, surface)) {
    interpolate(t, block, surface);
    return;
  }
  gathered_texels gathered = {0};
  for (uint32_t i = 0; i < BLOCK * BLOCK; i++) {
    if (t->capture->hits[texel_of(t, block, i)].triangle != OLX_NO_HIT) light_texel(t, block, i, surface, &gathered);
  }
}

static void light_row(void *user, uint32_t row) {
  const texel_light *t = user;
  const uint32_t blocks = t->capture->size / BLOCK;
  for (uint32_t x = 0; x < blocks; x++) light_block(t, row * blocks + x);
}

olx_result olx_texel_light(const olx_capture *capture, const olx_scene_light *light, olx_vec3 *irradiance) {
  texel_light t = {.capture = capture, .light = light, .irradiance = irradiance};
  return olx_parallel_for(capture->size / BLOCK, capture->threads, light_row, &t, capture->task, 0);
}
