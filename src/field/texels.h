// Reads what a texel of a light field probe holds of the surface that it sees. `texel` is an index into a bordered map
// (olx_map_index, olx_texel_towards). This header is the only place that decodes these chunks.
#ifndef OLX_FIELD_TEXELS_H
#define OLX_FIELD_TEXELS_H

#include "core/bsdf.h"
#include "field/maps.h"

// What a texel's material is made of.
typedef struct olx_texel_material_codes {
  uint32_t base;
  uint16_t specular;
} olx_texel_material_codes;

static inline float olx_byte_pack_unit(float share) { return rintf(olx_clamp(share, 0.0f, 1.0f) * 255.0f); }

static inline olx_texel_material_codes olx_material_pack(olx_vec3 base_color, float roughness, float metallic,
                                                         float specular_weight) {
  const olx_vec3 c = olx_max_each(base_color, olx_splat(0.0f));
  return (olx_texel_material_codes){
      .base = (uint32_t)olx_byte_pack_unit(sqrtf(c.x)) | (uint32_t)olx_byte_pack_unit(sqrtf(c.y)) << 8 |
              (uint32_t)olx_byte_pack_unit(sqrtf(c.z)) << 16 | (uint32_t)olx_byte_pack_unit(roughness) << 24,
      .specular =
          (uint16_t)((uint32_t)olx_byte_pack_unit(metallic) | (uint32_t)olx_byte_pack_unit(specular_weight) << 8),
  };
}

static inline float olx_byte_unpack_unit(uint32_t code) { return (float)(code & 0xFFu) * (1.0f / 255.0f); }

static inline olx_vec3 olx_base_color_unpack(uint32_t base) {
  return olx_v3(olx_square(olx_byte_unpack_unit(base)), olx_square(olx_byte_unpack_unit(base >> 8)),
                olx_square(olx_byte_unpack_unit(base >> 16)));
}

static inline olx_bsdf olx_material_unpack(olx_texel_material_codes codes) {
  return olx_bsdf_make(olx_base_color_unpack(codes.base), olx_byte_unpack_unit(codes.specular),
                       olx_byte_unpack_unit(codes.base >> 24), olx_byte_unpack_unit((uint32_t)codes.specular >> 8));
}

// How the surface reflects; that of the sky reflects nothing through its diffuse lobe.
static inline olx_bsdf olx_texel_material(const olx_field *field, uint32_t probe, size_t texel) {
  const size_t at = field->texels * probe + texel;
  return olx_material_unpack((olx_texel_material_codes){field->surfaces.base[at], field->surfaces.specular[at]});
}

// Irradiance in W/m^2 that reaches the surface straight from emitters and the sky; 0 for the sky.
static inline olx_vec3 olx_texel_direct(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_rgb9e5_unpack(field->surfaces.direct[field->texels * probe + texel]);
}

// Irradiance in W/m^2 of light that has at least one surface between emitter and texel; 0 for the sky.
static inline olx_vec3 olx_texel_indirect(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_rgb9e5_unpack(field->surfaces.indirect[field->texels * probe + texel]);
}

// Radiance in W/(sr m^2) that an emitter sends towards the probe, or that of the sky; 0 for a surface that does not emit.
static inline olx_vec3 olx_texel_emission(const olx_field *field, uint32_t probe, size_t texel) {
  const uint32_t distance = field->distance[field->texels * probe + texel];
  if (distance < 0x7C00u) return olx_splat(0.0f);
  const olx_field_surfaces *s = &field->surfaces;
  int32_t x, y;
  olx_border_source((int32_t)(texel % field->stride) - 1, (int32_t)(texel / field->stride) - 1, (int32_t)field->n, &x,
                    &y);
  const uint32_t column = (uint32_t)x, row = (uint32_t)y;
  const size_t tile = (size_t)(row / OLX_EMISSION_TILE) * s->tile_side + column / OLX_EMISSION_TILE;
  const uint32_t entry = s->emission[(size_t)s->tile_side * s->tile_side * probe + tile];
  if (entry == 0 || entry > s->tile_count) return olx_splat(0.0f); // a damaged file may name what there is not
  const uint32_t inside = row % OLX_EMISSION_TILE * OLX_EMISSION_TILE + column % OLX_EMISSION_TILE;
  return olx_rgb9e5_unpack(s->tiles[(size_t)(entry - 1) * OLX_EMISSION_TILE_TEXELS + inside]);
}

#endif
