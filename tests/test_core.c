// Tests results and messages, hooks, the parallel loop, and files that are never left half written.
#include "core/file.h"
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"

#include <dirent.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

// ---- a folder of its own for each test that writes

typedef struct folder {
  char path[256];
  char file[300]; // the path of a file in the folder
} folder;

static int folder_create(void **state) {
  folder *f = calloc(1, sizeof *f);
  const char *base = getenv("TMPDIR");
  snprintf(f->path, sizeof f->path, "%s/octalux-core-XXXXXX", base && *base ? base : "/tmp");
  if (!mkdtemp(f->path)) return -1;
  snprintf(f->file, sizeof f->file, "%s/out.bin", f->path);
  *state = f;
  return 0;
}

static uint32_t folder_entries(const folder *f) {
  uint32_t count = 0;
  DIR *directory = opendir(f->path);
  assert_non_null(directory);
  for (struct dirent *entry; (entry = readdir(directory));) {
    count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
  }
  closedir(directory);
  return count;
}

static int folder_remove(void **state) {
  folder *f = *state;
  olx_set_hooks(NULL);
  DIR *directory = opendir(f->path);
  for (struct dirent *entry; directory && (entry = readdir(directory));) {
    char name[600];
    snprintf(name, sizeof name, "%s/%s", f->path, entry->d_name);
    if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) remove(name);
  }
  if (directory) closedir(directory);
  rmdir(f->path);
  free(f);
  return 0;
}

static int hooks_restore(void **state) {
  (void)state;
  olx_set_hooks(NULL);
  return 0;
}

static void assert_content(const char *path, const char *expected) {
  char content[64] = {0};
  FILE *stream = fopen(path, "rb");
  assert_non_null(stream);
  const size_t length = fread(content, 1, sizeof content - 1, stream);
  fclose(stream);
  assert_int_equal(length, strlen(expected));
  assert_string_equal(content, expected);
}

// ---- results

static void every_result_has_a_name_of_its_own(void **state) {
  (void)state;
  for (int a = OLX_OK; a <= OLX_ERROR_GPU; a++) {
    assert_string_not_equal(olx_result_name((olx_result)a), "unknown result");
    for (int b = OLX_OK; b < a; b++) {
      assert_string_not_equal(olx_result_name((olx_result)a), olx_result_name((olx_result)b));
    }
  }
  assert_string_equal(olx_result_name((olx_result)1000), "unknown result");
}

static void version_is_that_of_the_header(void **state) {
  (void)state;
  char expected[32];
  snprintf(expected, sizeof expected, "%d.%d.%d", OLX_VERSION_MAJOR, OLX_VERSION_MINOR, OLX_VERSION_PATCH);
  assert_string_equal(olx_version(), expected);
}

static void a_message_may_quote_the_one_before(void **state) {
  (void)state;
  assert_int_equal(olx_fail(OLX_ERROR_FORMAT, "probe %d is odd", 7), OLX_ERROR_FORMAT);
  assert_int_equal(olx_fail(OLX_ERROR_FILE, "a.olx: %s", olx_last_error()), OLX_ERROR_FILE);
  assert_string_equal(olx_last_error(), "a.olx: probe 7 is odd");
}

static void a_message_too_long_is_cut(void **state) {
  (void)state;
  char text[5000];
  memset(text, 'x', sizeof text - 1);
  text[sizeof text - 1] = 0;
  olx_fail(OLX_ERROR_FILE, "%s", text);
  assert_int_equal(strspn(olx_last_error(), "x"), strlen(olx_last_error()));
  assert_in_range(strlen(olx_last_error()), 500, sizeof text - 2);
}

static void *fail_on_thread(void *user) {
  const bool fresh = olx_last_error()[0] == 0;
  olx_fail(OLX_ERROR_FILE, "of the other thread");
  *(bool *)user = fresh && strcmp(olx_last_error(), "of the other thread") == 0;
  return NULL;
}

