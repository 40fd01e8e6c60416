// What light field probes see in every direction: the triangle that a ray meets, and that surface's distance and
// normal.
#ifndef OLX_BAKE_CAPTURE_H
#define OLX_BAKE_CAPTURE_H

#include "bake/bake_context.h"
#include "block/geometry_encode.h"
#include "scene/surface.h"

enum {
  OLX_CAPTURE_CHUNK = 8,     // texels whose samples are cast together; divides the size of every map
  OLX_CAPTURE_MOST_SIDE = 8, // samples along the side of a texel
  OLX_CAPTURE_MOST_RAYS = OLX_CAPTURE_CHUNK * OLX_CAPTURE_MOST_SIDE * OLX_CAPTURE_MOST_SIDE
};

// One probe at a time: the maps hold the probe that was captured last.
typedef struct olx_capture {
  olx_bake_context *context;
  uint32_t size;  // texels along a side of the maps
  uint32_t probe; // the number enters the random numbers
  olx_vec3 position;
  uint16_t *normal, *distance; // as the file holds them, size^2
  olx_ray_hit *hits;           // of rays through the middles of texels, size^2
  double *row_seconds;         // that the ray caster took for the samples of each row, in olx_capture_measure
  uint64_t rays;               // cast so far
} olx_capture;

// The fields up to `size` are the caller's to fill.
olx_result olx_capture_create(olx_capture *capture);
// The memory that maps of `size` texels along a side take. They need not be created.
uint64_t olx_capture_bytes(uint32_t size);
void olx_capture_free(olx_capture *capture);

// Rays through the samples of a probe's texels, which are its units of progress, too.
uint64_t olx_capture_units(const olx_capture *capture);

olx_result olx_capture_probe(olx_capture *capture, uint32_t probe, olx_vec3 position);

// The exact surface that the ray through a texel's middle met; `capture` is an olx_capture.
olx_geometry_texel olx_capture_geometry(const void *capture, uint32_t x, uint32_t y);

// Casts rays through the samples^2 parts of each of OLX_CAPTURE_CHUNK texels of row `y` from column `x` on, one texel's
// after another's. Returns how many they are.
uint32_t olx_capture_cast_samples(const olx_capture *capture, uint32_t x, uint32_t y,
                                  olx_ray rays[OLX_CAPTURE_MOST_RAYS], olx_ray_hit hits[OLX_CAPTURE_MOST_RAYS]);

// Casts the rays of all samples of the probe and does nothing with what they hit: adds the ray caster's time on
// `threads` threads to *embree_seconds.
olx_result olx_capture_measure(olx_capture *capture, double *embree_seconds);

#endif
