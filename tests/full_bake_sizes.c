// Tests that a bake reports its needs beforehand, the file to the byte and memory to a few per cent, and that a bake
// that does not fit is refused before it begins.
#include "block/geometry_encode.h"
#include "core/hooks.h"
#include "scene_files.h"

#include <octalux/bake.h>
#include <octalux/limits.h>
#include <octalux/place.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

// Memory hooks that record the largest amount held at a time.
enum { HEADER_BYTES = 64 };
static atomic_llong held, most_held;

static void *allocate_counted(void *user, size_t size_bytes) {
  (void)user;
  char *memory = aligned_alloc(64, HEADER_BYTES + (size_bytes + 63) / 64 * 64);
  if (!memory) return NULL;
  memcpy(memory, &size_bytes, sizeof size_bytes);
  const long long now = atomic_fetch_add(&held, (long long)size_bytes) + (long long)size_bytes;
  long long most = atomic_load(&most_held);
  while (now > most && !atomic_compare_exchange_weak(&most_held, &most, now)) continue;
  return memory + HEADER_BYTES;
}

static void release_counted(void *user, void *memory) {
  (void)user;
  size_t size_bytes;
  memcpy(&size_bytes, (char *)memory - HEADER_BYTES, sizeof size_bytes);
  atomic_fetch_sub(&held, (long long)size_bytes);
  free((char *)memory - HEADER_BYTES);
}

static olx_scene *load(const char *name) {
  olx_scene *scene = NULL;
  if (olx_scene_load(name, &scene) != OLX_OK) fail_msg("%s", olx_last_error());
  return scene;
}

static void assert_as_measured(const scene_folder *folder, const olx_bake_settings *settings, const olx_scene *scene) {
  char path[512];
  olx_bake_sizes sizes;
  olx_bake_stats stats;
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  if (olx_bake_measure(scene, settings, path, &sizes) != OLX_OK) fail_msg("%s", olx_last_error());
  const long long before = atomic_load(&held);
  atomic_store(&most_held, before);
  if (olx_bake(scene, settings, path, NULL, &stats) != OLX_OK) fail_msg("%s", olx_last_error());
  const double taken = (double)(atomic_load(&most_held) - before), said = (double)sizes.memory_bytes;
  // The number of emission tiles is known only when the probes have been traced; they take at most 4 bytes a texel.
  const uint64_t texels = (uint64_t)sizes.probes * settings->radiance_size * settings->radiance_size;
  assert_in_range(stats.file_bytes, sizes.file_bytes, sizes.file_bytes + 4 * texels + 64);
  // Tables that are not part of the estimate take a mebibyte or two, whatever the number of probes.
  if (!(taken <= 1.02 * said + 0x1p21 && taken >= 0.95 * said)) fail_msg("%.0f bytes taken, %.0f said", taken, said);
}

static void bakes_take_what_they_say(void **state) {
  olx_set_hooks(&(olx_hooks){.allocate = allocate_counted, .release = release_counted});
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings base = olx_bake_settings_default(scene);
  base.radiance_size = 64;
  base.irradiance_size = 32;
  base.samples = 1;
  base.bounces = 2;
  base.threads = 2;
  base.light = OLX_LIGHT_REFERENCE; // surfels and links are not estimated, since their number depends on the scene
  base.reference_paths = 1;
  assert_as_measured(*state, &base, scene);
  olx_bake_settings changed = base;
  changed.bounces = 0;
  changed.fit = false;
  assert_as_measured(*state, &changed, scene);
  changed = base;
  changed.irradiance_form = OLX_IRRADIANCE_SH3;
  changed.bounce_gather = OLX_GATHER_TRACED;
  assert_as_measured(*state, &changed, scene);
  changed = base;
  changed.classic = true;
  changed.classic_size = changed.classic_cube_size = 32;
  changed.bounces = 6;
  assert_as_measured(*state, &changed, scene);
  changed = base;
  changed.uncompressed = true;
  assert_as_measured(*state, &changed, scene);
  olx_scene_free(scene);
  olx_set_hooks(NULL);
}

// A bake that takes a fraction of a second.
static olx_bake_settings rough_settings(const olx_scene *scene, uint32_t radiance_size) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = radiance_size;
  settings.samples = 1;
  settings.noise = 1.0f;
  settings.bounces = 0;
  settings.threads = 2;
  return settings;
}

static void assert_within(uint64_t announced, uint64_t bytes, double share) {
  if (fabs((double)announced / (double)bytes - 1.0) > share)
    fail_msg("%llu bytes announced, %llu taken", (unsigned long long)announced, (unsigned long long)bytes);
}

