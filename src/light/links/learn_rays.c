// Sums the light that the links of surfels bring, by pool and by direction, and has each pool learn its density from
// the sums.
#include "light/links/learn_rays.h"

#include "core/hooks.h"
#include "core/result.h"
#include "light/links/link_batch.h"

typedef struct lesson {
  const olx_ray_guide *guide;
  const olx_light_surfels *surfels;
  const olx_surfel_direct *direct;
  const olx_vec3 *irradiance;
  olx_guide_sums *sums; // one per pool
} lesson;

// Returns the luminance that a ray brings, through its link and without it.
static float brought(const lesson *l, const olx_link *link, float fixed) {
  return fixed + olx_luminance(olx_link_light(link, l->direct, l->irradiance));
}

static void add_batch(const lesson *l, const olx_link_batch *batch) {
  uint32_t from = 0;
  for (uint32_t n = 0; n < batch->count; n++) {
    const uint32_t surfel = olx_link_surfel(batch, n);
    olx_guide_sums *sums = &l->sums[l->guide->pool_of[surfel]];
    for (uint32_t i = 0; i < batch->rays; i++) {
      const olx_vec2 point = olx_links_ray_point(l->surfels, surfel, batch->first_ray + i);
      const size_t at = (size_t)n * batch->rays + i;
      olx_guide_add(sums, point, brought(l, &batch->links[at], batch->fixed[at]));
    }
    olx_link_batch_passed(batch, n, &from);
  }
  olx_link_batch_rest(batch, from, batch->count);
}

olx_result olx_rays_learn(olx_ray_guide *guide, const olx_light_surfels *surfels, const olx_light_links *links,
                          const olx_surfel_direct *direct, const olx_vec3 *irradiance) {
  lesson l = {.guide = guide, .surfels = surfels, .direct = direct, .irradiance = irradiance};
  l.sums = olx_allocate_zero(guide->pool_count, sizeof *l.sums);
  if (!l.sums)
    return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for guiding the rays of %u surfels", surfels->count);
  for (uint32_t k = 0; k < links->batch_count; k++) add_batch(&l, &links->batches[k]);
  for (uint32_t i = 0; i < guide->pool_count; i++) olx_guide_learn(&guide->pools[i], &l.sums[i]);
  olx_release(l.sums);
  return OLX_OK;
}
