// Finds the chunks of surfaces and lights in a field file and checks what they hold.
#include "core/result.h"
#include "field/field_chunks.h"
#include "field/texels.h"

// Finds the chunk of one kind, which holds any number of whole records of its shape.
static olx_result find_records(const olx_field *field, olx_chunk_kind kind, uint64_t most, const void **data,
                               uint32_t *count) {
  const olx_chunk_file file = olx_field_file(field);
  olx_chunk_shape shapes[OLX_CHUNK_KINDS];
  const olx_file_chunk *chunk;
  olx_chunk_shapes(&field->info, shapes);
  OLX_TRY(olx_chunk_find(&file, shapes[kind].type, &chunk));
  const uint64_t records = chunk->size_bytes / shapes[kind].record_bytes;
  if (records > most) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk %s: %llu records are more than %llu", field->name,
                    olx_chunk_type_name(shapes[kind].type).text, (unsigned long long)records, (unsigned long long)most);
  }
  shapes[kind].size_bytes = records * shapes[kind].record_bytes;
  *count = (uint32_t)records;
  return olx_chunk_find_shaped(&file, &shapes[kind], data);
}

static bool is_length(float f) { return fabsf(f) <= OLX_FIELD_MAX_LENGTH; }

static bool is_unit(olx_vec3 v) { return fabsf(olx_dot(v, v) - 1.0f) <= 1e-3f; }

static bool is_zero(olx_vec3 v) { return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f; }

// Conditions are written so that NaN fails.
olx_result olx_field_light_check(const olx_field_light *light, uint32_t index, const char *name, olx_result failure) {
  const char *problem = NULL;
  const bool sun = light->type == OLX_LIGHT_SUN, point = light->type == OLX_LIGHT_POINT;
  const olx_vec3 p = light->position, e = light->emission;
  if (light->type > OLX_LIGHT_SPOT) problem = "unknown type";
  else if (sun ? !is_zero(p) : !(is_length(p.x) && is_length(p.y) && is_length(p.z))) problem = "impossible position";
  else if (point ? !is_zero(light->direction) : !is_unit(light->direction)) problem = "impossible direction";
  else if (!olx_finite(e)) problem = "impossible emission";
  else if (light->type == OLX_LIGHT_SPOT ? !(light->cosine_inner <= 1.0f && light->cosine_outer >= -1.0f &&
                                             light->cosine_outer <= light->cosine_inner)
                                         : light->cosine_inner != 0.0f || light->cosine_outer != 0.0f) {
    problem = "impossible cone";
  }
  for (uint32_t i = 0; i < 4 && !problem; i++) problem = light->zero[i] ? "reserved bytes" : NULL;
  return problem ? olx_fail(failure, "%s: chunk LITE: light %u: %s", name, index, problem) : OLX_OK;
}

olx_result olx_lights_open(olx_field *field) {
  olx_field_surfaces *s = &field->surfaces;
  const void *lights;
  OLX_TRY(find_records(field, OLX_CHUNK_LIGHTS, OLX_FIELD_MOST_LIGHTS, &lights, &s->light_count));
  s->lights = lights;
  for (uint32_t i = 0; i < s->light_count; i++) {
    OLX_TRY(olx_field_light_check(&s->lights[i], i, field->name, OLX_ERROR_FORMAT));
  }
  field->info.scene.light_count = s->light_count;
  return OLX_OK;
}

olx_result olx_emission_tiles_open(olx_field *field) {
  olx_field_surfaces *s = &field->surfaces;
  const void *tiles;
  OLX_TRY(find_records(field, OLX_CHUNK_EMISSION_TILES, UINT32_MAX - 1u, &tiles, &s->tile_count));
  s->tiles = tiles;
  field->info.bytes.emission += (uint64_t)s->tile_count * OLX_EMISSION_TILE_TEXELS * sizeof *s->tiles;
  return OLX_OK;
}

