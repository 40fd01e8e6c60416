// Tests damaged field files: every refusal of the header, the table, the description and the content is reached.
#include "field_fixture.h"

#include "core/file.h"
#include "core/hooks.h"
#include "field/texels.h"

// The chunks of a field that has only the required ones; the chunk of emission tiles comes last.
enum { REQUIRED = OLX_CHUNK_REQUIRED + 1 };
static const olx_chunk_kind TILES = OLX_CHUNK_REQUIRED;

static void test_refuses_a_wrong_header(void **state) {
  field_image i = field_image_load(*state, &small);
  const olx_file_header good = *i.header;
  const size_t size_bytes = i.size_bytes;

  i.size_bytes = 0;
  assert_field_refused(&i, OLX_ERROR_FORMAT, "too short");
  i.size_bytes = 63;
  assert_field_refused(&i, OLX_ERROR_FORMAT, "too short");
  i.size_bytes = 64;
  assert_field_refused(&i, OLX_ERROR_FORMAT, "truncated");
  i.size_bytes = size_bytes - 1;
  assert_field_refused(&i, OLX_ERROR_FORMAT, "truncated");
  i.size_bytes = size_bytes;

  i.header->magic[1] = 'o';
  assert_field_refused(&i, OLX_ERROR_FORMAT, "wrong magic");
  *i.header = good;
  i.header->version = 1;
  assert_field_refused(&i, OLX_ERROR_VERSION, "version 1 is older than the 2 this library reads; bake the");
  i.header->version = 3;
  assert_field_refused(&i, OLX_ERROR_VERSION, "version 3 is newer");
  *i.header = good;
  i.header->chunk_count++;
  assert_field_refused(&i, OLX_ERROR_CHECKSUM, "header: wrong checksum");
  *i.header = good;
  i.header->file_bytes -= 64;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "too long");
  *i.header = good;
  i.header->zero[2] = 1;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "header: reserved bytes");
  *i.header = good;
  for (uint32_t wrong = 0; wrong <= 257; wrong += 257) {
    i.header->chunk_count = wrong;
    field_seal(&i);
    assert_field_refused(&i, OLX_ERROR_FORMAT, "chunks are not in 1..256");
  }
  // The header states the file's true size, but the file is too short for a chunk table.
  *i.header = good;
  i.header->file_bytes = i.size_bytes = 128;
  i.header->header_hash = olx_content_hash(i.header, 56);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "truncated inside the chunk table");
  i.size_bytes = size_bytes;
  *i.header = good;
  i.chunks[3].size_bytes ^= 1;
  assert_field_refused(&i, OLX_ERROR_CHECKSUM, "chunk table: wrong checksum");
  i.chunks[3].size_bytes ^= 1;

  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes + 1, i.size_bytes - 1, &field), OLX_ERROR_ARGUMENT);
  assert_says("not aligned");
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  olx_field_close(field);
  olx_release(i.bytes);
}

// A file of version 1 cannot be used, but can be described.
static void test_describes_version_1(void **state) {
  const field_fixture *f = *state;
  const field_image i = field_image_load(*state, &small);
  olx_field_info info = {0};
  assert_int_equal(olx_field_describe_version_1(f->path, &info), OLX_ERROR_VERSION);
  assert_says("format version 2 is newer than the 1");
  i.header->version = 1;
  field_seal(&i);
  assert_int_equal(olx_write_file(f->path, i.bytes, i.size_bytes), OLX_OK);
  assert_int_equal(olx_field_describe_version_1(f->path, &info), OLX_OK);
  assert_true(info.probes.count == 12 && info.maps.size == 16 && info.scene.hash == 0x0123456789ABCDEFu);
  assert_true(info.bytes.file == i.size_bytes && info.bytes.radiance == 0);
  i.info->probe_count = 0;
  assert_int_equal(olx_write_file(f->path, i.bytes, i.size_bytes), OLX_OK);
  assert_int_equal(olx_field_describe_version_1(f->path, &info), OLX_ERROR_CHECKSUM);
  field_seal(&i);
  assert_int_equal(olx_write_file(f->path, i.bytes, i.size_bytes), OLX_OK);
  assert_int_equal(olx_field_describe_version_1(f->path, &info), OLX_ERROR_FORMAT);
  assert_says("no light field probes");
  assert_int_equal(olx_write_file(f->path, i.bytes, 100), OLX_OK);
  assert_int_equal(olx_field_describe_version_1(f->path, &info), OLX_ERROR_FORMAT);
  olx_release(i.bytes);
}

