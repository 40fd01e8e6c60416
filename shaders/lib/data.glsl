// Access to a field's data in both languages for which the library is compiled: GLSL for Vulkan, with storage buffers
// and the descriptor set of a field, and ESSL 3.00 for WebGL2, which has textures alone. All other files read words,
// probes and probe light through the names defined here; maps of texels are arrays of images in both languages. It has
// no twin in C.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_DATA_GLSL
#define OLX_DATA_GLSL

#include "language.glsl" // comes first, because it sets precisions
#include "../octalux_shared.h"

#ifdef GL_ES
// The host sets these uniforms by name (web/src/textures.js). Words and probes lie row by row in images that are
// OLX_DATA_ROW texels wide. Probe light is not uploaded: here a field has no irradiance probes, and hits are shaded.
const uint OLX_DATA_ROW_BITS = 11u, OLX_DATA_ROW = 1u << OLX_DATA_ROW_BITS;

uniform olx_field_constants olx_field;
uniform usampler2D olx_word_image;  // a word a texel
uniform usampler2D olx_probe_image; // light field probes: the bits of x, y and z, and flags
uniform usampler2DArray olx_normal_maps;
uniform usampler2DArray olx_distance_maps;
uniform sampler2DArray olx_indirect_maps;
uniform sampler2DArray olx_direct_maps;
uniform sampler2DArray olx_base_maps;
uniform sampler2DArray olx_specular_maps;

ivec2 olx_data_at(uint index) { return ivec2(index & (OLX_DATA_ROW - 1u), index >> OLX_DATA_ROW_BITS); }

uint olx_word(uint index) { return texelFetch(olx_word_image, olx_data_at(index), 0).r; }
uint olx_probe_flags(uint probe) { return texelFetch(olx_probe_image, olx_data_at(probe), 0).a; }
vec3 olx_probe_position(uint probe) { return uintBitsToFloat(texelFetch(olx_probe_image, olx_data_at(probe), 0).xyz); }

uint olx_irradiance_probe_flags(uint probe) { return OLX_PROBE_BURIED; }
vec3 olx_irradiance_probe_position(uint probe) { return vec3(0.0); }
vec3 olx_radiance_texel(ivec3 at) { return vec3(0.0); }
vec3 olx_irradiance_filtered(vec3 at) { return vec3(0.0); }
vec2 olx_moments_filtered(vec3 at) { return vec2(0.0); }
#else
#ifndef OLX_FIELD_SET
#define OLX_FIELD_SET 0
#endif

layout(set = OLX_FIELD_SET, binding = OLX_BINDING_FIELD, std140) uniform olx_field_block {
  olx_field_constants olx_field;
};
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_PROBES, std430) readonly buffer olx_probe_block {
  olx_gpu_probe olx_probes[];
};
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_IRRADIANCE_PROBES, std430) readonly buffer
    olx_irradiance_probe_block {
  olx_gpu_probe olx_irradiance_probes[];
};
// One buffer holds all words of a field, because shaders of some devices have no more than four buffers.
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_WORDS, std430) readonly buffer olx_word_block { uint olx_words[]; };
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_RADIANCE) uniform sampler2DArray olx_radiance_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_NORMAL) uniform usampler2DArray olx_normal_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_DISTANCE) uniform usampler2DArray olx_distance_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_IRRADIANCE) uniform sampler2DArray olx_irradiance_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_MOMENTS) uniform sampler2DArray olx_moments_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_INDIRECT) uniform sampler2DArray olx_indirect_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_DIRECT) uniform sampler2DArray olx_direct_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_BASE) uniform sampler2DArray olx_base_maps;
layout(set = OLX_FIELD_SET, binding = OLX_BINDING_SPECULAR) uniform sampler2DArray olx_specular_maps;

// These are macros, because a function would keep compilers from seeing the buffers.
#define olx_word(index) olx_words[index]
#define olx_probe_flags(probe) olx_probes[probe].flags
#define olx_irradiance_probe_flags(probe) olx_irradiance_probes[probe].flags
#define olx_radiance_texel(at) texelFetch(olx_radiance_maps, at, 0).rgb
#define olx_irradiance_filtered(at) textureLod(olx_irradiance_maps, at, 0.0).rgb
#define olx_moments_filtered(at) textureLod(olx_moments_maps, at, 0.0).rg

vec3 olx_probe_position(uint probe) { return vec3(olx_probes[probe].x, olx_probes[probe].y, olx_probes[probe].z); }

vec3 olx_irradiance_probe_position(uint probe) {
  return vec3(olx_irradiance_probes[probe].x, olx_irradiance_probes[probe].y, olx_irradiance_probes[probe].z);
}
#endif

#endif
