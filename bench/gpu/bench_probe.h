// The benchmark's own passes: what the passes under test read for a pixel, the least that they could take, and how fast
// the device copies.
#ifndef OCTALUX_BENCH_PROBE_H
#define OCTALUX_BENCH_PROBE_H

#include "gpu_pipeline.h"
#include "gpu_timer.h"
#include "rasteriser.h"

typedef struct bench_counts {
  double filtered;       // filtered texture reads of the diffuse pass, a pixel with a surface
  double most_filtered;  // of one pixel
  double texels;         // texel fetches of the diffuse pass, a pixel with a surface
  double fetched;        // texel fetches a glossy ray
  double steps, probes;  // texels that the ray passes, probes that it is traced through
  double surfaces, rays; // shares of all pixels
  double unresolved;     // share of the rays
} bench_counts;

typedef struct bench_probe {
  gpu_set counts_set, floor_set;
  gpu_buffer counted;
  VkSampler sampler;
  gpu_compute counts, floor;
} bench_probe;

bool bench_probe_create(gpu_device *device, const olx_vulkan_field *field, const rasteriser *raster,
                        bench_probe *probe);
void bench_probe_destroy(gpu_device *device, bench_probe *probe);

// Run the counting pass on the G-buffer as it is. Every `stride`th pixel is looked at.
bool bench_probe_count(gpu_device *device, const bench_probe *probe, const olx_vulkan_field *field,
                       const rasteriser *raster, const raster_view *view, olx_tracer tracer, olx_select select,
                       uint32_t stride, bench_counts *counts);

// Record the pass that does the least: its results replace irradiance (diffuse) or glossy light.
void bench_probe_floor(const gpu_device *device, const bench_probe *probe, const olx_vulkan_field *field,
                       const rasteriser *raster, const raster_view *view, bool glossy, VkCommandBuffer commands);

// Gigabytes a second, reading and writing together, of copies between two buffers of the device: the best of `rounds`.
bool bench_copy_bandwidth(gpu_device *device, VkDeviceSize bytes, uint32_t rounds, double *gigabytes);

#endif
