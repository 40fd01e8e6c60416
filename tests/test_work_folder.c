// Tests work folders: results come back as they were stored or not at all, wrong folders are refused, only the folder's
// own files are removed, and parts compute the right units.
#include "core/hooks.h"
#include "core/result.h"
#include "work/unit_store.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cmocka.h>

enum { MOST_CALLS = 64 };

// The program's calls of the file system, in order: 'w'rite, 's'ync of a file, 'f'older synced, 'r'ename, 'u'nlinking
// of a unit, unlinking of the 'm'anifest.
static struct {
  char calls[MOST_CALLS];
  uint32_t count;
  int write_error;       // with which further writes fail; 0: they do not
  const char *spoilt;    // the name of a file that cannot be read
  int open_error;        // with which opening it fails, or
  int read_error;        // with which reading it fails
  int descriptor;        // of that file
  uint32_t most_unlinks; // unless 0, how many files can be removed, as if the program were killed then
  uint32_t unlinks;
} disk;

static void note(char call) {
  if (disk.count + 1 < MOST_CALLS) disk.calls[disk.count++] = call;
}

ssize_t write(int descriptor, const void *data, size_t size_bytes) {
  if (descriptor > 2) note('w');
  if (descriptor > 2 && disk.write_error) {
    errno = disk.write_error;
    return -1;
  }
  return syscall(SYS_write, descriptor, data, size_bytes);
}

int openat(int folder, const char *name, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  const bool spoilt = disk.spoilt && strcmp(name, disk.spoilt) == 0;
  if (spoilt && disk.open_error) {
    errno = disk.open_error;
    return -1;
  }
  const int descriptor = (int)syscall(SYS_openat, folder, name, flags, mode);
  if (spoilt) disk.descriptor = descriptor;
  else if (descriptor == disk.descriptor) disk.descriptor = 0;
  return descriptor;
}

ssize_t read(int descriptor, void *data, size_t size_bytes) {
  if (disk.read_error && disk.descriptor > 0 && descriptor == disk.descriptor) {
    errno = disk.read_error;
    return -1;
  }
  return syscall(SYS_read, descriptor, data, size_bytes);
}

int fsync(int descriptor) {
  struct stat status;
  note(fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode) ? 'f' : 's');
  return (int)syscall(SYS_fsync, descriptor);
}

int renameat(int from_folder, const char *from, int to_folder, const char *to) {
  note('r');
  return (int)syscall(SYS_renameat2, from_folder, from, to_folder, to, 0);
}

int unlinkat(int folder, const char *name, int flags) {
  note(strcmp(name, "manifest-0-0.unit") == 0 ? 'm' : 'u');
  if (disk.most_unlinks && disk.unlinks == disk.most_unlinks) return -1;
  disk.unlinks++;
  return (int)syscall(SYS_unlinkat, folder, name, flags);
}

typedef struct place {
  char parent[200], folder[256], file[512];
} place;

static int create_place(void **state) {
  place *p = calloc(1, sizeof *p);
  const char *base = getenv("TMPDIR");
  snprintf(p->parent, sizeof p->parent, "%s/octalux-work-XXXXXX", base && *base ? base : "/tmp");
  if (!mkdtemp(p->parent)) return -1;
  snprintf(p->folder, sizeof p->folder, "%s/work", p->parent);
  memset(&disk, 0, sizeof disk);
  *state = p;
  return 0;
}

static int remove_place(void **state) {
  place *p = *state;
  char command[300];
  snprintf(command, sizeof command, "rm -rf '%s'", p->parent);
  const int result = system(command);
  free(p);
  return result;
}

// Returns the path of a file in the work folder, or beside it for a name that begins with "../".
static const char *file_in(place *p, const char *name) {
  snprintf(p->file, sizeof p->file, "%s/%s", p->folder, name);
  return p->file;
}

static uint32_t count_files(const char *folder) {
  DIR *entries = opendir(folder);
  uint32_t count = 0;
  assert_non_null(entries);
  while (readdir(entries)) count++;
  closedir(entries);
  return count - 2; // without . and ..
}

static bool exists(const char *path) {
  struct stat status;
  return lstat(path, &status) == 0;
}

static void write_file(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
}

static olx_manifest manifest_of(const char *scene, const char *instructions) {
  olx_manifest manifest = {""};
  olx_manifest_add(&manifest, "scene", scene);
  olx_manifest_add(&manifest, "instructions", instructions);
  olx_manifest_add(&manifest, "stages", "manifest cast probe awaited");
  return manifest;
}

static olx_result open_as(const place *p, const olx_manifest *manifest, olx_work_lock lock, bool fresh,
                          olx_work_folder **folder) {
  const olx_work_folder_settings settings = {.manifest = manifest, .lock = lock, .fresh = fresh};
  return olx_work_folder_open(p->folder, &settings, folder);
}

static olx_work_folder *opened(const place *p) {
  const olx_manifest manifest = manifest_of("a", "avx2");
  olx_work_folder *folder;
  assert_int_equal(open_as(p, &manifest, OLX_WORK_ALONE, false, &folder), OLX_OK);
  return folder;
}

