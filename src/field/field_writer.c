// Writes a field file piece by piece in the order of its probes: adds borders and pyramids to maps, stores repeated
// tiles of emission once, and commits the file when it is complete.
#include "field/field_writer.h"

#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "field/field_chunks.h"

#include <assert.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

// Data whose size and offset are known only at the end.
typedef struct growing_chunk {
  olx_spool data;
  uint32_t count; // of elements
} growing_chunk;

enum { COPY_BYTES = 1 << 16 }; // of such data, copied at a time

struct olx_field_writer {
  olx_output_file file;
  olx_field_info info;
  olx_field_layout layout;
  XXH3_state_t hashes[OLX_CHUNK_KINDS]; // of what has been written to each chunk
  uint32_t probes_written, surfaces_written, irradiance_written, classic_written;
  bool failed, volume_written, relight_written;

  olx_vec3 *probe_positions, *irradiance_positions;
  uint8_t *probe_flags, *irradiance_flags;
  void *map;                                           // a map with its border
  uint16_t *least, *greatest;                          // a pyramid
  uint16_t *block_least, *block_greatest;              // the bounds of blocks from which the pyramid is built
  olx_geometry_block *blocks;                          // of one map, as the file stores them
  growing_chunk planes, pools[OLX_SURFACE_MAPS];       // of all probes so far
  uint32_t *tile_index;                                // of one map of emission, or of tiles of surfaces
  uint32_t tile[OLX_EMISSION_TILE_TEXELS], tile_count; // the tile of emission written last, and the number of tiles
};

static void set_bytes(olx_field_layout *layout, olx_chunk_kind kind, size_t size_bytes) {
  layout->shapes[kind].size_bytes = layout->shapes[kind].record_bytes = size_bytes;
}

static void find_present(const olx_field_header *header, olx_field_layout *layout) {
  const olx_field_info *info = &header->info;
  const bool has[OLX_FIELD_PARTS] = {[OLX_PART_CLASSIC] = info->classic.size > 0,
                                     [OLX_PART_VOLUME] = header->volume_bytes > 0,
                                     [OLX_PART_RELIGHT] = header->relight,
                                     [OLX_PART_ORIGIN] = olx_origin_is_stored(header->origin)};
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    layout->present[k] = olx_chunk_is_required(info, k) || has[olx_chunk_kinds[k].part];
  }
  for (olx_select select = OLX_SELECT_VORONOI; select < OLX_SELECT_STORED; select++) {
    layout->present[olx_select_chunk(select)] = (info->select_mask & 1u << select) != 0;
    set_bytes(layout, olx_select_chunk(select), header->select_bytes[select]);
  }
  set_bytes(layout, OLX_CHUNK_VOLUME, header->volume_bytes);
  layout->shapes[OLX_CHUNK_LIGHTS].size_bytes = header->light_count * sizeof(olx_field_light);
}

void olx_field_lay_out(const olx_field_header *header, olx_field_layout *layout) {
  *layout = (olx_field_layout){0};
  olx_chunk_shapes(&header->info, layout->shapes);
  find_present(header, layout);
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) layout->chunk_count += layout->present[k];
  const bool on_device = header->info.irradiance.form == OLX_IRRADIANCE_OCTAHEDRAL;
  uint64_t end = sizeof(olx_file_header) + layout->chunk_count * sizeof(olx_file_chunk);
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    if (!layout->present[k]) continue;
    layout->offsets[k] = end;
    end = olx_align_chunk(end + layout->shapes[k].size_bytes);
    if (on_device && olx_chunk_is_on_device(k)) layout->device_bytes += layout->shapes[k].size_bytes;
  }
  layout->file_bytes = end;
}

