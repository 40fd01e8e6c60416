// Loads COUNT mutated descriptions, OBJ, MTL, glTF, GLB and image files: fuzz_scene COUNT [SEED [PART]], with PART only
// those whose names contain it, such as ".gl". Each must become a scene whose numbers are valid, or be refused with a
// message, within seconds and without excessive memory. Files are made from (seed, round) alone, so a failure can be
// repeated; rounds run in a child process, so that a crash inside Assimp is counted and the run continues. Crashes,
// hangs and leaks of our own code fail the test.
#include "core/hooks.h"
#include "core/sampling.h"
#include "counted_memory.h"
#include "gltf_maker.h"
#include "processor_alarm.h"
#include "scene_files.h"
#include "scene_seeds.h"
#include "sound_scene.h"

#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define BATCH 50u
#define SECONDS_A_FILE 5u
// An image file of some 100 bytes may hold 16384 texels a byte; an environment takes twelve bytes a texel and as much
// again to sample it.
#define MOST_BYTES_A_FILE ((size_t)64 << 20)
#define MAX_FILE_BYTES 65536u
typedef struct shared_state {
  atomic_uint round, loaded, refused;
  atomic_size_t most_bytes; // most bytes that one file requested
  char part[32];            // part of the names of the files to mutate
} shared_state;

// ---- mutations

typedef struct random_stream {
  uint32_t seed, round, drawn;
} random_stream;

static uint32_t draw(random_stream *r, uint32_t below) {
  const uint32_t bits = olx_hash3(r->seed, r->round, r->drawn++);
  return below ? (uint32_t)(((uint64_t)bits * below) >> 32) : 0;
}

typedef struct mutant {
  uint8_t bytes[MAX_FILE_BYTES];
  size_t size_bytes;
} mutant;

// Replaces `removed` bytes at `at` by `size_bytes` others.
static void splice_bytes(mutant *m, size_t at, size_t removed, const void *bytes, size_t size_bytes) {
  uint8_t inserted[MAX_FILE_BYTES / 4];
  if (size_bytes > sizeof inserted || m->size_bytes - removed + size_bytes > sizeof m->bytes) return;
  memcpy(inserted, bytes, size_bytes); // a copy, since `bytes` may point into the mutant itself
  memmove(m->bytes + at + size_bytes, m->bytes + at + removed, m->size_bytes - at - removed);
  memcpy(m->bytes + at, inserted, size_bytes);
  m->size_bytes += size_bytes - removed;
}

static bool in_number(uint8_t byte) { return (byte >= '0' && byte <= '9') || byte == '.' || byte == '-'; }

static void replace_number(mutant *m, random_stream *r) {
  static const char *const numbers[] = {
      "NaN",        "1e38",  "-1",   "4294967295", "0",    "1e-45", "1e999", "inf",
      "2147483648", "-1e38", "7",    "65535",      "1e20", "-0",    "1.5",   "99999999999999999999",
      "null",       "0x7f",  "2",    "3",          "4",    "8",     "5120",  "5121",
      "5122",       "5123",  "5125", "5126"};
  size_t at = draw(r, (uint32_t)m->size_bytes);
  for (size_t tried = 0; tried < m->size_bytes && !in_number(m->bytes[at]); ++tried) at = (at + 1) % m->size_bytes;
  if (!in_number(m->bytes[at])) return;
  size_t end = at;
  while (at > 0 && in_number(m->bytes[at - 1])) --at;
  while (end < m->size_bytes && in_number(m->bytes[end])) ++end;
  const char *number = numbers[draw(r, sizeof numbers / sizeof *numbers)];
  splice_bytes(m, at, end - at, number, strlen(number));
}

static void insert_token(mutant *m, random_stream *r) {
  static const char *const tokens[] = {"{",    "}",         "[",        "]",     "\"",        ",",
                                       ":",    "\n",        "\\",       "\xff",  "f 1 2 3\n", "f 9/9/9 1 -9\n",
                                       "/",    "usemtl \n", "mtllib\n", "v 1\n", "-",         "%",
                                       "null", "\\u0000",   "map_Kd\n", "f\n"};
  const char *token = tokens[draw(r, sizeof tokens / sizeof *tokens)];
  splice_bytes(m, draw(r, (uint32_t)m->size_bytes + 1), 0, token, strlen(token));
}

