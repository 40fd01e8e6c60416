// Links: what the rays of surfels meet. Each ends at the surfel that serves the surface there, with the share of that
// surface's light that comes back along the ray; on the way it may have been passed on by specular surfaces, and by
// surfaces that no surfel serves.
//
// Rays are cast once. Light then goes over links as often as it bounces.
#ifndef OLX_LIGHT_LINKS_H
#define OLX_LIGHT_LINKS_H

#include "core/pack.h"
#include "light/ray_guide.h"

enum {
  OLX_CHAIN_MOST = 4,        // surfaces that pass a ray on before it is given up
  OLX_LINK_CHAIN_SHIFT = 29, // bits of `end` above the surfel's number: how many surfaces have passed the ray on
  OLX_LINK_CHAIN_MASK = 3
};

// Of `end`: the ray found the direct light at the end itself, and the link does not bring it.
#define OLX_LINK_LIT (1u << 31)

#define OLX_LINK_NOWHERE                                                                                               \
  ((1u << OLX_LINK_CHAIN_SHIFT) - 1)             // the ray brings nothing: sky, an emitter's own light, black
#define OLX_LINK_UNSERVED (OLX_LINK_NOWHERE - 1) // it meets a surface for which surfels are sought

// Irradiance at the end times the weight is pi times the radiance that arrives, times what the ray is worth, over the
// density of rays there.
typedef struct olx_link {
  uint32_t end;    // the surfel's number, the surfaces on the way, and OLX_LINK_LIT
  uint32_t weight; // RGB9E5
} olx_link;

// Rays first_ray to first_ray + rays - 1 of some surfels.
typedef struct olx_link_batch {
  const uint32_t *surfels; // count numbers; NULL: all from first_surfel on
  uint32_t first_surfel, count, first_ray, rays;
  const olx_ray_guide *guide; // by which rays are drawn; NULL: evenly
  olx_link *links;            // `rays` a surfel
  float *fixed;               // luminance that each ray brings without its link, times pi; NULL: not wanted
} olx_link_batch;

// Light that rays bring without a link, by the number of surfaces between its emitter and the surfel, less one: what
// surfaces that pass a ray on reflect of emitters and the sky, and direct light at its end where the link is
// OLX_LINK_LIT. Sums over rays, of radiance times pi.
typedef struct olx_fixed_light {
  olx_vec3 sum[OLX_CHAIN_MOST];
  float square; // sum over rays of the squared luminance
} olx_fixed_light;

// Casts the rays of a batch. With `unserved` not NULL, ends at surfaces without a surfel are marked OLX_LINK_UNSERVED
// and their points appended to it, in the order of the links; else their rays go on from there.
typedef struct olx_point_list {
  olx_surface_point *points;
  uint32_t count, capacity;
} olx_point_list;

olx_result olx_links_cast(const olx_light_surfels *surfels, olx_link_batch *batch, olx_fixed_light *fixed,
                          olx_point_list *unserved, uint64_t *rays);

// Continues the ray of link `i` of a batch, which ends at a surface that turned out to have no surfel, by a
// cosine-distributed ray from there.
void olx_link_go_on(const olx_light_surfels *surfels, olx_link_batch *batch, size_t i, const olx_surface *surface,
                    olx_fixed_light *fixed, uint64_t *rays);

// The point of the unit square that a ray of a surfel was made from, without a guide.
olx_vec2 olx_links_ray_point(const olx_light_surfels *surfels, uint32_t surfel, uint32_t ray);

// What surfels pass on: direct irradiance, and with it indirect irradiance of all bounces but the last of `bounces`.
typedef struct olx_passed_light {
  const olx_vec3 *direct, *all;
  uint32_t bounces;
  float most; // luminance times pi that a gathered ray may bring: what one in hundreds finds by luck makes a blotch
} olx_passed_light;

// Indirect irradiance in W/m^2 of any surface, about its shading normal, from `rays` rays of its own. They are drawn by
// what a pool has learnt; NULL: evenly.
olx_vec3 olx_links_gather(const olx_light_surfels *surfels, const olx_surface *surface, const olx_ray_pool *pool,
                          uint32_t seed, uint32_t rays, const olx_passed_light *light);

// How many rays of even density each ray of a surfel is worth: the inverse of its variance beside theirs.
static inline float olx_link_worth(const olx_link_batch *batch, uint32_t surfel) {
  return batch->guide ? 1.0f / batch->guide->pools[batch->guide->pool_of[surfel]].spread : 1.0f;
}

static inline uint32_t olx_link_end(const olx_link *link) { return link->end & OLX_LINK_NOWHERE; }
static inline uint32_t olx_link_chain(const olx_link *link) {
  return link->end >> OLX_LINK_CHAIN_SHIFT & OLX_LINK_CHAIN_MASK;
}
// Whether there is a surfel at the end.
static inline bool olx_link_brings_light(const olx_link *link) { return olx_link_end(link) < OLX_LINK_UNSERVED; }

// The light that a link brings when surfaces carry `direct` + `irradiance`, in W/m^2 times what its ray counts for.
static inline olx_vec3 olx_link_light(const olx_link *link, const olx_vec3 *direct, const olx_vec3 *irradiance) {
  if (!olx_link_brings_light(link)) return olx_splat(0.0f);
  const uint32_t end = olx_link_end(link);
  const olx_vec3 light = link->end & OLX_LINK_LIT ? irradiance[end] : olx_add(direct[end], irradiance[end]);
  return olx_mul(olx_rgb9e5_unpack(link->weight), light);
}

// The n-th surfel of a batch.
static inline uint32_t olx_link_surfel(const olx_link_batch *batch, uint32_t n) {
  return batch->surfels ? batch->surfels[n] : batch->first_surfel + n;
}

#endif
