// The visibility atlas: surfels spread over every surface that is visible from the space that matters.
#ifndef OLX_PLACE_SURFELS_H
#define OLX_PLACE_SURFELS_H

#include "place/cover/surfel_sight.h"
#include "place/space/space.h"

// How an atlas distributes its surfels.
typedef enum olx_spread {
  OLX_SPREAD_AREA, // evenly over both sides of all triangles: each represents the same area
  OLX_SPREAD_RAYS  // where rays from all over the space, in all directions, arrive: each represents the same number of
                   // rays
} olx_spread;

typedef struct olx_surfels {
  uint32_t count;
  olx_surfel *items; // along the Morton curve, so that neighbours in the array are neighbours in space; none is UNSEEN
  double share;      // share of the whole atlas that a surfel represents: 1 / count
  // OLX_SPREAD_AREA: the number of points on a surface, the number of those that are seen from neither side, and the
  // positions of unseen sides that face free space which is cut off from the space that matters.
  uint32_t present, unseen, cut_off_count;
  olx_vec3 *cut_off;
} olx_surfels;

// Points spread evenly over all triangles, sorted by tile.
typedef struct olx_area_points {
  struct olx_area_point {
    uint32_t triangle, nth; // triangle, and index of the point on it
  } * items;
  uint32_t *first; // index of each tile's first point, and the end
  uint32_t count, seed;
  double metres2; // one-sided area of surface that each represents
} olx_area_points;

olx_result olx_area_points_create(const olx_world *world, uint32_t points, uint32_t seed, olx_area_points *all);
void olx_area_points_free(olx_area_points *all);
// Finds the surfels on both sides of the tile's points that are seen, with their fates.
olx_result olx_area_surfels(const olx_space *space, const olx_sight *sight, const olx_area_points *all,
                            uint32_t threads, olx_surfels *surfels);

// Distributes `points` points and keeps the surfels of the tile that are seen. With OLX_SPREAD_RAYS these are all
// except rays that leave the tile's core or the scene, and their fates are not determined.
olx_result olx_surfels_create(const olx_space *space, const olx_sight *sight, olx_spread spread, uint32_t points,
                              uint32_t seed, uint32_t threads, olx_surfels *surfels);
// Determines the fates that are not known. With `views`, surfels that are seen well by `least` probes are skipped.
olx_result olx_surfels_ask(const olx_space *space, const olx_sight *sight, const uint8_t *views, uint32_t least,
                           uint32_t seed, uint32_t threads, olx_surfels *surfels);
void olx_surfels_free(olx_surfels *surfels);

// Finds up to `wanted` positions that allow a probe and see the surfel well, along random rays. Returns their number.
uint32_t olx_surfel_vantages(const olx_space *space, const olx_sight *sight, const olx_surfel *surfel, uint32_t seed,
                             uint32_t wanted, olx_vec3 *places);

#endif
