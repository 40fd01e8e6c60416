// Packs a probe's spherical harmonics of irradiance as half floats, evaluates them in a direction, and finds codes that
// no writer stores.
#include "field/harmonic_data.h"

// Packs a value as a half float; values beyond its range are clamped so that they stay finite.
static uint16_t pack_finite(float value) { return olx_half_pack(olx_clamp(value, -OLX_HALF_MOST, OLX_HALF_MOST)); }

void olx_harmonics_pack(const olx_vec3 *coefficients, uint32_t bands, uint16_t halves[OLX_HARMONICS_MOST_HALVES]) {
  const uint32_t count = olx_harmonics_count(bands);
  for (uint32_t i = 0; i < count; i++) {
    // Ringing may make the mean of zero light slightly negative.
    const olx_vec3 c = i == 0 ? olx_max_each(coefficients[0], olx_splat(0.0f)) : coefficients[i];
    halves[3 * i] = pack_finite(c.x);
    halves[3 * i + 1] = pack_finite(c.y);
    halves[3 * i + 2] = pack_finite(c.z);
  }
  for (uint32_t i = 3 * count; i < olx_harmonics_halves(bands); i++) halves[i] = 0;
}

olx_vec3 olx_harmonics_irradiance(const uint16_t *halves, uint32_t bands, const float values[OLX_HARMONICS_MOST]) {
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < olx_harmonics_count(bands); i++) {
    sum = olx_madd(sum, olx_harmonics_coefficient(halves, i), values[i]);
  }
  return sum;
}

uint32_t olx_harmonics_first_bad(const uint16_t *halves, uint32_t bands) {
  const uint32_t used = 3 * olx_harmonics_count(bands), all = olx_harmonics_halves(bands);
  for (uint32_t i = 0; i < all; i++) {
    const bool infinite = (halves[i] & 0x7C00u) == 0x7C00u, negative_mean = i < 3 && halves[i] & 0x8000u;
    if (infinite || negative_mean || (i >= used && halves[i] != 0)) return i;
  }
  return all;
}
