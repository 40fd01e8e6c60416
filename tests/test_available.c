// Tests what is taken for available memory in a control group, by files like those of Linux.
#include "bake/cost/available.h"

#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

static void put(const char *folder, const char *name, const char *text) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
}

static void files_in_memory_are_available(void **state) {
  (void)state;
  char folder[] = "/tmp/octalux-group-XXXXXX";
  assert_non_null(mkdtemp(folder));
  assert_true(olx_available_to_group(folder) == UINT64_MAX); // no group is known
  put(folder, "memory.max", "8000\n");
  put(folder, "memory.current", "7900\n");
  assert_int_equal(olx_available_to_group(folder), 100);
  put(folder, "memory.stat", "anon 400\nfile 7500\ninactive_file 5000\nactive_file 2000\n");
  assert_int_equal(olx_available_to_group(folder), 7100);
  put(folder, "memory.current", "9000\n"); // beyond the limit, for a moment
  put(folder, "memory.stat", "anon 9000\n");
  assert_int_equal(olx_available_to_group(folder), 0);
  put(folder, "memory.max", "max\n");
  assert_true(olx_available_to_group(folder) == UINT64_MAX);
  for (const char *const *name = (const char *const[]){"memory.max", "memory.current", "memory.stat", NULL}; *name;
       name++) {
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, *name);
    assert_int_equal(unlink(path), 0);
  }
  assert_int_equal(rmdir(folder), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(files_in_memory_are_available)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