olx_result olx_planes_open(olx_field *field) {
  const void *planes;
  if (!field->geometry) return OLX_OK;
  OLX_TRY(find_records(field, OLX_CHUNK_PLANES, UINT32_MAX - 1u, &planes, &field->planes.count));
  field->planes.planes = planes;
  field->info.bytes.geometry += sizeof(olx_plane_code) * (uint64_t)field->planes.count;
  return OLX_OK;
}

olx_result olx_pools_open(olx_field *field) {
  if (!field->info.maps.compressed) return OLX_OK;
  uint64_t *const bytes[OLX_SURFACE_MAPS] = {&field->info.bytes.material, &field->info.bytes.material,
                                             &field->info.bytes.direct, &field->info.bytes.indirect};
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    olx_tiled_maps *maps = &field->surfaces.tiled[map];
    OLX_TRY(find_records(field, OLX_CHUNK_BASE_POOL + map, OLX_TILE_MOST_BLOCKS, &maps->blocks, &maps->count));
    *bytes[map] += (uint64_t)maps->count * olx_surface_block_bytes(map);
  }
  return OLX_OK;
}

static olx_result fail_at(const olx_field *field, const char *what, uint32_t probe, uint32_t x, uint32_t y,
                          const char *problem) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s of probe %u, texel (%u, %u): %s", field->name, what, probe, x, y, problem);
}

// Checks that a sky texel has neither material nor irradiance.
static olx_result check_sky(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  const olx_field_surfaces *s = &field->surfaces;
  const size_t at = field->texels * probe + olx_map_index(field->stride, (int32_t)x, (int32_t)y);
  if (!olx_texel_is_sky(field, probe, at - field->texels * probe)) return OLX_OK;
  const char *what = s->base[at]       ? "base colour"
                     : s->specular[at] ? "specular"
                     : s->direct[at]   ? "direct light"
                     : s->indirect[at] ? "indirect light"
                                       : NULL;
  return what ? fail_at(field, what, probe, x, y, "not 0, but it sees the sky") : OLX_OK;
}

static bool all_is_sky(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  for (uint32_t i = 0; i < OLX_TILE_TEXELS; i++) {
    const size_t texel =
        olx_map_index(field->stride, (int32_t)(x + i % OLX_TILE_SIDE), (int32_t)(y + i / OLX_TILE_SIDE));
    if (!olx_texel_is_sky(field, probe, texel)) return false;
  }
  return true;
}

// Checks that a tile names blocks that exist, and that light in them has a mode.
static const char *check_tile_word(const olx_tiled_maps *maps, olx_surface_map map, uint32_t word, bool sky) {
  const uint32_t first = olx_tile_first(word), count = olx_tile_blocks(word);
  if (sky) return word ? "a tile of sky that is not 0" : NULL;
  if (count == 0) return "a tile of no form";
  if ((uint64_t)first + count > maps->count) return "a tile of blocks that are not there";
  if (map < OLX_SURFACE_DIRECT) return NULL;
  const olx_bc6h_block *blocks = maps->blocks;
  for (uint32_t i = 0; i < count; i++) {
    if (!olx_bc6h_is_valid(&blocks[first + i])) return "a block of no mode";
  }
  return NULL;
}

// Checks the tiles whose first texel is (x, y).
static olx_result check_tiles(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  static const char *const names[OLX_SURFACE_MAPS] = {"base colour", "reflectance", "direct light", "indirect light"};
  const bool sky = all_is_sky(field, probe, x, y);
  const size_t tile =
      olx_first_tile(field, probe) + (size_t)(y / OLX_TILE_SIDE) * field->surfaces.tile_side + x / OLX_TILE_SIDE;
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    const olx_tiled_maps *maps = &field->surfaces.tiled[map];
    const char *problem = check_tile_word(maps, map, maps->words[tile], sky);
    if (problem) return fail_at(field, names[map], probe, x, y, problem);
  }
  return OLX_OK;
}

