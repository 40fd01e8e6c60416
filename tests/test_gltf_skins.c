// Tests that skinned glTF meshes stand as their joints do at rest, and that skins that do not fit are refused. Each
// file is made here and has one feature.
#include "gltf_square.h"
#include "scene/scene_build.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static const uint8_t two_joints[16] = {0, 9, 9, 9, 1, 9, 9, 9, 0, 1, 9, 9, 0, 9, 9, 9}; // 9 has no weight anywhere
static const float two_weights[16] = {1, 0, 0, 0, 1, 0, 0, 0, 2, 2, 0, 0, 0.5f, 0, 0, 0};
static const float plain_matrices[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};

// Nodes 2 and 3 are joints, node 1 has the mesh, and a transform that does not count.
#define SKINNED_NODES(of_first, of_second)                                                                             \
  "[{\"children\": [1, 2, 3]}, {\"mesh\": 0, \"skin\": 0, \"translation\": [100, 0, 0], \"scale\": [5, -5, 5]}, "      \
  "{" of_first "}, {" of_second "}]"
#define APART SKINNED_NODES("\"translation\": [0, 0, 5]", "\"translation\": [10, 0, 0], \"scale\": [2, 2, 2]")
#define BOTH_JOINTS ", \"materials\": [{}], \"skins\": [{\"joints\": [2, 3], \"inverseBindMatrices\": 6}]"
#define BONDS ", \"JOINTS_0\": 4, \"WEIGHTS_0\": 5"

// Makes a square whose accessors 4 to 6 are joints, weights and the inverse matrices of two joints.
static gltf_maker skinned_square(const uint8_t joints[16], const float weights[16]) {
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, joints, 16, 4, GLTF_UINT8, "VEC4", false);
  gltf_add(&m, weights, 64, 4, GLTF_FLOAT, "VEC4", false);
  gltf_add(&m, plain_matrices, sizeof plain_matrices, 2, GLTF_FLOAT, "MAT4", false);
  return m;
}

static void skinned_vertices_follow_their_joints_and_not_their_node(void **state) {
  gltf_maker m = skinned_square(two_joints, two_weights);
  olx_scene *scene = load_model(write_square_model(&m, *state, square_with(BONDS), APART, BOTH_JOINTS));
  assert_near_vector(scene->positions[0], 0, 0, 5, 1e-5f);
  assert_near_vector(scene->positions[1], 10, 0, 0, 1e-5f);         // 2 (1 - 1) + 10
  assert_near_vector(scene->positions[2], 5.5f, 1.5f, 2.5f, 1e-5f); // the mean of (1, 1, 5) and (10, 2, 0)
  assert_near_vector(scene->positions[3], 0, 1, 5, 1e-5f);
  assert_model_warned(scene, "1 skinned meshes stand as their joints do at rest");
  olx_scene_free(scene);
  scene =
      load_model(scene_folder_write_text(*state, "made.json", "{\"model\": \"made.gltf\", \"translate\": [0, 0, 3]}"));
  assert_near_vector(scene->positions[0], 0, 0, 8, 1e-5f);
  olx_scene_free(scene);
}

static void skins_without_matrices_take_joints_as_they_are(void **state) {
  gltf_maker m = skinned_square(two_joints, two_weights);
  olx_scene *scene = load_model(write_square_model(&m, *state, square_with(BONDS), APART,
                                                   ", \"materials\": [{}], \"skins\": [{\"joints\": [2, 3]}]"));
  assert_near_vector(scene->positions[1], 12, 0, 0, 1e-5f);
  olx_scene_free(scene);
}

static void joints_turn_normals_and_keep_fronts(void **state) {
  const uint8_t first[16] = {0};
  gltf_maker m = skinned_square(first, two_weights);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, square_with(BONDS),
      SKINNED_NODES("\"rotation\": [0.70710678, 0, 0, 0.70710678], \"scale\": [3, 1, 1]", ""), BOTH_JOINTS));
  for (uint32_t v = 0; v < 4; ++v) assert_near_vector(scene->normals[v], 0, -1, 0, 1e-5f);
  assert_near_vector(winding_normal(scene, 0), 0, -1, 0, 1e-5f);
  olx_scene_free(scene);
  scene = load_model(
      write_square_model(&m, *state, square_with(BONDS), SKINNED_NODES("\"scale\": [-1, 1, 1]", ""), BOTH_JOINTS));
  assert_near_vector(scene->normals[0], 0, 0, 1, 1e-5f);
  assert_near_vector(winding_normal(scene, 0), 0, 0, 1, 1e-5f);
  olx_scene_free(scene);
}

