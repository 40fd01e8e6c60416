// Evaluates the solved light at a surface: interpolated between records (light_records.h), or gathered by rays where
// interpolation is unreliable.
#ifndef OLX_LIGHT_LIGHT_LOOKUP_H
#define OLX_LIGHT_LIGHT_LOOKUP_H

#include "light/links/kept_gathers.h"
#include "light/solution/light_solution.h"

// Interpolates indirect irradiance in W/m^2. Returns false where records do not determine it.
bool olx_light_interpolate(const olx_scene_light *light, const olx_surface *surface, olx_vec3 *irradiance);
// Interpolates the irradiance of one bounce less, from however few records there are.
olx_vec3 olx_light_interpolate_before(const olx_scene_light *light, const olx_surface *surface);
// Returns whether light varies so much between the records around one of them that their cells are divided.
bool olx_light_varies(const olx_scene_light *light, const olx_surface *surface);

// Returns indirect irradiance in W/m^2 by `batches` times OLX_GATHER_RAYS rays from the surface. `row` keeps what they
// find; it may be NULL.
olx_vec3 olx_light_gather(const olx_scene_light *light, const olx_surface *surface, uint32_t batches,
                          olx_gather_row *row);

// The rays that a point casts of its own, and the standard error that is expected of them, as a share of the light of
// the records around it; 0 without records.
typedef struct olx_gather_plan {
  uint32_t batches; // as many as bring the error to its bound, or the most that there are
  float error;
} olx_gather_plan;

olx_gather_plan olx_light_plan_gather(const olx_scene_light *light, const olx_surface *surface);
// Returns the number of batches that a record casts in the cell of a surfel.
uint32_t olx_light_record_batches(const olx_scene_light *light, uint32_t surfel);

#endif
