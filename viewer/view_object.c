// Creates a ball that is not part of the scene, but casts shadows and receives indirect light from the field.
#include "view_object.h"

#include <math.h>
#include <string.h>

enum { RINGS = 32, SPOKES = 64, VERTICES = (RINGS + 1) * (SPOKES + 1), TRIANGLES = RINGS * SPOKES * 2 };

typedef struct ball_mesh {
  olx_vec3 positions[VERTICES];
  olx_vec2 uvs[VERTICES];
  uint32_t indices[3 * TRIANGLES], materials[TRIANGLES];
} ball_mesh;

static void make_mesh(ball_mesh *mesh) {
  for (uint32_t ring = 0; ring <= RINGS; ring++) {
    for (uint32_t spoke = 0; spoke <= SPOKES; spoke++) {
      const float v = (float)ring / RINGS, u = (float)spoke / SPOKES;
      const float polar = 3.14159265f * v, around = 6.28318531f * u;
      const uint32_t at = ring * (SPOKES + 1) + spoke;
      mesh->positions[at] = (olx_vec3){sinf(polar) * cosf(around), cosf(polar), sinf(polar) * sinf(around)};
      mesh->uvs[at] = (olx_vec2){u, v};
    }
  }
  uint32_t *index = mesh->indices;
  for (uint32_t ring = 0; ring < RINGS; ring++) {
    for (uint32_t spoke = 0; spoke < SPOKES; spoke++) {
      const uint32_t a = ring * (SPOKES + 1) + spoke, b = a + SPOKES + 1;
      const uint32_t corners[6] = {a, a + 1, b, a + 1, b + 1, b};
      memcpy(index, corners, sizeof corners);
      index += 6;
    }
  }
  memset(mesh->materials, 0, sizeof mesh->materials);
}

bool view_object_create(gpu_device *device, float roughness, float metallic, gpu_scene *object) {
  ball_mesh mesh;
  make_mesh(&mesh);
  const olx_material material = {.name = "ball",
                                 .base_color = {0.85f, 0.82f, 0.78f},
                                 .metallic = metallic,
                                 .roughness = roughness,
                                 .specular_weight = 1.0f,
                                 .alpha = 1.0f,
                                 .base_color_texture = OLX_NO_TEXTURE,
                                 .alpha_texture = OLX_NO_TEXTURE,
                                 .metallic_roughness_texture = OLX_NO_TEXTURE,
                                 .emission_texture = OLX_NO_TEXTURE,
                                 .normal_texture = OLX_NO_TEXTURE,
                                 .normal_scale = 1.0f};
  const olx_environment none = {.texels = NULL};
  const olx_scene_content content = {.vertex_count = VERTICES,
                                     .triangle_count = TRIANGLES,
                                     .material_count = 1,
                                     .positions = mesh.positions,
                                     .normals = mesh.positions,
                                     .uvs = mesh.uvs,
                                     .indices = mesh.indices,
                                     .material_index = mesh.materials,
                                     .materials = &material,
                                     .environment = &none,
                                     .bounds_min = {-1, -1, -1},
                                     .bounds_max = {1, 1, 1}};
  return gpu_scene_create(device, &content, object);
}

draw_item view_object_place(const gpu_scene *object, const view_state *state) {
  const float r = state->object_radius;
  const olx_vec3 p = state->object_position;
  return (draw_item){object, {r, 0, 0, p.x, 0, r, 0, p.y, 0, 0, r, p.z}};
}
