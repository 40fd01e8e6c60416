// Tests placement in scenes whose result is known: what is reached, what is inside geometry, what one probe sees, and
// requests that are refused.
#include "core/sampling.h"
#include "made_scenes.h"
#include "place/cover/measure.h"
#include "place/cover/surfels.h"
#include "place/space/space_box.h"
#include "place/space/space_find.h"
#include "place_fixtures.h"
#include "scene/builtin/builtin_shapes.h"
#include "scene/bvh.h"
#include "tiny_scenes.h"

#include <octalux/limits.h>
#include <octalux/place.h>

#include <unistd.h>

static void add_camera(olx_scene *scene, olx_vec3 eye, olx_vec3 target) {
  const olx_camera camera = tiny_camera(eye, target, 60.0f);
  ASSERT_OK(olx_scene_add_camera(scene, &camera));
}

// Checks that every method but the grid finds no place for a probe, optimized or not.
static void expect_nothing(olx_scene *scene, const char *why) {
  for (int method = OLX_PLACE_SDF; method <= OLX_PLACE_COVER; method++) {
    for (int how = OLX_OPTIMIZE_NONE; how <= OLX_OPTIMIZE_GIBBS; how++) {
      olx_place_settings settings = quick_settings(scene, (olx_place_method)method);
      settings.optimize = (olx_place_optimizer)how;
      settings.marks = how > OLX_OPTIMIZE_NONE;
      olx_probe_set set;
      assert_int_equal(olx_place(scene, &settings, NULL, &set), OLX_ERROR_EMPTY);
      if (!strstr(olx_last_error(), why)) fail_msg("\"%s\" does not say \"%s\"", olx_last_error(), why);
      assert_null(set.probes);
      assert_null(set.marks);
    }
  }
  olx_scene_free(scene);
}

static void distance_transform_is_exact(void **state) {
  (void)state;
  enum { MOST = 20 * 20 * 20 };
  static uint8_t solid[MOST];
  static uint32_t distance[MOST];
  const uint32_t shapes[5][3] = {{17, 9, 13}, {1, 20, 20}, {20, 1, 3}, {20, 20, 20}, {1, 1, 1}};
  for (uint32_t trial = 0; trial < 20; trial++) {
    const uint32_t *n = shapes[trial % 5], total = n[0] * n[1] * n[2], sparsity = 1u << trial % 9;
    for (uint32_t i = 0; i < total; i++) solid[i] = olx_hash2(trial, i) % sparsity == 0;
    if (trial == 13) memset(solid, 0, sizeof solid);
    ASSERT_OK(olx_distance_transform(solid, n, 1 + trial % 3, distance));
    for (uint32_t a = 0; a < total; a++) {
      uint32_t least = OLX_FAR_VOXELS;
      for (uint32_t b = 0; b < total; b++) {
        if (!solid[b]) continue;
        const int x = (int)(a % n[0]) - (int)(b % n[0]), y = (int)(a / n[0] % n[1]) - (int)(b / n[0] % n[1]),
                  z = (int)(a / n[0] / n[1]) - (int)(b / n[0] / n[1]);
        const uint32_t squared = (uint32_t)(x * x + y * y + z * z);
        if (squared < least) least = squared;
      }
      if (distance[a] != least) fail_msg("trial %u, voxel %u: %u instead of %u", trial, a, distance[a], least);
    }
  }
}

// Every voxel that contains a point of a surface is solid, and every solid voxel touches a surface.
static void voxels_are_conservative_and_tight(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:pillars");
  olx_space space;
  ASSERT_OK(olx_space_create(scene, 31, 2, &space));
  const olx_voxels voxels = space.voxels;
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    const uint32_t *i = scene->indices + 3 * (size_t)t;
    for (uint32_t k = 0; k < 200; k++) {
      const olx_vec2 uv = olx_sample_triangle(made_random(t, k));
      const olx_vec3 a = scene->positions[i[0]], b = scene->positions[i[1]], c = scene->positions[i[2]];
      const size_t voxel = olx_voxel_at(&voxels, olx_madd(olx_madd(a, olx_sub(b, a), uv.x), olx_sub(c, a), uv.y));
      if (voxel != OLX_NO_VOXEL) assert_true(voxels.solid[voxel]);
    }
  }
  const float half_diagonal = 0.5f * sqrtf(3.0f) * voxels.size;
  size_t solid = 0;
  for (size_t i = 0; i < voxels.total; i++) {
    if (!voxels.solid[i]) continue;
    solid++;
    assert_true(olx_bvh_distance(scene->bvh, olx_voxel_centre(&voxels, i), INFINITY) <= half_diagonal * 1.01f);
  }
  assert_true(solid > 0 && solid < voxels.total / 2);
  olx_space_free(&space);
  olx_scene_free(scene);
}

