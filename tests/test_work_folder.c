// Tests work folders: results come back as they were stored or not at all, wrong folders are refused, and only the
// folder's own files are removed.
#include "faults/work_place.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static void write_file(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
}

static void refused(const work_place *p, const char *why) {
  const olx_manifest manifest = work_place_manifest("a", "avx2");
  olx_work_folder *folder;
  assert_int_not_equal(work_place_open_as(p, &manifest, OLX_WORK_ALONE, false, &folder), OLX_OK);
  assert_null(folder);
  if (!strstr(olx_last_error(), why)) fail_msg("'%s' does not say '%s'", olx_last_error(), why);
}

static const olx_unit_name probe_3 = {"probe", 0, 3, OLX_PARTS_ALL}, cast_2_7 = {"cast", 2, 7, OLX_PARTS_ALL};

static void results_outlive_the_program_that_made_them(void **state) {
  olx_work_folder *folder = work_place_open(*state);
  assert_false(olx_work_folder_has(folder, &probe_3));
  put_unit_text(folder, &probe_3, "a result");
  put_unit_text(folder, &cast_2_7, "");
  olx_work_folder_close(folder);
  folder = work_place_open(*state);
  assert_true(olx_work_folder_has(folder, &probe_3));
  holds_unit_text(folder, &probe_3, "a result");
  holds_unit_text(folder, &cast_2_7, "");
  put_unit_text(folder, &probe_3, "another");
  holds_unit_text(folder, &probe_3, "another");
  assert_false(olx_work_folder_has(folder, &(olx_unit_name){"probe", 0, 4, OLX_PARTS_ALL}));
  olx_work_folder_close(folder);
}

// Contents are durable before a file gets its name, and names before success is reported.
static void a_power_failure_leaves_whole_results_or_none(void **state) {
  olx_work_folder *folder = work_place_open(*state);
  memset(&work_disk, 0, sizeof work_disk);
  put_unit_text(folder, &probe_3, "a result");
  const char *last_write = strrchr(work_disk.calls, 'w'), *sync = strchr(work_disk.calls, 's'),
             *rename = strchr(work_disk.calls, 'r');
  assert_non_null(last_write);
  assert_non_null(sync);
  assert_non_null(rename);
  assert_true(last_write < sync && sync < rename);
  assert_string_equal(rename, "rf");
  olx_work_folder_close(folder);
}

static void a_full_disk_is_an_error_and_keeps_what_was_there(void **state) {
  olx_work_folder *folder = work_place_open(*state);
  put_unit_text(folder, &probe_3, "a result");
  work_disk.write_error = ENOSPC;
  assert_int_equal(olx_work_folder_put(folder, &probe_3, "more", 4), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "probe-0-3.unit: cannot write: No space left"));
  work_disk.write_error = 0;
  holds_unit_text(folder, &probe_3, "a result");
  olx_work_folder_remove(folder);
  assert_false(file_exists(((work_place *)*state)->folder));
}

static long size_of(const char *path) {
  struct stat status;
  assert_int_equal(stat(path, &status), 0);
  return (long)status.st_size;
}

static void is_damaged(const olx_work_folder *folder, const olx_unit_name *name) {
  void *data;
  size_t size_bytes;
  assert_int_equal(olx_work_folder_get(folder, name, &data, &size_bytes), OLX_ERROR_CHECKSUM);
  assert_non_null(strstr(olx_last_error(), ".unit: is damaged"));
  assert_null(data);
}

static void damage_anywhere_is_found(void **state) {
  work_place *p = *state;
  olx_work_folder *folder = work_place_open(p);
  put_unit_text(folder, &probe_3, "a result");
  const long size_bytes = size_of(work_place_file(p, "probe-0-3.unit"));
  for (long at = 0; at < size_bytes; at++) {
    flip_byte(work_place_file(p, "probe-0-3.unit"), at);
    is_damaged(folder, &probe_3);
    flip_byte(work_place_file(p, "probe-0-3.unit"), at);
  }
  holds_unit_text(folder, &probe_3, "a result");
  assert_int_equal(truncate(work_place_file(p, "probe-0-3.unit"), size_bytes + 1), 0);
  is_damaged(folder, &probe_3);
  for (long length = 0; length < size_bytes; length++) {
    assert_int_equal(truncate(work_place_file(p, "probe-0-3.unit"), size_bytes - 1 - length), 0);
    is_damaged(folder, &probe_3);
  }
  olx_work_folder_close(folder);
}

