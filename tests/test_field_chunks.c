// Tests optional chunks, those of classic maps, spherical harmonics and relighting: every refusal is reached.
#include "field_fixture.h"

#include "core/hooks.h"
#include "field/field_writer.h"

// Puts a wrong value in a place of `i` and checks that opening the file, or only verifying it, fails with these words.
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
// The words of a chunk of `i`.
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
  REFUSED(header->size, 128, "chunk CIRR: 104544 bytes in records of 17424"); // the stored maps have 64 texels
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
  i.info->irradiance_form = OLX_IRRADIANCE_SH2; // the records have the size of the third order
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
  UNVERIFIED(halves[28 + 1], 0xB800, "irradiance of probe 1: coefficient 0"); // a negative mean
  UNVERIFIED(halves[28 * 5 + 27], 1, "irradiance of probe 5: coefficient 9"); // padding of the last word
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// --- Relighting data: the last chunk, after the tiles of emission

enum { RLIT = OLX_CHUNK_REQUIRED + 1 };

// Pointers to the arrays of a relighting chunk, to be changed, as docs/format.md defines them.
typedef struct relight_image {
  olx_relight_header *header;
  olx_relight_surfel *surfels;
  uint32_t *link_starts;
  olx_relight_link *links;
  olx_relight_block *blocks;
  uint32_t *entry_starts;
  olx_relight_entry *entries;
  uint32_t *volume_starts;
} relight_image;

static relight_image relight_of(const field_image *i) {
  relight_image r = {.header = (olx_relight_header *)(i->bytes + i->chunks[RLIT].offset)};
  assert_int_equal(i->chunks[RLIT].type, OLX_FOUR_CC('R', 'L', 'I', 'T'));
  r.surfels = (olx_relight_surfel *)(r.header + 1);
  r.link_starts = (uint32_t *)(r.surfels + r.header->surfels);
  r.links = (olx_relight_link *)(r.link_starts + r.header->surfels + 1);
  r.blocks = (olx_relight_block *)(r.links + r.header->links);
  r.entry_starts = (uint32_t *)(r.blocks + r.header->blocks);
  r.entries = (olx_relight_entry *)(r.entry_starts + r.header->sites + 1);
  r.volume_starts = (uint32_t *)(r.entries + r.header->entries);
  assert_ptr_equal(r.volume_starts + r.header->volume_probes + 1,
                   i->bytes + i->chunks[RLIT].offset + i->chunks[RLIT].size_bytes);
  return r;
}

static void test_refuses_wrong_relight_headers(void **state) {
  const field_image i = field_image_load(*state, &relit);
  olx_relight_header *h = relight_of(&i).header;
  uint32_t *const counts[] = {&h->links, &h->sites, &h->entries, &h->volume_links, &h->blocks, &h->volume_probes};
  for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
    REFUSED(*counts[k], OLX_RELIGHT_MOST + 1u, "chunk RLIT: a count of 268435457");
    REFUSED(*counts[k], *counts[k] + 1, "bytes where its contents take");
    REFUSED(*counts[k], OLX_RELIGHT_MOST, "bytes where its contents take");
  }
  // A link has 24 bits for the surfel's number.
  REFUSED(h->surfels, OLX_RELIGHT_MOST_SURFELS + 1u, "chunk RLIT: a count of 16777217");
  REFUSED(h->surfels, OLX_RELIGHT_MOST_SURFELS, "bytes where its contents take");
  REFUSED(h->surfels, h->surfels + 1, "bytes where its contents take");
  for (uint32_t k = 0; k < 9; k++) REFUSED(h->zero[k], 1u << 31, "chunk RLIT: reserved bytes are not 0");
  field_seal(&i);
  assert_field_sound(&i);
  i.chunks[RLIT].flags = 0;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_UNSUPPORTED, "(RLIT) is required");
  olx_relight_data relight;
  assert_int_equal(olx_relight_structure_open(h, sizeof *h - 1, "short", &relight), OLX_ERROR_FORMAT);
  assert_says("short: chunk RLIT: 63 bytes");
  olx_release(i.bytes);
}

