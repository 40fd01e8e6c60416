// Tests that rays without links and records can be stored and resumed: a work folder, and parts of a bake, give the
// light of a solution without a folder.
#include "core/hooks.h"
#include "light/scene_light.h"
#include "light/solution/light_solution.h"
#include "scene/scene_build.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { PROBES = 2, MOST_RUNS = 100, MOST_FINAL_UNITS = 64 };

typedef struct place {
  char folder[64];
  olx_scene *scene;
  olx_vec3 probes[PROBES];
  uint8_t flags[PROBES];
  olx_scene_light_settings settings;
} place;

static int set_up(void **state) {
  place *p = calloc(1, sizeof *p);
  snprintf(p->folder, sizeof p->folder, "/tmp/octalux-final-XXXXXX");
  if (!mkdtemp(p->folder) || olx_scene_load("builtin:cornell", &p->scene) != OLX_OK) return -1;
  const olx_vec3 middle = olx_scale(olx_add(p->scene->bounds_min, p->scene->bounds_max), 0.5f);
  p->probes[0] = olx_v3(middle.x, 0.8f * p->scene->bounds_max.y, middle.z);
  p->probes[1] = olx_v3(0.8f * p->scene->bounds_max.x, middle.y, middle.z);
  p->settings = olx_scene_light_settings_default();
  p->settings.map_size = 128;
  p->settings.noise = 0.006f;
  p->settings.most_links = 1 << 16;
  *state = p;
  return 0;
}

static int tear_down(void **state) {
  place *p = *state;
  olx_scene_free(p->scene);
  char command[80];
  snprintf(command, sizeof command, "rm -rf '%s'", p->folder);
  const int result = system(command);
  free(p);
  return result;
}

typedef struct units_done {
  uint32_t final_made, final_loaded, final_rounds, record_made, record_loaded, record_rounds;
} units_done;

static void count_unit(void *user, const olx_unit_done *unit) {
  units_done *done = user;
  if (strcmp(unit->name.stage, "final") == 0) {
    ++*(unit->found ? &done->final_loaded : &done->final_made);
    if (unit->name.round >= done->final_rounds) done->final_rounds = unit->name.round + 1;
  }
  if (strcmp(unit->name.stage, "record") != 0) return;
  ++*(unit->found ? &done->record_loaded : &done->record_made);
  if (unit->name.round >= done->record_rounds) done->record_rounds = unit->name.round + 1;
}

static olx_unit_store *open_store(const place *p, uint32_t part, uint32_t parts, units_done *done) {
  olx_manifest manifest = {""};
  olx_manifest_add(&manifest, "stages", "manifest light points cast surfels direct bounce final record lookup");
  const olx_unit_store_settings settings = {
      .folder = p->folder, .manifest = &manifest, .part = part, .parts = parts, .done = count_unit, .user = done};
  olx_unit_store *store;
  assert_int_equal(olx_unit_store_open(&settings, &store), OLX_OK);
  return store;
}

static olx_result solve(const place *p, olx_unit_store *store, olx_scene_light **light) {
  olx_scene_light_settings settings = p->settings;
  settings.store = store;
  return olx_scene_light_create(p->scene, &settings, p->probes, p->flags, PROBES, light);
}

static void assert_same_light(const olx_scene_light *a, const olx_scene_light *b) {
  const olx_scene_light_parts one = olx_scene_light_open(a), other = olx_scene_light_open(b);
  assert_int_equal(one.surfels->count, other.surfels->count);
  assert_memory_equal(one.irradiance, other.irradiance, one.surfels->count * sizeof *one.irradiance);
  const uint32_t records = olx_scene_light_describe(a).records;
  assert_int_equal(records, olx_scene_light_describe(b).records);
  assert_memory_equal(a->records.irradiance, b->records.irradiance, records * sizeof *a->records.irradiance);
  assert_int_equal(olx_scene_light_describe(a).rays, olx_scene_light_describe(b).rays);
}

static void remove_unit(const place *p, const char *name) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s.unit", p->folder, name);
  assert_int_equal(unlink(path), 0);
}

// Removes the steps after the first round of final rays began, of which each round has one, the lookups, one unit of
// that round, and one of records.
static void damage(const place *p, const units_done *done) {
  char path[128];
  for (uint32_t step = 20, left = done->final_rounds + done->record_rounds; step > 0 && left > 0; step--) {
    snprintf(path, sizeof path, "%s/light-%u-0.unit", p->folder, step);
    left -= unlink(path) == 0;
  }
  remove_unit(p, "lookup-0-0");
  remove_unit(p, "final-0-1");
  remove_unit(p, "record-0-0");
}

static void a_work_folder_resumes_between_final_rays_and_records(void **state) {
  place *p = *state;
  olx_scene_light *fresh, *light;
  assert_int_equal(solve(p, NULL, &fresh), OLX_OK);
  units_done first = {0}, second = {0};
  olx_unit_store *store = open_store(p, 0, 0, &first);
  assert_int_equal(solve(p, store, &light), OLX_OK);
  assert_same_light(fresh, light);
  olx_scene_light_free(light);
  olx_unit_store_close(store, false);
  assert_true(first.final_made > 2 && first.record_made > 0);
  damage(p, &first);
  store = open_store(p, 0, 0, &second);
  assert_int_equal(solve(p, store, &light), OLX_OK);
  assert_same_light(fresh, light);
  assert_int_equal(second.final_made, 1);
  assert_int_equal(second.final_loaded, first.final_made - 1);
  assert_int_equal(second.record_made, 1);
  assert_int_equal(second.record_loaded, first.record_made - 1);
  olx_scene_light_free(light);
  olx_scene_light_free(fresh);
  olx_unit_store_close(store, true);
}

static void parts_share_final_rays_and_records(void **state) {
  place *p = *state;
  enum { PARTS = 2 };
  olx_scene_light *fresh, *light = NULL;
  assert_int_equal(solve(p, NULL, &fresh), OLX_OK);
  units_done done[PARTS] = {{0}};
  for (uint32_t run = 0, finished = 0; finished < PARTS; run++) {
    assert_true(run < MOST_RUNS);
    olx_unit_store *store = open_store(p, run % PARTS + 1, PARTS, &done[run % PARTS]);
    const olx_result result = solve(p, store, &light);
    finished = result == OLX_OK ? finished + 1 : 0;
    if (result == OLX_OK) assert_same_light(fresh, light);
    else assert_int_equal(result, OLX_ERROR_INCOMPLETE);
    if (result == OLX_OK) olx_scene_light_free(light);
    olx_unit_store_close(store, false);
  }
  assert_true(done[0].final_made > 0 && done[1].final_made > 0);
  olx_scene_light_free(fresh);
  units_done none = {0};
  olx_unit_store_close(open_store(p, 0, 0, &none), true);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_work_folder_resumes_between_final_rays_and_records, set_up, tear_down),
      cmocka_unit_test_setup_teardown(parts_share_final_rays_and_records, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
