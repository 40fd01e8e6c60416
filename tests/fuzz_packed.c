// Unpacks COUNT mutated packed fields: fuzz_packed COUNT [SEED]. Each must be refused with a message, or give the very
// field that was packed, or another one whose own checksums are right; no memory may be used beyond what blocks need.
// Most files have right checksums, so that the checks behind them are reached. Files depend on (seed, round) alone.
#include "packed_fields.h"

#include "core/hooks.h"
#include "core/sampling.h"
#include "counted_memory.h"
#include "synthetic_field.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_ADDED = 256 };

typedef struct random_stream {
  uint32_t seed, round, drawn;
} random_stream;

static uint32_t draw(random_stream *r, uint32_t below) {
  const uint32_t bits = olx_hash3(r->seed, r->round, r->drawn++);
  return below ? (uint32_t)(((uint64_t)bits * below) >> 32) : bits;
}

static uint64_t extreme_number(random_stream *r) {
  static const uint64_t numbers[] = {0,
                                     1,
                                     2,
                                     3,
                                     4,
                                     8,
                                     63,
                                     64,
                                     65,
                                     255,
                                     256,
                                     1 << 20,
                                     (1 << 20) + 1,
                                     0x00FFFFFF,
                                     0x7FFFFFFF,
                                     0x80000000,
                                     UINT32_MAX,
                                     UINT64_C(1) << 35,
                                     UINT64_C(1) << 40,
                                     UINT64_C(1) << 63,
                                     UINT64_MAX,
                                     UINT64_MAX - 63};
  return draw(r, 4) ? numbers[draw(r, sizeof numbers / sizeof *numbers)] : draw(r, 0);
}

static void flip_bit(random_stream *r, unsigned char *bytes, size_t size_bytes) {
  if (size_bytes) bytes[draw(r, (uint32_t)size_bytes)] ^= (unsigned char)(1u << draw(r, 8));
}

static void spoil_word(random_stream *r, void *words, size_t size_bytes) {
  const uint64_t number = extreme_number(r);
  const size_t wide = draw(r, 2) ? 8 : 4;
  memcpy((char *)words + 4 * (size_t)draw(r, (uint32_t)(size_bytes / 4 - 1)), &number, wide);
}

// Damages blocks of a chunk, found by the original's table, since the mutant's may be damaged.
static void spoil_blocks(random_stream *r, const packed_image *original, packed_image *i) {
  const uint32_t index = draw(r, original->field_header->chunk_count);
  const olx_file_chunk *chunk = &original->chunks[index + 1];
  if (draw(r, 2)) {
    flip_bit(r, i->bytes + chunk->offset, chunk->size_bytes);
  } else if (chunk->size_bytes) {
    const uint32_t number = (uint32_t)extreme_number(r);
    memcpy(i->bytes + (packed_image_words(original, index) - original->bytes), &number, sizeof number);
  }
}

// Makes a small file claim a large field, with consistent tables.
static void inflate(random_stream *r, uint32_t count, const packed_image *i) {
  const uint32_t index = draw(r, count);
  i->field_chunks[index].size_bytes += (uint64_t)draw(r, 1u << 20) << draw(r, 24);
  for (uint32_t k = index + 1; k < count; k++) {
    i->field_chunks[k].offset = olx_align_chunk(i->field_chunks[k - 1].offset + i->field_chunks[k - 1].size_bytes);
  }
  i->field_header->file_bytes =
      olx_align_chunk(i->field_chunks[count - 1].offset + i->field_chunks[count - 1].size_bytes);
}

static void change_size(random_stream *r, packed_image *i) {
  if (draw(r, 2)) {
    i->size_bytes = draw(r, (uint32_t)i->size_bytes);
  } else {
    const size_t added = 1 + draw(r, MOST_ADDED);
    memset(i->bytes + i->size_bytes, (int)draw(r, 2), added);
    i->size_bytes += added;
  }
  if (draw(r, 2) && i->size_bytes >= sizeof(olx_file_header)) i->header->file_bytes = i->size_bytes;
}

static void spoil(random_stream *r, const packed_image *original, packed_image *i) {
  const uint32_t count = original->field_header->chunk_count;
  switch (draw(r, 8)) {
  case 0: spoil_word(r, i->header, sizeof *i->header); break;
  case 1: spoil_word(r, i->chunks, (count + 1) * sizeof(olx_file_chunk)); break;
  case 2: spoil_word(r, i->field_header, sizeof *i->field_header); break;
  case 3: spoil_word(r, i->field_chunks, count * sizeof(olx_file_chunk)); break;
  case 4: inflate(r, count, i); break;
  case 5: flip_bit(r, i->bytes, original->size_bytes); break;
  default: spoil_blocks(r, original, i);
  }
}

