// Tests that all long work ends with OLX_ERROR_CANCELLED soon after its progress callback returned false, and leaves
// nothing behind.
#include "core/parallel.h"
#include "place_fixtures.h"

#include <octalux/bake.h>

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

// A progress callback's state, which cancels at report number `at`.
typedef struct canceller {
  uint32_t at, reports;
  float done;
  bool went_back;
  char stage[64];
} canceller;

static bool count_reports(void *user, const char *stage, float done) {
  canceller *c = user;
  c->went_back |= done < c->done;
  c->done = done;
  snprintf(c->stage, sizeof c->stage, "%s", stage);
  return ++c->reports != c->at;
}

// Each run is cancelled at a later report, until placement ends before that report.
static void placement_is_one_task_that_can_be_cancelled_anywhere(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:pillars");
  for (int method = OLX_PLACE_GRID; method <= OLX_PLACE_COVER; method++) {
    olx_place_settings settings = quicker_settings(scene, (olx_place_method)method);
    settings.optimize = method == OLX_PLACE_COVER ? OLX_OPTIMIZE_NONE : OLX_OPTIMIZE_GRADIENT;
    olx_result result = OLX_ERROR_CANCELLED;
    for (uint32_t at = 1; result != OLX_OK; at += at) {
      canceller c = {.at = at};
      const olx_progress progress = {.report = count_reports, .user = &c};
      olx_probe_set set;
      result = olx_place(scene, &settings, &progress, &set);
      if (result != OLX_OK && result != OLX_ERROR_CANCELLED) {
        fail_msg("report %u, %s: %s", at, c.stage, olx_last_error());
      }
      assert_int_equal(result == OLX_ERROR_CANCELLED, c.reports >= at);
      assert_false(c.went_back);
      if (result == OLX_OK) assert_string_equal(c.stage, "measuring coverage");
      olx_probe_set_free(&set);
    }
  }
  olx_scene_free(scene);
}

typedef struct loading {
  const char *name;
  olx_scene *scene;
} loading;

static olx_result load_watched(void *user) {
  loading *l = user;
  return olx_scene_load(l->name, &l->scene);
}

// Loading a built-in scene reads no file: Embree's build takes the time and notices the cancellation.
static void loading_can_be_cancelled_while_embree_builds(void **state) {
  (void)state;
  canceller c = {.at = 1};
  const olx_progress progress = {.report = count_reports, .user = &c};
  loading l = {.name = "builtin:temple"};
  assert_int_equal(olx_watch(&progress, "loading", load_watched, &l), OLX_ERROR_CANCELLED);
  assert_null(l.scene);
  assert_string_equal(c.stage, "loading");
  assert_non_null(strstr(olx_last_error(), "builtin:temple: ray caster: cancelled while Embree built it"));
  c = (canceller){.at = 0};
  assert_int_equal(olx_watch(&progress, "loading", load_watched, &l), OLX_OK);
  assert_true(c.reports > 0);
  olx_scene_free(l.scene);
}

typedef struct cooking {
  const olx_scene *scene;
  char path[128];
} cooking;

static olx_result cook_watched(void *user) {
  const cooking *c = user;
  return olx_scene_cook(c->scene, c->path, NULL);
}

static void cooking_can_be_cancelled(void **state) {
  (void)state;
  char folder[] = "/tmp/octalux-cancel-XXXXXX";
  assert_non_null(mkdtemp(folder));
  cooking cook = {.scene = load("builtin:cornell")};
  snprintf(cook.path, sizeof cook.path, "%s/a.olxs", folder);
  canceller c = {.at = 1};
  const olx_progress progress = {.report = count_reports, .user = &c};
  assert_int_equal(olx_watch(&progress, "cooking", cook_watched, &cook), OLX_ERROR_CANCELLED);
  assert_int_equal(rmdir(folder), 0); // succeeds only when the folder is empty
  olx_scene_free((olx_scene *)(uintptr_t)cook.scene);
}

static void visit(void *user, uint32_t index) {
  (void)index;
  atomic_fetch_add((atomic_uint *)user, 1);
}

// Loops without a task of their own watch the task of their thread, and a nested task ends with the outer one.
static void loops_watch_the_tasks_of_their_thread(void **state) {
  (void)state;
  canceller c = {.at = 1};
  const olx_progress progress = {.report = count_reports, .user = &c};
  atomic_uint visits = 0;
  olx_task outer, inner;
  assert_int_equal(olx_check_cancelled(), OLX_OK);
  olx_task_begin(&outer, &progress, "outer", 1);
  olx_task_begin(&inner, NULL, "inner", 1);
  assert_ptr_equal(olx_task_current(), &inner);
  assert_int_equal(olx_check_cancelled(), OLX_ERROR_CANCELLED);
  olx_task_end(&inner);
  assert_int_equal(olx_parallel_for(100, 2, visit, &visits, NULL, 0), OLX_ERROR_CANCELLED);
  assert_int_equal(visits, 0);
  olx_task_end(&outer);
  assert_null(olx_task_current());
  assert_int_equal(olx_parallel_for(100, 2, visit, &visits, NULL, 0), OLX_OK);
  assert_int_equal(visits, 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(placement_is_one_task_that_can_be_cancelled_anywhere),
      cmocka_unit_test(loading_can_be_cancelled_while_embree_builds),
      cmocka_unit_test(cooking_can_be_cancelled),
      cmocka_unit_test(loops_watch_the_tasks_of_their_thread),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
