// Tests placement in space that is divided into tiles: floods by bricks, covers that do not depend on the order of
// tiles, and surfaces that are not reached.
#include "core/hooks.h"
#include "core/sampling.h"
#include "made_scenes.h"
#include "place/cover/tiles.h"
#include "place/space/space_find.h"
#include "place_fixtures.h"
#include "scene/builtin/builtin_shapes.h"
#include "tiny_scenes.h"

#include <octalux/place.h>

#define HALL_LENGTH 60.0f
#define HALL_HEIGHT 3.0f
#define HALL_WIDTH 5.0f
#define ROOM_LENGTH 12.0f
#define DOOR_LOW 2.0f
#define DOOR_HIGH 3.0f

static void divide(olx_scene *scene, float x, float from, float to) {
  const float middle = 0.5f * (from + to);
  made_quad(scene, olx_v3(x, 0.5f * HALL_HEIGHT, middle), olx_v3(0, HALL_HEIGHT, 0), olx_v3(0, 0, to - from),
            matte(scene));
}

// Makes five rooms in a row with doors of one metre between them, except to the last room when it is sealed. The camera
// is in the first room.
static olx_scene *load_hall(bool sealed) {
  olx_scene *scene = made_scene();
  made_quad(scene, olx_v3(0.5f * HALL_LENGTH, 0, 0.5f * HALL_WIDTH), olx_v3(0, 0, HALL_WIDTH),
            olx_v3(HALL_LENGTH, 0, 0), matte(scene));
  made_quad(scene, olx_v3(0.5f * HALL_LENGTH, HALL_HEIGHT, 0.5f * HALL_WIDTH), olx_v3(HALL_LENGTH, 0, 0),
            olx_v3(0, 0, HALL_WIDTH), matte(scene));
  for (int end = 0; end < 2; end++) {
    divide(scene, end ? HALL_LENGTH : 0.0f, 0.0f, HALL_WIDTH);
    made_quad(scene, olx_v3(0.5f * HALL_LENGTH, 0.5f * HALL_HEIGHT, end ? HALL_WIDTH : 0.0f), olx_v3(HALL_LENGTH, 0, 0),
              olx_v3(0, HALL_HEIGHT, 0), matte(scene));
  }
  for (int room = 1; room < 5; room++) {
    const bool closed = sealed && room == 4;
    divide(scene, (float)room * ROOM_LENGTH, 0.0f, closed ? HALL_WIDTH : DOOR_LOW);
    if (!closed) divide(scene, (float)room * ROOM_LENGTH, DOOR_HIGH, HALL_WIDTH);
  }
  const olx_camera camera = tiny_camera(olx_v3(2, 1.5f, 2.5f), olx_v3(9, 1.5f, 2.5f), 60.0f);
  ASSERT_OK(olx_scene_add_camera(scene, &camera));
  return made_finish(scene);
}

static olx_place_settings hall_settings(const olx_scene *scene) {
  olx_place_settings settings = olx_place_settings_default(scene);
  settings.surfels = 700;
  settings.candidates = 150;
  settings.refinements = 1;
  return settings;
}

// Scatters 400 large parallelograms in a cube of 20 m, so that space is full of caves.
static olx_scene *load_caves(uint32_t seed) {
  olx_scene *scene = made_scene();
  const uint32_t material = matte(scene);
  for (uint32_t i = 0; i < 400; i++) {
    const olx_vec3 centre = {20.0f * olx_unit_float(olx_hash3(seed, i, 0)),
                             20.0f * olx_unit_float(olx_hash3(seed, i, 1)),
                             20.0f * olx_unit_float(olx_hash3(seed, i, 2))};
    const olx_vec3 u = olx_sample_sphere(made_random(seed, 2 * i)), v = olx_sample_sphere(made_random(seed, 2 * i + 1));
    made_quad(scene, centre, olx_scale(u, 6.0f), olx_scale(v, 6.0f), material);
  }
  return made_finish(scene);
}

// Labels every voxel by its state in the world of bricks, free voxels with 0, for comparison with a flood voxel by
// voxel.
static void label_voxels(const olx_world *world, const olx_voxels *v, uint32_t *labels) {
  for (size_t i = 0; i < v->total; i++) {
    uint32_t voxel[3];
    olx_voxel_coordinates(v, i, voxel);
    labels[i] = olx_world_state(world, voxel) == OLX_VOXEL_SOLID ? UINT32_MAX : 0;
  }
}

