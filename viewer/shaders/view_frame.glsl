// Shared by the viewer's shaders: the field, their constants, colours.
#ifndef VIEW_FRAME_GLSL
#define VIEW_FRAME_GLSL

#include "lib/octalux.glsl"
#include "view_shared.h"

layout(push_constant, std430) uniform view_push_block { view_gpu_push view; };

bool has_flag(uint flag) { return (view.flags & flag) != 0u; }

olx_sample_settings view_settings(bool emitters) {
  uint hits = has_flag(VIEW_FLAG_STORED) ? OLX_HITS_STORED : OLX_HITS_SHADED;
  return olx_sample_settings(view.tracer, view.select, has_flag(VIEW_FLAG_VISIBILITY),
                             olx_sample_settings_default().max_probes, has_flag(VIEW_FLAG_KEEP_BURIED), emitters,
                             hits, 0.0);
}

vec3 srgb(vec3 linear) {
  return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, greaterThan(linear, vec3(0.0031308)));
}

// Applies the tone map of the library's .png files.
vec3 tone(vec3 radiance) {
  const float knee = 0.6, rest = 1.0 - knee;
  vec3 x = max(radiance * view.exposure, vec3(0.0));
  return srgb(mix(x, knee + rest * (1.0 - exp((knee - x) / rest)), greaterThan(x, vec3(knee))));
}

// Returns the light that a texel of a light field probe sends to the probe: as stored, or from its surface in a field
// without probe light.
vec3 seen_light(uint probe, ivec2 texel) {
  ivec3 map = olx_map_origin(probe);
  if (olx_field.irradiance_grid.count.w != 0u) return olx_texel_radiance(map, texel);
  float distance = olx_texel_distance(map, texel);
  if (isinf(distance)) return olx_texel_emission(probe, texel);
  vec3 direction = olx_texel_direction(uvec2(texel), olx_field.n);
  olx_reflection light = olx_texel_shade(map, texel, olx_probe_position(probe) + direction * distance, direction, false);
  return light.reflected + light.lobe + (olx_texel_emits(probe, texel) ? olx_texel_emission(probe, texel) : vec3(0.0));
}

vec3 hue(float h) { return clamp(abs(fract(h + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0); }

// Returns a colour for an index; neighbouring indices get clearly different colours.
vec3 probe_color(uint probe) {
  float h = fract(float(probe) * 0.61803399 + 0.04);
  float pale = 0.25 + 0.25 * float(probe / 3u % 2u), dim = probe / 7u % 3u == 1u ? 0.75 : 1.0;
  return mix(hue(h), vec3(1.0), pale) * dim;
}

// Returns the colour of a heat map for 0 to 1: dark violet over red and orange to pale yellow.
vec3 heat(float x) {
  const vec3 stops[6] = vec3[6](vec3(0.03, 0.02, 0.12), vec3(0.30, 0.07, 0.48), vec3(0.66, 0.18, 0.44),
                                vec3(0.94, 0.38, 0.27), vec3(0.99, 0.70, 0.32), vec3(0.99, 0.98, 0.75));
  float at = clamp(x, 0.0, 1.0) * 5.0;
  int below = min(int(at), 4);
  return mix(stops[below], stops[below + 1], at - float(below));
}

#endif