// Returns whether a texel may have emission: it is marked as an emitter or sees the sky, or distances have no mark.
static bool may_emit(const olx_field *field, uint32_t probe, uint32_t x, uint32_t y) {
  if (field->geometry) return true;
  return field->distance[field->texels * probe + olx_map_index(field->stride, (int32_t)x, (int32_t)y)] >= 0x7C00u;
}

static olx_result check_emission(const olx_field *field, uint32_t probe, uint32_t tile_x, uint32_t tile_y) {
  const olx_field_surfaces *s = &field->surfaces;
  const uint32_t entry = s->emission[(size_t)s->tile_side * s->tile_side * probe + tile_y * s->tile_side + tile_x];
  if (entry == 0) return OLX_OK;
  if (entry > s->tile_count) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: emission of probe %u, tile (%u, %u): tile %u of %u", field->name, probe,
                    tile_x, tile_y, entry - 1, s->tile_count);
  }
  const uint32_t *texels = s->tiles + (size_t)(entry - 1) * OLX_EMISSION_TILE_TEXELS;
  for (uint32_t i = 0; i < OLX_EMISSION_TILE_TEXELS; i++) {
    const uint32_t x = tile_x * OLX_EMISSION_TILE + i % OLX_EMISSION_TILE,
                   y = tile_y * OLX_EMISSION_TILE + i / OLX_EMISSION_TILE;
    if (texels[i] && !may_emit(field, probe, x, y)) {
      return fail_at(field, "emission", probe, x, y, "not 0, but its distance marks no emitter");
    }
  }
  return OLX_OK;
}

olx_result olx_surface_contents_verify(const olx_field *field, uint32_t probe) {
  const uint32_t step = field->info.maps.compressed ? OLX_TILE_SIDE : 1;
  for (uint32_t y = 0; y < field->n; y += step) {
    for (uint32_t x = 0; x < field->n; x += step) {
      OLX_TRY(field->info.maps.compressed ? check_tiles(field, probe, x, y) : check_sky(field, probe, x, y));
    }
  }
  const uint32_t side = field->surfaces.tile_side;
  for (uint32_t i = 0; i < side * side; i++) OLX_TRY(check_emission(field, probe, i % side, i / side));
  return OLX_OK;
}

void olx_surface_row(const olx_field *field, olx_surface_map map, uint32_t probe, uint32_t row, void *texels) {
  uint16_t *halves = texels;
  uint32_t *words = texels;
  for (uint32_t x = 0; x < field->stride; x++) {
    const size_t texel = (size_t)field->stride * row + x;
    if (map == OLX_SURFACE_BASE) words[x] = olx_tiled_base(field, probe, texel);
    if (map == OLX_SURFACE_SPECULAR) halves[x] = olx_tiled_specular(field, probe, texel);
    if (map == OLX_SURFACE_DIRECT) words[x] = olx_rgb9e5_pack(olx_texel_direct(field, probe, texel));
    if (map == OLX_SURFACE_INDIRECT) words[x] = olx_rgb9e5_pack(olx_texel_indirect(field, probe, texel));
  }
}

void olx_pool_row(const olx_field *field, olx_surface_map map, uint32_t first, uint32_t count, uint32_t row,
                  void *texels) {
  const olx_tiled_maps *maps = &field->surfaces.tiled[map];
  const olx_bc1_block *base = maps->blocks;
  const olx_bc5_block *specular = maps->blocks;
  const olx_bc6h_block *light = maps->blocks;
  uint16_t *halves = texels;
  uint32_t *words = texels;
  for (uint32_t x = 0; x < OLX_BLOCK_SIDE * count; x++) {
    const uint32_t block = first + x / OLX_BLOCK_SIDE, texel = row * OLX_BLOCK_SIDE + x % OLX_BLOCK_SIDE;
    if (map == OLX_SURFACE_BASE) words[x] = olx_bc1_texel(&base[block], texel);
    else if (map == OLX_SURFACE_SPECULAR) halves[x] = olx_bc5_texel(&specular[block], texel);
    else words[x] = olx_rgb9e5_pack(olx_bc6h_texel(&light[block], texel));
  }
}
