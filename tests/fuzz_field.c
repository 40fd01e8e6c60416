// Opens, verifies and sends rays through COUNT spoilt field files: fuzz_field COUNT [SEED [FIRST]]. Nothing may crash.
//
// Every round takes a small valid file, spoils it, opens and verifies it, and, when it opens, sends rays through it. In
// most rounds the checksums are made right again, so that the checks behind them are reached. Nothing may crash, hang
// or touch memory outside the file, and every refusal says why. A round depends on SEED and its number alone: FIRST
// repeats one.
#include "hostile_field.h"
#include "processor_alarm.h"
#include "synthetic_field.h"

#include "core/hooks.h"
#include "field/field_file.h"

#include <octalux/octalux.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define ALL (1u << OLX_SELECT_VORONOI | 1u << OLX_SELECT_OCTREE | 1u << OLX_SELECT_BRICKS)
enum { SHAPES = 19, SECONDS_A_ROUND = 20, MOST_ADDED = 4096 };

static const synthetic_shape shapes[SHAPES] = {
    {.grid = {1, 1, 1}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8},
    {.grid = {2, 2, 2}, .irradiance_grid = {2, 2, 2}, .n = 16, .irradiance_n = 16},
    {.grid = {3, 1, 2}, .irradiance_grid = {1, 3, 1}, .n = 8, .irradiance_n = 8},
    {.grid = {1, 4, 1}, .irradiance_grid = {2, 2, 1}, .n = 32, .irradiance_n = 8},
    {.grid = {1, 1, 1}, .irradiance_grid = {1, 1, 1}, .n = 64, .irradiance_n = 32},
    {.grid = {1, 1, 2}, .irradiance_grid = {1, 2, 2}, .n = 64, .irradiance_n = 8},
    {.grid = {3, 3, 3}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8, .select_mask = ALL},
    {.grid = {20, 7, 2}, .irradiance_grid = {1, 1, 1}, .n = 8, .irradiance_n = 8, .select_mask = ALL},
    {.grid = {1, 1, 1}, .irradiance_grid = {2, 1, 2}, .n = 8, .irradiance_n = 8, .classic_size = 32},
    {.grid = {2, 1, 1},
     .irradiance_grid = {1, 1, 1},
     .n = 8,
     .irradiance_n = 8,
     .select_mask = ALL,
     .classic_size = 64},
    {.grid = {1, 1, 2}, .irradiance_grid = {2, 1, 2}, .n = 8, .irradiance_n = 8, .relight_surfels = 40},
    {.grid = {2, 1, 1}, .n = 64, .select_mask = ALL, .relight_surfels = 600},
    {.grid = {1, 1, 1}, .irradiance_grid = {2, 1, 2}, .n = 8, .irradiance_n = 8, .irradiance_form = OLX_IRRADIANCE_SH2},
    {.grid = {1, 1, 1},
     .irradiance_grid = {2, 2, 2},
     .n = 8,
     .irradiance_n = 16,
     .irradiance_form = OLX_IRRADIANCE_SH3},
    {.grid = {2, 1, 2}, .n = 16, .select_mask = ALL},
    {.grid = {2, 1, 2}, .n = 16, .select_mask = ALL, .compressed = true},
    {.grid = {1, 1, 3}, .irradiance_grid = {1, 1, 1}, .n = 32, .irradiance_n = 8, .compressed = true},
    {.grid = {2, 1, 2}, .n = 16, .select_mask = ALL, .compressed = true, .geometry_blocks = true},
    {.grid = {1, 1, 2},
     .n = 64,
     .select_mask = ALL,
     .compressed = true,
     .geometry_blocks = true,
     .relight_surfels = 600},
};

typedef struct buffer {
  unsigned char *bytes;
  size_t size_bytes;
} buffer;

// --- Spoiling

static olx_file_header *header_of(buffer b) { return (olx_file_header *)b.bytes; }
static olx_file_chunk *table_of(buffer b) { return (olx_file_chunk *)(b.bytes + sizeof(olx_file_header)); }