// Attributes of another count than the positions are no joints.
static void primitives_without_joints_follow_the_first_one(void **state) {
  gltf_maker m = skinned_square(two_joints, two_weights);
  gltf_add(&m, two_joints, 12, 3, GLTF_UINT8, "VEC4", false);
  static const char *const bonds[] = {"", ", \"JOINTS_0\": 4", ", \"JOINTS_0\": 7, \"WEIGHTS_0\": 5"};
  for (size_t i = 0; i < sizeof bonds / sizeof *bonds; ++i) {
    olx_scene *scene = load_model(write_square_model(&m, *state, square_with(bonds[i]), APART, BOTH_JOINTS));
    assert_near_vector(scene->positions[1], 1, 0, 5, 1e-5f);
    assert_model_warned(scene, "4 vertices of skinned meshes have no usable weights");
    if (i == 2) assert_model_warned(scene, "1 attributes are ignored");
    olx_scene_free(scene);
  }
}

static void vertices_without_usable_weights_follow_their_first_joint(void **state) {
  const float weights[16] = {0, 0, 0, 0, NAN, 0, 0, 0, 2, -1, 0, 0, 1, INFINITY, 0, 0};
  gltf_maker m = skinned_square(two_joints, weights);
  olx_scene *scene = load_model(write_square_model(&m, *state, square_with(BONDS), APART, BOTH_JOINTS));
  assert_near_vector(scene->positions[0], 0, 0, 5, 1e-5f);
  assert_near_vector(scene->positions[1], 10, 0, 0, 1e-5f);
  assert_near_vector(scene->positions[2], 1, 1, 5, 1e-5f);
  assert_near_vector(scene->positions[3], 0, 1, 5, 1e-5f);
  assert_model_warned(scene, "4 vertices of skinned meshes have no usable weights");
  olx_scene_free(scene);
}

static void a_skinned_mesh_stands_in_one_place(void **state) {
  const float translations[6] = {1, 0, 0, 2, 0, 0};
  gltf_maker m = skinned_square(two_joints, two_weights);
  gltf_add(&m, translations, sizeof translations, 2, GLTF_FLOAT, "VEC3", false);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, square_with(BONDS),
      "[{\"children\": [1, 2, 3]}, {\"mesh\": 0, \"skin\": 0, \"extensions\": {\"EXT_mesh_gpu_instancing\": "
      "{\"attributes\": {\"TRANSLATION\": 7}}}}, {}, {\"translation\": [10, 0, 0]}]",
      BOTH_JOINTS));
  assert_int_equal(scene->triangle_count, 2);
  assert_near_vector(scene->positions[0], 0, 0, 0, 1e-5f);
  olx_scene_free(scene);
}

static void skins_that_do_not_fit_are_refused(void **state) {
  static const char *const cases[][2] = {
      {"", "skins[0]: it has no joints"},
      {"\"joints\": []", "skins[0]: it has no joints"},
      {"\"joints\": [2, 9]", "skins[0]: a joint does not exist"},
      {"\"joints\": [2, 4]", "skins[0]: a joint is not in the file's scene"},
      {"\"joints\": [2], \"inverseBindMatrices\": 77", "skins[0]: the accessor of its inverseBindMatrices"},
      {"\"joints\": [2], \"inverseBindMatrices\": 5", "skins[0]: its inverseBindMatrices are not plain matrices"},
      {"\"joints\": [2, 3, 0], \"inverseBindMatrices\": 6", "skins[0]: it has fewer inverseBindMatrices than joints"},
      {"\"joints\": [2]", "accessors[4]: a vertex follows a joint that its skin does not have"}};
  gltf_maker m = skinned_square(two_joints, two_weights);
  const char *nodes = "[{\"children\": [1, 2, 3]}, {\"mesh\": 0, \"skin\": 0}, {}, {}, {}]";
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    char more[160];
    snprintf(more, sizeof more, ", \"materials\": [{}], \"skins\": [{%s}]", cases[i][0]);
    assert_model_refused(write_square_model(&m, *state, square_with(BONDS), nodes, more), OLX_ERROR_FORMAT,
                         cases[i][1]);
  }
  assert_model_refused(write_square_model(&m, *state, square_with(BONDS), nodes, ", \"materials\": [{}]"),
                       OLX_ERROR_FORMAT, "nodes[1]: its skin does not exist");
  assert_model_refused(
      write_square_model(&m, *state, square_with(", \"JOINTS_0\": 0, \"WEIGHTS_0\": 5"), nodes, BOTH_JOINTS),
      OLX_ERROR_UNSUPPORTED, "JOINTS_0 is not made of four");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(skinned_vertices_follow_their_joints_and_not_their_node),
      WITH_FOLDER(skins_without_matrices_take_joints_as_they_are),
      WITH_FOLDER(joints_turn_normals_and_keep_fronts),
      WITH_FOLDER(primitives_without_joints_follow_the_first_one),
      WITH_FOLDER(vertices_without_usable_weights_follow_their_first_joint),
      WITH_FOLDER(a_skinned_mesh_stands_in_one_place),
      WITH_FOLDER(skins_that_do_not_fit_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
