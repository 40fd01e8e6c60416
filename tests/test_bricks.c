// Tests bricks: how cells of space list the probes that see them, and how these lists are read.
#include "made_scenes.h"

#include "bake/selectors/bricks_build.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"
#include "select/bricks.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { ROOM = 4, MOST = 1000 };

// Makes a room 4 m wide. With `wall`, a two-sided sheet at x = 1.7 divides it except for a slot under the ceiling, y >
// 3.
static olx_scene *room(bool wall) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t index = made_material(scene, &material);
  made_room(scene, olx_splat(0.5f * ROOM), ROOM, index);
  if (wall) made_quad(scene, olx_v3(1.7f, 1.5f, 2.0f), olx_v3(0, 3, 0), olx_v3(0, 0, 4), index);
  return made_finish(scene);
}

static olx_vec3 place(uint32_t seed, uint32_t i) {
  const olx_vec2 xy = made_random(seed, 2 * i), z = made_random(seed, 2 * i + 1);
  return olx_scale(olx_v3(0.02f + 0.96f * xy.x, 0.02f + 0.96f * xy.y, 0.02f + 0.96f * z.x), ROOM);
}

typedef struct made_bricks {
  void *data;
  size_t size_bytes;
  olx_bricks bricks;
  olx_vec3 probes[MOST];
  uint32_t count;
} made_bricks;

static void build(const olx_scene *scene, uint32_t count, const uint8_t *flags, uint32_t size, uint32_t threads,
                  made_bricks *made) {
  static const uint8_t none[MOST];
  made->count = count;
  for (uint32_t i = 0; i < count; i++) made->probes[i] = place(1, i);
  const olx_selector_input input = {.scene = scene,
                                    .positions = made->probes,
                                    .flags = flags ? flags : none,
                                    .count = count,
                                    .radiance_size = size,
                                    .map_bytes = (uint64_t)count * (size + 2) * (size + 2) * 8,
                                    .distance_scale = olx_length(olx_splat(ROOM)),
                                    .threads = threads};
  if (olx_bricks_build(&input, &made->data, &made->size_bytes) != OLX_OK ||
      olx_bricks_open(made->data, made->size_bytes, count, "test", &made->bricks) != OLX_OK) {
    fail_msg("%s", olx_last_error());
  }
}

static void release(made_bricks *made) { olx_release(made->data); }

static bool sees(const olx_scene *scene, olx_vec3 probe, olx_vec3 point) {
  const olx_ray ray = {.origin = probe, .direction = olx_sub(point, probe), .t_min = 0.0f, .t_max = 1.0f};
  return !olx_bvh_occluded(scene->bvh, &ray);
}

static bool lists(const uint32_t *list, uint32_t probe) {
  for (uint32_t i = 0; i < OLX_BRICK_PROBES; i++) {
    if (olx_bricks_probe(list, i) == probe) return true;
  }
  return false;
}

// ---- what lists promise

// Returns a random point of the cell that contains `point`, or of its brick when the brick has no cells.
static olx_vec3 neighbour(const made_bricks *made, olx_vec3 point, uint32_t i) {
  const olx_bricks_header *h = made->bricks.header;
  const olx_vec3 origin = olx_v3(h->origin[0], h->origin[1], h->origin[2]);
  const float brick = h->cell_metres * OLX_BRICK_SIDE;
  const olx_vec3 at = olx_scale(olx_sub(point, origin), 1.0f / brick);
  const uint32_t index = (uint32_t)at.x + h->size[0] * ((uint32_t)at.y + h->size[1] * (uint32_t)at.z);
  const float side = made->bricks.index[index] & OLX_BRICK_DIVIDED ? h->cell_metres : brick;
  const olx_vec3 sides = olx_scale(olx_sub(point, origin), 1.0f / side);
  const olx_vec3 corner = olx_v3(floorf(sides.x), floorf(sides.y), floorf(sides.z));
  const olx_vec2 xy = made_random(71, 2 * i), z = made_random(71, 2 * i + 1);
  return olx_madd(origin, olx_add(corner, olx_v3(xy.x, xy.y, z.x)), side);
}

// Returns whether the line of sight clears the wall, or misses the slot by no more than a texel, in height or in depth;
// a texel spans at most `texel` radians.
static bool nearly_sees(olx_vec3 probe, olx_vec3 point, float texel) {
  if ((probe.x < 1.7f) == (point.x < 1.7f)) return true;
  const olx_vec3 way = olx_sub(point, probe);
  const olx_vec3 crossing = olx_madd(probe, way, (1.7f - probe.x) / way.x);
  const float footprint = texel * olx_length(olx_sub(crossing, probe));
  return crossing.y > 3.0f - footprint || fabsf(point.x - 1.7f) < footprint;
}

