// Field files: what is written is what is read, every refusal is reached, nothing is left half written.
#include "synthetic_field.h"

#include "core/file.h"
#include "core/hooks.h"
#include "field/field_file.h"

#include <octalux/octalux.h>

#include <dirent.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const synthetic_shape small = {.grid = {3, 2, 2}, .irradiance_grid = {2, 1, 3}, .n = 16, .irradiance_n = 8};
static const synthetic_shape single = {.grid = {1, 1, 1}, .irradiance_grid = {1, 1, 1}, .n = 128, .irradiance_n = 32};
static const synthetic_shape classic = {
    .grid = {2, 1, 1}, .irradiance_grid = {2, 1, 3}, .n = 8, .irradiance_n = 8, .classic_size = 64};
static const synthetic_shape relit = {.grid = {2, 1, 1},
                                      .irradiance_grid = {2, 1, 3},
                                      .n = 16,
                                      .irradiance_n = 8,
                                      .relight_size = 16,
                                      .relight_points = 5,
                                      .relight_rays = 9};
static const synthetic_shape unfitted = {
    .grid = {1, 1, 1}, .irradiance_grid = {1, 2, 1}, .n = 8, .irradiance_n = 32, .relight_size = 32};
static const synthetic_shape least = {.grid = {1, 4, 1}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8};

typedef struct fixture {
  char folder[64], path[96];
} fixture;

static int set_up(void **state) {
  fixture *f = calloc(1, sizeof *f);
  snprintf(f->folder, sizeof f->folder, "/tmp/octalux-field-XXXXXX");
  if (!mkdtemp(f->folder)) return -1;
  snprintf(f->path, sizeof f->path, "%s/a.olx", f->folder);
  *state = f;
  return 0;
}

static uint32_t files_in(const char *folder) {
  uint32_t count = 0;
  DIR *directory = opendir(folder);
  for (const struct dirent *entry; (entry = readdir(directory));) count += entry->d_name[0] != '.';
  closedir(directory);
  return count;
}

static int tear_down(void **state) {
  fixture *f = *state;
  unlink(f->path);
  const int result = rmdir(f->folder); // also proves that nothing else was left behind
  free(f);
  return result;
}

static unsigned char *written(fixture *f, const synthetic_shape *shape, size_t *size_bytes) {
  uint64_t file_bytes = 0;
  assert_int_equal(synthetic_write(f->path, shape, &file_bytes), OLX_OK);
  unsigned char *bytes = synthetic_read_file(f->path, size_bytes);
  assert_non_null(bytes);
  assert_int_equal(file_bytes, *size_bytes);
  return bytes;
}

static uint32_t bordered(const void *map, uint32_t n, size_t texel_bytes, int32_t x, int32_t y) {
  uint32_t texel = 0;
  memcpy(&texel, (const char *)map + ((size_t)(y + 1) * (n + 2) + (size_t)(x + 1)) * texel_bytes, texel_bytes);
  return texel;
}

// Whether a bordered map is the given one with the border that continues it on the sphere.
static void assert_map(const void *stored, const void *map, uint32_t n, size_t texel_bytes) {
  const int32_t size = (int32_t)n;
  for (int32_t y = -1; y <= size; y++) {
    for (int32_t x = -1; x <= size; x++) {
      int32_t source_x, source_y;
      olx_border_source(x, y, size, &source_x, &source_y);
      uint32_t expected = 0;
      memcpy(&expected, (const char *)map + ((size_t)source_y * n + (size_t)source_x) * texel_bytes, texel_bytes);
      assert_int_equal(bordered(stored, n, texel_bytes, x, y), expected);
    }
  }
}

static void assert_classic(const olx_field *field, const olx_field_header *header) {
  const olx_classic_maps *maps = &field->classic;
  const uint32_t size = header->info.classic_size;
  assert_int_equal(maps->size, size);
  assert_int_equal(field->info.classic_size, size);
  if (size == 0) {
    assert_int_equal(field->info.classic_bytes, 0);
    return;
  }
  assert_int_equal(field->info.classic_cube_size, header->info.classic_cube_size);
  assert_true(field->info.classic_sharpness == header->info.classic_sharpness);
  assert_memory_equal(maps->table, header->classic_table, 4 * OLX_CLASSIC_TABLE_ENTRIES);
  synthetic_classic *expected = olx_allocate(1, sizeof *expected);
  for (uint32_t i = 0; i < header->info.irradiance_probe_count; i++) {
    const olx_classic_record record = synthetic_classic_maps(size, i, header->irradiance_positions[i], expected);
    assert_map(maps->irradiance + maps->irradiance_texels * i, record.irradiance, size, 4);
    for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
      const uint32_t *stored = maps->radiance + maps->radiance_texels * i + maps->level_first[level];
      assert_map(stored, record.radiance[level], olx_classic_side(size, level), 4);
    }
    assert_memory_equal(&maps->boxes[i], &record.box, sizeof record.box);
  }
  olx_release(expected);
}

static void assert_relight(const olx_field *field, const synthetic_shape *shape) {
  const olx_relight_maps *maps = &field->relight;
  const uint32_t size = shape->relight_size, n = shape->n;
  assert_int_equal(maps->size, size);
  assert_int_equal(field->info.relight_size, size);
  if (size == 0) {
    assert_int_equal(field->info.relight_bytes, 0);
    return;
  }
  const size_t words = shape->relight_points * (4 + (size_t)shape->relight_rays);
  olx_surface_sample *surfaces = olx_allocate((size_t)size * size, sizeof *surfaces);
  uint32_t *fit = olx_allocate(words, 4), *albedo = olx_allocate((size_t)n * n, 4);
  for (uint32_t i = 0; i < field->info.irradiance_probe_count; i++) {
    synthetic_surfaces(shape, i, surfaces, fit);
    assert_memory_equal(maps->surfaces + (size_t)size * size * i, surfaces, (size_t)size * size * sizeof *surfaces);
    if (words) assert_memory_equal(maps->fit + words * i, fit, 4 * words);
  }
  for (uint32_t i = 0; i < field->info.probe_count; i++) {
    synthetic_albedo(n, i, albedo);
    assert_map(maps->albedo + field->texels * i, albedo, n, 4);
  }
  const uint64_t probes = field->info.irradiance_probe_count;
  assert_int_equal(field->info.relight_bytes,
                   64 + 4 * field->texels * field->info.probe_count + probes * (8ull * size * size + 4 * words));
  olx_release(surfaces);
  olx_release(fit);
  olx_release(albedo);
}

