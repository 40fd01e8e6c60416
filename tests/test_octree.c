// Tests the octree selector (Wang 2018, section 4.2): leaves contain their points and end at surfaces, and each lists
// the four best of the probes that see it.
#include "bake/selectors/octree_build.h"
#include "core/hooks.h"
#include "made_scenes.h"
#include "scene/scene_build.h"
#include "select/octree.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 400, LEVELS = 5, SIZE = 1 << LEVELS };

typedef struct made_field {
  olx_field field;
  uint8_t flags[MOST];
} made_field;

static void build(const olx_scene *scene, const olx_vec3 *positions, const uint8_t *flags, uint32_t count,
                  uint32_t threads, made_field *f) {
  memset(f, 0, sizeof *f);
  if (flags) memcpy(f->flags, flags, count);
  f->field.info.probes.count = count;
  f->field.info.scene.bounds_min = scene->bounds_min;
  f->field.info.scene.bounds_max = scene->bounds_max;
  f->field.probe_positions = positions;
  f->field.probe_flags = f->flags;
  f->field.name = (char *)(uintptr_t) "made";
  const olx_selector_input input = {.scene = scene,
                                    .positions = positions,
                                    .flags = f->flags,
                                    .count = count,
                                    .radiance_size = SIZE,
                                    .threads = threads};
  void *data;
  if (olx_octree_build(&input, &data, &f->field.select_bytes[OLX_SELECT_OCTREE]) != OLX_OK) {
    fail_msg("%s", olx_last_error());
  }
  f->field.select_data[OLX_SELECT_OCTREE] = data;
  if (olx_octree_check(&f->field) != OLX_OK) fail_msg("%s", olx_last_error());
  if (olx_octree_verify(&f->field) != OLX_OK) fail_msg("%s", olx_last_error());
}

static void release(made_field *f) { olx_release((void *)(uintptr_t)f->field.select_data[OLX_SELECT_OCTREE]); }

static olx_octree_header *header_of(const made_field *f) {
  return (void *)(uintptr_t)f->field.select_data[OLX_SELECT_OCTREE];
}
static uint32_t *nodes_of(const made_field *f) { return (uint32_t *)(header_of(f) + 1); }

// Makes a room of 4 m a side, with its low corner at the origin.
static olx_scene *make_room(void) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  made_room(scene, olx_splat(2.0f), 4.0f, made_material(scene, &material));
  return scene;
}

static olx_vec3 inside(uint32_t seed, uint32_t i) {
  const olx_vec2 a = made_random(seed, 2 * i), b = made_random(seed, 2 * i + 1);
  return olx_v3(4.0f * a.x, 4.0f * a.y, 4.0f * b.x);
}

// ---- walking the tree, by halving boxes

typedef struct leaf {
  olx_vec3 low;
  float side;
  uint32_t level, ordinal;
  uint32_t choices[OLX_CHOICES];
} leaf;

typedef void (*visitor)(const made_field *f, const leaf *l, void *user);

static void walk(const made_field *f, uint32_t node, leaf l, visitor visit, void *user) {
  const uint32_t value = nodes_of(f)[node];
  if (value & OLX_OCTREE_LEAF) {
    l.ordinal = value & ~OLX_OCTREE_LEAF;
    olx_octree_choices(&f->field, l.ordinal, l.choices);
    visit(f, &l, user);
    return;
  }
  for (uint32_t child = 0; child < 8; child++) {
    leaf inner = {.side = 0.5f * l.side, .level = l.level + 1};
    inner.low = olx_madd(l.low, olx_v3(child & 1u ? 1.0f : 0.0f, child & 2u ? 1.0f : 0.0f, child & 4u ? 1.0f : 0.0f),
                         inner.side);
    walk(f, value + child, inner, visit, user);
  }
}

static void walk_all(const made_field *f, visitor visit, void *user) {
  const leaf root = {.low = f->field.info.scene.bounds_min,
                     .side = olx_max3(olx_sub(f->field.info.scene.bounds_max, f->field.info.scene.bounds_min))};
  walk(f, 0, root, visit, user);
}

static olx_vec3 middle_of(const leaf *l) { return olx_add(l->low, olx_splat(0.5f * l->side)); }

// Returns whether the leaf touches a wall of the room, one of the planes at 0 and 4.
static bool touches_wall(const leaf *l) {
  const float far = 4.0f - 1e-4f;
  return l->low.x <= 1e-4f || l->low.y <= 1e-4f || l->low.z <= 1e-4f || l->low.x + l->side >= far ||
         l->low.y + l->side >= far || l->low.z + l->side >= far;
}

