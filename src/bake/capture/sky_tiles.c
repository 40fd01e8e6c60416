// Learns where the sky is seen from the surfaces of each tile of a probe's map: from even samples first, then from
// samples that follow what these found.
#include "bake/capture/sky_tiles.h"

#include "bake/capture/texel_radiance.h"
#include "scene/direct_light.h"
#include "scene/texel_samples.h"

enum {
  ROUNDS = 2,        // of learning
  ROUND_TEXELS = 64, // of a tile
  ROUND_SAMPLES = 8, // of each of these texels
  SALT_SKY = 0x534B5954
};

typedef struct learning {
  const olx_capture *capture;
  olx_sky_guide *guides;
  atomic_uint_fast64_t *rays;
} learning;

// Returns a texel of a tile; `i` counts texels that are spread over it.
static uint32_t texel_of(const olx_capture *c, uint32_t tile, uint32_t i) {
  const uint32_t side = c->size / OLX_SKY_TILES;
  const olx_vec2 at = olx_hammersley(i, ROUND_TEXELS);
  const uint32_t x = tile % OLX_SKY_TILES * side + (uint32_t)(at.x * (float)side);
  const uint32_t y = tile / OLX_SKY_TILES * side + (uint32_t)(at.y * (float)side);
  return y * c->size + x;
}

static uint64_t learn_from(const learning *l, uint32_t tile, uint32_t round, olx_sky_guide *guide) {
  const olx_capture *c = l->capture;
  const olx_scene *scene = c->context->scene;
  const uint32_t seed = olx_hash3(c->probe, tile, SALT_SKY + round) ^ c->context->settings->seed;
  uint64_t rays = 0;
  for (uint32_t i = 0; i < ROUND_TEXELS; i++) {
    const uint32_t texel = texel_of(c, tile, i);
    const olx_ray_hit *hit = &c->hits[texel];
    if (hit->triangle == OLX_NO_HIT) continue;
    const olx_vec3 direction = olx_texel_direction(texel % c->size, texel / c->size, c->size);
    const olx_surface met = olx_surface_at(scene, hit, direction);
    const olx_surface surface = olx_texel_smooth_surface(scene, hit, &met);
    for (uint32_t k = 0; k < ROUND_SAMPLES; k++) {
      olx_sampler sampler = {.seed = seed, .index = i * ROUND_SAMPLES + k};
      (void)olx_direct_irradiance(scene, &surface, guide, &sampler, &rays);
    }
  }
  return rays;
}

static void learn_tile(void *user, uint32_t tile) {
  const learning *l = user;
  olx_sky_guide *guide = &l->guides[tile];
  uint64_t rays = 0;
  olx_sky_guide_begin(guide);
  for (uint32_t round = 0; round < ROUNDS; round++) {
    rays += learn_from(l, tile, round, guide);
    olx_sky_guide_next(guide, 1u << 2 * round);
  }
  atomic_fetch_add_explicit(l->rays, rays, memory_order_relaxed);
}

olx_result olx_sky_tiles_learn(const olx_capture *capture, olx_sky_guide *guides, atomic_uint_fast64_t *rays) {
  learning l = {capture, guides, rays};
  return olx_bake_for(capture->context, OLX_SKY_TILES * OLX_SKY_TILES, learn_tile, &l, 0);
}
