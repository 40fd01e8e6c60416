// Tests the store of units: what is missing, damaged or of another scene is made, parts compute the right units, and
// what cannot be read for a while is never removed.
#include "faults/work_place.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

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
  olx_manifest manifest = work_place_manifest("a", "avx2");
  olx_manifest_add(&manifest, "walls", walls);
  olx_manifest_add(&manifest, "paint", paint);
  olx_manifest_add(&manifest, "parts-of-scene", "walls paint");
  return manifest;
}

static olx_work_folder *open_scene(const work_place *p, const char *walls, const char *paint) {
  const olx_manifest manifest = scene_manifest(walls, paint);
  const olx_work_folder_settings settings = {.manifest = &manifest, .lock = OLX_WORK_ALONE, .edited = true};
  olx_work_folder *folder;
  assert_int_equal(olx_work_folder_open(p->folder, &settings, &folder), OLX_OK);
  return folder;
}

static void units_hold_while_the_parts_of_the_scene_do_that_they_need(void **state) {
  work_place *p = *state;
  const olx_unit_name of_walls = {"cast", 0, 0, WALLS}, of_all = {"probe", 0, 0, OLX_PARTS_ALL};
  olx_work_folder *folder = open_scene(p, "brick", "red");
  put_unit_text(folder, &of_walls, "a shape");
  put_unit_text(folder, &of_all, "a colour");
  olx_work_folder_close(folder);

  folder = open_scene(p, "brick", "blue");
  assert_int_equal(olx_work_folder_edited(folder), PAINT);
  holds_unit_text(folder, &of_walls, "a shape");
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
  holds_unit_text(folder, &of_walls, "a shape");
  olx_work_folder_close(folder);
}

static void tidying_leaves_what_cannot_be_read_now(void **state) {
  work_place *p = *state;
  const olx_unit_name of_walls = {"cast", 0, 0, WALLS};
  olx_work_folder *folder = open_scene(p, "brick", "red");
  put_unit_text(folder, &of_walls, "a shape");
  olx_work_folder_close(folder);
  for (uint32_t i = 0; i < 2; i++) {
    folder = open_scene(p, "brick", i ? "green" : "blue");
    work_disk.spoilt = "cast-0-0.unit";
    *(i ? &work_disk.read_error : &work_disk.open_error) = EIO;
    olx_work_folder_tidy(folder);
    memset(&work_disk, 0, sizeof work_disk);
    holds_unit_text(folder, &of_walls, "a shape");
    olx_work_folder_close(folder);
  }
}

// After an interrupted bake of an edited scene, and after an edit that is taken back, keys alone tell what holds.
static void keys_outlive_the_manifest_of_an_edit(void **state) {
  work_place *p = *state;
  const olx_unit_name of_all = {"probe", 0, 0, OLX_PARTS_ALL};
  olx_work_folder *folder = open_scene(p, "brick", "red");
  put_unit_text(folder, &of_all, "a colour");
  olx_work_folder_close(folder);
  olx_work_folder_close(open_scene(p, "brick", "blue"));
  folder = open_scene(p, "brick", "blue");
  assert_int_equal(olx_work_folder_edited(folder), 0);
  assert_int_equal(olx_work_folder_look(folder, &of_all), OLX_UNIT_STALE);
  olx_work_folder_close(folder);
  folder = open_scene(p, "brick", "red");
  holds_unit_text(folder, &of_all, "a colour");
  olx_work_folder_close(folder);
}

static void an_edit_has_to_be_allowed_and_to_be_of_the_scene_alone(void **state) {
  work_place *p = *state;
  olx_work_folder_close(open_scene(p, "brick", "red"));
  const olx_manifest painted = scene_manifest("brick", "blue");
  olx_manifest other = scene_manifest("brick", "blue");
  olx_manifest_add(&other, "noise", "0.1");
  olx_work_folder *folder;
  assert_int_equal(work_place_open_as(p, &painted, OLX_WORK_ALONE, false, &folder), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "with 'paint red' in place of 'paint blue'"));
  assert_non_null(strstr(olx_last_error(), "or reuse what still holds with --keep-work"));
  const olx_work_folder_settings settings = {.manifest = &other, .lock = OLX_WORK_ALONE, .edited = true};
  assert_int_equal(olx_work_folder_open(p->folder, &settings, &folder), OLX_ERROR_ARGUMENT);
  assert_null(strstr(olx_last_error(), "--keep-work"));
}

