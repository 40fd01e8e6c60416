#version 460
#extension GL_GOOGLE_include_directive : require
#include "raster_shared.glsl"

layout(location = 0) out vec4 uvs;
layout(location = 1) out float vertex_alpha;

void main() {
  uint vertex = indices[gl_VertexIndex];
  raster_vertex own = vertices[vertex];
  vec2 uv = vec2(own.position_u.w, own.normal_v.w);
  raster_rare more = rare_of(materials[material], vertex, uv);
  uvs = vec4(uv, more.second_uv.xy);
  vertex_alpha = more.color.a;
  gl_Position = world_to_clip * vec4(place_point(own.position_u.xyz), 1.0);
}
