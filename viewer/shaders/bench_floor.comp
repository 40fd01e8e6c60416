#version 460
#extension GL_GOOGLE_include_directive : require
// The least that a pass can do: read the surface, read as many texels of the field's maps as any algorithm of its kind
// must, and write. For diffuse light sixteen filtered reads, irradiance and moments of eight probes; for glossy light
// one texel of distance, normal and radiance.
#include "bench_surface.glsl"
#include <shaders/lib/octalux.glsl>

layout(set = 1, binding = 4, rgba16f) writeonly uniform image2D result;

const uint FLOOR_DIFFUSE = 0u, FLOOR_GLOSSY = 1u;

// The probe at a corner of the cell that a point is in.
uint corner_probe(vec3 position, uint corner) {
  uvec3 count = olx_field.irradiance_grid.count.xyz;
  vec3 spacing = max(olx_field.irradiance_grid.spacing.xyz, 1e-6);
  uvec3 cell = uvec3(clamp((position - olx_field.irradiance_grid.origin.xyz) / spacing, vec3(0.0), vec3(count - 1u)));
  uvec3 at = min(cell + (uvec3(corner, corner >> 1, corner >> 2) & 1u), count - 1u);
  return at.x + count.x * (at.y + count.y * at.z);
}

vec4 diffuse(ivec2 pixel, float depth) {
  vec3 position = position_of(pixel, depth), normal = texelFetch(normals, pixel, 0).xyz;
  vec4 sum = vec4(0.0);
  for (uint i = 0u; i < 8u; i++) {
    uint probe = corner_probe(position, i);
    vec2 towards = olx_octahedral_encode(normalize(position - olx_irradiance_probe_position(probe)));
    sum += textureLod(olx_irradiance_maps, olx_irradiance_coordinate(probe, olx_octahedral_encode(normal)), 0.0);
    sum += textureLod(olx_moments_maps, olx_irradiance_coordinate(probe, towards), 0.0);
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
  vec3 light = olx_texel_radiance(origin, texel) * texelFetch(albedos, pixel, 0).rgb;
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
