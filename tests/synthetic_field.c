// Writes small field files that are valid throughout but whose maps are made up, for tests of files and of their
// readers.
#include "synthetic_field.h"

#include "bake/selectors/selectors.h"
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/texels.h"

#include <stdlib.h>

const olx_field_light synthetic_lights[SYNTHETIC_LIGHTS] = {
    {.type = OLX_LIGHT_SUN, .direction = {0.0f, -1.0f, 0.0f}, .emission = {3.0f, 2.0f, 1.0f}},
    {.type = OLX_LIGHT_POINT, .position = {1.0f, 2.0f, -1.0f}, .emission = {5.0f, 5.0f, 5.0f}},
    {.type = OLX_LIGHT_SPOT,
     .position = {-1.0f, 2.5f, 0.5f},
     .direction = {0.6f, -0.8f, 0.0f},
     .emission = {0.0f, 7.0f, 0.0f},
     .cosine_inner = 0.9f,
     .cosine_outer = 0.5f},
};

static uint32_t probes_of(const uint32_t counts[3]) { return counts[0] * counts[1] * counts[2]; }

static olx_grid grid_of(const uint32_t counts[3]) {
  return (olx_grid){.origin = {-0.5f * (float)(counts[0] - 1), 0.25f, -0.5f * (float)(counts[2] - 1)},
                    .spacing = {counts[0] > 1, counts[1] > 1, counts[2] > 1},
                    .count = {counts[0], counts[1], counts[2]}};
}

static const olx_vec3 *positions_of(const olx_grid *grid, uint32_t count) {
  olx_vec3 *positions = olx_allocate(count, sizeof *positions);
  for (uint32_t i = 0; positions && i < count; i++) positions[i] = olx_grid_position(grid, i);
  return positions;
}

static void build_selectors(olx_field_header *header, uint32_t mask) {
  uint8_t *flags = olx_allocate(header->info.probes.count, 1);
  for (uint32_t i = 0; i < header->info.probes.count; i++) flags[i] = synthetic_flags(i);
  olx_scene *scene = NULL;
  if (mask && olx_scene_load("builtin:cornell", &scene) != OLX_OK) abort();
  const olx_selector_input input = {.scene = scene,
                                    .positions = header->probe_positions,
                                    .flags = flags,
                                    .count = header->info.probes.count,
                                    .radiance_size = header->info.maps.size,
                                    .distance_scale = header->info.maps.distance_scale_metres,
                                    .threads = 1};
  olx_selector_blobs blobs = {0};
  if (olx_selectors_build(&input, mask, &blobs) == OLX_OK) header->info.select_mask |= mask;
  for (uint32_t i = 0; i < OLX_SELECT_STORED; i++) {
    header->select_data[i] = blobs.data[i];
    header->select_bytes[i] = blobs.size_bytes[i];
  }
  olx_scene_free(scene);
  olx_release(flags);
}

static void describe_classic(olx_field_header *header, uint32_t size) {
  uint32_t *table = olx_allocate(OLX_CLASSIC_TABLE_ENTRIES, sizeof *table);
  for (uint32_t i = 0; i < OLX_CLASSIC_TABLE_ENTRIES; i++) {
    const float scale = olx_unit_float(olx_hash(i));
    table[i] = olx_half_pack(scale) | (uint32_t)olx_half_pack(1.0f - scale) << 16;
  }
  header->info.classic.size = size;
  header->info.classic.cube_size = 64;
  header->info.classic.sharpness = 512.0f;
  header->classic_table = table;
}

olx_field_header synthetic_header(const synthetic_shape *shape) {
  olx_field_header header = {
      .info = {.probes = {.count = probes_of(shape->grid), .has_grid = true, .grid = grid_of(shape->grid)},
               .maps = {.size = shape->n,
                        .samples = 2,
                        .distance_scale_metres = 12.5f,
                        .compressed = shape->compressed,
                        .geometry_blocks = shape->geometry_blocks},
               .irradiance = {.probe_count = probes_of(shape->irradiance_grid),
                              .size = shape->irradiance_n,
                              .form = shape->irradiance_form},
               .select_mask = 1u << OLX_SELECT_CAGE,
               .bounces.count = 3,
               .scene = {.bounds_min = {-4.0f, -1.0f, -4.5f},
                         .bounds_max = {4.0f, 3.0f, 4.5f},
                         .hash = 0x0123456789ABCDEFu}}};
  if (header.info.irradiance.probe_count) header.info.irradiance.grid = grid_of(shape->irradiance_grid);
  header.probe_positions = positions_of(&header.info.probes.grid, header.info.probes.count);
  header.irradiance_positions = positions_of(&header.info.irradiance.grid, header.info.irradiance.probe_count);
  build_selectors(&header, shape->select_mask);
  if (shape->classic_size) describe_classic(&header, shape->classic_size);
  header.lights = synthetic_lights;
  header.light_count = SYNTHETIC_LIGHTS;
  header.relight = shape->relight_surfels > 0;
  memcpy(header.origin, shape->origin, sizeof header.origin);
  return header;
}

