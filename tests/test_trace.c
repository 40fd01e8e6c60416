// Tests rays through analytic fields, for which the correct hits are known.
#include "analytic_field.h"

#include "core/sampling.h"
#include "select/sight.h"
#include "trace/probe_trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static const analytic_scene empty_room = {.room = {{0, 0, 0}, {4, 3, 5}}};
static const analytic_scene open_court = {.room = {{0, 0, 0}, {4, 3, 5}}, .open = true};
static const analytic_scene furnished = {
    .room = {{0, 0, 0}, {4, 3, 5}},
    .box_count = 2,
    .boxes = {{{0.9f, 0.0f, 1.1f}, {1.7f, 1.3f, 2.1f}}, {{2.3f, 0.0f, 2.6f}, {3.1f, 2.1f, 3.3f}}},
};
static const olx_grid single = {.origin = {1.9f, 1.4f, 2.7f}, .count = {1, 1, 1}};
static const olx_grid cage = {.origin = {0.5f, 0.5f, 0.5f}, .spacing = {3.0f, 2.0f, 4.0f}, .count = {2, 2, 2}};

static olx_vec3 random_direction(uint32_t i) { return olx_sample_sphere(olx_stratified2(i, 17)); }

static olx_vec3 random_point(uint32_t i, const analytic_scene *scene) {
  const olx_vec2 a = olx_stratified2(i, 3), b = olx_stratified2(i, 4);
  const olx_vec3 size = olx_sub(scene->room.max, scene->room.min);
  return olx_add(scene->room.min, olx_mul(size, olx_v3(0.05f + 0.9f * a.x, 0.05f + 0.9f * a.y, 0.05f + 0.9f * b.x)));
}

static bool inside_box(const analytic_scene *scene, olx_vec3 p) {
  for (uint32_t i = 0; i < scene->box_count; i++) {
    const analytic_box *b = &scene->boxes[i];
    if (p.x > b->min.x && p.y > b->min.y && p.z > b->min.z && p.x < b->max.x && p.y < b->max.y && p.z < b->max.z) {
      return true;
    }
  }
  return false;
}

// Returns whether some probe sees what a ray hits: the point, or the sky in the ray's direction.
static bool seen(const analytic_scene *scene, const olx_field *field, olx_vec3 o, olx_vec3 d, analytic_hit truth) {
  for (uint32_t i = 0; i < field->info.probes.count; i++) {
    const olx_vec3 probe = field->probe_positions[i];
    const olx_vec3 to = truth.t < INFINITY ? olx_sub(olx_madd(o, d, truth.t), probe) : d;
    const float t = analytic_cast(scene, probe, olx_normalize(to)).t;
    if (truth.t < INFINITY ? t > 0.999f * olx_length(to) : t == INFINITY) return true;
  }
  return false;
}

// Results of rays against the truth: of rays whose hit some probe sees, the shares that are unknown, and that are off
// by more than two footprints or 1 % of the way.
typedef struct score {
  double unknown, wrong, steps;
} score;

static score judge(const analytic_scene *scene, const olx_grid *grid, uint32_t n, olx_tracer tracer, uint32_t count) {
  olx_field *field = analytic_field_make(scene, grid, n, 16);
  olx_sample_settings settings = olx_sample_settings_default();
  settings.tracer = tracer;
  score s = {0};
  uint32_t asked = 0;
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec3 o = random_point(i, scene), d = random_direction(i);
    if (inside_box(scene, o)) continue;
    const analytic_hit truth = analytic_cast(scene, o, d);
    if (!seen(scene, field, o, d, truth)) continue;
    asked++;
    const olx_trace_hit hit = olx_trace(field, &settings, o, d, INFINITY);
    s.steps += hit.texel_steps;
    if (hit.status == OLX_TRACE_UNKNOWN) {
      s.unknown++;
      continue;
    }
    if ((hit.status == OLX_TRACE_MISS) != (truth.t == INFINITY)) s.wrong++;
    else if (truth.t < INFINITY &&
             fabsf(hit.distance_metres - truth.t) > olx_max(2.0f * hit.footprint_metres, 0.01f * truth.t))
      s.wrong++;
  }
  s.unknown /= asked;
  s.wrong /= asked;
  s.steps /= asked;
  analytic_field_free(field);
  return s;
}

static void one_probe_resolves_every_ray_in_a_convex_room(void **state) {
  (void)state;
  const score s = judge(&empty_room, &single, 128, OLX_TRACER_HIZ, 20000);
  print_message("unknown %.5f wrong %.5f steps %.1f\n", s.unknown, s.wrong, s.steps);
  assert_true(s.unknown < 1e-3);
  assert_true(s.wrong < 1e-3);
}