static void messages_are_kept_per_thread(void **state) {
  (void)state;
  olx_fail(OLX_ERROR_FORMAT, "of this thread");
  pthread_t thread;
  bool good = false;
  assert_int_equal(pthread_create(&thread, NULL, fail_on_thread, &good), 0);
  pthread_join(thread, NULL);
  assert_true(good);
  assert_string_equal(olx_last_error(), "of this thread");
}

// ---- hooks

typedef struct host {
  uint64_t allocated, released, failing_after; // failing_after is the number of allocations that still succeed
  char message[2048];
  olx_log_level level;
  uint32_t loops, wanted_threads;
} host;

static void *host_allocate(void *user, size_t size_bytes) {
  host *h = user;
  if (h->failing_after == 0) return NULL;
  h->failing_after--;
  h->allocated++;
  return aligned_alloc(64, (size_bytes + 63) & ~(size_t)63);
}

static void host_release(void *user, void *memory) {
  host *h = user;
  h->released++;
  free(memory);
}

static void host_log(void *user, olx_log_level level, const char *message) {
  host *h = user;
  h->level = level;
  snprintf(h->message, sizeof h->message, "%s", message);
}

// A host's parallel loop that runs all jobs backwards.
static void host_parallel_for(void *user, uint32_t count, uint32_t threads, void (*job)(void *, uint32_t),
                              void *job_user) {
  host *h = user;
  h->loops++;
  h->wanted_threads = threads;
  for (uint32_t i = count; i-- > 0;) job(job_user, i);
}

static void memory_is_aligned_and_zeroed_when_asked(void **state) {
  (void)state;
  for (size_t size = 0; size < 300; size += 7) {
    unsigned char *memory = olx_allocate_zero(size, 3);
    assert_non_null(memory);
    assert_int_equal((uintptr_t)memory % 64, 0);
    for (size_t i = 0; i < size * 3; i++) assert_int_equal(memory[i], 0);
    olx_release(memory);
  }
  olx_release(NULL);
}

static void sizes_that_overflow_get_no_memory(void **state) {
  (void)state;
  assert_null(olx_allocate(SIZE_MAX, 2));
  assert_null(olx_allocate(SIZE_MAX / 2 + 1, 1));
  assert_null(olx_allocate_zero(SIZE_MAX / 4, 8));
}

static void all_memory_comes_from_the_host(void **state) {
  const folder *f = *state;
  host h = {.failing_after = UINT64_MAX};
  olx_set_hooks(&(olx_hooks){.user = &h, .allocate = host_allocate, .release = host_release});
  char *copy = olx_copy_string("octahedron");
  assert_string_equal(copy, "octahedron");
  olx_release(copy);
  assert_int_equal(olx_write_file(f->file, "data", 4), OLX_OK);
  olx_set_hooks(NULL);
  assert_true(h.allocated >= 2);
  assert_int_equal(h.allocated, h.released);
}

static void half_an_allocator_is_none(void **state) {
  (void)state;
  host h = {.failing_after = UINT64_MAX};
  olx_set_hooks(&(olx_hooks){.user = &h, .allocate = host_allocate});
  olx_release(olx_allocate(1, 1));
  olx_set_hooks(&(olx_hooks){.user = &h, .release = host_release});
  olx_release(olx_allocate(1, 1));
  assert_int_equal(h.allocated, 0);
  assert_int_equal(h.released, 0);
}

static void running_out_of_memory_anywhere_is_answered(void **state) {
  const folder *f = *state;
  host h = {.failing_after = UINT64_MAX};
  olx_set_hooks(&(olx_hooks){.user = &h, .allocate = host_allocate, .release = host_release});
  assert_int_equal(olx_write_file(f->file, "old", 3), OLX_OK);
  const uint64_t needed = h.allocated;
  assert_true(needed > 0);
  for (uint64_t granted = 0; granted < needed; granted++) {
    h = (host){.failing_after = granted};
    assert_int_equal(olx_write_file(f->file, "new", 3), OLX_ERROR_MEMORY);
    assert_non_null(strstr(olx_last_error(), f->file));
    assert_int_equal(h.allocated, h.released);
    assert_int_equal(folder_entries(f), 1);
  }
  assert_content(f->file, "old");
  assert_null(olx_copy_string("no memory left"));
}

