// Fits ambient cubes to surfaces, as an engine's look-up will show them.
#ifndef OLX_EXPORT_CUBE_FIT_H
#define OLX_EXPORT_CUBE_FIT_H

#include "core/parallel.h"
#include "export/cube_points.h"

enum { OLX_CUBE_FIT_ROUNDS = 32 };

// Changes captured cubes so that look-ups at the points come closest to their light: least squares over all values at
// least 0, with a small weight that keeps values near what was captured. Values are the same to the last bit at any
// number of threads.
olx_result olx_cubes_fit(olx_cubes *cubes, const olx_cube_points *points, uint32_t threads, olx_task *task);

// How well look-ups show surfaces.
typedef struct olx_cubes_errors {
  uint32_t points;     // of surfaces
  double relative_mse; // sum of squared differences over the sum of squares; 0 without light
} olx_cubes_errors;

olx_cubes_errors olx_cubes_compare(const olx_cubes *cubes, const olx_cube_points *points);

#endif