static void test_refuses_a_wrong_chunk_table(void **state) {
  field_image i = field_image_load(*state, &small);
  olx_file_chunk good[REQUIRED];
  memcpy(good, i.chunks, sizeof good);
  olx_file_chunk *normal = &i.chunks[OLX_CHUNK_NORMAL];
#define REFUSED(result, message)                                                                                       \
  field_seal_table(&i);                                                                                                \
  assert_field_refused(&i, result, message);                                                                           \
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
  normal->offset -= 64; // overlaps the chunk before
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): begins at byte");
  normal->offset += 4;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): begins at byte");
  normal->size_bytes = UINT64_MAX;
  REFUSED(OLX_ERROR_FORMAT, "chunk 4 (NORM): 18446744073709551615 bytes");
  // The size does not overflow the sum of offset and size, but its padding does.
  normal->size_bytes = UINT64_MAX - normal->offset;
  REFUSED(OLX_ERROR_FORMAT, "reach beyond the end of the file");
  i.chunks[TILES].size_bytes -= 64;
  REFUSED(OLX_ERROR_FORMAT, "bytes after the last chunk");
  normal->size_bytes -= 1; // the next chunk still begins at the same byte
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
  // The last chunk's padding would end after the end of the file, which is cut within the padding.
  i.chunks[TILES].size_bytes -= 40;
  i.header->file_bytes -= 32;
  i.size_bytes -= 32;
  REFUSED(OLX_ERROR_FORMAT, "its padding reaches beyond");
#undef REFUSED
  olx_release(i.bytes);
}

// Makes the same file with one more chunk at the end of the table.
static field_image with_chunk(const field_image *from, uint32_t type, uint32_t flags) {
  const size_t old_table = REQUIRED * sizeof(olx_file_chunk), head = 64 + old_table;
  field_image i = {.size_bytes = from->size_bytes + 64 + 64};
  i.bytes = olx_allocate_zero(i.size_bytes, 1);
  memcpy(i.bytes, from->bytes, head);
  memcpy(i.bytes + head + 64, from->bytes + head, from->size_bytes - head);
  i.header = (olx_file_header *)i.bytes;
  i.chunks = (olx_file_chunk *)(i.bytes + 64);
  i.header->chunk_count++;
  i.header->file_bytes = i.size_bytes;
  for (uint32_t k = 0; k < REQUIRED; k++) i.chunks[k].offset += 64;
  memcpy(i.bytes + i.size_bytes - 64, "something new", 13);
  i.chunks[REQUIRED] = (olx_file_chunk){.type = type,
                                        .flags = flags,
                                        .offset = i.size_bytes - 64,
                                        .size_bytes = 13,
                                        .record_bytes = 13,
                                        .element_bytes = 1,
                                        .hash = olx_content_hash("something new", 13)};
  field_seal_table(&i);
  return i;
}

