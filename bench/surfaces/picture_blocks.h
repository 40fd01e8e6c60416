// Indirect diffuse light of pictures, summed over channels, and its comparison in blocks of 8 x 8 pixels.
#ifndef OCTALUX_BENCH_PICTURE_BLOCKS_H
#define OCTALUX_BENCH_PICTURE_BLOCKS_H

#include <octalux/render.h>

// Returns the mean light of an image.
double surface_mean_light(const olx_image *image);
// Returns the mean light of a block of `side` x `side` pixels.
double surface_block_light(const olx_image *image, uint32_t left, uint32_t top, uint32_t side);
// Computes the least and the greatest ratio of light over blocks of 8 x 8 pixels, at most and at least 1. Left out are
// blocks whose light in the reference is at most 1 % of its mean, and those with light in fewer than a quarter of the
// reference's pixels.
void surface_compare_blocks(const olx_image *image, const olx_image *reference, double *least, double *most);

#endif
