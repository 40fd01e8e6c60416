// Reading the maps of a field. Coordinates are in texels of the map without border.
#ifndef OLX_FIELD_MAPS_H
#define OLX_FIELD_MAPS_H

#include "field/field_data.h"

static inline size_t olx_map_index(uint32_t stride, int32_t x, int32_t y) {
  return (size_t)(y + 1) * stride + (size_t)(x + 1);
}

// The four texels around a point of a bordered map and their bilinear weights.
typedef struct olx_bilinear {
  size_t index[4];
  float weight[4];
} olx_bilinear;

static inline olx_bilinear olx_bilinear_at(olx_vec2 uv, uint32_t n) {
  const float x = uv.x * (float)n - 0.5f, y = uv.y * (float)n - 0.5f;
  const float limit = (float)n - 1.0f;
  const float x0 = olx_clamp(floorf(x), -1.0f, limit), y0 = olx_clamp(floorf(y), -1.0f, limit);
  const float fx = olx_clamp(x - x0, 0.0f, 1.0f), fy = olx_clamp(y - y0, 0.0f, 1.0f);
  const size_t first = olx_map_index(n + 2, (int32_t)x0, (int32_t)y0);
  return (olx_bilinear){
      .index = {first, first + 1, first + n + 2, first + n + 3},
      .weight = {(1.0f - fx) * (1.0f - fy), fx * (1.0f - fy), (1.0f - fx) * fy, fx * fy},
  };
}

// The texel of a light field map that a direction falls into.
static inline size_t olx_texel_towards(const olx_field *field, olx_vec3 direction) {
  const olx_vec2 uv = olx_octahedral_encode(direction);
  const float n = (float)field->n;
  return olx_map_index(field->stride, (int32_t)olx_min(uv.x * n, n - 1.0f), (int32_t)olx_min(uv.y * n, n - 1.0f));
}

// Stored distance of a texel in metres; infinite for the sky.
static inline float olx_texel_distance(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_half_unpack(field->distance[field->texels * probe + texel] & 0x7FFFu) * field->distance_scale;
}

static inline bool olx_texel_emits(const olx_field *field, uint32_t probe, size_t texel) {
  return (field->distance[field->texels * probe + texel] & 0x8000u) != 0;
}

static inline olx_vec3 olx_texel_normal(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_normal_unpack(field->normal[field->texels * probe + texel]);
}

static inline olx_vec3 olx_texel_radiance(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_r11g11b10f_unpack(field->radiance[field->texels * probe + texel]);
}

#endif
