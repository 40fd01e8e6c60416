#version 460
#extension GL_GOOGLE_include_directive : require
#include "raster_shared.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 uvs;
layout(location = 3) flat in vec3 outward;
layout(location = 4) flat in vec3 along_u;
layout(location = 5) flat in vec3 along_v;
layout(location = 6) in vec4 color;
layout(location = 7) in vec4 tangent;
// Flags of the material. The vertex shader passes them on because all pixels of a quad need them to choose coordinates,
// and helper pixels outside the triangle read no buffers.
layout(location = 8) flat in uint flags;

layout(location = 0) out vec4 out_normal;
layout(location = 1) out vec4 out_albedo;
layout(location = 2) out vec4 out_material;
layout(location = 3) out vec4 out_vertex_normal;
layout(location = 4) out vec4 out_color;

const float MAX_ALBEDO = 0.95, MIN_NORMAL_COSINE = 0.01, MIN_VIEW_COSINE = 1e-3, LARGEST_HALF = 65504.0;

// Returns the normal in the map, in the tangent frame: x along increasing u, y along decreasing v.
vec3 mapped_normal(raster_material m) {
  vec2 uv = uv_for(flags, SECOND_NORMAL, uvs);
  if ((m.flags & NORMAL_IS_HEIGHT) == 0u) {
    vec3 n = texture(normal_texture, uv).xyz * 2.0 - 1.0;
    return vec3(n.xy * m.normal_scale, n.z);
  }
  vec2 step = 0.5 / vec2(textureSize(normal_texture, 0));
  float rise_u = texture(normal_texture, uv + vec2(step.x, 0.0)).r - texture(normal_texture, uv - vec2(step.x, 0.0)).r;
  float rise_v = texture(normal_texture, uv + vec2(0.0, step.y)).r - texture(normal_texture, uv - vec2(0.0, step.y)).r;
  return vec3(-rise_u * m.normal_scale, rise_v * m.normal_scale, 1.0);
}

// Finds the directions of a normal map's x and y at a normal, from the vertices' tangents or, where there are none,
// from texture coordinates.
bool find_frame(vec3 n, out vec3 x, out vec3 y) {
  vec3 given = tangent.xyz - n * dot(tangent.xyz, n);
  if (tangent.w != 0.0 && length(given) > 1e-3) {
    x = normalize(given);
    y = cross(n, x) * ((tangent.w < 0.0) != (dot(normal, n) < 0.0) ? -1.0 : 1.0);
    return true;
  }
  x = normalize(along_u - n * dot(along_u, n));
  vec3 across = cross(n, x);
  y = dot(across, along_v) > 0.0 ? -across : across;
  return dot(along_u, along_u) != 0.0;
}

vec3 bend(raster_material m, vec3 n) {
  vec3 x, y;
  if (!find_frame(n, x, y)) return n;
  vec3 local = mapped_normal(m);
  vec3 bent = x * local.x + y * local.y + n * local.z;
  float size = length(bent);
  return size > 0.0 ? bent / size : n;
}

// Returns whether the object has been moved from its place in the scene.
bool is_moved() {
  return to_world[0] != vec4(1.0, 0.0, 0.0, 0.0) || to_world[1] != vec4(0.0, 1.0, 0.0, 0.0) ||
         to_world[2] != vec4(0.0, 0.0, 1.0, 0.0);
}

// Returns the interpolated vertex normal, on the side of the triangle's winding.
vec3 vertex_normal() {
  vec3 n = normalize(normal);
  float agreement = dot(n, outward);
  return agreement < 0.0 ? -n : agreement > 0.0 ? n : outward;
}

// Returns the shading normal on the visible side, like that of the ray caster's surfaces.
vec3 shading_normal(raster_material m, vec3 to_eye, bool back) {
  vec3 n = vertex_normal();
  if ((m.flags & NORMAL_MAP) != 0u) n = bend(m, n);
  float cosine = dot(n, outward);
  if (cosine < MIN_NORMAL_COSINE) n = normalize(n + outward * (MIN_NORMAL_COSINE - cosine));
  if (back) n = -n;
  float view_cosine = dot(n, to_eye);
  return view_cosine < MIN_VIEW_COSINE ? normalize(n + to_eye * (MIN_VIEW_COSINE - view_cosine)) : n;
}

void main() {
  raster_material m = materials[material];
  // Sampled before the mask discards pixels, because mip selection needs neighbouring pixels.
  vec3 base_color = m.base_color_alpha.rgb * texture(base_color_texture, uv_for(flags, SECOND_BASE_COLOR, uvs)).rgb;
  if ((m.flags & VERTEX_COLORS) != 0u) base_color *= color.rgb;
  vec3 emission = m.emission_cutoff.rgb * texture(emission_texture, uv_for(flags, SECOND_EMISSION, uvs)).rgb;
  vec3 surface = texture(metallic_roughness_texture, uv_for(flags, SECOND_METALLIC_ROUGHNESS, uvs)).gba;
  if ((m.flags & SPECULAR_IN_ALPHA) == 0u) surface.z = 1.0;
  vec3 to_eye = normalize(eye - position);
  bool back = dot(outward, to_eye) < 0.0;
  vec3 n = shading_normal(m, to_eye, back);
  if (!mask_present(m, uvs, color.a)) discard;
  if (back && (m.flags & EMITS_BOTH_SIDES) == 0u) emission = vec3(0.0);
  out_normal = vec4(n, 1.0);
  out_albedo = vec4(min(base_color, vec3(MAX_ALBEDO)), 1.0);
  out_material = vec4(m.roughness * surface.x, m.metallic * surface.y, m.specular_weight * surface.z,
                      is_moved() ? 1.0 : 0.0);
  out_vertex_normal = vec4(back ? -vertex_normal() : vertex_normal(), 1.0);
  out_color = vec4(min(emission, vec3(LARGEST_HALF)), 1.0);
}