void synthetic_header_release(olx_field_header *header) {
  olx_release((void *)(uintptr_t)header->probe_positions);
  olx_release((void *)(uintptr_t)header->irradiance_positions);
  for (uint32_t i = 0; i < OLX_SELECT_STORED; i++) olx_release((void *)(uintptr_t)header->select_data[i]);
  olx_release((void *)(uintptr_t)header->classic_table);
}

uint8_t synthetic_flags(uint32_t probe) { return probe % 3 == 1 ? OLX_PROBE_BURIED : 0; }

void synthetic_light_maps(uint32_t n, uint32_t probe, uint32_t *radiance, uint16_t *normal, uint16_t *distance) {
  for (uint32_t i = 0; i < n * n; i++) {
    const uint32_t random = olx_hash3(i, n, probe);
    const olx_vec3 direction = olx_texel_direction(i % n, i / n, n);
    const float light = 8.0f * olx_unit_float(random);
    radiance[i] = olx_r11g11b10f_pack(olx_v3(light, 0.5f * light, 0.25f + 0.25f * light));
    normal[i] = olx_normal_pack(olx_negate(direction));
    // Returns the distance to a room around the probe with slightly rough walls.
    const float wall = olx_max(fabsf(direction.x), olx_max(1.5f * fabsf(direction.y), fabsf(direction.z)));
    distance[i] = olx_half_pack((0.25f - 0.02f * olx_unit_float(olx_hash(random))) / wall);
    if (random % 17 == 0) distance[i] = 0x7C00;
    else if (random % 13 == 0) distance[i] |= 0x8000;
  }
  distance[n / 2] = 0;
  for (uint32_t i = 0; i < 16 && n >= 16 && probe % 4 == 3; i++) distance[(4 + i / 4) * n + 8 + i % 4] = 0x7C00;
}

olx_geometry_texel synthetic_geometry_texel(const void *geometry, uint32_t x, uint32_t y) {
  const synthetic_geometry *g = geometry;
  const size_t at = (size_t)y * g->n + x;
  const float distance = olx_half_unpack(g->distance[at] & 0x7FFFu) * 12.5f; // the header's distance scale
  return (olx_geometry_texel){distance, olx_normal_unpack(g->normal[at])};
}

static olx_result write_blocks(olx_field_writer *writer, uint32_t probe, const uint32_t *radiance,
                               const synthetic_geometry *geometry) {
  olx_geometry_maker maker;
  OLX_TRY(olx_geometry_maker_create(geometry->n, &maker));
  olx_result result = olx_geometry_maker_encode(&maker, geometry->n, 1, synthetic_geometry_texel, geometry);
  if (result == OLX_OK) {
    result = olx_field_writer_probe_blocks(writer, probe, synthetic_flags(probe), radiance, &maker.map);
  }
  olx_geometry_maker_free(&maker);
  return result;
}

olx_surface_maps synthetic_surface_maps(uint32_t n, uint32_t probe, const uint16_t *distance,
                                        synthetic_surfaces_room *room) {
  for (uint32_t i = 0; i < n * n; i++) {
    const uint32_t tile = i / n / OLX_TILE_SIDE * (n / OLX_TILE_SIDE) + i % n / OLX_TILE_SIDE,
                   place = probe % 3 == 1 ? tile : i; // tiles of one surface and of many
    const float a = olx_unit_float(olx_hash3(place, n, probe ^ 0x1000u)),
                b = olx_unit_float(olx_hash3(place, n, probe ^ 0x2000u));
    const bool sky = distance[i] == 0x7C00, emits = distance[i] >= 0x7C00 && (probe % 2 == 0 || i >= n * n / 4 * 3);
    const olx_texel_material_codes material = olx_material_pack(olx_v3(a, b, a * b), b, a > 0.5f, a);
    room->base[i] = sky ? 0 : material.base;
    room->specular[i] = sky ? 0 : material.specular;
    room->direct[i] = sky ? 0 : olx_rgb9e5_pack(olx_v3(9.0f * a, b, 0.0f));
    room->indirect[i] = sky ? 0 : olx_rgb9e5_pack(olx_v3(b, a, 0.1f));
    room->emission[i] = emits ? olx_rgb9e5_pack(olx_v3(20.0f, 10.0f + a, b)) : 0;
  }
  return (olx_surface_maps){room->base, room->specular, room->direct, room->indirect, .emission = room->emission};
}

