#version 460
#extension GL_GOOGLE_include_directive : require
#include "cube_shared.glsl"

layout(location = 0) flat out uint triangle;
layout(location = 1) out vec4 both_uvs;
layout(location = 2) out float vertex_alpha;

void main() {
  triangle = triangle_drawn(gl_VertexIndex);
  uint vertex = vertex_drawn(gl_VertexIndex);
  both_uvs = uvs[vertex];
  vertex_alpha = alphas[vertex];
  gl_Position = place_on_face(vertex);
}
