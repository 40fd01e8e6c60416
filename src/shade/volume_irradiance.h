// Interpolates irradiance in free space between the probes of the irradiance volume.
#ifndef OLX_SHADE_VOLUME_IRRADIANCE_H
#define OLX_SHADE_VOLUME_IRRADIANCE_H

#include "field/field_data.h"

#include <octalux/sample.h>

// Irradiance at a place as a function of the normal.
typedef struct olx_volume_light_at {
  olx_vec3 coefficients[OLX_HARMONICS_MOST];
} olx_volume_light_at;

// Returns whether the field has a volume.
static inline bool olx_volume_answers(const olx_field *field) { return field->volume.header != NULL; }

// Interpolates irradiance around a place; false where the field has no volume or the volume no cell. `normal` is that
// of the surface at `position`.
bool olx_volume_gather(const olx_field *field, olx_vec3 position, olx_vec3 normal, olx_volume_light_at *light);
// Returns irradiance for one unit normal, at least 0.
olx_vec3 olx_volume_towards(const olx_volume_light_at *light, olx_vec3 normal);
// Returns irradiance for a normal bent by a normal map, without the share from below the surface with normal `smooth`.
// No light comes from there, but a place in free space in front of the surface sees the surface itself.
olx_vec3 olx_volume_bent(const olx_volume_light_at *light, olx_vec3 smooth, olx_vec3 bent);

#endif
