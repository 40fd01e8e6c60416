// Tests packed fields: unpacking restores the packed file, and every refusal is reached.
#include "field_fixture.h"
#include "packed_fields.h"

#include "core/hooks.h"
#include "core/sampling.h"
#include "export/block_filter.h"

#include <sys/resource.h>
#include <unistd.h>
#include <zstd.h>

static void packed_path(const field_fixture *f, char path[128]) { snprintf(path, 128, "%s/a.olxz", f->folder); }

static void back_path(const field_fixture *f, char path[128]) { snprintf(path, 128, "%s/back.olx", f->folder); }

static void write_synthetic(const field_fixture *f, const synthetic_shape *shape) {
  assert_int_equal(synthetic_write(f->path, shape, NULL), OLX_OK);
}

static void pack(const field_fixture *f, uint32_t level, uint32_t threads, olx_packed_info *info) {
  char packed[128];
  packed_path(f, packed);
  const olx_pack_settings settings = {.level = level, .threads = threads};
  assert_int_equal(olx_field_pack(f->path, &settings, packed, NULL, info), OLX_OK);
}

static void assert_same_files(const char *a, const char *b) {
  size_t a_bytes, b_bytes;
  unsigned char *first = synthetic_read_file(a, &a_bytes), *second = synthetic_read_file(b, &b_bytes);
  assert_non_null(first);
  assert_non_null(second);
  assert_int_equal(a_bytes, b_bytes);
  assert_memory_equal(first, second, a_bytes);
  olx_release(first);
  olx_release(second);
}

static void assert_comes_back(const field_fixture *f, const synthetic_shape *shape) {
  char packed[128], back[128];
  olx_packed_info made, said, found;
  const olx_unpack_settings settings = olx_unpack_settings_default();
  packed_path(f, packed);
  back_path(f, back);
  write_synthetic(f, shape);
  pack(f, 3, 2, &made);
  assert_int_equal(olx_packed_describe(packed, &said), OLX_OK);
  assert_int_equal(olx_field_unpack(packed, &settings, back, NULL, &found), OLX_OK);
  assert_same_files(f->path, back);
  assert_true(made.field_bytes == said.field_bytes && made.packed_bytes == found.packed_bytes);
  assert_int_equal(olx_field_unpack(packed, &settings, NULL, NULL, NULL), OLX_OK); // unpacks without writing a file
  unlink(packed);
  unlink(back);
}

static void test_every_kind_of_field_comes_back(void **state) {
  const synthetic_shape far = {.grid = {2, 1, 1}, .n = 8, .origin = {1e6, 0.0, -3e6}};
  const synthetic_shape *const shapes[] = {&small, &classic, &relit, &third_order, &without_probe_light, &least, &far};
  for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) assert_comes_back(*state, shapes[i]);
}

// A shape whose chunks have several blocks, the last of them incomplete.
static const synthetic_shape large = {.grid = {5, 1, 1}, .n = 256};

static void test_bytes_depend_on_neither_threads_nor_runs(void **state) {
  const field_fixture *f = *state;
  char packed[128], first[128];
  packed_path(f, packed);
  snprintf(first, sizeof first, "%s/first.olxz", f->folder);
  write_synthetic(f, &large);
  pack(f, 5, 1, NULL);
  assert_int_equal(rename(packed, first), 0);
  for (uint32_t threads = 1; threads <= 7; threads += 2) {
    pack(f, 5, threads, NULL);
    assert_same_files(first, packed);
  }
  unlink(packed);
  unlink(first);
}

static void test_filters_are_undone(void **state) {
  (void)state;
  enum { MOST = 1003 };
  uint8_t original[MOST], data[MOST], room[MOST];
  for (uint32_t i = 0; i < MOST; i++) original[i] = (uint8_t)olx_hash(i);
  for (uint32_t element = 0; element <= 16; element++) {
    for (uint32_t filter = 0; filter <= OLX_FILTERS; filter++) {
      if (!olx_filter_exists(filter, element)) continue;
      for (size_t size_bytes = 0; size_bytes <= MOST; size_bytes += size_bytes < 20 ? 1 : 61) {
        memcpy(data, original, size_bytes);
        uint8_t *there = olx_filter_apply(filter, element, data, room, size_bytes);
        uint8_t *back = olx_filter_undo(filter, element, there, there == data ? room : data, size_bytes);
        assert_memory_equal(back, original, size_bytes);
      }
    }
  }
  assert_false(olx_filter_exists(OLX_FILTER_COLORS, 2));
  assert_false(olx_filter_exists(0, 3));
  assert_false(olx_filter_exists(OLX_FILTERS, 4));
}