// Returns the number of entries of the chunk table that are inside the file.
static uint32_t chunks_inside(buffer b) {
  if (b.size_bytes < sizeof(olx_file_header)) return 0;
  const size_t fit = (b.size_bytes - sizeof(olx_file_header)) / sizeof(olx_file_chunk);
  return header_of(b)->chunk_count < fit ? header_of(b)->chunk_count : (uint32_t)fit;
}

// Returns the bytes of a chunk, or none when the table points outside the file.
static buffer chunk_of(buffer b, uint32_t index) {
  if (index >= chunks_inside(b)) return (buffer){0};
  const olx_file_chunk *chunk = &table_of(b)[index];
  if (chunk->offset > b.size_bytes || chunk->size_bytes > b.size_bytes - chunk->offset) return (buffer){0};
  if (chunk->offset % 64 != 0) return (buffer){0};
  return (buffer){b.bytes + chunk->offset, chunk->size_bytes};
}

// Corrects every checksum whose chunk is inside the file.
static void seal(buffer b) {
  if (b.size_bytes < sizeof(olx_file_header)) return;
  const uint32_t count = chunks_inside(b);
  for (uint32_t i = 0; i < count; i++) {
    const buffer chunk = chunk_of(b, i);
    if (chunk.bytes) table_of(b)[i].hash = olx_content_hash(chunk.bytes, chunk.size_bytes);
  }
  header_of(b)->table_hash = olx_content_hash(table_of(b), count * sizeof(olx_file_chunk));
  header_of(b)->header_hash = olx_content_hash(b.bytes, offsetof(olx_file_header, header_hash));
}

static void flip_bits(dice *d, buffer *b) {
  for (uint32_t i = draw_below(d, 16) + 1; i > 0 && b->size_bytes; i--) {
    b->bytes[draw_offset(d, b->size_bytes)] ^= (unsigned char)(1u << draw_below(d, 8));
  }
}

static void overwrite_run(dice *d, buffer *b) {
  if (!b->size_bytes) return;
  const size_t at = draw_offset(d, b->size_bytes), longest = b->size_bytes - at;
  const size_t size_bytes = draw_offset(d, longest < 512 ? longest : 512);
  const uint32_t kind = draw_below(d, 4);
  for (size_t i = 0; i < size_bytes; i++) {
    b->bytes[at + i] = kind == 0 ? 0 : kind == 1 ? 0xFF : kind == 2 ? (unsigned char)draw(d) : b->bytes[i];
  }
}

static void change_size(dice *d, buffer *b) {
  if (draw(d) & 1u) {
    b->size_bytes = draw_offset(d, b->size_bytes);
    if (draw(d) & 1u) b->size_bytes &= ~(size_t)63;
  } else {
    const size_t added = draw_below(d, MOST_ADDED) + 1;
    memset(b->bytes + b->size_bytes, draw(d) & 1u ? 0 : 0xA5, added);
    b->size_bytes += added;
  }
  if ((draw(d) & 1u) && b->size_bytes >= sizeof(olx_file_header)) header_of(*b)->file_bytes = b->size_bytes;
}

static void change_header(dice *d, buffer *b) {
  if (b->size_bytes < sizeof(olx_file_header)) return;
  olx_file_header *header = header_of(*b);
  switch (draw_below(d, 5)) {
  case 0: header->version = extreme_u32(d); break;
  case 1: header->chunk_count = extreme_u32(d); break;
  case 2: header->file_bytes = extreme_u64(d); break;
  case 3: header->zero[draw_below(d, 3)] = extreme_u64(d); break;
  default: header->chunk_count += draw_below(d, 3) - 1; break;
  }
}

