// The host's one pass: transforms vertices to clip space.
#version 460

layout(push_constant) uniform camera {
  mat4 world_to_clip;
  vec4 eye;
};
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 base_color;
layout(location = 3) in vec3 material;
layout(location = 4) in vec3 emission;
layout(location = 0) out vec3 surface_position;
layout(location = 1) out vec3 surface_normal;
layout(location = 2) out vec3 surface_base_color;
layout(location = 3) out vec3 surface_material;
layout(location = 4) out vec3 surface_emission;

void main() {
  gl_Position = world_to_clip * vec4(position, 1.0);
  surface_position = position;
  surface_normal = normal;
  surface_base_color = base_color;
  surface_material = material;
  surface_emission = emission;
}