void synthetic_surface_tiles(uint32_t n, const uint16_t *distance, olx_surface_maker *maker, olx_surface_maps *maps) {
  const olx_surface_texels texels = {maps->base, maps->specular, maps->direct, maps->indirect, distance};
  if (olx_surface_maker_create(n, maker) != OLX_OK || olx_surface_maker_encode(maker, &texels, n, 1) != OLX_OK) abort();
  *maps = (olx_surface_maps){.tiled = maker->maps, .emission = maps->emission};
}

void synthetic_irradiance_maps(uint32_t n, uint32_t probe, uint32_t *irradiance, uint32_t *moments) {
  for (uint32_t i = 0; i < n * n; i++) {
    const uint32_t random = olx_hash3(i, n, probe ^ 0x5000u);
    const float light = olx_unit_float(random), mean = olx_unit_float(olx_hash(random));
    const float spread = (1.0f - mean) * mean * olx_unit_float(olx_hash(random + 1));
    irradiance[i] = olx_r11g11b10f_pack(olx_v3(light, 1.0f - light, 0.5f));
    moments[i] = olx_half_pack(mean) | (uint32_t)olx_half_pack(mean * mean + spread) << 16;
  }
}

void synthetic_harmonics(olx_irradiance_form form, uint32_t probe, uint16_t halves[OLX_HARMONICS_MOST_HALVES]) {
  olx_vec3 coefficients[OLX_HARMONICS_MOST];
  for (uint32_t i = 0; i < OLX_HARMONICS_MOST; i++) {
    const float value = 4.0f * olx_unit_float(olx_hash3(i, probe, 0xE000u)) - 2.0f;
    coefficients[i] = i == 0 ? olx_splat(1.0f) : olx_v3(value, -value, 0.5f * value);
  }
  olx_harmonics_pack(coefficients, olx_irradiance_bands(form), halves);
}

olx_classic_record synthetic_classic_maps(uint32_t size, uint32_t probe, olx_vec3 position, synthetic_classic *maps) {
  olx_classic_record record = {
      .irradiance = maps->irradiance,
      .box = {olx_sub(position, olx_v3(2.0f, 1.0f, 0.5f)), olx_add(position, olx_v3(1.0f, 0.0f, 3.0f + (float)probe))}};
  for (uint32_t map = 0; map <= OLX_CLASSIC_LEVELS; map++) {
    uint32_t *codes = map < OLX_CLASSIC_LEVELS ? maps->radiance[map] : maps->irradiance;
    const uint32_t side = map < OLX_CLASSIC_LEVELS ? olx_classic_side(size, map) : size;
    for (uint32_t i = 0; i < side * side; i++) {
      const float light = olx_unit_float(olx_hash3(i, map, probe ^ 0x7000u));
      codes[i] = olx_r11g11b10f_pack(olx_v3(light, 1.0f - light, 0.5f));
    }
    if (map < OLX_CLASSIC_LEVELS) record.radiance[map] = codes;
  }
  return record;
}

static olx_result write_classic(olx_field_writer *writer, const synthetic_shape *shape) {
  if (shape->classic_size == 0) return OLX_OK;
  synthetic_classic *maps = olx_allocate(1, sizeof *maps);
  if (!maps) return olx_fail(OLX_ERROR_MEMORY, "out of memory");
  const olx_grid grid = grid_of(shape->irradiance_grid);
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < probes_of(shape->irradiance_grid) && result == OLX_OK; i++) {
    const olx_classic_record record = synthetic_classic_maps(shape->classic_size, i, olx_grid_position(&grid, i), maps);
    result = olx_field_writer_classic(writer, i, &record);
  }
  olx_release(maps);
  return result;
}

// ---- Relighting data

static olx_vec3 some_direction(uint32_t random) {
  return olx_sample_sphere((olx_vec2){olx_unit_float(random), olx_unit_float(olx_hash(random))});
}