static olx_result allocate_buffers(olx_field_writer *writer, const olx_field_header *header, const char *path) {
  const olx_field_info *info = &writer->info;
  const olx_chunk_shape *shapes = writer->layout.shapes;
  const uint64_t radiance = shapes[OLX_CHUNK_RADIANCE].record_bytes,
                 irradiance = shapes[OLX_CHUNK_MOMENTS].record_bytes;
  const uint64_t classic = writer->info.classic.size ? shapes[OLX_CHUNK_CLASSIC_IRRADIANCE].record_bytes : 0;
  const uint64_t most = radiance > irradiance ? radiance : irradiance;
  writer->map = olx_allocate(most > classic ? most : classic, 1);
  writer->least = olx_allocate(shapes[OLX_CHUNK_LEAST].record_bytes, 1);
  writer->greatest = olx_allocate(shapes[OLX_CHUNK_GREATEST].record_bytes, 1);
  writer->tile_index = olx_allocate(shapes[OLX_CHUNK_EMISSION].record_bytes, 1);
  const size_t side = info->maps.size / OLX_BLOCK_SIDE, blocks = info->maps.geometry_blocks ? side * side : 1;
  writer->block_least = olx_allocate(blocks, sizeof *writer->block_least);
  writer->block_greatest = olx_allocate(blocks, sizeof *writer->block_greatest);
  writer->blocks = olx_allocate(blocks, sizeof *writer->blocks);
  writer->probe_flags = olx_allocate(info->probes.count, 1);
  writer->irradiance_flags = olx_allocate(info->irradiance.probe_count, 1);
  writer->probe_positions = olx_allocate(info->probes.count, sizeof(olx_vec3));
  writer->irradiance_positions = olx_allocate(info->irradiance.probe_count, sizeof(olx_vec3));
  if (!writer->map || !writer->least || !writer->greatest || !writer->tile_index || !writer->probe_flags ||
      !writer->irradiance_flags || !writer->probe_positions || !writer->irradiance_positions || !writer->block_least ||
      !writer->block_greatest || !writer->blocks) {
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  }
  memcpy(writer->probe_positions, header->probe_positions, shapes[OLX_CHUNK_PROBE_POSITIONS].size_bytes);
  if (info->irradiance.probe_count) {
    memcpy(writer->irradiance_positions, header->irradiance_positions,
           shapes[OLX_CHUNK_IRRADIANCE_POSITIONS].size_bytes);
  }
  return OLX_OK;
}

static void destroy(olx_field_writer *writer) {
  olx_release(writer->map);
  olx_release(writer->least);
  olx_release(writer->greatest);
  olx_release(writer->tile_index);
  olx_release(writer->block_least);
  olx_release(writer->block_greatest);
  olx_release(writer->blocks);
  olx_spool_discard(&writer->planes.data);
  for (uint32_t i = 0; i < OLX_SURFACE_MAPS; i++) olx_spool_discard(&writer->pools[i].data);
  olx_release(writer->probe_flags);
  olx_release(writer->irradiance_flags);
  olx_release(writer->probe_positions);
  olx_release(writer->irradiance_positions);
  olx_release(writer);
}

static olx_result put_whole(olx_field_writer *writer, olx_chunk_kind kind, const void *data) {
  XXH3_64bits_update(&writer->hashes[kind], data, writer->layout.shapes[kind].size_bytes);
  return olx_output_write_at(&writer->file, writer->layout.offsets[kind], data, writer->layout.shapes[kind].size_bytes);
}

static olx_result put_selectors(olx_field_writer *writer, const olx_field_header *header) {
  for (olx_select select = OLX_SELECT_VORONOI; select < OLX_SELECT_STORED; select++) {
    const olx_chunk_kind kind = olx_select_chunk(select);
    if (writer->layout.present[kind]) OLX_TRY(put_whole(writer, kind, header->select_data[select]));
  }
  return OLX_OK;
}

static olx_result check_lights(const olx_field_header *header, const char *path) {
  if (header->light_count > OLX_FIELD_MOST_LIGHTS) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: %u lights are more than %d", path, header->light_count,
                    OLX_FIELD_MOST_LIGHTS);
  }
  for (uint32_t i = 0; i < header->light_count; i++) {
    OLX_TRY(olx_field_light_check(&header->lights[i], i, path, OLX_ERROR_ARGUMENT));
  }
  return OLX_OK;
}

static olx_result put_classic_header(olx_field_writer *writer, const olx_field_header *header) {
  if (!writer->layout.present[OLX_CHUNK_CLASSIC]) return OLX_OK;
  olx_classic_header classic = {.size = header->info.classic.size,
                                .cube_size = header->info.classic.cube_size,
                                .levels = OLX_CLASSIC_LEVELS,
                                .table_side = OLX_CLASSIC_TABLE_SIDE,
                                .sharpness = header->info.classic.sharpness};
  memcpy(classic.table, header->classic_table, sizeof classic.table);
  return put_whole(writer, OLX_CHUNK_CLASSIC, &classic);
}