static void assert_round_trip(fixture *f, const synthetic_shape *shape) {
  olx_field *field;
  size_t size_bytes;
  olx_release(written(f, shape, &size_bytes));
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);

  olx_field_header header = synthetic_header(shape);
  const uint32_t n = shape->n, m = shape->irradiance_n;
  uint32_t *color = olx_allocate(256 * 256, 4), *moments = olx_allocate(256 * 256, 4);
  uint16_t *normal = olx_allocate(256 * 256, 2), *distance = olx_allocate(256 * 256, 2);
  for (uint32_t i = 0; i < header.info.probe_count; i++) {
    synthetic_light_maps(n, i, color, normal, distance);
    assert_map(field->radiance + field->texels * i, color, n, 4);
    assert_map(field->normal + field->texels * i, normal, n, 2);
    assert_map(field->distance + field->texels * i, distance, n, 2);
    for (uint32_t y = 0; y < n; y++) {
      for (uint32_t x = 0; x < n; x++) {
        const olx_pyramid_shape *pyramid = &field->pyramid;
        for (uint32_t level = 0; level < pyramid->levels; level++) {
          const uint32_t shift = olx_pyramid_shift(level);
          const uint32_t node = pyramid->first[level] + olx_pyramid_index(pyramid->side[level], x >> shift, y >> shift);
          const uint16_t code = distance[y * n + x] & 0x7FFF;
          assert_true(field->least[(size_t)pyramid->least_nodes * i + node] <= code);
          if (level < pyramid->greatest_level) continue;
          assert_true(field->greatest[(size_t)pyramid->greatest_nodes * i + node] >= code);
        }
      }
    }
    const olx_vec3 position = olx_field_probe_position(field, i);
    assert_memory_equal(&position, &header.probe_positions[i], sizeof position);
    assert_int_equal(olx_field_probe_buried(field, i), synthetic_flags(i));
  }
  for (uint32_t i = 0; i < header.info.irradiance_probe_count; i++) {
    synthetic_irradiance_maps(m, i, color, moments);
    assert_map(field->irradiance + field->irradiance_texels * i, color, m, 4);
    assert_map(field->moments + field->irradiance_texels * i, moments, m, 4);
    assert_memory_equal(&field->irradiance_positions[i], &header.irradiance_positions[i], sizeof(olx_vec3));
    assert_int_equal(field->irradiance_flags[i], synthetic_flags(i));
  }
  assert_classic(field, &header);
  assert_relight(field, shape);
  olx_release(color);
  olx_release(moments);
  olx_release(normal);
  olx_release(distance);
  synthetic_header_release(&header);
  olx_field_close(field);
}

static void test_round_trip(void **state) {
  assert_round_trip(*state, &classic);
  assert_round_trip(*state, &relit);
  assert_round_trip(*state, &unfitted);
  assert_round_trip(*state, &small);
  assert_round_trip(*state, &single);
  assert_round_trip(*state, &least);
}

// One near and one far texel, the near one marked as an emitter, change the nodes that hold them and no others.
static void test_pyramids_bound_their_nodes(void **state) {
  (void)state;
  for (uint32_t n = 8; n <= 2048; n *= 2) {
    const olx_pyramid_shape shape = olx_pyramid_shape_of(n);
    const uint32_t near_x = n - 1, near_y = n / 2, far_x = n / 2 - 1, far_y = 3;
    uint16_t *distance = olx_allocate((size_t)n * n, 2), *nearest = olx_allocate(shape.least_nodes, 2),
             *farthest = olx_allocate(shape.greatest_nodes, 2);
    for (size_t i = 0; i < (size_t)n * n; i++) distance[i] = 0x3400;
    distance[near_y * n + near_x] = 0x8000 | 0x3000;
    distance[far_y * n + far_x] = 0x7C00;
    olx_pyramid_make(&shape, distance, n, nearest, farthest);
    uint32_t nodes = 0;
    for (uint32_t level = 0; level < shape.levels; level++) {
      const uint32_t side = shape.side[level], shift = olx_pyramid_shift(level);
      assert_int_equal(side << shift, n);
      for (uint32_t y = 0; y < side; y++) {
        for (uint32_t x = 0; x < side; x++, nodes++) {
          const uint32_t at = shape.first[level] + olx_pyramid_index(side, x, y);
          const bool near = x == near_x >> shift && y == near_y >> shift,
                     far = x == far_x >> shift && y == far_y >> shift;
          assert_int_equal(nearest[at], near ? 0x3000 : 0x3400);
          if (level >= shape.greatest_level) assert_int_equal(farthest[at], far ? 0x7C00 : 0x3400);
        }
      }
    }
    assert_int_equal(nodes, shape.least_nodes);
    olx_release(distance);
    olx_release(nearest);
    olx_release(farthest);
  }
}

static void test_describes(void **state) {
  fixture *f = *state;
  size_t size_bytes;
  olx_release(written(f, &small, &size_bytes));
  olx_field *field;
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  const olx_field_info info = olx_field_describe(field);
  assert_int_equal(info.probe_count, 12);
  assert_int_equal(info.irradiance_probe_count, 6);
  assert_int_equal(info.buried_count, 4);
  assert_int_equal(info.irradiance_buried_count, 2);
  assert_true(info.has_grid);
  assert_int_equal(info.grid.count[0], 3);
  assert_int_equal(info.grid.count[1], 2);
  assert_int_equal(info.grid.count[2], 2);
  assert_true(info.grid.origin.x == -1.0f && info.grid.origin.y == 0.25f && info.grid.origin.z == -0.5f);
  assert_true(info.grid.spacing.x == 1.0f && info.grid.spacing.y == 1.0f && info.grid.spacing.z == 1.0f);
  assert_int_equal(info.irradiance_grid.count[2], 3);
  assert_true(info.irradiance_grid.spacing.y == 0.0f);
  assert_int_equal(info.radiance_size, 16);
  assert_int_equal(info.irradiance_size, 8);
  assert_int_equal(info.select_mask, 1);
  assert_true(info.distance_scale_metres == 12.5f);
  assert_true(info.scene_min.z == -4.5f && info.scene_max.y == 3.0f);
  assert_int_equal(info.bounces, 3);
  assert_int_equal(info.samples, 2);
  assert_true(info.scene_hash == 0x0123456789ABCDEFu);
  assert_int_equal(info.file_bytes, size_bytes);
  assert_int_equal(info.radiance_bytes, 12 * 18 * 18 * 4);
  assert_int_equal(info.normal_bytes, 12 * 18 * 18 * 2);
  assert_int_equal(info.distance_bytes, 12 * 18 * 18 * 2);
  assert_int_equal(info.pyramid_bytes, 12 * 4 * 4 * 2 * 2);
  assert_int_equal(info.irradiance_bytes, 6 * 10 * 10 * 4);
  assert_int_equal(info.moments_bytes, 6 * 10 * 10 * 4);
  assert_int_equal(info.selector_bytes, 0);
  olx_field_close(field);
}