static void messages_reach_the_host_in_one_piece(void **state) {
  (void)state;
  host h = {.failing_after = UINT64_MAX};
  olx_set_hooks(&(olx_hooks){.user = &h, .log = host_log});
  olx_log(OLX_LOG_WARNING, "%s: %d skipped", "a.obj", 3);
  assert_string_equal(h.message, "a.obj: 3 skipped");
  assert_int_equal(h.level, OLX_LOG_WARNING);
  char text[5000];
  memset(text, 'y', sizeof text - 1);
  text[sizeof text - 1] = 0;
  olx_log(OLX_LOG_INFO, "%s", text);
  assert_int_equal(h.level, OLX_LOG_INFO);
  assert_in_range(strlen(h.message), 500, sizeof h.message - 1);
}

static void by_default_warnings_and_errors_go_to_standard_error(void **state) {
  const folder *f = *state;
  fflush(stderr);
  const int kept = dup(STDERR_FILENO);
  assert_non_null(freopen(f->file, "wb", stderr));
  olx_log(OLX_LOG_INFO, "quiet");
  olx_log(OLX_LOG_WARNING, "careful");
  olx_log(OLX_LOG_ERROR, "broken");
  fflush(stderr);
  dup2(kept, STDERR_FILENO);
  close(kept);
  assert_content(f->file, "warning: careful\nerror: broken\n");
}

// ---- the parallel loop

enum { MOST_INDICES = 1000 };

static void count_visit(void *user, uint32_t index) {
  atomic_uint *visits = user;
  atomic_fetch_add(&visits[index], 1);
}

static void every_index_runs_once_on_any_number_of_threads(void **state) {
  (void)state;
  const uint32_t counts[] = {0, 1, 2, 7, 63, MOST_INDICES}, threads[] = {0, 1, 2, 3, 8, 1000};
  for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
    for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
      atomic_uint visits[MOST_INDICES + 1] = {0};
      assert_int_equal(olx_parallel_for(counts[c], threads[t], count_visit, visits, NULL, 0), OLX_OK);
      for (uint32_t i = 0; i <= MOST_INDICES; i++) assert_int_equal(visits[i], i < counts[c] ? 1 : 0);
    }
  }
}

static void the_host_runs_the_loop_when_it_wants_to(void **state) {
  (void)state;
  host h = {0};
  olx_set_hooks(&(olx_hooks){.user = &h, .parallel_for = host_parallel_for});
  atomic_uint visits[MOST_INDICES] = {0};
  assert_int_equal(olx_parallel_for(MOST_INDICES, 5, count_visit, visits, NULL, 0), OLX_OK);
  for (uint32_t i = 0; i < MOST_INDICES; i++) assert_int_equal(visits[i], 1);
  assert_int_equal(h.loops, 1);
  assert_int_equal(h.wanted_threads, 5);
}

typedef struct record {
  float shares[4096];
  uint32_t reports, cancel_at; // cancel_at is the report that cancels, or 0 for none
  char last_stage[32];
  long sleep_ns;
  atomic_uint inside;
  bool overlapped;
} record;

static bool record_report(void *user, const char *stage, float done) {
  record *r = user;
  if (atomic_fetch_add(&r->inside, 1) != 0) r->overlapped = true;
  if (r->reports < sizeof r->shares / sizeof *r->shares) r->shares[r->reports] = done;
  r->reports++;
  snprintf(r->last_stage, sizeof r->last_stage, "%s", stage);
  if (r->sleep_ns) nanosleep(&(struct timespec){.tv_nsec = r->sleep_ns}, NULL);
  atomic_fetch_sub(&r->inside, 1);
  return r->cancel_at == 0 || r->reports < r->cancel_at;
}

static void work_a_little(void *user, uint32_t index) {
  (void)index;
  atomic_fetch_add((atomic_uint *)user, 1);
  nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL);
}