static void refused(const place *p, const char *why) {
  const olx_manifest manifest = manifest_of("a", "avx2");
  olx_work_folder *folder;
  assert_int_not_equal(open_as(p, &manifest, OLX_WORK_ALONE, false, &folder), OLX_OK);
  assert_null(folder);
  if (!strstr(olx_last_error(), why)) fail_msg("'%s' does not say '%s'", olx_last_error(), why);
}

static const olx_unit_name probe_3 = {"probe", 0, 3, OLX_PARTS_ALL}, cast_2_7 = {"cast", 2, 7, OLX_PARTS_ALL};

static void put_text(olx_work_folder *folder, const olx_unit_name *name, const char *text) {
  assert_int_equal(olx_work_folder_put(folder, name, text, strlen(text)), OLX_OK);
}

static void holds_text(const olx_work_folder *folder, const olx_unit_name *name, const char *text) {
  void *data;
  size_t size_bytes;
  assert_int_equal(olx_work_folder_get(folder, name, &data, &size_bytes), OLX_OK);
  assert_int_equal(size_bytes, strlen(text));
  assert_memory_equal(data, text, size_bytes);
  olx_release(data);
}

static void results_outlive_the_program_that_made_them(void **state) {
  olx_work_folder *folder = opened(*state);
  assert_false(olx_work_folder_has(folder, &probe_3));
  put_text(folder, &probe_3, "a result");
  put_text(folder, &cast_2_7, "");
  olx_work_folder_close(folder);
  folder = opened(*state);
  assert_true(olx_work_folder_has(folder, &probe_3));
  holds_text(folder, &probe_3, "a result");
  holds_text(folder, &cast_2_7, "");
  put_text(folder, &probe_3, "another");
  holds_text(folder, &probe_3, "another");
  assert_false(olx_work_folder_has(folder, &(olx_unit_name){"probe", 0, 4, OLX_PARTS_ALL}));
  olx_work_folder_close(folder);
}

// Contents are durable before a file gets its name, and names before success is reported.
static void a_power_failure_leaves_whole_results_or_none(void **state) {
  olx_work_folder *folder = opened(*state);
  memset(&disk, 0, sizeof disk);
  put_text(folder, &probe_3, "a result");
  const char *last_write = strrchr(disk.calls, 'w'), *sync = strchr(disk.calls, 's'), *rename = strchr(disk.calls, 'r');
  assert_non_null(last_write);
  assert_non_null(sync);
  assert_non_null(rename);
  assert_true(last_write < sync && sync < rename);
  assert_string_equal(rename, "rf");
  olx_work_folder_close(folder);
}

static void a_full_disk_is_an_error_and_keeps_what_was_there(void **state) {
  olx_work_folder *folder = opened(*state);
  put_text(folder, &probe_3, "a result");
  disk.write_error = ENOSPC;
  assert_int_equal(olx_work_folder_put(folder, &probe_3, "more", 4), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "probe-0-3.unit: cannot write: No space left"));
  disk.write_error = 0;
  holds_text(folder, &probe_3, "a result");
  olx_work_folder_remove(folder);
  assert_false(exists(((place *)*state)->folder));
}

static long size_of(const char *path) {
  struct stat status;
  assert_int_equal(stat(path, &status), 0);
  return (long)status.st_size;
}

static void flip_byte(const char *path, long at) {
  FILE *file = fopen(path, "r+");
  assert_non_null(file);
  fseek(file, at, SEEK_SET);
  const int byte = fgetc(file);
  fseek(file, at, SEEK_SET);
  fputc(byte ^ 1, file);
  fclose(file);
}

static void is_damaged(const olx_work_folder *folder, const olx_unit_name *name) {
  void *data;
  size_t size_bytes;
  assert_int_equal(olx_work_folder_get(folder, name, &data, &size_bytes), OLX_ERROR_CHECKSUM);
  assert_non_null(strstr(olx_last_error(), ".unit: is damaged"));
  assert_null(data);
}

static void damage_anywhere_is_found(void **state) {
  place *p = *state;
  olx_work_folder *folder = opened(p);
  put_text(folder, &probe_3, "a result");
  const long size_bytes = size_of(file_in(p, "probe-0-3.unit"));
  for (long at = 0; at < size_bytes; at++) {
    flip_byte(file_in(p, "probe-0-3.unit"), at);
    is_damaged(folder, &probe_3);
    flip_byte(file_in(p, "probe-0-3.unit"), at);
  }
  holds_text(folder, &probe_3, "a result");
  assert_int_equal(truncate(file_in(p, "probe-0-3.unit"), size_bytes + 1), 0);
  is_damaged(folder, &probe_3);
  for (long length = 0; length < size_bytes; length++) {
    assert_int_equal(truncate(file_in(p, "probe-0-3.unit"), size_bytes - 1 - length), 0);
    is_damaged(folder, &probe_3);
  }
  olx_work_folder_close(folder);
}

static void a_result_under_another_name_is_no_result(void **state) {
  place *p = *state;
  char other[512];
  olx_work_folder *folder = opened(p);
  put_text(folder, &probe_3, "a result");
  snprintf(other, sizeof other, "%s", file_in(p, "probe-0-4.unit"));
  assert_int_equal(rename(file_in(p, "probe-0-3.unit"), other), 0);
  is_damaged(folder, &(olx_unit_name){"probe", 0, 4, OLX_PARTS_ALL});
  olx_work_folder_close(folder);
}

