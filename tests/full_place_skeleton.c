// Tests skeletons of spaces whose medial axis is known, and the guarantees of the optimizer.
#include "core/sampling.h"
#include "made_scenes.h"
#include "place/optimize.h"
#include "place/skeleton/skeleton.h"
#include "place/space/space_find.h"
#include "place_fixtures.h"
#include "scene/builtin/builtin_shapes.h"
#include "scene/bvh.h"
#include "tiny_scenes.h"

#include <octalux/place.h>

#include <unistd.h>

static olx_scene *cube(void) {
  olx_scene *scene = made_scene();
  made_room(scene, olx_v3(0, 0, 0), 2.0f, matte(scene));
  return made_finish(scene);
}

// The centre is the only point of a cube's skeleton that is not on a ridge to a corner.
static void a_cube_has_its_probe_in_the_centre(void **state) {
  (void)state;
  olx_scene *scene = cube();
  for (uint32_t voxels = 30; voxels < 34; voxels++) {
    olx_place_settings settings = quick_settings(scene, OLX_PLACE_SDF);
    settings.voxels = voxels;
    olx_probe_set set = place(scene, &settings);
    assert_int_equal(set.count, 1);
    assert_true(olx_length(set.probes[0].position) < 3.0f / (float)voxels);
    assert_int_equal(set.probes[0].origin, OLX_ORIGIN_SKELETON);
    olx_probe_set_free(&set);
  }
  olx_scene_free(scene);
}

static void far_voxels_are_far_from_surfaces(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:pillars");
  olx_space space;
  ASSERT_OK(olx_space_create(scene, 40, 1, &space));
  olx_cluster_item *items;
  uint32_t count;
  ASSERT_OK(olx_far_voxels(&space, &items, &count));
  assert_true(count > 10 && count < space.place_count / 3);
  for (uint32_t i = 0; i < count; i++) {
    assert_true(olx_space_allows(&space, items[i].place));
    // A place is at least two voxels, centre to centre, from a solid voxel, which the surface may touch anywhere.
    const float reach = (2.0f - 0.5f * sqrtf(3.0f) - 0.01f) * space.voxels.size;
    assert_true(olx_bvh_distance(scene->bvh, items[i].place, 1.0f) >= olx_min(reach, 1.0f));
  }
  olx_release(items);
  olx_space_free(&space);
  olx_scene_free(scene);
}

// Each medial ball contains no surface and touches two points of surfaces, apart from each other.
static void medial_balls_touch_two_surfaces(void **state) {
  (void)state;
  const char *const names[] = {"builtin:cornell", "builtin:pillars"};
  for (int k = 0; k < 2; k++) {
    olx_scene *scene = load(names[k]);
    olx_space space;
    olx_surfels surfels;
    olx_medial_ball *balls;
    uint32_t count;
    ASSERT_OK(olx_space_create(scene, 40, 1, &space));
    const olx_sight sight =
        olx_sight_create(olx_length(olx_sub(scene->bounds_max, scene->bounds_min)), 0.02f, 0.05f, 512);
    ASSERT_OK(olx_surfels_create(&space, &sight, OLX_SPREAD_AREA, 2000, 3, 1, &surfels));
    ASSERT_OK(olx_medial_balls(&space, &surfels, 1, &balls, &count));
    assert_true(count > surfels.count / 4);
    for (uint32_t i = 0; i < count; i++) {
      const olx_medial_ball *b = &balls[i];
      const olx_vec3 first = olx_madd(b->centre, b->normal, -b->radius);
      const float slack = 1e-3f + 1e-3f * b->radius;
      assert_true(olx_bvh_distance(scene->bvh, first, 1.0f) < slack);
      assert_true(olx_bvh_distance(scene->bvh, b->other, 1.0f) < slack);
      assert_true(fabsf(olx_length(olx_sub(b->other, b->centre)) - b->radius) < slack);
      assert_true(olx_bvh_distance(scene->bvh, b->centre, b->radius) >= 0.97f * b->radius);
      assert_true(olx_length(olx_sub(b->other, first)) > 0.99f * b->radius); // at least 60 degrees apart
    }
    olx_release(balls);
    olx_surfels_free(&surfels);
    olx_space_free(&space);
    olx_scene_free(scene);
  }
}

