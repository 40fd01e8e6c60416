// Writes KTX 2.0 files (Khronos, "KTX File Format Specification", version 2.0): the header, one level, the description
// of the format (Khronos, "Data Format Specification" 1.3), entries of text, and texels. Every number is little-endian.
#include "export/ktx2_file.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>
#include <zstd.h>

enum {
  E5B9G9R9_UFLOAT_PACK32 = 123, // of VkFormat
  HEADER_BYTES = 104,           // with the index and one level
  CHANNELS = 3,
  SAMPLE_BYTES = 16,
  FORMAT_BYTES = 28 + 2 * CHANNELS * SAMPLE_BYTES, // with the size before it
  // Of the data format: the colour model, primaries of Rec.709 and a linear transfer.
  MODEL_RGBSDA = 1,
  PRIMARIES_BT709 = 1,
  TRANSFER_LINEAR = 1,
  VERSION_1_3 = 2,
  IS_EXPONENT = 0x20,
  MANTISSA_BITS = 9,
  EXPONENT_BITS = 5,
  EXPONENT_SHIFT = 27,
  EXPONENT_BIAS = 15,
  SUPERCOMPRESSION_ZSTD = 2,
  ZSTD_LEVEL = 19,
  ONE = 8448 // the mantissa's upper bound in the specification's own example of the format
};

static const char WRITER_KEY[] = "KTXwriter", WRITER[] = "octalux";

typedef struct byte_writer {
  uint8_t *at;
} byte_writer;

static void put_u32(byte_writer *w, uint32_t value) {
  for (uint32_t i = 0; i < 4; i++) *w->at++ = (uint8_t)(value >> 8 * i);
}
static void put_u64(byte_writer *w, uint64_t value) {
  put_u32(w, (uint32_t)value);
  put_u32(w, (uint32_t)(value >> 32));
}
static void put_bytes(byte_writer *w, const void *bytes, size_t count) {
  memcpy(w->at, bytes, count);
  w->at += count;
}

// Each entry is padded to four bytes; both strings end in a zero.
static size_t entry_length(const char *key, const char *text) { return strlen(key) + strlen(text) + 2; }
static size_t entry_bytes(const char *key, const char *text) { return 4 + (entry_length(key, text) + 3) / 4 * 4; }

static void put_entry(byte_writer *w, const char *key, const char *text) {
  uint8_t *end = w->at + entry_bytes(key, text);
  put_u32(w, (uint32_t)entry_length(key, text));
  put_bytes(w, key, strlen(key) + 1);
  put_bytes(w, text, strlen(text) + 1);
  while (w->at < end) *w->at++ = 0;
}

// Describes `bits` bits of a texel.
static void put_sample(byte_writer *w, uint32_t first_bit, uint32_t bits, uint32_t channel, uint32_t lower,
                       uint32_t upper) {
  put_u32(w, first_bit | (bits - 1) << 16 | channel << 24);
  put_u32(w, 0); // the sample's place in the texel
  put_u32(w, lower);
  put_u32(w, upper);
}

// Describes RGB9E5: three mantissas, each with the exponent that all share.
static void put_format(byte_writer *w) {
  put_u32(w, FORMAT_BYTES);
  put_u32(w, 0); // a basic descriptor of Khronos
  put_u32(w, VERSION_1_3 | (uint32_t)(FORMAT_BYTES - 4) << 16);
  put_u32(w, MODEL_RGBSDA | PRIMARIES_BT709 << 8 | TRANSFER_LINEAR << 16);
  put_u32(w, 0); // blocks of one texel
  put_u32(w, 4); // bytes of a texel
  put_u32(w, 0);
  for (uint32_t channel = 0; channel < CHANNELS; channel++) {
    put_sample(w, channel * MANTISSA_BITS, MANTISSA_BITS, channel, 0, ONE);
    put_sample(w, EXPONENT_SHIFT, EXPONENT_BITS, channel | IS_EXPONENT, EXPONENT_BIAS, (1u << EXPONENT_BITS) - 1);
  }
}

// The file's parts: places and sizes in bytes, and the texels as they are stored.
typedef struct file_plan {
  size_t entries_bytes, texels_offset, texels_bytes, stored_bytes;
  const uint8_t *stored;
} file_plan;

