// Reads the maps of a field. Coordinates are in texels of the map without border. Its twin is shaders/lib/maps.glsl.
#ifndef OLX_FIELD_MAPS_H
#define OLX_FIELD_MAPS_H

#include "field/bilinear.h"
#include "field/field_data.h"

// Returns the texel of a light field map into which a direction falls.
static inline size_t olx_texel_towards(const olx_field *field, olx_vec3 direction) {
  const olx_vec2 uv = olx_octahedral_encode(direction);
  const float n = (float)field->n;
  return olx_map_index(field->stride, (int32_t)olx_min(uv.x * n, n - 1.0f), (int32_t)olx_min(uv.y * n, n - 1.0f));
}

// Finds the texel (x, y) inside the map of which a texel, perhaps of the border, is a copy.
static inline void olx_texel_source(const olx_field *field, size_t texel, uint32_t *x, uint32_t *y) {
  const uint32_t at = (uint32_t)texel, stride = field->stride;
  int32_t source_x, source_y;
  olx_border_source((int32_t)(at % stride) - 1, (int32_t)(at / stride) - 1, (int32_t)field->n, &source_x, &source_y);
  *x = (uint32_t)source_x;
  *y = (uint32_t)source_y;
}

// The place of a texel in blocks: those of a map, or of a pool.
typedef struct olx_texel_block {
  size_t block;
  uint32_t texel; // in the block, row by row
} olx_texel_block;

// Returns the place of texel (x, y), not of the border, in a field's maps of geometry blocks.
static inline olx_texel_block olx_block_at(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  const uint32_t side = field->n / OLX_BLOCK_SIDE;
  return (olx_texel_block){((size_t)side * probe + y / OLX_BLOCK_SIDE) * side + x / OLX_BLOCK_SIDE,
                           y % OLX_BLOCK_SIDE * OLX_BLOCK_SIDE + x % OLX_BLOCK_SIDE};
}

#define OLX_NO_BLOCK UINT32_MAX // no place in a pool

// Returns the place of texel (x, y) of a map in the pool of its tile; OLX_NO_BLOCK for the sky, and where a damaged
// file names blocks that do not exist. `count` is that of the pool.
static inline olx_texel_block olx_tile_texel(uint32_t word, uint32_t count, uint32_t x, uint32_t y) {
  const uint32_t form = word >> OLX_TILE_FORM_SHIFT;
  uint32_t block = olx_tile_first(word), texel = y / 2 % 4 * 4 + x / 2 % 4;
  if (form != OLX_TILE_HALF) {
    block += y / 4 % 2 * 2 + x / 4 % 2;
    texel = y % 4 * 4 + x % 4;
  }
  return (olx_texel_block){form == 0 || block >= count ? OLX_NO_BLOCK : block, texel};
}

// Returns the place of a field's first tile of a probe among the words of each kind of map.
static inline size_t olx_first_tile(const olx_field *field, uint32_t probe) {
  return (size_t)field->surfaces.tile_side * field->surfaces.tile_side * probe;
}

// Returns the place of a texel, perhaps of the border, in the pool of a kind of map.
static inline olx_texel_block olx_tiled_texel(const olx_field *field, olx_surface_map map, uint32_t probe,
                                              size_t texel) {
  const olx_tiled_maps *maps = &field->surfaces.tiled[map];
  uint32_t x, y;
  olx_texel_source(field, texel, &x, &y);
  const size_t tile = (size_t)(y / OLX_TILE_SIDE) * field->surfaces.tile_side + x / OLX_TILE_SIDE;
  return olx_tile_texel(maps->words[olx_first_tile(field, probe) + tile], maps->count, x, y);
}

// Returns the plane that texel (x, y) of a field of geometry blocks sees over its whole extent; 0 for the sky.
static inline olx_vec3 olx_block_plane(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  const olx_texel_block at = olx_block_at(field, probe, x, y);
  const olx_block_place place = {field->n, x / OLX_BLOCK_SIDE, y / OLX_BLOCK_SIDE};
  return olx_geometry_plane(&field->geometry[at.block], &field->planes, place, at.texel);
}

// What a texel sees in its direction.
typedef struct olx_texel_geometry {
  float distance;  // metres; infinite for the sky
  olx_vec3 normal; // of the surface, on the probe's side; undefined for the sky
} olx_texel_geometry;

static inline olx_texel_geometry olx_block_geometry(const olx_field *field, uint32_t probe, size_t texel) {
  uint32_t x, y;
  olx_texel_source(field, texel, &x, &y);
  const olx_vec3 plane = olx_block_plane(field, probe, x, y);
  return (olx_texel_geometry){olx_plane_distance(plane, olx_texel_direction(x, y, field->n)), olx_plane_normal(plane)};
}

// Returns the distance of a texel's surface in metres; infinite for the sky.
static inline float olx_texel_distance(const olx_field *field, uint32_t probe, size_t texel) {
  if (field->geometry) return olx_block_geometry(field, probe, texel).distance;
  return olx_half_unpack(field->distance[field->texels * probe + texel] & 0x7FFFu) * field->distance_scale;
}

static inline olx_vec3 olx_texel_normal(const olx_field *field, uint32_t probe, size_t texel) {
  if (field->geometry) return olx_block_geometry(field, probe, texel).normal;
  return olx_normal_unpack(field->normal[field->texels * probe + texel]);
}

// Decodes the distance and the normal of a texel together.
static inline olx_texel_geometry olx_texel_geometry_of(const olx_field *field, uint32_t probe, size_t texel) {
  if (field->geometry) return olx_block_geometry(field, probe, texel);
  return (olx_texel_geometry){olx_texel_distance(field, probe, texel), olx_texel_normal(field, probe, texel)};
}

static inline bool olx_texel_is_sky(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_texel_distance(field, probe, texel) == INFINITY;
}

static inline olx_vec3 olx_texel_radiance(const olx_field *field, uint32_t probe, size_t texel) {
  return olx_r11g11b10f_unpack(field->radiance[field->texels * probe + texel]);
}

#endif