static void test_same_input_same_bytes(void **state) {
  size_t first_size, second_size;
  unsigned char *first = written(*state, &small, &first_size), *second = written(*state, &small, &second_size);
  assert_int_equal(first_size, second_size);
  assert_memory_equal(first, second, first_size);
  olx_release(first);
  olx_release(second);
}

static void test_two_fields_at_once(void **state) {
  fixture *f = *state;
  size_t size_bytes;
  unsigned char *bytes = written(f, &single, &size_bytes);
  olx_field *in_memory, *mapped;
  assert_int_equal(olx_field_open_memory(bytes, size_bytes, &in_memory), OLX_OK);
  assert_int_equal(synthetic_write(f->path, &small, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &mapped), OLX_OK);
  assert_int_equal(olx_field_describe(in_memory).radiance_size, 128);
  assert_int_equal(olx_field_describe(mapped).radiance_size, 16);
  // The mapping outlives the file's name.
  assert_int_equal(synthetic_write(f->path, &least, NULL), OLX_OK);
  assert_int_equal(olx_field_verify(mapped), OLX_OK);
  assert_int_equal(olx_field_verify(in_memory), OLX_OK);
  olx_field_close(in_memory);
  olx_field_close(mapped);
  olx_field_close(NULL);
  olx_release(bytes);
}

// --- Refusals

typedef struct image {
  unsigned char *bytes;
  size_t size_bytes;
  olx_file_header *header;
  olx_file_chunk *chunks;
  olx_file_info *info;
  uint32_t sealed; // chunks that the file was written with
} image;

static image load(fixture *f, const synthetic_shape *shape) {
  image i;
  i.bytes = written(f, shape, &i.size_bytes);
  i.header = (olx_file_header *)i.bytes;
  i.chunks = (olx_file_chunk *)(i.bytes + sizeof(olx_file_header));
  i.info = (olx_file_info *)(i.bytes + i.chunks[OLX_CHUNK_INFO].offset);
  i.sealed = i.header->chunk_count;
  return i;
}

static void *chunk_data(const image *i, olx_chunk_kind kind) { return i->bytes + i->chunks[kind].offset; }

// Make every checksum right again.
static void seal(const image *i) {
  for (uint32_t k = 0; k < i->sealed; k++) {
    i->chunks[k].hash = olx_content_hash(i->bytes + i->chunks[k].offset, i->chunks[k].size_bytes);
  }
  i->header->table_hash = olx_content_hash(i->chunks, i->sealed * sizeof(olx_file_chunk));
  i->header->header_hash = olx_content_hash(i->header, 56);
}
static void seal_table(const image *i) {
  i->header->table_hash = olx_content_hash(i->chunks, i->header->chunk_count * sizeof(olx_file_chunk));
  i->header->header_hash = olx_content_hash(i->header, 56);
}

static void assert_says(const char *expected) {
  if (!strstr(olx_last_error(), expected)) fail_msg("\"%s\" is not in \"%s\"", expected, olx_last_error());
}

static void assert_refused(const image *i, olx_result expected, const char *message) {
  olx_field *field = (olx_field *)(uintptr_t)1;
  const olx_result result = olx_field_open_memory(i->bytes, i->size_bytes, &field);
  if (result != expected) fail_msg("result %d, not %d: %s", (int)result, (int)expected, olx_last_error());
  assert_null(field);
  assert_says(message);
  assert_says("field in memory: ");
}

static void assert_unverified(const image *i, olx_result expected, const char *message) {
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i->bytes, i->size_bytes, &field), OLX_OK);
  const olx_result result = olx_field_verify(field);
  if (result != expected) fail_msg("result %d, not %d: %s", (int)result, (int)expected, olx_last_error());
  assert_says(message);
  olx_field_close(field);
}

static void test_refuses_a_wrong_header(void **state) {
  image i = load(*state, &small);
  const olx_file_header good = *i.header;
  const size_t size_bytes = i.size_bytes;

  i.size_bytes = 0;
  assert_refused(&i, OLX_ERROR_FORMAT, "too short");
  i.size_bytes = 63;
  assert_refused(&i, OLX_ERROR_FORMAT, "too short");
  i.size_bytes = 64;
  assert_refused(&i, OLX_ERROR_FORMAT, "truncated");
  i.size_bytes = size_bytes - 1;
  assert_refused(&i, OLX_ERROR_FORMAT, "truncated");
  i.size_bytes = size_bytes;

  i.header->magic[1] = 'o';
  assert_refused(&i, OLX_ERROR_FORMAT, "wrong magic");
  *i.header = good;
  i.header->version = 0;
  assert_refused(&i, OLX_ERROR_VERSION, "version 0 is older");
  i.header->version = 2;
  assert_refused(&i, OLX_ERROR_VERSION, "version 2 is newer");
  *i.header = good;
  i.header->chunk_count++;
  assert_refused(&i, OLX_ERROR_CHECKSUM, "header: wrong checksum");
  *i.header = good;
  i.header->file_bytes -= 64;
  seal(&i);
  assert_refused(&i, OLX_ERROR_FORMAT, "too long");
  *i.header = good;
  i.header->zero[2] = 1;
  seal(&i);
  assert_refused(&i, OLX_ERROR_FORMAT, "header: reserved bytes");
  *i.header = good;
  for (uint32_t wrong = 0; wrong <= 257; wrong += 257) {
    i.header->chunk_count = wrong;
    seal(&i);
    assert_refused(&i, OLX_ERROR_FORMAT, "chunks are not in 1..256");
  }
  // A header that is right about its size, but the size holds no table.
  *i.header = good;
  i.header->file_bytes = i.size_bytes = 128;
  i.header->header_hash = olx_content_hash(i.header, 56);
  assert_refused(&i, OLX_ERROR_FORMAT, "truncated inside the chunk table");
  i.size_bytes = size_bytes;
  *i.header = good;
  i.chunks[3].size_bytes ^= 1;
  assert_refused(&i, OLX_ERROR_CHECKSUM, "chunk table: wrong checksum");
  i.chunks[3].size_bytes ^= 1;

  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes + 1, i.size_bytes - 1, &field), OLX_ERROR_ARGUMENT);
  assert_says("not aligned");
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  olx_field_close(field);
  olx_release(i.bytes);
}

