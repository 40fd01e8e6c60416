// Makes glTF models of a square, one feature each, loads them, and asserts what their scenes hold or say.
#include "gltf_square.h"

#include "scene/bvh.h"
#include "scene_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

const char *write_square_model(const gltf_maker *m, const scene_folder *folder, const char *primitive,
                               const char *nodes, const char *more) {
  char *text = gltf_maker_text(m, primitive, nodes, more, false);
  const char *path = scene_folder_write_text(folder, "made.gltf", text);
  free(text);
  return path;
}

olx_scene *load_model(const char *path) {
  olx_scene *scene = NULL;
  if (olx_scene_load(path, &scene) != OLX_OK) fail_msg("%s", olx_last_error());
  return scene;
}

void assert_model_refused(const char *path, olx_result expected, const char *part) {
  olx_scene *scene = NULL;
  const olx_result result = olx_scene_load(path, &scene);
  olx_scene_free(scene);
  if (result != expected || !strstr(olx_last_error(), part) || !strstr(olx_last_error(), "made.gltf")) {
    fail_msg("%d, \"%s\" does not say \"%s\" of made.gltf", result, olx_last_error(), part);
  }
}

void assert_model_warned(const olx_scene *scene, const char *part) {
  for (uint32_t i = 0; i < scene->warning_count; ++i) {
    if (strstr(scene->warnings[i], part)) return;
  }
  fail_msg("no warning says \"%s\"", part);
}

void assert_near_number(float a, float b, float tolerance) {
  if (!(fabsf(a - b) <= tolerance)) fail_msg("%g is not %g", (double)a, (double)b);
}

void assert_near_vector(olx_vec3 v, float x, float y, float z, float tolerance) {
  if (!(olx_length(olx_sub(v, olx_v3(x, y, z))) <= tolerance)) {
    fail_msg("(%g %g %g) is not (%g %g %g)", (double)v.x, (double)v.y, (double)v.z, (double)x, (double)y, (double)z);
  }
}

olx_vec3 winding_normal(const olx_scene *scene, uint32_t triangle) {
  const uint32_t *i = scene->indices + (size_t)triangle * 3;
  const olx_vec3 a = scene->positions[i[0]];
  return olx_normalize(olx_cross(olx_sub(scene->positions[i[1]], a), olx_sub(scene->positions[i[2]], a)));
}

olx_surface look_at_square(const olx_scene *scene, float x, float y) {
  const olx_ray ray = {{x, y, 1.0f}, {0.0f, 0.0f, -1.0f}, 0.0f, INFINITY};
  const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
  assert_int_not_equal(hit.triangle, OLX_NO_HIT);
  return olx_surface_at(scene, &hit, ray.direction);
}

const float square_positions[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const float square_normals[12] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
const float square_uvs[8] = {0, 1, 1, 1, 1, 0, 0, 0};
const uint16_t square_indices[6] = {0, 1, 2, 0, 2, 3};
uint32_t add_square(gltf_maker *m) {
  const uint32_t first = gltf_add(m, square_positions, sizeof square_positions, 4, GLTF_FLOAT, "VEC3", false);
  gltf_add(m, square_normals, sizeof square_normals, 4, GLTF_FLOAT, "VEC3", false);
  gltf_add(m, square_uvs, sizeof square_uvs, 4, GLTF_FLOAT, "VEC2", false);
  gltf_add(m, square_indices, sizeof square_indices, 6, GLTF_UINT16, "SCALAR", false);
  return first;
}

#define SQUARE                                                                                                         \
  "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2%s}, \"indices\": 3, \"material\": 0}"

const char *square_with(const char *attributes) {
  static char text[512];
  snprintf(text, sizeof text, SQUARE, attributes);
  return text;
}