static void test_skips_unknown_optional_chunks_only(void **state) {
  const field_image plain = field_image_load(*state, &small);
  const uint32_t type = OLX_FOUR_CC('G', 'L', 'O', 'W');
  field_image i = with_chunk(&plain, type, 0);
  assert_field_refused(&i, OLX_ERROR_UNSUPPORTED, "chunk 19 (GLOW) is required");
  olx_release(i.bytes);

  i = with_chunk(&plain, type, OLX_CHUNK_OPTIONAL);
  assert_field_sound(&i);
  i.bytes[i.size_bytes - 60] ^= 1;
  assert_field_unverified(&i, OLX_ERROR_CHECKSUM, "chunk 19 (GLOW): wrong checksum");
  i.bytes[i.size_bytes - 60] ^= 1;
  i.bytes[i.size_bytes - 1] = 1;
  assert_field_unverified(&i, OLX_ERROR_FORMAT, "chunk 19 (GLOW): padding");
  olx_release(i.bytes);

  i = with_chunk(&plain, plain.chunks[OLX_CHUNK_RADIANCE].type, 0);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "two chunks RADI");
  olx_release(i.bytes);
  olx_release(plain.bytes);
}

static void test_refuses_a_wrong_description(void **state) {
  const field_image i = field_image_load(*state, &small);
  const olx_file_info good = *i.info;
#define REFUSED(change, message)                                                                                       \
  i.info->change;                                                                                                      \
  field_seal(&i);                                                                                                      \
  assert_field_refused(&i, OLX_ERROR_FORMAT, message);                                                                 \
  *i.info = good
  REFUSED(radiance_size = 4, "radiance size 4 is not");
  REFUSED(radiance_size = 24, "radiance size 24 is not");
  REFUSED(radiance_size = 4096, "radiance size 4096 is not");
  REFUSED(radiance_size = 0, "radiance size 0 is not");
  REFUSED(radiance_size = 32, "chunk RADI: ");
  REFUSED(irradiance_size = 512, "irradiance size 512 is not");
  REFUSED(irradiance_size = 16, "chunk IRRA: ");
  REFUSED(probe_count = 0, "no light field probes");
  REFUSED(irradiance_probe_count = 0, "more probes are buried than there are");
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
  REFUSED(last_bounce = -0.1f, "last bounce of -0.1");
  REFUSED(last_bounce = 1.5f, "last bounce of 1.5");
  REFUSED(last_bounce = NAN, "last bounce");
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
  REFUSED(has_grid = 2, "a flag that is not 0 or 1");
  REFUSED(has_grid = 0, "the cage selector needs light field probes on a grid");
  REFUSED(irradiance_form = 3, "unknown form of irradiance 3");
  REFUSED(irradiance_form = UINT32_MAX, "unknown form of irradiance");
  REFUSED(irradiance_form = OLX_IRRADIANCE_SH2, "no chunk IRSH");
  REFUSED(form = 8, "an unknown form");
  REFUSED(form = 2, "a chunk NORM, but the description has geometry in blocks");
  REFUSED(form = 4, "no chunk TBAS");
#undef REFUSED
  i.info->select_mask = 1u << OLX_SELECT_BRICKS; // a selector whose chunk is missing
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "no chunk BRIK, but the description names its selector");
  *i.info = good;
  i.info->select_mask = 1u << 31 | 1u; // an unknown later selector beside a known one
  field_seal(&i);
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  olx_field_close(field);
  *i.info = good;

  float *position = field_chunk(&i, OLX_CHUNK_PROBE_POSITIONS);
  position[3 * 7 + 2] = NAN;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "position of light field probe 7 is out of range");
  position[3 * 7 + 2] = 1.0f;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "light field probe 7 stands at");
  olx_release(i.bytes);
}

static void test_verify_sees_every_flipped_bit(void **state) {
  const field_image i = field_image_load(*state, &small);
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
  // Flips a bit in every chunk, and in the padding after each.
  for (uint32_t k = 0; k < REQUIRED; k++) {
    const olx_file_chunk *chunk = &i.chunks[k];
    if (k != OLX_CHUNK_INFO && k != OLX_CHUNK_LIGHTS) { // the contents of these chunks are checked on opening
      char message[64];
      snprintf(message, sizeof message, "chunk %u (%s): wrong checksum", k, olx_chunk_type_name(chunk->type).text);
      i.bytes[chunk->offset] ^= 4;
      assert_field_unverified(&i, OLX_ERROR_CHECKSUM, message);
      i.bytes[chunk->offset] ^= 4;
    }
    if (chunk->size_bytes % 64 == 0) continue;
    i.bytes[chunk->offset + chunk->size_bytes] = 0x10;
    assert_field_unverified(&i, OLX_ERROR_FORMAT, "padding at byte");
    i.bytes[chunk->offset + chunk->size_bytes] = 0;
  }
  olx_release(i.bytes);
}