static void another_bake_is_refused_by_what_differs(void **state) {
  place *p = *state;
  const olx_manifest moved = manifest_of("b", "avx2"), wider = manifest_of("a", "avx512");
  olx_work_folder *folder = opened(p);
  put_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
  assert_int_equal(open_as(p, &moved, OLX_WORK_ALONE, false, &folder), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "its scene is a, and this one's is b"));
  assert_int_equal(open_as(p, &wider, OLX_WORK_ALONE, false, &folder), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "its instructions is avx2, and this one's is avx512"));
  folder = opened(p);
  holds_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
}

static void beginning_again_forgets_another_bake(void **state) {
  place *p = *state;
  const olx_manifest moved = manifest_of("b", "avx2");
  olx_work_folder *folder = opened(p);
  put_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
  assert_int_equal(open_as(p, &moved, OLX_WORK_ALONE, true, &folder), OLX_OK);
  assert_false(olx_work_folder_has(folder, &probe_3));
  assert_string_equal(olx_manifest_find(olx_work_folder_manifest(folder), "scene").text, "b");
  olx_work_folder_close(folder);
}

static void joining_takes_the_folders_own_manifest(void **state) {
  place *p = *state;
  olx_work_folder *folder;
  assert_int_equal(open_as(p, NULL, OLX_WORK_ALONE, false, &folder), OLX_ERROR_FILE);
  assert_false(exists(p->folder));
  olx_work_folder_close(opened(p));
  assert_int_equal(open_as(p, NULL, OLX_WORK_ALONE, false, &folder), OLX_OK);
  assert_string_equal(olx_manifest_find(olx_work_folder_manifest(folder), "instructions").text, "avx2");
  assert_string_equal(olx_manifest_find(olx_work_folder_manifest(folder), "instruction").text, "");
  olx_work_folder_close(folder);
}

static void folders_that_are_not_ours_are_refused_and_left_alone(void **state) {
  place *p = *state;
  char target[300];
  write_file(p->folder, "a file");
  refused(p, "it is a file or a link");
  assert_int_equal(unlink(p->folder), 0);
  snprintf(target, sizeof target, "%s/elsewhere", p->parent);
  assert_int_equal(mkdir(target, 0700), 0);
  assert_int_equal(symlink(target, p->folder), 0);
  refused(p, "it is a file or a link");
  assert_int_equal(unlink(p->folder), 0);
  assert_int_equal(mkdir(p->folder, 0700), 0);
  write_file(file_in(p, "notes.txt"), "mine");
  refused(p, "it has no manifest, and there are files in it");
  assert_true(exists(file_in(p, "notes.txt")));
  assert_int_equal(unlink(file_in(p, "notes.txt")), 0);
  assert_int_equal(chmod(p->folder, 0750), 0);
  refused(p, "others may look into it");
  assert_int_equal(chmod(p->folder, 0700), 0);
  olx_work_folder_close(opened(p));
}

static void a_folder_with_a_damaged_manifest_is_left_alone(void **state) {
  place *p = *state;
  const olx_manifest manifest = manifest_of("a", "avx2");
  olx_work_folder *folder = opened(p);
  put_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
  flip_byte(file_in(p, "manifest-0-0.unit"), 70);
  refused(p, "manifest-0-0.unit: is damaged; nothing says what the folder's other files are");
  assert_int_equal(open_as(p, &manifest, OLX_WORK_ALONE, true, &folder), OLX_ERROR_CHECKSUM);
  assert_true(exists(file_in(p, "probe-0-3.unit")));
}

static void a_manifest_that_cannot_be_read_now_is_no_reason_to_remove_it(void **state) {
  place *p = *state;
  const olx_manifest manifest = manifest_of("a", "avx2");
  olx_work_folder *folder = opened(p);
  olx_work_folder_close(folder);
  disk.spoilt = "manifest-0-0.unit";
  disk.open_error = EMFILE;
  assert_int_equal(open_as(p, &manifest, OLX_WORK_ALONE, true, &folder), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "manifest-0-0.unit: cannot open: Too many open files"));
  assert_null(strstr(olx_last_error(), "by hand"));
  memset(&disk, 0, sizeof disk);
  olx_work_folder_close(opened(p));
}

static void only_what_the_manifest_names_is_removed(void **state) {
  static const char *const foreign[] = {"notes.txt", "other-0-1.unit", "probe-x-1.unit", "probe-0.unit",
                                        "probe-0-1.unit.old"};
  place *p = *state;
  olx_work_folder *folder = opened(p);
  put_text(folder, &probe_3, "a result");
  for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) write_file(file_in(p, foreign[i]), "mine");
  write_file(file_in(p, "../outside"), "mine");
  assert_int_equal(symlink("../outside", file_in(p, "cast-0-0.unit")), 0);
  olx_work_folder_remove(folder);
  for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) assert_true(exists(file_in(p, foreign[i])));
  assert_true(exists(file_in(p, "cast-0-0.unit")));
  assert_true(exists(file_in(p, "../outside")));
  assert_false(exists(file_in(p, "probe-0-3.unit")));
  assert_false(exists(file_in(p, "manifest-0-0.unit")));
}

