// The corners of the square in the window in which a map is shown.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_frame.glsl"

layout(location = 0) out vec2 uv;

void main() {
  uv = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1);
  vec2 pixel = view.pick + uv * view.radius;
  gl_Position = vec4(pixel / vec2(view.width, view.height) * 2.0 - 1.0, 1.0, 1.0);
}
