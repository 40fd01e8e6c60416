// Fits spherical harmonics to the surfaces that they will light, as surface_fit.h fits maps: finds the coefficients
// whose interpolation by the runtime's weights is closest to the measurements.
#ifndef OLX_BAKE_HARMONICS_FIT_H
#define OLX_BAKE_HARMONICS_FIT_H

#include "bake/irradiance/surface_fit.h"

// Corrects `coefficients`, olx_harmonics_count(bands) per probe, by the measurements of the last solved fit. On entry
// they hold the projection of exact irradiance.
olx_result olx_harmonics_fit(const olx_surface_fit *fit, uint32_t bands, olx_vec3 *coefficients, uint32_t probe_count);

#endif