static void assert_expected(const char *path, const olx_bake_settings *settings, const olx_scene *scene) {
  olx_bake_sizes sizes;
  olx_bake_stats stats;
  if (olx_bake_measure(scene, settings, path, &sizes) != OLX_OK) fail_msg("%s", olx_last_error());
  if (olx_bake(scene, settings, path, NULL, &stats) != OLX_OK) fail_msg("%s", olx_last_error());
  assert_within(sizes.expected_bytes, stats.file_bytes, 0.05);
}

// Without probe light the file has neither irradiance probes nor radiance, and the bake takes less memory and fewer
// rays.
static void probe_light_has_its_size(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = 64;
  olx_bake_sizes without, with;
  assert_int_equal(olx_bake_measure(scene, &settings, path, &without), OLX_OK);
  settings.probe_light = true;
  assert_int_equal(olx_bake_measure(scene, &settings, path, &with), OLX_OK);
  const uint64_t radiance = 4ull * 66 * 66 * with.probes, maps = 8ull * 130 * 130 * with.irradiance_probes;
  assert_int_equal(without.irradiance_probes, 0);
  assert_in_range(with.file_bytes - without.file_bytes, radiance + maps, radiance + maps + 4096);
  assert_int_equal(with.device_bytes - without.device_bytes, radiance + maps);
  assert_true(without.memory_bytes < with.memory_bytes && without.rays < with.rays);
  double seconds = -1.0;
  settings.probe_light = false;
  assert_int_equal(olx_bake_estimate_seconds(scene, &settings, NULL, &seconds), OLX_OK);
  assert_true(seconds > 0.0 && seconds < 600.0);
  olx_scene_free(scene);
}

// Light and material take 16 bytes for a tile of 64 texels and at most 56 for each of its four blocks, and geometry 16
// bytes for a block of 16 texels, in the file and on a device; as texels they take 18 bytes each, with a border and a
// level of the pyramid. What is announced as the least leaves blocks of tiles out.
static void blocks_have_their_size(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = 64;
  olx_bake_sizes blocks, texels;
  assert_int_equal(olx_bake_measure(scene, &settings, path, &blocks), OLX_OK);
  settings.uncompressed = true;
  assert_int_equal(olx_bake_measure(scene, &settings, path, &texels), OLX_OK);
  const uint64_t saved = blocks.probes * (18ull * 66 * 66 + 2 * 16 * 16 - 16ull * 16 * 16 - 16 * 8 * 8),
                 most = blocks.probes * 56ull * 16 * 16;
  // A margin, since chunks begin at multiples of 64.
  assert_in_range(texels.file_bytes - blocks.file_bytes, saved - 256, saved + 256);
  assert_in_range(texels.device_bytes - blocks.device_bytes, saved - most, saved - most / 16);
  // During a bake a probe's blocks are held beside its texels, and blocks of geometry with all the planes that each may
  // need, but with two bytes less of pyramid; and the words of tiles, with a table in which equal tiles are found.
  assert_int_equal(blocks.memory_bytes - texels.memory_bytes,
                   (56 + 16 + sizeof(olx_geometry_code) - 2) * 16 * 16 + 24 * 8 * 8);
  olx_scene_free(scene);
}

// `place` announces the size that `bake` announces for the same probes, and a field within a twentieth of it is
// written.
static void place_and_bake_announce_the_size_of_the_file(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  olx_scene *scene = load("builtin:pillars");
  olx_place_settings placing = olx_place_settings_default(scene);
  placing.count = 20;
  placing.voxels = 32;
  placing.surfels = 500;
  placing.candidates = 64;
  placing.resolution = 64;
  placing.field_size = true;
  olx_probe_set set;
  if (olx_place(scene, &placing, NULL, &set) != OLX_OK) fail_msg("%s", olx_last_error());
  olx_vec3 probes[20];
  for (uint32_t i = 0; i < set.count; i++) probes[i] = set.probes[i].position;
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = 64;
  settings.noise = 0.1f;
  settings.threads = 2;
  settings.probes = probes;
  settings.probe_count = set.count;
  olx_bake_sizes sizes;
  assert_int_equal(olx_bake_measure(scene, &settings, path, &sizes), OLX_OK);
  assert_within(set.report.field_bytes, sizes.expected_bytes, 0.001);
  assert_expected(path, &settings, scene);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// In rooms the announced size is within a twentieth of the file's, whatever share of the maps sees lamps and how much
// detail there is.
static void announced_sizes_are_those_of_files(void **state) {
  static const struct {
    const char *name;
    bool uncompressed;
  } rooms[] = {{"builtin:parlour", false}, {"builtin:labyrinth", false}, {"builtin:cornell", true}};
  const scene_folder *folder = *state;
  char path[512];
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++) {
    olx_scene *scene = load(rooms[i].name);
    olx_bake_settings settings = rough_settings(scene, 64);
    settings.uncompressed = rooms[i].uncompressed;
    assert_expected(path, &settings, scene);
    olx_scene_free(scene);
  }
}