static void rays_through_an_open_ceiling_miss(void **state) {
  (void)state;
  const score s = judge(&open_court, &single, 512, OLX_TRACER_HIZ, 20000);
  print_message("unknown %.5f wrong %.5f steps %.1f\n", s.unknown, s.wrong, s.steps);
  assert_true(s.unknown < 0.002);
  assert_true(s.wrong < 0.005);
}

static void eight_probes_resolve_rays_around_furniture(void **state) {
  (void)state;
  const score s = judge(&furnished, &cage, 256, OLX_TRACER_HIZ, 20000);
  print_message("unknown %.5f wrong %.5f steps %.1f\n", s.unknown, s.wrong, s.steps);
  assert_true(s.unknown < 0.001);
  assert_true(s.wrong < 0.01);
}

// Rays without light end where rays with light do.
static void rays_for_visibility_alone_end_where_others_do(void **state) {
  (void)state;
  enum { RAYS = 256 };
  olx_field *field = analytic_field_make(&furnished, &cage, 64, 16);
  const olx_sample_settings settings = olx_sample_settings_default();
  olx_sample_settings alone = settings;
  alone.visibility_only = true;
  olx_vec3 origins[RAYS], directions[RAYS];
  for (uint32_t i = 0; i < RAYS; i++) origins[i] = random_point(i, &furnished), directions[i] = random_direction(i);
  olx_trace_hit together[RAYS];
  olx_trace_rays(field, &alone, RAYS, origins, directions, INFINITY, together);
  uint32_t lit = 0;
  for (uint32_t i = 0; i < RAYS; i++) {
    const olx_trace_hit whole = olx_trace(field, &settings, origins[i], directions[i], INFINITY),
                        hit = olx_trace(field, &alone, origins[i], directions[i], INFINITY);
    lit += whole.radiance.x > 0.0f || whole.emission.x > 0.0f;
    assert_int_equal(hit.status, whole.status);
    assert_true(hit.distance_metres == whole.distance_metres && hit.texel == whole.texel && hit.probe == whole.probe);
    assert_true(hit.normal.x == whole.normal.x && hit.texel_steps == whole.texel_steps);
    assert_true(olx_max3(hit.radiance) == 0.0f && olx_max3(hit.emission) == 0.0f && olx_max3(hit.lobe) == 0.0f);
    assert_true(together[i].distance_metres == hit.distance_metres && olx_max3(together[i].radiance) == 0.0f);
  }
  assert_true(lit > RAYS / 4);
  analytic_field_free(field);
}

// The bricks consist of one brick whose list names only probe 7. A ray that it loses asks at most two of the others;
// the reference asks on.
static void rays_ask_at_most_two_probes_that_no_list_names(void **state) {
  (void)state;
  olx_field *field = analytic_field_make(&furnished, &cage, 64, 16);
  const olx_bricks_header header = {.cell_metres = 10.0f, .size = {1, 1, 1}, .lists = 1};
  const uint32_t index[1] = {0}, list[OLX_BRICK_LIST_WORDS] = {0xFFFF0007u, ~0u, ~0u, ~0u};
  field->bricks = (olx_bricks){.header = &header, .index = index, .lists = list};
  field->info.select_mask |= 1u << OLX_SELECT_BRICKS;
  olx_sample_settings listed = olx_sample_settings_default(), all = listed;
  listed.select = OLX_SELECT_BRICKS;
  all.select = OLX_SELECT_EXHAUSTIVE;
  uint32_t asked[10] = {0}, most = 0;
  for (uint32_t i = 0; i < 5000; i++) {
    const olx_vec3 o = random_point(i, &furnished), d = random_direction(i);
    if (inside_box(&furnished, o)) continue;
    if (!olx_probe_sees(field, 7, o, OLX_SIGHT_START, &d)) continue; // its only search is that of all
    const olx_trace_hit hit = olx_trace(field, &listed, o, d, INFINITY),
                        by_all = olx_trace(field, &all, o, d, INFINITY);
    assert_true(hit.probes_tried <= 3);
    asked[hit.probes_tried]++;
    most = by_all.probes_tried > most ? by_all.probes_tried : most;
  }
  print_message("asked 1: %u, 2: %u, 3: %u; the reference at most %u\n", asked[1], asked[2], asked[3], most);
  assert_true(asked[1] > asked[2] && asked[2] > asked[3] && asked[3] > 0);
  assert_true(most > 3);
  analytic_field_free(field);
}

