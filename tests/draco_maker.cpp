// Makes Draco streams for tests. Draco's encoder is written in C++.
#include "draco_maker.h"

#include <draco/compression/encode.h>

#include <cstring>

static void add_attribute(draco::Mesh *mesh, draco::GeometryAttribute::Type type, const float *numbers,
                          uint32_t components, uint32_t points) {
  const size_t stride = components * sizeof(float);
  draco::GeometryAttribute description;
  description.Init(type, nullptr, static_cast<int8_t>(components), draco::DT_FLOAT32, false,
                   static_cast<int64_t>(stride), 0);
  draco::PointAttribute *added = mesh->attribute(mesh->AddAttribute(description, true, points));
  for (uint32_t p = 0; p < points; ++p)
    added->SetAttributeValue(draco::AttributeValueIndex(p), numbers + p * components);
}

size_t draco_encode(const draco_mesh *mesh, uint8_t *stream, size_t capacity) {
  draco::Mesh built;
  built.set_num_points(mesh->points);
  add_attribute(&built, draco::GeometryAttribute::POSITION, mesh->positions, 3, mesh->points);
  add_attribute(&built, draco::GeometryAttribute::NORMAL, mesh->normals, 3, mesh->points);
  add_attribute(&built, draco::GeometryAttribute::TEX_COORD, mesh->uvs, 2, mesh->points);
  built.SetNumFaces(mesh->faces);
  for (uint32_t f = 0; f < mesh->faces; ++f) {
    const uint32_t *i = mesh->indices + 3 * f;
    built.SetFace(draco::FaceIndex(f), {{draco::PointIndex(i[0]), draco::PointIndex(i[1]), draco::PointIndex(i[2])}});
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(mesh->sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer encoded;
  if (!encoder.EncodeMeshToBuffer(built, &encoded).ok() || encoded.size() > capacity) return 0;
  std::memcpy(stream, encoded.data(), encoded.size());
  return encoded.size();
}