static void change_table(dice *d, buffer *b) {
  const uint32_t count = chunks_inside(*b);
  if (count == 0) return;
  olx_file_chunk *chunk = &table_of(*b)[draw_below(d, count)], *other = &table_of(*b)[draw_below(d, count)];
  switch (draw_below(d, 9)) {
  case 0: chunk->type = (draw(d) & 1u) ? extreme_u32(d) : other->type; break;
  case 1: chunk->flags = extreme_u32(d); break;
  case 2: chunk->offset = extreme_u64(d); break;
  case 3: chunk->size_bytes = extreme_u64(d); break;
  case 4: chunk->record_bytes = extreme_u64(d); break;
  case 5: chunk->element_bytes = extreme_u32(d); break;
  case 6: chunk->size_bytes += (uint64_t)draw_below(d, 257) - 128; break;
  case 7: *chunk = *other; break;
  default: {
    const olx_file_chunk swapped = *chunk;
    *chunk = *other;
    *other = swapped;
  }
  }
}

// Changes one or two numbers of the description.
static void change_info(dice *d, buffer *b) {
  const buffer info = chunk_of(*b, OLX_CHUNK_INFO);
  if (info.size_bytes < sizeof(olx_file_info)) return;
  const size_t words = sizeof(olx_file_info) / 4;
  for (uint32_t i = draw_below(d, 2) + 1; i > 0; i--) {
    const size_t word = draw_offset(d, words);
    if (draw(d) & 1u) {
      const uint32_t value = extreme_u32(d);
      memcpy(info.bytes + 4 * word, &value, 4);
    } else {
      const float value = extreme_float(d);
      memcpy(info.bytes + 4 * word, &value, 4);
    }
  }
}

static void change_positions(dice *d, buffer *b) {
  const buffer positions = chunk_of(*b, draw(d) & 1u ? OLX_CHUNK_PROBE_POSITIONS : OLX_CHUNK_IRRADIANCE_POSITIONS);
  if (positions.size_bytes < 4) return;
  const float value = extreme_float(d);
  memcpy(positions.bytes + 4 * draw_offset(d, positions.size_bytes / 4), &value, 4);
}

static void stretch_grid(dice *d, olx_file_grid *grid, buffer positions) {
  if (!grid->count[0] || !grid->count[1] || !grid->count[2]) return;
  const float spacing = powf(10.0f, 36.0f * draw_unit(d) - 18.0f);
  olx_grid moved = {.count = {grid->count[0], grid->count[1], grid->count[2]}};
  float *const spacings[3] = {&moved.spacing.x, &moved.spacing.y, &moved.spacing.z};
  float *const origins[3] = {&moved.origin.x, &moved.origin.y, &moved.origin.z};
  const float away = (draw(d) & 1u) ? 0.0f : 1e17f * (draw_unit(d) - 0.5f);
  for (uint32_t axis = 0; axis < 3; axis++) {
    *spacings[axis] = grid->spacing[axis] = grid->count[axis] > 1 ? spacing : 0.0f;
    *origins[axis] = grid->origin[axis] = away + grid->origin[axis] * spacing;
  }
  for (uint32_t i = 0; i < positions.size_bytes / sizeof(olx_vec3); i++) {
    const olx_vec3 position = olx_grid_position(&moved, i);
    memcpy(positions.bytes + i * sizeof position, &position, sizeof position);
  }
}

// Changes the description consistently to a scene that is absurdly large, small, or far away.
static void stretch_space(dice *d, buffer *b) {
  const buffer info = chunk_of(*b, OLX_CHUNK_INFO);
  if (info.size_bytes < sizeof(olx_file_info)) return;
  olx_file_info *stored = (olx_file_info *)info.bytes;
  if (draw(d) & 1u) stored->distance_scale = powf(10.0f, 36.0f * draw_unit(d) - 18.0f);
  if (draw(d) & 1u) stretch_grid(d, &stored->grid, chunk_of(*b, OLX_CHUNK_PROBE_POSITIONS));
  if (draw(d) & 1u) stretch_grid(d, &stored->irradiance_grid, chunk_of(*b, OLX_CHUNK_IRRADIANCE_POSITIONS));
}

