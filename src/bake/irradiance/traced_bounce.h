// Bounces by rays (the dissertation's section 4.3.3): rays are cast from the surfaces that a probe sees, and where they
// meet other surfaces, the light of the previous bounce is read from what probes stored there. A probe is read only for
// places that it sees: the place must lie at the distance that the probe stored in that direction. The alternative is
// to interpolate irradiance maps.
//
// Geometry does not move, so rays are cast and probes found once; each bounce follows the same links.
#ifndef OLX_BAKE_TRACED_BOUNCE_H
#define OLX_BAKE_TRACED_BOUNCE_H

#include "bake/bake_context.h"
#include "bake/capture/shade_batch.h"
#include "bake/irradiance/quadrature.h"

enum { OLX_BOUNCE_RAYS = 4 }; // rays that each gather point casts

typedef struct olx_traced_bounce {
  // The caller's to fill.
  olx_bake_context *context;
  olx_shade_context *shade;
  const olx_quadrature *quadrature;
  const olx_grid *grid;
  const olx_ray_hit *hits; // of the gather points, olx_gather_points of each probe
  // OLX_BOUNCE_RAYS entries for each gather point: the gather point, over all probes, that holds the light at the ray's
  // end.
  uint32_t *links;
  // Light that leaves gather points towards their probes: direct, and of the bounces up to the last and the one before.
  olx_vec3 *direct, *light[2];
  atomic_uint_fast64_t rays, unseen; // rays that met a surface, and those of them whose end no probe nearby sees
} olx_traced_bounce;

olx_result olx_traced_bounce_create(olx_traced_bounce *traced);
// Returns the memory that a bounce holds, for so many probes of so many gather points.
uint64_t olx_traced_bounce_bytes(uint32_t probe_count, uint32_t gather_points);
void olx_traced_bounce_free(olx_traced_bounce *traced);

// Casts the rays. The hits must be known.
olx_result olx_traced_bounce_link(olx_traced_bounce *traced);

// Returns the irradiance of bounce `bounce` (0: of direct light) at gather point `point`, over all probes.
olx_vec3 olx_traced_irradiance(const olx_traced_bounce *traced, size_t point, uint32_t bounce);

// Returns where the light of a bounce is stored.
static inline olx_vec3 *olx_traced_light(const olx_traced_bounce *traced, uint32_t bounce) {
  return bounce == 0 ? traced->direct : traced->light[bounce & 1u];
}

#endif
