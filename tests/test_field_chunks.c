// Chunks that not every field has, those of classic maps, spherical harmonics and relighting: every refusal is reached.
#include "field_fixture.h"

#include "core/hooks.h"
#include "field/field_writer.h"

// With a wrong value in a place of `i` the file is refused, or only when it is verified, with these words.
#define WRONG(place, value, judge, message)                                                                            \
  do {                                                                                                                 \
    __typeof__(place) *at = &(place), good = *at;                                                                      \
    *at = (value);                                                                                                     \
    field_seal(&i);                                                                                                    \
    judge(&i, OLX_ERROR_FORMAT, message);                                                                              \
    *at = good;                                                                                                        \
  } while (0)
#define REFUSED(place, value, message) WRONG(place, value, assert_field_refused, message)
#define UNVERIFIED(place, value, message) WRONG(place, value, assert_field_unverified, message)
// A chunk of `i`.
#define WORDS(chunk) ((uint32_t *)(i.bytes + i.chunks[chunk].offset))

// --- Classic maps: chunks after the required ones, since the field has no selector but the cage

enum { CLAS = OLX_CHUNK_REQUIRED, CIRR, CRAD, CBOX };

static void test_refuses_wrong_classic_maps(void **state) {
  const field_image i = field_image_load(*state, &classic);
  olx_classic_header *header = (olx_classic_header *)(i.bytes + i.chunks[CLAS].offset);
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
  REFUSED(i.chunks[CRAD].type, strange, "no chunk CRAD, but chunk CLAS speaks of it");
  REFUSED(i.chunks[CBOX].type, i.chunks[CIRR].type, "two chunks CIRR");
  REFUSED(i.chunks[CLAS].type, strange, "a chunk CIRR, but no chunk CLAS");
  REFUSED(i.chunks[CIRR].record_bytes, 64, "chunk CIRR");
  field_seal(&i);
  i.chunks[CRAD].flags = 0;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_UNSUPPORTED, "(CRAD) is required");
  i.chunks[CRAD].flags = OLX_CHUNK_OPTIONAL;
  field_seal(&i);
  header->table[7] ^= 1;
  assert_field_refused(&i, OLX_ERROR_CHECKSUM, "chunk CLAS: wrong checksum");
  olx_release(i.bytes);
}

static void test_verify_reads_classic_maps(void **state) {
  const field_image i = field_image_load(*state, &classic);
  const size_t texels = 66 * 66, record = olx_classic_first(64, OLX_CLASSIC_LEVELS);
  UNVERIFIED(WORDS(CIRR)[2 * texels + 70], 0x7C0, "classic irradiance of probe 2, texel (3, 0): not a finite");
  UNVERIFIED(WORDS(CIRR)[0], 3, "classic irradiance of probe 0: border texel (-1, -1) differs");
  UNVERIFIED(WORDS(CRAD)[record + 70], 0xF8000000, "classic radiance of probe 1, texel (3, 0): not a finite");
  UNVERIFIED(WORDS(CRAD)[olx_classic_first(64, 4)], 3, "classic radiance of probe 0: border texel (-1, -1) differs");
  UNVERIFIED(WORDS(CLAS)[16 + 99], 0x7C00, "entry 99 of the table: impossible");
  UNVERIFIED(WORDS(CLAS)[16], 0x7E000000, "entry 0 of the table: impossible");
  UNVERIFIED(WORDS(CLAS)[16 + 4095], 0x80000000, "entry 4095 of the table: impossible");
  UNVERIFIED(WORDS(CLAS)[16 + 1], 0x40004000, "entry 1 of the table: impossible");
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// --- Irradiance as spherical harmonics

static void test_refuses_wrong_harmonics(void **state) {
  const field_image i = field_image_load(*state, &third_order);
  const olx_file_info good = *i.info;
  olx_file_chunk *chunk = &i.chunks[OLX_CHUNK_IRRADIANCE];
  i.info->irradiance_form = OLX_IRRADIANCE_OCTAHEDRAL;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "no chunk IRRA");
  i.info->irradiance_form = OLX_IRRADIANCE_SH2; // the records are those of the third order
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk IRSH: 336 bytes in records of 56");
  *i.info = good;
  chunk->type = OLX_FOUR_CC('I', 'R', 'R', 'A');
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "no chunk IRSH");
  olx_release(i.bytes);
}