// Replaces a word of glTF by another one, such as "VEC3" or "mode".
static void replace_word(mutant *m, random_stream *r) {
  static const char *const words[] = {"SCALAR",     "VEC2",     "VEC3",       "VEC4",       "MAT4",        "ATTRIBUTES",
                                      "TRIANGLES",  "INDICES",  "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "NONE",
                                      "POSITION",   "NORMAL",   "TANGENT",    "TEXCOORD_0", "TEXCOORD_1",  "COLOR_0",
                                      "indices",    "count",    "byteStride", "byteOffset", "byteLength",  "buffer",
                                      "bufferView", "children", "mesh",       "source"};
  size_t at = draw(r, (uint32_t)m->size_bytes);
  while (at < m->size_bytes && m->bytes[at] != '"') ++at;
  size_t end = at + 1;
  while (end < m->size_bytes && m->bytes[end] != '"') ++end;
  const char *word = words[draw(r, sizeof words / sizeof *words)];
  if (end < m->size_bytes && end - at < 32) splice_bytes(m, at + 1, end - at - 1, word, strlen(word));
}

static void mutate_once(mutant *m, random_stream *r) {
  if (m->size_bytes == 0) return;
  const uint32_t size = (uint32_t)m->size_bytes, at = draw(r, size);
  const uint32_t length = 1 + draw(r, size - at < 200 ? size - at : 200);
  const uint32_t kind = draw(r, 16);
  if (kind == 0) m->size_bytes = at;
  else if (kind <= 3) m->bytes[at] ^= (uint8_t)(1u << draw(r, 8));
  else if (kind == 4) m->bytes[at] = (uint8_t)draw(r, 256);
  else if (kind == 5) splice_bytes(m, at, length > size - at ? size - at : length, "", 0);
  else if (kind == 6) splice_bytes(m, draw(r, size), 0, m->bytes + at, length > size - at ? size - at : length);
  else if (kind == 7) insert_token(m, r);
  else if (kind <= 9) replace_word(m, r);
  else replace_number(m, r);
}

static void set_mutant(mutant *m, const uint8_t *bytes, size_t size_bytes) {
  m->size_bytes = size_bytes < sizeof m->bytes ? size_bytes : sizeof m->bytes;
  memcpy(m->bytes, bytes, m->size_bytes);
}

static void mutate(mutant *m, random_stream *r) {
  for (uint32_t count = 1 + draw(r, 3); count > 0; --count) mutate_once(m, r);
}

// Mutates only one of the two parts of a .glb, and wraps both in a valid frame.
static void mutate_part(const seed_file *from, mutant *m, random_stream *r) {
  uint32_t text_bytes;
  uint8_t *made;
  memcpy(&text_bytes, from->bytes + 12, sizeof text_bytes);
  const uint8_t *text = from->bytes + 20, *bytes = text + text_bytes + 8;
  const size_t size_bytes = from->size_bytes - 28 - text_bytes;
  const bool json = draw(r, 2) == 0;
  set_mutant(m, json ? text : bytes, json ? text_bytes : size_bytes);
  mutate(m, r);
  const size_t total = json ? gltf_make_glb((const char *)m->bytes, m->size_bytes, bytes, size_bytes, &made)
                            : gltf_make_glb((const char *)text, text_bytes, m->bytes, m->size_bytes, &made);
  set_mutant(m, made, total);
  free(made);
}

static const seed_file *make_mutant(const seed_file seeds[SEED_COUNT], const char *part, uint32_t seed, uint32_t round,
                                    mutant *m) {
  random_stream r = {.seed = seed, .round = round};
  const seed_file *from;
  do from = &seeds[draw(&r, SEED_COUNT)];
  while (!strstr(from->name, part));
  if (strstr(from->name, ".glb") && draw(&r, 4)) {
    mutate_part(from, m, &r);
  } else {
    set_mutant(m, from->bytes, from->size_bytes);
    mutate(m, &r);
  }
  return from;
}

