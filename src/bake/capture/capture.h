// Captures what light field probes see in every direction: the triangle that a ray hits, and its distance and normal.
#ifndef OLX_BAKE_CAPTURE_H
#define OLX_BAKE_CAPTURE_H

#include "bake/bake_context.h"
#include "bake/capture/cube_views.h"
#include "block/geometry_encode.h"
#include "scene/surface.h"

#include <stdatomic.h>

enum {
  OLX_CAPTURE_CHUNK = 8,     // texels whose samples are cast together; divides every map size
  OLX_CAPTURE_MOST_SIDE = 8, // samples along the side of a texel
  OLX_CAPTURE_MOST_RAYS = OLX_CAPTURE_CHUNK * OLX_CAPTURE_MOST_SIDE * OLX_CAPTURE_MOST_SIDE
};

// The captured geometry of one probe at a time: the maps hold the latest one.
typedef struct olx_capture {
  olx_bake_context *context;
  uint32_t size;  // texels along a side of the maps
  uint32_t probe; // index of the probe, which seeds its random numbers
  olx_vec3 position;
  uint16_t *normal, *distance; // size^2, encoded as in the file
  olx_ray_hit *hits;           // size^2 hits of rays through texel centres
  double *row_seconds;         // time of the ray caster for the samples of each row, set by olx_capture_measure
  uint64_t rays;               // cast so far
  olx_cube_views cubes;        // what rays from the probe hit, where a raster finds that
  atomic_uint_fast64_t recast; // rays that the cubes left to be cast
} olx_capture;

// Allocates the maps. The caller sets the fields up to `size`.
olx_result olx_capture_create(olx_capture *capture);
// Returns the bytes that maps of `size` texels along a side take, without cubes; they need not be allocated.
uint64_t olx_capture_bytes(uint32_t size);
void olx_capture_free(olx_capture *capture);

// Returns the number of rays through the samples of a probe's texels, which are also its units of progress.
uint64_t olx_capture_units(const olx_capture *capture);

olx_result olx_capture_probe(olx_capture *capture, uint32_t probe, olx_vec3 position);

// Returns the exact surface that the ray through a texel's centre hits; `capture` is an olx_capture.
olx_geometry_texel olx_capture_geometry(const void *capture, uint32_t x, uint32_t y);

// Finds the hits of rays through the samples^2 subpixels of each of OLX_CAPTURE_CHUNK texels of row `y` from column `x`
// on, texel by texel. Returns the number of rays.
uint32_t olx_capture_cast_samples(olx_capture *capture, uint32_t x, uint32_t y, olx_ray rays[OLX_CAPTURE_MOST_RAYS],
                                  olx_ray_hit hits[OLX_CAPTURE_MOST_RAYS]);

// Casts the rays of all samples of the probe and discards the hits, to measure the ray caster: adds the time that this
// takes on the threads of the bake's settings to *embree_seconds.
olx_result olx_capture_measure(olx_capture *capture, double *embree_seconds);

#endif