static void test_refuses_a_wrong_chunk_table(void **state) {
  image i = load(*state, &small);
  olx_file_chunk good[OLX_CHUNK_REQUIRED];
  memcpy(good, i.chunks, sizeof good);
  olx_file_chunk *normal = &i.chunks[OLX_CHUNK_NORMAL];
#define REFUSED(result, message)                                                                                       \
  seal_table(&i);                                                                                                      \
  assert_refused(&i, result, message);                                                                                 \
  memcpy(i.chunks, good, sizeof good)
  normal->flags = 2;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): unknown flags");
  normal->zero_a = 1;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): unknown flags or reserved");
  normal->zero_b[1] = 1;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): unknown flags or reserved");
  normal->flags = OLX_CHUNK_OPTIONAL;
  REFUSED(OLX_ERROR_FORMAT, "chunk NORM: flagged optional");
  normal->offset += 64;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): begins at byte");
  normal->offset -= 64; // overlaps the one before
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): begins at byte");
  normal->offset += 4;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): begins at byte");
  normal->size_bytes = UINT64_MAX;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): 18446744073709551615 bytes");
  normal->size_bytes = UINT64_MAX - normal->offset; // the sum does not overflow, its padding would
  REFUSED(OLX_ERROR_FORMAT, "reach beyond the end of the file");
  i.chunks[OLX_CHUNK_MOMENTS].size_bytes -= 64;
  REFUSED(OLX_ERROR_FORMAT, "bytes after the last chunk");
  normal->size_bytes -= 1; // still the same place for the next chunk
  REFUSED(OLX_ERROR_FORMAT, "chunk NORM: 7775 bytes");
  normal->record_bytes -= 1;
  REFUSED(OLX_ERROR_FORMAT, "chunk NORM: 7776 bytes in records of 647");
  normal->element_bytes = 4;
  REFUSED(OLX_ERROR_FORMAT, "elements of 4");
  normal->type = OLX_FOUR_CC('N', 'E', 'W', 1);
  REFUSED(OLX_ERROR_FORMAT, "no chunk NORM");
  normal->type = i.chunks[OLX_CHUNK_DISTANCE].type;
  REFUSED(OLX_ERROR_FORMAT, "no chunk NORM");
  i.chunks[OLX_CHUNK_INFO].type = 0;
  REFUSED(OLX_ERROR_FORMAT, "no chunk INFO");
  i.chunks[OLX_CHUNK_NORMAL].type = i.chunks[OLX_CHUNK_INFO].type;
  REFUSED(OLX_ERROR_FORMAT, "two chunks INFO");
  i.chunks[OLX_CHUNK_INFO].hash ^= 1;
  REFUSED(OLX_ERROR_CHECKSUM, "chunk INFO: wrong checksum");
  i.chunks[OLX_CHUNK_INFO].size_bytes = 129;
  REFUSED(OLX_ERROR_FORMAT, "chunk INFO: 129 bytes, not 160");
  // A padding that would end behind the file: the last chunk, and the file cut inside its padding.
  i.header->file_bytes -= 32;
  i.size_bytes -= 32;
  REFUSED(OLX_ERROR_FORMAT, "its padding reaches beyond");
#undef REFUSED
  olx_release(i.bytes);
}

// The same file with one more chunk at the end of the table.
static image with_chunk(const image *from, uint32_t type, uint32_t flags) {
  const size_t old_table = OLX_CHUNK_REQUIRED * sizeof(olx_file_chunk), head = 64 + old_table;
  image i = {.size_bytes = from->size_bytes + 64 + 64};
  i.bytes = olx_allocate_zero(i.size_bytes, 1);
  memcpy(i.bytes, from->bytes, head);
  memcpy(i.bytes + head + 64, from->bytes + head, from->size_bytes - head);
  i.header = (olx_file_header *)i.bytes;
  i.chunks = (olx_file_chunk *)(i.bytes + 64);
  i.header->chunk_count++;
  i.header->file_bytes = i.size_bytes;
  for (uint32_t k = 0; k < OLX_CHUNK_REQUIRED; k++) i.chunks[k].offset += 64;
  memcpy(i.bytes + i.size_bytes - 64, "something new", 13);
  i.chunks[OLX_CHUNK_REQUIRED] = (olx_file_chunk){.type = type,
                                                  .flags = flags,
                                                  .offset = i.size_bytes - 64,
                                                  .size_bytes = 13,
                                                  .record_bytes = 13,
                                                  .element_bytes = 1,
                                                  .hash = olx_content_hash("something new", 13)};
  seal_table(&i);
  return i;
}

static void test_skips_unknown_optional_chunks_only(void **state) {
  const image plain = load(*state, &small);
  const uint32_t type = OLX_FOUR_CC('G', 'L', 'O', 'W');
  image i = with_chunk(&plain, type, 0);
  assert_refused(&i, OLX_ERROR_UNSUPPORTED, "chunk 12 (GLOW) is required");
  olx_release(i.bytes);

  i = with_chunk(&plain, type, OLX_CHUNK_OPTIONAL);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);
  olx_field_close(field);
  i.bytes[i.size_bytes - 60] ^= 1;
  assert_unverified(&i, OLX_ERROR_CHECKSUM, "chunk 12 (GLOW): wrong checksum");
  i.bytes[i.size_bytes - 60] ^= 1;
  i.bytes[i.size_bytes - 1] = 1;
  assert_unverified(&i, OLX_ERROR_FORMAT, "chunk 12 (GLOW): padding");
  olx_release(i.bytes);

  i = with_chunk(&plain, plain.chunks[OLX_CHUNK_RADIANCE].type, 0);
  assert_refused(&i, OLX_ERROR_FORMAT, "two chunks RADI");
  olx_release(i.bytes);
  olx_release(plain.bytes);
}