// ---- the tree

static void find_own_points(const made_field *f, const leaf *l, void *user) {
  uint32_t *leaves = user;
  for (uint32_t i = 0; i < 9; i++) {
    const olx_vec3 share = {i & 1u ? 0.99f : 0.01f, i & 2u ? 0.99f : 0.01f, i & 4u ? 0.99f : 0.01f};
    const olx_vec3 point = i == 8 ? middle_of(l) : olx_madd(l->low, share, l->side);
    assert_int_equal(olx_octree_leaf(&f->field, point), l->ordinal);
  }
  (*leaves)++;
}

static void test_a_points_leaf_contains_it(void **state) {
  (void)state;
  olx_scene *scene = made_finish(make_room());
  const olx_vec3 probe = {1.3f, 2.2f, 1.9f};
  static made_field f;
  build(scene, &probe, NULL, 1, 1, &f);
  uint32_t leaves = 0;
  walk_all(&f, find_own_points, &leaves);
  assert_int_equal(leaves, 1 + 7 * header_of(&f)->inner_nodes);
  // For a point outside the root the nearest leaf is returned; for a point that is not finite, any leaf.
  assert_int_equal(olx_octree_leaf(&f.field, olx_v3(-5, -INFINITY, -1e30f)), olx_octree_leaf(&f.field, olx_splat(0)));
  assert_int_equal(olx_octree_leaf(&f.field, olx_v3(2, 9, 2)), olx_octree_leaf(&f.field, olx_v3(2, 3.999f, 2)));
  assert_in_range(olx_octree_leaf(&f.field, olx_splat(NAN)), 0, 7 * header_of(&f)->inner_nodes);
  release(&f);
  olx_scene_free(scene);
}

static void check_size(const made_field *f, const leaf *l, void *user) {
  (void)f;
  uint32_t *counts = user;
  if (touches_wall(l)) assert_int_equal(l->level, LEVELS);
  counts[touches_wall(l)]++;
}

// Voxels on walls have the finest level, and only they cause subdivisions: no leaf has seven empty siblings.
static void test_leaves_end_at_surfaces(void **state) {
  (void)state;
  olx_scene *scene = made_finish(make_room());
  const olx_vec3 probe = {1.3f, 2.2f, 1.9f};
  static made_field f;
  build(scene, &probe, NULL, 1, 1, &f);
  uint32_t counts[2] = {0};
  walk_all(&f, check_size, counts);
  const uint32_t shell = SIZE * SIZE * SIZE - (SIZE - 2) * (SIZE - 2) * (SIZE - 2);
  assert_int_equal(counts[1], shell);
  // A shell of each level but the last is subdivided, and each subdivision adds seven leaves.
  uint32_t inner = 1;
  for (uint32_t side = 2; side < SIZE; side *= 2) inner += side * side * side - (side - 2) * (side - 2) * (side - 2);
  assert_int_equal(header_of(&f)->inner_nodes, inner);
  assert_int_equal(counts[0] + counts[1], 1 + 7 * inner);
  release(&f);
  olx_scene_free(scene);
}

static void test_resolution_follows_the_maps(void **state) {
  (void)state;
  assert_int_equal(olx_octree_levels(8), 3);
  assert_int_equal(olx_octree_levels(64), 6);
  assert_int_equal(olx_octree_levels(512), 9);
  assert_int_equal(olx_octree_levels(2048), 9);
}

// ---- ranks

typedef struct ranking {
  const olx_vec3 *probes;
  uint32_t count, checked;
  bool (*sees)(olx_vec3 probe, const leaf *l); // NULL when every probe sees everything
} ranking;

// Returns a leaf's score from its definition: n . p / d on walls, 1 / d in free space, and 0 for leaves at edges, whose
// normal is a mean.
static float score_of(const leaf *l, olx_vec3 probe) {
  const olx_vec3 offset = olx_sub(probe, middle_of(l));
  const float distance = olx_length(offset);
  if (!touches_wall(l)) return 1.0f / distance;
  const float low[3] = {l->low.x, l->low.y, l->low.z}, along[3] = {offset.x, offset.y, offset.z};
  float score = 0.0f;
  uint32_t walls = 0;
  for (int axis = 0; axis < 3; axis++) {
    if (low[axis] > 1e-4f && low[axis] + l->side < 4.0f - 1e-4f) continue;
    walls++;
    score = fabsf(along[axis]) / (distance * distance);
  }
  return walls == 1 ? score : 0.0f;
}