// Between two large parallel walls the medial axis is the plane in the middle.
static void a_slab_has_its_axis_in_the_middle(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const uint32_t m = matte(scene), materials[6] = {m, m, m, m, m, m};
  ASSERT_OK(olx_add_room(scene, "room", olx_v3(-4, 0, -4), olx_v3(4, 1, 4), materials));
  made_finish(scene);
  for (int method = OLX_PLACE_SDF; method <= OLX_PLACE_MEDIAL; method++) {
    olx_place_settings settings = quick_settings(scene, (olx_place_method)method);
    settings.count = 9;
    settings.voxels = 80;
    olx_probe_set set = place(scene, &settings);
    assert_int_equal(set.count, 9);
    for (uint32_t i = 0; i < set.count; i++) assert_true(fabsf(set.probes[i].position.y - 0.5f) < 0.16f);
    olx_probe_set_free(&set);
  }
  olx_scene_free(scene);
}

static void the_count_sets_the_granularity(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:temple");
  for (int method = OLX_PLACE_SDF; method <= OLX_PLACE_MEDIAL; method++) {
    olx_place_settings settings = quick_settings(scene, (olx_place_method)method);
    settings.voxels = 64;
    double before = 0.0;
    for (settings.count = 1; settings.count <= 16; settings.count *= 4) {
      olx_probe_set set = place(scene, &settings);
      assert_int_equal(set.count, settings.count);
      assert_true(set.report.coverage > before);
      before = set.report.coverage;
      olx_probe_set_free(&set);
    }
  }
  olx_scene_free(scene);
}

// The distribution function is F(x) = (R0 x + (R1 - R0) x^2 / 2) / ((R0 + R1) / 2).
static void the_linear_sampler_has_its_distribution(void **state) {
  (void)state;
  enum { DRAWS = 20000, BINS = 50 };
  const float ends[6][2] = {{0, 1}, {1, 0}, {1, 1}, {0.2f, 0.9f}, {3, 1e-6f}, {0, 0}};
  for (int k = 0; k < 6; k++) {
    const double r0 = (double)ends[k][0], r1 = (double)ends[k][1];
    uint32_t below[BINS] = {0};
    for (uint32_t i = 0; i < DRAWS; i++) {
      const float x = olx_sample_linear(ends[k][0], ends[k][1], ((float)i + 0.5f) / DRAWS);
      assert_true(x >= 0.0f && x <= 1.0f);
      for (uint32_t b = 0; b < BINS; b++) below[b] += (double)x < (b + 1.0) / BINS;
    }
    for (uint32_t b = 0; b < BINS; b++) {
      const double x = (b + 1.0) / BINS, sum = 0.5 * (r0 + r1);
      const double cdf = sum > 0.0 ? (r0 * x + 0.5 * (r1 - r0) * x * x) / sum : x;
      assert_true(fabs((double)below[b] / DRAWS - cdf) < 2e-4);
    }
  }
}

static void expect_mean(const double mean[3], double x, double y, double z) {
  assert_true(fabs(mean[0] - x) < 0.008);
  assert_true(fabs(mean[1] - y) < 0.008);
  assert_true(fabs(mean[2] - z) < 0.008);
}