static void test_refuses_a_wrong_description(void **state) {
  const image i = load(*state, &small);
  const olx_file_info good = *i.info;
#define REFUSED(change, message)                                                                                       \
  i.info->change;                                                                                                      \
  seal(&i);                                                                                                            \
  assert_refused(&i, OLX_ERROR_FORMAT, message);                                                                       \
  *i.info = good
  REFUSED(radiance_size = 4, "radiance size 4 is not");
  REFUSED(radiance_size = 24, "radiance size 24 is not");
  REFUSED(radiance_size = 4096, "radiance size 4096 is not");
  REFUSED(radiance_size = 0, "radiance size 0 is not");
  REFUSED(radiance_size = 32, "chunk RADI: ");
  REFUSED(irradiance_size = 512, "irradiance size 512 is not");
  REFUSED(irradiance_size = 16, "chunk IRRA: ");
  REFUSED(probe_count = 0, "no light field probes");
  REFUSED(irradiance_probe_count = 0, "no irradiance probes");
  REFUSED(probe_count = UINT32_MAX, "light field grid: 3 x 2 x 2 is not the number of probes");
  REFUSED(buried_count = 13, "more probes are buried than there are");
  REFUSED(irradiance_buried_count = UINT32_MAX, "more probes are buried than there are");
  REFUSED(buried_count = 5, "4 light field probes are flagged as buried where the description says 5");
  REFUSED(irradiance_buried_count = 1, "2 irradiance probes are flagged as buried");
  REFUSED(samples = 0, "samples 0");
  REFUSED(distance_scale = 0.0f, "distance scale 0");
  REFUSED(distance_scale = -1.0f, "distance scale -1");
  REFUSED(distance_scale = NAN, "distance scale");
  REFUSED(distance_scale = INFINITY, "distance scale inf");
  REFUSED(distance_scale = 1e-40f, "distance scale");
  REFUSED(scene_min[0] = 5.0f, "are not a box");
  REFUSED(scene_max[2] = NAN, "are not a box");
  REFUSED(scene_min[1] = -INFINITY, "are not a box");
  REFUSED(scene_max[1] = 1e30f, "are not a box");
  REFUSED(grid.count[0] = 0, "light field grid: count 0 along x");
  REFUSED(grid.count[1] = 1u << 31, "light field grid: count 2147483648 along y");
  REFUSED(grid.count[2] = 3, "light field grid: 3 x 2 x 3 is not the number of probes, 12");
  REFUSED(grid.spacing[1] = 0.0f, "light field grid: spacing 0 along y");
  REFUSED(grid.spacing[1] = -1.0f, "light field grid: spacing -1 along y");
  REFUSED(grid.spacing[2] = NAN, "spacing");
  REFUSED(grid.origin[0] = NAN, "light field grid: origin");
  REFUSED(grid.origin[0] = 7.0f, "light field probe 0 stands at");
  REFUSED(grid.spacing[2] = 1.5f, "light field probe 6 stands at");
  REFUSED(irradiance_grid.spacing[1] = 1.0f, "irradiance grid: spacing 1 along y");
  REFUSED(irradiance_grid.count[0] = 3, "irradiance grid: 3 x 1 x 3 is not the number of probes, 6");
  REFUSED(has_grid = 2, "grid flag");
  REFUSED(has_grid = 0, "the cage selector needs light field probes on a grid");
  REFUSED(zero_a = 16, "reserved bytes");
  REFUSED(zero_b = 1, "reserved bytes");
#undef REFUSED
  i.info->select_mask = 1u << OLX_SELECT_BRICKS; // whose chunk is missing
  seal(&i);
  assert_refused(&i, OLX_ERROR_FORMAT, "no chunk BRIK, but the description names its selector");
  *i.info = good;
  i.info->select_mask = 1u << 31 | 1u; // a later selector beside one that is known
  seal(&i);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  olx_field_close(field);
  *i.info = good;

  float *position = chunk_data(&i, OLX_CHUNK_PROBE_POSITIONS);
  position[3 * 7 + 2] = NAN;
  seal(&i);
  assert_refused(&i, OLX_ERROR_FORMAT, "position of light field probe 7 is out of range");
  position[3 * 7 + 2] = 1.0f;
  seal(&i);
  assert_refused(&i, OLX_ERROR_FORMAT, "light field probe 7 stands at");
  olx_release(i.bytes);
}

static void test_verify_sees_every_flipped_bit(void **state) {
  const image i = load(*state, &small);
  size_t at = 0, seen_open = 0, seen_verify = 0;
  for (uint32_t step = 0; at < i.size_bytes; at += step < 1000 ? 1 : 37, step++) {
    i.bytes[at] ^= (unsigned char)(1u << at % 8);
    olx_field *field;
    olx_result result = olx_field_open_memory(i.bytes, i.size_bytes, &field);
    if (result != OLX_OK) {
      seen_open++;
    } else {
      result = olx_field_verify(field);
      seen_verify++;
      olx_field_close(field);
    }
    if (result == OLX_OK) fail_msg("byte %zu may change", at);
    i.bytes[at] ^= (unsigned char)(1u << at % 8);
  }
  assert_true(seen_open > 900 && seen_verify > 900);
  // Every chunk, and the padding after each.
  for (uint32_t k = 0; k < OLX_CHUNK_REQUIRED; k++) {
    const olx_file_chunk *chunk = &i.chunks[k];
    if (k != OLX_CHUNK_INFO) { // whose checksum is looked at on opening
      char message[64];
      snprintf(message, sizeof message, "chunk %u (%s): wrong checksum", k, olx_chunk_type_name(chunk->type).text);
      i.bytes[chunk->offset] ^= 4;
      assert_unverified(&i, OLX_ERROR_CHECKSUM, message);
      i.bytes[chunk->offset] ^= 4;
    }
    if (chunk->size_bytes % 64 == 0) continue;
    i.bytes[chunk->offset + chunk->size_bytes] = 0x10;
    assert_unverified(&i, OLX_ERROR_FORMAT, "padding at byte");
    i.bytes[chunk->offset + chunk->size_bytes] = 0;
  }
  olx_release(i.bytes);
}