static void a_result_under_another_name_is_no_result(void **state) {
  work_place *p = *state;
  char other[512];
  olx_work_folder *folder = work_place_open(p);
  put_unit_text(folder, &probe_3, "a result");
  snprintf(other, sizeof other, "%s", work_place_file(p, "probe-0-4.unit"));
  assert_int_equal(rename(work_place_file(p, "probe-0-3.unit"), other), 0);
  is_damaged(folder, &(olx_unit_name){"probe", 0, 4, OLX_PARTS_ALL});
  olx_work_folder_close(folder);
}

static void another_bake_is_refused_by_what_differs(void **state) {
  work_place *p = *state;
  const olx_manifest moved = work_place_manifest("b", "avx2"), wider = work_place_manifest("a", "avx512");
  olx_work_folder *folder = work_place_open(p);
  put_unit_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
  assert_int_equal(work_place_open_as(p, &moved, OLX_WORK_ALONE, false, &folder), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "with 'scene a' in place of 'scene b'"));
  assert_int_equal(work_place_open_as(p, &wider, OLX_WORK_ALONE, false, &folder), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "with 'instructions avx2' in place of 'instructions avx512'"));
  folder = work_place_open(p);
  holds_unit_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
}

static void beginning_again_forgets_another_bake(void **state) {
  work_place *p = *state;
  const olx_manifest moved = work_place_manifest("b", "avx2");
  olx_work_folder *folder = work_place_open(p);
  put_unit_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
  assert_int_equal(work_place_open_as(p, &moved, OLX_WORK_ALONE, true, &folder), OLX_OK);
  assert_false(olx_work_folder_has(folder, &probe_3));
  assert_string_equal(olx_manifest_find(olx_work_folder_manifest(folder), "scene").text, "b");
  olx_work_folder_close(folder);
}

static void joining_takes_the_folders_own_manifest(void **state) {
  work_place *p = *state;
  olx_work_folder *folder;
  assert_int_equal(work_place_open_as(p, NULL, OLX_WORK_ALONE, false, &folder), OLX_ERROR_FILE);
  assert_false(file_exists(p->folder));
  olx_work_folder_close(work_place_open(p));
  assert_int_equal(work_place_open_as(p, NULL, OLX_WORK_ALONE, false, &folder), OLX_OK);
  assert_string_equal(olx_manifest_find(olx_work_folder_manifest(folder), "instructions").text, "avx2");
  assert_string_equal(olx_manifest_find(olx_work_folder_manifest(folder), "instruction").text, "");
  olx_work_folder_close(folder);
}

static void folders_that_are_not_ours_are_refused_and_left_alone(void **state) {
  work_place *p = *state;
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
  write_file(work_place_file(p, "notes.txt"), "mine");
  refused(p, "it has no manifest, and there are files in it");
  assert_true(file_exists(work_place_file(p, "notes.txt")));
  assert_int_equal(unlink(work_place_file(p, "notes.txt")), 0);
  assert_int_equal(chmod(p->folder, 0750), 0);
  refused(p, "others may look into it");
  assert_int_equal(chmod(p->folder, 0700), 0);
  olx_work_folder_close(work_place_open(p));
}

static void a_folder_with_a_damaged_manifest_is_left_alone(void **state) {
  work_place *p = *state;
  const olx_manifest manifest = work_place_manifest("a", "avx2");
  olx_work_folder *folder = work_place_open(p);
  put_unit_text(folder, &probe_3, "a result");
  olx_work_folder_close(folder);
  flip_byte(work_place_file(p, "manifest-0-0.unit"), 70);
  refused(p, "manifest-0-0.unit: is damaged; nothing says what the folder's other files are");
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_ALONE, true, &folder), OLX_ERROR_CHECKSUM);
  assert_true(file_exists(work_place_file(p, "probe-0-3.unit")));
}

static void a_manifest_that_cannot_be_read_now_is_no_reason_to_remove_it(void **state) {
  work_place *p = *state;
  const olx_manifest manifest = work_place_manifest("a", "avx2");
  olx_work_folder *folder = work_place_open(p);
  olx_work_folder_close(folder);
  work_disk.spoilt = "manifest-0-0.unit";
  work_disk.open_error = EMFILE;
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_ALONE, true, &folder), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "manifest-0-0.unit: cannot open: Too many open files"));
  assert_null(strstr(olx_last_error(), "by hand"));
  memset(&work_disk, 0, sizeof work_disk);
  olx_work_folder_close(work_place_open(p));
}

