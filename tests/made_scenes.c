// Makes small scenes from squares, rooms and textures for tests.
#include "made_scenes.h"

#include "core/hooks.h"
#include "core/sampling.h"
#include "scene/builtin/builtin_shapes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

olx_scene *made_scene(void) {
  olx_scene *scene = olx_allocate_zero(1, sizeof *scene);
  assert_non_null(scene);
  return scene;
}

uint32_t made_material(olx_scene *scene, const olx_material *material) {
  uint32_t index = 0;
  assert_int_equal(olx_scene_add_material(scene, material, &index), OLX_OK);
  return index;
}

uint32_t made_texture(olx_scene *scene, uint32_t width, uint32_t height, const uint8_t *rgba, bool srgb) {
  const size_t texels = (size_t)width * height;
  const olx_texture texture = {.width = width, .height = height, .texels = olx_allocate(texels, 4), .srgb = srgb};
  assert_non_null(texture.texels);
  memcpy(texture.texels, rgba, texels * 4);
  uint32_t index = 0;
  assert_int_equal(olx_scene_add_texture(scene, &texture, &index), OLX_OK);
  return index;
}

void made_quad(olx_scene *scene, olx_vec3 center, olx_vec3 edge_u, olx_vec3 edge_v, uint32_t material) {
  const olx_vec3 corner = olx_madd(olx_madd(center, edge_u, -0.5f), edge_v, -0.5f), along = olx_add(corner, edge_u);
  const olx_vec3 corners[4] = {corner, along, olx_add(along, edge_v), olx_add(corner, edge_v)};
  const olx_vec2 uvs[4] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 1.0f}, {0.0f, 1.0f}};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  assert_int_equal(olx_scene_add_mesh(scene, "quad", corners, NULL, uvs, 4, indices, 2, material), OLX_OK);
}

void made_square(olx_scene *scene, float y, uint32_t material) {
  const olx_vec3 corners[4] = {{-1.0f, y, -1.0f}, {-1.0f, y, 1.0f}, {1.0f, y, 1.0f}, {1.0f, y, -1.0f}};
  const olx_vec2 uvs[4] = {{0.0f, 0.0f}, {0.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, 0.0f}};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  assert_int_equal(olx_scene_add_mesh(scene, "square", corners, NULL, uvs, 4, indices, 2, material), OLX_OK);
}

void made_room(olx_scene *scene, olx_vec3 center, float side, uint32_t material) {
  const uint32_t materials[6] = {material, material, material, material, material, material};
  const olx_vec3 half = olx_splat(0.5f * side);
  assert_int_equal(olx_add_room(scene, "room", olx_sub(center, half), olx_add(center, half), materials), OLX_OK);
}

void made_box(olx_scene *scene, olx_vec3 low, olx_vec3 high, bool outward, uint32_t material) {
  olx_vec3 p[8];
  for (uint32_t i = 0; i < 8; i++) {
    p[i] = olx_v3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  }
  const uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  uint32_t indices[36];
  for (uint32_t f = 0; f < 6; f++) {
    const uint32_t *q = faces[f], order[6] = {q[0], q[1], q[2], q[0], q[2], q[3]};
    for (uint32_t i = 0; i < 6; i++) indices[6 * f + i] = order[outward ? i : 5 - i];
  }
  assert_int_equal(olx_scene_add_mesh(scene, "box", p, NULL, NULL, 8, indices, 12, material), OLX_OK);
}

olx_scene *made_finish(olx_scene *scene) {
  assert_int_equal(olx_scene_finish(scene), OLX_OK);
  return scene;
}

olx_vec2 made_random(uint32_t seed, uint32_t index) {
  return (olx_vec2){olx_unit_float(olx_hash3(seed, index, 0)), olx_unit_float(olx_hash3(seed, index, 1))};
}
