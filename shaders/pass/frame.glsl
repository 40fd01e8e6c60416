// The host's images and the surface that a pixel shows, shared by the passes.
#ifndef OLX_FRAME_GLSL
#define OLX_FRAME_GLSL

#include "../lib/octalux.glsl"
#include "ray_turn.glsl"

layout(local_size_x = OLX_PASS_SIZE, local_size_y = OLX_PASS_SIZE) in;

layout(push_constant, std430) uniform olx_frame_block { olx_frame_constants frame; };
layout(set = 1, binding = OLX_BINDING_DEPTH) uniform sampler2D depth_image;
layout(set = 1, binding = OLX_BINDING_SURFACE_NORMAL) uniform sampler2D normal_image;
layout(set = 1, binding = OLX_BINDING_ALBEDO) uniform sampler2D albedo_image;
layout(set = 1, binding = OLX_BINDING_ROUGHNESS) uniform sampler2D roughness_image;
layout(set = 1, binding = OLX_BINDING_GEOMETRIC_NORMAL) uniform sampler2D geometric_normal_image;
layout(set = 1, binding = OLX_BINDING_VERTEX_NORMAL) uniform sampler2D vertex_normal_image;
layout(set = 1, binding = OLX_BINDING_DYNAMIC) uniform sampler2D dynamic_image;
layout(set = 1, binding = OLX_BINDING_OUT_IRRADIANCE, rgba16f) uniform image2D irradiance_image;
layout(set = 1, binding = OLX_BINDING_OUT_GLOSSY, rgba16f) uniform image2D glossy_image;
layout(set = 1, binding = OLX_BINDING_OUT_COLOR, rgba16f) uniform image2D color_image;

layout(set = 2, binding = OLX_BINDING_SAMPLE, rgba16f) uniform writeonly image2D sample_image;

struct frame_surface {
  vec3 position, normal, view;
  olx_bsdf bsdf;
  float roughness;
};

bool has_flag(uint flag) { return (frame.flags & flag) != 0u; }

olx_sample_settings frame_settings() {
  return olx_sample_settings(olx_constant_tracer, olx_constant_select, has_flag(OLX_FRAME_VISIBILITY), frame.max_probes,
                             has_flag(OLX_FRAME_KEEP_BURIED), has_flag(OLX_FRAME_EMITTERS), olx_constant_hits,
                             frame.surface_tolerance);
}

// Returns the pixel for which an invocation traces rays: one for each square where pixels take turns.
ivec2 pixel_to_trace() {
  ivec2 id = ivec2(gl_GlobalInvocationID.xy);
  return traced_pixel(frame.flags, has_flag(OLX_TURN_SPARSE) ? 2 * id : id);
}

bool outside_frame(ivec2 pixel) { return pixel.x >= int(frame.width) || pixel.y >= int(frame.height); }

vec3 position_at(ivec2 pixel, float depth) {
  vec2 clip = (vec2(pixel) + 0.5) / vec2(frame.width, frame.height) * 2.0 - 1.0;
  vec4 world = frame.clip_to_world[0] * clip.x + frame.clip_to_world[1] * clip.y + frame.clip_to_world[2] * depth +
               frame.clip_to_world[3];
  return world.xyz / world.w;
}

vec3 read_normal(sampler2D image, ivec2 pixel, uint unorm) {
  vec3 normal = texelFetch(image, pixel, 0).xyz;
  return olx_normalize(has_flag(unorm) ? normal * 2.0 - 1.0 : normal);
}

// Reads the surface of a pixel; false where the pixel shows none.
bool read_surface(ivec2 pixel, out frame_surface surface) {
  surface = frame_surface(vec3(0.0), vec3(0.0), vec3(0.0), olx_bsdf_make(vec3(0.0), 0.0, 0.0, 0.0), 0.0);
  float depth = texelFetch(depth_image, pixel, 0).r;
  if (depth == frame.eye.w) return false;
  vec3 base_color = texelFetch(albedo_image, pixel, 0).rgb;
  vec3 material = texelFetch(roughness_image, pixel, 0).rgb; // roughness, metallic, specular weight
  surface.position = position_at(pixel, depth);
  surface.normal = read_normal(normal_image, pixel, OLX_FRAME_NORMAL_UNORM);
  surface.view = olx_normalize(frame.eye.xyz - surface.position);
  // Interpolated and mapped normals may face away from the eye near outlines, and are turned as on the CPU.
  float cosine = olx_dot(surface.normal, surface.view);
  if (cosine < OLX_LEAST_VIEW_COSINE) {
    surface.normal = olx_normalize(surface.normal + surface.view * (OLX_LEAST_VIEW_COSINE - cosine));
  }
  surface.bsdf = olx_bsdf_make(base_color, material.y, material.x, material.z);
  surface.roughness = material.x;
  return true;
}

// Returns whether a direction leads into the pixel's surface, which rays drawn around its shading normal may do; `view`
// leads to the eye. Without a geometric normal from the host none does.
bool leads_inside(ivec2 pixel, vec3 view, vec3 direction) {
  if (!has_flag(OLX_FRAME_GEOMETRIC_NORMAL)) return false;
  vec3 normal = read_normal(geometric_normal_image, pixel, OLX_FRAME_GEOMETRIC_UNORM);
  return olx_dot(normal, direction) * olx_dot(normal, view) <= 0.0;
}

vec4 storable(vec3 light, float alpha) { return vec4(clamp(light, vec3(0.0), vec3(OLX_HALF_MOST)), alpha); }

// Returns the seed of a pixel's random numbers.
uint pixel_seed(uvec2 pixel, uint branch) {
  uint seed = olx_hash2(pixel.x, pixel.y);
  return olx_hash2(frame.seed != 0u ? olx_hash2(seed, frame.seed) : seed, OLX_SALT_BRANCH + branch);
}

// Stores the light of a pixel's rays for the denoiser, if the lobe is denoised; a negative nearness means that the
// pixel has no such light.
void write_sample(ivec2 pixel, vec3 light, float nearness) {
  if (has_flag(OLX_FRAME_SAMPLE)) imageStore(sample_image, pixel, storable(light, min(nearness, OLX_HALF_MOST)));
}

#endif