// ---- one round, in the child

static void load_one(const scene_folder *folder, const seed_file seeds[SEED_COUNT], uint32_t seed, uint32_t round,
                     shared_state *shared) {
  static mutant m;
  char path[600];
  const seed_file *from = make_mutant(seeds, shared->part, seed, round, &m);
  scene_folder_write(folder, from->name, m.bytes, m.size_bytes);
  counted_memory_asked();
  snprintf(path, sizeof path, "%s/%s", folder->path, from->opened);
  olx_scene *scene = NULL;
  const olx_result result = olx_scene_load(path, &scene);
  if (result == OLX_OK) {
    sound_scene_check(scene);
    atomic_fetch_add(&shared->loaded, 1);
  } else {
    sound_scene_demand(scene == NULL && olx_last_error()[0], "a refusal without a message");
    atomic_fetch_add(&shared->refused, 1);
  }
  olx_scene_free(scene);
  sound_scene_demand(counted_memory_held() == 0, "memory that was not released");
  const size_t asked = counted_memory_asked();
  if (asked > atomic_load(&shared->most_bytes)) atomic_store(&shared->most_bytes, asked);
  sound_scene_demand(asked <= MOST_BYTES_A_FILE, "memory out of proportion");
  scene_folder_write(folder, from->name, from->bytes, from->size_bytes);
}

static void name_stack(int signal_number) {
  void *frames[64];
  const char *what = signal_number == PROCESSOR_ALARM ? "hang\n" : "crash\n";
  (void)!write(STDERR_FILENO, what, strlen(what));
  const int depth = backtrace(frames, 64); // frame 0 is this function
  if (depth > 1) backtrace_symbols_fd(frames + 1, depth - 1, STDERR_FILENO);
  _exit(signal_number == PROCESSOR_ALARM ? 3 : 2);
}

static void run_child(const scene_folder *folder, const char *trace_path, const seed_file seeds[SEED_COUNT],
                      uint32_t seed, uint32_t first, uint32_t end, shared_state *shared) {
  const int trace = open(trace_path, O_CREAT | O_TRUNC | O_WRONLY, 0600);
  if (trace < 0 || dup2(trace, STDERR_FILENO) < 0) _exit(1);
  const int signals[] = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, PROCESSOR_ALARM};
  void *warm_up[1];
  backtrace(warm_up, 1); // loads the library that it needs while memory is intact
  for (size_t i = 0; i < sizeof signals / sizeof *signals; ++i) signal(signals[i], name_stack);
  counted_memory_begin();
  for (uint32_t round = first; round < end; ++round) {
    atomic_store(&shared->round, round);
    set_processor_alarm(SECONDS_A_FILE);
    load_one(folder, seeds, seed, round, shared);
  }
  _exit(0);
}

// ---- the parent

typedef enum blame { BLAME_ASSIMP, BLAME_US } blame;

// Finds the innermost frame that belongs neither to the C and C++ libraries nor to a sanitizer.
static blame find_blame(const char *trace_path, char *frame, size_t frame_bytes) {
  static const char *const passed_over[] = {"libc.so",   "libstdc++",   "libgcc", "libasan",      "libpthread",
                                            "sanitizer", "interceptor", "__asan", "operator new", "[vdso]"};
  FILE *file = fopen(trace_path, "r");
  char line[2048];
  snprintf(frame, frame_bytes, "no stack");
  while (file && fgets(line, sizeof line, file)) {
    line[strcspn(line, "\n")] = 0;
    bool passed = !strstr(line, "0x");
    for (size_t i = 0; i < sizeof passed_over / sizeof *passed_over; ++i)
      passed |= strstr(line, passed_over[i]) != NULL;
    // Sanitizers print addresses in prose before the numbered frames.
    if (passed || (line[0] == '=' && line[1] == '=') || strncmp(line, "READ", 4) == 0 ||
        strncmp(line, "WRITE", 5) == 0) {
      continue;
    }
    snprintf(frame, frame_bytes, "%.300s", line);
    break;
  }
  if (file) fclose(file);
  return strstr(frame, "libassimp") ? BLAME_ASSIMP : BLAME_US;
}