// Rows of `least`, `least` + 1, ... elements, with `kinds` lengths in turn.
typedef struct row_lengths {
  uint32_t rows, least, kinds;
} row_lengths;

static uint32_t row_length(row_lengths l, uint32_t row) { return l.least + row % l.kinds; }

static uint32_t length_of_all(row_lengths l) {
  uint32_t sum = 0;
  for (uint32_t i = 0; i < l.rows; i++) sum += row_length(l, i);
  return sum;
}

// The lengths of rows of surfels' links and of sites' entries.
typedef struct relight_rows {
  row_lengths links, entries;
} relight_rows;

static relight_rows relight_rows_of(const synthetic_shape *shape, uint32_t blocks) {
  return (relight_rows){.links = {shape->relight_surfels, 0, 4}, .entries = {blocks + OLX_RELIGHT_BLOCK_SITES, 0, 4}};
}

static void put(char **next, const void *data, size_t size_bytes) {
  memcpy(*next, data, size_bytes);
  *next += size_bytes;
}

static void put_starts(char **next, row_lengths l) {
  uint32_t start = 0;
  for (uint32_t i = 0; i <= l.rows; i++) {
    put(next, &start, sizeof start);
    start += row_length(l, i);
  }
}

static void put_surfels(char **next, uint32_t count) {
  for (uint32_t i = 0; i < count; i++) {
    const uint32_t random = olx_hash2(i, 0xB000u);
    const olx_vec3 normal = some_direction(random);
    olx_relight_surfel s = {.normal = olx_normal_pack(normal),
                            .irradiance = olx_rgb9e5_pack(olx_v3(2.0f, olx_unit_float(random), 0.5f)),
                            .diffuse = (uint8_t)(32u + (random & 63u)),
                            .specular = (uint8_t)(random >> 6 & 63u),
                            .f0 = (uint8_t)(random >> 12),
                            .alpha = (uint8_t)(random >> 20)};
    for (uint32_t k = 0; k < OLX_RELIGHT_POINTS; k++) {
      olx_store3(s.points[k], olx_madd(olx_scale(normal, -2.0f), some_direction(random + k), 0.1f));
    }
    put(next, &s, sizeof s);
  }
}

// Writes links that together pass on less light than there is; a random share of it met no specular surface.
static void put_links(char **next, uint32_t count, uint32_t surfels) {
  for (uint32_t i = 0; i < count; i++) {
    const uint32_t random = olx_hash2(i, 0xC000u);
    const olx_vec3 weight = olx_scale(olx_v3(1.0f, olx_unit_float(random), 0.5f), 0.2f);
    const olx_relight_link link = {random % surfels | random >> 24 << 24, olx_rgb9e5_pack(weight)};
    put(next, &link, sizeof link);
  }
}

// Writes blocks of sites; every seventh sees nothing but the sky.
static void put_blocks(char **next, uint32_t count, uint32_t sites) {
  for (uint32_t i = 0; i < count; i++) {
    const uint32_t first = olx_hash2(i, 0xE000u) % (sites - OLX_RELIGHT_BLOCK_SITES + 1);
    const olx_relight_block block = {i % 7 == 3 ? OLX_RELIGHT_NO_SITE : first, olx_hash2(i, 0xF000u)};
    put(next, &block, sizeof block);
  }
}

// Writes entries of sites; the weights of each site sum to 255, with the remainder in the last entry.
static void put_entries(char **next, row_lengths l, uint32_t surfels) {
  for (uint32_t site = 0; site < l.rows; site++) {
    uint32_t left[4] = {255, 255, 255, 255};
    for (uint32_t i = 0; i < row_length(l, site); i++) {
      const uint32_t random = olx_hash3(i, site, 0xA000u);
      const bool last = i + 1 == row_length(l, site);
      olx_relight_entry entry = {.surfel = random % surfels};
      for (uint32_t corner = 0; corner < 4; corner++) {
        entry.weights[corner] = (uint8_t)(last ? left[corner] : (random >> 8 * corner & 0xFFu) * left[corner] / 255u);
        left[corner] -= entry.weights[corner];
      }
      put(next, &entry, sizeof entry);
    }
  }
}