static void distance_to_surfaces_is_exact(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  made_square(scene, 0.0f, matte(scene));
  made_finish(scene);
  assert_close((double)olx_bvh_distance(scene->bvh, olx_v3(0.3f, 0.7f, 0.2f), INFINITY), 0.7, 1e-6, "above");
  assert_close((double)olx_bvh_distance(scene->bvh, olx_v3(4.0f, 4.0f, 0.5f), INFINITY), 5.0, 1e-6, "beside");
  assert_close((double)olx_bvh_distance(scene->bvh, olx_v3(3.0f, 1.0f, -3.0f), INFINITY), 3.0, 1e-6, "past a corner");
  assert_true(olx_bvh_distance(scene->bvh, olx_v3(0, 5, 0), 2.0f) == 2.0f);
  olx_scene_free(scene);
}

static void one_probe_covers_a_closed_box(void **state) {
  (void)state;
  olx_scene *scene = start_room();
  made_finish(scene);
  const olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.count, 1);
  assert_true(set.report.coverage > 0.999);
  assert_true(set.report.coverage_by_area > 0.99);
  assert_true(set.report.unreachable == 0.0);
  assert_close((double)set.probes[0].gain, set.report.coverage, 1e-6, "the only probe's gain");
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// A wall from floor to ceiling with a gap at one side divides the room, so one probe cannot see all of it.
static void a_wall_needs_a_second_probe(void **state) {
  (void)state;
  olx_scene *scene = start_room();
  made_quad(scene, olx_v3(0, 1, -0.4f), olx_v3(0, 2, 0), olx_v3(0, 0, 3.2f), matte(scene));
  made_finish(scene);
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.count = 1;
  olx_probe_set one = place(scene, &settings);
  settings.count = 2;
  olx_probe_set two = place(scene, &settings);
  assert_int_equal(two.count, 2);
  assert_true(one.report.coverage < 0.9);
  assert_true(two.report.coverage > 0.97);
  assert_true(one.report.missed > 0.1);
  assert_close(one.report.coverage + one.report.missed + one.report.grazing + one.report.restricted, 1.0, 1e-6, "sum");
  olx_probe_set_free(&one);
  olx_probe_set_free(&two);
  olx_scene_free(scene);
}

static void nothing_is_placed_in_a_sealed_room(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const uint32_t m = matte(scene);
  made_room(scene, olx_v3(-1.5f, 0, 0), 2.0f, m);
  made_room(scene, olx_v3(1.5f, 0, 0), 2.0f, m);
  add_camera(scene, olx_v3(-1.2f, 0, 0), olx_v3(-2, 0, 0));
  made_finish(scene);
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.count = 3;
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.count, 3);
  for (uint32_t i = 0; i < set.count; i++) assert_true(set.probes[i].position.x < -0.5f);
  assert_close(set.report.unreachable, 0.5, 0.02, "unreachable share");
  assert_true(set.report.coverage > 0.999);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// Without a camera the larger of two rooms counts; with light in the smaller room, that room counts.
static void light_says_which_room_matters(void **state) {
  (void)state;
  for (int lit = 0; lit < 2; lit++) {
    olx_scene *scene = made_scene();
    const uint32_t m = matte(scene);
    made_room(scene, olx_v3(-1.5f, 0, 0), 2.0f, m);
    made_room(scene, olx_v3(2.5f, 0, 0), 4.0f, m);
    const olx_light light = {.type = OLX_LIGHT_POINT, .position = {-1.5f, 0.5f, 0}, .emission = {1, 1, 1}};
    if (lit) ASSERT_OK(olx_scene_add_light(scene, &light));
    made_finish(scene);
    const olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
    olx_probe_set set = place(scene, &settings);
    for (uint32_t i = 0; i < set.count; i++) assert_true((set.probes[i].position.x < -0.5f) == (lit == 1));
    olx_probe_set_free(&set);
    olx_scene_free(scene);
  }
}

