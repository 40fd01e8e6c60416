// Checks that the structs of shaders/octalux_shared.h have the layout of std140 and std430 in C, and that its numbers
// equal those of the headers.
#ifndef OLX_VULKAN_GPU_STRUCTS_H
#define OLX_VULKAN_GPU_STRUCTS_H

#include "shaders/octalux_shared.h"

#include <octalux/vulkan.h>

#include <stddef.h>

_Static_assert(sizeof(olx_gpu_grid) == 48 && offsetof(olx_gpu_grid, spacing) == 16 &&
                   offsetof(olx_gpu_grid, count) == 32,
               "std140");
_Static_assert(sizeof(olx_gpu_field) == 256 && offsetof(olx_gpu_field, irradiance_grid) == 48 &&
                   offsetof(olx_gpu_field, scene_min) == 96 && offsetof(olx_gpu_field, scene_max) == 112 &&
                   offsetof(olx_gpu_field, probe_count) == 128 && offsetof(olx_gpu_field, n) == 132 &&
                   offsetof(olx_gpu_field, least_nodes) == 136 && offsetof(olx_gpu_field, maps_a_side) == 140 &&
                   offsetof(olx_gpu_field, irradiance_n) == 144 &&
                   offsetof(olx_gpu_field, irradiance_maps_a_side) == 148 &&
                   offsetof(olx_gpu_field, irradiance_texel) == 152 && offsetof(olx_gpu_field, distance_scale) == 156 &&
                   offsetof(olx_gpu_field, select_mask) == 160 && offsetof(olx_gpu_field, pyramid_levels) == 164 &&
                   offsetof(olx_gpu_field, bricks_first) == 168 && offsetof(olx_gpu_field, voronoi_first) == 172 &&
                   offsetof(olx_gpu_field, emission_first) == 176 && offsetof(olx_gpu_field, tiles_first) == 180 &&
                   offsetof(olx_gpu_field, tile_side) == 184 && offsetof(olx_gpu_field, tile_count) == 188 &&
                   offsetof(olx_gpu_field, lights_first) == 192 && offsetof(olx_gpu_field, light_count) == 196 &&
                   offsetof(olx_gpu_field, last_bounce) == 200 && offsetof(olx_gpu_field, volume_first) == 204 &&
                   offsetof(olx_gpu_field, pyramid_first) == 208 && offsetof(olx_gpu_field, surface_scale) == 224 &&
                   offsetof(olx_gpu_field, surface_border) == 228 && offsetof(olx_gpu_field, compressed) == 232 &&
                   offsetof(olx_gpu_field, planes_first) == 236 && offsetof(olx_gpu_field, plane_count) == 240 &&
                   offsetof(olx_gpu_field, geometry_scale) == 244,
               "std140");
_Static_assert(sizeof(olx_gpu_probe) == 16 && offsetof(olx_gpu_probe, flags) == 12, "std430");
_Static_assert(sizeof(olx_gpu_frame) == 128 && offsetof(olx_gpu_frame, eye) == 64 &&
                   offsetof(olx_gpu_frame, width) == 80 &&
                   offsetof(olx_gpu_frame, height) == 84 && offsetof(olx_gpu_frame, flags) == 88 &&
                   offsetof(olx_gpu_frame, max_probes) == 92 && offsetof(olx_gpu_frame, glossy_samples) == 96 &&
                   offsetof(olx_gpu_frame, sample_index) == 100 && offsetof(olx_gpu_frame, dim_lobe) == 104 &&
                   offsetof(olx_gpu_frame, seed) == 108 && offsetof(olx_gpu_frame, diffuse_samples) == 112 &&
                   offsetof(olx_gpu_frame, surface_tolerance) == 116,
               "std430; every device has 128 bytes of push constants");
_Static_assert(sizeof(olx_gpu_accumulate) == 128 && offsetof(olx_gpu_accumulate, before) == 48 &&
                   offsetof(olx_gpu_accumulate, size) == 96 && offsetof(olx_gpu_accumulate, flags) == 100 &&
                   offsetof(olx_gpu_accumulate, empty_depth) == 104 &&
                   offsetof(olx_gpu_accumulate, diffuse_history) == 108 &&
                   offsetof(olx_gpu_accumulate, glossy_still_history) == 120,
               "std430");
_Static_assert(sizeof(olx_gpu_filter) == 80 && offsetof(olx_gpu_filter, size) == 48 &&
                   offsetof(olx_gpu_filter, radius_pixels) == 56 && offsetof(olx_gpu_filter, stride_pixels) == 60 &&
                   offsetof(olx_gpu_filter, reach) == 64 && offsetof(olx_gpu_filter, dim_lobe) == 68,
               "std430");

_Static_assert(sizeof(olx_gpu_light) == 80 && sizeof(olx_gpu_light) == OLX_LIGHT_WORDS * sizeof(uint32_t) &&
                   offsetof(olx_gpu_light, type) == 64 && offsetof(olx_gpu_light, cosine_outer) == 76,
               "std430");
_Static_assert(sizeof(olx_gpu_relight) == 96 && offsetof(olx_gpu_relight, lights) == 20 &&
                   offsetof(olx_gpu_relight, direct) == 28 && offsetof(olx_gpu_relight, tile_light) == 56 &&
                   offsetof(olx_gpu_relight, link_starts) == 68 && offsetof(olx_gpu_relight, entry_starts) == 76 &&
                   offsetof(olx_gpu_relight, volume_light) == 92,
               "std430");
_Static_assert(sizeof(olx_gpu_relight_call) == 32 && offsetof(olx_gpu_relight_call, flags) == 28, "std430");

_Static_assert(OLX_DENOISE_DIFFUSE == OLX_VULKAN_LOBE_DIFFUSE && OLX_DENOISE_GLOSSY == OLX_VULKAN_LOBE_GLOSSY,
               "flags are lobes");

#endif
