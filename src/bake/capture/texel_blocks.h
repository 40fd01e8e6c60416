// Blocks of 4 x 4 texels of a light field map, whose texels share what is looked up for them.
#ifndef OLX_BAKE_TEXEL_BLOCKS_H
#define OLX_BAKE_TEXEL_BLOCKS_H

#include "bake/capture/capture.h"
#include "block/geometry_block.h"
#include "scene/surface.h"

// How far the parts of one plane may lie from it, in footprints, and how far their normals may differ.
#define OLX_FLAT_FOOTPRINTS 0.25f
#define OLX_FLAT_COSINE 0.999f

// Returns the index of the i-th texel of a block in a map whose rows lie one after the other.
static inline uint32_t olx_block_texel(const olx_capture *capture, uint32_t block, uint32_t i) {
  const uint32_t blocks = capture->size / OLX_BLOCK_SIDE;
  const uint32_t x = block % blocks * OLX_BLOCK_SIDE + i % OLX_BLOCK_SIDE,
                 y = block / blocks * OLX_BLOCK_SIDE + i / OLX_BLOCK_SIDE;
  return y * capture->size + x;
}

// The surfaces that the texels of a block see, for the probe that was captured last, with vertex normals for shading.
typedef struct olx_block_surfaces {
  uint32_t seen; // bit i: texel i sees a surface, else the sky
  olx_surface surface[OLX_BLOCK_TEXELS];
} olx_block_surfaces;

void olx_block_look(const olx_capture *capture, uint32_t block, olx_block_surfaces *surfaces);

// Returns whether all texels see one plane.
bool olx_block_is_flat(const olx_capture *capture, uint32_t block, const olx_block_surfaces *surfaces);

// Returns whether a surface point lies on the surface of a texel, of this number in the map, near enough for both to
// share what is found for one.
bool olx_texel_shares(const olx_capture *capture, uint32_t texel, const olx_surface *surface, const olx_surface *other);

// Returns whether two texels of a block see one surface, near enough to each other to share what is found for one.
static inline bool olx_block_shares(const olx_capture *capture, uint32_t block, const olx_block_surfaces *surfaces,
                                    uint32_t texel, uint32_t other) {
  return olx_texel_shares(capture, olx_block_texel(capture, block, texel), &surfaces->surface[texel],
                          &surfaces->surface[other]);
}

#endif