// The filters give the bytes that docs/format.md states, for single elements.
static void test_filters_are_as_documented(void **state) {
  (void)state;
  uint8_t room[8];
  // The colour has red 1, green 2 * 5 + 1, blue 2 * 7, exponent 17.
  uint32_t color = 1u | 11u << 9 | 14u << 18 | 17u << 27;
  olx_filter_apply(OLX_FILTER_COLORS, 4, (uint8_t *)&color, room, 4);
  assert_int_equal(color, 0u | 5u << 8 | 7u << 16 | (17u | 0xC0u) << 24);
  uint8_t numbers[8] = {1, 2, 4, 3, 250, 1, 9, 9};
  const uint8_t *planes = olx_filter_apply(OLX_FILTER_DIFFERENCES | OLX_FILTER_PLANES, 2, numbers, room, 8);
  assert_memory_equal(planes, ((uint8_t[]){1, 3, 246, 15, 2, 1, 254, 8}), 8);
}

static void test_a_packed_field_is_no_field(void **state) {
  const field_fixture *f = *state;
  char packed[128];
  olx_field *field;
  olx_packed_info info;
  const olx_unpack_settings settings = olx_unpack_settings_default();
  packed_path(f, packed);
  write_synthetic(f, &least);
  pack(f, 1, 1, NULL);
  assert_true(olx_is_packed_field(packed) && !olx_is_packed_field(f->path) && !olx_is_packed_field("/nowhere"));
  assert_int_equal(olx_field_open(packed, &field), OLX_ERROR_UNSUPPORTED);
  assert_says("a packed field; `octalux unpack`");
  assert_int_equal(olx_packed_describe(f->path, &info), OLX_ERROR_FORMAT);
  assert_says("a field that is not packed");
  assert_int_equal(olx_field_unpack(f->path, &settings, NULL, NULL, NULL), OLX_ERROR_FORMAT);
  assert_int_equal(olx_field_pack(packed, &(olx_pack_settings){.level = 1}, f->path, NULL, NULL),
                   OLX_ERROR_UNSUPPORTED);
  unlink(packed);
}

static void test_refuses_settings_out_of_range(void **state) {
  const field_fixture *f = *state;
  char packed[128];
  packed_path(f, packed);
  write_synthetic(f, &least);
  assert_int_equal(olx_field_pack(f->path, &(olx_pack_settings){.level = 0}, packed, NULL, NULL), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_field_pack(f->path, &(olx_pack_settings){.level = 23}, packed, NULL, NULL), OLX_ERROR_ARGUMENT);
  assert_says("level 23 is not in 1..22");
  assert_int_equal(access(packed, F_OK), -1);
}

// A field with a wrong checksum, or with padding that is not zero, is not packed, since unpacking could not restore it.
static void test_packs_no_damaged_field(void **state) {
  const field_fixture *f = *state;
  char packed[128];
  packed_path(f, packed);
  const field_image i = field_image_load(*state, &least);
  ((uint8_t *)field_chunk(&i, OLX_CHUNK_DIRECT))[5] ^= 1;
  assert_int_equal(olx_write_file(f->path, i.bytes, i.size_bytes), OLX_OK);
  assert_int_equal(olx_field_pack(f->path, &(olx_pack_settings){.level = 1}, packed, NULL, NULL), OLX_ERROR_CHECKSUM);
  assert_says("(DIRE): wrong checksum");
  assert_int_equal(access(packed, F_OK), -1);
  olx_release(i.bytes);
}

// ---- Damage

static void assert_refused(const field_fixture *f, const packed_image *i, olx_result expected, const char *message) {
  char packed[128], back[128];
  packed_path(f, packed);
  back_path(f, back);
  assert_int_equal(olx_write_file(packed, i->bytes, i->size_bytes), OLX_OK);
  const olx_unpack_settings settings = olx_unpack_settings_default();
  assert_int_equal(olx_field_unpack(packed, &settings, back, NULL, NULL), expected);
  assert_says(message);
  assert_says("a.olxz");
  assert_int_equal(access(back, F_OK), -1);
}

static packed_image packed_small(const field_fixture *f) {
  char packed[128];
  packed_path(f, packed);
  write_synthetic(f, &small);
  pack(f, 1, 1, NULL);
  return packed_image_load(packed, 0);
}

static void end_damage(const field_fixture *f, packed_image *i) {
  char packed[128];
  packed_path(f, packed);
  unlink(packed);
  olx_release(i->bytes);
}