// Checks the structure of the volume as readers do, and what it says of the probes.
static olx_result check_volume(const olx_field_header *header, const char *path) {
  olx_volume volume;
  if (header->volume_bytes == 0) return OLX_OK;
  OLX_TRY(olx_volume_open(header->volume, header->volume_bytes, path, &volume));
  if (volume.header->probes != header->info.volume.probe_count) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: a volume of %u probes, not %u", path, volume.header->probes,
                    header->info.volume.probe_count);
  }
  return olx_positions_check(header->volume_positions, volume.header->probes, NULL, "volume", path, OLX_ERROR_ARGUMENT);
}

static olx_result put_volume(olx_field_writer *writer, const olx_field_header *header) {
  if (!writer->layout.present[OLX_CHUNK_VOLUME]) return OLX_OK;
  OLX_TRY(put_whole(writer, OLX_CHUNK_VOLUME, header->volume));
  return put_whole(writer, OLX_CHUNK_VOLUME_POSITIONS, header->volume_positions);
}

olx_result olx_field_writer_create(const char *path, const olx_field_header *header, olx_field_writer **created) {
  assert(path && header && created);
  *created = NULL;
  olx_field_info info = header->info;
  info.probes.buried = info.irradiance.buried = 0;
  OLX_TRY(olx_field_info_check(&info, path, OLX_ERROR_ARGUMENT));
  OLX_TRY(check_lights(header, path));
  OLX_TRY(check_volume(header, path));
  if (info.classic.size) OLX_TRY(olx_classic_info_check(&info, path, OLX_ERROR_ARGUMENT));
  OLX_TRY(olx_positions_check(header->probe_positions, info.probes.count,
                              info.probes.has_grid ? &info.probes.grid : NULL, "light field", path,
                              OLX_ERROR_ARGUMENT));
  OLX_TRY(olx_positions_check(header->irradiance_positions, info.irradiance.probe_count, &info.irradiance.grid,
                              "irradiance", path, OLX_ERROR_ARGUMENT));
  olx_field_writer *writer = olx_allocate_zero(1, sizeof *writer);
  if (!writer) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  writer->info = info;
  olx_field_lay_out(header, &writer->layout);
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) XXH3_64bits_reset(&writer->hashes[k]);
  olx_result result;
  OLX_TRY_GOTO(allocate_buffers(writer, header, path), failed);
  OLX_TRY_GOTO(olx_output_open(path, &writer->file), failed);
  OLX_TRY_GOTO(olx_output_reserve(&writer->file, writer->layout.file_bytes), opened);
  OLX_TRY_GOTO(put_selectors(writer, header), opened);
  OLX_TRY_GOTO(put_whole(writer, OLX_CHUNK_LIGHTS, header->lights), opened);
  OLX_TRY_GOTO(put_classic_header(writer, header), opened);
  OLX_TRY_GOTO(put_volume(writer, header), opened);
  if (writer->layout.present[OLX_CHUNK_ORIGIN])
    OLX_TRY_GOTO(put_whole(writer, OLX_CHUNK_ORIGIN, header->origin), opened);
  *created = writer;
  return OLX_OK;

opened:
  olx_output_discard(&writer->file);
failed:
  destroy(writer);
  return result;
}

// Writes the next record of a chunk.
static olx_result put(olx_field_writer *writer, olx_chunk_kind kind, uint32_t index, const void *data) {
  const uint64_t size_bytes = writer->layout.shapes[kind].record_bytes;
  XXH3_64bits_update(&writer->hashes[kind], data, size_bytes);
  return olx_output_write_at(&writer->file, writer->layout.offsets[kind] + index * size_bytes, data, size_bytes);
}