static void expect_same_flood(olx_world *world, const olx_voxels *v, size_t start, uint32_t *labels, size_t *stack) {
  uint32_t voxel[3];
  label_voxels(world, v, labels);
  const size_t by_voxels = olx_voxels_flood(v, start, 1, labels, stack);
  olx_voxel_coordinates(v, start, voxel);
  olx_world_forget(world);
  olx_world_flood(world, voxel);
  assert_int_equal(olx_world_count_reached(world), by_voxels);
  for (size_t i = 0; i < v->total; i++) {
    olx_voxel_coordinates(v, i, voxel);
    assert_int_equal(olx_world_state(world, voxel) == OLX_VOXEL_REACHED, labels[i] == 1);
  }
}

// The caves have 37 voxels a side, which is not a multiple of a brick's eight.
static void floods_by_bricks_reach_what_floods_by_voxels_reach(void **state) {
  (void)state;
  for (uint32_t seed = 0; seed < 3; seed++) {
    olx_scene *scene = load_caves(seed);
    olx_voxels v = {0};
    olx_world world;
    olx_voxels_fit((olx_box){{0, 0, 0}, {20, 20, 20}}, 37, &v);
    const olx_lattice lattice = {v.low, v.size, 1e-3f, {v.count[0], v.count[1], v.count[2]}};
    ASSERT_OK(olx_world_create(scene, (olx_box){{0, 0, 0}, {20, 20, 20}}, &lattice, (const uint32_t[3]){0}, 2, &world));
    uint32_t *labels = olx_allocate(v.total, sizeof *labels);
    size_t *stack = olx_allocate(v.total, sizeof *stack);
    for (uint32_t trial = 0; trial < 10; trial++) {
      expect_same_flood(&world, &v, olx_hash2(seed, trial) % v.total, labels, stack);
    }
    olx_release(labels);
    olx_release(stack);
    olx_world_free(&world);
    olx_scene_free(scene);
  }
}

// Covers the hall with the tiles of each colour in forward or backward order.
static olx_tile_probes cover_hall(olx_world *world, const olx_scene *scene, bool backwards) {
  olx_place_settings settings = hall_settings(scene);
  settings.coverage = 0.999f;
  const olx_sight sight = olx_sight_create(olx_world_diagonal(world), 0.02f, 0.05f, 512);
  olx_tiling tiling;
  olx_tile_probes joined = {0};
  ASSERT_OK(olx_tiling_create(world, &sight, &settings, &tiling));
  for (uint32_t colour = 0; colour < OLX_TILE_COLOURS; colour++) {
    for (uint32_t i = 0; i < world->tile_total; i++) {
      const uint32_t tile = backwards ? world->tile_total - 1 - i : i;
      if (olx_tile_colour(world, tile) == colour) ASSERT_OK(olx_tiling_cover(&tiling, tile));
    }
  }
  ASSERT_OK(olx_tiling_join(&tiling, &joined.items, &joined.count));
  olx_tiling_free(&tiling);
  return joined;
}

static void the_order_of_tiles_does_not_matter(void **state) {
  (void)state;
  olx_scene *scene = load_hall(false);
  olx_world world;
  // Voxels are 0.125 m wide, so that there are several tiles of one colour.
  ASSERT_OK(olx_world_create_tiled(scene, 0.125f, 2, &world));
  assert_true(world.tile_total >= 4);
  olx_tile_probes forwards = cover_hall(&world, scene, false), backwards = cover_hall(&world, scene, true);
  assert_true(forwards.count >= 4);
  assert_int_equal(forwards.count, backwards.count);
  for (uint32_t i = 0; i < forwards.count; i++) {
    assert_memory_equal(&forwards.items[i].place, &backwards.items[i].place, sizeof(olx_vec3));
  }
  olx_release(forwards.items);
  olx_release(backwards.items);
  olx_world_free(&world);
  olx_scene_free(scene);
}

static void tiles_cover_a_hall_with_any_number_of_threads(void **state) {
  (void)state;
  olx_scene *scene = load_hall(false);
  olx_place_settings settings = hall_settings(scene);
  settings.threads = 1;
  olx_probe_set one = place(scene, &settings);
  settings.threads = 3;
  olx_probe_set three = place(scene, &settings);
  assert_int_equal(one.report.tiles, 2);
  assert_true(one.report.voxel_metres == 0.25f);
  assert_true(one.report.coverage > 0.997);
  assert_true(one.report.unreached_m2 == 0.0);
  assert_true(same_probes(&one, &three));
  olx_probe_set_free(&one);
  olx_probe_set_free(&three);
  olx_scene_free(scene);
}