static void progress_grows_to_one_through_several_loops(void **state) {
  (void)state;
  record r = {0};
  const olx_progress progress = {.report = record_report, .user = &r};
  atomic_uint done = 0;
  olx_task task;
  olx_task_begin(&task, &progress, "first", 3 * 400 + 5 * 600);
  assert_int_equal(olx_parallel_for(400, 4, work_a_little, &done, &task, 3), OLX_OK);
  olx_task_stage(&task, "second");
  assert_int_equal(olx_parallel_for(600, 4, work_a_little, &done, &task, 5), OLX_OK);
  olx_task_end(&task);
  assert_int_equal(done, 1000);
  assert_true(r.reports >= 2);
  for (uint32_t i = 0; i < r.reports; i++) {
    assert_true(r.shares[i] > 0.0f && r.shares[i] <= 1.0f);
    if (i > 0) assert_true(r.shares[i] >= r.shares[i - 1]);
  }
  assert_true(r.shares[r.reports - 1] == 1.0f);
  assert_string_equal(r.last_stage, "second");
  assert_false(r.overlapped);
}

// A slow report must not suppress the last one, at 1.
static void the_end_is_reported_even_while_a_report_is_running(void **state) {
  (void)state;
  for (uint32_t round = 0; round < 10; round++) {
    record r = {.sleep_ns = 3000000};
    const olx_progress progress = {.report = record_report, .user = &r};
    atomic_uint done = 0;
    olx_task task;
    olx_task_begin(&task, &progress, "work", 8);
    assert_int_equal(olx_parallel_for(8, 4, work_a_little, &done, &task, 1), OLX_OK);
    olx_task_end(&task);
    assert_true(r.shares[r.reports - 1] == 1.0f);
    assert_false(r.overlapped);
  }
}

static void reports_come_some_ten_times_a_second(void **state) {
  (void)state;
  record r = {0};
  const olx_progress progress = {.report = record_report, .user = &r};
  atomic_uint done = 0;
  olx_task task;
  olx_task_begin(&task, &progress, "work", 2000);
  const double start = olx_seconds();
  assert_int_equal(olx_parallel_for(2000, 2, work_a_little, &done, &task, 1), OLX_OK);
  const double seconds = olx_seconds() - start;
  olx_task_end(&task);
  assert_true(r.reports <= 3 + (uint32_t)(seconds * 10.0));
}

static void cancelling_skips_the_rest(void **state) {
  (void)state;
  record r = {.cancel_at = 1};
  const olx_progress progress = {.report = record_report, .user = &r};
  atomic_uint done = 0;
  olx_task task;
  olx_task_begin(&task, &progress, "tracing", 5000);
  assert_int_equal(olx_parallel_for(5000, 2, work_a_little, &done, &task, 1), OLX_ERROR_CANCELLED);
  assert_non_null(strstr(olx_last_error(), "tracing"));
  assert_true(done < 5000);
  assert_int_equal(r.reports, 1);
  const uint32_t before = done;
  assert_int_equal(olx_parallel_for(5000, 2, work_a_little, &done, &task, 1), OLX_ERROR_CANCELLED);
  assert_int_equal(done, before);
  olx_task_end(&task);
}

static void cancelling_reaches_the_hosts_loop(void **state) {
  (void)state;
  host h = {0};
  olx_set_hooks(&(olx_hooks){.user = &h, .parallel_for = host_parallel_for});
  record r = {.cancel_at = 1};
  const olx_progress progress = {.report = record_report, .user = &r};
  atomic_uint visits[MOST_INDICES] = {0};
  olx_task task;
  olx_task_begin(&task, &progress, "work", MOST_INDICES);
  assert_int_equal(olx_parallel_for(MOST_INDICES, 0, count_visit, visits, &task, 1), OLX_ERROR_CANCELLED);
  olx_task_end(&task);
  assert_int_equal(visits[MOST_INDICES - 1], 1);
  assert_int_equal(visits[0], 0);
}

// ---- files

