// Irradiance of a probe as spherical harmonics (docs/format.md, "Spherical harmonics"): the coefficients of
// core/harmonics.h in order, red, green and blue of each, as half floats, padded to whole words.
#ifndef OLX_FIELD_HARMONIC_DATA_H
#define OLX_FIELD_HARMONIC_DATA_H

#include "core/harmonics.h"
#include "core/pack.h"

#include <octalux/field.h>

enum { OLX_HARMONICS_MOST_HALVES = 28 };

// Returns the number of bands of an irradiance form; 0 for octahedral maps.
static inline uint32_t olx_irradiance_bands(olx_irradiance_form form) {
  return form == OLX_IRRADIANCE_OCTAHEDRAL ? 0 : (uint32_t)form + 1;
}

// Returns the number of half floats in a probe's record; an odd number is padded with a zero.
static inline uint32_t olx_harmonics_halves(uint32_t bands) { return (3 * olx_harmonics_count(bands) + 1) & ~1u; }

void olx_harmonics_pack(const olx_vec3 *coefficients, uint32_t bands, uint16_t halves[OLX_HARMONICS_MOST_HALVES]);

static inline olx_vec3 olx_harmonics_coefficient(const uint16_t *halves, uint32_t index) {
  const uint16_t *rgb = halves + 3 * (size_t)index;
  return olx_v3(olx_half_unpack(rgb[0]), olx_half_unpack(rgb[1]), olx_half_unpack(rgb[2]));
}

// Evaluates irradiance in the direction whose values olx_harmonics_at gave. Truncation of the series causes ringing, so
// the result may be below 0.
olx_vec3 olx_harmonics_irradiance(const uint16_t *halves, uint32_t bands, const float values[OLX_HARMONICS_MOST]);

// Returns the index of the first invalid code of a record: a number that is not finite, a mean below 0, or padding that
// is not 0. Returns the number of half floats when there is none.
uint32_t olx_harmonics_first_bad(const uint16_t *halves, uint32_t bands);

#endif
