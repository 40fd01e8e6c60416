// Light field probes: radiance, normal and distance in every direction, from rays.
#ifndef OLX_BAKE_CAPTURE_H
#define OLX_BAKE_CAPTURE_H

#include "bake/shade_batch.h"
#include "core/parallel.h"

// One probe at a time: the maps hold the probe that was captured last.
typedef struct olx_capture {
  olx_shade_context *shade;
  uint32_t size, samples, light_samples, bounces, threads;
  float distance_scale;
  olx_task *task;
  uint32_t probe; // the number enters the random numbers
  olx_vec3 position;
  uint32_t tile_side; // texels along the side of a tile, whose samples make one batch
  uint32_t *radiance; // packed, size^2
  uint16_t *normal, *distance;
  olx_ray_hit *hits; // of rays through the middles of texels, size^2
  double *tile_seconds; // that the ray caster took for each tile, in olx_capture_measure
} olx_capture;

// The fields up to `task` are the caller's to fill.
olx_result olx_capture_create(olx_capture *capture);
// The memory that maps of `size` texels along a side take. They need not be created.
uint64_t olx_capture_bytes(uint32_t size);
void olx_capture_free(olx_capture *capture);

// Units of progress a probe takes, in rays.
uint64_t olx_capture_units(const olx_capture *capture);

olx_result olx_capture_probe(olx_capture *capture, uint32_t probe, olx_vec3 position);

// Cast the primary rays of the probe again and do nothing with what they hit: adds the ray caster's time on `threads`
// threads to *embree_seconds.
olx_result olx_capture_measure(olx_capture *capture, double *embree_seconds);

#endif