// Adds a border to a map of n x n texels.
static const void *add_border(olx_field_writer *writer, const void *source, uint32_t n, size_t texel_bytes) {
  const char *map = source;
  char *bordered = writer->map;
  const int32_t size = (int32_t)n;
  const size_t stride = n + 2;
  for (int32_t y = -1; y <= size; y++) {
    char *row = bordered + (size_t)(y + 1) * stride * texel_bytes;
    const bool inside = y >= 0 && y < size;
    if (inside) memcpy(row + texel_bytes, map + (size_t)y * n * texel_bytes, n * texel_bytes);
    for (int32_t x = -1; x <= size; x += inside ? size + 1 : 1) {
      int32_t source_x, source_y;
      olx_border_source(x, y, size, &source_x, &source_y);
      memcpy(row + (size_t)(x + 1) * texel_bytes, map + ((size_t)source_y * n + (size_t)source_x) * texel_bytes,
             texel_bytes);
    }
  }
  return bordered;
}

static olx_result put_map(olx_field_writer *writer, olx_chunk_kind kind, uint32_t index, const void *map, uint32_t n) {
  return put(writer, kind, index, add_border(writer, map, n, writer->layout.shapes[kind].element_bytes));
}

static olx_result refuse_order(const olx_field_writer *writer, const char *kind, uint32_t index, uint32_t next) {
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: %s probe %u written where %u comes next", writer->file.path, kind, index,
                  next);
}

static olx_result put_pyramid(olx_field_writer *writer, uint32_t index, const olx_pyramid_base *base) {
  const olx_pyramid_shape pyramid = olx_pyramid_shape_of(writer->info.maps.size, writer->info.maps.geometry_blocks);
  olx_pyramid_make(&pyramid, base, writer->least, writer->greatest);
  OLX_TRY(put(writer, OLX_CHUNK_LEAST, index, writer->least));
  return put(writer, OLX_CHUNK_GREATEST, index, writer->greatest);
}

static olx_result put_texels(olx_field_writer *writer, uint32_t index, const uint16_t *normal,
                             const uint16_t *distance) {
  const uint32_t n = writer->info.maps.size;
  OLX_TRY(put_map(writer, OLX_CHUNK_NORMAL, index, normal, n));
  OLX_TRY(put_map(writer, OLX_CHUNK_DISTANCE, index, distance, n));
  const olx_pyramid_base base = olx_pyramid_over_texels(distance, n);
  return put_pyramid(writer, index, &base);
}

// Appends elements to a chunk. Their number stays below OLX_NO_PLANE.
static olx_result append(olx_field_writer *writer, growing_chunk *chunk, const void *data, uint32_t added,
                         size_t size) {
  const uint64_t count = (uint64_t)chunk->count + added;
  if (count >= OLX_NO_PLANE) return olx_fail(OLX_ERROR_ARGUMENT, "%s: too many planes", writer->file.path);
  if (added) OLX_TRY(olx_spool_append(&chunk->data, &writer->file, data, added * size));
  chunk->count = (uint32_t)count;
  return OLX_OK;
}

// Writes the blocks of a map with plane numbers that count from the start of the file's pool instead of the map's.
static olx_result put_blocks(olx_field_writer *writer, uint32_t index, const olx_geometry_map *geometry) {
  const uint32_t n = writer->info.maps.size, side = n / OLX_BLOCK_SIDE;
  for (uint32_t i = 0; i < side * side; i++) {
    writer->blocks[i] = geometry->blocks[i];
    if (writer->blocks[i].words[3] >> 30 == OLX_GEOMETRY_POOL) writer->blocks[i].words[0] += writer->planes.count;
  }
  OLX_TRY(put(writer, OLX_CHUNK_DISTANCE, index, writer->blocks));
  const olx_plane_pool *pool = &geometry->pool;
  OLX_TRY(append(writer, &writer->planes, pool->planes, pool->count, sizeof *pool->planes));
  const olx_pyramid_base base = olx_pyramid_over_blocks(geometry, n, writer->info.maps.distance_scale_metres,
                                                        writer->block_least, writer->block_greatest);
  return put_pyramid(writer, index, &base);
}

static olx_result check_next_probe(const olx_field_writer *writer, uint32_t index, bool radiance, bool blocks) {
  if (index != writer->probes_written || index >= writer->info.probes.count) {
    return refuse_order(writer, "light field", index, writer->probes_written);
  }
  if (radiance != writer->layout.present[OLX_CHUNK_RADIANCE]) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: light field probe %u: radiance goes with irradiance probes",
                    writer->file.path, index);
  }
  if (blocks == writer->info.maps.geometry_blocks) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT, "%s: light field probe %u: geometry in another form than the header says",
                  writer->file.path, index);
}