static file_plan plan_file(const olx_ktx2_texture *t, const uint8_t *stored, size_t stored_bytes) {
  const size_t entries = entry_bytes(WRITER_KEY, WRITER) + entry_bytes(t->key, t->text);
  return (file_plan){.entries_bytes = entries,
                     .texels_offset = HEADER_BYTES + FORMAT_BYTES + entries,
                     .texels_bytes = 4 * (size_t)t->size[0] * t->size[1] * t->size[2],
                     .stored_bytes = stored_bytes,
                     .stored = stored};
}

static void put_header(byte_writer *w, const olx_ktx2_texture *t, const file_plan *plan) {
  static const uint8_t magic[12] = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
  put_bytes(w, magic, sizeof magic);
  put_u32(w, E5B9G9R9_UFLOAT_PACK32);
  put_u32(w, 4); // bytes of the words that other byte orders swap
  for (uint32_t i = 0; i < 3; i++) put_u32(w, t->size[i]);
  put_u32(w, 0); // no array
  put_u32(w, 1); // faces
  put_u32(w, 1); // levels
  put_u32(w, t->zstd ? SUPERCOMPRESSION_ZSTD : 0);
  put_u32(w, HEADER_BYTES);
  put_u32(w, FORMAT_BYTES);
  put_u32(w, HEADER_BYTES + FORMAT_BYTES);
  put_u32(w, (uint32_t)plan->entries_bytes);
  put_u64(w, 0); // no data of a supercompression
  put_u64(w, 0);
  put_u64(w, plan->texels_offset);
  put_u64(w, plan->stored_bytes);
  put_u64(w, plan->texels_bytes);
}

static olx_result write_parts(const olx_ktx2_texture *texture, const file_plan *plan, const char *path) {
  const size_t size_bytes = plan->texels_offset + plan->stored_bytes;
  uint8_t *bytes = olx_allocate(size_bytes, 1);
  if (!bytes) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  byte_writer w = {bytes};
  put_header(&w, texture, plan);
  put_format(&w);
  put_entry(&w, WRITER_KEY, WRITER);
  put_entry(&w, texture->key, texture->text);
  put_bytes(&w, plan->stored, plan->stored_bytes);
  const olx_result result = olx_write_file(path, bytes, size_bytes);
  olx_release(bytes);
  return result;
}

// Stores the texels in `stored`, which has room for `most` bytes; returns their size in bytes, 0 when zstd fails.
static size_t store_texels(const olx_ktx2_texture *t, uint8_t *raw, size_t raw_bytes, uint8_t *stored, size_t most) {
  byte_writer w = {raw};
  for (size_t i = 0; i < raw_bytes / 4; i++) put_u32(&w, t->texels[i]);
  if (!t->zstd) return raw_bytes;
  const size_t size_bytes = ZSTD_compress(stored, most, raw, raw_bytes, ZSTD_LEVEL);
  return ZSTD_isError(size_bytes) ? 0 : size_bytes;
}

olx_result olx_ktx2_write(const olx_ktx2_texture *texture, const char *path, uint64_t *file_bytes) {
  const size_t raw_bytes = 4 * (size_t)texture->size[0] * texture->size[1] * texture->size[2];
  const size_t most = texture->zstd ? ZSTD_compressBound(raw_bytes) : 0;
  uint8_t *raw = olx_allocate(raw_bytes, 1), *packed = olx_allocate(most, 1);
  const size_t stored_bytes = raw && packed ? store_texels(texture, raw, raw_bytes, packed, most) : 0;
  olx_result result = OLX_OK;
  if (stored_bytes) {
    const file_plan plan = plan_file(texture, texture->zstd ? packed : raw, stored_bytes);
    result = write_parts(texture, &plan, path);
    if (file_bytes) *file_bytes = plan.texels_offset + plan.stored_bytes;
  } else {
    result = olx_fail(OLX_ERROR_MEMORY, "%s: no memory for %zu bytes of texels", path, raw_bytes);
  }
  olx_release(raw);
  olx_release(packed);
  return result;
}
