// Traces the ray of the picked pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_pixels.glsl"

layout(local_size_x = 1) in;

void main() {
  pixel_ray ray;
  pick.position = vec4(0.0);
  pick.probe = OLX_NO_PROBE;
  if (!told_ray(ivec2(view.pick), ray)) return;
  olx_trace_hit hit = olx_trace(view_settings(true), ray.origin, ray.direction, OLX_INFINITY);
  pick.position = vec4(ray.origin, 1.0);
  pick.normal = vec4(ray.normal, 0.0);
  pick.direction = vec4(ray.direction, hit.distance_metres);
  pick.status = hit.status;
  pick.probe = hit.probe;
  pick.steps = hit.texel_steps;
  pick.tried = hit.probes_tried;
}
