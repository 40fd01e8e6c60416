// The visibility atlas: surfels spread over every surface that the space that matters sees.
#ifndef OLX_PLACE_SURFELS_H
#define OLX_PLACE_SURFELS_H

#include "place/space.h"
#include "place/surfel_sight.h"

// Where an atlas lays its surfels.
typedef enum olx_spread {
  OLX_SPREAD_AREA, // evenly over both sides of all triangles: each stands for the same area
  OLX_SPREAD_RAYS  // where rays arrive from all over the space in all directions: each stands for as many rays
} olx_spread;

typedef struct olx_surfels {
  uint32_t count;
  olx_surfel *items;  // along the Morton curve, so that neighbours in the array are neighbours in space; none is UNSEEN
  double share;       // of the whole atlas that a surfel stands for: 1 / count
  double unreachable; // OLX_SPREAD_AREA: share of all surface no side of which is seen
} olx_surfels;

// Lay `points` points and keep the surfels that are seen. Of OLX_SPREAD_RAYS those are all but the rays that leave the
// scene, and their fates are not looked for.
olx_result olx_surfels_create(const olx_space *space, const olx_sight *sight, olx_spread spread, uint32_t points,
                              uint32_t seed, uint32_t threads, olx_surfels *surfels);
// Find the fates that are not known. With `views`, surfels that are seen well by `least` probes are left out.
olx_result olx_surfels_ask(const olx_space *space, const olx_sight *sight, const uint8_t *views, uint32_t least,
                           uint32_t seed, uint32_t threads, olx_surfels *surfels);
void olx_surfels_free(olx_surfels *surfels);

// Up to `wanted` places from which the surfel is seen well and which allow a probe, found along random rays.
// Returns how many.
uint32_t olx_surfel_vantages(const olx_space *space, const olx_sight *sight, const olx_surfel *surfel, uint32_t seed,
                             uint32_t wanted, olx_vec3 *places);

#endif