// An even sky is one tile for all the texels that see it: it takes no bytes in proportion to them. Maps are larger than
// above, since beside the few bytes of this scene's maps the uncertainty of its volume, a third, is more than a
// twentieth.
static void an_even_sky_takes_no_tiles(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  olx_scene *scene = load("builtin:furnace");
  const olx_bake_settings settings = rough_settings(scene, 128);
  assert_expected(path, &settings, scene);
  olx_scene_free(scene);
}

static uint64_t expected_with(const olx_scene *scene, olx_bake_settings settings, uint32_t radiance_size) {
  olx_bake_sizes sizes;
  settings.radiance_size = radiance_size;
  assert_int_equal(olx_bake_measure(scene, &settings, "", &sizes), OLX_OK);
  return sizes.expected_bytes;
}

// A budget of exactly the announced bytes of a size of maps gives this size, and one of a byte less gives the next
// smaller one.
static void a_budget_gives_the_largest_maps_that_fit(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  const olx_bake_settings settings = olx_bake_settings_default(scene);
  uint32_t chosen = 0;
  for (uint32_t size = OLX_RADIANCE_SIZE_MOST; size > OLX_RADIANCE_SIZE_LEAST; size /= 2) {
    const uint64_t bytes = expected_with(scene, settings, size);
    assert_int_equal(olx_bake_size_for_budget(scene, &settings, ((double)bytes + 0.5) * 1e-6, &chosen), OLX_OK);
    assert_int_equal(chosen, size);
    assert_int_equal(olx_bake_size_for_budget(scene, &settings, ((double)bytes - 0.5) * 1e-6, &chosen), OLX_OK);
    assert_int_equal(chosen, size / 2);
  }
  assert_int_equal(olx_bake_size_for_budget(scene, &settings, 1e9, &chosen), OLX_OK);
  assert_int_equal(chosen, OLX_RADIANCE_SIZE_MOST);
  olx_scene_free(scene);
}

// The message that refuses a budget names megabytes that suffice, rounded up to a thousandth.
static void a_budget_that_holds_no_maps_is_refused_with_one_that_does(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = olx_bake_settings_default(scene);
  uint32_t chosen = 0;
  settings.probe_light = true;
  const double least = (double)expected_with(scene, settings, OLX_RADIANCE_SIZE_LEAST) * 1e-6;
  assert_int_equal(olx_bake_size_for_budget(scene, &settings, 0.001, &chosen), OLX_ERROR_ARGUMENT);
  const char *named = strstr(olx_last_error(), "it takes ");
  assert_non_null(named);
  const double megabytes = atof(named + strlen("it takes "));
  assert_true(megabytes >= least && megabytes < least + 0.0011);
  assert_int_equal(olx_bake_size_for_budget(scene, &settings, megabytes, &chosen), OLX_OK);
  assert_int_equal(chosen, OLX_RADIANCE_SIZE_LEAST);
  const double senseless[] = {0.0, -1.0, (double)NAN, (double)INFINITY};
  for (size_t i = 0; i < sizeof senseless / sizeof *senseless; i++) {
    assert_int_equal(olx_bake_size_for_budget(scene, &settings, senseless[i], &chosen), OLX_ERROR_ARGUMENT);
    assert_non_null(strstr(olx_last_error(), "must be a number of megabytes"));
  }
  settings.samples = 99;
  assert_int_equal(olx_bake_size_for_budget(scene, &settings, 1.0, &chosen), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "samples"));
  olx_scene_free(scene);
}