// Without a camera every room counts that light reaches, however large the others are, be it through a pane.
static void all_lit_rooms_matter(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const uint32_t m = matte(scene);
  olx_material glass = olx_material_default();
  glass.alpha = 0.6f;
  glass.alpha_cutoff = 0.5f;
  glass.blended = true;
  const uint32_t pane = made_material(scene, &glass);
  const float x[] = {-1.5f, 2.5f, 6.5f, 9.5f}; // of the rooms' centres; no light reaches the third
  made_room(scene, olx_v3(x[0], 0, 0), 2.0f, m);
  made_room(scene, olx_v3(x[1], 0, 0), 4.0f, m);
  made_room(scene, olx_v3(x[2], 0, 0), 2.0f, m);
  made_room(scene, olx_v3(x[3], 0, 0), 2.0f, pane);
  scene->environment.radiance = olx_splat(1.0f);
  for (uint32_t i = 0; i < 2; i++) {
    const olx_light light = {.type = OLX_LIGHT_POINT, .position = {x[i], 0.5f, 0}, .emission = {1, 1, 1}};
    ASSERT_OK(olx_scene_add_light(scene, &light));
  }
  made_finish(scene);
  const olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  olx_probe_set set = place(scene, &settings);
  bool seen[4] = {false};
  for (uint32_t i = 0; i < set.count; i++) {
    const float at = set.probes[i].position.x;
    seen[at < -0.5f ? 0 : at < 4.5f ? 1 : at < 8.0f ? 2 : 3] = true;
  }
  assert_true(seen[0] && seen[1] && !seen[2] && seen[3]);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

static void nothing_to_place_in_is_said_clearly(void **state) {
  (void)state;
  // The camera, which sees the room around the solid, decides what is inside geometry.
  olx_scene *solid = start_room();
  ASSERT_OK(olx_add_box(solid, "solid", olx_v3(-0.5f, -0.5f, -0.5f), olx_v3(0.5f, 0.5f, 0.5f), matte(solid)));
  add_camera(solid, olx_v3(0.8f, 0.8f, 0.8f), olx_v3(0, 0, 0));
  solid->probe_rules.has_playable = true;
  solid->probe_rules.playable = (olx_box){{-0.4f, -0.4f, -0.4f}, {0.4f, 0.4f, 0.4f}};
  expect_nothing(made_finish(solid), "inside geometry");
  olx_scene *quad = made_scene();
  made_square(quad, 0.0f, matte(quad));
  expect_nothing(made_finish(quad), "flat");
  olx_scene *far = start_room();
  far->probe_rules.has_playable = true;
  far->probe_rules.playable = (olx_box){{50, 50, 50}, {60, 60, 60}};
  expect_nothing(made_finish(far), "playable box");
  // A playable box above the room can be reached, but nothing is seen from it.
  olx_scene *room = start_room();
  room->probe_rules.has_playable = true;
  room->probe_rules.playable = (olx_box){{-1, 3, -1}, {1, 4, 1}};
  made_finish(room);
  const olx_place_settings settings = quick_settings(room, OLX_PLACE_COVER);
  olx_probe_set set;
  // A viewer above the room sees the outside of its ceiling.
  ASSERT_OK(olx_place(room, &settings, NULL, &set));
  for (uint32_t i = 0; i < set.count; i++) assert_true(set.probes[i].position.y > 3.0f);
  olx_probe_set_free(&set);
  olx_scene_free(room);
  olx_scene *forbidden = start_room();
  forbidden->probe_rules.min_distance = 1.5f;
  expect_nothing(made_finish(forbidden), "leave no place");
}

// Both sides of a single sheet in a playable box are seen and covered.
static void a_single_quad_has_two_sides(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  made_square(scene, 0.0f, matte(scene));
  scene->probe_rules.has_playable = true;
  scene->probe_rules.playable = (olx_box){{-1, -1, -1}, {1, 1, 1}};
  made_finish(scene);
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.count = 2;
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.count, 2);
  assert_true(set.probes[0].position.y * set.probes[1].position.y < 0.0f);
  assert_true(set.report.coverage > 0.95);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

static void threads_and_runs_do_not_matter(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:pillars");
  for (int kind = 0; kind < 12; kind++) {
    olx_place_settings settings = quicker_settings(scene, (olx_place_method)(kind / 3));
    settings.optimize = (olx_place_optimizer)(kind % 3);
    const bool skeleton = settings.method == OLX_PLACE_SDF || settings.method == OLX_PLACE_MEDIAL;
    if (skeleton && settings.optimize != OLX_OPTIMIZE_NONE) continue; // full_place_skeleton.c tests these
    settings.rounds = 2;
    settings.count = 6;
    settings.threads = 1;
    olx_probe_set one = place(scene, &settings);
    settings.threads = 5;
    olx_probe_set other = place(scene, &settings);
    assert_true(same_probes(&one, &other));
    olx_probe_set_free(&other);
    if (settings.method == OLX_PLACE_COVER) {
      settings.seed = 1;
      olx_probe_set seeded = place(scene, &settings);
      assert_false(same_probes(&one, &seeded));
      olx_probe_set_free(&seeded);
    }
    olx_probe_set_free(&one);
  }
  olx_scene_free(scene);
}

static void more_probes_cover_more(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:labyrinth");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  double before = 0.0;
  for (settings.count = 1; settings.count <= 16; settings.count *= 2) {
    olx_probe_set set = place(scene, &settings);
    assert_int_equal(set.count, settings.count);
    // Coverage grows strictly, until all but the last half per mille is covered.
    assert_true(set.report.coverage > before || set.report.coverage >= 0.9995);
    assert_true(set.report.visible >= set.report.coverage);
    before = set.report.coverage;
    double gains = 0.0;
    for (uint32_t i = 0; i < set.count; i++) gains += (double)set.probes[i].gain;
    assert_close(gains, set.report.coverage, 1e-4, "sum of gains");
    olx_probe_set_free(&set);
  }
  assert_true(before > 0.99);
  olx_scene_free(scene);
}

static void asked_coverage_is_reached(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:labyrinth");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.coverage = 0.9f;
  olx_probe_set less = place(scene, &settings);
  settings.coverage = 0.99f;
  olx_probe_set more = place(scene, &settings);
  assert_true(less.count < more.count);
  assert_true(less.report.coverage >= 0.89 * less.report.coverable);
  assert_true(more.report.coverage >= 0.985 * more.report.coverable);
  olx_probe_set_free(&less);
  olx_probe_set_free(&more);
  olx_scene_free(scene);
}

static void a_second_view_needs_more_probes(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.coverage = 0.97f;
  olx_probe_set once = place(scene, &settings);
  settings.views = 2;
  olx_probe_set twice = place(scene, &settings);
  assert_true(twice.count > once.count);
  assert_true(twice.report.coverage > 0.94);
  olx_probe_set_free(&once);
  olx_probe_set_free(&twice);
  olx_scene_free(scene);
}

// As many probes are placed as have a field that is expected to fit: one byte less holds one probe less.
static void a_budget_says_how_many(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.resolution = 64;
  settings.count = 12;
  settings.coverage = 1.0f;
  settings.field_size = true;
  olx_probe_set free = place(scene, &settings);
  settings.count = 0;
  settings.field_size = false;
  settings.coverage = 0.0f;
  settings.budget_mb = 1e-6 * (double)free.report.field_bytes;
  olx_probe_set set = place(scene, &settings);
  // What other probes see differs by no more than a probe's share.
  assert_in_range(set.count, free.count - 1, free.count + 1);
  assert_true((double)set.report.field_bytes <= settings.budget_mb * 1e6);
  assert_true((double)set.report.field_bytes * (1.0 + 1.5 / set.count) > settings.budget_mb * 1e6);
  olx_probe_set_free(&set);
  olx_probe_set_free(&free);
  olx_scene_free(scene);
}

// The message that refuses a budget names megabytes that hold a probe, rounded up to a thousandth.
static void a_budget_for_no_probe_is_refused(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.resolution = 64;
  settings.budget_mb = 0.01;
  olx_probe_set set;
  assert_int_equal(olx_place(scene, &settings, NULL, &set), OLX_ERROR_ARGUMENT);
  const char *named = strstr(olx_last_error(), "does not hold a field of one probe of 64 x 64 texels, which takes ");
  assert_non_null(named);
  settings.budget_mb = atof(strstr(named, "takes ") + strlen("takes "));
  assert_true(settings.budget_mb > 0.02 && settings.budget_mb < 0.05);
  set = place(scene, &settings);
  assert_int_equal(set.count, 1);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

static void the_pillars_bury_three_grid_probes(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:pillars");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.method = OLX_PLACE_GRID;
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.count, 18);
  assert_int_equal(set.report.buried, 3);
  for (uint32_t i = 0; i < set.count; i++) {
    const olx_vec3 p = set.probes[i].position;
    const bool centre = p.x == 0.0f && p.z == 0.0f, right = p.x == 2.0f && p.z == -2.0f && p.y < 1.5f;
    assert_true(set.probes[i].buried == (centre || right));
    assert_int_equal(set.probes[i].origin, OLX_ORIGIN_GRID);
    if (set.probes[i].buried) assert_true(set.probes[i].gain == 0.0f);
  }
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

static void no_probe_is_inside_geometry(void **state) {
  (void)state;
  const char *const names[] = {"builtin:pillars", "builtin:cornell", "builtin:two-rooms-gap", "builtin:temple",
                               "builtin:furnace"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    for (int cameras = 0; cameras < 2; cameras++) {
      olx_scene *scene = load(names[k]);
      if (!cameras) scene->camera_count = 0;
      olx_place_settings settings = quicker_settings(scene, OLX_PLACE_COVER);
      settings.count = 12;
      olx_probe_set set = place(scene, &settings);
      if (set.report.buried) fail_msg("%s: %u probes are inside geometry", names[k], set.report.buried);
      if (k == 0) expect_outside_the_centre_pillar(&set);
      olx_probe_set_free(&set);
      olx_scene_free(scene);
    }
  }
}

static void overrides_hold_for_every_method(void **state) {
  (void)state;
  for (int method = OLX_PLACE_GRID; method <= OLX_PLACE_COVER; method++) {
    olx_scene *scene = load_ruled_room();
    olx_place_settings settings = quick_settings(scene, (olx_place_method)method);
    settings.count = 5;
    settings.grid = (olx_grid){.origin = {-1.75f, 0.5f, -1.75f}, .spacing = {0.5f, 0.5f, 0.5f}, .count = {8, 3, 8}};
    olx_probe_set set = place(scene, &settings);
    assert_true(set.count >= 4);
    expect_rules_kept(scene, &set);
    if (method == OLX_PLACE_GRID) assert_int_equal(set.count + set.report.rejected, 2 + 8 * 3 * 8);
    settings.count = 1;
    olx_probe_set few;
    if (method == OLX_PLACE_COVER) assert_int_equal(olx_place(scene, &settings, NULL, &few), OLX_ERROR_ARGUMENT);
    olx_probe_set_free(&set);
    olx_scene_free(scene);
  }
}

// Surfaces behind a forbidden part of a corridor are seen, but cannot be covered, and the report says so.
static void what_cannot_be_covered_is_told_apart(void **state) {
  (void)state;
  olx_scene *scene = start_room();
  made_quad(scene, olx_v3(0, 1, -0.4f), olx_v3(0, 2, 0), olx_v3(0, 0, 3.2f), matte(scene));
  add_camera(scene, olx_v3(-1, 1, 0), olx_v3(0, 1, 1));
  made_finish(scene);
  olx_probe_rules *rules = &scene->probe_rules;
  rules->forbidden = olx_allocate(1, sizeof *rules->forbidden);
  rules->forbidden[0] = (olx_box){{-0.5f, 0, -2}, {2, 2, 2}};
  rules->forbidden_count = 1;
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  olx_probe_set set = place(scene, &settings);
  for (uint32_t i = 0; i < set.count; i++) assert_true(set.probes[i].position.x < -0.5f);
  assert_true(set.report.restricted > 0.1);
  assert_true(set.report.coverage >= 0.99 * set.report.coverable);
  assert_true(set.report.unreachable == 0.0);
  olx_probe_set_free(&set);
  // At this resolution texels are too large everywhere: all surfaces are seen, but none is seen well.
  rules->forbidden_count = 0;
  settings.count = 3;
  settings.resolution = 8;
  settings.max_footprint = 1e-5f;
  assert_int_equal(olx_place(scene, &settings, NULL, &set), OLX_ERROR_EMPTY);
  assert_non_null(strstr(olx_last_error(), "max_footprint"));
  olx_scene_free(scene);
}

// Sight is marched in steps of half a voxel, which are less than a float resolves a thousand kilometres away.
static void surfaces_may_be_very_far_from_small_voxels(void **state) {
  (void)state;
  olx_scene *scene = start_room();
  made_quad(scene, olx_v3(0, -100, 0), olx_v3(0, 0, 4e6f), olx_v3(4e6f, 0, 0), matte(scene));
  add_camera(scene, olx_v3(1e6f, 10, 1e6f), olx_v3(0, 1, 0));
  made_finish(scene);
  scene->probe_rules.has_playable = true;
  scene->probe_rules.playable = (olx_box){{-0.5f, 0.5f, -0.5f}, {0.5f, 1.5f, 0.5f}};
  const olx_place_settings settings = quicker_settings(scene, OLX_PLACE_COVER);
  olx_probe_set set = place(scene, &settings);
  for (uint32_t i = 0; i < set.count; i++) assert_true(box_holds(&scene->probe_rules.playable, set.probes[i].position));
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

static void settings_out_of_range_are_refused(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  for (int i = 0; i < 12; i++) {
    olx_place_settings s = quick_settings(scene, i == 10 ? OLX_PLACE_GRID : OLX_PLACE_COVER);
    if (i == 0) s.coverage = 1.5f;
    if (i == 1) s.coverage = NAN;
    if (i == 2) s.views = 0;
    if (i == 3) s.resolution = 100;
    if (i == 4) s.min_cosine = 1.0f;
    if (i == 5) s.max_footprint = 0.0f;
    if (i == 6) s.voxels = 4;
    if (i == 7) s.candidates = 0;
    if (i == 8) s.grid.count[1] = 0;
    if (i == 9) s.budget_mb = -1.0;
    if (i == 10) s.grid = (olx_grid){.count = {OLX_PLACE_PROBES_MOST + 1, 1, 1}};
    if (i == 11) s.grid = (olx_grid){.count = {OLX_BAKE_PROBES_MOST + 1, 1, 1}};
    olx_probe_set set;
    assert_int_equal(olx_place(scene, &s, NULL, &set), OLX_ERROR_ARGUMENT);
    assert_null(set.probes);
  }
  olx_scene_free(scene);
}

static void placement_can_be_cancelled(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:pillars");
  const olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  const olx_progress progress = {.report = refuse};
  olx_probe_set set;
  assert_int_equal(olx_place(scene, &settings, &progress, &set), OLX_ERROR_CANCELLED);
  assert_null(set.probes);
  olx_scene_free(scene);
}

static void write_text(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
}

static void probe_files_come_back(void **state) {
  (void)state;
  char path[] = "/tmp/octalux-probes-XXXXXX";
  const int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  olx_scene *scene = load("builtin:pillars");
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.method = OLX_PLACE_GRID;
  settings.seed = 4000000000u;
  olx_probe_set set = place(scene, &settings), back;
  ASSERT_OK(olx_probe_set_save(&set, path));
  ASSERT_OK(olx_probe_set_load(path, NULL, &back));
  assert_int_equal(back.count, set.count);
  assert_true(back.scene_hash == set.scene_hash);
  assert_int_equal(back.settings.method, OLX_PLACE_GRID);
  assert_true(back.settings.seed == settings.seed && back.settings.min_cosine == settings.min_cosine);
  for (uint32_t i = 0; i < set.count; i++) {
    assert_memory_equal(&back.probes[i].position, &set.probes[i].position, sizeof set.probes[i].position);
    assert_int_equal(back.probes[i].origin, set.probes[i].origin);
    assert_true(back.probes[i].buried == set.probes[i].buried);
    assert_true(fabsf(back.probes[i].gain - set.probes[i].gain) < 1e-6f);
  }
  olx_probe_set_free(&back);
  write_text(path, "{\"probes\": [{\"position\": [1, 2.5, -3]}]}");
  ASSERT_OK(olx_probe_set_load(path, NULL, &back));
  assert_int_equal(back.count, 1);
  assert_true(back.probes[0].position.y == 2.5f && !back.probes[0].buried);
  olx_probe_set_free(&back);
  const char *const broken[][2] = {
      {"", "empty"},
      {"{\"probes\": [{\"position\": [1, 2]}]}", "probes[0].position"},
      {"{\"probes\": [{\"position\": [1, 2, 3]}, {\"position\": [1, 2, 1e99]}]}", "probes[1].position"},
      {"{\"probes\": [{\"position\": [1, 2, 3], \"origin\": \"moon\"}]}", "probes[0].origin"},
      {"{\"probes\": [{\"position\": [1, 2, 3], \"gain\": \"much\"}]}", "probes[0].gain"},
      {"{\"probes\": []}", "at least one probe"},
      {"{\"probes\": {}}", "expected a list"},
      {"[]", "expected a list"},
      {"{\"version\": 2, \"probes\": [{\"position\": [1, 2, 3]}]}", "version"},
      {"{\"method\": \"magic\", \"probes\": [{\"position\": [1, 2, 3]}]}", "method"},
      {"{\"settings\": {\"seed\": -1}, \"probes\": [{\"position\": [1, 2, 3]}]}", "settings.seed"},
      {"{\"probes\": [{\"position\": [1, 2, 3]", "JSON"},
  };
  for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
    write_text(path, broken[i][0]);
    assert_int_not_equal(olx_probe_set_load(path, NULL, &back), OLX_OK);
    assert_null(back.probes);
    if (!strstr(olx_last_error(), broken[i][1]) || !strstr(olx_last_error(), path)) {
      fail_msg("%s: \"%s\" does not name %s", broken[i][0], olx_last_error(), broken[i][1]);
    }
  }
  unlink(path);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// The marks of missed surfaces agree with the report, and the skeleton is inside the room.
static void marks_tell_what_is_missed(void **state) {
  (void)state;
  olx_scene *scene = made_finish(start_divided_room());
  for (int method = OLX_PLACE_GRID; method <= OLX_PLACE_COVER; method++) {
    olx_place_settings settings = quick_settings(scene, (olx_place_method)method);
    settings.count = 1;
    settings.grid = (olx_grid){.origin = {-1, 1, 0}, .spacing = {1, 1, 1}, .count = {1, 1, 1}};
    settings.marks = true;
    olx_probe_set set = place(scene, &settings);
    uint32_t missed = 0, skeleton = 0;
    for (uint32_t i = 0; i < set.mark_count; i++) {
      const olx_place_mark *mark = &set.marks[i];
      missed += mark->kind == OLX_MARK_MISSED;
      if (mark->kind != OLX_MARK_SKELETON) continue;
      skeleton++;
      assert_true(mark->radius > 0.0f && mark->radius < 1.2f);
      assert_true(box_holds(&(olx_box){{-2, 0, -2}, {2, 2, 2}}, mark->position));
    }
    assert_true(skeleton > 10);
    assert_close((double)missed / (double)set.report.surfels, set.report.missed, 1e-9, "share of marks");
    assert_true(method == OLX_PLACE_COVER || missed > 100);
    olx_probe_set_free(&set);
    settings.marks = false;
    set = place(scene, &settings);
    assert_true(set.mark_count == 0 && !set.marks);
    olx_probe_set_free(&set);
  }
  olx_scene_free(scene);
}

// Starts a room that has an open window in a wall, floor and walls that face both sides, and ground around it, with a
// camera: the bounds contain much free space outside, which that camera sees.
static olx_scene *start_room_with_a_window(void) {
  olx_scene *scene = made_scene();
  const uint32_t m = matte(scene);
  made_quad(scene, olx_v3(0, 0, 0), olx_v3(0, 0, 12), olx_v3(12, 0, 0), m);
  made_quad(scene, olx_v3(0, 2, 0), olx_v3(4, 0, 0), olx_v3(0, 0, 4), m);
  made_quad(scene, olx_v3(0, 1, -2), olx_v3(4, 0, 0), olx_v3(0, 2, 0), m);
  made_quad(scene, olx_v3(0, 1, 2), olx_v3(4, 0, 0), olx_v3(0, 2, 0), m);
  made_quad(scene, olx_v3(-2, 1, 0), olx_v3(0, 0, 4), olx_v3(0, 2, 0), m);
  made_quad(scene, olx_v3(2, 0.5f, 0), olx_v3(0, 0, 4), olx_v3(0, 1, 0), m); // the wall below the window
  add_camera(scene, olx_v3(-1, 1, 0), olx_v3(1, 1, 0));
  return scene;
}

static bool is_in_room(olx_vec3 p) { return box_holds(&(olx_box){{-2, 0, -2}, {3.0f, 2.0f, 2.0f}}, p); }

static void no_probe_leaves_through_a_window(void **state) {
  (void)state;
  olx_scene *scene = made_finish(start_room_with_a_window());
  for (int method = OLX_PLACE_SDF; method <= OLX_PLACE_COVER; method++) {
    for (int how = OLX_OPTIMIZE_NONE; how <= OLX_OPTIMIZE_GIBBS; how++) {
      olx_place_settings settings = quicker_settings(scene, (olx_place_method)method);
      settings.optimize = (olx_place_optimizer)how;
      settings.voxels = 96;
      olx_probe_set set = place(scene, &settings);
      for (uint32_t i = 0; i < set.count; i++) {
        const olx_vec3 p = set.probes[i].position;
        if (!is_in_room(p)) {
          fail_msg("%s, %s: (%g, %g, %g) is not in the room", olx_place_method_name(settings.method),
                   olx_place_optimizer_name(settings.optimize), (double)p.x, (double)p.y, (double)p.z);
        }
      }
      olx_probe_set_free(&set);
    }
  }
  olx_scene_free(scene);
}

// A second camera, beyond the ground, sees the house from outside: what lies before it matters as well.
static void a_camera_outdoors_gets_probes_beside_one_indoors(void **state) {
  (void)state;
  olx_scene *scene = start_room_with_a_window();
  add_camera(scene, olx_v3(9, 1.5f, 1), olx_v3(2, 1, 0));
  made_finish(scene);
  const olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  olx_probe_set set = place(scene, &settings);
  uint32_t indoors = 0;
  for (uint32_t i = 0; i < set.count; i++) indoors += is_in_room(set.probes[i].position);
  assert_true(indoors > 0 && indoors < set.count);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// A grid of more points than there may be candidates, even than there may be probes, is thinned; it is neither left out
// nor refused.
static void a_large_grid_has_candidates(void **state) {
  (void)state;
  olx_scene *scene = made_finish(start_divided_room());
  olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
  settings.count = 40;
  ASSERT_OK(olx_scene_probe_grid(scene, (const uint32_t[3]){64, 24, 64}, &settings.grid));
  olx_probe_set set = place(scene, &settings);
  uint32_t of_grid = 0;
  for (uint32_t i = 0; i < set.count; i++) of_grid += set.probes[i].origin == OLX_ORIGIN_GRID;
  assert_true(of_grid > 0);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// A block stands on the ground, its top is the scene's. A camera that looks down on it gets probes above it, which see
// the top; a camera below the top does not.
static void what_lies_uppermost_is_seen_from_above(void **state) {
  (void)state;
  for (int above = 0; above < 2; above++) {
    olx_scene *scene = made_scene();
    const uint32_t m = matte(scene);
    made_quad(scene, olx_v3(0, 0, 0), olx_v3(0, 0, 6), olx_v3(6, 0, 0), m);
    made_box(scene, olx_v3(-1, 0, -1), olx_v3(1, 1, 1), true, m);
    add_camera(scene, above ? olx_v3(5, 4, 5) : olx_v3(2.5f, 0.5f, 2.5f), olx_v3(0, 0.5f, 0));
    made_finish(scene);
    const olx_place_settings settings = quick_settings(scene, OLX_PLACE_COVER);
    olx_probe_set set = place(scene, &settings);
    uint32_t see_top = 0;
    for (uint32_t i = 0; i < set.count; i++) {
      const olx_vec3 p = set.probes[i].position;
      assert_true(p.y < 1.0f + 0.125f * sqrtf(73.0f));
      see_top += p.y > 1.0f;
    }
    assert_int_equal(see_top > 0, above);
    olx_probe_set_free(&set);
    olx_scene_free(scene);
  }
}

// Returns how far the box of interest of a block of 4 x 3 x 4 m reaches beyond it in +z, for a camera, or for none.
static float reach_in_front(const olx_camera *camera) {
  olx_scene *scene = made_scene();
  made_box(scene, olx_v3(-2, 0, -2), olx_v3(2, 3, 2), true, matte(scene));
  if (camera) ASSERT_OK(olx_scene_add_camera(scene, camera));
  made_finish(scene);
  olx_box box;
  ASSERT_OK(olx_space_box(scene, &box));
  const olx_vec3 low = olx_sub(scene->bounds_min, box.min), high = olx_sub(box.max, scene->bounds_max);
  assert_true(olx_max3(low) == 0.0f && olx_max(high.x, high.y) == 0.0f); // all cameras stand in front of it
  const float reach = high.z;
  olx_scene_free(scene);
  return reach;
}

// A house without ground, and a camera in the street: no place within its bounds sees the front, so space in front
// matters, as far as the camera, and at most to an eighth of the diagonal.
static void the_front_of_a_house_is_seen_from_the_street(void **state) {
  (void)state;
  const olx_vec3 front = {0, 1.5f, 2};
  const olx_camera near = tiny_camera(olx_v3(0.5f, 1.5f, 2.5f), front, 60.0f);
  const olx_camera far = tiny_camera(olx_v3(3, 1.5f, 20), front, 60.0f);
  const olx_camera away = tiny_camera(olx_v3(0, 1.5f, 20), olx_v3(0, 1.5f, 30), 60.0f);
  assert_float_equal(reach_in_front(NULL), 0.0f, 0.0f);
  assert_float_equal(reach_in_front(&near), 0.5f, 1e-6f);
  assert_float_equal(reach_in_front(&far), 0.125f * sqrtf(16.0f + 9.0f + 16.0f), 1e-5f);
  assert_float_equal(reach_in_front(&away), 0.0f, 0.0f);
}

// A camera outside that looks into a room through its open side sees no outer surfaces: space beyond the room, from
// which no more could be seen, is left out.
static void an_open_room_is_seen_from_within(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const uint32_t m = matte(scene);
  made_quad(scene, olx_v3(0, 0, 0), olx_v3(0, 0, 2), olx_v3(2, 0, 0), m);        // the floor
  made_quad(scene, olx_v3(0, 3, 0), olx_v3(2, 0, 0), olx_v3(0, 0, 2), m);        // the ceiling
  made_quad(scene, olx_v3(0, 1.5f, -2), olx_v3(2, 0, 0), olx_v3(0, 1.5f, 0), m); // the back wall
  add_camera(scene, olx_v3(0, 1.5f, 6), olx_v3(0, 1.5f, 0));
  made_finish(scene);
  olx_box box;
  ASSERT_OK(olx_space_box(scene, &box));
  assert_float_equal(box.max.z, scene->bounds_max.z, 0.0f);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distance_transform_is_exact),
      cmocka_unit_test(voxels_are_conservative_and_tight),
      cmocka_unit_test(distance_to_surfaces_is_exact),
      cmocka_unit_test(one_probe_covers_a_closed_box),
      cmocka_unit_test(a_wall_needs_a_second_probe),
      cmocka_unit_test(nothing_is_placed_in_a_sealed_room),
      cmocka_unit_test(light_says_which_room_matters),
      cmocka_unit_test(all_lit_rooms_matter),
      cmocka_unit_test(nothing_to_place_in_is_said_clearly),
      cmocka_unit_test(a_single_quad_has_two_sides),
      cmocka_unit_test(threads_and_runs_do_not_matter),
      cmocka_unit_test(more_probes_cover_more),
      cmocka_unit_test(asked_coverage_is_reached),
      cmocka_unit_test(marks_tell_what_is_missed),
      cmocka_unit_test(no_probe_leaves_through_a_window),
      cmocka_unit_test(a_camera_outdoors_gets_probes_beside_one_indoors),
      cmocka_unit_test(a_large_grid_has_candidates),
      cmocka_unit_test(what_lies_uppermost_is_seen_from_above),
      cmocka_unit_test(the_front_of_a_house_is_seen_from_the_street),
      cmocka_unit_test(an_open_room_is_seen_from_within),
      cmocka_unit_test(a_second_view_needs_more_probes),
      cmocka_unit_test(a_budget_says_how_many),
      cmocka_unit_test(a_budget_for_no_probe_is_refused),
      cmocka_unit_test(the_pillars_bury_three_grid_probes),
      cmocka_unit_test(no_probe_is_inside_geometry),
      cmocka_unit_test(overrides_hold_for_every_method),
      cmocka_unit_test(what_cannot_be_covered_is_told_apart),
      cmocka_unit_test(surfaces_may_be_very_far_from_small_voxels),
      cmocka_unit_test(settings_out_of_range_are_refused),
      cmocka_unit_test(placement_can_be_cancelled),
      cmocka_unit_test(probe_files_come_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
