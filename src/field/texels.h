// Reads what a texel of a light field probe stores of the surface that it sees. `texel` is an index into a bordered map
// (olx_map_index, olx_texel_towards), whether the field holds texels or tiles. This header is the only place that
// decodes these chunks. For the sky, only emission is defined. Its twin is shaders/lib/texels.glsl.
#ifndef OLX_FIELD_TEXELS_H
#define OLX_FIELD_TEXELS_H

#include "block/reflectance.h"
#include "core/bsdf.h"
#include "field/maps.h"

// The stored codes of a texel's material.
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

// The parameters of a texel's reflectance: base colour, roughness, and the weights of its lobes.
typedef struct olx_texel_parameters {
  olx_vec3 base_color;
  float roughness, metallic, specular_weight;
} olx_texel_parameters;

// Returns the bytes of a texel's base colour in a field of tiles, red lowest; 0 for the sky.
static inline uint32_t olx_tiled_base(const olx_field *field, uint32_t probe, size_t texel) {
  const olx_texel_block at = olx_tiled_texel(field, OLX_SURFACE_BASE, probe, texel);
  const olx_bc1_block *blocks = field->surfaces.tiled[OLX_SURFACE_BASE].blocks;
  return at.block == OLX_NO_BLOCK ? 0 : olx_bc1_texel(&blocks[at.block], at.texel);
}

// Returns roughness in the low byte and olx_reflectance_pack in the high one, in a field of tiles; 0 for the sky.
static inline uint16_t olx_tiled_specular(const olx_field *field, uint32_t probe, size_t texel) {
  const olx_texel_block at = olx_tiled_texel(field, OLX_SURFACE_SPECULAR, probe, texel);
  const olx_bc5_block *blocks = field->surfaces.tiled[OLX_SURFACE_SPECULAR].blocks;
  return at.block == OLX_NO_BLOCK ? 0 : olx_bc5_texel(&blocks[at.block], at.texel);
}

static inline olx_texel_parameters olx_texel_parameters_of(const olx_field *field, uint32_t probe, size_t texel) {
  const olx_field_surfaces *s = &field->surfaces;
  if (s->base) {
    const size_t at = field->texels * probe + texel;
    const uint32_t base = s->base[at], specular = s->specular[at];
    return (olx_texel_parameters){olx_base_color_unpack(base), olx_byte_unpack_unit(base >> 24),
                                  olx_byte_unpack_unit(specular), olx_byte_unpack_unit(specular >> 8)};
  }
  const uint32_t specular = olx_tiled_specular(field, probe, texel);
  const olx_reflectance r = olx_reflectance_unpack(specular >> 8);
  return (olx_texel_parameters){olx_base_color_unpack(olx_tiled_base(field, probe, texel)),
                                olx_byte_unpack_unit(specular), r.metallic, r.specular_weight};
}

// Returns the reflectance of the texel's surface.
static inline olx_bsdf olx_texel_material(const olx_field *field, uint32_t probe, size_t texel) {
  const olx_texel_parameters p = olx_texel_parameters_of(field, probe, texel);
  return olx_bsdf_make(p.base_color, p.metallic, p.roughness, p.specular_weight);
}

// Reads irradiance from a map of texels, or from tiles where `texels` is NULL.
static inline olx_vec3 olx_texel_irradiance(const olx_field *field, const uint32_t *texels, olx_surface_map map,
                                            uint32_t probe, size_t texel) {
  if (texels) return olx_rgb9e5_unpack(texels[field->texels * probe + texel]);
  const olx_texel_block at = olx_tiled_texel(field, map, probe, texel);
  const olx_bc6h_block *blocks = field->surfaces.tiled[map].blocks;
  return at.block == OLX_NO_BLOCK ? olx_splat(0.0f) : olx_bc6h_texel(&blocks[at.block], at.texel);
}

// Returns the irradiance in W/m^2 that reaches the surface directly from emitters and the sky.
static inline olx_vec3 olx_texel_direct(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_texel_irradiance(field, field->surfaces.direct, OLX_SURFACE_DIRECT, probe, texel);
}

// Returns the irradiance in W/m^2 of light that met at least one surface between emitter and texel.
static inline olx_vec3 olx_texel_indirect(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_texel_irradiance(field, field->surfaces.indirect, OLX_SURFACE_INDIRECT, probe, texel);
}

// Prefetches what the functions above read of one kind of map: a texel, or a block, which takes reading its tile.
static inline void olx_texel_prefetch_map(const olx_field *field, olx_surface_map map, const void *texels,
                                          size_t texel_bytes, uint32_t probe, size_t texel) {
  if (texels) {
    __builtin_prefetch((const char *)texels + texel_bytes * (field->texels * probe + texel));
    return;
  }
  const uint32_t block = (uint32_t)olx_tiled_texel(field, map, probe, texel).block;
  if (block == OLX_NO_BLOCK) return;
  __builtin_prefetch((const char *)field->surfaces.tiled[map].blocks + (size_t)block * olx_surface_block_bytes(map));
}

// Prefetches what the functions above read.
static inline void olx_texel_prefetch(const olx_field *field, uint32_t probe, size_t texel) {
  const olx_field_surfaces *s = &field->surfaces;
  olx_texel_prefetch_map(field, OLX_SURFACE_BASE, s->base, sizeof *s->base, probe, texel);
  olx_texel_prefetch_map(field, OLX_SURFACE_SPECULAR, s->specular, sizeof *s->specular, probe, texel);
  olx_texel_prefetch_map(field, OLX_SURFACE_DIRECT, s->direct, sizeof *s->direct, probe, texel);
  olx_texel_prefetch_map(field, OLX_SURFACE_INDIRECT, s->indirect, sizeof *s->indirect, probe, texel);
}

// Returns the emission stored for a texel, RGB9E5; 0 where nothing emits.
static inline uint32_t olx_texel_emission_code(const olx_field *field, uint32_t probe, size_t texel) {
  const olx_field_surfaces *s = &field->surfaces;
  uint32_t column, row;
  olx_texel_source(field, texel, &column, &row);
  const size_t tile = (size_t)(row / OLX_EMISSION_TILE) * s->tile_side + column / OLX_EMISSION_TILE;
  const uint32_t entry = s->emission[(size_t)s->tile_side * s->tile_side * probe + tile];
  if (entry == 0 || entry > s->tile_count) return 0; // a damaged file may name a tile that does not exist
  const uint32_t inside = row % OLX_EMISSION_TILE * OLX_EMISSION_TILE + column % OLX_EMISSION_TILE;
  return s->tiles[(size_t)(entry - 1) * OLX_EMISSION_TILE_TEXELS + inside];
}

// Returns whether the texel sees an emitter. The sky does not count as one.
static inline bool olx_texel_emits(const olx_field *field, uint32_t probe, size_t texel) {
  if (!field->geometry) return (field->distance[field->texels * probe + texel] & 0x8000u) != 0;
  return olx_texel_emission_code(field, probe, texel) != 0 && !olx_texel_is_sky(field, probe, texel);
}

// Returns the radiance in W/(sr m^2) that an emitter sends towards the probe, or that of the sky; 0 for a surface that
// does not emit.
static inline olx_vec3 olx_texel_emission(const olx_field *field, uint32_t probe, size_t texel) {
  if (!field->geometry && field->distance[field->texels * probe + texel] < 0x7C00u) return olx_splat(0.0f);
  return olx_rgb9e5_unpack(olx_texel_emission_code(field, probe, texel));
}

#endif