static void check_ranks(const made_field *f, const leaf *l, void *user) {
  (void)f;
  ranking *r = user;
  const bool in_edge = touches_wall(l) && score_of(l, olx_v3(2.1f, 2.2f, 1.7f)) == 0.0f;
  if (in_edge) return;
  float last = INFINITY;
  uint32_t known = 0;
  while (known < OLX_CHOICES && l->choices[known] != OLX_NO_PROBE) {
    const float score = score_of(l, r->probes[l->choices[known]]);
    assert_true(score <= last * (1.0f + 1e-5f));
    last = score;
    known++;
  }
  uint32_t seen = 0;
  for (uint32_t i = 0; i < r->count; i++) {
    const bool sees = !r->sees || r->sees(r->probes[i], l);
    seen += sees;
    bool chosen = false;
    for (uint32_t k = 0; k < known; k++) chosen |= l->choices[k] == i;
    if (!sees) assert_false(chosen);
    if (sees && !chosen) assert_true(score_of(l, r->probes[i]) <= last * (1.0f + 1e-5f));
  }
  assert_int_equal(known, seen < OLX_CHOICES ? seen : OLX_CHOICES);
  r->checked++;
}

// In an empty room every probe sees everything, so rank alone decides.
static void test_the_four_best_come_in_order(void **state) {
  (void)state;
  enum { COUNT = 20 };
  olx_scene *scene = made_finish(make_room());
  olx_vec3 probes[COUNT];
  for (uint32_t i = 0; i < COUNT; i++) probes[i] = olx_madd(olx_splat(0.4f), inside(1, i), 0.8f);
  static made_field f;
  build(scene, probes, NULL, COUNT, 1, &f);
  ranking r = {.probes = probes, .count = COUNT};
  walk_all(&f, check_ranks, &r);
  assert_true(r.checked > 6 * 30 * 30);
  release(&f);
  // With fewer than four probes, all are listed, followed by no probe. Buried probes are left out.
  const uint8_t flags[COUNT] = {0, OLX_PROBE_BURIED, 0};
  build(scene, probes, flags, 3, 1, &f);
  for (uint32_t i = 0; i < 200; i++) {
    uint32_t choices[OLX_CHOICES];
    olx_octree_choices(&f.field, olx_octree_leaf(&f.field, inside(2, i)), choices);
    assert_int_equal(choices[0] + choices[1], 2); // probes 0 and 2 in either order
    assert_true(choices[0] != 1 && choices[2] == OLX_NO_PROBE && choices[3] == OLX_NO_PROBE);
  }
  release(&f);
  olx_scene_free(scene);
}

// ---- visibility

// Returns whether a probe sees a leaf past a wall at x = 1.7 that reaches from side to side, with a slot under the
// ceiling at y > 3.
static bool sees_past_wall(olx_vec3 probe, const leaf *l) {
  const olx_vec3 p = middle_of(l);
  if ((probe.x < 1.7f) == (p.x < 1.7f)) return true;
  const float t = (1.7f - probe.x) / (p.x - probe.x);
  return probe.y + t * (p.y - probe.y) > 3.0f;
}

static void check_finest(const made_field *f, const leaf *l, void *user) {
  // Voxels that the wall crosses are seen from both sides, and coarser voxels count as seen when any of eight points
  // is.
  if (l->level < LEVELS || (l->low.x <= 1.7f && l->low.x + l->side >= 1.7f)) return;
  check_ranks(f, l, user);
}

static void test_probes_behind_walls_are_left_out(void **state) {
  (void)state;
  enum { COUNT = 12 };
  olx_scene *scene = make_room();
  const olx_material material = olx_material_default();
  made_quad(scene, olx_v3(1.7f, 1.5f, 2.0f), olx_v3(0, 3, 0), olx_v3(0, 0, 4), made_material(scene, &material));
  made_finish(scene);
  olx_vec3 probes[COUNT];
  for (uint32_t i = 0; i < COUNT; i++) probes[i] = olx_madd(olx_splat(0.41f), inside(3, i), 0.8f);
  static made_field f;
  build(scene, probes, NULL, COUNT, 1, &f);
  ranking r = {.probes = probes, .count = COUNT, .sees = sees_past_wall};
  walk_all(&f, check_finest, &r);
  assert_true(r.checked > 4000);
  release(&f);
  olx_scene_free(scene);
}