enum { STORED = 12 };

static void put_units(olx_work_folder *folder) {
  for (uint32_t i = 0; i < STORED; i++) put_text(folder, &(olx_unit_name){"probe", 0, i, OLX_PARTS_ALL}, "a result");
}

static void the_manifest_outlives_the_units(void **state) {
  place *p = *state;
  olx_work_folder *folder = opened(p);
  put_units(folder);
  memset(&disk, 0, sizeof disk);
  olx_work_folder_remove(folder);
  const char *marked = strchr(disk.calls, 'r'), *unit = strchr(disk.calls, 'u');
  assert_true(marked && unit && marked < unit);
  assert_string_equal(unit, "uuuuuuuuuuuum");
}

// A folder whose removal a killed program has begun belongs to no bake: the next one clears it, whatever bake it is.
static void a_folder_that_is_half_removed_is_begun_anew(void **state) {
  place *p = *state;
  const olx_manifest moved = manifest_of("b", "avx2");
  olx_work_folder *folder = opened(p);
  put_units(folder);
  memset(&disk, 0, sizeof disk);
  disk.most_unlinks = 5;
  olx_work_folder_remove(folder);
  assert_int_equal(count_files(p->folder), STORED - 5 + 1);
  assert_int_equal(open_as(p, NULL, OLX_WORK_ALONE, false, &folder), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "its bake is finished"));
  disk.most_unlinks = 0;
  assert_int_equal(open_as(p, &moved, OLX_WORK_ALONE, false, &folder), OLX_OK);
  assert_int_equal(count_files(p->folder), 1);
  olx_work_folder_remove(folder);
  assert_false(exists(p->folder));
}

static void links_in_the_folder_are_not_followed(void **state) {
  place *p = *state;
  char target[512];
  olx_work_folder *folder = opened(p);
  put_text(folder, &probe_3, "a result");
  snprintf(target, sizeof target, "%s", file_in(p, "../moved"));
  assert_int_equal(rename(file_in(p, "probe-0-3.unit"), target), 0);
  assert_int_equal(symlink("../moved", file_in(p, "probe-0-3.unit")), 0);
  void *data;
  size_t size_bytes;
  assert_false(olx_work_folder_has(folder, &probe_3));
  assert_int_equal(olx_work_folder_get(folder, &probe_3, &data, &size_bytes), OLX_ERROR_INCOMPLETE);
  olx_work_folder_drop(folder, &probe_3);
  assert_true(exists(file_in(p, "probe-0-3.unit")));
  put_text(folder, &probe_3, "a new one");
  const long moved_bytes = size_of(target);
  holds_text(folder, &probe_3, "a new one");
  assert_int_equal(size_of(target), moved_bytes);
  olx_work_folder_close(folder);
}

static void who_works_alone_keeps_others_out(void **state) {
  place *p = *state;
  const olx_manifest manifest = manifest_of("a", "avx2");
  olx_work_folder *alone = opened(p), *other, *shared;
  assert_int_equal(open_as(p, &manifest, OLX_WORK_ALONE, false, &other), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "another bake works in this folder"));
  assert_int_equal(open_as(p, &manifest, OLX_WORK_SHARED, false, &other), OLX_ERROR_FILE);
  olx_work_folder_close(alone);
  assert_int_equal(open_as(p, &manifest, OLX_WORK_SHARED, false, &shared), OLX_OK);
  assert_int_equal(open_as(p, &manifest, OLX_WORK_SHARED, false, &other), OLX_OK);
  assert_int_equal(open_as(p, &manifest, OLX_WORK_ALONE, false, &alone), OLX_ERROR_FILE);
  olx_work_folder_close(shared);
  olx_work_folder_close(other);
  olx_work_folder_close(opened(p));
}

// ---- Units

enum { UNITS = 23 };

// A test stage whose unit n is the number 100 n.
typedef struct numbers {
  uint32_t made[UNITS], value[UNITS], told;
  bool heeded; // whether the last part went no further than the mark
} numbers;

static olx_result make_number(void *user, uint32_t unit) {
  numbers *n = user;
  n->made[unit]++;
  n->value[unit] = 100 * unit;
  return OLX_OK;
}

static void save_number(void *user, uint32_t unit, olx_byte_writer *to) {
  olx_bytes_put(to, &((numbers *)user)->value[unit], 1, sizeof(uint32_t));
}

static olx_result load_number(void *user, uint32_t unit, olx_byte_reader *from) {
  olx_bytes_copy(from, &((numbers *)user)->value[unit], 1, sizeof(uint32_t));
  return OLX_OK;
}

static olx_unit_stage stage_of(numbers *n) {
  return (olx_unit_stage){"probe", 0, UNITS, n, make_number, save_number, load_number, OLX_PARTS_ALL};
}

static void count_done(void *user, const olx_unit_done *unit) {
  assert_string_equal(unit->name.stage, "probe");
  assert_int_equal(unit->count, UNITS);
  ((numbers *)user)->told++;
}

