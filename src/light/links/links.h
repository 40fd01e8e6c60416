// Links: where the rays of surfels end. Each link names the surfel that serves the surface there, and the share of that
// surface's light that returns along the ray. On the way, specular surfaces, or surfaces that no surfel serves, may
// have passed the ray on.
//
// Rays are cast once. Light is then propagated over the links once per bounce.
#ifndef OLX_LIGHT_LINKS_H
#define OLX_LIGHT_LINKS_H

#include "core/pack.h"
#include "light/links/ray_ends.h"

// A list of points that grows.
typedef struct olx_point_list {
  olx_surfel_point *points;
  uint32_t count, capacity;
} olx_point_list;

// What a work folder knows of rays (kept_rays.h).
typedef struct olx_cast_keeping {
  struct olx_kept_rays *kept;           // receives what each ray depends on; NULL: not wanted
  const struct olx_former_rays *former; // rays for another scene, which are not cast again where they hold; or NULL
  atomic_uint_fast64_t *reused;         // counts those rays; NULL without `kept`
} olx_cast_keeping;

// Casts the rays of a batch. When `unserved` is not NULL, ends at surfaces without a surfel are marked
// OLX_LINK_UNSERVED and their points appended to it, in the order of the links; otherwise their rays continue from
// there. `keeping` may be NULL. Adds all rays to *rays, including those that still hold and are not cast again.
olx_result olx_links_cast(const olx_light_surfels *surfels, olx_link_batch *batch, olx_fixed_light *fixed,
                          olx_point_list *unserved, const olx_cast_keeping *keeping, uint64_t *rays);

// Continues the ray of link `i` of a batch, which ends at a surface without a surfel, by a cosine-distributed ray from
// there.
void olx_link_go_on(const olx_light_surfels *surfels, olx_link_batch *batch, size_t i, const olx_surface *surface,
                    olx_fixed_light *fixed, uint64_t *rays);

// Returns the point of the unit square from which a surfel's unguided ray was generated.
olx_vec2 olx_links_ray_point(const olx_light_surfels *surfels, uint32_t surfel, uint32_t ray);

// The sum of what several rays of a surfel bring.
typedef struct olx_ray_sum {
  olx_vec3 light; // sum over rays of irradiance times the ray's worth, W/m^2
  float squares;  // sum of the squared deviations of that luminance from its mean
  float worth;    // sum over rays, in rays of even density
} olx_ray_sum;

// Adds up what `count` rays of a surfel bring, drawn by the guide, from index `first` on; they leave no links. *rays
// counts all rays.
olx_ray_sum olx_links_add_up(const olx_light_surfels *surfels, uint32_t surfel, const olx_ray_guide *guide,
                             uint32_t first, uint32_t count, const olx_passed_light *light, uint64_t *rays);

// Returns whether a batch has enough rays for a guide to divide; fewer are drawn evenly.
static inline bool olx_link_is_guided(const olx_link_batch *batch) {
  return batch->guide && batch->rays >= 2 * OLX_GUIDE_BINS;
}

// Returns the weight of each ray of a surfel, in rays of even density: the inverse of their ratio of variances.
static inline float olx_link_worth(const olx_link_batch *batch, uint32_t surfel) {
  return olx_link_is_guided(batch) ? 1.0f / batch->guide->pools[batch->guide->pool_of[surfel]].spread : 1.0f;
}

// Returns the light that a link brings when surfaces carry `direct` + `irradiance`, in W/m^2 times the weight of its
// ray.
static inline olx_vec3 olx_link_light(const olx_link *link, const olx_surfel_direct *direct,
                                      const olx_vec3 *irradiance) {
  if (!olx_link_brings_light(link)) return olx_splat(0.0f);
  const uint32_t end = olx_link_end(link);
  const olx_vec3 light = olx_add(olx_direct_of_link(link, direct), irradiance[end]);
  return olx_mul(olx_rgb9e5_unpack(link->weight), light);
}

#endif