// Compares means of the draws with their closed form; half a side is 0.5. A line from 0 to 1 has its mean at 2/3.
static void support_samples_follow_the_fitness(void **state) {
  (void)state;
  enum { DRAWS = 16000 };
  double one[8] = {0}, along_z[8], mean_one[3] = {0}, mean_z[3] = {0};
  one[5] = 1.0; // the corner at +x, -y, +z
  for (uint32_t i = 0; i < 8; i++) along_z[i] = i & 4 ? 1.0 : 0.0;
  for (uint32_t i = 0; i < DRAWS; i++) {
    float random[7];
    for (uint32_t d = 0; d < 7; d++) random[d] = olx_unit_float(olx_hash2(i, d));
    const olx_vec3 a = olx_sample_support(olx_v3(1, 2, 3), 0.5f, one, random);
    const olx_vec3 b = olx_sample_support(olx_v3(1, 2, 3), 0.5f, along_z, random);
    const double a3[3] = {(double)a.x, (double)a.y, (double)a.z}, b3[3] = {(double)b.x, (double)b.y, (double)b.z};
    for (int d = 0; d < 3; d++) {
      assert_true(fabs(a3[d] - (d + 1)) <= 0.5 + 1e-6);
      mean_one[d] += (a3[d] - (d + 1)) / DRAWS;
      mean_z[d] += (b3[d] - (d + 1)) / DRAWS;
    }
  }
  // With one good corner, z leans by 1/6; y by as much on one of the two edges that z mixes, which counts 2/3; x on one
  // of four.
  expect_mean(mean_one, 2.0 / 27.0, -1.0 / 9.0, 1.0 / 6.0);
  // With fitness along z alone, x and y are uniform.
  expect_mean(mean_z, 0.0, 0.0, 1.0 / 6.0);
}

static void fitness_is_cosine_and_distance(void **state) {
  (void)state;
  const olx_surfel surfel = {.position = {0, 0, 0}, .normal = {0, 1, 0}};
  assert_close((double)olx_fitness(&surfel, olx_v3(0, 2, 0), 10.0f), 0.5 * (1.0 + 0.2), 1e-6, "above");
  assert_close((double)olx_fitness(&surfel, olx_v3(3, 4, 0), 10.0f), 0.5 * (0.8 + 0.5), 1e-6, "aslant");
  assert_true(olx_fitness(&surfel, olx_v3(0, -1, 0), 10.0f) == 0.0f);
}

typedef struct arena {
  olx_scene *scene;
  olx_space space;
  olx_surfels surfels;
} arena;

static arena start_arena(olx_scene *scene) {
  arena a = {.scene = scene};
  ASSERT_OK(olx_space_create(scene, 36, 1, &a.space));
  const olx_sight sight =
      olx_sight_create(olx_length(olx_sub(scene->bounds_max, scene->bounds_min)), 0.02f, 0.05f, 512);
  ASSERT_OK(olx_surfels_create(&a.space, &sight, OLX_SPREAD_RAYS, 1000, 11, 1, &a.surfels));
  ASSERT_OK(olx_surfels_ask(&a.space, &sight, NULL, 0, 11, 1, &a.surfels));
  return a;
}

static void end_arena(arena *a) {
  olx_surfels_free(&a->surfels);
  olx_space_free(&a->space);
  olx_scene_free(a->scene);
}

static double reward_of(const arena *a, const olx_candidate *probes, uint32_t count, olx_place_reward kind) {
  olx_vec3 places[8];
  double reward = 0.0;
  for (uint32_t i = 0; i < count; i++) places[i] = probes[i].place;
  ASSERT_OK(olx_reward(&a->space, &a->surfels, places, count, kind, 1, &reward));
  return reward;
}

// Either optimizer moves two probes out of one corner, and reports the reward that the probes have.
static void a_bad_start_gets_better(void **state) {
  (void)state;
  arena a = start_arena(made_finish(start_divided_room()));
  for (int kind = OLX_REWARD_BEST; kind <= OLX_REWARD_SUM; kind++) {
    for (int how = OLX_OPTIMIZE_GRADIENT; how <= OLX_OPTIMIZE_GIBBS; how++) {
      olx_place_settings settings = quick_settings(a.scene, OLX_PLACE_SDF);
      settings.optimize = (olx_place_optimizer)how;
      settings.reward = (olx_place_reward)kind;
      settings.rounds = 120;
      olx_candidate probes[2] = {{{-1.8f, 0.2f, -1.8f}, OLX_ORIGIN_SPACE}, {{-1.7f, 0.3f, -1.7f}, OLX_ORIGIN_SPACE}};
      const double before = reward_of(&a, probes, 2, settings.reward);
      olx_optimization outcome;
      ASSERT_OK(olx_optimize(&a.space, &a.surfels, &settings, NULL, probes, 2, &outcome));
      assert_close(outcome.reward_before, before, 1e-9, "reward before");
      assert_close(outcome.reward_after, reward_of(&a, probes, 2, settings.reward), 1e-9, "reward after");
      assert_true(outcome.reward_after > 1.1 * before);
      assert_true(outcome.rounds >= 1 && outcome.rounds <= 120);
      for (int i = 0; i < 2; i++) assert_true(olx_space_allows(&a.space, probes[i].place));
    }
  }
  end_arena(&a);
}

