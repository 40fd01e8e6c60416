// Which pixels trace rays in a frame: all of them, or one of each square of 2 x 2 pixels, in turn.
#ifndef OLX_SHADE_RAY_TURN_H
#define OLX_SHADE_RAY_TURN_H

#include <octalux/denoiser.h>

#include <stdbool.h>

typedef struct olx_ray_turn {
  uint32_t spacing; // side of a square
  uint32_t x, y;    // of the pixel that traces, within its square
} olx_ray_turn;

// Returns the turn of a frame. The pixels of a square take turns by (0, 0), (1, 1), (1, 0), (0, 1), so that two frames
// already reach every row and every column.
static inline olx_ray_turn olx_ray_turn_of(uint32_t spacing, uint32_t frame) {
  if (spacing == 1) return (olx_ray_turn){.spacing = 1};
  return (olx_ray_turn){.spacing = spacing, .x = (frame + 1) >> 1 & 1u, .y = frame & 1u};
}

static inline bool olx_ray_turn_is(const olx_ray_turn *turn, uint32_t x, uint32_t y) {
  return x % turn->spacing == turn->x && y % turn->spacing == turn->y;
}

// Returns the number of the ray that a pixel traces in its turn: how many rounds of turns precede the frame's.
static inline uint32_t olx_ray_turn_number(uint32_t spacing, uint32_t frame) { return frame / (spacing * spacing); }

#endif
