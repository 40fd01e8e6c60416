// Reads the places in which a glTF node puts copies of its mesh (EXT_mesh_gpu_instancing), from accessors that are
// checked before anything is allocated for them.
#include "scene/gltf/gltf_instances.h"

#include "core/hooks.h"
#include "core/result.h"
#include "scene/gltf/gltf_accessor.h"
#include "scene/local_frame.h"

enum { TRANSLATION, ROTATION, SCALE, ATTRIBUTES };

static const char *const names[ATTRIBUTES] = {"TRANSLATION", "ROTATION", "SCALE"};
static const uint32_t components[ATTRIBUTES] = {3, 4, 3};

static const cJSON *attributes_of(const olx_gltf *gltf, uint32_t node) {
  return olx_json_member(olx_gltf_extension(gltf->nodes.elements[node], "EXT_mesh_gpu_instancing"), "attributes");
}

// Returns the accessor of an attribute; OLX_GLTF_NONE without one.
static uint32_t accessor_of(const olx_gltf *gltf, uint32_t node, uint32_t attribute) {
  uint32_t accessor;
  olx_gltf_index(attributes_of(gltf, node), names[attribute], gltf->accessors.count, &accessor);
  return accessor;
}

// ---- Checks

// Returns whether an accessor's numbers are those of an attribute: floats, or for rotations integers that stand for -1
// to 1. Compressed elements belong to primitives alone.
static bool fits(const olx_gltf_accessor *a, uint32_t attribute) {
  const bool whole = a->normalized && (a->type == OLX_GLTF_INT8 || a->type == OLX_GLTF_INT16);
  return a->components == components[attribute] && !a->compressed &&
         (a->type == OLX_GLTF_FLOAT || (attribute == ROTATION && whole));
}

static olx_result check_node(const olx_gltf *gltf, uint32_t node) {
  uint64_t count = 0; // of the first attribute; no accessor is empty, or has more elements than a uint32_t counts
  for (uint32_t i = 0; i < ATTRIBUTES; ++i) {
    uint32_t accessor;
    if (!olx_gltf_index(attributes_of(gltf, node), names[i], gltf->accessors.count, &accessor)) {
      return olx_gltf_fail(gltf, "nodes", node, "an attribute of its instances does not exist");
    }
    if (accessor == OLX_GLTF_NONE) continue;
    const olx_gltf_accessor *a = &gltf->accessor_data[accessor];
    if (!fits(a, i)) return olx_gltf_fail(gltf, "nodes", node, "an attribute of its instances is of another type");
    if (count > 0 && a->count != count) {
      return olx_gltf_fail(gltf, "nodes", node, "the attributes of its instances differ in their count");
    }
    count = a->count;
  }
  return OLX_OK;
}

olx_result olx_gltf_check_instances(const olx_gltf *gltf) {
  for (uint32_t i = 0; i < gltf->nodes.count; ++i) OLX_TRY(check_node(gltf, i));
  return OLX_OK;
}

// ---- Reading

uint32_t olx_gltf_instance_count(const olx_gltf *gltf, uint32_t node) {
  for (uint32_t i = 0; i < ATTRIBUTES; ++i) {
    const uint32_t accessor = accessor_of(gltf, node, i);
    if (accessor != OLX_GLTF_NONE) return (uint32_t)gltf->accessor_data[accessor].count;
  }
  return 1;
}

// Reads an attribute, or repeats what it is without an accessor.
static olx_result read_attribute(const olx_gltf *gltf, uint32_t node, uint32_t attribute, uint32_t count,
                                 float *numbers) {
  const uint32_t accessor = accessor_of(gltf, node, attribute), each = components[attribute];
  if (accessor != OLX_GLTF_NONE) return olx_gltf_read_floats(gltf, accessor, each, numbers);
  for (uint32_t i = 0; i < count * each; ++i) {
    numbers[i] = attribute == SCALE || (attribute == ROTATION && i % each == 3) ? 1.0f : 0.0f;
  }
  return OLX_OK;
}

static olx_affine make_transform(const olx_gltf *gltf, const float t[3], const float q[4], const float s[3]) {
  double translation[3];
  for (int i = 0; i < 3; ++i) translation[i] = olx_scene_length(gltf->scene, (double)t[i]);
  return olx_affine_from_trs(translation, (const double[4]){(double)q[0], (double)q[1], (double)q[2], (double)q[3]},
                             (const double[3]){(double)s[0], (double)s[1], (double)s[2]});
}

olx_result olx_gltf_read_instances(const olx_gltf *gltf, uint32_t node, olx_affine *transforms) {
  const uint32_t count = olx_gltf_instance_count(gltf, node);
  float *numbers[ATTRIBUTES] = {0};
  olx_result result = OLX_OK;
  for (uint32_t i = 0; result == OLX_OK && i < ATTRIBUTES; ++i) {
    numbers[i] = olx_allocate(count, components[i] * sizeof *numbers[i]);
    result = numbers[i] ? read_attribute(gltf, node, i, count, numbers[i])
                        : olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for %u instances", gltf->path, count);
  }
  for (uint32_t i = 0; result == OLX_OK && i < count; ++i) {
    transforms[i] = make_transform(gltf, numbers[TRANSLATION] + (size_t)3 * i, numbers[ROTATION] + (size_t)4 * i,
                                   numbers[SCALE] + (size_t)3 * i);
  }
  for (uint32_t i = 0; i < ATTRIBUTES; ++i) olx_release(numbers[i]);
  return result;
}
