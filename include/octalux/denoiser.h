// Settings of the separated spatial-temporal denoiser of McGuire et al. 2017, section 5.1 (docs/denoising.md): a mean
// over frames, then a filter over pixels. olx_render_frames runs it on the CPU, olx_vulkan_record_denoise on a GPU.
//
// SPDX-License-Identifier: MIT
#ifndef OCTALUX_DENOISER_H
#define OCTALUX_DENOISER_H

#include <octalux/base.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

typedef struct olx_lobe_filter {
  uint32_t radius_pixels; // of the filter over pixels, 0 to 64; 0: no filter
  uint32_t stride_pixels; // between the pixels that the filter reads, 1 to 64; the mean distance where reach is above 0
  float history;          // largest share of earlier frames in a pixel, 0 to 0.999
  float still_history;    // largest share of earlier frames where the surface has not moved in the picture, 0 to 0.999
  float reach;            // finite, at least 0; 0: the radius alone. Above 0, kernels also narrow as frames add up: of
                          // diffuse light to `reach` mean distances of what rays found, of glossy light to that share
                          // of the lobe's width, both over the root of the number of frames
} olx_lobe_filter;

typedef struct olx_denoise_settings {
  olx_lobe_filter diffuse, glossy;
  // Distance between the rays of a frame along rows and columns, 1 or 2 pixels; default 1. With 2, each square of 2 x 2
  // pixels traces one ray a lobe and frame, its pixels in turn: a quarter of the rays.
  uint32_t ray_spacing;
} olx_denoise_settings;

// Returns the published settings with a reach of 2.5 for diffuse and 0.6 for glossy light, whose share of earlier
// frames is 98 % where the surface has not moved in the picture.
olx_denoise_settings olx_denoise_settings_default(void);
// Returns the paper's settings: 12 pixels, stride 2, 98 % for diffuse light; 3 pixels, stride 1, 75 % for glossy light.
olx_denoise_settings olx_denoise_settings_published(void);
// Returns settings that filter nothing, so that every frame shows its rays as they are.
olx_denoise_settings olx_denoise_settings_none(void);

// Returns OLX_ERROR_ARGUMENT, with a message, when a number is out of range.
olx_result olx_denoise_settings_check(const olx_denoise_settings *settings);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
