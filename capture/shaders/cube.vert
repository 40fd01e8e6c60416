#version 460
#extension GL_GOOGLE_include_directive : require
#include "cube_shared.glsl"

layout(location = 0) flat out uint triangle;

void main() {
  triangle = triangle_drawn(gl_VertexIndex);
  gl_Position = place_on_face(vertex_drawn(gl_VertexIndex));
}