static olx_result write_radiance(olx_field_writer *writer, uint32_t index, const uint32_t *radiance) {
  return radiance ? put_map(writer, OLX_CHUNK_RADIANCE, index, radiance, writer->info.maps.size) : OLX_OK;
}

static olx_result end_probe(olx_field_writer *writer, uint32_t index, uint8_t flags, olx_result result) {
  writer->failed |= result != OLX_OK;
  writer->probe_flags[index] = flags;
  writer->info.probes.buried += flags & OLX_PROBE_BURIED;
  writer->probes_written++;
  return result;
}

olx_result olx_field_writer_probe(olx_field_writer *writer, uint32_t index, uint8_t flags, const uint32_t *radiance,
                                  const uint16_t *normal, const uint16_t *distance) {
  OLX_TRY(check_next_probe(writer, index, radiance != NULL, false));
  olx_result result = write_radiance(writer, index, radiance);
  if (result == OLX_OK) result = put_texels(writer, index, normal, distance);
  return end_probe(writer, index, flags, result);
}

olx_result olx_field_writer_probe_blocks(olx_field_writer *writer, uint32_t index, uint8_t flags,
                                         const uint32_t *radiance, const olx_geometry_map *geometry) {
  OLX_TRY(check_next_probe(writer, index, radiance != NULL, true));
  olx_result result = write_radiance(writer, index, radiance);
  if (result == OLX_OK) result = put_blocks(writer, index, geometry);
  return end_probe(writer, index, flags, result);
}

// Appends a tile to the file unless it equals the previously written one, so that the tiles of an even sky are stored
// once.
static olx_result put_tile(olx_field_writer *writer, const uint32_t tile[OLX_EMISSION_TILE_TEXELS], uint32_t *entry) {
  static const uint32_t dark[OLX_EMISSION_TILE_TEXELS] = {0};
  *entry = 0;
  if (memcmp(tile, dark, sizeof dark) == 0) return OLX_OK;
  if (writer->tile_count == 0 || memcmp(tile, writer->tile, sizeof writer->tile) != 0) {
    if (writer->tile_count == UINT32_MAX - 1u) {
      return olx_fail(OLX_ERROR_ARGUMENT, "%s: too many tiles of emission", writer->file.path);
    }
    memcpy(writer->tile, tile, sizeof writer->tile);
    OLX_TRY(put(writer, OLX_CHUNK_EMISSION_TILES, writer->tile_count++, tile));
  }
  *entry = writer->tile_count;
  return OLX_OK;
}

static olx_result put_emission(olx_field_writer *writer, uint32_t index, const uint32_t *emission) {
  const uint32_t n = writer->info.maps.size, side = n / OLX_EMISSION_TILE;
  for (uint32_t i = 0; i < side * side; i++) {
    uint32_t tile[OLX_EMISSION_TILE_TEXELS];
    const uint32_t *corner = emission + (size_t)(i / side * OLX_EMISSION_TILE) * n + i % side * OLX_EMISSION_TILE;
    for (uint32_t row = 0; row < OLX_EMISSION_TILE; row++) {
      memcpy(tile + (size_t)row * OLX_EMISSION_TILE, corner + (size_t)row * n, OLX_EMISSION_TILE * sizeof *tile);
    }
    OLX_TRY(put_tile(writer, tile, &writer->tile_index[i]));
  }
  return put(writer, OLX_CHUNK_EMISSION, index, writer->tile_index);
}

static olx_result put_surface(olx_field_writer *writer, olx_chunk_kind kind, uint32_t index, const void *map) {
  return put_map(writer, kind, index, map, writer->info.maps.size);
}

// Writes the tiles of a map with block numbers that count from the start of the file's pool instead of the map's.
static olx_result put_tiles(olx_field_writer *writer, olx_surface_map map, uint32_t index, const olx_tiled_maps *maps) {
  growing_chunk *pool = &writer->pools[map];
  const uint32_t side = writer->info.maps.size / OLX_TILE_SIDE;
  for (uint32_t i = 0; i < side * side; i++) {
    writer->tile_index[i] = maps->words[i] ? maps->words[i] + pool->count : 0;
  }
  if ((uint64_t)pool->count + maps->count > OLX_TILE_MOST_BLOCKS) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: too many blocks of surfaces", writer->file.path);
  }
  OLX_TRY(put(writer, OLX_CHUNK_BASE + map, index, writer->tile_index));
  return append(writer, pool, maps->blocks, maps->count, olx_surface_block_bytes(map));
}

