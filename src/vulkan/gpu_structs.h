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
_Static_assert(
    sizeof(olx_field_constants) == 288 && offsetof(olx_field_constants, irradiance_grid) == 48 &&
        offsetof(olx_field_constants, scene_min) == 96 && offsetof(olx_field_constants, scene_max) == 112 &&
        offsetof(olx_field_constants, probe_count) == 128 && offsetof(olx_field_constants, n) == 132 &&
        offsetof(olx_field_constants, least_nodes) == 136 && offsetof(olx_field_constants, maps_a_side) == 140 &&
        offsetof(olx_field_constants, irradiance_n) == 144 &&
        offsetof(olx_field_constants, irradiance_maps_a_side) == 148 &&
        offsetof(olx_field_constants, irradiance_texel) == 152 &&
        offsetof(olx_field_constants, distance_scale) == 156 && offsetof(olx_field_constants, select_mask) == 160 &&
        offsetof(olx_field_constants, pyramid_levels) == 164 && offsetof(olx_field_constants, bricks_first) == 168 &&
        offsetof(olx_field_constants, voronoi_first) == 172 && offsetof(olx_field_constants, emission_first) == 176 &&
        offsetof(olx_field_constants, tiles_first) == 180 && offsetof(olx_field_constants, tile_side) == 184 &&
        offsetof(olx_field_constants, tile_count) == 188 && offsetof(olx_field_constants, lights_first) == 192 &&
        offsetof(olx_field_constants, light_count) == 196 && offsetof(olx_field_constants, last_bounce) == 200 &&
        offsetof(olx_field_constants, volume_first) == 204 && offsetof(olx_field_constants, pyramid_first) == 208 &&
        offsetof(olx_field_constants, map_scale) == 224 && offsetof(olx_field_constants, tiled) == 228 &&
        offsetof(olx_field_constants, compressed) == 232 && offsetof(olx_field_constants, planes_first) == 236 &&
        offsetof(olx_field_constants, plane_count) == 240 && offsetof(olx_field_constants, geometry_scale) == 244 &&
        offsetof(olx_field_constants, tile_words) == 256 && offsetof(olx_field_constants, tile_blocks) == 272,
    "std140");
_Static_assert(sizeof(olx_gpu_probe) == 16 && offsetof(olx_gpu_probe, flags) == 12, "std430");
_Static_assert(sizeof(olx_frame_constants) == 128 && offsetof(olx_frame_constants, eye) == 64 &&
                   offsetof(olx_frame_constants, width) == 80 && offsetof(olx_frame_constants, height) == 84 &&
                   offsetof(olx_frame_constants, flags) == 88 && offsetof(olx_frame_constants, max_probes) == 92 &&
                   offsetof(olx_frame_constants, glossy_samples) == 96 &&
                   offsetof(olx_frame_constants, sample_index) == 100 &&
                   offsetof(olx_frame_constants, dim_lobe) == 104 && offsetof(olx_frame_constants, seed) == 108 &&
                   offsetof(olx_frame_constants, diffuse_samples) == 112 &&
                   offsetof(olx_frame_constants, surface_tolerance) == 116,
               "std430; every device has 128 bytes of push constants");
_Static_assert(sizeof(olx_accumulate_constants) == 128 && offsetof(olx_accumulate_constants, before) == 48 &&
                   offsetof(olx_accumulate_constants, size) == 96 && offsetof(olx_accumulate_constants, flags) == 100 &&
                   offsetof(olx_accumulate_constants, empty_depth) == 104 &&
                   offsetof(olx_accumulate_constants, diffuse_history) == 108 &&
                   offsetof(olx_accumulate_constants, glossy_still_history) == 120,
               "std430");
_Static_assert(sizeof(olx_filter_constants) == 80 && offsetof(olx_filter_constants, size) == 48 &&
                   offsetof(olx_filter_constants, radius_pixels) == 56 &&
                   offsetof(olx_filter_constants, stride_pixels) == 60 && offsetof(olx_filter_constants, reach) == 64 &&
                   offsetof(olx_filter_constants, dim_lobe) == 68,
               "std430");

_Static_assert(sizeof(olx_gpu_light) == 80 && sizeof(olx_gpu_light) == OLX_LIGHT_WORDS * sizeof(uint32_t) &&
                   offsetof(olx_gpu_light, type) == 64 && offsetof(olx_gpu_light, cosine_outer) == 76,
               "std430");
_Static_assert(sizeof(olx_gpu_relight) == 116 && offsetof(olx_gpu_relight, lights) == 28 &&
                   offsetof(olx_gpu_relight, direct) == 36 && offsetof(olx_gpu_relight, tile_light) == 76 &&
                   offsetof(olx_gpu_relight, link_starts) == 88 && offsetof(olx_gpu_relight, entry_starts) == 96 &&
                   offsetof(olx_gpu_relight, volume_light) == 112,
               "std430");
_Static_assert(sizeof(olx_gpu_relight_call) == 32 && offsetof(olx_gpu_relight_call, flags) == 28, "std430");

_Static_assert(OLX_DENOISE_DIFFUSE == OLX_VULKAN_LOBE_DIFFUSE && OLX_DENOISE_GLOSSY == OLX_VULKAN_LOBE_GLOSSY,
               "flags are lobes");

#endif