static void test_refuses_a_changed_byte_anywhere(void **state) {
  packed_image i = packed_small(*state);
  for (size_t at = 0; at < i.size_bytes; at += 1 + i.size_bytes / 97) {
    i.bytes[at] ^= 0x10;
    char packed[128];
    packed_path(*state, packed);
    assert_int_equal(olx_write_file(packed, i.bytes, i.size_bytes), OLX_OK);
    const olx_unpack_settings settings = olx_unpack_settings_default();
    assert_int_not_equal(olx_field_unpack(packed, &settings, NULL, NULL, NULL), OLX_OK);
    i.bytes[at] ^= 0x10;
  }
  end_damage(*state, &i);
}

static void test_refuses_what_is_cut_short(void **state) {
  packed_image i = packed_small(*state);
  const size_t size_bytes = i.size_bytes;
  i.size_bytes = 20;
  assert_refused(*state, &i, OLX_ERROR_FORMAT, "too short for a packed field");
  i.size_bytes = size_bytes - 64;
  assert_refused(*state, &i, OLX_ERROR_FORMAT, "truncated");
  i.size_bytes = size_bytes;
  end_damage(*state, &i);
}

static void test_refuses_tables_that_disagree(void **state) {
  packed_image i = packed_small(*state);
#define REFUSED(place, value, result, message)                                                                         \
  do {                                                                                                                 \
    const __typeof__(place) good = (place);                                                                            \
    (place) = (value);                                                                                                 \
    packed_image_seal(&i);                                                                                             \
    assert_refused(*state, &i, result, message);                                                                       \
    (place) = good;                                                                                                    \
  } while (0)
  REFUSED(i.header->version, 2u, OLX_ERROR_VERSION, "format version 2 is newer than the 1");
  REFUSED(i.chunks[0].type, OLX_FOUR_CC('T', 'A', 'B', 'E'), OLX_ERROR_FORMAT, "the first chunk is not the header");
  REFUSED(i.field_header->chunk_count, 3u, OLX_ERROR_FORMAT, "the first chunk is not the header");
  REFUSED(i.field_header->version, 1u, OLX_ERROR_VERSION, "version 1 is older");
  REFUSED(i.field_header->file_bytes, i.field_header->file_bytes + 64, OLX_ERROR_FORMAT, "64 bytes after the last");
  REFUSED(i.field_chunks[3].type, OLX_FOUR_CC('R', 'A', 'D', 'X'), OLX_ERROR_FORMAT,
          "packed chunk 3 is RADI where the field has RADX");
  REFUSED(i.chunks[4].record_bytes, 1u << 21, OLX_ERROR_FORMAT, "chunk RADI: blocks of 2097152 bytes");
  REFUSED(i.chunks[4].element_bytes, 3u, OLX_ERROR_FORMAT, "in elements of 3");
  REFUSED(i.chunks[4].flags, 1u, OLX_ERROR_FORMAT, "or flags");
  REFUSED(i.field_chunks[3].hash, i.field_chunks[3].hash ^ 1, OLX_ERROR_CHECKSUM,
          "chunk RADI: wrong checksum once it is unpacked");
#undef REFUSED
  end_damage(*state, &i);
}

static void test_refuses_blocks_that_cannot_be(void **state) {
  packed_image i = packed_small(*state);
  unsigned char *word = packed_image_words(&i, OLX_CHUNK_NORMAL);
  uint32_t good;
  memcpy(&good, word, sizeof good);
  const struct {
    uint32_t word;
    const char *message;
  } bad[] = {{0, "chunk NORM: block 0 has an impossible size or filter"},
             {good | (OLX_FILTER_COLORS << OLX_PACKED_FILTER_SHIFT), "block 0 has an impossible size or filter"},
             {good | (OLX_FILTERS << OLX_PACKED_FILTER_SHIFT), "block 0 has an impossible size or filter"},
             {OLX_PACKED_MOST_BLOCK_BYTES + 1, "block 0 has an impossible size or filter"},
             {good + 1, "chunk NORM: blocks of"}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    memcpy(word, &bad[k].word, sizeof good);
    packed_image_seal(&i);
    assert_refused(*state, &i, OLX_ERROR_FORMAT, bad[k].message);
  }
  memcpy(word, &good, sizeof good);
  i.bytes[i.chunks[OLX_CHUNK_NORMAL + 1].offset] ^= 0xFF; // the magic number of the zstd frame
  packed_image_seal(&i);
  assert_refused(*state, &i, OLX_ERROR_FORMAT, "chunk NORM: block 0 does not unpack to");
  end_damage(*state, &i);
}