static void a_file_appears_only_when_committed(void **state) {
  const folder *f = *state;
  olx_output_file file;
  assert_int_equal(olx_output_open(f->file, &file), OLX_OK);
  assert_int_equal(olx_output_write(&file, "hello", 5), OLX_OK);
  assert_int_equal(olx_output_write_at(&file, 1, "u", 1), OLX_OK);
  assert_int_equal(access(f->file, F_OK), -1);
  assert_true(folder_entries(f) <= 1); // at most a temporary file; an unnamed one does not count
  assert_int_equal(olx_output_commit(&file), OLX_OK);
  assert_content(f->file, "hullo");
  assert_int_equal(folder_entries(f), 1);
  olx_output_discard(&file);
  assert_content(f->file, "hullo");
}

static void a_discarded_file_leaves_nothing(void **state) {
  const folder *f = *state;
  olx_output_file file;
  assert_int_equal(olx_output_open(f->file, &file), OLX_OK);
  assert_int_equal(olx_output_write(&file, "hello", 5), OLX_OK);
  olx_output_discard(&file);
  assert_int_equal(folder_entries(f), 0);
  olx_output_discard(&file);
}

static void committing_replaces_the_old_file(void **state) {
  const folder *f = *state;
  assert_int_equal(olx_write_file(f->file, "the old one, longer", 19), OLX_OK);
  assert_int_equal(olx_write_file(f->file, "new", 3), OLX_OK);
  assert_content(f->file, "new");
  assert_int_equal(folder_entries(f), 1);
}

static void two_writers_of_one_file_do_not_meet(void **state) {
  const folder *f = *state;
  olx_output_file a, b;
  assert_int_equal(olx_output_open(f->file, &a), OLX_OK);
  assert_int_equal(olx_output_open(f->file, &b), OLX_OK);
  assert_int_equal(olx_output_write(&a, "aaa", 3), OLX_OK);
  assert_int_equal(olx_output_write(&b, "b", 1), OLX_OK);
  assert_int_equal(olx_output_commit(&a), OLX_OK);
  assert_content(f->file, "aaa");
  assert_int_equal(olx_output_commit(&b), OLX_OK);
  assert_content(f->file, "b");
}

static void new_files_have_the_rights_the_user_wants(void **state) {
  const folder *f = *state;
  const mode_t masks[] = {022, 077, 002};
  const mode_t old = umask(0);
  for (size_t i = 0; i < sizeof masks / sizeof *masks; i++) {
    umask(masks[i]);
    unlink(f->file);
    assert_int_equal(olx_write_file(f->file, "x", 1), OLX_OK);
    assert_int_equal(umask(masks[i]), masks[i]);
    struct stat status;
    assert_int_equal(stat(f->file, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0666 & ~masks[i]);
  }
  umask(old);
}

static void places_that_cannot_be_written_are_named(void **state) {
  const folder *f = *state;
  char path[400];
  snprintf(path, sizeof path, "%s/missing/out.bin", f->path);
  const char *const paths[] = {path, "/proc/octalux-out.bin", ""};
  for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
    assert_int_equal(olx_write_file(paths[i], "x", 1), OLX_ERROR_FILE);
    assert_non_null(strstr(olx_last_error(), paths[i]));
  }
  assert_int_equal(folder_entries(f), 0);
}

static void a_directory_is_not_replaced(void **state) {
  const folder *f = *state;
  assert_int_equal(mkdir(f->file, 0777), 0);
  assert_int_equal(olx_write_file(f->file, "x", 1), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), f->file));
  assert_int_equal(folder_entries(f), 1);
}

// A limit on the size of files has the same effect as a full disk.
static void a_full_disk_leaves_the_old_file(void **state) {
  const folder *f = *state;
  assert_int_equal(olx_write_file(f->file, "old", 3), OLX_OK);
  struct rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &(struct rlimit){.rlim_cur = 4096, .rlim_max = before.rlim_max});
  char *data = calloc(1, 100000);
  const olx_result result = olx_write_file(f->file, data, 100000);
  free(data);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_DFL);
  assert_int_equal(result, OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), f->file));
  assert_content(f->file, "old");
  assert_int_equal(folder_entries(f), 1);
}