static double now_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void what_does_not_fit_is_refused_at_once(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  olx_bake_sizes sizes;
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.probe_light = true;
  const uint32_t count[3] = {100, 100, 100};
  assert_int_equal(olx_scene_probe_grid(scene, count, &settings.grid), OLX_OK);
  settings.irradiance_grid = olx_bake_irradiance_grid(&settings.grid);
  const double start = now_seconds();
  assert_int_equal(olx_bake(scene, &settings, path, NULL, NULL), OLX_ERROR_FILE);
  assert_true(now_seconds() - start < 0.5); // the refusal comes before any work
  assert_non_null(strstr(olx_last_error(), "a.olx: 1000000 light field and 1000000 irradiance probes make a file of "));
  assert_non_null(strstr(olx_last_error(), " are free there"));
  assert_int_not_equal(access(path, F_OK), 0);
  assert_int_equal(olx_bake_measure(scene, &settings, path, &sizes), OLX_ERROR_FILE);
  assert_int_equal(sizes.probes, 1000000);
  assert_true(sizes.file_bytes > 5ull * 514 * 514 * 1000000);
  // Irradiance probes alone make a small file whose bake needs more memory than a machine has.
  settings.radiance_size = settings.irradiance_size = 8;
  settings.irradiance_form = OLX_IRRADIANCE_SH2;
  settings.bounce_gather = OLX_GATHER_IRRADIANCE; // this way of gathering keeps rays of every fitted point
  const olx_result result = olx_bake_measure(scene, &settings, path, &sizes);
  assert_true(sizes.memory_bytes > 500000000000);
  if (sizes.available_memory_bytes < sizes.memory_bytes && sizes.available_disk_bytes > sizes.file_bytes) {
    assert_int_equal(result, OLX_ERROR_MEMORY);
    assert_non_null(strstr(olx_last_error(), "baking 1000000 light field and 1000000 irradiance probes takes "));
  }
  settings.grid.count[0] = 0;
  assert_int_equal(olx_bake_measure(scene, &settings, path, &sizes), OLX_ERROR_ARGUMENT);
  assert_int_equal(sizes.probes, 0);
  olx_scene_free(scene);
}

// A field whose least size fits the disk, while what it takes with its tiles does not, is refused before the bake.
static void what_the_expected_file_takes_is_checked(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  olx_bake_sizes one, many;
  snprintf(path, sizeof path, "%s/a.olx", folder->path);
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = olx_bake_settings_default(scene);
  assert_int_equal(olx_scene_probe_grid(scene, (const uint32_t[3]){1, 1, 1}, &settings.grid), OLX_OK);
  assert_int_equal(olx_bake_measure(scene, &settings, path, &one), OLX_OK);
  const double least = (double)one.file_bytes, along = cbrt((double)one.available_disk_bytes / (1.1 * least));
  if (along >= 20.0) {
    const uint32_t side = (uint32_t)along;
    assert_int_equal(olx_scene_probe_grid(scene, (const uint32_t[3]){side, side, side}, &settings.grid), OLX_OK);
    assert_int_equal(olx_bake_measure(scene, &settings, path, &many), OLX_ERROR_FILE);
    assert_true(many.file_bytes < many.available_disk_bytes);
    assert_int_equal(olx_bake(scene, &settings, path, NULL, NULL), OLX_ERROR_FILE);
    assert_non_null(strstr(olx_last_error(), " are free there"));
    assert_int_not_equal(access(path, F_OK), 0);
  }
  olx_scene_free(scene);
}

// The estimate grows in proportion to the number of probes, since it multiplies measured times: two estimates differ
// from this proportion by noise alone.
static void an_estimate_is_a_time(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.probe_light = true;
  settings.radiance_size = 64;
  settings.irradiance_size = 16;
  double seconds = -1.0;
  assert_int_equal(olx_bake_estimate_seconds(scene, &settings, NULL, &seconds), OLX_OK);
  assert_true(seconds > 0.0 && seconds < 600.0);
  const uint32_t count[3] = {100, 100, 100};
  double many;
  assert_int_equal(olx_scene_probe_grid(scene, count, &settings.grid), OLX_OK);
  settings.irradiance_grid = settings.grid;
  assert_int_equal(olx_bake_estimate_seconds(scene, &settings, NULL, &many), OLX_OK);
  assert_true(many > 1000.0 * seconds); // at least 37,000 times as many probes of each kind
  settings.samples = 99;
  assert_int_equal(olx_bake_estimate_seconds(scene, &settings, NULL, &many), OLX_ERROR_ARGUMENT);
  olx_scene_free(scene);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_set_up, scene_folder_tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      IN_FOLDER(bakes_take_what_they_say),
      IN_FOLDER(probe_light_has_its_size),
      IN_FOLDER(place_and_bake_announce_the_size_of_the_file),
      IN_FOLDER(announced_sizes_are_those_of_files),
      IN_FOLDER(an_even_sky_takes_no_tiles),
      cmocka_unit_test(a_budget_gives_the_largest_maps_that_fit),
      cmocka_unit_test(a_budget_that_holds_no_maps_is_refused_with_one_that_does),
      IN_FOLDER(blocks_have_their_size),
      IN_FOLDER(what_does_not_fit_is_refused_at_once),
      IN_FOLDER(what_the_expected_file_takes_is_checked),
      cmocka_unit_test(an_estimate_is_a_time),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