static bool sees_part_of_cell(const made_bricks *made, uint32_t probe, olx_vec3 point, float texel) {
  for (uint32_t i = 0; i < 200; i++) {
    if (nearly_sees(made->probes[probe], neighbour(made, point, i), texel)) return true;
  }
  return false;
}

static void test_listed_probes_see_their_cell(void **state) {
  (void)state;
  olx_scene *scene = room(true);
  static made_bricks made;
  build(scene, 12, NULL, 128, 2, &made);
  uint32_t checked = 0;
  for (uint32_t i = 0; i < 2000; i++) {
    const olx_vec3 point = place(2, i);
    const uint32_t *list = olx_bricks_list(&made.bricks, point);
    for (uint32_t k = 0; k < OLX_BRICK_PROBES; k++) {
      const uint32_t probe = olx_bricks_probe(list, k);
      if (probe == OLX_BRICK_NO_PROBE) break;
      if (!sees_part_of_cell(&made, probe, point, 1.4f * 3.5449f / 128.0f))
        fail_msg("probe %u does not see the cell of point %u", probe, i);
      checked++;
    }
  }
  assert_true(checked > 4000);
  release(&made);
  olx_scene_free(scene);
}

// At least one probe of a point's list sees the point itself, and nearly always the nearest probe that sees it is
// listed.
static void test_what_is_seen_lists_who_sees_it(void **state) {
  (void)state;
  olx_scene *scene = room(true);
  static made_bricks made;
  build(scene, 12, NULL, 128, 2, &made);
  uint32_t seen = 0, unlisted = 0, nearest_listed = 0;
  for (uint32_t i = 0; i < 20000; i++) {
    const olx_vec3 point = place(3, i);
    const uint32_t *list = olx_bricks_list(&made.bricks, point);
    uint32_t nearest = OLX_BRICK_NO_PROBE;
    float least = INFINITY;
    bool listed = false;
    for (uint32_t probe = 0; probe < made.count; probe++) {
      if (!sees(scene, made.probes[probe], point)) continue;
      listed |= lists(list, probe);
      const float distance = olx_length(olx_sub(made.probes[probe], point));
      if (distance >= least) continue;
      least = distance;
      nearest = probe;
    }
    if (nearest == OLX_BRICK_NO_PROBE) continue;
    seen++;
    unlisted += !listed;
    nearest_listed += lists(list, nearest);
  }
  assert_true(seen > 19000);
  assert_int_equal(unlisted, 0);
  assert_true(nearest_listed > 0.99 * seen);
  release(&made);
  olx_scene_free(scene);
}

// In an empty room every probe sees everything: lists hold the nearest probe, and no probe twice.
static void test_the_nearest_is_listed_where_all_see(void **state) {
  (void)state;
  olx_scene *scene = room(false);
  static made_bricks made;
  build(scene, 40, NULL, 64, 2, &made);
  uint32_t nearest_listed = 0;
  for (uint32_t i = 0; i < 4000; i++) {
    const olx_vec3 point = place(4, i);
    const uint32_t *list = olx_bricks_list(&made.bricks, point);
    uint32_t nearest = 0;
    for (uint32_t probe = 1; probe < made.count; probe++) {
      const float a = olx_length(olx_sub(made.probes[probe], point)),
                  b = olx_length(olx_sub(made.probes[nearest], point));
      if (a < b) nearest = probe;
    }
    nearest_listed += lists(list, nearest);
    for (uint32_t k = 0; k < OLX_BRICK_PROBES; k++) {
      assert_true(olx_bricks_probe(list, k) < made.count); // forty probes see the point, so the list is full with eight
      for (uint32_t l = 0; l < k; l++) assert_true(olx_bricks_probe(list, l) != olx_bricks_probe(list, k));
    }
  }
  assert_true(nearest_listed > 0.99 * 4000);
  release(&made);
  olx_scene_free(scene);
}

