// Cameras and the guide, a picture of a frame's surfaces, shared by the denoiser's passes.
#ifndef OLX_GUIDE_GLSL
#define OLX_GUIDE_GLSL

#include "../octalux_shared.h"

#include "../lib/denoise.glsl"
#include "../lib/octahedral.glsl"
#include "ray_turn.glsl"

layout(local_size_x = OLX_PASS_SIZE, local_size_y = OLX_PASS_SIZE) in;

uvec2 size_of(uint size) { return uvec2(size & 0xFFFFu, size >> 16); }

olx_camera_frame camera_of(olx_gpu_camera c, bool mirrored) {
  vec3 forward = normalize(cross(c.up.xyz, c.right.xyz));
  return olx_camera_frame(c.eye.xyz, mirrored ? -forward : forward, c.right.xyz, c.up.xyz);
}

vec2 shift_of(olx_gpu_camera c) { return vec2(c.eye.w, c.right.w); }

// Packs a guide's pixel: depth, normal, the number of frames in each lobe's history, roughness.
uvec4 pack_guide(float depth, vec3 normal, vec2 counts, float roughness) {
  return uvec4(floatBitsToUint(depth), packUnorm2x16(olx_octahedral_encode(normal)), packHalf2x16(counts),
               packHalf2x16(vec2(roughness, 0.0)));
}

bool guide_is_empty(uvec4 guide) { return guide.x == floatBitsToUint(OLX_INFINITY); }
vec2 guide_counts(uvec4 guide) { return unpackHalf2x16(guide.z); }

olx_shown guide_shows(uvec4 guide, olx_camera_frame camera, vec2 size, vec2 pixel) {
  float depth = uintBitsToFloat(guide.x);
  return olx_shown(olx_guide_position(camera, size, pixel, depth), olx_octahedral_decode(unpackUnorm2x16(guide.y)),
                   depth, unpackHalf2x16(guide.w).x, olx_pixel_angle(camera, size));
}

olx_incident incident_of(vec4 texel) { return olx_incident(texel.rgb, texel.a); }
vec4 storable(olx_incident incident) {
  return vec4(clamp(incident.light, vec3(0.0), vec3(OLX_HALF_MOST)), incident.inverse_distance);
}

#endif
