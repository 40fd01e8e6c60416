// Which pixel traces rays in a frame, for the passes that trace and the denoiser's. Twin of src/shade/ray_turn.h.
#ifndef OLX_RAY_TURN_GLSL
#define OLX_RAY_TURN_GLSL

#include "../octalux_shared.h"

// Returns the pixel that traces in this frame for the square of 2 x 2 around a pixel: itself where all trace.
ivec2 traced_pixel(uint flags, ivec2 pixel) {
  if ((flags & OLX_TURN_SPARSE) == 0u) return pixel;
  return pixel & ~1 | ivec2((flags & OLX_TURN_X) != 0u, (flags & OLX_TURN_Y) != 0u);
}

#endif