static void keep_failure(const scene_folder *kept, const char *trace_path, const seed_file *from, const mutant *m,
                         uint32_t round) {
  char name[96], command[1400];
  snprintf(name, sizeof name, "%u-%s", round, from->name);
  scene_folder_write(kept, name, m->bytes, m->size_bytes);
  snprintf(command, sizeof command, "cp '%s' '%s/%u-stack.txt'", trace_path, kept->path, round);
  (void)!system(command);
}

typedef struct tally {
  uint32_t ours, assimp_crashes, assimp_hangs;
} tally;

static void record_failure(const scene_folder *kept, const char *trace_path, const seed_file seeds[SEED_COUNT],
                           const char *part, uint32_t seed, uint32_t round, int status, tally *counts) {
  static mutant m;
  char frame[400];
  const seed_file *from = make_mutant(seeds, part, seed, round, &m);
  const bool hang = WIFEXITED(status) && WEXITSTATUS(status) == 3;
  const blame guilty = find_blame(trace_path, frame, sizeof frame);
  keep_failure(kept, trace_path, from, &m, round);
  printf("round %u: %s: %s in %s: %s\n", round, from->name, hang ? "hang" : "crash",
         guilty == BLAME_ASSIMP ? "Assimp" : "our code", frame);
  if (guilty == BLAME_US) ++counts->ours;
  else if (hang) ++counts->assimp_hangs;
  else ++counts->assimp_crashes;
}

static void run_all(uint32_t count, uint32_t seed, shared_state *shared, const scene_folder *kept, tally *counts) {
  static seed_file seeds[SEED_COUNT];
  scene_folder folder;
  char trace_path[400];
  if (!scene_folder_create(&folder)) exit(1);
  scene_seeds_make(seeds);
  for (uint32_t i = 0; i < SEED_COUNT; ++i) {
    scene_folder_write(&folder, seeds[i].name, seeds[i].bytes, seeds[i].size_bytes);
  }
  snprintf(trace_path, sizeof trace_path, "%s/trace.txt", folder.path);
  for (uint32_t next = 0; next < count;) {
    const uint32_t end = count - next < BATCH ? count : next + BATCH;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) run_child(&folder, trace_path, seeds, seed, next, end, shared);
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) exit(1);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
      next = end;
      continue;
    }
    const uint32_t round = atomic_load(&shared->round);
    record_failure(kept, trace_path, seeds, shared->part, seed, round, status, counts);
    next = round + 1;
    for (uint32_t i = 0; i < SEED_COUNT; ++i) {
      scene_folder_write(&folder, seeds[i].name, seeds[i].bytes, seeds[i].size_bytes);
    }
  }
  scene_seeds_free(seeds);
  scene_folder_remove(&folder);
}

int main(int argc, char **argv) {
  const uint32_t count = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 200;
  const uint32_t seed = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
  shared_state *shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  scene_folder kept;
  tally counts = {0};
  if (shared == MAP_FAILED || !scene_folder_create(&kept)) return 1;
  snprintf(shared->part, sizeof shared->part, "%s", argc > 3 ? argv[3] : "");
  run_all(count, seed, shared, &kept, &counts);
  const uint32_t failures = counts.ours + counts.assimp_crashes + counts.assimp_hangs;
  if (failures) printf("the files are kept in %s\n", kept.path);
  else scene_folder_remove(&kept);
  printf("fuzz_scene: %u files, seed %u: %u loaded, %u refused, %u crashes and %u hangs inside Assimp, %u failures of "
         "our own; %.1f MiB asked for at most\n",
         count, seed, atomic_load(&shared->loaded), atomic_load(&shared->refused), counts.assimp_crashes,
         counts.assimp_hangs, counts.ours, (double)atomic_load(&shared->most_bytes) / 1048576.0);
  return counts.ours ? 1 : 0;
}