static void test_verify_reads_the_content(void **state) {
  const field_image i = field_image_load(*state, &small);
  const size_t texels = 18 * 18, inner = 5 * 18 + 7; // `inner` is texel (6, 4)
#define REFUSED(kind, type, index, value, message)                                                                     \
  do {                                                                                                                 \
    type *codes = field_chunk(&i, kind);                                                                               \
    const type good = codes[index];                                                                                    \
    codes[index] = (type)(value);                                                                                      \
    field_seal(&i);                                                                                                    \
    assert_field_unverified(&i, OLX_ERROR_FORMAT, message);                                                            \
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
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

static void test_refuses_wrong_lights(void **state) {
  field_image i = field_image_load(*state, &small);
  olx_field_light *lights = field_chunk(&i, OLX_CHUNK_LIGHTS);
#define REFUSED(index, change, message)                                                                                \
  do {                                                                                                                 \
    const olx_field_light good = lights[index];                                                                        \
    lights[index].change;                                                                                              \
    field_seal(&i);                                                                                                    \
    assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk LITE: light " #index ": " message);                              \
    lights[index] = good;                                                                                              \
  } while (0)
  REFUSED(0, type = 3, "unknown type");
  REFUSED(0, position.x = 1.0f, "impossible position"); // a sun has no position
  REFUSED(0, direction.x = 1.0f, "impossible direction");
  REFUSED(0, direction.y = NAN, "impossible direction");
  REFUSED(0, emission.x = NAN, "impossible emission");
  REFUSED(1, emission.y = INFINITY, "impossible emission");
  REFUSED(1, position.y = 2e18f, "impossible position");
  REFUSED(1, direction.z = 1.0f, "impossible direction"); // a point light has no direction
  REFUSED(1, cosine_inner = 0.5f, "impossible cone");
  REFUSED(2, position.z = NAN, "impossible position");
  REFUSED(2, cosine_outer = 0.95f, "impossible cone");
  REFUSED(2, cosine_inner = 1.5f, "impossible cone");
  REFUSED(2, cosine_outer = NAN, "impossible cone");
  REFUSED(2, zero[3] = 1, "reserved bytes");
#undef REFUSED
  olx_file_chunk *chunk = &i.chunks[OLX_CHUNK_LIGHTS];
  const olx_file_chunk good = *chunk;
  chunk->size_bytes -= 32;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk LITE: 160 bytes in records of 64");
  *chunk = good;
  chunk->record_bytes = 32;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk LITE: 192 bytes in records of 32");
  *chunk = good;
  i.chunks[TILES].element_bytes = 2;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk ETIL: 9216 bytes in records of 256 and elements of 2");
  i.chunks[TILES].element_bytes = 4;
  i.chunks[TILES].flags = OLX_CHUNK_OPTIONAL;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk ETIL: flagged optional, but it is not");
  i.chunks[TILES].flags = 0;
  i.chunks[TILES].type = OLX_FOUR_CC('E', 't', 'i', 'l');
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_UNSUPPORTED, "chunk 18 (Etil) is required");
  olx_release(i.bytes);
}

static void test_verify_reads_surfaces(void **state) {
  const field_image i = field_image_load(*state, &small);
  const uint16_t *distance = field_chunk(&i, OLX_CHUNK_DISTANCE);
  size_t sky = 19, wall = 19; // texels inside the first probe's map, without its border
  for (; distance[sky] != 0x7C00; sky++) continue;
  for (; distance[wall] >= 0x7C00; wall++) continue;
#define UNVERIFIED(kind, type, index, value, message)                                                                  \
  do {                                                                                                                 \
    type *codes = field_chunk(&i, kind);                                                                               \
    const type good = codes[index];                                                                                    \
    codes[index] = (type)(value);                                                                                      \
    field_seal(&i);                                                                                                    \
    assert_field_unverified(&i, OLX_ERROR_FORMAT, message);                                                            \
    codes[index] = good;                                                                                               \
  } while (0)
  UNVERIFIED(OLX_CHUNK_BASE, uint32_t, 0, 1, "base colour of probe 0: border texel (-1, -1) differs");
  UNVERIFIED(OLX_CHUNK_SPECULAR, uint16_t, 324 * 3, 1, "specular of probe 3: border texel (-1, -1) differs");
  UNVERIFIED(OLX_CHUNK_DIRECT, uint32_t, 324 * 11, 1, "direct light of probe 11: border texel (-1, -1) differs");
  UNVERIFIED(OLX_CHUNK_INDIRECT, uint32_t, 323, 1, "indirect light of probe 0: border texel (16, 16) differs");
  // The border repeats some inner texels, so the sky is searched for away from the edge.
  for (; distance[sky] != 0x7C00 || sky % 18 < 2 || sky % 18 > 15 || sky / 18 < 2; sky++) continue;
  UNVERIFIED(OLX_CHUNK_BASE, uint32_t, sky, 1, "base colour of probe 0, texel (");
  UNVERIFIED(OLX_CHUNK_SPECULAR, uint16_t, sky, 1, "): not 0, but it sees the sky");
  UNVERIFIED(OLX_CHUNK_DIRECT, uint32_t, sky, 1, "direct light of probe 0, texel (");
  UNVERIFIED(OLX_CHUNK_INDIRECT, uint32_t, sky, 1, "indirect light of probe 0, texel (");
  UNVERIFIED(OLX_CHUNK_EMISSION, uint32_t, 4 * 5 + 3, 37, "emission of probe 5, tile (1, 1): tile 36 of 36");
  UNVERIFIED(OLX_CHUNK_EMISSION, uint32_t, 4 * 5 + 3, UINT32_MAX, "emission of probe 5, tile (1, 1): tile 4294967294");
  const size_t x = wall % 18 - 1, y = wall / 18 - 1;
  UNVERIFIED(TILES, uint32_t, (y / 8 * 2 + x / 8) * 64 + y % 8 * 8 + x % 8, 1,
             "not 0, but its distance marks no emitter");
#undef UNVERIFIED
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// The form that a description states must agree with the chunks, and an older reader refuses chunks that it does not
// know.
static void test_refuses_texels_for_tiles(void **state) {
  const field_image i = field_image_load(*state, &of_blocks);
  const olx_file_info good = *i.info;
  i.info->form = 0;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "no chunk BASE");
  i.info->form = 12;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "a flag that is not 0 or 1");
  i.info->form = 1;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_UNSUPPORTED, "tiles have replaced; bake the scene again");
  *i.info = good;
  const olx_chunk_kind kinds[] = {OLX_CHUNK_BASE, OLX_CHUNK_SPECULAR, OLX_CHUNK_DIRECT, OLX_CHUNK_INDIRECT};
  static const char *const names[] = {"TBAS", "TREF", "TDIR", "TIND"};
  for (uint32_t k = 0; k < 4; k++) {
    olx_file_chunk *chunk = &i.chunks[kinds[k]];
    const olx_file_chunk kept = *chunk;
    char message[32];
    snprintf(message, sizeof message, "no chunk %s", names[k]);
    chunk->type = OLX_FOUR_CC('B', 'A', 'S', 'E');
    field_seal(&i);
    assert_field_refused(&i, OLX_ERROR_FORMAT, message);
    *chunk = kept;
    chunk->record_bytes *= 2;
    field_seal(&i);
    assert_field_refused(&i, OLX_ERROR_FORMAT, names[k]);
    *chunk = kept;
  }
  olx_release(i.bytes);
}

