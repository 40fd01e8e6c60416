// Rows of the baseline: irradiance probes without visibility.
#version 460
#extension GL_GOOGLE_include_directive : require
#define OLX_CLASSIC_SET 2
#include "parity.glsl"
#include "shaders/lib/classic.glsl"

void classic_rows() {
  uint size = olx_classic[OLX_CLASSIC_SIZE];
  olx_classic_weights weights;
  switch (row) {
  case ROW_olx_classic_color:
    put(olx_classic_color(olx_classic[OLX_CLASSIC_IRRADIANCE] + (size + 2u) * (size + 2u) * irradiance_probe, size,
                          random.xy));
    break;
  case ROW_olx_classic_vector: put(olx_classic_vector(olx_classic[OLX_CLASSIC_BOXES] + 6u * irradiance_probe)); break;
  case ROW_olx_classic_parallax: put(olx_classic_parallax(irradiance_probe, point, direction)); break;
  case ROW_olx_classic_reflectance: put(olx_classic_reflectance(1.2 * random.x - 0.1, 1.2 * random.y - 0.1)); break;
  case ROW_olx_classic_side: put(olx_classic_side(bits.y % OLX_CLASSIC_LEVELS)); break;
  case ROW_olx_classic_radiance: put(olx_classic_radiance(irradiance_probe, direction, 1.2 * random.z - 0.1)); break;
  case ROW_olx_classic_weigh:
    weights = olx_classic_weigh(settings, point);
    put(weights.count);
    for (uint i = 0u; i < weights.count; i++) put(weights.probe[i]), put(weights.weight[i]);
    break;
  case ROW_olx_classic_irradiance: put(olx_classic_irradiance(settings, point, direction)); break;
  case ROW_olx_classic_glossy:
    put(olx_classic_glossy(settings, point, direction, view, random.x, abs(view), random.y));
    break;
  }
}

void main() {
  begin();
  classic_rows();
}