static void test_verify_reads_the_content(void **state) {
  const image i = load(*state, &small);
  const size_t texels = 18 * 18, inner = 5 * 18 + 7; // texel (6, 4)
#define REFUSED(kind, type, index, value, message)                                                                     \
  do {                                                                                                                 \
    type *codes = chunk_data(&i, kind);                                                                                \
    const type good = codes[index];                                                                                    \
    codes[index] = (type)(value);                                                                                      \
    seal(&i);                                                                                                          \
    assert_unverified(&i, OLX_ERROR_FORMAT, message);                                                                  \
    codes[index] = good;                                                                                               \
  } while (0)
  REFUSED(OLX_CHUNK_RADIANCE, uint32_t, 3 * texels + inner, 0x7C0, "radiance of probe 3, texel (6, 4): not a finite");
  REFUSED(OLX_CHUNK_RADIANCE, uint32_t, inner, 0x3F << 16, "radiance of probe 0, texel (6, 4): not a finite");
  REFUSED(OLX_CHUNK_RADIANCE, uint32_t, 11 * texels + inner, 0xF8000001, "radiance of probe 11, texel (6, 4): not a");
  REFUSED(OLX_CHUNK_NORMAL, uint16_t, texels + inner, 0xFF, "normal of probe 1, texel (6, 4)");
  REFUSED(OLX_CHUNK_NORMAL, uint16_t, texels + inner, 0xFF00, "normal of probe 1, texel (6, 4)");
  REFUSED(OLX_CHUNK_DISTANCE, uint16_t, 2 * texels + inner, 0x7E00, "distance of probe 2, texel (6, 4): NaN");
  REFUSED(OLX_CHUNK_DISTANCE, uint16_t, 2 * texels + inner, 0xFC01, "distance of probe 2, texel (6, 4): NaN");
  REFUSED(OLX_CHUNK_DISTANCE, uint16_t, 2 * texels + inner, 0xFC00, "distance of probe 2, texel (6, 4): NaN");
  REFUSED(OLX_CHUNK_DISTANCE, uint16_t, 2 * texels + inner, 0x0001, "least distance of probe 2, level 0, node (1, 1)");
  REFUSED(OLX_CHUNK_LEAST, uint16_t, 16 * 4 + 5, 0x0001, "least distance of probe 4, level 0, node (1, 1)");
  REFUSED(OLX_CHUNK_GREATEST, uint16_t, 16 * 4 + 6, 0x7C01, "greatest distance of probe 4, level 0, node (2, 1)");
  REFUSED(OLX_CHUNK_RADIANCE, uint32_t, 0, 0, "radiance of probe 0: border texel (-1, -1) differs from texel (15, 15)");
  REFUSED(OLX_CHUNK_NORMAL, uint16_t, texels - 1, 0, "border texel (16, 16) differs from texel (0, 0)");
  REFUSED(OLX_CHUNK_DISTANCE, uint16_t, 18 * 3, 0x7BFF, "border texel (-1, 2) differs from texel (0, 13)");
  REFUSED(OLX_CHUNK_IRRADIANCE, uint32_t, 100 + 45, 0xF8000000, "irradiance of probe 1, texel (4, 3): not a finite");
  REFUSED(OLX_CHUNK_IRRADIANCE, uint32_t, 3, 1,
          "irradiance of probe 0: border texel (2, -1) differs from texel (5, 0)");
#define MOMENTS(mean, square) ((uint32_t)(mean) | (uint32_t)(square) << 16)
  const char *impossible = "moments of probe 0, texel (4, 3): impossible moments";
  REFUSED(OLX_CHUNK_MOMENTS, uint32_t, 45, MOMENTS(0x7C00, 0x3C00), impossible);     // infinite mean
  REFUSED(OLX_CHUNK_MOMENTS, uint32_t, 45, MOMENTS(0x3C00, 0x7E00), impossible);     // NaN
  REFUSED(OLX_CHUNK_MOMENTS, uint32_t, 45, MOMENTS(0xB000, 0x3C00), impossible);     // negative mean
  REFUSED(OLX_CHUNK_MOMENTS, uint32_t, 45, MOMENTS(0x3C20, 0x3C40), impossible);     // mean 1.03
  REFUSED(OLX_CHUNK_MOMENTS, uint32_t, 45, MOMENTS(0x3800, 0x3400 - 4), impossible); // 0.5^2 > 0.2490
  REFUSED(OLX_CHUNK_MOMENTS, uint32_t, 0, MOMENTS(0x3C00, 0x3C00), "moments of probe 0: border texel (-1, -1)");
  REFUSED(OLX_CHUNK_PROBE_FLAGS, uint8_t, 5, 0x40, "flags of light field probe 5: unknown bits");
  REFUSED(OLX_CHUNK_IRRADIANCE_FLAGS, uint8_t, 1, 0x81, "flags of irradiance probe 1: unknown bits");
#undef REFUSED
  seal(&i);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);
  olx_field_close(field);
  olx_release(i.bytes);
}

// The half that rounding a mean up and a second moment down leaves is no error: every mean with its own square passes.
static void test_rounded_moments_are_possible(void **state) {
  const image i = load(*state, &least);
  uint32_t *moments = chunk_data(&i, OLX_CHUNK_MOMENTS);
  for (uint32_t pass = 0; pass < 2000; pass++) {
    const float mean = (float)(pass + 1) / 2000.0f;
    for (uint32_t t = 0; t < 100; t++) {
      moments[t] = olx_half_pack(mean) | (uint32_t)olx_half_pack(mean * mean) << 16;
    }
    i.chunks[OLX_CHUNK_MOMENTS].hash = olx_content_hash(moments, 400);
    seal_table(&i);
    olx_field *field;
    assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
    if (olx_field_verify(field) != OLX_OK) fail_msg("mean %g: %s", (double)mean, olx_last_error());
    olx_field_close(field);
  }
  olx_release(i.bytes);
}

static void test_opening_names_the_file(void **state) {
  const fixture *f = *state;
  olx_field *field;
  assert_int_equal(olx_field_open(f->path, &field), OLX_ERROR_FILE);
  assert_null(field);
  assert_says(f->path);
  assert_int_equal(olx_field_open(f->folder, &field), OLX_ERROR_FILE);
  assert_int_equal(olx_write_file(f->path, "", 0), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_ERROR_FORMAT);
  assert_says(f->path);
  assert_int_equal(olx_write_file(f->path, "#?RADIANCE\n", 11), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_ERROR_FORMAT);
}

// --- Classic maps: chunks after the required ones, since the field has no selector but the cage

enum { CLAS = OLX_CHUNK_REQUIRED, CIRR, CRAD, CBOX };

static void test_refuses_wrong_classic_maps(void **state) {
  const image i = load(*state, &classic);
  olx_classic_header *header = (olx_classic_header *)(i.bytes + i.chunks[CLAS].offset);
#define REFUSED(place, value, message)                                                                                 \
  do {                                                                                                                 \
    __typeof__(place) *at = &(place), good = *at;                                                                      \
    *at = (value);                                                                                                     \
    seal(&i);                                                                                                          \
    assert_refused(&i, OLX_ERROR_FORMAT, message);                                                                     \
    *at = good;                                                                                                        \
  } while (0)
  REFUSED(header->size, 16, "classic size 16 is not a power of two in 32..256");
  REFUSED(header->size, 48, "classic size 48");
  REFUSED(header->size, 512, "classic size 512");
  REFUSED(header->size, 0, "classic size 0");
  REFUSED(header->size, 128, "chunk CIRR: 104544 bytes in records of 17424"); // the maps are those of 64
  REFUSED(header->cube_size, 2048, "cube maps of 2048 texels");
  REFUSED(header->sharpness, NAN, "classic sharpness nan");
  REFUSED(header->sharpness, 1.0f, "classic sharpness 1");
  REFUSED(header->levels, 6, "chunk CLAS: 6 levels");
  REFUSED(header->table_side, 65, "a table of 65 entries");
  REFUSED(header->zero[10], 1, "or reserved bytes");
  float *box = (float *)(i.bytes + i.chunks[CBOX].offset);
  REFUSED(box[6 * 3 + 1], 9.0f, "is not around probe 3");
  REFUSED(box[6 * 2 + 3], NAN, "is not around probe 2");
  REFUSED(box[6 * 5 + 5], INFINITY, "is not around probe 5");
  REFUSED(box[0], -2e18f, "is not around probe 0");
  const uint32_t strange = OLX_FOUR_CC('c', 'r', 'a', 'd');
  REFUSED(i.chunks[CRAD].type, strange, "no chunk CRAD, but a chunk CLAS");
  REFUSED(i.chunks[CBOX].type, i.chunks[CIRR].type, "two chunks CIRR");
  REFUSED(i.chunks[CLAS].type, strange, "a chunk CIRR, but no chunk CLAS");
  REFUSED(i.chunks[CIRR].record_bytes, 64, "chunk CIRR");
#undef REFUSED
  seal(&i);
  i.chunks[CRAD].flags = 0;
  seal(&i);
  assert_refused(&i, OLX_ERROR_UNSUPPORTED, "(CRAD) is required");
  i.chunks[CRAD].flags = OLX_CHUNK_OPTIONAL;
  seal(&i);
  header->table[7] ^= 1;
  assert_refused(&i, OLX_ERROR_CHECKSUM, "chunk CLAS: wrong checksum");
  olx_release(i.bytes);
}

