#include "synthetic_field.h"

#include "bake/selectors.h"
#include "core/file.h"
#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"
#include "field/texels.h"

#include <stdlib.h>

const olx_field_light synthetic_lights[SYNTHETIC_LIGHTS] = {
    {.type = OLX_FIELD_SUN, .direction = {0.0f, -1.0f, 0.0f}, .emission = {3.0f, 2.0f, 1.0f}},
    {.type = OLX_FIELD_POINT, .position = {1.0f, 2.0f, -1.0f}, .emission = {5.0f, 5.0f, 5.0f}},
    {.type = OLX_FIELD_SPOT,
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
  uint8_t *flags = olx_allocate(header->info.probe_count, 1);
  for (uint32_t i = 0; i < header->info.probe_count; i++) flags[i] = synthetic_flags(i);
  olx_scene *scene = NULL;
  if (mask && olx_scene_load("builtin:cornell", &scene) != OLX_OK) abort();
  const olx_selector_input input = {.scene = scene,
                                    .positions = header->probe_positions,
                                    .flags = flags,
                                    .count = header->info.probe_count,
                                    .radiance_size = header->info.radiance_size,
                                    .distance_scale = header->info.distance_scale_metres,
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
  header->info.classic_size = size;
  header->info.classic_cube_size = 64;
  header->info.classic_sharpness = 512.0f;
  header->classic_table = table;
}

olx_field_header synthetic_header(const synthetic_shape *shape) {
  olx_field_header header = {.info = {.probe_count = probes_of(shape->grid),
                                      .irradiance_probe_count = probes_of(shape->irradiance_grid),
                                      .has_grid = true,
                                      .grid = grid_of(shape->grid),
                                      .radiance_size = shape->n,
                                      .irradiance_size = shape->irradiance_n,
                                      .irradiance_form = shape->irradiance_form,
                                      .select_mask = 1u << OLX_SELECT_CAGE,
                                      .distance_scale_metres = 12.5f,
                                      .scene_min = {-4.0f, -1.0f, -4.5f},
                                      .scene_max = {4.0f, 3.0f, 4.5f},
                                      .bounces = 3,
                                      .samples = 2,
                                      .scene_hash = 0x0123456789ABCDEFu}};
  if (header.info.irradiance_probe_count) header.info.irradiance_grid = grid_of(shape->irradiance_grid);
  header.probe_positions = positions_of(&header.info.grid, header.info.probe_count);
  header.irradiance_positions = positions_of(&header.info.irradiance_grid, header.info.irradiance_probe_count);
  build_selectors(&header, shape->select_mask);
  if (shape->classic_size) describe_classic(&header, shape->classic_size);
  header.lights = synthetic_lights;
  header.light_count = SYNTHETIC_LIGHTS;
  header.info.relight_size = shape->relight_size;
  header.info.relight_points = shape->relight_points;
  header.info.relight_rays = shape->relight_rays;
  header.info.relight_hidden = shape->relight_hidden;
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
    // A room around the probe, its walls a little rough.
    const float wall = olx_max(fabsf(direction.x), olx_max(1.5f * fabsf(direction.y), fabsf(direction.z)));
    distance[i] = olx_half_pack((0.25f - 0.02f * olx_unit_float(olx_hash(random))) / wall);
    if (random % 17 == 0) distance[i] = 0x7C00;
    else if (random % 13 == 0) distance[i] |= 0x8000;
  }
  distance[n / 2] = 0;
}

olx_surface_maps synthetic_surface_maps(uint32_t n, uint32_t probe, const uint16_t *distance,
                                        synthetic_surfaces_room *room) {
  for (uint32_t i = 0; i < n * n; i++) {
    const float a = olx_unit_float(olx_hash3(i, n, probe ^ 0x1000u)), b = olx_unit_float(olx_hash3(i, n, probe ^ 0x2000u));
    const bool sky = distance[i] == 0x7C00, emits = distance[i] >= 0x7C00 && (probe % 2 == 0 || i >= n * n / 4 * 3);
    const olx_texel_material_codes material = olx_material_pack(olx_v3(a, b, a * b), b, a > 0.5f, a);
    room->base[i] = sky ? 0 : material.base;
    room->specular[i] = sky ? 0 : material.specular;
    room->direct[i] = sky ? 0 : olx_rgb9e5_pack(olx_v3(9.0f * a, b, 0.0f));
    room->indirect[i] = sky ? 0 : olx_rgb9e5_pack(olx_v3(b, a, 0.1f));
    room->emission[i] = emits ? olx_rgb9e5_pack(olx_v3(20.0f, 10.0f + a, b)) : 0;
  }
  return (olx_surface_maps){room->base, room->specular, room->direct, room->indirect, room->emission};
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

void synthetic_albedo(uint32_t n, uint32_t probe, uint32_t *albedo) {
  for (uint32_t i = 0; i < n * n; i++) {
    const float share = olx_unit_float(olx_hash3(i, n, probe ^ 0x9000u));
    albedo[i] = olx_r11g11b10f_pack(olx_v3(share, 1.0f - share, 1.0f));
  }
}

static olx_vec3 some_direction(uint32_t random) {
  return olx_sample_sphere((olx_vec2){olx_unit_float(random), olx_unit_float(olx_hash(random))});
}

// Every fourth place is empty.
void synthetic_hidden(const synthetic_shape *shape, uint32_t probe, olx_hidden_surface *hidden) {
  for (uint32_t i = 0; i < shape->relight_hidden; i++) {
    const uint32_t random = olx_hash3(i, probe, 0xF000u);
    const olx_vec3 direction = some_direction(random);
    hidden[i] = (olx_hidden_surface){olx_scale(direction, 3.0f), olx_normal_pack(olx_negate(direction)),
                                     olx_r11g11b10f_pack(olx_splat(olx_unit_float(olx_hash(random + 1))))};
    if (i % 4 == 3) hidden[i] = (olx_hidden_surface){.normal = OLX_FIT_NO_POINT};
  }
}

void synthetic_surfaces(const synthetic_shape *shape, uint32_t probe, olx_surface_sample *surfaces, uint32_t *fit) {
  const uint32_t n = shape->relight_size, count = n * n;
  const uint32_t all = (count + shape->relight_hidden) * probes_of(shape->irradiance_grid);
  for (uint32_t i = 0; i < count; i++) {
    const uint32_t random = olx_hash3(i, n, probe ^ 0xB000u);
    const olx_vec3 direction = olx_surface_direction(i % n, i / n, n);
    const float wall = olx_max(fabsf(direction.x), olx_max(1.5f * fabsf(direction.y), fabsf(direction.z)));
    surfaces[i] = (olx_surface_sample){olx_r11g11b10f_pack(olx_splat(olx_unit_float(random))),
                                       olx_normal_pack(olx_negate(direction)),
                                       random % 19 == 0 ? 0x7C00 : olx_half_pack(0.25f / wall)};
  }
  for (uint32_t p = 0; p < shape->relight_points; p++) {
    uint32_t *words = fit + (size_t)p * (4 + shape->relight_rays);
    const uint32_t random = olx_hash3(p, probe, 0xD000u);
    const olx_vec3 normal = some_direction(random);
    const olx_fit_place place = {olx_scale(normal, 2.0f), p == 1 ? OLX_FIT_NO_POINT : olx_normal_pack(normal)};
    memcpy(words, &place, sizeof place);
    for (uint32_t k = 0; k < shape->relight_rays; k++) {
      const uint32_t surface = olx_hash3(p, k, random) % all;
      words[4 + k] = k % 7 == 5 ? OLX_FIT_RAY_SKY : k % 7 == 6 ? OLX_FIT_RAY_UNKNOWN : surface;
    }
  }
}

static olx_result write_relight(olx_field_writer *writer, const synthetic_shape *shape) {
  const uint32_t size = shape->relight_size, n = shape->n;
  if (size == 0) return OLX_OK;
  olx_surface_sample *surfaces = olx_allocate((size_t)size * size, sizeof *surfaces);
  uint32_t *fit = olx_allocate((size_t)shape->relight_points * (4 + shape->relight_rays), sizeof *fit);
  olx_hidden_surface *hidden = olx_allocate(shape->relight_hidden, sizeof *hidden);
  uint32_t *albedo = olx_allocate((size_t)n * n, sizeof *albedo);
  olx_result result = OLX_OK;
  for (uint32_t i = 0; i < probes_of(shape->irradiance_grid) && result == OLX_OK; i++) {
    synthetic_surfaces(shape, i, surfaces, fit);
    synthetic_hidden(shape, i, hidden);
    result = olx_field_writer_relight(writer, i, &(olx_relight_record){surfaces, fit, hidden});
  }
  for (uint32_t i = 0; i < probes_of(shape->grid) && result == OLX_OK; i++) {
    synthetic_albedo(n, i, albedo);
    result = olx_field_writer_albedo(writer, i, albedo);
  }
  olx_release(surfaces);
  olx_release(fit);
  olx_release(hidden);
  olx_release(albedo);
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
    result = olx_field_writer_probe(writer, i, synthetic_flags(i), probe_light ? first : NULL, normal, distance);
    const olx_surface_maps maps = synthetic_surface_maps(shape->n, i, distance, room);
    if (result == OLX_OK) result = olx_field_writer_surface(writer, i, &maps);
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
