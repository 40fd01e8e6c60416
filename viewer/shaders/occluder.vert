#version 460
#extension GL_GOOGLE_include_directive : require
#include "raster_shared.glsl"

layout(location = 0) out vec2 uv;

void main() {
  raster_vertex own = vertices[indices[gl_VertexIndex]];
  uv = vec2(own.position_u.w, own.normal_v.w);
  gl_Position = world_to_clip * vec4(place_point(own.position_u.xyz), 1.0);
}
