// Twin of src/shade/classic.c: the classic method, irradiance probes without visibility, which light field probes
// replace (docs/maths.md, "The baseline"). It is not part of octalux.glsl, because it needs a descriptor set of its
// own, with the classic maps as one buffer of words.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_CLASSIC_GLSL
#define OLX_CLASSIC_GLSL

#include "irradiance.glsl"

#ifndef OLX_CLASSIC_SET
#define OLX_CLASSIC_SET 3
#endif

// The buffer begins with the words of the header, which hold the offsets of the parts (src/vulkan/vulkan_classic.c).
layout(set = OLX_CLASSIC_SET, binding = 0, std430) readonly buffer olx_classic_block { uint olx_classic[]; };

struct olx_classic_weights {
  uint count;
  uint probe[9];
  float weight[9];
};

// Interpolates bilinearly in a bordered map of n x n texels that begins at a word.
vec3 olx_classic_color(uint map, uint n, vec2 uv) {
  precise vec2 at = uv * float(n) - 0.5;
  vec2 first = clamp(floor(at), vec2(-1.0), vec2(float(n) - 1.0)), part = clamp(at - first, vec2(0.0), vec2(1.0));
  uint stride = n + 2u, word = map + uint(int(first.y) + 1) * stride + uint(int(first.x) + 1);
  vec3 near = mix(olx_r11g11b10f_unpack(olx_classic[word]), olx_r11g11b10f_unpack(olx_classic[word + 1u]), part.x);
  word += stride;
  vec3 far = mix(olx_r11g11b10f_unpack(olx_classic[word]), olx_r11g11b10f_unpack(olx_classic[word + 1u]), part.x);
  return mix(near, far, part.y);
}

vec3 olx_classic_vector(uint word) {
  return vec3(uintBitsToFloat(olx_classic[word]), uintBitsToFloat(olx_classic[word + 1u]),
              uintBitsToFloat(olx_classic[word + 2u]));
}

// Returns the direction in which the probe sees what the ray from `position` along `direction` meets, if the probe's
// surroundings are its box.
vec3 olx_classic_parallax(uint probe, vec3 position, vec3 direction) {
  uint box = olx_classic[OLX_CLASSIC_BOXES] + 6u * probe;
  vec3 low = olx_classic_vector(box), high = olx_classic_vector(box + 3u), from = clamp(position, low, high);
  float t = OLX_INFINITY;
  for (int axis = 0; axis < 3; axis++) {
    if (direction[axis] == 0.0) continue;
    t = min(t, ((direction[axis] > 0.0 ? high[axis] : low[axis]) - from[axis]) / direction[axis]);
  }
  vec3 seen = from + direction * t - olx_irradiance_probe_position(probe);
  float distance = length(seen);
  return distance > 0.0 && distance < OLX_INFINITY ? seen / distance : direction;
}

// Returns scale and bias of F0, for the cosine between normal and eye.
vec2 olx_classic_reflectance(float cosine, float roughness) {
  const float last = float(OLX_CLASSIC_TABLE_SIDE - 1u);
  vec2 at = vec2(sqrt(clamp(cosine, 0.0, 1.0)), clamp(roughness, 0.0, 1.0)) * last;
  vec2 first = min(floor(at), vec2(last - 1.0)), part = at - first, sum = vec2(0.0);
  uint word = olx_classic[OLX_CLASSIC_TABLE] + uint(first.y) * OLX_CLASSIC_TABLE_SIDE + uint(first.x);
  for (uint i = 0u; i < 4u; i++) {
    uint code = olx_classic[word + (i >> 1) * OLX_CLASSIC_TABLE_SIDE + (i & 1u)];
    float weight = ((i & 1u) != 0u ? part.x : 1.0 - part.x) * (i >> 1 != 0u ? part.y : 1.0 - part.y);
    sum += weight * vec2(olx_half_unpack(code & 0xFFFFu), olx_half_unpack(code >> 16));
  }
  return sum;
}

// Returns the number of texels along a side of a level of radiance.
uint olx_classic_side(uint level) { return max(olx_classic[OLX_CLASSIC_SIZE] >> level, OLX_CLASSIC_LEAST_SIDE); }