static void test_buried_probes_are_never_listed(void **state) {
  (void)state;
  olx_scene *scene = room(true);
  uint8_t flags[MOST] = {0};
  static made_bricks made;
  for (uint32_t i = 0; i < 12; i += 2) flags[i] = OLX_PROBE_BURIED;
  build(scene, 12, flags, 32, 1, &made);
  for (uint32_t i = 0; i < 1000; i++) {
    const uint32_t *list = olx_bricks_list(&made.bricks, place(5, i));
    for (uint32_t k = 0; k < OLX_BRICK_PROBES; k++) {
      const uint32_t probe = olx_bricks_probe(list, k);
      assert_true(probe == OLX_BRICK_NO_PROBE || probe % 2 == 1);
    }
  }
  release(&made);
  for (uint32_t i = 0; i < 12; i++) flags[i] = OLX_PROBE_BURIED;
  build(scene, 12, flags, 32, 1, &made);
  assert_int_equal(olx_bricks_probe(olx_bricks_list(&made.bricks, place(5, 0)), 0), OLX_BRICK_NO_PROBE);
  release(&made);
  olx_scene_free(scene);
}

// ---- size and repeatability

static void test_the_budget_is_kept(void **state) {
  (void)state;
  assert_int_equal(olx_bricks_budget(0), 4096);
  assert_int_equal(olx_bricks_budget(100 * 1000 * 1000), 4 * 1000 * 1000);
  assert_int_equal(olx_bricks_budget(10 * 1000 * 1000), 400 * 1000);
  assert_int_equal(olx_bricks_budget(UINT64_MAX), 4 * 1000 * 1000);
  olx_scene *scene = room(true);
  static made_bricks made;
  const uint32_t counts[] = {1, 2, 30, MOST}, sizes[] = {8, 16, 64};
  for (uint32_t i = 0; i < 4; i++) {
    for (uint32_t k = 0; k < 3; k++) {
      build(scene, counts[i], NULL, sizes[k], 2, &made);
      assert_true(made.size_bytes <= olx_bricks_budget((uint64_t)counts[i] * (sizes[k] + 2) * (sizes[k] + 2) * 8));
      release(&made);
    }
  }
  olx_scene_free(scene);
}

static void test_one_probe_is_listed_wherever_it_sees(void **state) {
  (void)state;
  olx_scene *scene = room(false);
  static made_bricks made;
  build(scene, 1, NULL, 32, 1, &made);
  for (uint32_t i = 0; i < 1000; i++) {
    const uint32_t *list = olx_bricks_list(&made.bricks, place(6, i));
    assert_int_equal(olx_bricks_probe(list, 0), 0);
    assert_int_equal(olx_bricks_probe(list, 1), OLX_BRICK_NO_PROBE);
  }
  release(&made);
  olx_scene_free(scene);
}

static void test_threads_do_not_matter(void **state) {
  (void)state;
  olx_scene *scene = room(true);
  static made_bricks one, other;
  build(scene, 30, NULL, 32, 1, &one);
  const uint32_t threads[] = {2, 5};
  for (uint32_t i = 0; i < 2; i++) {
    build(scene, 30, NULL, 32, threads[i], &other);
    assert_int_equal(one.size_bytes, other.size_bytes);
    assert_memory_equal(one.data, other.data, one.size_bytes);
    release(&other);
  }
  release(&one);
  olx_scene_free(scene);
}

// A probe under the open sky with nothing in sight still gets a structure, of one brick.
static void test_nothing_in_sight(void **state) {
  (void)state;
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_quad(scene, olx_v3(0, -1e4f, 0), olx_v3(1, 0, 0), olx_v3(0, 0, 1), made_material(scene, &material));
  made_finish(scene);
  static made_bricks made;
  build(scene, 1, NULL, 8, 1, &made);
  assert_int_equal(olx_bricks_probe(olx_bricks_list(&made.bricks, made.probes[0]), 0), 0);
  release(&made);
  olx_scene_free(scene);
}

// ---- hostile structures and places

static void test_any_place_has_a_list(void **state) {
  (void)state;
  olx_scene *scene = room(true);
  static made_bricks made;
  build(scene, 5, NULL, 32, 1, &made);
  const float values[] = {-1e30f, -INFINITY, NAN, 1e30f, INFINITY, 0.0f, -0.0f, 1e-45f, 4.0f, 3.9999998f};
  enum { VALUES = sizeof values / sizeof values[0] };
  for (uint32_t i = 0; i < VALUES * VALUES * VALUES; i++) {
    const olx_vec3 point = {values[i % VALUES], values[i / VALUES % VALUES], values[i / VALUES / VALUES]};
    const uint32_t *list = olx_bricks_list(&made.bricks, point);
    assert_true(list >= made.bricks.lists);
    assert_true(list < made.bricks.lists + (size_t)made.bricks.header->lists * OLX_BRICK_LIST_WORDS);
  }
  // Points outside the structure use the list of the nearest cell.
  assert_ptr_equal(olx_bricks_list(&made.bricks, olx_v3(-50, 1, 1)), olx_bricks_list(&made.bricks, olx_v3(0, 1, 1)));
  release(&made);
  olx_scene_free(scene);
}

