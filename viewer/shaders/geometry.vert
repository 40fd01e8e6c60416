#version 460
#extension GL_GOOGLE_include_directive : require
#include "raster_shared.glsl"

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec2 uv;
layout(location = 3) flat out vec3 outward; // of the triangle's winding, unit
layout(location = 4) flat out vec3 along_u; // zero where texture coordinates span no frame
layout(location = 5) flat out vec3 along_v;

vec2 uv_of(raster_vertex v) { return vec2(v.position_u.w, v.normal_v.w); }

// The directions in which u and v grow; their lengths say nothing.
void span_texture(vec3 e1, vec3 e2, vec2 d1, vec2 d2) {
  float determinant = d1.x * d2.y - d2.x * d1.y;
  float orientation = determinant > 0.0 ? 1.0 : determinant < 0.0 ? -1.0 : 0.0;
  along_u = normalize(e1 * d2.y - e2 * d1.y) * orientation;
  along_v = normalize(e2 * d1.x - e1 * d2.x) * orientation;
  if (orientation == 0.0) along_u = along_v = vec3(0.0);
}

void main() {
  int first = gl_VertexIndex - gl_VertexIndex % 3;
  raster_vertex a = vertices[indices[first]], b = vertices[indices[first + 1]], c = vertices[indices[first + 2]];
  vec3 e1 = place_direction(b.position_u.xyz - a.position_u.xyz);
  vec3 e2 = place_direction(c.position_u.xyz - a.position_u.xyz);
  outward = normalize(cross(e1, e2));
  along_u = along_v = vec3(0.0);
  if ((materials[material].flags & NORMAL_MAP) != 0u) span_texture(e1, e2, uv_of(b) - uv_of(a), uv_of(c) - uv_of(a));
  raster_vertex own = gl_VertexIndex == first ? a : gl_VertexIndex == first + 1 ? b : c;
  position = place_point(own.position_u.xyz);
  normal = place_direction(own.normal_v.xyz);
  uv = uv_of(own);
  gl_Position = world_to_clip * vec4(position, 1.0);
}