enum { WALLS = 1, PAINT = 2 }; // the parts of the scene, in the order of the manifest

static olx_manifest scene_manifest(const char *walls, const char *paint) {
  olx_manifest manifest = manifest_of("a", "avx2");
  olx_manifest_add(&manifest, "walls", walls);
  olx_manifest_add(&manifest, "paint", paint);
  olx_manifest_add(&manifest, "parts-of-scene", "walls paint");
  return manifest;
}

static olx_work_folder *open_scene(const place *p, const char *walls, const char *paint) {
  const olx_manifest manifest = scene_manifest(walls, paint);
  const olx_work_folder_settings settings = {.manifest = &manifest, .lock = OLX_WORK_ALONE, .edited = true};
  olx_work_folder *folder;
  assert_int_equal(olx_work_folder_open(p->folder, &settings, &folder), OLX_OK);
  return folder;
}

static void units_hold_while_the_parts_of_the_scene_do_that_they_need(void **state) {
  place *p = *state;
  const olx_unit_name of_walls = {"cast", 0, 0, WALLS}, of_all = {"probe", 0, 0, OLX_PARTS_ALL};
  olx_work_folder *folder = open_scene(p, "brick", "red");
  put_text(folder, &of_walls, "a shape");
  put_text(folder, &of_all, "a colour");
  olx_work_folder_close(folder);

  folder = open_scene(p, "brick", "blue");
  assert_int_equal(olx_work_folder_edited(folder), PAINT);
  holds_text(folder, &of_walls, "a shape");
  assert_int_equal(olx_work_folder_look(folder, &of_all), OLX_UNIT_STALE);
  assert_false(olx_work_folder_has(folder, &of_all));
  void *data;
  size_t size_bytes;
  assert_int_equal(olx_work_folder_get(folder, &of_all, &data, &size_bytes), OLX_ERROR_INCOMPLETE);
  olx_work_folder_get_stale(folder, &of_all, &data, &size_bytes);
  assert_int_equal(size_bytes, strlen("a colour"));
  olx_release(data);
  olx_work_folder_get_stale(folder, &of_walls, &data, &size_bytes);
  assert_null(data);
  olx_work_folder_tidy(folder);
  assert_int_equal(olx_work_folder_look(folder, &of_all), OLX_UNIT_ABSENT);
  holds_text(folder, &of_walls, "a shape");
  olx_work_folder_close(folder);
}

static void tidying_leaves_what_cannot_be_read_now(void **state) {
  place *p = *state;
  const olx_unit_name of_walls = {"cast", 0, 0, WALLS};
  olx_work_folder *folder = open_scene(p, "brick", "red");
  put_text(folder, &of_walls, "a shape");
  olx_work_folder_close(folder);
  for (uint32_t i = 0; i < 2; i++) {
    folder = open_scene(p, "brick", i ? "green" : "blue");
    disk.spoilt = "cast-0-0.unit";
    *(i ? &disk.read_error : &disk.open_error) = EIO;
    olx_work_folder_tidy(folder);
    memset(&disk, 0, sizeof disk);
    holds_text(folder, &of_walls, "a shape");
    olx_work_folder_close(folder);
  }
}

// After an interrupted bake of an edited scene, and after an edit that is taken back, keys alone tell what holds.
static void keys_outlive_the_manifest_of_an_edit(void **state) {
  place *p = *state;
  const olx_unit_name of_all = {"probe", 0, 0, OLX_PARTS_ALL};
  olx_work_folder *folder = open_scene(p, "brick", "red");
  put_text(folder, &of_all, "a colour");
  olx_work_folder_close(folder);
  olx_work_folder_close(open_scene(p, "brick", "blue"));
  folder = open_scene(p, "brick", "blue");
  assert_int_equal(olx_work_folder_edited(folder), 0);
  assert_int_equal(olx_work_folder_look(folder, &of_all), OLX_UNIT_STALE);
  olx_work_folder_close(folder);
  folder = open_scene(p, "brick", "red");
  holds_text(folder, &of_all, "a colour");
  olx_work_folder_close(folder);
}

static void an_edit_has_to_be_allowed_and_to_be_of_the_scene_alone(void **state) {
  place *p = *state;
  olx_work_folder_close(open_scene(p, "brick", "red"));
  const olx_manifest painted = scene_manifest("brick", "blue");
  olx_manifest other = scene_manifest("brick", "blue");
  olx_manifest_add(&other, "noise", "0.1");
  olx_work_folder *folder;
  assert_int_equal(open_as(p, &painted, OLX_WORK_ALONE, false, &folder), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "its paint is red, and this one's is blue"));
  assert_non_null(strstr(olx_last_error(), "or reuse what still holds with --keep-work"));
  const olx_work_folder_settings settings = {.manifest = &other, .lock = OLX_WORK_ALONE, .edited = true};
  assert_int_equal(olx_work_folder_open(p->folder, &settings, &folder), OLX_ERROR_ARGUMENT);
  assert_null(strstr(olx_last_error(), "--keep-work"));
}

