// Twin of src/relight/*.c, as far as these use numbers alone: rays to lights, and how texels and probes of the volume
// receive light from surfels. It is not part of octalux.glsl, because only Octalux's own passes
// have its buffers.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_RELIGHT_GLSL
#define OLX_RELIGHT_GLSL

#include "../octalux_shared.h"
#include "bsdf.glsl"
#include "harmonics.glsl"
#include "pack.glsl"
#include "sampling.glsl"

struct olx_light_ray {
  vec3 direction;
  float length_metres;
  vec3 irradiance; // if nothing shadows the light
};

// ---- Rays to lights

bool olx_light_varies(olx_gpu_light light) { return light.type >= OLX_LIGHT_RECT; }

float olx_spot_falloff(olx_gpu_light light, float cosine) {
  if (cosine >= light.cosine_inner) return 1.0;
  if (cosine <= light.cosine_outer) return 0.0;
  return olx_square((cosine - light.cosine_outer) / (light.cosine_inner - light.cosine_outer));
}

bool olx_point_light(olx_gpu_light light, vec3 position, vec3 normal, out olx_light_ray ray) {
  vec3 away = light.position.xyz - position;
  float distance = sqrt(olx_dot(away, away)), cosine = olx_dot(away, normal) / distance;
  vec3 direction = away * (1.0 / distance);
  float strength = cosine / (distance * distance);
  if (light.type == OLX_LIGHT_SPOT) strength *= olx_spot_falloff(light, -olx_dot(direction, light.edge_u.xyz));
  ray = olx_light_ray(direction, distance * (1.0 - OLX_END_SHARE), light.emission.xyz * strength);
  return cosine > 0.0 && strength > 0.0;
}

bool olx_area_light(olx_gpu_light light, vec3 position, vec3 normal, vec2 random, out olx_light_ray ray) {
  bool is_half = light.type == OLX_LIGHT_TRIANGLE;
  if (is_half) random = olx_sample_triangle(random);
  vec3 target = light.position.xyz + light.edge_u.xyz * random.x + light.edge_v.xyz * random.y;
  vec3 area = cross(light.edge_u.xyz, light.edge_v.xyz) * (is_half ? 0.5 : 1.0);
  vec3 away = target - position;
  float distance = sqrt(olx_dot(away, away)), cosine = olx_dot(away, normal) / distance;
  vec3 direction = away * (1.0 / distance);
  float facing = -olx_dot(area, direction);
  if (light.both_sides != 0u) facing = abs(facing);
  // A light contributes at most as much as one that surrounds the place, however near it is.
  ray = olx_light_ray(direction, distance * (1.0 - OLX_END_SHARE),
                      light.emission.xyz * min(cosine * facing / (distance * distance), OLX_PI));
  return cosine > 0.0 && facing > 0.0;
}

// Draws a ray from a place towards a light; false when the light cannot reach it.
bool olx_aim(olx_gpu_light light, vec3 position, vec3 normal, vec2 random, out olx_light_ray ray) {
  if (light.type == OLX_LIGHT_POINT || light.type == OLX_LIGHT_SPOT) {
    return olx_point_light(light, position, normal, ray);
  }
  if (light.type == OLX_LIGHT_RECT || light.type == OLX_LIGHT_TRIANGLE) {
    return olx_area_light(light, position, normal, random, ray);
  }
  if (light.type == OLX_LIGHT_SKY) {
    vec3 direction = olx_normalize(olx_from_basis(olx_sample_cosine(random), normal));
    ray = olx_light_ray(direction, OLX_INFINITY, light.emission.xyz * OLX_PI);
    return true;
  }
  float cosine = -olx_dot(light.edge_u.xyz, normal);
  ray = olx_light_ray(-light.edge_u.xyz, OLX_INFINITY, light.emission.xyz * cosine);
  return cosine > 0.0;
}

