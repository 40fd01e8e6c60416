// The functions of libm that src/block needs, where there is no libm: instructions of WebAssembly.
#ifndef OLX_FREESTANDING_MATH_H
#define OLX_FREESTANDING_MATH_H

#define INFINITY __builtin_inff()
#define sqrtf __builtin_sqrtf
#define fabsf __builtin_fabsf
#define isfinite __builtin_isfinite
#define floorf __builtin_floorf
#define rintf __builtin_rintf

static inline float fminf(float a, float b) { return a < b ? a : b; }
static inline float fmaxf(float a, float b) { return a > b ? a : b; }

#endif
