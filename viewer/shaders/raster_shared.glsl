// Shared by the passes that draw a scene: its buffers and textures as viewer/scene_upload.c binds them, and its
// transform.
#ifndef RASTER_SHARED_GLSL
#define RASTER_SHARED_GLSL

struct raster_vertex {
  vec4 position_u;
  vec4 normal_v;
};

// Attributes that few vertices have; read where the material's flags include RARE.
struct raster_rare {
  vec4 color;
  vec4 tangent; // w: handedness of the bitangent; 0: derived from texture coordinates
  vec4 second_uv;
};

struct raster_material {
  vec4 base_color_alpha;
  vec4 emission_cutoff;
  float metallic, roughness, specular_weight, normal_scale;
  uint flags, unused0, unused1, unused2;
};

const uint EMITS_BOTH_SIDES = 1u, NORMAL_MAP = 2u, NORMAL_IS_HEIGHT = 4u, ALPHA_MAP = 8u, VERTEX_COLORS = 16u,
           RARE = 32u, SPECULAR_IN_ALPHA = 64u;
// Flags of textures that use second_uv.
const uint SECOND_BASE_COLOR = 256u, SECOND_ALPHA = 512u, SECOND_METALLIC_ROUGHNESS = 1024u, SECOND_EMISSION = 2048u,
           SECOND_NORMAL = 4096u;

layout(set = 0, binding = 0, std430) readonly buffer scene_vertices { raster_vertex vertices[]; };
layout(set = 0, binding = 1, std430) readonly buffer scene_indices { uint indices[]; };
layout(set = 0, binding = 2, std430) readonly buffer scene_materials { raster_material materials[]; };
layout(set = 0, binding = 3, std430) readonly buffer scene_rare { raster_rare rare[]; };
layout(set = 0, binding = 4) uniform sampler2D base_color_texture;
layout(set = 0, binding = 5) uniform sampler2D alpha_texture;
layout(set = 0, binding = 6) uniform sampler2D metallic_roughness_texture;
layout(set = 0, binding = 7) uniform sampler2D emission_texture;
layout(set = 0, binding = 8) uniform sampler2D normal_texture;

layout(push_constant) uniform draw_constants {
  mat4 world_to_clip;
  vec4 to_world[3]; // rows
  vec3 eye;
  uint material;
};

vec3 place_point(vec3 p) {
  vec4 q = vec4(p, 1.0);
  return vec3(dot(to_world[0], q), dot(to_world[1], q), dot(to_world[2], q));
}

vec3 place_direction(vec3 v) { return vec3(dot(to_world[0].xyz, v), dot(to_world[1].xyz, v), dot(to_world[2].xyz, v)); }

raster_rare rare_of(raster_material m, uint vertex, vec2 uv) {
  if ((m.flags & RARE) != 0u) return rare[vertex];
  return raster_rare(vec4(1.0), vec4(0.0), vec4(uv, 0.0, 0.0));
}

// Returns the coordinates of a texture: xy are those of most textures, zw the second set.
vec2 uv_for(uint flags, uint second, vec4 uvs) { return (flags & second) != 0u ? uvs.zw : uvs.xy; }

// Returns whether the surface is opaque. The mask is read at its finest level, because coarser ones would thin out
// leaves with distance.
bool mask_present(raster_material m, vec4 uvs, float vertex_alpha) {
  float cutoff = m.emission_cutoff.a;
  if (cutoff <= 0.0) return true;
  float alpha = m.base_color_alpha.a * vertex_alpha;
  alpha *= textureLod(base_color_texture, uv_for(m.flags, SECOND_BASE_COLOR, uvs), 0.0).a;
  if ((m.flags & ALPHA_MAP) != 0u) alpha *= textureLod(alpha_texture, uv_for(m.flags, SECOND_ALPHA, uvs), 0.0).r;
  return alpha >= cutoff;
}

#endif
