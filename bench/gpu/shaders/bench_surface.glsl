// The surfaces of the benchmark's own passes.
#ifndef BENCH_SURFACE_GLSL
#define BENCH_SURFACE_GLSL

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 1, binding = 0) uniform sampler2D depths;
layout(set = 1, binding = 1) uniform sampler2D normals;
layout(set = 1, binding = 2) uniform sampler2D albedos;
layout(set = 1, binding = 3) uniform sampler2D surfaces; // roughness, metallic, specular weight

layout(push_constant) uniform constants {
  mat4 clip_to_world;
  vec3 eye;
  uint width, height, stride; // size in pixels, and the distance between sampled pixels
  uint tracer, select, kind;
};

vec3 position_of(ivec2 pixel, float depth) {
  vec2 clip = (vec2(pixel) + 0.5) / vec2(width, height) * 2.0 - 1.0;
  vec4 place = clip_to_world * vec4(clip, depth, 1.0);
  return place.xyz / place.w;
}

bool has_specular(vec3 surface) { return max(surface.y, surface.z) > 0.0; }

#endif
