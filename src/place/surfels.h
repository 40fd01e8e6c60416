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
  olx_surfel *items; // along the Morton curve, so that neighbours in the array are neighbours in space; none is UNSEEN
  double share;      // of the whole atlas that a surfel stands for: 1 / count
  // OLX_SPREAD_AREA: points where there is surface, of which so many have no side that is seen; and places of sides
  // that are unseen and face free space that is cut off from the space that matters.
  uint32_t present, unseen, cut_off_count;
  olx_vec3 *cut_off;
} olx_surfels;

// Points spread evenly over all triangles, tile by tile.
typedef struct olx_area_points {
  struct olx_area_point {
    uint32_t triangle, nth; // which of the points there
  } * items;
  uint32_t *first; // a tile: its first point; and behind the last tile the number of all
  uint32_t count, seed;
  double metres2; // of surface that each stands for, of one side
} olx_area_points;

olx_result olx_area_points_create(const olx_world *world, uint32_t points, uint32_t seed, olx_area_points *all);
void olx_area_points_free(olx_area_points *all);
// Both sides of the tile's points, those that are seen, with their fates.
olx_result olx_area_surfels(const olx_space *space, const olx_sight *sight, const olx_area_points *all,
                            uint32_t threads, olx_surfels *surfels);

// Lay `points` points and keep the surfels of the tile that are seen. Of OLX_SPREAD_RAYS those are all but the rays
// that leave the tile's core or the scene, and their fates are not looked for.
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