static void only_what_the_manifest_names_is_removed(void **state) {
  static const char *const foreign[] = {"notes.txt", "other-0-1.unit", "probe-x-1.unit", "probe-0.unit",
                                        "probe-0-1.unit.old"};
  work_place *p = *state;
  olx_work_folder *folder = work_place_open(p);
  put_unit_text(folder, &probe_3, "a result");
  for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) write_file(work_place_file(p, foreign[i]), "mine");
  write_file(work_place_file(p, "../outside"), "mine");
  assert_int_equal(symlink("../outside", work_place_file(p, "cast-0-0.unit")), 0);
  olx_work_folder_remove(folder);
  for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++)
    assert_true(file_exists(work_place_file(p, foreign[i])));
  assert_true(file_exists(work_place_file(p, "cast-0-0.unit")));
  assert_true(file_exists(work_place_file(p, "../outside")));
  assert_false(file_exists(work_place_file(p, "probe-0-3.unit")));
  assert_false(file_exists(work_place_file(p, "manifest-0-0.unit")));
}

enum { STORED = 12 };

static void put_units(olx_work_folder *folder) {
  for (uint32_t i = 0; i < STORED; i++)
    put_unit_text(folder, &(olx_unit_name){"probe", 0, i, OLX_PARTS_ALL}, "a result");
}

static void the_manifest_outlives_the_units(void **state) {
  work_place *p = *state;
  olx_work_folder *folder = work_place_open(p);
  put_units(folder);
  memset(&work_disk, 0, sizeof work_disk);
  olx_work_folder_remove(folder);
  const char *marked = strchr(work_disk.calls, 'r'), *unit = strchr(work_disk.calls, 'u');
  assert_true(marked && unit && marked < unit);
  assert_string_equal(unit, "uuuuuuuuuuuum");
}

// A folder whose removal a killed program has begun belongs to no bake: the next one clears it, whatever bake it is.
static void a_folder_that_is_half_removed_is_begun_anew(void **state) {
  work_place *p = *state;
  const olx_manifest moved = work_place_manifest("b", "avx2");
  olx_work_folder *folder = work_place_open(p);
  put_units(folder);
  memset(&work_disk, 0, sizeof work_disk);
  work_disk.most_unlinks = 5;
  olx_work_folder_remove(folder);
  assert_int_equal(count_files(p->folder), STORED - 5 + 1);
  assert_int_equal(work_place_open_as(p, NULL, OLX_WORK_ALONE, false, &folder), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "its bake is finished"));
  work_disk.most_unlinks = 0;
  assert_int_equal(work_place_open_as(p, &moved, OLX_WORK_ALONE, false, &folder), OLX_OK);
  assert_int_equal(count_files(p->folder), 1);
  olx_work_folder_remove(folder);
  assert_false(file_exists(p->folder));
}

static void links_in_the_folder_are_not_followed(void **state) {
  work_place *p = *state;
  char target[512];
  olx_work_folder *folder = work_place_open(p);
  put_unit_text(folder, &probe_3, "a result");
  snprintf(target, sizeof target, "%s", work_place_file(p, "../moved"));
  assert_int_equal(rename(work_place_file(p, "probe-0-3.unit"), target), 0);
  assert_int_equal(symlink("../moved", work_place_file(p, "probe-0-3.unit")), 0);
  void *data;
  size_t size_bytes;
  assert_false(olx_work_folder_has(folder, &probe_3));
  assert_int_equal(olx_work_folder_get(folder, &probe_3, &data, &size_bytes), OLX_ERROR_INCOMPLETE);
  olx_work_folder_drop(folder, &probe_3);
  assert_true(file_exists(work_place_file(p, "probe-0-3.unit")));
  put_unit_text(folder, &probe_3, "a new one");
  const long moved_bytes = size_of(target);
  holds_unit_text(folder, &probe_3, "a new one");
  assert_int_equal(size_of(target), moved_bytes);
  olx_work_folder_close(folder);
}

static void who_works_alone_keeps_others_out(void **state) {
  work_place *p = *state;
  const olx_manifest manifest = work_place_manifest("a", "avx2");
  olx_work_folder *alone = work_place_open(p), *other, *shared;
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_ALONE, false, &other), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "another bake works in this folder"));
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_SHARED, false, &other), OLX_ERROR_FILE);
  olx_work_folder_close(alone);
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_SHARED, false, &shared), OLX_OK);
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_SHARED, false, &other), OLX_OK);
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_ALONE, false, &alone), OLX_ERROR_FILE);
  olx_work_folder_close(shared);
  olx_work_folder_close(other);
  olx_work_folder_close(work_place_open(p));
}

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
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