// Aims a ray from a place at a point of a surface near a lamp; false when its light does not reach the place.
bool olx_aim_near(olx_gpu_lamp_point point, vec3 position, vec3 normal, out olx_light_ray ray) {
  vec3 way = point.position.xyz - position;
  float squared = olx_dot(way, way), distance = sqrt(squared);
  vec3 direction = way * (1.0 / distance);
  float leaving = -olx_dot(direction, point.normal.xyz), arriving = olx_dot(direction, normal);
  float share = leaving / (max(squared, point.normal.w) * point.intensity.w);
  ray = olx_light_ray(direction, distance * (1.0 - OLX_END_SHARE), point.intensity.xyz * (share * arriving));
  return squared > 0.0 && leaving > 0.0 && arriving > 0.0;
}

// ---- Highlights between surfels (src/relight/relit_highlights.c)

// Returns the brightness of a specular lobe in light from one direction, relative to a white matte surface.
float olx_specular_brightness(vec3 normal, float f0, float roughness_alpha, vec3 view, vec3 light) {
  float to_view = olx_dot(view, normal), to_light = olx_dot(light, normal);
  if (to_view <= 0.0 || to_light <= 0.0) return 0.0;
  vec3 middle = olx_normalize(view + light);
  float cosine = min(olx_dot(middle, normal), 1.0);
  float alpha = sqrt(roughness_alpha * roughness_alpha + OLX_LINK_ALPHA * OLX_LINK_ALPHA);
  float fresnel = f0 + (1.0 - f0) * olx_pow5(clamp(1.0 - olx_dot(view, middle), 0.0, 1.0));
  float a2 = alpha * alpha, c2 = cosine * cosine, d = 1.0 - c2 + c2 * a2, lobe = a2 / (OLX_PI * d * d);
  float seen = 1.0 / (1.0 + olx_ggx_lambda(alpha, to_view) + olx_ggx_lambda(alpha, to_light));
  return min(OLX_PI * fresnel * lobe * seen / (4.0 * to_view * to_light), OLX_MOST_BRIGHT);
}

// ---- Texels and the volume

// Returns texel i of a tile in the order of its blocks of OLX_LIT_SIDE x OLX_LIT_SIDE texels, which share samples of
// lights.
uvec2 olx_tile_texel(uint i, uint tile_side) {
  uint in_block = i % (OLX_LIT_SIDE * OLX_LIT_SIDE), block = i / (OLX_LIT_SIDE * OLX_LIT_SIDE),
       blocks = tile_side / OLX_LIT_SIDE;
  return uvec2(block % blocks, block / blocks) * OLX_LIT_SIDE + uvec2(in_block % OLX_LIT_SIDE, in_block / OLX_LIT_SIDE);
}

// Computes the weights of a block's corners for a texel.
vec4 olx_site_corners(uvec2 in_block) {
  vec2 at = vec2(in_block) / float(OLX_RELIGHT_BLOCK - 1u);
  return vec4((1.0 - at.x) * (1.0 - at.y), at.x * (1.0 - at.y), (1.0 - at.x) * at.y, at.x * at.y);
}

// Returns the share of a surfel in a texel's indirect light; `weights` are an entry's, a byte each.
float olx_site_weight(uint weights, vec4 corners) {
  vec4 bytes = vec4(weights & 0xFFu, weights >> 8 & 0xFFu, weights >> 16 & 0xFFu, weights >> 24);
  return dot(corners, bytes) * (1.0 / 255.0);
}

// Returns the factor that turns a sum over directions into a coefficient of irradiance (Ramamoorthi and Hanrahan 2001).
float olx_irradiance_scale(uint k) {
  float band = k == 0u ? OLX_PI : k < 4u ? 2.0 / 3.0 * OLX_PI : 0.25 * OLX_PI;
  float mean_square = k == 0u ? 1.0 : k < 4u ? 1.0 / 3.0 : k == 6u ? 4.0 / 5.0 : k == 8u ? 4.0 / 15.0 : 1.0 / 15.0;
  return band / mean_square;
}

// Packs a value as a half float; values beyond its range are clamped so that they stay finite.
uint olx_half_pack_finite(float value) { return olx_half_pack(clamp(value, -OLX_HALF_MOST, OLX_HALF_MOST)); }

#endif