static void test_verify_reads_harmonics(void **state) {
  const field_image i = field_image_load(*state, &third_order);
  uint16_t *halves = (uint16_t *)(i.bytes + i.chunks[OLX_CHUNK_IRRADIANCE].offset);
  UNVERIFIED(halves[28 * 2 + 13], 0x7C00, "irradiance of probe 2: coefficient 4: impossible (code 0x7c00)");
  UNVERIFIED(halves[5], 0xFE00, "irradiance of probe 0: coefficient 1");      // NaN
  UNVERIFIED(halves[28 + 1], 0xB800, "irradiance of probe 1: coefficient 0"); // a mean below zero
  UNVERIFIED(halves[28 * 5 + 27], 1, "irradiance of probe 5: coefficient 9"); // what fills the last word
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// --- What relighting needs

enum { RLIT = OLX_CHUNK_REQUIRED, ALBE, SURF, FITP, HIDN };

static void test_refuses_wrong_relight_chunks(void **state) {
  const field_image i = field_image_load(*state, &relit);
  olx_relight_header *header = (olx_relight_header *)(i.bytes + i.chunks[RLIT].offset);
  REFUSED(header->size, 8, "8 surfaces along a side are not 16, 32, 64 or 128");
  REFUSED(header->size, 0, "0 surfaces");
  REFUSED(header->size, 256, "256 surfaces");
  REFUSED(header->size, 32, "chunk SURF: 12288 bytes in records of 2048"); // the maps are those of 16
  REFUSED(header->points, 0, "0 points of 9 rays");
  REFUSED(header->points, 4097, "4097 points of 9 rays");
  REFUSED(header->points, 6, "chunk FITP: 1560 bytes");
  REFUSED(header->rays, 0, "5 points of 0 rays");
  REFUSED(header->rays, 257, "5 points of 257 rays");
  REFUSED(header->hidden, 1025, "1025 hidden surfaces and 5 points a probe: at most 1024");
  REFUSED(header->hidden, 6, "chunk HIDN: 600 bytes in records of 100");
  REFUSED(header->hidden, 0, "a chunk HIDN, but no chunk RLIT that speaks of it");
  REFUSED(header->zero[11], 1, "chunk RLIT: reserved bytes");
  const uint32_t strange = OLX_FOUR_CC('s', 'u', 'r', 'f');
  REFUSED(i.chunks[SURF].type, strange, "no chunk SURF, but chunk RLIT speaks of it");
  REFUSED(i.chunks[FITP].type, strange, "no chunk FITP");
  REFUSED(i.chunks[HIDN].type, strange, "no chunk HIDN, but chunk RLIT speaks of it");
  REFUSED(i.chunks[HIDN].element_bytes, 4, "chunk HIDN");
  REFUSED(i.chunks[RLIT].type, strange, "a chunk ALBE, but no chunk RLIT");
  REFUSED(i.chunks[ALBE].record_bytes, 64, "chunk ALBE");
  field_seal(&i);
  header->points ^= 1;
  assert_field_refused(&i, OLX_ERROR_CHECKSUM, "chunk RLIT: wrong checksum");
  olx_release(i.bytes);
}

// Rays are what hidden surfaces are known by.
static void test_refuses_hidden_surfaces_without_points(void **state) {
  synthetic_shape shape = relit;
  shape.relight_points = shape.relight_rays = shape.relight_hidden = 0;
  const field_image i = field_image_load(*state, &shape);
  ((olx_relight_header *)(i.bytes + i.chunks[RLIT].offset))->hidden = 5;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT,
                       "5 hidden surfaces and 0 points a probe: at most 1024, none without points");
  olx_release(i.bytes);
}

static void test_refuses_to_relight_harmonics(void **state) {
  const field_fixture *f = *state;
  olx_field_header header = synthetic_header(&relit);
  header.info.irradiance_form = OLX_IRRADIANCE_SH2;
  olx_field_writer *writer;
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_ERROR_ARGUMENT);
  assert_says("relighting needs octahedral irradiance, not sh2");
  synthetic_header_release(&header);
}