void *synthetic_relight(const synthetic_shape *shape, size_t *size_bytes) {
  const uint32_t side = shape->n / OLX_RELIGHT_BLOCK, blocks = side * side * probes_of(shape->grid);
  const relight_rows rows = relight_rows_of(shape, blocks);
  const olx_relight_header header = {.surfels = shape->relight_surfels,
                                     .links = length_of_all(rows.links),
                                     .sites = rows.entries.rows,
                                     .entries = length_of_all(rows.entries),
                                     .blocks = blocks};
  *size_bytes = olx_relight_structure_bytes(&header);
  void *data = olx_allocate(*size_bytes, 1);
  if (!data) return NULL;
  char *next = data;
  put(&next, &header, sizeof header);
  put_surfels(&next, header.surfels);
  put_starts(&next, rows.links);
  put_links(&next, header.links, header.surfels);
  put_blocks(&next, blocks, header.sites);
  put_starts(&next, rows.entries);
  put_entries(&next, rows.entries, header.surfels);
  put_starts(&next, (row_lengths){.kinds = 1}); // no starts of volume probes
  return data;
}

static olx_result write_relight(olx_field_writer *writer, const synthetic_shape *shape) {
  if (shape->relight_surfels == 0) return OLX_OK;
  size_t size_bytes;
  void *data = synthetic_relight(shape, &size_bytes);
  if (!data) return olx_fail(OLX_ERROR_MEMORY, "out of memory");
  const olx_result result = olx_field_writer_relight(writer, data, size_bytes);
  olx_release(data);
  return result;
}

olx_result synthetic_write_probes(olx_field_writer *writer, const synthetic_shape *shape) {
  const size_t texels = (size_t)shape->n * shape->n,
               irradiance_texels = (size_t)shape->irradiance_n * shape->irradiance_n;
  const size_t most = texels > irradiance_texels ? texels : irradiance_texels;
  uint32_t *first = olx_allocate(most, 8), *second = first + most;
  synthetic_surfaces_room *room = olx_allocate(1, sizeof *room);
  if (!first || !room) return olx_fail(OLX_ERROR_MEMORY, "out of memory");
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < probes_of(shape->grid) && result == OLX_OK; i++) {
    uint16_t *normal = (uint16_t *)second, *distance = normal + texels;
    synthetic_light_maps(shape->n, i, first, normal, distance);
    const bool probe_light = probes_of(shape->irradiance_grid) > 0;
    const uint32_t *radiance = probe_light ? first : NULL;
    const synthetic_geometry geometry = {shape->n, normal, distance};
    result = shape->geometry_blocks ? write_blocks(writer, i, radiance, &geometry)
                                    : olx_field_writer_probe(writer, i, synthetic_flags(i), radiance, normal, distance);
    olx_surface_maps maps = synthetic_surface_maps(shape->n, i, distance, room);
    olx_surface_maker tiles = {.known = NULL};
    if (shape->compressed) synthetic_surface_tiles(shape->n, distance, &tiles, &maps);
    if (result == OLX_OK) result = olx_field_writer_surface(writer, i, &maps);
    olx_surface_maker_free(&tiles);
  }
  for (uint32_t i = 0; i < probes_of(shape->irradiance_grid) && result == OLX_OK; i++) {
    synthetic_irradiance_maps(shape->irradiance_n, i, first, second);
    uint16_t halves[OLX_HARMONICS_MOST_HALVES];
    const bool map = shape->irradiance_form == OLX_IRRADIANCE_OCTAHEDRAL;
    if (!map) synthetic_harmonics(shape->irradiance_form, i, halves);
    result = olx_field_writer_irradiance(writer, i, synthetic_flags(i), map ? (const void *)first : halves, second);
  }
  olx_release(room);
  olx_release(first);
  if (result == OLX_OK) result = write_classic(writer, shape);
  return result == OLX_OK ? write_relight(writer, shape) : result;
}

olx_result synthetic_write(const char *path, const synthetic_shape *shape, uint64_t *file_bytes) {
  olx_field_header header = synthetic_header(shape);
  olx_field_writer *writer = NULL;
  olx_result result = olx_field_writer_create(path, &header, &writer);
  synthetic_header_release(&header);
  OLX_TRY(result);
  result = synthetic_write_probes(writer, shape);
  if (result == OLX_OK) return olx_field_writer_commit(writer, file_bytes);
  olx_field_writer_discard(writer);
  return result;
}

unsigned char *synthetic_read_file(const char *path, size_t *size_bytes) {
  olx_mapped_file file = {0};
  if (olx_map_file(path, &file) != OLX_OK) return NULL;
  unsigned char *bytes = olx_allocate(file.size_bytes, 1);
  if (bytes && file.size_bytes) memcpy(bytes, file.data, file.size_bytes);
  *size_bytes = file.size_bytes;
  olx_unmap_file(&file);
  return bytes;
}
