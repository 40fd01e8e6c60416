// Fitting spherical harmonics to the surfaces they will light, as surface_fit.h fits maps: the harmonics that
// interpolation by the runtime's weights takes closest to what was measured there.
#ifndef OLX_BAKE_HARMONICS_FIT_H
#define OLX_BAKE_HARMONICS_FIT_H

#include "bake/surface_fit.h"

// `coefficients`, olx_harmonics_count(bands) a probe, are those of exact irradiance, and are corrected by the
// measurements of the fit that was solved last.
olx_result olx_harmonics_fit(const olx_surface_fit *fit, uint32_t bands, olx_vec3 *coefficients, uint32_t probe_count);

#endif