static void rays_along_axes_and_through_the_probe_end_where_they_should(void **state) {
  (void)state;
  olx_field *field = analytic_field_make(&empty_room, &single, 64, 16);
  const olx_sample_settings settings = olx_sample_settings_default();
  for (int32_t x = -1; x <= 1; x++) {
    for (int32_t y = -1; y <= 1; y++) {
      for (int32_t z = -1; z <= 1; z++) {
        if (!x && !y && !z) continue;
        const olx_vec3 d = olx_normalize(olx_v3((float)x, (float)y, (float)z));
        for (int32_t start = -2; start <= 2; start++) { // starts before, at and behind the probe's centre
          const olx_vec3 o = olx_madd(single.origin, d, 0.4f * (float)start);
          const olx_trace_hit hit = olx_trace(field, &settings, o, d, INFINITY);
          assert_int_equal(hit.status, OLX_TRACE_HIT);
          const float truth = analytic_cast(&empty_room, o, d).t;
          assert_true(fabsf(hit.distance_metres - truth) <= 2.0f * hit.footprint_metres);
        }
      }
    }
  }
  analytic_field_free(field);
}

// A ray from a probe's own place runs along one texel, and ends at what the probe sees there. It never ends before
// that, in the air, even where the texel shows the edge of a box.
static void rays_from_a_probe_end_at_what_it_sees(void **state) {
  (void)state;
  olx_field *field = analytic_field_make(&furnished, &single, 64, 16);
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_vec3 probe = field->probe_positions[0];
  uint32_t hits = 0, early = 0;
  for (uint32_t i = 0; i < 20000; i++) {
    const olx_vec3 d = random_direction(i);
    const olx_trace_hit hit = olx_trace(field, &settings, probe, d, INFINITY);
    if (hit.status != OLX_TRACE_HIT) continue;
    const float stored = olx_texel_distance(field, 0, olx_texel_towards(field, d));
    hits++;
    early += hit.distance_metres < 0.5f * stored;
  }
  print_message("%u of %u rays from a probe end in the air\n", early, hits);
  assert_true(hits > 19000);
  assert_int_equal(early, 0);
  analytic_field_free(field);
}

// A lamp close above the floor lights the floor below it, so its rays must end there, with every way to choose probes.
static void rays_from_close_above_a_surface_end_on_it(void **state) {
  (void)state;
  olx_field *field = analytic_field_make(&empty_room, &cage, 64, 16);
  olx_sample_settings settings = olx_sample_settings_default();
  for (int select = OLX_SELECT_CAGE; select <= OLX_SELECT_EXHAUSTIVE; select += OLX_SELECT_EXHAUSTIVE) {
    settings.select = (olx_select)select;
    for (uint32_t i = 0; i < 200; i++) {
      const olx_vec3 above = random_point(i, &empty_room), down = random_direction(i);
      const olx_vec3 d = olx_v3(down.x, -fabsf(down.y), down.z);
      const olx_trace_hit floor = olx_trace(field, &settings, above, olx_v3(0, -1, 0), INFINITY);
      assert_int_equal(floor.status, OLX_TRACE_HIT);
      const float height = 0.6f * floor.footprint_metres;
      const olx_vec3 o = olx_v3(above.x, empty_room.room.min.y + height, above.z);
      const olx_trace_hit hit = olx_trace(field, &settings, o, d, INFINITY);
      assert_int_equal(hit.status, OLX_TRACE_HIT);
      assert_true(fabsf(hit.distance_metres - analytic_cast(&empty_room, o, d).t) <= 2.0f * hit.footprint_metres);
    }
  }
  analytic_field_free(field);
}

static void a_ray_that_ends_early_misses(void **state) {
  (void)state;
  olx_field *field = analytic_field_make(&empty_room, &single, 64, 16);
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_trace_hit hit = olx_trace(field, &settings, olx_v3(1, 1, 1), olx_v3(0, 0, 1), 0.5f);
  assert_int_equal(hit.status, OLX_TRACE_MISS);
  assert_true(hit.distance_metres == 0.5f);
  assert_false(hit.emitter);
  analytic_field_free(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_probe_resolves_every_ray_in_a_convex_room),
      cmocka_unit_test(rays_through_an_open_ceiling_miss),
      cmocka_unit_test(eight_probes_resolve_rays_around_furniture),
      cmocka_unit_test(rays_for_visibility_alone_end_where_others_do),
      cmocka_unit_test(rays_ask_at_most_two_probes_that_no_list_names),
      cmocka_unit_test(rays_along_axes_and_through_the_probe_end_where_they_should),
      cmocka_unit_test(rays_from_a_probe_end_at_what_it_sees),
      cmocka_unit_test(rays_from_close_above_a_surface_end_on_it),
      cmocka_unit_test(a_ray_that_ends_early_misses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
