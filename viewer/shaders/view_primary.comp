// Renders the image from the field alone: what the ray of each pixel finds (McGuire et al. 2017, Figure 20).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_pixels.glsl"

layout(local_size_x = OLX_PASS_SIZE, local_size_y = OLX_PASS_SIZE) in;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (pixel.x >= int(view.width) || pixel.y >= int(view.height)) return;
  pixel_ray ray = eye_ray(pixel);
  olx_sample_settings settings = view_settings(true);
  olx_trace_hit hit = olx_trace(settings, ray.origin, ray.direction, OLX_INFINITY);
  vec3 light = olx_light_found(settings, hit, ray.origin);
  imageStore(color_image, pixel, vec4(clamp(light, vec3(0.0), vec3(65504.0)), 1.0));
}
