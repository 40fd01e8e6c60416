// Interpolates irradiance from probes with prefiltered visibility (McGuire et al. 2017, section 5.2).
#ifndef OLX_SHADE_IRRADIANCE_H
#define OLX_SHADE_IRRADIANCE_H

#include "field/maps.h"
#include "select/cage.h"

#include <octalux/sample.h>

// The source of irradiance: the packed maps or spherical harmonics of a field, or a baker's float maps. Maps carry a
// one-texel border (field/field_data.h); sizes are without it.
typedef struct olx_irradiance_source {
  olx_grid grid;
  const uint8_t *flags; // OLX_PROBE_*, one a probe; NULL where there are no probes
  float distance_scale; // moments times this are metres (and square metres, times its square)
  uint32_t irradiance_n, moments_n;
  const uint32_t *packed_irradiance, *packed_moments; // where NULL, the float maps below
  const olx_vec3 *irradiance;
  const olx_vec2 *moments;   // mean distance, mean squared distance
  const uint16_t *harmonics; // replace irradiance maps where `bands` is not 0; `harmonic_halves` a probe
  uint32_t bands, harmonic_halves;
} olx_irradiance_source;

olx_irradiance_source olx_irradiance_source_of(const olx_field *field);

// The terms of a probe's weight, each of which bench and audit can leave out.
enum {
  OLX_WEIGHT_TRILINEAR = 1,
  OLX_WEIGHT_BACK_FACE = 2, // a smooth test of the side of the surface on which the probe lies
  OLX_WEIGHT_CHEBYSHEV = 4, // variance test on the filtered distance
  OLX_WEIGHT_SHARPEN = 8,   // the cube of the Chebyshev bound
  OLX_WEIGHT_BIAS = 16,     // moves the point that is tested off its surface, towards the viewer
  OLX_WEIGHT_CRUSH = 32,    // presses small weights down further
  OLX_WEIGHT_ALL = 63
};

olx_vec3 olx_irradiance_from(const olx_irradiance_source *source, const olx_sample_settings *settings,
                             olx_vec3 position, olx_vec3 normal, olx_vec3 view);

// The probes from which a point's irradiance comes, and their weights, which sum to 1, or to 0 where no probe is
// usable: every probe there is buried (inside geometry), or there is none.
typedef struct olx_irradiance_weights {
  uint32_t count;
  uint32_t probe[16];
  float weight[16];
} olx_irradiance_weights;

olx_irradiance_weights olx_irradiance_weigh(const olx_irradiance_source *source, uint32_t terms, bool keep_buried,
                                            olx_vec3 position, olx_vec3 normal, olx_vec3 view);

// Interpolates irradiance for two normals, both with the weights that the probes around the point have for the first.
void olx_irradiance_both(const olx_irradiance_source *source, const olx_sample_settings *settings, olx_vec3 position,
                         const olx_vec3 normals[2], olx_vec3 view, olx_vec3 irradiance[2]);

// Interpolates irradiance as olx_irradiance does, with a choice of the terms that weigh probes.
olx_vec3 olx_irradiance_terms(const olx_irradiance_source *source, uint32_t terms, bool keep_buried, olx_vec3 position,
                              olx_vec3 normal, olx_vec3 view);

#endif