static void the_reward_never_ends_lower(void **state) {
  (void)state;
  arena a = start_arena(load("builtin:pillars"));
  for (uint32_t seed = 0; seed < 12; seed++) {
    olx_place_settings settings = quick_settings(a.scene, OLX_PLACE_SDF);
    settings.optimize = seed % 2 ? OLX_OPTIMIZE_GIBBS : OLX_OPTIMIZE_GRADIENT;
    settings.reward = seed % 3 ? OLX_REWARD_BEST : OLX_REWARD_SUM;
    settings.rounds = 1 + seed % 4;
    settings.seed = seed;
    olx_candidate probes[3];
    for (uint32_t i = 0; i < 3; i++) {
      const size_t at = olx_hash2(seed, i) % a.space.place_count;
      probes[i] = (olx_candidate){olx_voxel_centre(&a.space.voxels, a.space.places[at]),
                                  i ? OLX_ORIGIN_SPACE : OLX_ORIGIN_PINNED};
    }
    const olx_vec3 pinned = probes[0].place;
    const double before = reward_of(&a, probes, 3, settings.reward);
    olx_optimization outcome;
    ASSERT_OK(olx_optimize(&a.space, &a.surfels, &settings, NULL, probes, 3, &outcome));
    assert_true(reward_of(&a, probes, 3, settings.reward) >= before);
    assert_memory_equal(&probes[0].place, &pinned, sizeof pinned);
  }
  end_arena(&a);
}

// A probe that sees everything needs no optimizer.
static void full_coverage_stops_the_search(void **state) {
  (void)state;
  olx_scene *scene = cube();
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_SDF);
  settings.optimize = OLX_OPTIMIZE_GIBBS;
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.report.rounds, 0);
  assert_true(set.report.reward_after == set.report.reward_before && set.report.reward_before > 0.3);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

static void overrides_hold_while_probes_move(void **state) {
  (void)state;
  for (int method = OLX_PLACE_SDF; method <= OLX_PLACE_MEDIAL; method++) {
    for (int how = OLX_OPTIMIZE_NONE; how <= OLX_OPTIMIZE_GIBBS; how++) {
      olx_scene *scene = load_ruled_room();
      olx_place_settings settings = quicker_settings(scene, (olx_place_method)method);
      settings.optimize = (olx_place_optimizer)how;
      settings.count = 5;
      olx_probe_set set = place(scene, &settings);
      assert_int_equal(set.count, 5);
      expect_rules_kept(scene, &set);
      settings.count = 2;
      olx_probe_set alone = place(scene, &settings);
      assert_int_equal(alone.count, 2);
      expect_rules_kept(scene, &alone);
      olx_probe_set_free(&alone);
      olx_probe_set_free(&set);
      olx_scene_free(scene);
    }
  }
}

static void no_probe_is_inside_geometry(void **state) {
  (void)state;
  const char *const names[] = {"builtin:pillars", "builtin:cornell", "builtin:temple"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    olx_scene *scene = load(names[k]);
    for (int method = OLX_PLACE_SDF; method <= OLX_PLACE_MEDIAL; method++) {
      for (int how = OLX_OPTIMIZE_NONE; how <= OLX_OPTIMIZE_GIBBS; how++) {
        olx_place_settings settings = quicker_settings(scene, (olx_place_method)method);
        settings.optimize = (olx_place_optimizer)how;
        settings.count = 8;
        olx_probe_set set = place(scene, &settings);
        assert_true(set.count > 0 && set.count <= 8);
        if (set.report.buried) fail_msg("%s: %u probes are inside geometry", names[k], set.report.buried);
        assert_true(set.report.reward_after >= set.report.reward_before);
        if (k == 0) expect_outside_the_centre_pillar(&set);
        olx_probe_set_free(&set);
      }
    }
    olx_scene_free(scene);
  }
}