static olx_unit_store *store_of(const place *p, numbers *n, uint32_t part, uint32_t parts, uint64_t limit_bytes) {
  const olx_manifest manifest = manifest_of("a", "avx2");
  const olx_unit_store_settings settings = {.folder = p->folder,
                                            .manifest = &manifest,
                                            .limit_bytes = limit_bytes,
                                            .part = part,
                                            .parts = parts,
                                            .done = count_done,
                                            .user = n};
  olx_unit_store *store;
  assert_int_equal(olx_unit_store_open(&settings, &store), OLX_OK);
  return store;
}

static uint32_t made(const numbers *n) {
  uint32_t sum = 0;
  for (uint32_t i = 0; i < UNITS; i++) sum += n->made[i];
  return sum;
}

static void all_right(const numbers *n) {
  for (uint32_t i = 0; i < UNITS; i++) assert_int_equal(n->value[i], 100 * i);
}

static olx_result run_whole(const place *p, numbers *n, uint64_t limit_bytes) {
  olx_unit_store *store = store_of(p, n, 0, 0, limit_bytes);
  const olx_unit_stage stage = stage_of(n);
  const olx_result result = olx_units_make(store, &stage);
  olx_unit_store_close(store, false);
  return result;
}

static olx_result run_part(const place *p, numbers *n, uint32_t part, uint32_t parts) {
  olx_unit_store *store = store_of(p, n, part, parts, 0);
  const olx_unit_stage stage = stage_of(n);
  olx_result result = olx_units_make(store, &stage);
  if (result == OLX_OK) result = olx_units_load(store, &stage);
  olx_unit_store_close(store, false);
  return result;
}

static void without_a_store_every_unit_is_made(void **state) {
  (void)state;
  numbers n = {0};
  const olx_unit_stage stage = stage_of(&n);
  assert_int_equal(olx_units_make(NULL, &stage), OLX_OK);
  assert_int_equal(made(&n), UNITS);
  all_right(&n);
}

static void a_whole_bake_makes_what_is_missing(void **state) {
  numbers first = {0}, second = {0};
  place *p = *state;
  assert_int_equal(run_whole(p, &first, 0), OLX_OK);
  assert_int_equal(made(&first), UNITS);
  assert_int_equal(first.told, UNITS);
  assert_int_equal(unlink(file_in(p, "probe-0-5.unit")), 0);
  flip_byte(file_in(p, "probe-0-9.unit"), 70);
  assert_int_equal(run_whole(p, &second, 0), OLX_OK);
  assert_int_equal(made(&second), 2);
  assert_true(second.made[5] && second.made[9]);
  assert_int_equal(second.told, UNITS);
  all_right(&second);
}

static void parts_in_any_order_make_every_unit_once(void **state) {
  place *p = *state;
  enum { PARTS = 7 };
  uint32_t sum = 0;
  for (uint32_t i = 0; i < PARTS; i++) {
    numbers n = {0};
    const uint32_t part = 1 + (3 * i + 2) % PARTS;
    const olx_result result = run_part(p, &n, part, PARTS);
    assert_int_equal(result, i + 1 < PARTS ? OLX_ERROR_INCOMPLETE : OLX_OK);
    assert_in_range(made(&n), UNITS / PARTS, UNITS / PARTS + 1);
    sum += made(&n);
    if (result == OLX_OK) all_right(&n);
  }
  assert_int_equal(sum, UNITS);
  numbers again = {0};
  assert_int_equal(run_part(p, &again, 4, PARTS), OLX_OK);
  assert_int_equal(made(&again), 0);
  all_right(&again);
}

static void a_part_that_reads_a_damaged_unit_has_it_made_again(void **state) {
  place *p = *state;
  numbers n = {0};
  assert_int_equal(run_whole(p, &n, 0), OLX_OK);
  flip_byte(file_in(p, "probe-0-9.unit"), 70);
  assert_int_equal(run_part(p, &n, 1, 1), OLX_ERROR_INCOMPLETE);
  assert_int_equal(run_part(p, &n, 1, 1), OLX_OK);
  assert_int_equal(n.made[9], 2);
  assert_int_equal(made(&n), UNITS + 1);
}

// A process may have too many open files and a server may be away; what is stored is as good as before.
static void what_cannot_be_read_now_is_never_removed(void **state) {
  const int faults[][2] = {{EMFILE, 0}, {ENFILE, 0}, {ESTALE, 0}, {EIO, 0}, {0, EIO}};
  place *p = *state;
  numbers n = {0};
  assert_int_equal(run_whole(p, &n, 0), OLX_OK);
  for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
    numbers whole = {0}, part = {0};
    memset(&disk, 0, sizeof disk);
    disk.spoilt = "probe-0-9.unit";
    disk.open_error = faults[i][0];
    disk.read_error = faults[i][1];
    assert_int_equal(run_part(p, &part, 1, 1), OLX_ERROR_FILE);
    assert_non_null(strstr(olx_last_error(), "probe-0-9.unit: cannot "));
    assert_int_equal(disk.count, 0);
    assert_int_equal(run_whole(p, &whole, 0), OLX_OK);
    assert_int_equal(made(&whole), 1);
    assert_int_equal(whole.made[9], 1);
    all_right(&whole);
    assert_null(strchr(disk.calls, 'u'));
    memset(&disk, 0, sizeof disk);
    assert_int_equal(run_part(p, &part, 1, 1), OLX_OK);
    assert_int_equal(made(&part), 0);
    all_right(&part);
  }
}

