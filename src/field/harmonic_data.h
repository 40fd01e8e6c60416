// Irradiance of a probe as spherical harmonics (docs/format.md, "IRSH"): the coefficients of core/harmonics.h one after
// the other, red, green and blue of each, as halves, in whole words.
#ifndef OLX_FIELD_HARMONIC_DATA_H
#define OLX_FIELD_HARMONIC_DATA_H

#include "core/harmonics.h"
#include "core/pack.h"

#include <octalux/field.h>

enum { OLX_HARMONICS_MOST_HALVES = 28 };

// 0 for octahedral maps.
static inline uint32_t olx_irradiance_bands(olx_irradiance_form form) {
  return form == OLX_IRRADIANCE_OCTAHEDRAL ? 0 : (uint32_t)form + 1;
}

// Halves of a probe's record; an odd number of them is followed by a zero.
static inline uint32_t olx_harmonics_halves(uint32_t bands) { return (3 * olx_harmonics_count(bands) + 1) & ~1u; }

void olx_harmonics_pack(const olx_vec3 *coefficients, uint32_t bands, uint16_t halves[OLX_HARMONICS_MOST_HALVES]);

static inline olx_vec3 olx_harmonics_coefficient(const uint16_t *halves, uint32_t index) {
  const uint16_t *rgb = halves + 3 * (size_t)index;
  return olx_v3(olx_half_unpack(rgb[0]), olx_half_unpack(rgb[1]), olx_half_unpack(rgb[2]));
}

// Irradiance in the direction whose values olx_harmonics_at gave. What the bands cut off rings: it may be below 0.
olx_vec3 olx_harmonics_irradiance(const uint16_t *halves, uint32_t bands, const float values[OLX_HARMONICS_MOST]);

// The first code of a record that cannot be: a number that is not finite, a mean below 0, a filling that is not 0. The
// number of halves when there is none.
uint32_t olx_harmonics_first_bad(const uint16_t *halves, uint32_t bands);

#endif
