// Shared by the viewer's C and GLSL. Both compilers read this file; view_passes.c asserts the offsets.
#ifndef OCTALUX_VIEW_SHARED_H
#define OCTALUX_VIEW_SHARED_H

#ifdef GL_core_profile
#define VIEW_GPU_STRUCT(name) struct name
#define view_gpu_uint uint
#define view_gpu_float float
#define view_gpu_vec2 vec2
#define view_gpu_vec4 vec4
#else
#include <stdint.h>
#define VIEW_GPU_STRUCT(name)                                                                                          \
  typedef struct name name;                                                                                            \
  struct name
#define view_gpu_uint uint32_t
#define view_gpu_float float
typedef struct view_gpu_vec2 {
  float x, y;
} view_gpu_vec2;
typedef struct view_gpu_vec4 {
  float x, y, z, w;
} view_gpu_vec4;
#endif

// Bindings of set 1 of the passes; set 0 is the field's.
#define VIEW_BINDING_DEPTH 0   // sampled, reversed
#define VIEW_BINDING_NORMAL 1  // sampled
#define VIEW_BINDING_COLOR 2   // storage, rgba16f
#define VIEW_BINDING_DISPLAY 3 // storage, rgba8
#define VIEW_BINDING_PICK 4    // storage buffer, view_gpu_pick
#define VIEW_BINDINGS 5

// Values of view_overlay in view_state.h.
#define VIEW_SHADE_BALL_INDEX 1
#define VIEW_SHADE_BALL_RADIANCE 2
#define VIEW_SHADE_BALL_IRRADIANCE 3
#define VIEW_SHADE_WEIGHTS 4
#define VIEW_SHADE_ANSWER 5
#define VIEW_SHADE_UNRESOLVED 6
#define VIEW_SHADE_STEPS 7

#define VIEW_FLAG_VISIBILITY 1
#define VIEW_FLAG_KEEP_BURIED 2
#define VIEW_FLAG_STORED 8 // light at the end of rays, as olx_hits
#define VIEW_FLAG_EYE_RAYS 4 // overlays show rays from the eye, not their reflections

#define VIEW_STEPS_LARGEST 512.0 // the brightest colour of the heat map

// Push constants of all of the viewer's passes.
VIEW_GPU_STRUCT(view_gpu_push) {
  view_gpu_vec4 matrix[4];    // columns; balls: world to clip; others: clip to world
  view_gpu_vec4 eye;          // w: depth of pixels without a surface
  view_gpu_uint width, height; // size of the lit images; for the map, of the window
  view_gpu_uint overlay, flags;
  view_gpu_uint tracer, select;
  view_gpu_uint probe; // probe whose map is shown, or ~0
  view_gpu_float exposure;
  view_gpu_vec2 pick;    // pixel of the lit images; for the map, its corner in pixels of the window
  view_gpu_float radius; // of balls, metres; for the map, pixels along a side
  view_gpu_float scale;  // lit pixels per pixel of the window
};

VIEW_GPU_STRUCT(view_gpu_pick) {
  view_gpu_vec4 position;  // origin of the ray; w: 1 when there is one
  view_gpu_vec4 normal;    // normal of the surface there
  view_gpu_vec4 direction; // w: distance to the hit, infinite for the sky
  view_gpu_uint status, probe, steps, tried;
};

#endif
