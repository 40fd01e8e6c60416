// Reads the solved light of the scene at what the texels of a probe see: at four texels of a block that lies on one plane,
// at every texel elsewhere.
#include "bake/texel_light.h"

#include "core/octahedral.h"

enum { BLOCK = 4 };

// How far a texel of a block may lie from the plane of its first, in footprints, and how far their normals may part.
static const float FLAT_FOOTPRINTS = 0.25f, FLAT_COSINE = 0.999f;

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
  const olx_scene *scene = c->shade->scene;
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
  for (uint32_t i = 0; i < BLOCK * BLOCK; i++) {
    const uint32_t texel = texel_of(t, block, i);
    if (t->capture->hits[texel].triangle == OLX_NO_HIT) continue;
    t->irradiance[texel] = olx_scene_light_irradiance(t->light, &surface[i]);
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
