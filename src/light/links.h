// Links: what the rays of surfels meet. Each ends at the surfel that serves the surface there, with the share of that
// surface's light that comes back along the ray; on the way it may have been passed on by specular surfaces.
//
// Rays are cast once. Light then goes over links as often as it bounces.
#ifndef OLX_LIGHT_LINKS_H
#define OLX_LIGHT_LINKS_H

#include "light/light_surfels.h"

enum {
  OLX_CHAIN_MOST = 4,       // specular surfaces that pass a ray on before it is given up
  OLX_LINK_CHAIN_SHIFT = 29 // bits of `end` above the surfel's number: how many specular surfaces are on the way
};

#define OLX_LINK_NOWHERE                                                                                               \
  ((1u << OLX_LINK_CHAIN_SHIFT) - 1)             // the ray brings nothing: sky, an emitter's own light, black
#define OLX_LINK_UNSERVED (OLX_LINK_NOWHERE - 1) // it meets a surface without a surfel

typedef struct olx_link {
  uint32_t end;    // the surfel's number, and the surfaces on the way
  uint32_t weight; // RGB9E5: irradiance at the end times this is pi times the radiance that arrives
} olx_link;

// Rays first_ray to first_ray + rays - 1 of some surfels.
typedef struct olx_link_batch {
  const uint32_t *surfels; // count numbers; NULL: all from first_surfel on
  uint32_t first_surfel, count, first_ray, rays;
  olx_link *links; // `rays` a surfel
} olx_link_batch;

// Light that rays bring without a link, by the number of surfaces that it met between its emitter and the surfel, less
// one: what specular surfaces on the way reflect of emitters and the sky. Sums over rays, of radiance times pi.
typedef struct olx_fixed_light {
  olx_vec3 sum[OLX_CHAIN_MOST];
  float square; // sum over rays of the squared luminance
} olx_fixed_light;

// Casts the rays of a batch. Ends at surfaces without a surfel are marked OLX_LINK_UNSERVED; with `unserved` not NULL
// their points are appended to it.
typedef struct olx_point_list {
  olx_surface_point *points;
  uint32_t count, capacity;
} olx_point_list;

olx_result olx_links_cast(const olx_light_surfels *surfels, olx_link_batch *batch, olx_fixed_light *fixed,
                          olx_point_list *unserved, uint64_t *rays);

// Indirect irradiance in W/m^2 of any surface, about its shading normal, from `rays` rays of its own that end at surfels with
// `light`: direct and indirect irradiance of all bounces but the last of `bounces`.
olx_vec3 olx_links_gather(const olx_light_surfels *surfels, const olx_surface *surface, uint32_t seed, uint32_t rays,
                          uint32_t bounces, const olx_vec3 *light);

// The n-th surfel of a batch.
static inline uint32_t olx_link_surfel(const olx_link_batch *batch, uint32_t n) {
  return batch->surfels ? batch->surfels[n] : batch->first_surfel + n;
}

#endif