// Tiles name blocks that exist, those of sky alone are 0, and blocks of light have fourteen valid modes.
static void test_verify_reads_tiles(void **state) {
  const field_image i = field_image_load(*state, &of_blocks);
  enum { PROBE = 7, TILES_A_PROBE = 4, POOLS = OLX_CHUNK_REQUIRED + 1 };
  static const char *const names[] = {"base colour", "reflectance", "direct light", "indirect light"};
  char message[96];
  for (uint32_t map = 0; map < OLX_SURFACE_MAPS; map++) {
    uint32_t *word = (uint32_t *)field_chunk(&i, OLX_CHUNK_BASE + map) + TILES_A_PROBE * PROBE + 1;
    const uint32_t good = *word, blocks = (uint32_t)i.chunks[POOLS + map].size_bytes / olx_surface_block_bytes(map);
    const struct {
      uint32_t word;
      const char *problem;
    } damages[] = {{0, "a tile of no form"},
                   {3u << 30, "a tile of no form"},
                   {1u << 30 | blocks, "a tile of blocks that are not there"},
                   {2u << 30 | (blocks - 3), "a tile of blocks that are not there"}};
    for (uint32_t k = 0; k < sizeof damages / sizeof damages[0]; k++) {
      *word = damages[k].word;
      field_seal(&i);
      snprintf(message, sizeof message, "%s of probe 7, texel (8, 0): %s", names[map], damages[k].problem);
      assert_field_unverified(&i, OLX_ERROR_FORMAT, message);
    }
    *word = good;
    if (map < OLX_SURFACE_DIRECT) continue;
    olx_bc6h_block *block = (olx_bc6h_block *)field_chunk(&i, POOLS + map) + (good & 0x3FFFFFFFu);
    for (uint32_t mode = 0; mode < 32; mode++) {
      const uint32_t first = block->words[0];
      block->words[0] = (first & ~31u) | mode;
      field_seal(&i);
      snprintf(message, sizeof message, "%s of probe 7, texel (8, 0): a block of no mode", names[map]);
      if (mode == 19 || mode == 23 || mode == 27 || mode == 31) assert_field_unverified(&i, OLX_ERROR_FORMAT, message);
      else assert_field_sound(&i);
      block->words[0] = first;
    }
  }
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// Returns the first geometry block that the encoder wrote in this form.
static olx_geometry_block *block_of_form(const field_image *i, uint32_t form) {
  const olx_file_chunk *chunk = field_chunk_of_type(i, OLX_FOUR_CC('G', 'E', 'O', 'M'));
  olx_geometry_block *blocks = (olx_geometry_block *)(i->bytes + chunk->offset);
  for (size_t k = 0; k < chunk->size_bytes / sizeof *blocks; k++) {
    const uint32_t *w = blocks[k].words;
    if (w[3] >> 30 == form && (w[0] || w[1] || w[2])) return &blocks[k];
  }
  fail_msg("no block of form %u", form);
  return NULL;
}

// Verifying refuses geometry blocks that are invalid, that name planes outside the pool or state a wrong nearest
// distance of their planes, and pyramids that do not agree with the blocks.
static void test_verify_reads_geometry(void **state) {
  const field_image i = field_image_load(*state, &of_planes);
  assert_field_sound(&i);
  const struct damage {
    uint32_t form, word, flipped;
    const char *message;
  } damages[] = {
      {OLX_GEOMETRY_POOL, 3, 1u << 30, "unknown form"},
      {OLX_GEOMETRY_POOL, 0, 1u << 31, "a plane that is not in the pool"},
      {OLX_GEOMETRY_POOL, 3, 1, "planes that come nearer or less near than it says"},
      {OLX_GEOMETRY_TWO, 2, 1u << 31, "reserved bits"},
  };
  for (uint32_t k = 0; k < sizeof damages / sizeof damages[0]; k++) {
    olx_geometry_block *block = block_of_form(&i, damages[k].form);
    block->words[damages[k].word] ^= damages[k].flipped;
    field_seal(&i);
    assert_field_unverified(&i, OLX_ERROR_FORMAT, damages[k].message);
    block->words[damages[k].word] ^= damages[k].flipped;
  }
  uint16_t *nodes = (uint16_t *)(i.bytes + field_chunk_of_type(&i, OLX_FOUR_CC('D', 'M', 'I', 'N'))->offset);
  nodes[3]++;
  field_seal(&i);
  assert_field_unverified(&i, OLX_ERROR_FORMAT, "least distance of probe 0, level 1, node (3, 0)");
  nodes[3]--;
  olx_file_chunk *planes = field_chunk_of_type(&i, OLX_FOUR_CC('P', 'L', 'A', 'N'));
  planes->record_bytes = 16;
  field_seal(&i);
  assert_field_refused(&i, OLX_ERROR_FORMAT, "chunk PLAN");
  planes->record_bytes = 8;
  field_seal(&i);
  assert_field_sound(&i);
  olx_release(i.bytes);
}

// Emission tiles that a damaged file refers to, but does not have, are not read.
static void test_emission_stays_inside(void **state) {
  const field_image i = field_image_load(*state, &small);
  uint32_t *entries = field_chunk(&i, OLX_CHUNK_EMISSION);
  const uint16_t *distance = field_chunk(&i, OLX_CHUNK_DISTANCE);
  size_t sky = 19;
  for (; distance[sky] != 0x7C00; sky++) continue;
  olx_field *field;
  assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
  assert_true(olx_texel_emission(field, 0, sky).x == 20.0f);
  static const uint32_t wrong[] = {37, 1u << 31, UINT32_MAX};
  for (uint32_t k = 0; k < 3; k++) {
    for (uint32_t tile = 0; tile < 4; tile++) entries[tile] = wrong[k];
    assert_true(olx_texel_emission(field, 0, sky).x == 0.0f);
  }
  olx_field_close(field);
  olx_release(i.bytes);
}

// Rounding a mean up and a second moment down to half floats is not an error: every mean with its own square is
// accepted.
static void test_rounded_moments_are_possible(void **state) {
  const field_image i = field_image_load(*state, &least);
  uint32_t *moments = field_chunk(&i, OLX_CHUNK_MOMENTS);
  for (uint32_t pass = 0; pass < 2000; pass++) {
    const float mean = (float)(pass + 1) / 2000.0f;
    for (uint32_t t = 0; t < 100; t++) {
      moments[t] = olx_half_pack(mean) | (uint32_t)olx_half_pack(mean * mean) << 16;
    }
    i.chunks[OLX_CHUNK_MOMENTS].hash = olx_content_hash(moments, 400);
    field_seal_table(&i);
    olx_field *field;
    assert_int_equal(olx_field_open_memory(i.bytes, i.size_bytes, &field), OLX_OK);
    if (olx_field_verify(field) != OLX_OK) fail_msg("mean %g: %s", (double)mean, olx_last_error());
    olx_field_close(field);
  }
  olx_release(i.bytes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_refuses_a_wrong_header, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_describes_version_1, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_a_wrong_chunk_table, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_skips_unknown_optional_chunks_only, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_a_wrong_description, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_sees_every_flipped_bit, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_the_content, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_wrong_lights, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_surfaces, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_refuses_texels_for_tiles, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_tiles, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_verify_reads_geometry, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_emission_stays_inside, field_set_up, field_tear_down),
      cmocka_unit_test_setup_teardown(test_rounded_moments_are_possible, field_set_up, field_tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
