// An engine that reads exported irradiance volumes, as Bevy does: its loader for KTX 2.0, and its look-up with a linear
// filter; and the light of a scene's surfaces to compare with.
#ifndef OLX_TESTS_ENGINE_CUBES_H
#define OLX_TESTS_ENGINE_CUBES_H

#include "core/vec.h"

#include <octalux/export.h>
#include <octalux/scene.h>

// A loaded texture, and the transform that its file names.
typedef struct engine_volume {
  uint32_t size[3]; // texels
  olx_vec3 *texels; // x fastest, then y, then z
  double translation[3], scale[3];
  bool compressed;
} engine_volume;

// Loads a file and asserts that it is sound. Free it with engine_volume_free.
engine_volume engine_volume_load(const char *path);
void engine_volume_free(engine_volume *volume);

// Returns the light that the engine multiplies by albedo at a place in scene coordinates, with an intensity of 1.
olx_vec3 engine_light(const engine_volume *volume, olx_vec3 position, olx_vec3 normal);

// Points spread evenly over the sides of a scene's surfaces that probes see, with the irradiance that the field stores
// for them, in W/m^2; and points in free space with normals to all sides.
typedef struct lit_points {
  uint32_t count;
  olx_vec3 *positions, *normals, *irradiance;
} lit_points;

lit_points lit_surfaces(const olx_scene *scene, const olx_field *field, uint32_t tries);
lit_points lit_space(const olx_field *field, uint32_t tries);
void lit_points_free(lit_points *points);

// Returns the relative MSE of the engine's light: sum (a - b)^2 / sum b^2.
double engine_error(const engine_volume *volume, const lit_points *points);

#endif