static void count_unseen(const made_field *f, const leaf *l, void *user) {
  (void)f;
  const bool beyond = l->low.x > 1.7f;
  uint32_t *counts = user;
  counts[beyond] += l->choices[0] == OLX_NO_PROBE;
}

// No probe sees a sealed room beside the probe's room, and its leaves list none.
static void test_what_nobody_sees_has_no_probe(void **state) {
  (void)state;
  olx_scene *scene = make_room();
  const olx_material material = olx_material_default();
  made_quad(scene, olx_v3(1.7f, 2.0f, 2.0f), olx_v3(0, 4, 0), olx_v3(0, 0, 4), made_material(scene, &material));
  made_finish(scene);
  const olx_vec3 probe = {0.8f, 2.0f, 2.0f};
  static made_field f;
  build(scene, &probe, NULL, 1, 1, &f);
  uint32_t unseen[2] = {0};
  walk_all(&f, count_unseen, unseen);
  assert_int_equal(unseen[0], 0);
  assert_true(unseen[1] > 1000);
  uint32_t choices[OLX_CHOICES];
  olx_octree_choices(&f.field, olx_octree_leaf(&f.field, olx_v3(3.5f, 2.0f, 2.0f)), choices);
  assert_int_equal(choices[0], OLX_NO_PROBE);
  release(&f);
  olx_scene_free(scene);
}

static void check_both_sides(const made_field *f, const leaf *l, void *user) {
  (void)f;
  if (!(l->low.x < 1.7f && l->low.x + l->side > 1.7f)) return;
  assert_int_equal(l->choices[0] + l->choices[1], 1);
  assert_int_equal(l->choices[2], OLX_NO_PROBE);
  (*(uint32_t *)user)++;
}

// A voxel that a thin wall crosses is seen from both sides of the wall, wherever in the voxel the wall is.
static void test_both_sides_of_a_wall_see_its_voxels(void **state) {
  (void)state;
  olx_scene *scene = make_room();
  const olx_material material = olx_material_default();
  made_quad(scene, olx_v3(1.7f, 2.0f, 2.0f), olx_v3(0, 4, 0), olx_v3(0, 0, 4), made_material(scene, &material));
  made_finish(scene);
  const olx_vec3 probes[2] = {{0.8f, 2.0f, 2.1f}, {3.3f, 1.9f, 2.0f}};
  static made_field f;
  build(scene, probes, NULL, 2, 1, &f);
  uint32_t leaves = 0;
  walk_all(&f, check_both_sides, &leaves);
  assert_int_equal(leaves, SIZE * SIZE);
  release(&f);
  olx_scene_free(scene);
}

static void test_bytes_do_not_depend_on_threads(void **state) {
  (void)state;
  static olx_vec3 probes[MOST];
  olx_scene *scene = made_finish(make_room());
  for (uint32_t i = 0; i < MOST; i++) probes[i] = inside(4, i);
  static made_field one, other;
  build(scene, probes, NULL, MOST, 1, &one); // with more than 255 probes, an index takes two bytes
  for (uint32_t threads = 2; threads <= 5; threads += 3) {
    build(scene, probes, NULL, MOST, threads, &other);
    assert_int_equal(one.field.select_bytes[OLX_SELECT_OCTREE], other.field.select_bytes[OLX_SELECT_OCTREE]);
    assert_memory_equal(one.field.select_data[OLX_SELECT_OCTREE], other.field.select_data[OLX_SELECT_OCTREE],
                        one.field.select_bytes[OLX_SELECT_OCTREE]);
    release(&other);
  }
  const uint32_t inner = header_of(&one)->inner_nodes;
  assert_int_equal(one.field.select_bytes[OLX_SELECT_OCTREE], 16 + 4 * (1 + 8 * inner) + 8 * (1 + 7 * inner));
  release(&one);
  olx_scene_free(scene);
}

// ---- what a file may not hold

