// Bakes whose memory runs out at the first allocations, one after the other, and at sampled later ones: each reports
// it, leaves the old file, and holds nothing afterwards.
#include <octalux/bake.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { EACH_OF = 200, LATER_STEP = 211 };

static atomic_long asked, fails_at, held;

static void *allocate(void *user, size_t size_bytes) {
  (void)user;
  if (atomic_fetch_add(&asked, 1) + 1 == atomic_load(&fails_at)) return NULL;
  void *memory = aligned_alloc(64, (size_bytes + 63) & ~(size_t)63);
  if (memory) atomic_fetch_add(&held, 1);
  return memory;
}

static void release(void *user, void *memory) {
  (void)user;
  if (memory) atomic_fetch_sub(&held, 1);
  free(memory);
}

static void write_old(const char *path) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fputs("the old field", file);
  fclose(file);
}

static bool is_old(const char *path) {
  char text[64] = "";
  FILE *file = fopen(path, "rb");
  if (!file) return false;
  const size_t size = fread(text, 1, sizeof text, file);
  fclose(file);
  return size == strlen("the old field") && memcmp(text, "the old field", size) == 0;
}

static void reports_every_failing_allocation(void **state) {
  (void)state;
  const char *path = "full_allocations.olx";
  olx_scene *scene = NULL;
  olx_set_hooks(&(olx_hooks){.allocate = allocate, .release = release});
  assert_int_equal(olx_scene_load("builtin:cornell", &scene), OLX_OK);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid.count[0] = settings.grid.count[1] = settings.grid.count[2] = 1;
  settings.radiance_size = 8;
  settings.noise = 1.0f;
  settings.threads = 1;
  // What the scene keeps for later bakes is there after the first.
  assert_int_equal(olx_bake(scene, &settings, path, NULL, NULL), OLX_OK);
  const long before = atomic_load(&held);
  uint32_t failures = 0;
  for (long at = 1;; at += at < EACH_OF ? 1 : LATER_STEP) {
    write_old(path);
    atomic_store(&asked, 0);
    atomic_store(&fails_at, at);
    const olx_result result = olx_bake(scene, &settings, path, NULL, NULL);
    atomic_store(&fails_at, 0);
    if (atomic_load(&held) != before) fail_msg("allocation %ld: %ld blocks lost", at, atomic_load(&held) - before);
    if (result == OLX_OK && atomic_load(&asked) < at) break;
    if (result == OLX_OK) continue; // it went on without that memory
    failures++;
    if (result != OLX_ERROR_MEMORY) fail_msg("allocation %ld: %s", at, olx_last_error());
    assert_true(strlen(olx_last_error()) > 0 && is_old(path));
  }
  assert_true(failures > EACH_OF / 2);
  remove(path);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(reports_every_failing_allocation)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