static uint16_t hostile_half(dice *d) {
  static const uint16_t values[] = {0x0000, 0x8000, 0x0001, 0x7C00, 0xFC00, 0x7C01, 0x7E00,
                                    0xFE00, 0x7FFF, 0xFFFF, 0x7BFF, 0xFBFF, 0xB000, 0x3C00};
  const uint32_t i = draw_below(d, sizeof values / sizeof values[0] + 4);
  return i < sizeof values / sizeof values[0] ? values[i] : (uint16_t)draw(d);
}

// Damages maps, flags and pyramids: a few codes, a run of one code, or noise everywhere.
static void change_maps(dice *d, buffer *b) {
  static const olx_chunk_kind kinds[] = {
      OLX_CHUNK_RADIANCE,         OLX_CHUNK_NORMAL,     OLX_CHUNK_DISTANCE, OLX_CHUNK_DISTANCE, OLX_CHUNK_LEAST,
      OLX_CHUNK_GREATEST,         OLX_CHUNK_IRRADIANCE, OLX_CHUNK_MOMENTS,  OLX_CHUNK_MOMENTS,  OLX_CHUNK_PROBE_FLAGS,
      OLX_CHUNK_IRRADIANCE_FLAGS, OLX_CHUNK_BASE,       OLX_CHUNK_SPECULAR, OLX_CHUNK_DIRECT,   OLX_CHUNK_INDIRECT,
      OLX_CHUNK_EMISSION,         OLX_CHUNK_LIGHTS};
  const buffer map = chunk_of(*b, kinds[draw_below(d, sizeof kinds / sizeof kinds[0])]);
  const size_t halves = map.size_bytes / 2;
  if (halves == 0) return;
  const uint32_t manner = draw_below(d, 3);
  const uint16_t code = hostile_half(d);
  const size_t first = draw_offset(d, halves), count = manner == 0 ? 8 : manner == 1 ? halves - first : halves;
  for (size_t i = 0; i < count; i++) {
    const size_t at = manner == 0 ? draw_offset(d, halves) : manner == 1 ? first + i : i;
    const uint16_t value = manner == 1 ? code : manner == 0 ? hostile_half(d) : (uint16_t)draw(d);
    memcpy(map.bytes + 2 * at, &value, 2);
  }
}

// Damages words of a selector's structure, of classic maps or of relighting data, the first words more often than the
// rest.
static void change_optional(dice *d, buffer *b) {
  const uint32_t count = chunks_inside(*b);
  if (count <= OLX_CHUNK_REQUIRED) return;
  const buffer chunk = chunk_of(*b, OLX_CHUNK_REQUIRED + draw_below(d, count - OLX_CHUNK_REQUIRED));
  if (chunk.size_bytes < 4) return;
  for (uint32_t i = draw_below(d, 4) + 1; i > 0; i--) {
    const size_t words = chunk.size_bytes / 4, first = words < 8 ? words : 8;
    const uint32_t value = draw(d) & 1u ? extreme_u32(d) : olx_float_bits(extreme_float(d));
    memcpy(chunk.bytes + 4 * draw_offset(d, draw(d) & 1u ? first : words), &value, 4);
  }
}

static void spoil(dice *d, buffer *b) {
  static void (*const ways[])(dice *, buffer *) = {
      flip_bits,     overwrite_run, change_size, change_header, change_table, change_info,     change_positions,
      stretch_space, stretch_space, change_maps, change_maps,   change_maps,  change_optional, change_optional};
  for (uint32_t i = draw_below(d, 4) ? 1 : 3; i > 0; i--) ways[draw_below(d, sizeof ways / sizeof ways[0])](d, b);
  if (draw_below(d, 8)) seal(*b);
}
// ---- Using the fields that opened

static dice current; // the round that a crash report names

static void report_round(void) {
  fprintf(stderr, "fuzz_field: round %u of seed %u; repeat it with: fuzz_field 1 %u %u\n", current.round, current.seed,
          current.seed, current.round);
}

static void on_signal(int number) {
  fprintf(stderr, "fuzz_field: %s\n", number == PROCESSOR_ALARM ? "hangs" : "crashes");
  report_round();
  _exit(1);
}