static olx_result write_surface(olx_field_writer *writer, uint32_t index, const olx_surface_maps *maps) {
  if ((maps->tiled != NULL) != writer->info.maps.compressed) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: surfaces of probe %u in another form than the header says",
                    writer->file.path, index);
  }
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS && maps->tiled; map++) {
    OLX_TRY(put_tiles(writer, map, index, &maps->tiled[map]));
  }
  if (maps->tiled) return put_emission(writer, index, maps->emission);
  OLX_TRY(put_surface(writer, OLX_CHUNK_BASE, index, maps->base));
  OLX_TRY(put_surface(writer, OLX_CHUNK_SPECULAR, index, maps->specular));
  OLX_TRY(put_surface(writer, OLX_CHUNK_DIRECT, index, maps->direct));
  OLX_TRY(put_surface(writer, OLX_CHUNK_INDIRECT, index, maps->indirect));
  return put_emission(writer, index, maps->emission);
}

olx_result olx_field_writer_surface(olx_field_writer *writer, uint32_t index, const olx_surface_maps *maps) {
  if (index != writer->surfaces_written || index >= writer->info.probes.count) {
    return refuse_order(writer, "surfaces of", index, writer->surfaces_written);
  }
  const olx_result result = write_surface(writer, index, maps);
  writer->failed |= result != OLX_OK;
  writer->surfaces_written++;
  return result;
}

static olx_result write_irradiance(olx_field_writer *writer, uint32_t index, const void *irradiance,
                                   const uint32_t *moments) {
  const uint32_t n = writer->info.irradiance.size;
  const bool map = writer->info.irradiance.form == OLX_IRRADIANCE_OCTAHEDRAL;
  OLX_TRY(map ? put_map(writer, OLX_CHUNK_IRRADIANCE, index, irradiance, n)
              : put(writer, OLX_CHUNK_IRRADIANCE, index, irradiance));
  return put_map(writer, OLX_CHUNK_MOMENTS, index, moments, n);
}

olx_result olx_field_writer_irradiance(olx_field_writer *writer, uint32_t index, uint8_t flags, const void *irradiance,
                                       const uint32_t *moments) {
  if (index != writer->irradiance_written || index >= writer->info.irradiance.probe_count) {
    return refuse_order(writer, "irradiance", index, writer->irradiance_written);
  }
  const olx_result result = write_irradiance(writer, index, irradiance, moments);
  writer->failed |= result != OLX_OK;
  writer->irradiance_flags[index] = flags;
  writer->info.irradiance.buried += flags & OLX_PROBE_BURIED;
  writer->irradiance_written++;
  return result;
}

// Writes the levels of radiance of a probe as one record.
static olx_result put_levels(olx_field_writer *writer, uint32_t index, const uint32_t *const *levels) {
  const uint64_t record = writer->layout.shapes[OLX_CHUNK_CLASSIC_RADIANCE].record_bytes;
  uint64_t offset = writer->layout.offsets[OLX_CHUNK_CLASSIC_RADIANCE] + index * record;
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    const uint32_t side = olx_classic_side(writer->info.classic.size, level);
    const uint64_t size_bytes = (uint64_t)(side + 2) * (side + 2) * sizeof(uint32_t);
    const void *map = add_border(writer, levels[level], side, sizeof(uint32_t));
    XXH3_64bits_update(&writer->hashes[OLX_CHUNK_CLASSIC_RADIANCE], map, size_bytes);
    OLX_TRY(olx_output_write_at(&writer->file, offset, map, size_bytes));
    offset += size_bytes;
  }
  return OLX_OK;
}

static olx_result write_classic(olx_field_writer *writer, uint32_t index, const olx_classic_record *record) {
  const uint32_t size = writer->info.classic.size;
  OLX_TRY(put_map(writer, OLX_CHUNK_CLASSIC_IRRADIANCE, index, record->irradiance, size));
  OLX_TRY(put_levels(writer, index, record->radiance));
  return put(writer, OLX_CHUNK_CLASSIC_BOXES, index, &record->box);
}

