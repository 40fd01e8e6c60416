// Places the vertices of skinned glTF meshes by their joints at rest.
#include "scene/gltf/gltf_skin.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_accessor.h"

#include <math.h>

enum { BONDS = 4, MATRIX = 16 }; // joints of a vertex, numbers of a matrix

static uint32_t matrices_of(const olx_gltf *gltf, uint32_t skin) {
  uint32_t accessor;
  olx_gltf_index(gltf->skins.elements[skin], "inverseBindMatrices", gltf->accessors.count, &accessor);
  return accessor;
}

// ---- Checks

static olx_result check_matrices(const olx_gltf *gltf, uint32_t skin, uint64_t joints) {
  uint32_t accessor;
  if (!olx_gltf_index(gltf->skins.elements[skin], "inverseBindMatrices", gltf->accessors.count, &accessor)) {
    return olx_gltf_fail(gltf, "skins", skin, "the accessor of its inverseBindMatrices does not exist");
  }
  if (accessor == OLX_GLTF_NONE) return OLX_OK;
  const olx_gltf_accessor *a = &gltf->accessor_data[accessor];
  if (a->components != MATRIX || a->type != OLX_GLTF_FLOAT || a->compressed || a->sparse.count) {
    return olx_gltf_fail(gltf, "skins", skin, "its inverseBindMatrices are not plain matrices of 4 x 4 floats");
  }
  if (a->count >= joints) return OLX_OK;
  return olx_gltf_fail(gltf, "skins", skin, "it has fewer inverseBindMatrices than joints");
}

static olx_result check_skin(const olx_gltf *gltf, uint32_t skin) {
  const cJSON *joints = olx_json_member(gltf->skins.elements[skin], "joints"), *joint = NULL;
  if (!cJSON_IsArray(joints) || !joints->child) return olx_gltf_fail(gltf, "skins", skin, "it has no joints");
  uint64_t count = 0;
  cJSON_ArrayForEach(joint, joints) {
    uint32_t node = 0;
    bool valid;
    if (!olx_json_index(joint, gltf->nodes.count, &node, &valid)) {
      return olx_gltf_fail(gltf, "skins", skin, "a joint does not exist");
    }
    ++count;
  }
  return check_matrices(gltf, skin, count);
}

olx_result olx_gltf_check_skins(const olx_gltf *gltf) {
  for (uint32_t i = 0; i < gltf->skins.count; ++i) OLX_TRY(check_skin(gltf, i));
  return OLX_OK;
}

// ---- Joints

static olx_affine from_columns(const float m[MATRIX]) {
  olx_affine a;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) a.m[row][column] = (double)m[column * 4 + row];
  }
  return a;
}

// Multiplies the joints' transforms by the inverse ones of the mesh's pose, of which there are as many.
static olx_result multiply_matrices(const olx_gltf *gltf, uint32_t accessor, const olx_gltf_skin *skin) {
  float *numbers = olx_allocate(skin->count, MATRIX * sizeof *numbers);
  if (!numbers) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for %u joints", gltf->path, skin->count);
  const olx_result result = olx_gltf_read_first_floats(gltf, accessor, skin->count, MATRIX, numbers);
  for (uint32_t i = 0; result == OLX_OK && i < skin->count; ++i) {
    const olx_affine inverse = from_columns(numbers + (size_t)MATRIX * i);
    skin->joints[i] = olx_affine_multiply(&skin->joints[i], &inverse);
  }
  olx_release(numbers);
  return result;
}

olx_result olx_gltf_read_skin(const olx_gltf *gltf, uint32_t index, const olx_gltf_node_place *nodes,
                              olx_gltf_skin *skin) {
  const cJSON *joints = olx_json_member(gltf->skins.elements[index], "joints"), *joint = NULL;
  const uint32_t count = (uint32_t)cJSON_GetArraySize(joints), accessor = matrices_of(gltf, index);
  *skin = (olx_gltf_skin){.joints = olx_allocate(count, sizeof *skin->joints)};
  if (!skin->joints) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for %u joints", gltf->path, count);
  cJSON_ArrayForEach(joint, joints) {
    const olx_gltf_node_place *node = &nodes[(uint32_t)joint->valuedouble];
    if (!node->reached) return olx_gltf_fail(gltf, "skins", index, "a joint is not in the file's scene");
    skin->joints[skin->count++] = node->transform;
  }
  return accessor == OLX_GLTF_NONE ? OLX_OK : multiply_matrices(gltf, accessor, skin);
}

// ---- Vertices

// Makes the weights of a vertex shares of 1; false where they are none, and the first joint gets all.
static bool share_out(const float weights[BONDS], double shares[BONDS]) {
  double sum = 0.0;
  bool usable = true;
  for (int k = 0; k < BONDS; ++k) {
    usable = usable && weights[k] >= 0.0f && isfinite(weights[k]);
    sum += (double)weights[k];
  }
  usable = usable && sum > 0.0;
  for (int k = 0; k < BONDS; ++k) shares[k] = usable ? (double)weights[k] / sum : k == 0 ? 1.0 : 0.0;
  return usable;
}

// Adds up shares of joints' transforms; false where the skin does not have a joint.
static bool add_joints(const olx_gltf_skin *skin, const float joints[BONDS], const double shares[BONDS],
                       olx_affine *place) {
  *place = (olx_affine){{{0.0}}};
  for (int k = 0; k < BONDS; ++k) {
    if (!(shares[k] > 0.0)) continue;
    if (!(joints[k] >= 0.0f && joints[k] < (float)skin->count)) return false;
    const olx_affine *joint = &skin->joints[(uint32_t)joints[k]];
    for (int i = 0; i < 12; ++i) place->m[i / 4][i % 4] += shares[k] * joint->m[i / 4][i % 4];
  }
  return true;
}

static olx_result pose(const olx_gltf *gltf, const olx_gltf_skin *skin, const olx_gltf_bond *bond, uint32_t vertices,
                       float *joints, olx_affine *places, uint32_t *unweighted) {
  float *weights = joints + (size_t)BONDS * vertices;
  OLX_TRY(olx_gltf_read_floats(gltf, bond->joints, BONDS, joints));
  OLX_TRY(olx_gltf_read_floats(gltf, bond->weights, BONDS, weights));
  for (uint32_t i = 0; i < vertices; ++i) {
    double shares[BONDS];
    *unweighted += !share_out(weights + (size_t)BONDS * i, shares);
    if (add_joints(skin, joints + (size_t)BONDS * i, shares, &places[i])) continue;
    return olx_gltf_fail(gltf, "accessors", bond->joints, "a vertex follows a joint that its skin does not have");
  }
  return OLX_OK;
}

olx_result olx_gltf_pose_vertices(const olx_gltf *gltf, const olx_gltf_skin *skin, const olx_gltf_bond *bond,
                                  uint32_t vertices, olx_affine *places, uint32_t *unweighted) {
  float *numbers = olx_allocate(vertices, 2 * BONDS * sizeof *numbers);
  const olx_result result = numbers
                                ? pose(gltf, skin, bond, vertices, numbers, places, unweighted)
                                : olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for %u vertices", gltf->path, vertices);
  olx_release(numbers);
  return result;
}