static void test_verify_reads_relight_chunks(void **state) {
  const field_image i = field_image_load(*state, &relit);
  UNVERIFIED(WORDS(ALBE)[18 * 18 + 20], 0x3C1, "albedo of probe 1, texel (1, 0): not in 0..1");
  UNVERIFIED(WORDS(ALBE)[20], 0x7C0, "albedo of probe 0, texel (1, 0): not in 0..1");
  UNVERIFIED(WORDS(ALBE)[0], 3, "albedo of probe 0: border texel (-1, -1) differs");
  UNVERIFIED(WORDS(SURF)[2 * 256], 0x7C0, "surface 0 of probe 1");
  UNVERIFIED(WORDS(SURF)[2 * 7 + 1], 0x7C0100FF, "surface 7 of probe 0"); // a normal's coordinate beyond 254
  UNVERIFIED(WORDS(SURF)[2 * 7 + 1], 0x7C010000, "surface 7 of probe 0"); // NaN
  UNVERIFIED(WORDS(SURF)[2 * 7 + 1], 0x80000000, "surface 7 of probe 0"); // below zero
  UNVERIFIED(WORDS(FITP)[65 + 0], 0x7FC00000, "point 0 of probe 1");
  UNVERIFIED(WORDS(FITP)[13 + 3], 0xFFFF, "point 1 of probe 0");
  UNVERIFIED(WORDS(FITP)[13 * 4 + 3], 0x10000, "point 4 of probe 0");
  UNVERIFIED(WORDS(FITP)[13 * 4 + 12], 6 * (256 + 5), "point 4 of probe 0");
  UNVERIFIED(WORDS(HIDN)[25 + 1], 0x7FC00000, "chunk HIDN: surface 0 of probe 1 is impossible");
  UNVERIFIED(WORDS(HIDN)[5 * 2 + 2], 0x5E5E0B6C, "surface 2 of probe 0"); // 4e18 metres
  UNVERIFIED(WORDS(HIDN)[5 * 2 + 2], 0xFF800000, "surface 2 of probe 0");
  UNVERIFIED(WORDS(HIDN)[5 * 3 + 0], 0x7F800000, "surface 3 of probe 0"); // even where there is none
  UNVERIFIED(WORDS(HIDN)[5 * 4 + 3], 0xFFFF, "surface 4 of probe 0");
  UNVERIFIED(WORDS(HIDN)[5 * 4 + 3], 0x10000, "surface 4 of probe 0");
  UNVERIFIED(WORDS(HIDN)[25 * 5 + 4], 0x3C1, "surface 0 of probe 5"); // more than it gets
  UNVERIFIED(WORDS(HIDN)[25 * 5 + 4], 0xF8000000, "surface 0 of probe 5");
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// --- Probe light: chunks that irradiance probes in the description bring with them

static void test_probe_light_comes_whole_or_not_at_all(void **state) {
  field_image i = field_image_load(*state, &without_probe_light);
  const char *silent = "a size, form or grid of irradiance probes, but none of them";
  assert_field_sound(&i);
  REFUSED(i.info->irradiance_size, 8, silent);
  REFUSED(i.info->irradiance_form, 1, silent);
  REFUSED(i.info->irradiance_grid.count[1], 1, silent);
  REFUSED(i.info->irradiance_grid.origin[2], 0.5f, silent);
  REFUSED(i.info->irradiance_buried_count, 1, "more probes are buried than there are");
  REFUSED(i.info->irradiance_probe_count, 1, "irradiance size 0 is not a power of two");
  const uint32_t types[] = {OLX_FOUR_CC('R', 'A', 'D', 'I'), OLX_FOUR_CC('I', 'P', 'O', 'S'),
                            OLX_FOUR_CC('I', 'F', 'L', 'G'), OLX_FOUR_CC('I', 'R', 'R', 'A'),
                            OLX_FOUR_CC('M', 'O', 'M', 'E')};
  // The only chunk but the tiles of emission that is looked for later.
  olx_file_chunk *lights = &i.chunks[i.header->chunk_count - 2];
  for (size_t k = 0; k < sizeof types / sizeof *types; k++) {
    REFUSED(lights->type, types[k], "but the description has no irradiance probes");
  }
  // A description that claims them.
  i.info->irradiance_probe_count = 1;
  i.info->irradiance_size = 8;
  for (int axis = 0; axis < 3; axis++) i.info->irradiance_grid.count[axis] = 1;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "no chunk RADI");
  olx_release(i.bytes);
  // One that denies them.
  i = field_image_load(*state, &least);
  i.info->irradiance_probe_count = i.info->irradiance_size = 0;
  i.info->irradiance_grid = (olx_file_grid){.count = {0}};
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "a chunk RADI, but the description has no irradiance probes");
  olx_release(i.bytes);
}

// --- The origin: after the required chunks, since the field has no other

static const synthetic_shape far_away = {
    .grid = {1, 4, 1}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8, .origin = {1e7, 0.0, -0.5}};

static void test_the_origin_is_read_and_checked(void **state) {
  field_image i = field_image_load(*state, &far_away);
  assert_int_equal(i.chunks[OLX_CHUNK_REQUIRED].flags, 0);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);
  double read[3];
  olx_field_origin(field, read);
  assert_memory_equal(read, far_away.origin, sizeof read);
  olx_field_close(field);
  double *stored = (double *)(i.bytes + i.chunks[OLX_CHUNK_REQUIRED].offset);
  REFUSED(stored[1], NAN, "chunk ORIG: the origin (1e+07 nan -0.5)");
  REFUSED(stored[0], 2.1e7, "chunk ORIG");
  REFUSED(i.chunks[OLX_CHUNK_REQUIRED].flags, OLX_CHUNK_OPTIONAL, "chunk ORIG: flagged optional, but it is not");
  field_seal(&i);
  stored[2] = 3.0;
  assert_field_refused(&i, OLX_ERROR_CHECKSUM, "chunk ORIG: wrong checksum");
  stored[0] = stored[2] = 0.0;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk ORIG: the origin (0 0 0) is 0");
  olx_release(i.bytes);
  // A field at the origin of coordinates has no such chunk.
  i = field_image_load(*state, &least);
  assert_int_equal(i.header->chunk_count, OLX_CHUNK_REQUIRED + 1); // and the tiles of emission, which come last
  olx_release(i.bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_refuses_wrong_classic_maps, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_classic_maps, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_wrong_harmonics, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_harmonics, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_to_relight_harmonics, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_wrong_relight_chunks, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_hidden_surfaces_without_points, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_relight_chunks, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_probe_light_comes_whole_or_not_at_all, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_the_origin_is_read_and_checked, field_set_up, field_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
