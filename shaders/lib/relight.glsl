// Twin of what relighting computes from numbers alone (src/shade/relighter*.c, corrections.c): places that are lit,
// rays to lights, and the cells of corrections. Not part of octalux.glsl: passes of Octalux's own have its buffers.
#ifndef OLX_RELIGHT_GLSL
#define OLX_RELIGHT_GLSL

#include "../octalux_shared.h"
#include "bilinear.glsl"
#include "pack.glsl"
#include "sampling.glsl"

const float OLX_OFF_SURFACE = 1.0 / 1024.0; // rays start this share of the distance off a surface
const float OLX_SHARED_PLANE = 0.01;        // look-ups are shared in one plane to this share of the distance
const float OLX_END_SHARE = 1e-3;           // how far from its end a ray to a light may stop
const float OLX_SIZE_PENALTY = 1e-4;
const float OLX_SMOOTHNESS_PENALTY = 3e-4;

// A place that is lit, moved a little off its surface.
struct olx_surface_view {
  vec3 place, normal, view, albedo;
  float distance_metres; // from its probe; infinite where nothing is lit
};

struct olx_light_ray {
  vec3 direction;
  float length_metres;
  vec3 irradiance; // that arrives when nothing is between
};

// The same texels of a map that has no border.
olx_bilinear olx_without_border(olx_bilinear texels, uint n) {
  for (uint k = 0u; k < 4u; k++) {
    ivec2 at = ivec2(texels.texel[k] % (n + 2u), texels.texel[k] / (n + 2u)) - 1;
    ivec2 inside = olx_border_source(at, int(n));
    texels.texel[k] = uint(inside.y) * n + uint(inside.x);
  }
  return texels;
}

// The direction in which surface (x, y) of an irradiance probe was looked for.
vec3 olx_surface_direction(uvec2 at, uint size) {
  float scale = 1.0 / float(size);
  return olx_octahedral_decode((vec2(at) + vec2(0.5078125, 0.48828125)) * scale);
}

vec3 olx_relit_albedo(uint code) { return min(olx_r11g11b10f_unpack(code), vec3(1.0)); }

// Whether a distance is that of a surface which reflects: neither an emitter's nor the sky's.
bool olx_known_distance(uint bits) { return bits < 0x7C00u; }

bool olx_alike(olx_surface_view a, olx_surface_view b) {
  return olx_dot(a.normal, b.normal) > 0.995 &&
         abs(olx_dot(a.place - b.place, a.normal)) < OLX_SHARED_PLANE * a.distance_metres;
}

// Texel k of a block of side x side that is number `block` in a map of n x n.
uint olx_block_texel(uint block, uint k, uint side, uint n) {
  uint blocks = n / side;
  return (block / blocks * side + k / side) * n + block % blocks * side + k % side;
}

// ---- Rays to lights

bool olx_light_varies(olx_gpu_light light) { return light.type >= OLX_LIGHT_RECT; }

float olx_spot_falloff(olx_gpu_light light, float cosine) {
  if (cosine <= light.cosine_outer) return 0.0;
  if (cosine >= light.cosine_inner) return 1.0;
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
  // However near, a light sends no more than it would from all around.
  ray = olx_light_ray(direction, distance * (1.0 - OLX_END_SHARE),
                      light.emission.xyz * min(cosine * facing / (distance * distance), OLX_PI));
  return cosine > 0.0 && facing > 0.0;
}

// A ray from a place towards a light; false when the light cannot reach it.
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

// ---- Cells of corrections

// The cells around a place of a map.
olx_bilinear olx_correction_cells_at(vec2 uv) {
  precise vec2 at = uv * float(OLX_CORRECTION_SIDE) - 0.5;
  vec2 first = floor(at), part = at - first;
  olx_bilinear cells;
  for (int k = 0; k < 4; k++) {
    ivec2 inside = olx_border_source(ivec2(first) + ivec2(k & 1, k >> 1), OLX_CORRECTION_SIDE);
    cells.texel[k] = uint(inside.y * OLX_CORRECTION_SIDE + inside.x);
    cells.weight[k] = ((k & 1) != 0 ? part.x : 1.0 - part.x) * ((k >> 1) != 0 ? part.y : 1.0 - part.y);
  }
  return cells;
}

// The cells with which a cell is compared, once for each time that C visits the pair from either side; the last of them
// may be missing.
uint olx_correction_neighbours(uint cell, out uint neighbours[6]) {
  const int side = OLX_CORRECTION_SIDE;
  ivec2 at = ivec2(cell % uint(side), cell / uint(side));
  uint count = 0u;
  for (int axis = 0; axis < 2; axis++) {
    ivec2 forward = ivec2(1 - axis, axis), next = olx_border_source(at + forward, side);
    neighbours[count++] = uint(next.y * side + next.x);
    if (at[axis] > 0) neighbours[count++] = uint((at.y - forward.y) * side + at.x - forward.x);
    if (at[axis] == side - 1) neighbours[count++] = uint(next.y * side + next.x); // whose next one is this
  }
  return count;
}

#endif
