// The images of the viewer's compute passes, and the ray of a pixel.
#ifndef VIEW_PIXELS_GLSL
#define VIEW_PIXELS_GLSL

#include "view_frame.glsl"

layout(set = 1, binding = VIEW_BINDING_DEPTH) uniform sampler2D depth_image;
layout(set = 1, binding = VIEW_BINDING_NORMAL) uniform sampler2D normal_image;
layout(set = 1, binding = VIEW_BINDING_COLOR, rgba16f) uniform image2D color_image;
layout(set = 1, binding = VIEW_BINDING_DISPLAY, rgba8) uniform image2D display_image;
layout(set = 1, binding = VIEW_BINDING_PICK, std430) buffer pick_block { view_gpu_pick pick; };

struct pixel_ray {
  vec3 origin, direction;
  vec3 normal; // normal of the surface that the ray leaves; 0 for rays from the eye
};

vec3 unproject(ivec2 pixel, float depth) {
  vec2 clip = (vec2(pixel) + 0.5) / vec2(view.width, view.height) * 2.0 - 1.0;
  vec4 world = view.matrix[0] * clip.x + view.matrix[1] * clip.y + view.matrix[2] * depth + view.matrix[3];
  return world.xyz / world.w;
}

// Returns the ray from the eye through the pixel.
pixel_ray eye_ray(ivec2 pixel) {
  return pixel_ray(view.eye.xyz, olx_normalize(unproject(pixel, 1.0) - view.eye.xyz), vec3(0.0));
}

// Finds the ray that overlays show: the mirror ray at the surface of a pixel, or the ray from the eye. Returns false
// when the pixel has none.
bool told_ray(ivec2 pixel, out pixel_ray ray) {
  ray = eye_ray(pixel);
  if (has_flag(VIEW_FLAG_EYE_RAYS)) return true;
  float depth = texelFetch(depth_image, pixel, 0).r;
  if (depth == view.eye.w) return false;
  ray.origin = unproject(pixel, depth);
  ray.normal = olx_normalize(texelFetch(normal_image, pixel, 0).xyz);
  ray.direction = olx_normalize(reflect(olx_normalize(ray.origin - view.eye.xyz), ray.normal));
  return true;
}

#endif