static olx_unit_store *store_of(const work_place *p, numbers *n, uint32_t part, uint32_t parts, uint64_t limit_bytes) {
  const olx_manifest manifest = work_place_manifest("a", "avx2");
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

static olx_result run_whole(const work_place *p, numbers *n, uint64_t limit_bytes) {
  olx_unit_store *store = store_of(p, n, 0, 0, limit_bytes);
  const olx_unit_stage stage = stage_of(n);
  const olx_result result = olx_units_make(store, &stage);
  olx_unit_store_close(store, false);
  return result;
}

static olx_result run_part(const work_place *p, numbers *n, uint32_t part, uint32_t parts) {
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
  work_place *p = *state;
  assert_int_equal(run_whole(p, &first, 0), OLX_OK);
  assert_int_equal(made(&first), UNITS);
  assert_int_equal(first.told, UNITS);
  assert_int_equal(unlink(work_place_file(p, "probe-0-5.unit")), 0);
  flip_byte(work_place_file(p, "probe-0-9.unit"), 70);
  assert_int_equal(run_whole(p, &second, 0), OLX_OK);
  assert_int_equal(made(&second), 2);
  assert_true(second.made[5] && second.made[9]);
  assert_int_equal(second.told, UNITS);
  all_right(&second);
}

static void parts_in_any_order_make_every_unit_once(void **state) {
  work_place *p = *state;
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
  work_place *p = *state;
  numbers n = {0};
  assert_int_equal(run_whole(p, &n, 0), OLX_OK);
  flip_byte(work_place_file(p, "probe-0-9.unit"), 70);
  assert_int_equal(run_part(p, &n, 1, 1), OLX_ERROR_INCOMPLETE);
  assert_int_equal(run_part(p, &n, 1, 1), OLX_OK);
  assert_int_equal(n.made[9], 2);
  assert_int_equal(made(&n), UNITS + 1);
}

// A process may have too many open files and a server may be away; what is stored is as good as before.
static void what_cannot_be_read_now_is_never_removed(void **state) {
  const int faults[][2] = {{EMFILE, 0}, {ENFILE, 0}, {ESTALE, 0}, {EIO, 0}, {0, EIO}};
  work_place *p = *state;
  numbers n = {0};
  assert_int_equal(run_whole(p, &n, 0), OLX_OK);
  for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
    numbers whole = {0}, part = {0};
    memset(&work_disk, 0, sizeof work_disk);
    work_disk.spoilt = "probe-0-9.unit";
    work_disk.open_error = faults[i][0];
    work_disk.read_error = faults[i][1];
    assert_int_equal(run_part(p, &part, 1, 1), OLX_ERROR_FILE);
    assert_non_null(strstr(olx_last_error(), "probe-0-9.unit: cannot "));
    assert_int_equal(work_disk.count, 0);
    assert_int_equal(run_whole(p, &whole, 0), OLX_OK);
    assert_int_equal(made(&whole), 1);
    assert_int_equal(whole.made[9], 1);
    all_right(&whole);
    assert_null(strchr(work_disk.calls, 'u'));
    memset(&work_disk, 0, sizeof work_disk);
    assert_int_equal(run_part(p, &part, 1, 1), OLX_OK);
    assert_int_equal(made(&part), 0);
    all_right(&part);
  }
}

