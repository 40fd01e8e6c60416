// Decodes Draco meshes with Debian's libdraco, which throws no exceptions but those of memory; none leaves this file.
#include "scene/gltf/draco_mesh.h"

#include <draco/compression/decode.h>

#include <limits>
#include <memory>
#include <utility>

struct olx_draco_mesh {
  std::unique_ptr<draco::Mesh> mesh;
};

olx_draco_mesh *olx_draco_decode(const uint8_t *data, size_t size_bytes) try {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char *>(data), size_bytes);
  draco::Decoder decoder;
  draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return nullptr;
  return new olx_draco_mesh{std::move(decoded).value()};
} catch (...) {
  return nullptr;
}

void olx_draco_release(olx_draco_mesh *mesh) { delete mesh; }

uint32_t olx_draco_points(const olx_draco_mesh *mesh) { return mesh->mesh->num_points(); }

uint32_t olx_draco_faces(const olx_draco_mesh *mesh) { return mesh->mesh->num_faces(); }

template <typename Number>
static bool read_numbers(const draco::PointAttribute &attribute, uint32_t points, uint32_t components, void *elements) {
  Number *numbers = static_cast<Number *>(elements);
  for (uint32_t p = 0; p < points; ++p, numbers += components) {
    const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(p));
    if (value.value() >= attribute.size()) return false;
    if (!attribute.ConvertValue<Number>(value, static_cast<int8_t>(components), numbers)) return false;
  }
  return true;
}

bool olx_draco_read_attribute(const olx_draco_mesh *mesh, uint32_t unique_id, int component_type, uint32_t components,
                              void *elements) {
  const draco::PointAttribute *attribute = mesh->mesh->GetAttributeByUniqueId(unique_id);
  if (!attribute || attribute->data_type() == draco::DT_BOOL) return false; // glTF has no booleans
  const uint32_t points = olx_draco_points(mesh);
  switch (component_type) {
  case 5120: return read_numbers<int8_t>(*attribute, points, components, elements);
  case 5121: return read_numbers<uint8_t>(*attribute, points, components, elements);
  case 5122: return read_numbers<int16_t>(*attribute, points, components, elements);
  case 5123: return read_numbers<uint16_t>(*attribute, points, components, elements);
  case 5125: return read_numbers<uint32_t>(*attribute, points, components, elements);
  case 5126: return read_numbers<float>(*attribute, points, components, elements);
  default: return false;
  }
}

template <typename Number> static bool read_points(const draco::Mesh &mesh, void *points) {
  Number *numbers = static_cast<Number *>(points);
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex &point : mesh.face(draco::FaceIndex(f))) {
      if (point.value() > std::numeric_limits<Number>::max()) return false;
      *numbers++ = static_cast<Number>(point.value());
    }
  }
  return true;
}

bool olx_draco_read_faces(const olx_draco_mesh *mesh, int component_type, void *points) {
  switch (component_type) {
  case 5121: return read_points<uint8_t>(*mesh->mesh, points);
  case 5123: return read_points<uint16_t>(*mesh->mesh, points);
  case 5125: return read_points<uint32_t>(*mesh->mesh, points);
  default: return false;
  }
}