// Runs a part as the light of a scene does: it heeds the mark, and leaves one where it cannot go on.
static olx_result run_marked_part(const place *p, numbers *n, uint32_t part, uint32_t parts) {
  olx_unit_store *store = store_of(p, n, part, parts, 0);
  const olx_unit_stage stage = stage_of(n);
  olx_result result = olx_units_heed_mark(store);
  n->heeded = result == OLX_ERROR_INCOMPLETE;
  if (result == OLX_OK) result = olx_units_make(store, &stage);
  if (result == OLX_ERROR_INCOMPLETE && !n->heeded) assert_int_equal(olx_units_leave_mark(store), OLX_OK);
  olx_unit_store_close(store, false);
  return result;
}

static void a_part_without_a_missing_unit_heeds_the_mark_of_others(void **state) {
  place *p = *state;
  numbers n = {0};
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_false(n.heeded); // there was no mark
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_true(n.heeded);
  assert_non_null(strstr(olx_last_error(), "units of the stage 'probe' are not there yet"));
  assert_in_range(made(&n), UNITS / 2, UNITS / 2 + 1);
  assert_int_equal(run_marked_part(p, &n, 2, 2), OLX_OK);
  assert_false(n.heeded); // the other half of the units is its own
  assert_int_equal(made(&n), UNITS);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_OK);
  assert_false(n.heeded); // the stage is complete
}

static void a_mark_that_is_damaged_or_lost_costs_nothing_but_time(void **state) {
  place *p = *state;
  numbers n = {0};
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  flip_byte(file_in(p, "awaited-0-0.unit"), 70);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_false(n.heeded);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_true(n.heeded);
  assert_int_equal(unlink(file_in(p, "awaited-0-0.unit")), 0);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_false(n.heeded);
}

static void a_mark_is_no_concern_of_whole_bakes(void **state) {
  place *p = *state;
  numbers n = {0};
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_int_equal(run_marked_part(p, &n, 0, 0), OLX_OK);
  assert_false(n.heeded);
  all_right(&n);
}

// Stores a mark as no program of ours leaves it. Returns what a part makes of it.
static olx_result heed_forged_mark(const place *p, const void *mark, size_t size_bytes) {
  numbers n = {0};
  olx_work_folder *folder = opened(p);
  const olx_unit_name name = {"awaited", 0, 0, OLX_PARTS_ALL};
  assert_int_equal(olx_work_folder_put(folder, &name, mark, size_bytes), OLX_OK);
  olx_work_folder_close(folder);
  olx_unit_store *store = store_of(p, &n, 1, 2, 0); // the first unit of 'cast' is of the other part
  const olx_result result = olx_units_heed_mark(store);
  olx_unit_store_close(store, false);
  return result;
}

static void a_mark_that_cannot_be_true_is_ignored(void **state) {
  struct {
    char stage[16];
    uint32_t numbers[4]; // round, count, parts of the scene, padding
  } mark = {"cast", {0, 1}};
  assert_int_equal(heed_forged_mark(*state, &mark, sizeof mark), OLX_ERROR_INCOMPLETE); // such a mark is believed
  mark.numbers[1] = UINT32_MAX;
  assert_int_equal(heed_forged_mark(*state, &mark, sizeof mark), OLX_OK);
  mark.numbers[1] = 1;
  memcpy(mark.stage, "../../../cast/x", 16);
  assert_int_equal(heed_forged_mark(*state, &mark, sizeof mark), OLX_OK);
  memset(mark.stage, 'a', 16);
  assert_int_equal(heed_forged_mark(*state, &mark, sizeof mark), OLX_OK);
}

static void joining_makes_nothing(void **state) {
  place *p = *state;
  numbers n = {0}, joined = {0};
  const olx_unit_stage stage = stage_of(&joined);
  const olx_unit_store_settings settings = {.folder = p->folder};
  olx_unit_store *store;
  assert_int_equal(run_whole(p, &n, 0), OLX_OK);
  assert_int_equal(olx_unit_store_open(&settings, &store), OLX_OK);
  assert_int_equal(olx_units_make(store, &stage), OLX_OK);
  all_right(&joined);
  flip_byte(file_in(p, "probe-0-9.unit"), 70);
  assert_int_equal(olx_units_make(store, &stage), OLX_ERROR_CHECKSUM);
  assert_non_null(strstr(olx_last_error(), "probe-0-9.unit: is damaged"));
  assert_true(exists(p->file));
  assert_int_equal(unlink(p->file), 0);
  assert_int_equal(olx_units_make(store, &stage), OLX_ERROR_INCOMPLETE);
  assert_int_equal(made(&joined), 0);
  olx_unit_store_close(store, false);
}