static void refused(const made_bricks *made, size_t size_bytes, const char *message) {
  olx_bricks bricks;
  assert_int_equal(olx_bricks_open(made->data, size_bytes, made->count, "test", &bricks), OLX_ERROR_FORMAT);
  if (!strstr(olx_last_error(), message)) fail_msg("\"%s\" where \"%s\" is wanted", olx_last_error(), message);
}

// Changes a word, checks that the structure is refused, and restores the word.
static void refused_with(made_bricks *made, const uint32_t *word, uint32_t value, const char *message) {
  uint32_t *words = made->data;
  const size_t at = (size_t)(word - words);
  const uint32_t old = words[at];
  words[at] = value;
  refused(made, made->size_bytes, message);
  words[at] = old;
}

static void test_corrupt_structures_are_refused(void **state) {
  (void)state;
  olx_scene *scene = room(true);
  static made_bricks made;
  build(scene, 6, NULL, 64, 1, &made);
  const uint32_t *words = made.data;
  const olx_bricks *b = &made.bricks;
  const uint32_t infinite = 0x7F800000u, sizes = 4, divided = 7, lists_at = 8, zero = 9;
  assert_true(b->header->divided > 0 && b->header->lists > 1);
  refused(&made, 0, "0 bytes");
  refused(&made, 63, "63 bytes");
  refused(&made, made.size_bytes - 4, "bricks");
  refused(&made, made.size_bytes + 64, "bricks");
  for (uint32_t axis = 0; axis < 3; axis++) {
    refused_with(&made, words + axis, infinite, "origin");
    refused_with(&made, words + sizes + axis, 0, "0 bricks along");
    refused_with(&made, words + sizes + axis, 65537, "65537 bricks along");
    refused_with(&made, words + sizes + axis, b->header->size[axis] + 1, "bricks");
  }
  refused_with(&made, words + 3, 0, "cells of 0 metres");
  refused_with(&made, words + 3, infinite, "cells of inf metres");
  refused_with(&made, words + 3, 0xBF800000u, "cells of -1 metres");
  refused_with(&made, words + 3, 1, "cells of"); // a size so small that its inverse overflows
  refused_with(&made, words + divided, UINT32_MAX, "divided");
  refused_with(&made, words + lists_at, 0, "0 lists");
  refused_with(&made, words + lists_at, 65537, "65537 lists");
  refused_with(&made, words + zero, 1, "reserved");
  refused_with(&made, words + 15, 1, "reserved");
  refused_with(&made, b->index, b->header->lists, "brick 0");
  refused_with(&made, b->index, OLX_BRICK_DIVIDED | b->header->divided, "brick 0");
  if (b->header->lists <= 0xFFFF) {
    refused_with(&made, b->cells, b->header->lists, "cells");
    refused_with(&made, b->cells, b->header->lists << 16, "cells");
  }
  refused_with(&made, b->lists, 6, "names probe 6");
  refused_with(&made, b->lists, 0xFFFFu, "after its end");
  refused_with(&made, b->lists, 3u << 16 | 3u, "probe 3 twice");
  made.count = 65536;
  refused(&made, made.size_bytes, "chunk BRIK: for at most 65535 probes, not 65536");
  made.count = 65535;
  assert_int_equal(olx_bricks_open(made.data, made.size_bytes, made.count, "test", &made.bricks), OLX_OK);
  release(&made);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_listed_probes_see_their_cell),
      cmocka_unit_test(test_what_is_seen_lists_who_sees_it),
      cmocka_unit_test(test_the_nearest_is_listed_where_all_see),
      cmocka_unit_test(test_buried_probes_are_never_listed),
      cmocka_unit_test(test_the_budget_is_kept),
      cmocka_unit_test(test_one_probe_is_listed_wherever_it_sees),
      cmocka_unit_test(test_threads_do_not_matter),
      cmocka_unit_test(test_nothing_in_sight),
      cmocka_unit_test(test_any_place_has_a_list),
      cmocka_unit_test(test_corrupt_structures_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
