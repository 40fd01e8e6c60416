// Computes diffuse light of static surfaces from the texels of light field probes that see them (docs/maths.md, "Light
// on surfaces").
#ifndef OLX_SHADE_SURFACE_IRRADIANCE_H
#define OLX_SHADE_SURFACE_IRRADIANCE_H

#include "field/field_data.h"

#include <octalux/sample.h>

// A point of a surface. Directions are unit vectors; normals are on the side towards the eye.
typedef struct olx_surface_point {
  olx_vec3 position;         // metres
  olx_vec3 geometric_normal; // of the triangle; decides which texels see the same surface
  olx_vec3 vertex_normal;    // interpolated over the triangle; the normal for which texels hold irradiance
  olx_vec3 shading_normal;   // the vertex normal, bent by a normal map where there is one
  olx_vec3 view;             // to the eye
} olx_surface_point;

typedef struct olx_surface_light {
  olx_vec3 irradiance; // W/m^2
  uint32_t probes;     // number of probes that were blended; 0: nothing is stored for this surface, and the light is
                       // that of a surface close to it or of the volume
} olx_surface_light;

olx_surface_light olx_surface_light_at(const olx_field *field, const olx_sample_settings *settings,
                                       const olx_surface_point *point);

#endif