// Runs a part as the light of a scene does: it heeds the mark, and leaves one where it cannot go on.
static olx_result run_marked_part(const work_place *p, numbers *n, uint32_t part, uint32_t parts) {
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
  work_place *p = *state;
  numbers n = {0};
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_false(n.heeded); // there was no mark
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_true(n.heeded);
  assert_non_null(strstr(olx_last_error(), "units of the stage 'probe' are not there yet"));
  assert_in_range(made(&n), UNITS / 2, UNITS / 2 + 1);
  // Waiting for them counts those that are missing, not all from the first missing one on.
  olx_unit_store *store = store_of(p, &n, 1, 2, 0);
  const olx_unit_stage stage = stage_of(&n);
  char missing[64];
  snprintf(missing, sizeof missing, ": %u of %u units of the stage", UNITS - made(&n), (unsigned)UNITS);
  assert_int_equal(olx_units_await(store, &stage), OLX_ERROR_INCOMPLETE);
  assert_non_null(strstr(olx_last_error(), missing));
  olx_unit_store_close(store, false);
  assert_int_equal(run_marked_part(p, &n, 2, 2), OLX_OK);
  assert_false(n.heeded); // the other half of the units is its own
  assert_int_equal(made(&n), UNITS);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_OK);
  assert_false(n.heeded); // the stage is complete
}

static void a_mark_that_is_damaged_or_lost_costs_nothing_but_time(void **state) {
  work_place *p = *state;
  numbers n = {0};
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  flip_byte(work_place_file(p, "awaited-0-0.unit"), 70);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_false(n.heeded);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_true(n.heeded);
  assert_int_equal(unlink(work_place_file(p, "awaited-0-0.unit")), 0);
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_false(n.heeded);
}

static void a_mark_is_no_concern_of_whole_bakes(void **state) {
  work_place *p = *state;
  numbers n = {0};
  assert_int_equal(run_marked_part(p, &n, 1, 2), OLX_ERROR_INCOMPLETE);
  assert_int_equal(run_marked_part(p, &n, 0, 0), OLX_OK);
  assert_false(n.heeded);
  all_right(&n);
}

// Stores a mark as no program of ours leaves it. Returns what a part makes of it.
static olx_result heed_forged_mark(const work_place *p, const void *mark, size_t size_bytes) {
  numbers n = {0};
  olx_work_folder *folder = work_place_open(p);
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
  work_place *p = *state;
  numbers n = {0}, joined = {0};
  const olx_unit_stage stage = stage_of(&joined);
  const olx_unit_store_settings settings = {.folder = p->folder};
  olx_unit_store *store;
  assert_int_equal(run_whole(p, &n, 0), OLX_OK);
  assert_int_equal(olx_unit_store_open(&settings, &store), OLX_OK);
  assert_int_equal(olx_units_make(store, &stage), OLX_OK);
  all_right(&joined);
  flip_byte(work_place_file(p, "probe-0-9.unit"), 70);
  assert_int_equal(olx_units_make(store, &stage), OLX_ERROR_CHECKSUM);
  assert_non_null(strstr(olx_last_error(), "probe-0-9.unit: is damaged"));
  assert_true(file_exists(p->file));
  assert_int_equal(unlink(p->file), 0);
  assert_int_equal(olx_units_make(store, &stage), OLX_ERROR_INCOMPLETE);
  assert_int_equal(made(&joined), 0);
  olx_unit_store_close(store, false);
}

static void a_limit_bounds_the_folder(void **state) {
  work_place *p = *state;
  numbers n = {0}, more = {0};
  assert_int_equal(run_whole(p, &n, 700), OLX_OK);
  all_right(&n);
  olx_work_folder *folder = work_place_open(p);
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
  work_place *p = *state;
  for (uint32_t i = 0; i < 3; i++) {
    numbers n = {0}, part = {0};
    olx_work_folder_close(work_place_open(p));
    work_disk.write_error = errors[i];
    assert_int_equal(run_whole(p, &n, 0), errors[i] == EIO ? OLX_ERROR_FILE : OLX_OK);
    if (errors[i] != EIO) all_right(&n);
    assert_int_equal(run_part(p, &part, 1, 1), OLX_ERROR_FILE);
    assert_non_null(strstr(olx_last_error(), ".unit: cannot write: "));
    assert_int_equal(count_files(p->folder), 1);
    memset(&work_disk, 0, sizeof work_disk);
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

int main(void) {
  const struct CMUnitTest tests[] = {
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
