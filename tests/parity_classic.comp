// Every function of shaders/lib/classic.glsl on the inputs of test_parity_classic.c: one row a dispatch, one thread an
// item.
#version 460
#extension GL_GOOGLE_include_directive : require
#define OLX_CLASSIC_SET 2
#include "parity_classic_rows.h"
#include "shaders/lib/octalux.glsl"
#include "shaders/lib/classic.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform row_block { uint row; };

struct parity_item {
  float v[12];
  uint u[4];
};
layout(set = 1, binding = 0, std430) readonly buffer items_block { parity_item items[]; };
layout(set = 1, binding = 1, std430) writeonly buffer results_block { uint results[]; };

uint filled = 0u;
void put(uint x) { results[gl_GlobalInvocationID.x * PARITY_CLASSIC_RESULTS + filled++] = x; }
void put(float x) { put(floatBitsToUint(x)); }
void put(vec2 v) { put(v.x), put(v.y); }
void put(vec3 v) { put(v.xy), put(v.z); }

void main() {
  parity_item item = items[gl_GlobalInvocationID.x];
  vec3 point = vec3(item.v[0], item.v[1], item.v[2]), direction = vec3(item.v[3], item.v[4], item.v[5]),
       view = vec3(item.v[6], item.v[7], item.v[8]), random = vec3(item.v[9], item.v[10], item.v[11]);
  uint probe = item.u[0] % olx_field.irradiance_grid.count.w, level = item.u[1] % OLX_CLASSIC_LEVEL_COUNT;
  uint size = olx_classic[OLX_CLASSIC_SIZE];
  olx_sample_settings settings = olx_sample_settings_default();
  settings.keep_buried = (item.u[2] & 1u) != 0u;
  olx_classic_weights weights;
  switch (row) {
  case ROW_olx_classic_color:
    put(olx_classic_color(olx_classic[OLX_CLASSIC_IRRADIANCE] + (size + 2u) * (size + 2u) * probe, size, random.xy));
    break;
  case ROW_olx_classic_vector: put(olx_classic_vector(olx_classic[OLX_CLASSIC_BOXES] + 6u * probe)); break;
  case ROW_olx_classic_parallax: put(olx_classic_parallax(probe, point, direction)); break;
  case ROW_olx_classic_reflectance: put(olx_classic_reflectance(1.2 * random.x - 0.1, 1.2 * random.y - 0.1)); break;
  case ROW_olx_classic_side: put(olx_classic_side(level)); break;
  case ROW_olx_classic_radiance: put(olx_classic_radiance(probe, direction, 1.2 * random.z - 0.1)); break;
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