static void a_limit_bounds_the_folder(void **state) {
  place *p = *state;
  numbers n = {0}, more = {0};
  assert_int_equal(run_whole(p, &n, 700), OLX_OK);
  all_right(&n);
  olx_work_folder *folder = opened(p);
  assert_in_range(olx_work_folder_bytes(folder), 300, 700);
  olx_work_folder_close(folder);
  olx_unit_store *store = store_of(p, &more, 1, 1, 700);
  const olx_unit_stage stage = stage_of(&more);
  assert_int_equal(olx_units_make(store, &stage), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "more than the 700 bytes that the work folder may take"));
  olx_unit_store_close(store, false);
}

// A whole bake needs its folder only for the case that it is interrupted, while parts have nothing else.
static void a_full_disk_ends_a_part_alone(void **state) {
  const int errors[] = {ENOSPC, EDQUOT, EIO};
  place *p = *state;
  for (uint32_t i = 0; i < 3; i++) {
    numbers n = {0}, part = {0};
    olx_work_folder_close(opened(p));
    disk.write_error = errors[i];
    assert_int_equal(run_whole(p, &n, 0), errors[i] == EIO ? OLX_ERROR_FILE : OLX_OK);
    if (errors[i] != EIO) all_right(&n);
    assert_int_equal(run_part(p, &part, 1, 1), OLX_ERROR_FILE);
    assert_non_null(strstr(olx_last_error(), ".unit: cannot write: "));
    assert_int_equal(count_files(p->folder), 1);
    memset(&disk, 0, sizeof disk);
  }
}

static void bytes_that_end_early_are_an_error(void **state) {
  (void)state;
  olx_byte_writer writer = {0};
  const uint32_t values[] = {1, 2, 3};
  olx_bytes_put(&writer, values, 3, sizeof *values);
  olx_byte_reader reader = {.data = writer.data, .size_bytes = writer.size_bytes};
  assert_int_equal(olx_bytes_end(&reader, "values"), OLX_ERROR_FORMAT);
  uint32_t *copy = olx_bytes_take(&reader, 3, sizeof *copy);
  assert_memory_equal(copy, values, sizeof values);
  assert_int_equal(olx_bytes_end(&reader, "values"), OLX_OK);
  assert_null(olx_bytes_get(&reader, 1, 1));
  assert_null(olx_bytes_take(&reader, SIZE_MAX / 2, 8));
  assert_int_equal(olx_bytes_end(&reader, "values"), OLX_ERROR_FORMAT);
  olx_release(copy);
  olx_byte_writer_free(&writer);
}

#define IN_A_PLACE(test) cmocka_unit_test_setup_teardown(test, create_place, remove_place)

int main(void) {
  const struct CMUnitTest tests[] = {
      IN_A_PLACE(results_outlive_the_program_that_made_them),
      IN_A_PLACE(a_power_failure_leaves_whole_results_or_none),
      IN_A_PLACE(a_full_disk_is_an_error_and_keeps_what_was_there),
      IN_A_PLACE(damage_anywhere_is_found),
      IN_A_PLACE(a_result_under_another_name_is_no_result),
      IN_A_PLACE(another_bake_is_refused_by_what_differs),
      IN_A_PLACE(beginning_again_forgets_another_bake),
      IN_A_PLACE(joining_takes_the_folders_own_manifest),
      IN_A_PLACE(folders_that_are_not_ours_are_refused_and_left_alone),
      IN_A_PLACE(a_folder_with_a_damaged_manifest_is_left_alone),
      IN_A_PLACE(a_manifest_that_cannot_be_read_now_is_no_reason_to_remove_it),
      IN_A_PLACE(only_what_the_manifest_names_is_removed),
      IN_A_PLACE(the_manifest_outlives_the_units),
      IN_A_PLACE(a_folder_that_is_half_removed_is_begun_anew),
      IN_A_PLACE(links_in_the_folder_are_not_followed),
      IN_A_PLACE(who_works_alone_keeps_others_out),
      IN_A_PLACE(units_hold_while_the_parts_of_the_scene_do_that_they_need),
      IN_A_PLACE(tidying_leaves_what_cannot_be_read_now),
      IN_A_PLACE(keys_outlive_the_manifest_of_an_edit),
      IN_A_PLACE(an_edit_has_to_be_allowed_and_to_be_of_the_scene_alone),
      cmocka_unit_test(without_a_store_every_unit_is_made),
      IN_A_PLACE(a_whole_bake_makes_what_is_missing),
      IN_A_PLACE(parts_in_any_order_make_every_unit_once),
      IN_A_PLACE(a_part_that_reads_a_damaged_unit_has_it_made_again),
      IN_A_PLACE(what_cannot_be_read_now_is_never_removed),
      IN_A_PLACE(a_part_without_a_missing_unit_heeds_the_mark_of_others),
      IN_A_PLACE(a_mark_that_is_damaged_or_lost_costs_nothing_but_time),
      IN_A_PLACE(a_mark_is_no_concern_of_whole_bakes),
      IN_A_PLACE(a_mark_that_cannot_be_true_is_ignored),
      IN_A_PLACE(joining_makes_nothing),
      IN_A_PLACE(a_limit_bounds_the_folder),
      IN_A_PLACE(a_full_disk_ends_a_part_alone),
      cmocka_unit_test(bytes_that_end_early_are_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
