#version 460
#extension GL_GOOGLE_include_directive : require
// Does the least work that a pass can do: it reads the surface and as many texels of the field's maps as any algorithm
// of its kind must, and writes. For diffuse light these are four texels of one probe, each of distance, normal and
// irradiance; for glossy light one texel of each.
#include "bench_surface.glsl"
#include <shaders/lib/octalux.glsl>

layout(set = 1, binding = 4, rgba16f) writeonly uniform image2D result;

const uint FLOOR_DIFFUSE = 0u, FLOOR_GLOSSY = 1u;

vec4 diffuse(ivec2 pixel, float depth) {
  vec3 offset = position_of(pixel, depth) - olx_probe_position(0u), normal = texelFetch(normals, pixel, 0).xyz;
  ivec3 origin = olx_map_origin(0u);
  ivec2 first = ivec2(floor(olx_octahedral_encode(offset) * float(olx_field.n) - 0.5));
  vec4 sum = vec4(normal, 0.0);
  for (int i = 0; i < 4; i++) {
    ivec2 texel = first + ivec2(i & 1, i >> 1), inside = olx_border_source(texel, int(olx_field.n));
    sum += vec4(olx_texel_indirect(origin, inside) + olx_texel_normal(origin, texel),
                olx_texel_distance(origin, texel));
  }
  return sum;
}

vec4 glossy(ivec2 pixel, float depth) {
  vec3 position = position_of(pixel, depth), normal = texelFetch(normals, pixel, 0).xyz;
  vec3 surface = texelFetch(surfaces, pixel, 0).rgb;
  if (!has_specular(surface)) return vec4(0.0);
  vec3 direction = reflect(normalize(position - eye), normal);
  ivec3 origin = olx_map_origin(0u);
  ivec2 texel = olx_texel_towards(direction);
  vec3 light = olx_texel_indirect(origin, texel) * texelFetch(albedos, pixel, 0).rgb;
  return vec4(light + olx_texel_normal(origin, texel), olx_texel_distance(origin, texel));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= int(width) || pixel.y >= int(height)) return;
  float depth = texelFetch(depths, pixel, 0).r;
  vec4 light = vec4(0.0);
  if (depth != 0.0) light = kind == FLOOR_DIFFUSE ? diffuse(pixel, depth) : glossy(pixel, depth);
  imageStore(result, pixel, light);
}
