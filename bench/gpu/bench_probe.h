// The benchmark's own passes, which measure what the tested passes read per pixel, a lower bound of their time, and the
// copy bandwidth of the device.
#ifndef OCTALUX_BENCH_PROBE_H
#define OCTALUX_BENCH_PROBE_H

#include "gpu_pipeline.h"
#include "gpu_timer.h"
#include "rasteriser.h"

typedef struct bench_counts {
  double filtered;       // filtered texture reads of the diffuse pass, per pixel with a surface
  double most_filtered;  // maximum over pixels
  double texels;         // texel fetches of the diffuse pass, per pixel with a surface
  double fetched;        // texel fetches per glossy ray
  double steps, probes;  // texels that a ray passes, probes through which it is traced
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

// Runs the counting pass on the current G-buffer, for every `stride`th pixel.
bool bench_probe_count(gpu_device *device, const bench_probe *probe, const olx_vulkan_field *field,
                       const rasteriser *raster, const raster_view *view, olx_tracer tracer, olx_select select,
                       uint32_t stride, bench_counts *counts);

// Records the pass with the least work: its results replace irradiance (diffuse) or glossy light.
void bench_probe_floor(const gpu_device *device, const bench_probe *probe, const olx_vulkan_field *field,
                       const rasteriser *raster, const raster_view *view, bool glossy, VkCommandBuffer commands);

// Measures the copy bandwidth between two buffers of the device in gigabytes per second, reads plus writes: the best of
// `rounds`.
bool bench_copy_bandwidth(gpu_device *device, VkDeviceSize bytes, uint32_t rounds, double *gigabytes);

#endif
