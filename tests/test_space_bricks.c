// Tests bricks of space: a ray crosses the bricks that its points lie in, and a ray that crosses no brick whose
// geometry was edited finds the same as before.
#include "core/sampling.h"
#include "made_scenes.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"
#include "scene/scene_parts.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { BOXES = 40, RAYS = 20000, STEPS = 50 };

static olx_vec3 random_point(uint32_t seed, uint32_t index) {
  const olx_vec2 a = made_random(seed, 2 * index), b = made_random(seed, 2 * index + 1);
  return olx_v3(8.0f * a.x, 3.0f * a.y, 5.0f * b.x);
}

static olx_ray random_ray(uint32_t index) {
  return (olx_ray){random_point(7, index), olx_sample_sphere(made_random(8, index)), 0.0f, INFINITY};
}

// A room with small boxes, the first of which is moved by `shift`.
static olx_scene *room_with_boxes(float shift) {
  olx_scene *scene = made_scene();
  const olx_material material = olx_material_default();
  const uint32_t index = made_material(scene, &material);
  made_box(scene, olx_splat(0.0f), olx_v3(8.0f, 3.0f, 5.0f), false, index);
  for (uint32_t i = 0; i < BOXES; i++) {
    olx_vec3 low = olx_scale(random_point(3, i), 0.9f);
    if (i == 0) low = olx_v3(2.0f + shift, 0.5f, 2.0f);
    made_box(scene, low, olx_add(low, olx_splat(0.2f)), true, index);
  }
  return made_finish(scene);
}

static bool has(const olx_brick_set *set, const olx_space_bricks *b, olx_vec3 p) {
  const olx_brick_range near = olx_space_bricks_near(b, p, p);
  for (uint32_t z = near.first[2]; z <= near.last[2]; z++) {
    for (uint32_t y = near.first[1]; y <= near.last[1]; y++) {
      for (uint32_t x = near.first[0]; x <= near.last[0]; x++) {
        const uint32_t brick = olx_space_brick(b, x, y, z);
        if (set->words[brick / 64] >> brick % 64 & 1u) return true;
      }
    }
  }
  return false;
}

static void rays_cross_the_bricks_of_their_points(void **state) {
  (void)state;
  const olx_space_bricks b = olx_space_bricks_make(olx_splat(0.0f), olx_v3(8.0f, 3.0f, 5.0f));
  assert_int_equal(b.count[0] * b.count[1] * b.count[2], OLX_SPACE_BRICKS);
  uint32_t crossed = 0;
  for (uint32_t i = 0; i < RAYS / 10; i++) {
    const olx_ray ray = random_ray(i);
    const float length = 2.0f * made_random(9, i).x;
    olx_brick_set set = {0};
    olx_space_bricks_cross(&b, ray.origin, ray.direction, length, &set);
    for (uint32_t k = 0; k <= STEPS; k++) {
      const olx_vec3 p = olx_madd(ray.origin, ray.direction, length * (float)k / STEPS);
      if (olx_max3(olx_sub(p, b.high)) > 0.0f || olx_max3(olx_sub(b.low, p)) > 0.0f) break;
      assert_true(has(&set, &b, p));
    }
    for (uint32_t k = 0; k < OLX_BRICK_WORDS; k++) crossed += (uint32_t)__builtin_popcountll(set.words[k]);
  }
  // A metre on average crosses three bricks of about 0.8 m, and not many more.
  assert_true(crossed < 4 * RAYS / 10);
  olx_brick_set set = {0};
  olx_space_bricks_cross(&b, olx_v3(-1.0f, 1.0f, 1.0f), olx_v3(-1.0f, 0.0f, 0.0f), INFINITY, &set);
  for (uint32_t k = 0; k < OLX_BRICK_WORDS; k++) assert_int_equal(set.words[k], 0);
}

static olx_scene_inputs inputs_of(const olx_scene *scene) {
  olx_scene_inputs inputs;
  assert_int_equal(olx_scene_hash_inputs(scene, &inputs), OLX_OK);
  return inputs;
}

static void rays_past_edited_bricks_find_the_same(void **state) {
  (void)state;
  olx_scene *scene = room_with_boxes(0.0f), *edited = room_with_boxes(0.3f);
  const olx_scene_inputs before = inputs_of(scene), after = inputs_of(edited);
  olx_brick_set changed = {0};
  uint32_t bricks = 0, passed = 0, differ = 0;
  for (uint32_t i = 0; i < OLX_SPACE_BRICKS; i++) {
    changed.words[i / 64] |= (uint64_t)(before.bricks[i] != after.bricks[i]) << i % 64;
    bricks += before.bricks[i] != after.bricks[i];
  }
  assert_true(bricks >= 1 && bricks <= 8);
  olx_ray_log log = {.bricks = olx_space_bricks_make(scene->bounds_min, scene->bounds_max)};
  const olx_bvh recording = {.tree = scene->bvh->tree, .log = &log};
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_ray ray = random_ray(i);
    log.crossed = (olx_brick_set){0};
    const olx_ray_hit hit = olx_bvh_intersect(&recording, &ray), now = olx_bvh_intersect(edited->bvh, &ray);
    const bool same = memcmp(&hit, &now, sizeof hit) == 0;
    differ += !same;
    if (olx_brick_sets_meet(&log.crossed, &changed)) continue;
    passed++;
    assert_true(same);
  }
  assert_true(differ > 20 && passed > RAYS * 3 / 4);
  olx_scene_free(scene);
  olx_scene_free(edited);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rays_cross_the_bricks_of_their_points),
      cmocka_unit_test(rays_past_edited_bricks_find_the_same),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