olx_result olx_field_writer_classic(olx_field_writer *writer, uint32_t index, const olx_classic_record *record) {
  if (index != writer->classic_written || index >= writer->info.irradiance.probe_count) {
    return refuse_order(writer, "classic", index, writer->classic_written);
  }
  const olx_result result = write_classic(writer, index, record);
  writer->failed |= result != OLX_OK;
  writer->classic_written++;
  return result;
}

olx_result olx_field_writer_volume(olx_field_writer *writer, const uint16_t *irradiance) {
  if (!writer->layout.present[OLX_CHUNK_VOLUME] || writer->volume_written) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: a volume that the header does not have, or twice", writer->file.path);
  }
  const olx_result result = put_whole(writer, OLX_CHUNK_VOLUME_IRRADIANCE, irradiance);
  writer->failed |= result != OLX_OK;
  writer->volume_written = true;
  return result;
}

// Sets the offsets of the chunks whose sizes are known only once all probes are written.
static void end_probes(olx_field_writer *writer) {
  olx_field_layout *layout = &writer->layout;
  olx_chunk_shape *shapes = layout->shapes;
  shapes[OLX_CHUNK_EMISSION_TILES].size_bytes = writer->tile_count * shapes[OLX_CHUNK_EMISSION_TILES].record_bytes;
  shapes[OLX_CHUNK_PLANES].size_bytes = writer->planes.count * shapes[OLX_CHUNK_PLANES].record_bytes;
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    olx_chunk_shape *shape = &shapes[OLX_CHUNK_BASE_POOL + map];
    shape->size_bytes = writer->pools[map].count * shape->record_bytes;
  }
  layout->file_bytes = layout->offsets[OLX_CHUNK_EMISSION_TILES];
  for (uint32_t k = OLX_CHUNK_EMISSION_TILES; k <= OLX_CHUNK_RELIGHT; k++) {
    if (!layout->present[k]) continue;
    layout->offsets[k] = layout->file_bytes;
    layout->file_bytes = olx_align_chunk(layout->offsets[k] + shapes[k].size_bytes);
  }
}

olx_result olx_field_writer_relight(olx_field_writer *writer, const void *data, size_t size_bytes) {
  if (!writer->layout.present[OLX_CHUNK_RELIGHT] || writer->relight_written ||
      writer->surfaces_written != writer->info.probes.count) {
    return olx_fail(OLX_ERROR_ARGUMENT,
                    "%s: relighting that the header does not have, twice, or before the last surfaces",
                    writer->file.path);
  }
  olx_chunk_shape *shape = &writer->layout.shapes[OLX_CHUNK_RELIGHT];
  shape->size_bytes = shape->record_bytes = size_bytes;
  end_probes(writer);
  olx_relight_data relight;
  OLX_TRY(olx_relight_structure_open(data, size_bytes, writer->file.path, &relight));
  const olx_result result = put_whole(writer, OLX_CHUNK_RELIGHT, data);
  writer->failed |= result != OLX_OK;
  writer->relight_written = true;
  return result;
}

// Copies data to its place, which is known by now.
static olx_result put_grown(olx_field_writer *writer, olx_chunk_kind kind, const growing_chunk *chunk) {
  char bytes[COPY_BYTES];
  for (uint64_t done = 0; done < chunk->data.size_bytes;) {
    const uint64_t left = chunk->data.size_bytes - done;
    const size_t count = left < COPY_BYTES ? (size_t)left : COPY_BYTES;
    OLX_TRY(olx_spool_read(&chunk->data, &writer->file, done, bytes, count));
    XXH3_64bits_update(&writer->hashes[kind], bytes, count);
    OLX_TRY(olx_output_write_at(&writer->file, writer->layout.offsets[kind] + done, bytes, count));
    done += count;
  }
  return OLX_OK;
}

