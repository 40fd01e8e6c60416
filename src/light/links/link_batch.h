// Batches of links, in ordinary memory or in a file without a name, whose pages leave memory once they were read or
// written. In a file links take disk instead of memory, and their values are the same.
#ifndef OLX_LIGHT_LINK_BATCH_H
#define OLX_LIGHT_LINK_BATCH_H

#include "light/links/ray_guide.h"

enum {
  OLX_LINK_PACKET = 64,      // rays that are cast together
  OLX_CHAIN_MOST = 4,        // surfaces that a ray may reach; the last one counts as matte and passes nothing on
  OLX_LINK_CHAIN_SHIFT = 28, // bits of `end` above the surfel's index: number of surfaces that passed the ray on
  OLX_LINK_CHAIN_MASK = 3
};

// Flags in `end`. The ray itself found the direct light at its end, and the link does not carry it. With the second
// flag this includes the light of the sky.
#define OLX_LINK_LIT (1u << 31)
#define OLX_LINK_SKY_LIT (1u << 30)

#define OLX_LINK_NOWHERE                                                                                               \
  ((1u << OLX_LINK_CHAIN_SHIFT) - 1)             // the ray brings nothing: sky, only emission, or a black surface
#define OLX_LINK_UNSERVED (OLX_LINK_NOWHERE - 1) // the ray hit a surface for which surfels will be added

// A link (links.h). The irradiance at the end times the weight is pi times the radiance that arrives, times the ray's
// worth, over the density of rays there.
typedef struct olx_link {
  uint32_t end;    // the surfel's index, the number of surfaces on the way, and the flags
  uint32_t weight; // RGB9E5
} olx_link;

static inline uint32_t olx_link_end(const olx_link *link) { return link->end & OLX_LINK_NOWHERE; }
static inline uint32_t olx_link_chain(const olx_link *link) {
  return link->end >> OLX_LINK_CHAIN_SHIFT & OLX_LINK_CHAIN_MASK;
}
// Returns whether the link ends at a surfel.
static inline bool olx_link_brings_light(const olx_link *link) { return olx_link_end(link) < OLX_LINK_UNSERVED; }

// The direct irradiance of surfels in W/m^2.
typedef struct olx_surfel_direct {
  const olx_vec3 *all, *sky; // of all emitters, and of the sky alone; sky may be NULL where all rays find its light
} olx_surfel_direct;

// Returns the direct irradiance that a link carries, which ends at a surfel.
static inline olx_vec3 olx_direct_of_link(const olx_link *link, const olx_surfel_direct *direct) {
  if (!(link->end & OLX_LINK_LIT)) return direct->all[olx_link_end(link)];
  const bool is_found = link->end & OLX_LINK_SKY_LIT || !direct->sky;
  return is_found ? olx_splat(0.0f) : direct->sky[olx_link_end(link)];
}

// Light that rays bring without a link, by the number of surfaces between its emitter and the surfel, less one:
// emission and sky that surfaces on the way reflect, direct light at the end where the link does not carry it, and the
// light of surfaces near lamps that rays bring (field/near_lamps.h). They are sums over rays of radiance times pi.
typedef struct olx_fixed_light {
  olx_vec3 sum[OLX_CHAIN_MOST];
  float square; // sum over rays of the squared luminance
} olx_fixed_light;

// Rays first_ray to first_ray + rays - 1 of some surfels.
typedef struct olx_link_batch {
  const uint32_t *surfels; // `count` indices; NULL: consecutive from first_surfel on
  uint32_t first_surfel, count, first_ray, rays;
  const olx_ray_guide *guide; // guide that rays are drawn by; NULL: evenly
  const char *folder;         // where a file holds links and `fixed`; NULL: they are in memory
  olx_link *links;            // `rays` per surfel
  float *fixed;               // luminance that each ray brings without its link, times pi; NULL: not stored
} olx_link_batch;

// Returns the n-th surfel of a batch.
static inline uint32_t olx_link_surfel(const olx_link_batch *batch, uint32_t n) {
  return batch->surfels ? batch->surfels[n] : batch->first_surfel + n;
}

// Links of a pass that a thread leaves in memory before they may go, in bytes.
enum { OLX_LINKS_AT_A_TIME = 1 << 20 };

// Allocates the batch's links, and with `fixed` what rays bring without them; in batch->folder unless that is NULL. On
// failure the batch has neither.
olx_result olx_link_batch_allocate(olx_link_batch *batch, bool fixed);
void olx_link_batch_release(olx_link_batch *batch);
// Releases what rays bring without links.
void olx_link_batch_release_fixed(olx_link_batch *batch);

// Lets the links of surfels `first` to `end` - 1 of a batch go to its file until they are read or written again. Any
// thread may use them meanwhile. Has no effect on ordinary memory.
void olx_link_batch_rest(const olx_link_batch *batch, uint32_t first, uint32_t end);

// Lets links go during a pass over a batch that has come to the end of surfel n. *from is the first surfel that has not
// gone yet.
static inline void olx_link_batch_passed(const olx_link_batch *batch, uint32_t n, uint32_t *from) {
  if (!batch->folder || (n + 1 - *from) * (size_t)batch->rays * sizeof *batch->links < OLX_LINKS_AT_A_TIME) return;
  olx_link_batch_rest(batch, *from, n + 1);
  *from = n + 1;
}

#endif
