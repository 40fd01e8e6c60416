// The corners of a square around each probe's ball.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_frame.glsl"

layout(location = 0) out vec3 world;
layout(location = 1) flat out vec4 ball; // centre, radius
layout(location = 2) flat out uint probe;

void main() {
  probe = uint(gl_InstanceIndex);
  bool irradiance = view.overlay == VIEW_SHADE_BALL_IRRADIANCE;
  vec3 centre = irradiance ? olx_irradiance_probe_position(probe) : olx_probe_position(probe);
  uint flags = irradiance ? olx_irradiance_probes[probe].flags : olx_probes[probe].flags;
  float radius = view.radius * ((flags & OLX_PROBE_BURIED) != 0u ? 0.6 : 1.0);
  vec3 axis = centre - view.eye.xyz, u, v;
  float distance = length(axis);
  ball = vec4(centre, radius);
  vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
  if (distance > 1.2 * radius) {
    olx_basis(axis / distance, u, v);
    float reach = 1.05 * radius * distance / sqrt(distance * distance - radius * radius);
    world = centre + (u * corner.x + v * corner.y) * reach;
    gl_Position = mat4(view.matrix[0], view.matrix[1], view.matrix[2], view.matrix[3]) * vec4(world, 1.0);
  } else { // the eye is inside the ball
    world = centre;
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
  }
}