// Writes the description, the padding after each chunk, the chunk table and the header.
static olx_result write_frame(olx_field_writer *writer) {
  const olx_file_info info = olx_field_info_store(&writer->info);
  OLX_TRY(put_whole(writer, OLX_CHUNK_INFO, &info));
  OLX_TRY(put_whole(writer, OLX_CHUNK_PROBE_POSITIONS, writer->probe_positions));
  OLX_TRY(put_whole(writer, OLX_CHUNK_PROBE_FLAGS, writer->probe_flags));
  if (writer->info.irradiance.probe_count) {
    OLX_TRY(put_whole(writer, OLX_CHUNK_IRRADIANCE_POSITIONS, writer->irradiance_positions));
    OLX_TRY(put_whole(writer, OLX_CHUNK_IRRADIANCE_FLAGS, writer->irradiance_flags));
  }
  end_probes(writer);
  if (writer->info.maps.geometry_blocks) OLX_TRY(put_grown(writer, OLX_CHUNK_PLANES, &writer->planes));
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS && writer->info.maps.compressed; map++) {
    OLX_TRY(put_grown(writer, OLX_CHUNK_BASE_POOL + map, &writer->pools[map]));
  }
  struct {
    olx_file_header header;
    olx_file_chunk chunks[OLX_CHUNK_KINDS];
  } head;
  const char padding[OLX_CHUNK_ALIGNMENT] = {0};
  uint32_t count = 0;
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) {
    if (!writer->layout.present[k]) continue;
    const olx_chunk_shape *shape = &writer->layout.shapes[k];
    const bool required = olx_chunk_is_required(&writer->info, k) || k == OLX_CHUNK_ORIGIN;
    head.chunks[count++] = olx_chunk_entry(shape, required ? 0 : OLX_CHUNK_OPTIONAL, writer->layout.offsets[k],
                                           XXH3_64bits_digest(&writer->hashes[k]));
    const uint64_t end = writer->layout.offsets[k] + shape->size_bytes;
    OLX_TRY(olx_output_write_at(&writer->file, end, padding, olx_align_chunk(end) - end));
  }
  head.header = olx_chunk_header(&OLX_FIELD_KIND, head.chunks, count, writer->layout.file_bytes);
  return olx_output_write_at(&writer->file, 0, &head, sizeof head.header + count * sizeof head.chunks[0]);
}

void olx_field_writer_last_bounce(olx_field_writer *writer, float share) {
  writer->info.bounces.last = olx_clamp(share, 0.0f, 1.0f);
}

olx_result olx_field_writer_commit(olx_field_writer *writer, uint64_t *file_bytes) {
  olx_result result = OLX_OK;
  if (writer->failed) {
    result = olx_fail(OLX_ERROR_FILE, "%s: not written, because writing a probe failed", writer->file.path);
  } else if (writer->probes_written != writer->info.probes.count ||
             writer->irradiance_written != writer->info.irradiance.probe_count) {
    result = olx_fail(OLX_ERROR_ARGUMENT, "%s: %u of %u light field probes and %u of %u irradiance probes written",
                      writer->file.path, writer->probes_written, writer->info.probes.count, writer->irradiance_written,
                      writer->info.irradiance.probe_count);
  } else if (writer->surfaces_written != writer->info.probes.count) {
    result = olx_fail(OLX_ERROR_ARGUMENT, "%s: surfaces of %u of %u light field probes written", writer->file.path,
                      writer->surfaces_written, writer->info.probes.count);
  } else if (writer->layout.present[OLX_CHUNK_VOLUME] && !writer->volume_written) {
    result = olx_fail(OLX_ERROR_ARGUMENT, "%s: the irradiance of the volume was not written", writer->file.path);
  } else if (writer->info.classic.size && writer->classic_written != writer->info.irradiance.probe_count) {
    result = olx_fail(OLX_ERROR_ARGUMENT, "%s: classic maps of %u of %u irradiance probes written", writer->file.path,
                      writer->classic_written, writer->info.irradiance.probe_count);
  } else if (writer->layout.present[OLX_CHUNK_RELIGHT] && !writer->relight_written) {
    result = olx_fail(OLX_ERROR_ARGUMENT, "%s: what relighting needs was not written", writer->file.path);
  } else {
    result = write_frame(writer);
  }
  if (result != OLX_OK) {
    olx_field_writer_discard(writer);
    return result;
  }
  result = olx_output_commit(&writer->file);
  if (result == OLX_OK && file_bytes) *file_bytes = writer->layout.file_bytes;
  destroy(writer);
  return result;
}

void olx_field_writer_discard(olx_field_writer *writer) {
  if (!writer) return;
  olx_output_discard(&writer->file);
  destroy(writer);
}