// ---- Bombs: sizes that a small file claims are compared with limits before memory is allocated for them.

// Enlarges the last chunk of the field by `blocks` blocks.
static void stretch(const packed_image *i, uint64_t blocks) {
  olx_file_chunk *last = &i->field_chunks[i->field_header->chunk_count - 1];
  last->size_bytes += blocks * OLX_PACKED_BLOCK_BYTES;
  i->field_header->file_bytes = olx_align_chunk(last->offset + last->size_bytes);
  packed_image_seal(i);
}

static void test_refuses_bombs(void **state) {
  const field_fixture *f = *state;
  packed_image i = packed_small(f);
  stretch(&i, 1u << 14);
  assert_refused(f, &i, OLX_ERROR_FORMAT, "chunk ETIL");
  assert_says("bytes cannot hold 16385 blocks");
  stretch(&i, UINT64_C(1) << 40);
  assert_refused(f, &i, OLX_ERROR_FORMAT, "cannot hold");
  end_damage(f, &i);
}

// A valid zstd frame that contains more than its block has room for is refused.
static void test_a_block_brings_no_more_than_it_may(void **state) {
  const field_fixture *f = *state;
  packed_image i = packed_small(f);
  static uint8_t zeros[OLX_PACKED_BLOCK_BYTES];
  olx_file_chunk *chunk = &i.chunks[OLX_CHUNK_NORMAL + 1];
  const size_t room = chunk->size_bytes - sizeof(uint32_t);
  size_t found = ZSTD_compress(i.bytes + chunk->offset, room, zeros, sizeof zeros, 19);
  assert_false(ZSTD_isError(found));
  memset(i.bytes + chunk->offset + found, 0, room - found);
  packed_image_seal(&i);
  assert_refused(f, &i, OLX_ERROR_FORMAT, "chunk NORM: block 0 does not unpack to");
  end_damage(f, &i);
}

static void test_a_limit_on_size_holds(void **state) {
  const field_fixture *f = *state;
  char packed[128], back[128];
  packed_path(f, packed);
  back_path(f, back);
  write_synthetic(f, &small);
  olx_packed_info info;
  pack(f, 1, 1, &info);
  olx_unpack_settings settings = olx_unpack_settings_default();
  assert_true(settings.most_bytes == UINT64_C(1) << 35);
  settings.most_bytes = info.field_bytes - 1;
  assert_int_equal(olx_field_unpack(packed, &settings, back, NULL, NULL), OLX_ERROR_UNSUPPORTED);
  assert_says("more than the limit of");
  assert_int_equal(access(back, F_OK), -1);
  settings.most_bytes = info.field_bytes;
  assert_int_equal(olx_field_unpack(packed, &settings, back, NULL, NULL), OLX_OK);
  unlink(packed);
  unlink(back);
}

// ---- Ends

static bool stop_at_once(void *user, const char *stage, float done) {
  (void)user, (void)stage, (void)done;
  return false;
}

static void test_stops_without_an_output(void **state) {
  const field_fixture *f = *state;
  const olx_progress progress = {.report = stop_at_once};
  char packed[128], back[128];
  packed_path(f, packed);
  back_path(f, back);
  write_synthetic(f, &large);
  assert_int_equal(olx_field_pack(f->path, &(olx_pack_settings){.level = 1}, packed, &progress, NULL),
                   OLX_ERROR_CANCELLED);
  assert_int_equal(access(packed, F_OK), -1);
  pack(f, 1, 2, NULL);
  const olx_unpack_settings settings = olx_unpack_settings_default();
  assert_int_equal(olx_field_unpack(packed, &settings, back, &progress, NULL), OLX_ERROR_CANCELLED);
  assert_int_equal(access(back, F_OK), -1);
  unlink(packed);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_every_kind_of_field_comes_back, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_bytes_depend_on_neither_threads_nor_runs, field_set_up, field_tear_down),
      cmocka_unit_test(test_filters_are_undone),
      cmocka_unit_test(test_filters_are_as_documented),
      cmocka_unit_test_setup_teardown(test_a_packed_field_is_no_field, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_settings_out_of_range, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_packs_no_damaged_field, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_a_changed_byte_anywhere, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_what_is_cut_short, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_tables_that_disagree, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_blocks_that_cannot_be, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_bombs, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_a_block_brings_no_more_than_it_may, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_a_limit_on_size_holds, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_stops_without_an_output, field_set_up, field_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
