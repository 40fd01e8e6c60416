// What light field probes see, from rasterised cube maps instead of rays: each texel of a cube holds the triangle that
// is nearest in its direction, and a ray from the probe is intersected with the triangles of the texels around it.
//
// A hit is exact: of the triangles in the 3 x 3 texels around the ray, the nearest that the ray really meets. Where
// that is not certain, the ray is cast: where it meets none of these triangles, unless all nine texels are sky, and
// where one of them lies in front of the hit, is not joined to its triangle, and so may end at a silhouette with
// triangles that are narrower than a texel. So nothing bleeds across silhouettes, and only what no texel around the ray
// shows can be missed.
#ifndef OLX_BAKE_CUBE_VIEWS_H
#define OLX_BAKE_CUBE_VIEWS_H

#include "bake/bake_context.h"
#include "scene/ray.h"

#include <octalux/bake.h>

// The cube maps of some probes.
typedef struct olx_cube_views {
  const olx_bake_raster *raster; // NULL: there are none
  uint32_t side;                 // texels along a face, with the ring beyond its edges
  uint32_t capacity;             // probes that are rasterised together
  uint32_t stride;               // between the indices of these
  uint32_t first, count;         // which are here: first, first + stride, ...
  uint32_t *triangles;           // of olx_bake_raster.look
  olx_vec3 *positions;           // capacity
  double seconds;                // of rasterising, so far
} olx_cube_views;

// Allocates the maps for a bake with these settings, whose maps have `size` texels along a side; without a raster none.
olx_result olx_cube_views_create(const olx_bake_settings *settings, uint32_t size, olx_cube_views *views);
// Returns the bytes that they take.
uint64_t olx_cube_views_bytes(const olx_bake_settings *settings, uint32_t size);
void olx_cube_views_free(olx_cube_views *views);

// Rasterises the cube of a light field probe, and those of the next ones, unless it is here already.
olx_result olx_cube_views_look(olx_cube_views *views, const olx_bake_context *context, uint32_t probe);

// Finds the hits of rays that begin at a probe whose cube is here, in any direction and of any length. Returns the
// number of rays that were cast.
uint32_t olx_cube_views_intersect(const olx_cube_views *views, const olx_scene *scene, uint32_t probe,
                                  const olx_ray *rays, uint32_t count, olx_ray_hit *hits);

#endif
