// Perceptual metrics of the similarity of two images. Both take 8-bit sRGB, 3 bytes per pixel, rows from the top.
#ifndef OLX_RENDER_PERCEPTUAL_H
#define OLX_RENDER_PERCEPTUAL_H

#include <octalux/render.h>

// Computes the mean structural similarity (Wang et al. 2004) of Rec.709 luma of the sRGB values, with a dynamic range
// of 1: 11 x 11 Gaussian windows of sigma 1.5 that lie inside the image, K1 = 0.01, K2 = 0.03. NaN when no window fits.
olx_result olx_ssim(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height, double *ssim);

// Computes LDR-FLIP (Andersson et al. 2020) of every pixel, 0 to 1, into map[width * height]. pixels_per_degree at most
// OLX_FLIP_MAX_PIXELS_PER_DEGREE.
olx_result olx_flip(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height, float pixels_per_degree,
                    uint32_t threads, float *map);
#define OLX_FLIP_MAX_PIXELS_PER_DEGREE 1000.0f

#endif