static size_t read_file(const char *path, char *bytes, size_t most) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  const size_t size = fread(bytes, 1, most, file);
  assert_int_equal(fclose(file), 0);
  assert_true(size > 0 && size < most);
  return size;
}

static void threads_and_runs_do_not_matter(void **state) {
  (void)state;
  enum { MOST = 1 << 16 };
  static char first[MOST], bytes[MOST];
  char path[] = "/tmp/octalux-skeleton-XXXXXX";
  const int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  olx_scene *scene = load("builtin:pillars");
  for (int method = OLX_PLACE_SDF; method <= OLX_PLACE_MEDIAL; method++) {
    for (int how = OLX_OPTIMIZE_GRADIENT; how <= OLX_OPTIMIZE_GIBBS; how++) {
      const uint32_t threads[4] = {1, 1, 2, 5};
      size_t size = 0;
      for (int i = 0; i < 4; i++) {
        olx_place_settings settings = quicker_settings(scene, (olx_place_method)method);
        settings.optimize = (olx_place_optimizer)how;
        settings.rounds = 2;
        settings.count = 4;
        settings.threads = threads[i];
        olx_probe_set set = place(scene, &settings);
        ASSERT_OK(olx_probe_set_save(&set, path));
        olx_probe_set_free(&set);
        const size_t length = read_file(path, i ? bytes : first, MOST);
        if (i == 0) size = length;
        assert_int_equal(length, size);
        if (i > 0) assert_memory_equal(bytes, first, size);
      }
      olx_probe_set back;
      ASSERT_OK(olx_probe_set_load(path, NULL, &back));
      assert_int_equal(back.settings.method, method);
      assert_int_equal(back.settings.optimize, how);
      assert_int_equal(back.settings.rounds, 2);
      olx_probe_set_free(&back);
    }
  }
  unlink(path);
  olx_scene_free(scene);
}

static void settings_out_of_range_are_refused(void **state) {
  (void)state;
  olx_scene *scene = cube();
  for (int i = 0; i < 4; i++) {
    olx_place_settings s = quick_settings(scene, OLX_PLACE_SDF);
    if (i == 0) s.rounds = 0;
    if (i == 1) s.optimize = (olx_place_optimizer)3;
    if (i == 2) s.reward = (olx_place_reward)2;
    if (i == 3) s.method = (olx_place_method)4;
    olx_probe_set set;
    assert_int_equal(olx_place(scene, &s, NULL, &set), OLX_ERROR_ARGUMENT);
    assert_null(set.probes);
  }
  olx_scene_free(scene);
}

static void optimizing_can_be_cancelled(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:pillars");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_SDF);
  settings.optimize = OLX_OPTIMIZE_GIBBS;
  settings.count = 2;
  const olx_progress progress = {.report = refuse};
  olx_probe_set set;
  assert_int_equal(olx_place(scene, &settings, &progress, &set), OLX_ERROR_CANCELLED);
  assert_null(set.probes);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cube_has_its_probe_in_the_centre),
      cmocka_unit_test(far_voxels_are_far_from_surfaces),
      cmocka_unit_test(medial_balls_touch_two_surfaces),
      cmocka_unit_test(a_slab_has_its_axis_in_the_middle),
      cmocka_unit_test(the_count_sets_the_granularity),
      cmocka_unit_test(the_linear_sampler_has_its_distribution),
      cmocka_unit_test(support_samples_follow_the_fitness),
      cmocka_unit_test(fitness_is_cosine_and_distance),
      cmocka_unit_test(a_bad_start_gets_better),
      cmocka_unit_test(the_reward_never_ends_lower),
      cmocka_unit_test(full_coverage_stops_the_search),
      cmocka_unit_test(overrides_hold_while_probes_move),
      cmocka_unit_test(no_probe_is_inside_geometry),
      cmocka_unit_test(threads_and_runs_do_not_matter),
      cmocka_unit_test(settings_out_of_range_are_refused),
      cmocka_unit_test(optimizing_can_be_cancelled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