static void test_spoilt_trees_are_refused(void **state) {
  (void)state;
  olx_scene *scene = made_finish(make_room());
  olx_vec3 probes[6];
  for (uint32_t i = 0; i < 6; i++) probes[i] = inside(5, i);
  static made_field f;
  build(scene, probes, NULL, 6, 1, &f);
  olx_field *field = &f.field;
  olx_octree_header *header = header_of(&f), good = *header;
  uint32_t *nodes = nodes_of(&f);
  size_t *bytes = &field->select_bytes[OLX_SELECT_OCTREE];
  const size_t whole = *bytes;
  const size_t sizes[] = {0, 15, 16, whole - 1, whole + 1, whole - 36};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    *bytes = sizes[i];
    assert_int_equal(olx_octree_check(field), OLX_ERROR_FORMAT);
  }
  *bytes = whole;
  const olx_octree_header bad_headers[] = {
      {0, good.inner_nodes, {0, 0}},      {11, good.inner_nodes, {0, 0}},    {LEVELS, 0, {0, 0}},
      {LEVELS, UINT32_MAX, {0, 0}},       {LEVELS, 0x20000000u + 1, {0, 0}}, {LEVELS, good.inner_nodes + 1, {0, 0}},
      {LEVELS, good.inner_nodes, {1, 0}}, {LEVELS, good.inner_nodes, {0, 1}}};
  for (size_t i = 0; i < sizeof bad_headers / sizeof bad_headers[0]; i++) {
    *header = bad_headers[i];
    assert_int_equal(olx_octree_check(field), OLX_ERROR_FORMAT);
  }
  *header = good;
  field->info.probes.count = 65536;
  assert_int_equal(olx_octree_check(field), OLX_ERROR_FORMAT);
  field->info.probes.count = 6;
  header->levels = LEVELS - 1; // a tree deeper than it says
  assert_int_equal(olx_octree_verify(field), OLX_ERROR_FORMAT);
  header->levels = LEVELS;

  // Invalid nodes: cycles to the root, to itself and to earlier nodes, children beyond the end, shared children, leaves
  // out of range and order.
  const uint32_t values[] = {0,
                             1,
                             2,
                             8,
                             9,
                             17,
                             8 * good.inner_nodes,
                             8 * good.inner_nodes + 1,
                             0x7FFFFFFFu,
                             0x80000000u,
                             0x80000000u | (7 * good.inner_nodes + 1),
                             UINT32_MAX};
  const uint32_t spoilt[] = {0, 1, 5, 8, 9, 100, 8 * good.inner_nodes};
  for (size_t n = 0; n < sizeof spoilt / sizeof spoilt[0]; n++) {
    const uint32_t was = nodes[spoilt[n]];
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
      nodes[spoilt[n]] = values[i];
      assert_int_equal(olx_octree_verify(field), values[i] == was ? OLX_OK : OLX_ERROR_FORMAT);
      for (uint32_t q = 0; q < 200; q++) {
        const uint32_t found = olx_octree_leaf(field, inside(6, q));
        assert_true(found <= 7 * good.inner_nodes || found == OLX_NO_LEAF);
        uint32_t choices[OLX_CHOICES];
        olx_octree_choices(field, found, choices);
      }
    }
    nodes[spoilt[n]] = was;
  }
  // The codes of the last leaf.
  uint8_t *codes = (uint8_t *)(nodes + 1 + 8 * good.inner_nodes) + 4 * 7 * good.inner_nodes;
  const uint8_t bad[][4] = {{6, 0, 1, 2}, {0, 1, 2, 254}, {3, 1, 2, 3}, {255, 0, 1, 2}, {0, 1, 255, 2}};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    memcpy(codes, bad[i], 4);
    assert_int_equal(olx_octree_verify(field), OLX_ERROR_FORMAT);
    assert_non_null(strstr(olx_last_error(), "names what is no choice"));
    uint32_t choices[OLX_CHOICES];
    olx_octree_choices(field, 7 * good.inner_nodes, choices);
    for (uint32_t k = 0; k < OLX_CHOICES; k++) assert_true(choices[k] < 6 || choices[k] == OLX_NO_PROBE);
  }
  const uint8_t none[4] = {255, 255, 255, 255};
  memcpy(codes, none, 4);
  assert_int_equal(olx_octree_verify(field), OLX_OK);
  release(&f);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_points_leaf_contains_it),
      cmocka_unit_test(test_leaves_end_at_surfaces),
      cmocka_unit_test(test_resolution_follows_the_maps),
      cmocka_unit_test(test_the_four_best_come_in_order),
      cmocka_unit_test(test_probes_behind_walls_are_left_out),
      cmocka_unit_test(test_what_nobody_sees_has_no_probe),
      cmocka_unit_test(test_both_sides_of_a_wall_see_its_voxels),
      cmocka_unit_test(test_bytes_do_not_depend_on_threads),
      cmocka_unit_test(test_spoilt_trees_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
