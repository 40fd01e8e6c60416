#version 460
#extension GL_GOOGLE_include_directive : require
// Counts what the passes read for a pixel: the diffuse light's filtered reads and texels, the glossy ray's fetches,
// steps and probes.
#include "bench_surface.glsl"

float depth_at(ivec2 pixel) { return texelFetch(depths, pixel, 0).r; }
vec3 normal_at(ivec2 pixel) { return normalize(texelFetch(normals, pixel, 0).xyz); }
vec3 surface_at(ivec2 pixel) { return texelFetch(surfaces, pixel, 0).rgb; }

uint filtered = 0u, fetched = 0u;

vec4 counted_read(sampler2DArray maps, vec3 at, float lod) {
  filtered++;
  return textureLod(maps, at, lod);
}

uvec4 counted_fetch(usampler2DArray maps, ivec3 at, int lod) {
  fetched++;
  return texelFetch(maps, at, lod);
}

vec4 counted_fetch(sampler2DArray maps, ivec3 at, int lod) {
  fetched++;
  return texelFetch(maps, at, lod);
}

#define textureLod counted_read
#define texelFetch counted_fetch
#include <shaders/lib/octalux.glsl>

struct pixel_counts {
  uint filtered, fetched, steps, probes;
  uint surface, ray, unknown, texels;
  float light; // stored, since compilers would otherwise remove the reads
};

layout(set = 1, binding = 4, std430) writeonly buffer counts { pixel_counts of_pixel[]; };

void trace_glossy(vec3 position, vec3 normal, vec3 view, vec3 surface, ivec2 pixel, inout pixel_counts c) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.tracer = tracer;
  settings.select = select;
  float weight, half_cosine;
  olx_trace_hit hit;
  fetched = 0u;
  vec2 random = olx_stratified2(0u, olx_hash2(uint(pixel.x), uint(pixel.y)));
  c.light += olx_glossy(settings, position, normal, view, surface.x, random, weight, half_cosine, hit).g;
  c.ray = weight > 0.0 ? 1u : 0u;
  c.unknown = uint(hit.status == OLX_TRACE_UNKNOWN);
  c.steps = hit.texel_steps;
  c.probes = hit.probes_tried;
  c.fetched = fetched;
}

void main() {
  uvec2 size = (uvec2(width, height) + stride - 1u) / stride;
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, size))) return;
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy * stride);
  pixel_counts c = pixel_counts(0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0.0);
  float depth = depth_at(pixel);
  if (depth != 0.0) {
    vec3 position = position_of(pixel, depth), normal = normal_at(pixel), surface = surface_at(pixel);
    vec3 view = normalize(eye - position);
    c.surface = 1u;
    c.light = olx_surface_irradiance(olx_sample_settings_default(), position, normal, normal, view).g;
    c.filtered = filtered;
    c.texels = fetched;
    if (has_specular(surface)) trace_glossy(position, normal, view, surface, pixel, c);
  }
  of_pixel[gl_GlobalInvocationID.x + size.x * gl_GlobalInvocationID.y] = c;
}