static void test_verify_reads_classic_maps(void **state) {
  const image i = load(*state, &classic);
  const size_t texels = 66 * 66, record = olx_classic_first(64, OLX_CLASSIC_LEVELS);
#define REFUSED(chunk, index, value, message)                                                                          \
  do {                                                                                                                 \
    uint32_t *codes = (uint32_t *)(i.bytes + i.chunks[chunk].offset), good = codes[index];                             \
    codes[index] = (value);                                                                                            \
    seal(&i);                                                                                                          \
    assert_unverified(&i, OLX_ERROR_FORMAT, message);                                                                  \
    codes[index] = good;                                                                                               \
  } while (0)
  REFUSED(CIRR, 2 * texels + 70, 0x7C0, "classic irradiance of probe 2, texel (3, 0): not a finite");
  REFUSED(CIRR, 0, 3, "classic irradiance of probe 0: border texel (-1, -1) differs");
  REFUSED(CRAD, record + 70, 0xF8000000, "classic radiance of probe 1, texel (3, 0): not a finite");
  REFUSED(CRAD, olx_classic_first(64, 4), 3, "classic radiance of probe 0: border texel (-1, -1) differs");
  REFUSED(CLAS, 16 + 99, 0x7C00, "entry 99 of the table: impossible");
  REFUSED(CLAS, 16, 0x7E000000, "entry 0 of the table: impossible");
  REFUSED(CLAS, 16 + 4095, 0x80000000, "entry 4095 of the table: impossible");
  REFUSED(CLAS, 16 + 1, 0x40004000, "entry 1 of the table: impossible");
#undef REFUSED
  seal(&i);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);
  olx_field_close(field);
  olx_release(i.bytes);
}

// --- What relighting needs

enum { RLIT = OLX_CHUNK_REQUIRED, ALBE, SURF, FITP };

static void test_refuses_wrong_relight_chunks(void **state) {
  const image i = load(*state, &relit);
  olx_relight_header *header = (olx_relight_header *)(i.bytes + i.chunks[RLIT].offset);
#define REFUSED(place, value, message)                                                                                 \
  do {                                                                                                                 \
    __typeof__(place) *at = &(place), good = *at;                                                                      \
    *at = (value);                                                                                                     \
    seal(&i);                                                                                                          \
    assert_refused(&i, OLX_ERROR_FORMAT, message);                                                                     \
    *at = good;                                                                                                        \
  } while (0)
  REFUSED(header->size, 8, "8 surfaces along a side are not 16, 32, 64 or 128");
  REFUSED(header->size, 0, "0 surfaces");
  REFUSED(header->size, 256, "256 surfaces");
  REFUSED(header->size, 32, "chunk SURF: 12288 bytes in records of 2048"); // the maps are those of 16
  REFUSED(header->points, 0, "0 points of 9 rays");
  REFUSED(header->points, 4097, "4097 points of 9 rays");
  REFUSED(header->points, 6, "chunk FITP: 1560 bytes");
  REFUSED(header->rays, 0, "5 points of 0 rays");
  REFUSED(header->rays, 257, "5 points of 257 rays");
  REFUSED(header->zero[12], 1, "chunk RLIT: reserved bytes");
  const uint32_t strange = OLX_FOUR_CC('s', 'u', 'r', 'f');
  REFUSED(i.chunks[SURF].type, strange, "no chunk SURF, but chunk RLIT speaks of it");
  REFUSED(i.chunks[FITP].type, strange, "no chunk FITP");
  REFUSED(i.chunks[RLIT].type, strange, "a chunk ALBE, but no chunk RLIT");
  REFUSED(i.chunks[ALBE].record_bytes, 64, "chunk ALBE");
#undef REFUSED
  seal(&i);
  header->points ^= 1;
  assert_refused(&i, OLX_ERROR_CHECKSUM, "chunk RLIT: wrong checksum");
  olx_release(i.bytes);
}

static void test_verify_reads_relight_chunks(void **state) {
  const image i = load(*state, &relit);
#define REFUSED(chunk, index, value, message)                                                                          \
  do {                                                                                                                 \
    uint32_t *codes = (uint32_t *)(i.bytes + i.chunks[chunk].offset), good = codes[index];                             \
    codes[index] = (value);                                                                                            \
    seal(&i);                                                                                                          \
    assert_unverified(&i, OLX_ERROR_FORMAT, message);                                                                  \
    codes[index] = good;                                                                                               \
  } while (0)
  REFUSED(ALBE, 18 * 18 + 20, 0x3C1, "albedo of probe 1, texel (1, 0): not in 0..1");
  REFUSED(ALBE, 20, 0x7C0, "albedo of probe 0, texel (1, 0): not in 0..1");
  REFUSED(ALBE, 0, 3, "albedo of probe 0: border texel (-1, -1) differs");
  REFUSED(SURF, 2 * 256, 0x7C0, "surface 0 of probe 1");
  REFUSED(SURF, 2 * 7 + 1, 0x7C0100FF, "surface 7 of probe 0"); // a normal's coordinate beyond 254
  REFUSED(SURF, 2 * 7 + 1, 0x7C010000, "surface 7 of probe 0"); // NaN
  REFUSED(SURF, 2 * 7 + 1, 0x80000000, "surface 7 of probe 0"); // below zero
  REFUSED(FITP, 65 + 0, 0x7FC00000, "point 0 of probe 1");
  REFUSED(FITP, 13 + 3, 0xFFFF, "point 1 of probe 0");
  REFUSED(FITP, 13 * 4 + 3, 0x10000, "point 4 of probe 0");
  REFUSED(FITP, 13 * 4 + 12, 6 * 256, "point 4 of probe 0");
#undef REFUSED
  seal(&i);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);
  olx_field_close(field);
  olx_release(i.bytes);
}