static void test_refuses_relight_rows_out_of_order(void **state) {
  const field_image i = field_image_load(*state, &relit);
  const relight_image r = relight_of(&i);
  const struct {
    uint32_t *starts, rows;
    const char *message;
  } all[] = {{r.link_starts, r.header->surfels, "chunk RLIT: links do not follow each other"},
             {r.entry_starts, r.header->sites, "chunk RLIT: entries do not follow each other"}};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    uint32_t *starts = all[k].starts;
    const uint32_t rows = all[k].rows;
    REFUSED(starts[0], 1, all[k].message);
    REFUSED(starts[rows], starts[rows] - 1, all[k].message);
    REFUSED(starts[rows], starts[rows] + 1, all[k].message);
    REFUSED(starts[rows / 2], starts[rows] + 1, all[k].message);
    REFUSED(starts[rows - 1], starts[rows - 2] - 1, all[k].message);
    REFUSED(starts[1], UINT32_MAX, all[k].message);
  }
  REFUSED(r.volume_starts[0], 1, "chunk RLIT: links of volume probes do not follow each other");
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

static void test_refuses_impossible_surfels(void **state) {
  const field_image i = field_image_load(*state, &relit);
  const relight_image r = relight_of(&i);
  REFUSED(r.surfels[3].points[0][0], NAN, "chunk RLIT: surfel 3 is impossible");
  REFUSED(r.surfels[0].points[7][1], INFINITY, "chunk RLIT: surfel 0 is impossible");
  REFUSED(r.surfels[20].points[4][2], -2e18f, "chunk RLIT: surfel 20 is impossible");
  REFUSED(r.surfels[5].normal, 255, "chunk RLIT: surfel 5 is impossible");
  REFUSED(r.surfels[5].normal, 255 << 8, "chunk RLIT: surfel 5 is impossible");
  REFUSED(r.surfels[5].normal, 1 << 16, "chunk RLIT: surfel 5 is impossible");
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// Numbers of surfels are below 21; the bits of a link above the 24 of the number hold its straight share, which may be
// anything.
static void test_refuses_relight_numbers_out_of_range(void **state) {
  const field_image i = field_image_load(*state, &relit);
  const relight_image r = relight_of(&i);
  assert_int_equal(r.header->surfels, 21);
  REFUSED(r.links[5].from_straight, 21, "chunk RLIT: link 5 names 21, which it cannot");
  REFUSED(r.links[5].from_straight, 0xFF000015, "chunk RLIT: link 5 names 21, which it cannot");
  REFUSED(r.links[0].from_straight, UINT32_MAX, "chunk RLIT: link 0 names 16777215, which it cannot");
  REFUSED(r.entries[2].surfel, 21, "chunk RLIT: entry 2 names 21, which it cannot");
  REFUSED(r.entries[0].surfel, UINT32_MAX, "chunk RLIT: entry 0 names 4294967295, which it cannot");
  // The sites that a block needs depend on the sites that its texels choose.
  const uint32_t sites = r.header->sites;
  r.blocks[0] = (olx_relight_block){sites - 1, 0};
  REFUSED(r.blocks[0].first_site, sites, "chunk RLIT: block 0 names");
  REFUSED(r.blocks[0].first_site, UINT32_MAX - 1, "chunk RLIT: block 0 names 4294967294, which it cannot");
  for (uint32_t texel = 0; texel < 16; texel++)
    REFUSED(r.blocks[0].which, 1u << 2 * texel, "chunk RLIT: block 0 names");
  r.blocks[0].first_site = sites - 3;
  REFUSED(r.blocks[0].which, 3u << 30, "chunk RLIT: block 0 names");
  r.blocks[0] = (olx_relight_block){OLX_RELIGHT_NO_SITE, UINT32_MAX};
  r.links[5].from_straight = 0xFF000014;
  r.links[6].from_straight = 20;
  r.entries[2].surfel = 20;
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

static void test_refuses_volume_links_out_of_range(void **state) {
  (void)state;
  struct {
    olx_relight_header header;
    olx_relight_surfel surfel;
    uint32_t link_starts[2], entry_starts[1], volume_starts[3];
    olx_relight_volume_link links[2];
  } d = {.header = {.surfels = 1, .volume_probes = 2, .volume_links = 2}, .volume_starts = {0, 1, 2}};
  olx_relight_data relight;
  assert_int_equal(olx_relight_structure_open(&d, sizeof d, "a file", &relight), OLX_OK);
  assert_ptr_equal(relight.volume_starts, d.volume_starts);
  assert_ptr_equal(relight.volume_links, d.links);
  d.links[1].from = 1;
  assert_int_equal(olx_relight_structure_open(&d, sizeof d, "a file", &relight), OLX_ERROR_FORMAT);
  assert_says("a file: chunk RLIT: link of a volume probe 1 names 1, which it cannot");
  d.links[1].from = 1u << 24; // all bits of this link are the surfel's number
  assert_int_equal(olx_relight_structure_open(&d, sizeof d, "a file", &relight), OLX_ERROR_FORMAT);
  assert_says("link of a volume probe 1 names 16777216");
  d.links[1].from = 0;
  d.volume_starts[1] = 3;
  assert_int_equal(olx_relight_structure_open(&d, sizeof d, "a file", &relight), OLX_ERROR_FORMAT);
  assert_says("links of volume probes do not follow each other");
}

// A field of two probes with maps of 16 x 16 texels has 32 blocks; the shapes here have no volume.
static void refuse_other_relighting(field_fixture *f, const void *data, size_t size_bytes, const char *message) {
  synthetic_shape bare = relit;
  bare.relight_surfels = 0;
  olx_field_header header = synthetic_header(&relit);
  olx_field_writer *writer;
  assert_int_equal(olx_field_writer_create(f->path, &header, &writer), OLX_OK);
  synthetic_header_release(&header);
  assert_int_equal(synthetic_write_probes(writer, &bare), OLX_OK);
  assert_int_equal(olx_field_writer_relight(writer, data, size_bytes), OLX_OK);
  assert_int_equal(olx_field_writer_commit(writer, NULL), OLX_OK);
  olx_field *field;
  assert_int_equal(olx_field_open(f->path, &field), OLX_ERROR_FORMAT);
  assert_says(message);
}

static void test_refuses_relighting_of_another_field(void **state) {
  synthetic_shape coarse = relit;
  coarse.n = 8;
  size_t size_bytes;
  void *data = synthetic_relight(&coarse, &size_bytes);
  refuse_other_relighting(*state, data, size_bytes, "chunk RLIT: 8 blocks of texels and 0 volume probes, not 32 and 0");
  olx_release(data);
  struct {
    olx_relight_header header;
    uint32_t link_starts[1];
    olx_relight_block blocks[32];
    uint32_t entry_starts[1], volume_starts[2];
  } empty = {.header = {.blocks = 32, .volume_probes = 1}};
  for (uint32_t i = 0; i < 32; i++) empty.blocks[i].first_site = OLX_RELIGHT_NO_SITE;
  refuse_other_relighting(*state, &empty, sizeof empty,
                          "chunk RLIT: 32 blocks of texels and 1 volume probes, not 32 and 0");
}

// The chunk's checksum is read only by verifying, and a reader that does not know the chunk uses the baked light.
static void test_relighting_is_optional(void **state) {
  const field_image i = field_image_load(*state, &relit);
  const relight_image r = relight_of(&i);
  r.surfels[7].irradiance ^= 1;
  assert_field_unverified(&i, OLX_ERROR_CHECKSUM, "(RLIT): wrong checksum");
  i.chunks[RLIT].type = OLX_FOUR_CC('r', 'l', 'i', 't');
  field_seal(&i);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  assert_int_equal(olx_field_verify(field), OLX_OK);
  const olx_field_info info = olx_field_describe(field);
  assert_int_equal(info.relight.surfels + info.relight.links + info.bytes.relight, 0);
  assert_null(field->relight.header);
  olx_field_close(field);
  olx_release(i.bytes);
}

// --- Chunks of one record of bytes: selectors, the volume and the data for relighting

static void test_refuses_other_records_than_one_of_bytes(void **state) {
  synthetic_shape shape = relit;
  shape.select_mask = 1u << OLX_SELECT_VORONOI | 1u << OLX_SELECT_OCTREE | 1u << OLX_SELECT_BRICKS;
  const field_image i = field_image_load(*state, &shape);
  assert_field_sound(&i);
  static const char *const names[] = {"VORO", "OCTR", "BRIK", "RLIT"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    olx_file_chunk *chunk = field_chunk_of_type(&i, OLX_FOUR_CC(names[k][0], names[k][1], names[k][2], names[k][3]));
    char records[64], elements[64];
    snprintf(records, sizeof records, "chunk %s: %llu bytes in records of 1 ", names[k],
             (unsigned long long)chunk->size_bytes);
    snprintf(elements, sizeof elements, "chunk %s: %llu bytes in records of %llu and elements of 4", names[k],
             (unsigned long long)chunk->size_bytes, (unsigned long long)chunk->size_bytes);
    REFUSED(chunk->record_bytes, 1, records);
    REFUSED(chunk->element_bytes, 4, elements);
  }
  olx_file_chunk *volume = field_chunk_of_type(&i, OLX_FOUR_CC('R', 'L', 'I', 'T')); // these fields have no volume
  volume->type = OLX_FOUR_CC('V', 'O', 'L', 'U');
  REFUSED(volume->record_bytes, 1, "in records of 1 and elements of 1");
  REFUSED(volume->element_bytes, 4, "and elements of 4");
  olx_release(i.bytes);
}

// --- Chunks with two forms, of which a file has the one that its description names

static void test_refuses_the_other_form_of_a_chunk_even_where_it_is_optional(void **state) {
  const field_image i = field_image_load(*state, &relit);
  assert_field_sound(&i);
  olx_file_chunk *optional = field_chunk_of_type(&i, OLX_FOUR_CC('R', 'L', 'I', 'T'));
  static const char *const forms[][2] = {{"DIST", "GEOM"}, {"BASE", "TBAS"}, {"SPEC", "TREF"},
                                         {"DIRE", "TDIR"}, {"INDI", "TIND"}, {"IRRA", "IRSH"}};
  for (size_t k = 0; k < sizeof forms / sizeof *forms; k++) {
    uint32_t types[2];
    const olx_file_chunk *found[2] = {0};
    for (int form = 0; form < 2; form++) {
      const char *name = forms[k][form];
      types[form] = OLX_FOUR_CC(name[0], name[1], name[2], name[3]);
      for (uint32_t c = 0; c < i.header->chunk_count; c++) {
        if (i.chunks[c].type == types[form]) found[form] = &i.chunks[c];
      }
    }
    assert_true(!found[0] != !found[1]);
    const int used = found[1] != NULL;
    char message[64];
    snprintf(message, sizeof message, "a chunk %s, but the description has %s", forms[k][!used], forms[k][used]);
    REFUSED(optional->type, types[!used], message);
  }
  olx_release(i.bytes);
}

// --- Probe light: chunks that a description with irradiance probes requires

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
                            OLX_FOUR_CC('I', 'R', 'S', 'H'), OLX_FOUR_CC('M', 'O', 'M', 'E')};
  // The chunk of lights is the only one after the required chunks, except the tiles of emission, that opening reads.
  olx_file_chunk *lights = &i.chunks[i.header->chunk_count - 2];
  for (lights->flags = 0; lights->flags <= OLX_CHUNK_OPTIONAL; lights->flags++) {
    for (size_t k = 0; k < sizeof types / sizeof *types; k++) {
      REFUSED(lights->type, types[k], "but the description has no irradiance probes");
    }
  }
  lights->flags = 0;
  // The description claims irradiance probes that the file does not have.
  i.info->irradiance_probe_count = 1;
  i.info->irradiance_size = 8;
  for (int axis = 0; axis < 3; axis++) i.info->irradiance_grid.count[axis] = 1;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "no chunk RADI");
  olx_release(i.bytes);
  // The description says that there are no irradiance probes, although the file has some.
  i = field_image_load(*state, &least);
  i.info->irradiance_probe_count = i.info->irradiance_size = 0;
  i.info->irradiance_grid = (olx_file_grid){.count = {0}};
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "a chunk RADI, but the description has no irradiance probes");
  olx_release(i.bytes);
}

// --- The origin: after the required chunks, since the field has no other chunk

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
  // A field whose origin is that of coordinates has no such chunk.
  i = field_image_load(*state, &least);
  // Required chunks and the tiles of emission, which come last.
  assert_int_equal(i.header->chunk_count, OLX_CHUNK_REQUIRED + 1);
  olx_release(i.bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_refuses_wrong_classic_maps, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_classic_maps, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_wrong_harmonics, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_harmonics, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_wrong_relight_headers, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_relight_rows_out_of_order, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_impossible_surfels, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_relight_numbers_out_of_range, field_set_up, field_tear_down),
      cmocka_unit_test(test_refuses_volume_links_out_of_range),
      cmocka_unit_test_setup_teardown(test_refuses_relighting_of_another_field, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_relighting_is_optional, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_other_records_than_one_of_bytes, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_the_other_form_of_a_chunk_even_where_it_is_optional, field_set_up,
                                      field_tear_down),
      cmocka_unit_test_setup_teardown(test_probe_light_comes_whole_or_not_at_all, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_the_origin_is_read_and_checked, field_set_up, field_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