static void a_count_is_kept_in_tiles(void **state) {
  (void)state;
  olx_scene *scene = load_hall(false);
  olx_place_settings settings = hall_settings(scene);
  settings.count = 3;
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.count, 3);
  // Each probe covers a room, and what it sees of others through doors.
  assert_true(set.report.coverage > 0.55);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// A budget drops the last probes, which must be those that add least, not those of the last tile.
static void a_budget_lists_probes_by_what_they_add(void **state) {
  (void)state;
  olx_scene *scene = load_hall(false);
  olx_place_settings settings = hall_settings(scene);
  settings.resolution = 64;
  settings.budget_mb = 100.0;
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.report.tiles, 2);
  uint32_t back = 0; // from a later tile to an earlier one
  for (uint32_t i = 1; i < set.count; i++) {
    back += set.probes[i - 1].position.x > 0.6f * HALL_LENGTH && set.probes[i].position.x < 0.4f * HALL_LENGTH;
  }
  assert_true(back > 0);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// The uncovered area is that of the sealed room's inner surfaces: floor, ceiling, two long walls and two short ones.
static void a_sealed_room_is_told_in_square_metres(void **state) {
  (void)state;
  const double room = 2.0 * (double)(ROOM_LENGTH * HALL_WIDTH + ROOM_LENGTH * HALL_HEIGHT + HALL_WIDTH * HALL_HEIGHT);
  olx_scene *scene = load_hall(true);
  const olx_place_settings settings = hall_settings(scene);
  olx_probe_set set = place(scene, &settings);
  assert_close(set.report.unreached_m2, room, 0.05 * room, "surface that is not reached");
  assert_close(set.report.reached_m2, 4.0 * room, 0.1 * room, "surface that is reached");
  for (uint32_t i = 0; i < set.count; i++) assert_true(set.probes[i].position.x < 4.0f * ROOM_LENGTH);
  olx_probe_set_free(&set);
  // A pinned probe makes the sealed room count as reached.
  olx_probe_rules *rules = &scene->probe_rules;
  rules->pinned = olx_allocate(1, sizeof *rules->pinned);
  assert_non_null(rules->pinned);
  rules->pinned[0] = olx_v3(4.5f * ROOM_LENGTH, 1.0f, 2.5f);
  rules->pinned_count = 1;
  set = place(scene, &settings);
  assert_true(set.report.unreached_m2 == 0.0);
  assert_true(set.report.coverage > 0.997);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// Voxels as large as doors close them, so that four rooms are not reached, and never count as covered.
static void coarse_voxels_close_doors(void **state) {
  (void)state;
  olx_scene *scene = load_hall(false);
  olx_place_settings settings = hall_settings(scene);
  settings.voxel_size = 1.0f;
  olx_probe_set set = place(scene, &settings);
  assert_int_equal(set.report.tiles, 1);
  assert_true(set.report.unreached_m2 > 3.5 * set.report.reached_m2);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

// A box may hold space that no viewer reaches, in tiles of its own.
static void a_playable_box_may_hold_tiles_without_space(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const uint32_t m = matte(scene), materials[6] = {m, m, m, m, m, m};
  for (int room = 0; room < 2; room++) {
    const float x = 94.0f * (float)room;
    ASSERT_OK(olx_add_room(scene, room ? "far" : "near", olx_v3(x, 0, 0), olx_v3(x + 6, 3, 6), materials));
  }
  const olx_camera camera = tiny_camera(olx_v3(1, 1.5f, 1), olx_v3(5, 1.5f, 5), 60.0f);
  ASSERT_OK(olx_scene_add_camera(scene, &camera));
  made_finish(scene);
  scene->probe_rules.has_playable = true;
  scene->probe_rules.playable = (olx_box){{0.1f, 0.1f, 0.1f}, {99.9f, 2.9f, 5.9f}};
  const olx_place_settings settings = hall_settings(scene);
  olx_probe_set set = place(scene, &settings);
  assert_true(set.report.tiles > 1);
  for (uint32_t i = 0; i < set.count; i++) assert_true(set.probes[i].position.x < 6.0f);
  olx_probe_set_free(&set);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(floods_by_bricks_reach_what_floods_by_voxels_reach),
      cmocka_unit_test(the_order_of_tiles_does_not_matter),
      cmocka_unit_test(tiles_cover_a_hall_with_any_number_of_threads),
      cmocka_unit_test(a_count_is_kept_in_tiles),
      cmocka_unit_test(a_budget_lists_probes_by_what_they_add),
      cmocka_unit_test(a_sealed_room_is_told_in_square_metres),
      cmocka_unit_test(coarse_voxels_close_doors),
      cmocka_unit_test(a_playable_box_may_hold_tiles_without_space),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