static void a_mapped_file_is_the_file(void **state) {
  const folder *f = *state;
  assert_int_equal(olx_write_file(f->file, "0123456789", 10), OLX_OK);
  olx_mapped_file file;
  assert_int_equal(olx_map_file(f->file, &file), OLX_OK);
  assert_int_equal(file.size_bytes, 10);
  assert_memory_equal(file.data, "0123456789", 10);
  assert_int_equal(olx_write_file(f->file, "replaced", 8), OLX_OK);
  assert_memory_equal(file.data, "0123456789", 10);
  olx_unmap_file(&file);
  assert_null(file.data);
  olx_unmap_file(&file);
}

static void what_is_no_file_is_not_mapped(void **state) {
  const folder *f = *state;
  olx_mapped_file file;
  assert_int_equal(olx_map_file(f->file, &file), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), f->file));
  assert_int_equal(olx_map_file(f->path, &file), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "not a regular file"));
  // Opening a pipe returns at once, without waiting for a writer.
  assert_int_equal(mkfifo(f->file, 0600), 0);
  alarm(10);
  assert_int_equal(olx_map_file(f->file, &file), OLX_ERROR_FILE);
  alarm(0);
  assert_null(file.data);
  assert_int_equal(file.size_bytes, 0);
}

static void an_empty_file_maps_to_nothing(void **state) {
  const folder *f = *state;
  assert_int_equal(olx_write_file(f->file, "", 0), OLX_OK);
  olx_mapped_file file;
  assert_int_equal(olx_map_file(f->file, &file), OLX_OK);
  assert_int_equal(file.size_bytes, 0);
  assert_non_null(file.data); // a pointer that readers of text may use as both begin and end
  olx_unmap_file(&file);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, folder_create, folder_remove)
#define WITH_HOOKS(test) cmocka_unit_test_teardown(test, hooks_restore)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_result_has_a_name_of_its_own),
      cmocka_unit_test(version_is_that_of_the_header),
      cmocka_unit_test(a_message_may_quote_the_one_before),
      cmocka_unit_test(a_message_too_long_is_cut),
      cmocka_unit_test(messages_are_kept_per_thread),
      cmocka_unit_test(memory_is_aligned_and_zeroed_when_asked),
      cmocka_unit_test(sizes_that_overflow_get_no_memory),
      IN_FOLDER(all_memory_comes_from_the_host),
      WITH_HOOKS(half_an_allocator_is_none),
      IN_FOLDER(running_out_of_memory_anywhere_is_answered),
      WITH_HOOKS(messages_reach_the_host_in_one_piece),
      IN_FOLDER(by_default_warnings_and_errors_go_to_standard_error),
      cmocka_unit_test(every_index_runs_once_on_any_number_of_threads),
      WITH_HOOKS(the_host_runs_the_loop_when_it_wants_to),
      cmocka_unit_test(progress_grows_to_one_through_several_loops),
      cmocka_unit_test(the_end_is_reported_even_while_a_report_is_running),
      cmocka_unit_test(reports_come_some_ten_times_a_second),
      cmocka_unit_test(cancelling_skips_the_rest),
      WITH_HOOKS(cancelling_reaches_the_hosts_loop),
      IN_FOLDER(a_file_appears_only_when_committed),
      IN_FOLDER(a_discarded_file_leaves_nothing),
      IN_FOLDER(committing_replaces_the_old_file),
      IN_FOLDER(two_writers_of_one_file_do_not_meet),
      IN_FOLDER(new_files_have_the_rights_the_user_wants),
      IN_FOLDER(places_that_cannot_be_written_are_named),
      IN_FOLDER(a_directory_is_not_replaced),
      IN_FOLDER(a_full_disk_leaves_the_old_file),
      IN_FOLDER(a_mapped_file_is_the_file),
      IN_FOLDER(what_is_no_file_is_not_mapped),
      IN_FOLDER(an_empty_file_maps_to_nothing),
  };
  return cmocka_run_group_tests_name("core", tests, NULL, NULL);
}