static void run_round(dice *d, const buffer *base, buffer *scratch, field_counts *c) {
  scratch->size_bytes = base->size_bytes;
  memcpy(scratch->bytes, base->bytes, base->size_bytes);
  spoil(d, scratch);
  // This copy is exactly as long as the file, so that the address sanitizer detects a read of the first byte beyond.
  void *exact = NULL;
  if (posix_memalign(&exact, OLX_CHUNK_ALIGNMENT, scratch->size_bytes ? scratch->size_bytes : 1) != 0) abort();
  memcpy(exact, scratch->bytes, scratch->size_bytes);
  hostile_field_use(d, exact, scratch->size_bytes, c);
  free(exact);
}

// The function exists only when the program is built with a sanitizer.
void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));

// Runs jobs in order on one thread: rounds are so small that threads would take more time than they save.
static void run_in_order(void *user, uint32_t count, uint32_t threads, void (*job)(void *, uint32_t), void *job_user) {
  (void)user;
  (void)threads;
  for (uint32_t i = 0; i < count; i++) job(job_user, i);
}

static bool make_bases(buffer bases[SHAPES], buffer *scratch) {
  char path[] = "/tmp/octalux-fuzz-XXXXXX";
  const int descriptor = mkstemp(path);
  if (descriptor < 0) return false;
  close(descriptor);
  size_t longest = 0;
  bool made = true;
  for (uint32_t i = 0; i < SHAPES && made; i++) {
    made = synthetic_write(path, &shapes[i], NULL) == OLX_OK &&
           (bases[i].bytes = synthetic_read_file(path, &bases[i].size_bytes)) != NULL;
    if (bases[i].size_bytes > longest) longest = bases[i].size_bytes;
  }
  unlink(path);
  scratch->bytes = olx_allocate(longest + 3 * (MOST_ADDED + 1), 1); // room for three changes of size in one round
  return made && scratch->bytes;
}

int main(int argc, char **argv) {
  if (argc < 2 || argc > 4) {
    fprintf(stderr, "usage: fuzz_field COUNT [SEED [FIRST]]\n");
    return 2;
  }
  const uint32_t count = (uint32_t)strtoul(argv[1], NULL, 10);
  const uint32_t seed = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
  const uint32_t first = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : 0;
  olx_set_hooks(&(olx_hooks){.parallel_for = run_in_order});
  signal(PROCESSOR_ALARM, on_signal);
  if (__sanitizer_set_death_callback) {
    __sanitizer_set_death_callback(report_round);
  } else {
    signal(SIGSEGV, on_signal);
    signal(SIGBUS, on_signal);
    signal(SIGFPE, on_signal);
  }
  signal(SIGABRT, on_signal);
  buffer bases[SHAPES] = {{0}}, scratch = {0};
  if (!make_bases(bases, &scratch)) {
    fprintf(stderr, "fuzz_field: cannot make the valid files: %s\n", olx_last_error());
    return 1;
  }
  field_counts c = {0};
  for (uint32_t i = 0; i < count; i++) {
    set_processor_alarm(SECONDS_A_ROUND);
    current = (dice){.seed = seed, .round = first + i};
    dice d = current;
    run_round(&d, &bases[draw_below(&d, SHAPES)], &scratch, &c);
  }
  for (uint32_t i = 0; i < SHAPES; i++) olx_release(bases[i].bytes);
  olx_release(scratch.bytes);
  printf("fuzz_field: %u files, seed %u: %llu opened, %llu of them verified; refused: format %llu, checksum %llu, "
         "version %llu, unsupported %llu; %llu calls; 0 failures\n",
         count, seed, (unsigned long long)c.opened, (unsigned long long)c.verified,
         (unsigned long long)c.refused[OLX_ERROR_FORMAT], (unsigned long long)c.refused[OLX_ERROR_CHECKSUM],
         (unsigned long long)c.refused[OLX_ERROR_VERSION], (unsigned long long)c.refused[OLX_ERROR_UNSUPPORTED],
         (unsigned long long)c.calls);
  return 0;
}
