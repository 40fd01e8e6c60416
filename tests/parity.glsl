// Code that the shaders of the parity tests share (parity.h): a dispatch computes one row, a thread one item. Each file
// holds one group of rows, since compile times grow faster than a file's length.
#ifndef PARITY_GLSL
#define PARITY_GLSL

#include "parity_rows.h"
#include "shaders/lib/octalux.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform row_block { uint row; };

struct parity_item {
  float v[16];
  uint u[4];
};
layout(set = 1, binding = 0, std430) readonly buffer items_block { parity_item items[]; };
layout(set = 1, binding = 1, std430) writeonly buffer results_block { uint results[]; };

uint filled = 0u;
void put(uint x) { results[gl_GlobalInvocationID.x * PARITY_RESULTS + filled++] = x; }
void put(int x) { put(uint(x)); }
void put(bool x) { put(uint(x)); }
void put(float x) { put(floatBitsToUint(x)); }
void put(vec2 v) { put(v.x), put(v.y); }
void put(vec3 v) { put(v.xy), put(v.z); }
void put(ivec2 v) { put(v.x), put(v.y); }
void put(uvec3 v) { put(v.x), put(v.y), put(v.z); }
void put(ivec3 v) { put(v.xy), put(v.z); }
// Writes a texel as C counts the texels of a bordered map.
void put_texel(ivec2 texel) { put((texel.y + 1) * int(olx_field.n + 2u) + texel.x + 1); }

// The item of this thread, and the values that the C side derives from it in the same way.
parity_item item;
vec3 point, direction, view;
vec4 random;
uvec4 bits;
uint probe, irradiance_probe;
ivec2 texel;
olx_sample_settings settings;
olx_bsdf bsdf;

void derive() {
  point = vec3(item.v[0], item.v[1], item.v[2]);
  direction = vec3(item.v[3], item.v[4], item.v[5]);
  view = vec3(item.v[6], item.v[7], item.v[8]);
  random = vec4(item.v[9], item.v[10], item.v[11], item.v[12]);
  bits = uvec4(item.u[0], item.u[1], item.u[2], item.u[3]);
  probe = bits.x % olx_field.probe_count;
  irradiance_probe = bits.x % olx_field.irradiance_grid.count.w;
  texel = ivec2(bits.yz % olx_field.n);
  settings = olx_sample_settings_default();
  settings.tracer = (bits.w >> 8) % 3u;
  settings.visibility = (bits.w & 6u) != 0u;
  settings.keep_buried = (bits.w & 8u) != 0u;
  settings.emitters = (bits.w & 16u) != 0u;
  settings.hits = (bits.w & 0x1800u) != 0u ? OLX_HITS_SHADED : OLX_HITS_STORED;
  settings.select = uint[](OLX_SELECT_EXHAUSTIVE, OLX_SELECT_CAGE, OLX_SELECT_BRICKS, OLX_SELECT_VORONOI,
                           OLX_SELECT_BEST)[(bits.w >> 5) % 5u];
  bsdf = olx_bsdf_make(abs(direction), random.x, random.y, random.z);
}

bool has_voronoi() { return olx_select_available(OLX_SELECT_VORONOI); }

void begin() {
  item = items[gl_GlobalInvocationID.x];
  derive();
}

#endif
