// Runs the denoiser's cross-bilateral filter along rows or along columns of pixels. Columns write the host's image:
// irradiance, or glossy light times the Fresnel reflectance by which it was divided.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "guide.glsl"

#include "../lib/bsdf.glsl"

layout(push_constant, std430) uniform olx_filter_block { olx_filter_constants job; };
layout(set = 0, binding = OLX_BINDING_GUIDE) uniform usampler2D guide_image;
layout(set = 0, binding = OLX_BINDING_LIGHT) uniform sampler2D light_image;
layout(set = 0, binding = OLX_BINDING_ROWS) uniform sampler2D rows_image;
layout(set = 0, binding = OLX_BINDING_FILTER_ALBEDO) uniform sampler2D albedo_image;
layout(set = 0, binding = OLX_BINDING_FILTER_ROUGHNESS) uniform sampler2D roughness_image;
layout(set = 0, binding = OLX_BINDING_OUT_ROWS, rgba16f) uniform writeonly image2D out_rows;
layout(set = 0, binding = OLX_BINDING_OUT_TARGET, rgba16f) uniform image2D out_target;


bool has_flag(uint flag) { return (job.flags & flag) != 0u; }
bool glossy() { return has_flag(OLX_DENOISE_GLOSSY); }
bool columns() { return has_flag(OLX_DENOISE_COLUMNS); }
float count_of(uvec4 guide) { return glossy() ? guide_counts(guide).y : guide_counts(guide).x; }

// Returns the distance in pixels to the tap numbered i; src/render/denoise.c says why taps lie closer near the middle.
int tap_distance(int i, int steps) {
  int stride = int(job.stride_pixels);
  if (i == 0 || !(job.reach > 0.0)) return i * stride;
  return i + (stride - 1) * i * abs(i) / steps;
}

// Returns the weighted mean over pixels along a line, and in alpha the sum of the weights. Rows read the history and
// columns the result of the rows, whose sums are the weights of a column's pixels. Where there is no light, it is what
// the pixel's square has lent, with the weight 0.
vec4 mean_along(ivec2 pixel, uvec4 guide, olx_camera_frame camera, olx_shown middle) {
  vec2 size = vec2(size_of(job.size)), shift = shift_of(job.camera);
  olx_incident own = incident_of(texelFetch(light_image, pixel, 0));
  olx_scales here = olx_scales_of(own, count_of(guide));
  int steps = int(job.radius_pixels / job.stride_pixels);
  vec3 sum = vec3(0.0);
  float weight_sum = 0.0;
  for (int i = -steps; i <= steps; i++) {
    int away = tap_distance(i, steps);
    ivec2 tap = pixel + (columns() ? ivec2(0, away) : ivec2(away, 0));
    if (any(lessThan(tap, ivec2(0))) || any(greaterThanEqual(tap, ivec2(size_of(job.size))))) continue;
    uvec4 guide_there = texelFetch(guide_image, tap, 0);
    if (guide_is_empty(guide_there)) continue;
    vec4 history = texelFetch(light_image, tap, 0), row = columns() ? texelFetch(rows_image, tap, 0) : vec4(0.0);
    float count = columns() ? row.a : count_of(guide_there);
    if (!(count > 0.0) || !columns() && !olx_is_sample(incident_of(history))) continue;
    olx_shown there = guide_shows(guide_there, camera, size, vec2(tap) + shift);
    float weight = olx_tap_weight(glossy(), float(job.radius_pixels), job.reach, middle, here, there, history.a,
                                  abs(float(away)));
    if (columns() || job.reach > 0.0) weight *= count;
    sum += (columns() ? row.rgb : history.rgb) * weight;
    weight_sum += weight;
  }
  if (weight_sum > OLX_LEAST_WEIGHT) return vec4(sum / weight_sum, weight_sum);
  return vec4(olx_is_sample(own) ? own.light : vec3(0.0), 0.0);
}

// Converts incident light to reflected light and writes it; pixels without a specular lobe reflect none, and those lit
// by dim.comp stay unchanged.
void write_glossy(ivec2 pixel, olx_shown middle, vec3 light) {
  vec3 material = texelFetch(roughness_image, pixel, 0).rgb; // roughness, metallic, specular weight
  olx_bsdf bsdf = olx_bsdf_make(texelFetch(albedo_image, pixel, 0).rgb, material.y, material.x, material.z);
  float cosine = olx_dot(olx_normalize(job.camera.eye.xyz - middle.position), middle.normal);
  if (!olx_bsdf_has_specular(bsdf)) {
    imageStore(out_target, pixel, vec4(0.0, 0.0, 0.0, 1.0));
    return;
  }
  if (olx_lobe_is_dim(bsdf, cosine, job.dim_lobe)) return;
  vec3 reflected = light * max(olx_fresnel(bsdf, cosine), vec3(OLX_LEAST_FRESNEL));
  // Only the alpha of pixels that traced is read, and these write it as it is, so that all may read and write at once.
  ivec2 traced = min(traced_pixel(job.flags, pixel), ivec2(size_of(job.size)) - 1);
  imageStore(out_target, pixel, vec4(min(reflected, vec3(OLX_HALF_MOST)), imageLoad(out_target, traced).a));
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(uvec2(pixel), size_of(job.size)))) return;
  uvec4 guide = texelFetch(guide_image, pixel, 0);
  olx_camera_frame camera = camera_of(job.camera, has_flag(OLX_DENOISE_MIRRORED));
  olx_shown middle = guide_shows(guide, camera, vec2(size_of(job.size)), vec2(pixel) + shift_of(job.camera));
  vec4 mean = guide_is_empty(guide) ? vec4(0.0) : mean_along(pixel, guide, camera, middle);
  if (!columns()) imageStore(out_rows, pixel, min(mean, vec4(OLX_HALF_MOST)));
  else if (guide_is_empty(guide)) imageStore(out_target, pixel, vec4(vec3(0.0), glossy() ? 1.0 : 0.0));
  else if (glossy()) write_glossy(pixel, middle, mean.rgb);
  else imageStore(out_target, pixel, vec4(mean.rgb, 1.0));
}