static void test_says_which_option_is_missing(void **state) {
  const fixture *f = *state;
  olx_field *field;
  assert_int_equal(synthetic_write(f->path, &least, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  assert_int_equal(olx_classic_check(field), OLX_ERROR_ARGUMENT);
  assert_says(f->path);
  assert_says("bake --classic");
  olx_field_close(field);
  assert_int_equal(synthetic_write(f->path, &classic, NULL), OLX_OK);
  assert_int_equal(olx_field_open(f->path, &field), OLX_OK);
  assert_int_equal(olx_classic_check(field), OLX_OK);
  olx_relight *relight;
  const olx_relight_settings settings = olx_relight_settings_default();
  assert_int_equal(olx_relight_create(field, &settings, &relight), OLX_ERROR_ARGUMENT);
  assert_null(relight);
  assert_says("bake --relight");
  olx_field_close(field);
}

// --- Writing

static void test_writer_refuses_what_readers_would(void **state) {
  const fixture *f = *state;
  olx_field_header header = synthetic_header(&small);
  const olx_field_info good = header.info;
  olx_field_writer *writer;
#define REFUSED(change, message)                                                                                       \
  header.info.change;                                                                                                  \
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_ERROR_ARGUMENT);                            \
  assert_null(writer);                                                                                                 \
  assert_says(message);                                                                                                \
  header.info = good
  REFUSED(radiance_size = 12, "radiance size 12");
  REFUSED(irradiance_size = 4, "irradiance size 4");
  REFUSED(probe_count = 11, "not the number of probes");
  REFUSED(distance_scale_metres = 0.0f, "distance scale 0");
  REFUSED(grid.spacing.x = 2.0f, "light field probe 1 stands at");
  REFUSED(has_grid = false, "needs light field probes on a grid");
#undef REFUSED
  assert_int_equal(files_in(f->folder), 0);
  synthetic_header_release(&header);
}

static olx_field_writer *begin(const fixture *f, const synthetic_shape *shape) {
  olx_field_header header = synthetic_header(shape);
  olx_field_writer *writer;
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  synthetic_header_release(&header);
  return writer;
}

static void test_writer_keeps_order(void **state) {
  const fixture *f = *state;
  olx_field_writer *writer = begin(f, &small);
  uint32_t radiance[16 * 16], moments[16 * 16];
  uint16_t normal[16 * 16], distance[16 * 16];
  synthetic_light_maps(16, 0, radiance, normal, distance);
  assert_int_equal(olx_field_writer_probe(writer, 1, 0, radiance, normal, distance), OLX_ERROR_ARGUMENT);
  assert_says("light field probe 1 written where 0 comes next");
  assert_int_equal(olx_field_writer_probe(writer, 0, 0, radiance, normal, distance), OLX_OK);
  assert_int_equal(olx_field_writer_probe(writer, 0, 0, radiance, normal, distance), OLX_ERROR_ARGUMENT);
  synthetic_irradiance_maps(8, 0, radiance, moments);
  assert_int_equal(olx_field_writer_irradiance(writer, 3, 0, radiance, moments), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_field_writer_irradiance(writer, 0, 0, radiance, moments), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_ARGUMENT);
  assert_says("1 of 12 light field probes and 1 of 6 irradiance probes");

  synthetic_shape without = classic;
  without.classic_size = 0;
  olx_field_header header = synthetic_header(&classic);
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  synthetic_header_release(&header);
  assert_int_equal(synthetic_write_probes(writer, &without), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_ARGUMENT);
  assert_says("classic maps of 0 of 6 irradiance probes written");

  without = relit;
  without.relight_size = 0;
  header = synthetic_header(&relit);
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  synthetic_header_release(&header);
  assert_int_equal(synthetic_write_probes(writer, &without), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_ARGUMENT);
  assert_says("surfaces of 0 of 6 irradiance probes and albedo of 0 of 2 probes written");
  assert_int_equal(files_in(f->folder), 0);
}

static void test_old_file_survives(void **state) {
  fixture *f = *state;
  size_t size_bytes, size_after;
  unsigned char *before = written(f, &least, &size_bytes);

  olx_field_writer_discard(NULL);
  olx_field_writer_discard(begin(f, &small));
  olx_field_writer *writer = begin(f, &small);
  assert_int_equal(files_in(f->folder), 2);
  assert_int_equal(synthetic_write_probes(writer, &small), OLX_OK);
  olx_field_writer_discard(writer);

  // A limit on the size of files is a disk that is full: known at the start, or, where space cannot be reserved, later.
  struct rlimit limit;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
  void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
  const struct rlimit low = {.rlim_cur = 20000, .rlim_max = limit.rlim_max};
  olx_field_header header = synthetic_header(&small);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
  const olx_result at_once = olx_field_writer_create(f->path, &header, &writer);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
  if (at_once == OLX_OK) olx_field_writer_discard(writer);
  else assert_int_equal(at_once, OLX_ERROR_FILE);

  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
  const olx_result later = synthetic_write_probes(writer, &small);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
  signal(SIGXFSZ, handler);
  assert_int_equal(later, OLX_ERROR_FILE);
  assert_says("cannot write");
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_ERROR_FILE);
  synthetic_header_release(&header);

  assert_int_equal(files_in(f->folder), 1);
  unsigned char *after = synthetic_read_file(f->path, &size_after);
  assert_int_equal(size_bytes, size_after);
  assert_memory_equal(before, after, size_bytes);
  olx_release(before);
  olx_release(after);
}

static void test_folder_that_cannot_be_written(void **state) {
  (void)state;
  assert_int_equal(synthetic_write("/nonexistent-folder/a.olx", &least, NULL), OLX_ERROR_FILE);
  assert_says("/nonexistent-folder/a.olx: cannot create");
  assert_int_equal(synthetic_write("/proc/a.olx", &least, NULL), OLX_ERROR_FILE);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_round_trip, set_up, tear_down),
      cmocka_unit_test(test_pyramids_bound_their_nodes),
      cmocka_unit_test_setup_teardown(test_describes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_same_input_same_bytes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_two_fields_at_once, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_a_wrong_header, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_a_wrong_chunk_table, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_skips_unknown_optional_chunks_only, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_a_wrong_description, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_verify_sees_every_flipped_bit, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_the_content, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_rounded_moments_are_possible, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_opening_names_the_file, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_wrong_classic_maps, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_classic_maps, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_wrong_relight_chunks, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_relight_chunks, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_says_which_option_is_missing, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_writer_refuses_what_readers_would, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_writer_keeps_order, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_old_file_survives, set_up, tear_down),
      cmocka_unit_test(test_folder_that_cannot_be_written),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