static void make_mutant(uint32_t seed, uint32_t round, const packed_image *original, packed_image *mutant) {
  random_stream r = {.seed = seed, .round = round};
  memcpy(mutant->bytes, original->bytes, original->size_bytes);
  mutant->size_bytes = original->size_bytes;
  for (uint32_t count = 1 + draw(&r, 3); count > 0; count--) spoil(&r, original, mutant);
  if (draw(&r, 8) == 0) change_size(&r, mutant);
  if (draw(&r, 16)) packed_image_seal(mutant);
}

static void demand(bool holds, const char *what, uint32_t round) {
  if (holds) return;
  fprintf(stderr, "round %u: broken promise: %s: %s\n", round, what, olx_last_error());
  abort();
}

typedef struct folder {
  char path[64], field[96], packed[96], mutant[96], back[96];
} folder;

static bool create_folder(folder *f) {
  snprintf(f->path, sizeof f->path, "/tmp/octalux-packed-XXXXXX");
  if (!mkdtemp(f->path)) return false;
  snprintf(f->field, sizeof f->field, "%s/a.olx", f->path);
  snprintf(f->packed, sizeof f->packed, "%s/a.olxz", f->path);
  snprintf(f->mutant, sizeof f->mutant, "%s/mutant.olxz", f->path);
  snprintf(f->back, sizeof f->back, "%s/back.olx", f->path);
  return true;
}

static void remove_folder(const folder *f) {
  unlink(f->field);
  unlink(f->packed);
  unlink(f->mutant);
  unlink(f->back);
  rmdir(f->path);
}

// Checks that an unpacked field agrees with its header and table, including every checksum.
static void check_field(const char *path, uint32_t round) {
  size_t size_bytes;
  unsigned char *bytes = synthetic_read_file(path, &size_bytes);
  const olx_chunk_file file = {.data = bytes, .size_bytes = size_bytes, .name = path};
  demand(bytes && olx_chunk_file_check(&file, &OLX_FIELD_KIND) == OLX_OK, "a table that is wrong", round);
  for (uint32_t i = 0; i < ((olx_file_header *)bytes)->chunk_count; i++) {
    demand(olx_chunk_check_content(&file, i) == OLX_OK, "a chunk that is wrong", round);
  }
  olx_release(bytes);
}

static bool unpack_mutant(const folder *f, const packed_image *mutant, uint32_t round) {
  const olx_unpack_settings settings = {.most_bytes = 1 << 26, .threads = 1 + round % 2};
  olx_packed_info info;
  if (olx_write_file(f->mutant, mutant->bytes, mutant->size_bytes) != OLX_OK) return false;
  (void)olx_packed_describe(f->mutant, &info);
  unlink(f->back);
  if (olx_field_unpack(f->mutant, &settings, f->back, NULL, &info) == OLX_OK) {
    check_field(f->back, round);
    return true;
  }
  demand(strstr(olx_last_error(), "mutant.olxz") || strstr(olx_last_error(), "back.olx"), "a refusal without a message",
         round);
  demand(access(f->back, F_OK) != 0, "a refused file left an output", round);
  return false;
}

// Returns how many mutants of one field unpack, taking one round in `stride`.
static uint32_t fuzz(const folder *f, const synthetic_shape *shape, uint32_t seed, uint32_t count, uint32_t stride) {
  uint32_t unpacked = 0;
  if (synthetic_write(f->field, shape, NULL) != OLX_OK) abort();
  if (olx_field_pack(f->field, &(olx_pack_settings){.level = 3}, f->packed, NULL, NULL) != OLX_OK) abort();
  packed_image original = packed_image_load(f->packed, 0), mutant = packed_image_load(f->packed, MOST_ADDED);
  const long held = counted_memory_held();
  for (uint32_t round = 0; round < count; round += stride) {
    make_mutant(seed, round, &original, &mutant);
    if (unpack_mutant(f, &mutant, round)) unpacked++;
    demand(counted_memory_held() == held, "memory that was not released", round);
  }
  olx_release(original.bytes);
  olx_release(mutant.bytes);
  return unpacked;
}

int main(int argc, char **argv) {
  static const synthetic_shape tiny = {
      .grid = {2, 1, 1}, .irradiance_grid = {2, 1, 1}, .n = 16, .irradiance_n = 8, .classic_size = 32};
  static const synthetic_shape blocks = {.grid = {5, 2, 2}, .n = 128}; // a field whose chunks have several blocks
  const uint32_t count = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 2000;
  const uint32_t seed = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
  folder f;
  counted_memory_begin();
  if (!create_folder(&f)) return 1;
  const uint32_t unpacked = fuzz(&f, &tiny, seed, count, 1) + fuzz(&f, &blocks, seed, count, 20);
  remove_folder(&f);
  printf("fuzz_packed: %u files and %u of several blocks, seed %u: %u unpacked, the others refused, 0 failures\n",
         count, (count + 19) / 20, seed, unpacked);
  return 0;
}
