#version 460
#extension GL_GOOGLE_include_directive : require
#include "raster_shared.glsl"

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec4 uvs;
layout(location = 3) flat out vec3 outward; // of the triangle's winding, unit
layout(location = 4) flat out vec3 along_u; // zero where texture coordinates span no frame
layout(location = 5) flat out vec3 along_v;
layout(location = 6) out vec4 color;
layout(location = 7) out vec4 tangent;
layout(location = 8) flat out uint flags; // of the material

vec2 uv_of(raster_vertex v) { return vec2(v.position_u.w, v.normal_v.w); }

// The texture coordinates of the normal map.
vec2 normal_uv(raster_material m, int corner) {
  uint vertex = indices[corner];
  return (m.flags & SECOND_NORMAL) != 0u ? rare[vertex].second_uv.xy : uv_of(vertices[vertex]);
}

// The directions of increasing u and v; their lengths are arbitrary.
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
  raster_material m = materials[material];
  if ((m.flags & NORMAL_MAP) != 0u) {
    vec2 from = normal_uv(m, first);
    span_texture(e1, e2, normal_uv(m, first + 1) - from, normal_uv(m, first + 2) - from);
  }
  raster_vertex own = gl_VertexIndex == first ? a : gl_VertexIndex == first + 1 ? b : c;
  position = place_point(own.position_u.xyz);
  normal = place_direction(own.normal_v.xyz);
  raster_rare more = rare_of(m, indices[gl_VertexIndex], uv_of(own));
  uvs = vec4(uv_of(own), more.second_uv.xy);
  color = more.color;
  flags = m.flags;
  tangent = vec4(place_direction(more.tangent.xyz), more.tangent.w);
  gl_Position = world_to_clip * vec4(position, 1.0);
}
