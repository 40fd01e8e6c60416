// What draws of a cube's face share: the scene as capture/cube_scene.c uploads it, the face, and the material.
#ifndef CUBE_SHARED_GLSL
#define CUBE_SHARED_GLSL

layout(set = 0, binding = 0, std430) readonly buffer scene_positions { float positions[]; };
layout(set = 0, binding = 1, std430) readonly buffer scene_indices { uint indices[]; };
layout(set = 0, binding = 2, std430) readonly buffer scene_order { uint order[]; }; // triangles as they are drawn
layout(set = 0, binding = 3, std430) readonly buffer scene_uvs { vec4 uvs[]; };     // both sets of a vertex
layout(set = 0, binding = 4, std430) readonly buffer scene_alphas { float alphas[]; };
layout(set = 0, binding = 5) uniform sampler2D base_color_texture;
layout(set = 0, binding = 6) uniform sampler2D alpha_texture;

const uint SECOND_BASE_COLOR = 1u, SECOND_ALPHA = 2u; // flags: textures that are looked up by the second set

layout(push_constant) uniform face_constants {
  vec3 eye;
  float near;  // distance at which triangles are cut off
  uint axis;   // that the face looks along
  float side;  // 1: in its direction, -1: against it
  float scale; // of a face's coordinates, less than 1 by the ring of texels beyond its edge
  uint flags;
  float alpha, alpha_cutoff;
};

uint triangle_drawn(int corner) { return order[corner / 3]; }

uint vertex_drawn(int corner) { return indices[3u * triangle_drawn(corner) + uint(corner % 3)]; }

// Returns the place of a vertex on the face. Depth is near / distance, largest at the probe.
vec4 place_on_face(uint vertex) {
  vec3 p = vec3(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]) - eye;
  vec3 turned = axis == 0u ? p.yzx : axis == 1u ? p.zxy : p;
  return vec4(turned.xy * scale, near, turned.z * side);
}

#endif