// Returns a probe's radiance, filtered for the roughness, around a unit direction.
vec3 olx_classic_radiance(uint probe, vec3 direction, float roughness) {
  vec2 uv = olx_octahedral_encode(direction);
  float level = clamp(roughness, 0.0, 1.0) * float(OLX_CLASSIC_LEVELS - 1u);
  uint below = uint(min(level, float(OLX_CLASSIC_LEVELS - 2u)));
  uint map = olx_classic[OLX_CLASSIC_RADIANCE] + olx_classic[OLX_CLASSIC_RADIANCE_WORDS] * probe;
  for (uint i = 0u; i < below; i++) map += (olx_classic_side(i) + 2u) * (olx_classic_side(i) + 2u);
  uint side = olx_classic_side(below);
  vec3 fine = olx_classic_color(map, side, uv);
  vec3 coarse = olx_classic_color(map + (side + 2u) * (side + 2u), olx_classic_side(below + 1u), uv);
  return mix(fine, coarse, level - float(below));
}

// Weighs probes trilinearly, without buried ones (inside geometry). Where all of the cage are buried, the nearest of
// the 4 x 4 x 4 probes around the point is used.
olx_classic_weights olx_classic_weigh(olx_sample_settings settings, vec3 position) {
  olx_cage cage = olx_cage_at(olx_field.irradiance_grid, position);
  olx_classic_weights weights;
  weights.count = 0u;
  float sum = 0.0;
  for (uint corner = 0u; corner < 8u; corner++) {
    if (!olx_cage_has(cage, corner)) continue;
    uint probe = olx_cage_probe(olx_field.irradiance_grid, cage, corner);
    float weight = olx_cage_weight(cage, corner);
    if (!olx_irradiance_usable(settings, probe) || weight <= 0.0) continue;
    weights.probe[weights.count] = probe;
    weights.weight[weights.count++] = weight;
    sum += weight;
  }
  for (uint i = 0u; i < weights.count; i++) weights.weight[i] /= max(sum, OLX_TRUSTED_WEIGHT);
  if (sum >= OLX_TRUSTED_WEIGHT) return weights;
  settings.visibility = false;
  uint nearest;
  if (olx_nearest_visible(settings, olx_surface_point(position, vec3(0.0), vec3(0.0)), cage, nearest)) {
    weights.probe[weights.count] = nearest;
    weights.weight[weights.count++] = 1.0 - sum / OLX_TRUSTED_WEIGHT;
  }
  return weights;
}

// Returns the indirect irradiance in W/m^2 on a surface.
vec3 olx_classic_irradiance(olx_sample_settings settings, vec3 position, vec3 normal) {
  olx_classic_weights weights = olx_classic_weigh(settings, position);
  vec2 uv = olx_octahedral_encode(normal);
  uint size = olx_classic[OLX_CLASSIC_SIZE], words = (size + 2u) * (size + 2u);
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < weights.count; i++) {
    uint map = olx_classic[OLX_CLASSIC_IRRADIANCE] + words * weights.probe[i];
    sum += olx_classic_color(map, size, uv) * weights.weight[i];
  }
  return sum;
}

// Returns the light that a GGX lobe reflects towards the eye, with Fresnel reflectance f0 at normal incidence and f90
// at grazing angles.
vec3 olx_classic_glossy(olx_sample_settings settings, vec3 position, vec3 normal, vec3 view, float roughness, vec3 f0,
                        float f90) {
  olx_classic_weights weights = olx_classic_weigh(settings, position);
  vec3 reflected = -view + normal * (2.0 * olx_dot(view, normal)), sum = vec3(0.0);
  for (uint i = 0u; i < weights.count; i++) {
    vec3 towards = olx_classic_parallax(weights.probe[i], position, reflected);
    sum += olx_classic_radiance(weights.probe[i], towards, roughness) * weights.weight[i];
  }
  vec2 reflectance = olx_classic_reflectance(olx_dot(normal, view), roughness);
  return sum * (f0 * reflectance.x + vec3(f90 * reflectance.y));
}

#endif
