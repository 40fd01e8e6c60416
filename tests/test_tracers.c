// Tests two-level and hi-Z tracing against exhaustive tracing, which visits every texel: they find the same texels, and
// the same t to the last bit.
#include "analytic_field.h"

#include "core/sampling.h"
#include "select/sight.h"
#include "trace/probe_trace.h"

#include <octalux/bake.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

static const analytic_scene furnished = {
    .room = {{0, 0, 0}, {4, 3, 5}},
    .box_count = 2,
    .boxes = {{{0.9f, 0.0f, 1.1f}, {1.7f, 1.3f, 2.1f}}, {{2.3f, 0.0f, 2.6f}, {3.1f, 2.1f, 3.3f}}},
};
static const analytic_scene open_court = {.room = {{0, 0, 0}, {4, 3, 5}}, .open = true};
static const olx_grid single = {.origin = {1.9f, 1.4f, 2.7f}, .count = {1, 1, 1}};
static const olx_grid pair = {.origin = {0.5f, 0.7f, 0.5f}, .spacing = {3.0f, 0.0f, 0.0f}, .count = {2, 1, 1}};

static float unit(uint32_t i, uint32_t salt) { return olx_unit_float(olx_hash2(i, salt)); }

static olx_vec3 random_direction(uint32_t i) {
  return olx_sample_sphere((olx_vec2){unit(i, 1), unit(i, 2)});
}

// Returns rays of every difficult kind, relative to the probe, in a field whose distances are about `scale`.
static olx_probe_ray random_ray(uint32_t i, float scale) {
  olx_vec3 d = random_direction(i), o = olx_scale(random_direction(i + 0x10000u), scale * unit(i, 3));
  switch (i % 8) {
  case 0: o = olx_scale(d, -2.0f * scale * unit(i, 4)); break;                       // through the probe's centre
  case 1: o = olx_madd(olx_scale(d, -scale), o, 1e-5f); break;                       // just past the probe
  case 2: o = (olx_vec3){0.0f, o.y, o.z}, d = olx_normalize((olx_vec3){0.0f, d.y, d.z}); break; // in an axis plane
  case 3: d = (olx_vec3){0.0f, i & 8 ? 1.0f : -1.0f, 0.0f}; break;                   // along an axis
  case 4: d = olx_normalize(olx_cross(o, d)); break; // nearest to the probe at its start
  case 5: o = olx_madd(o, d, -4.0f * scale); break;                                  // from far outside
  default: break;
  }
  olx_probe_ray ray = {.origin = o, .direction = d, .t_max = INFINITY};
  if (unit(i, 5) < 0.5f) ray.t_max = 3.0f * scale * unit(i, 6);
  if (unit(i, 7) < 0.3f) ray.t_min = 0.5f * scale * unit(i, 8);
  return ray;
}

static bool same_bits(float a, float b) { return memcmp(&a, &b, sizeof a) == 0; }

static void assert_same(const olx_field *field, uint32_t probe, const olx_probe_ray *ray, olx_tracer tracer,
                        const olx_probe_answer *truth, uint32_t i) {
  const olx_probe_answer a = olx_trace_probe(field, probe, ray, tracer);
  if (a.status == truth->status && a.texel == truth->texel && same_bits(a.t, truth->t) &&
      same_bits(a.gap, truth->gap)) {
    return;
  }
  fail_msg("n %u, ray %u, tracer %d: status %d texel %zu t %.9g, the referee has status %d texel %zu t %.9g", field->n,
           i, tracer, a.status, a.texel, (double)a.t, truth->status, truth->texel, (double)truth->t);
}

// Asserts that many rays traced at once have the same answers as each of them alone, including steps.
static void assert_same_together(const olx_field *field, const olx_probe_job *jobs, uint32_t count) {
  olx_probe_answer *answers = calloc(count, sizeof *answers);
  olx_trace_probes(field, jobs, count, OLX_TRACER_HIZ, answers);
  for (uint32_t i = 0; i < count; i++) {
    const olx_probe_answer one = olx_trace_probe(field, jobs[i].probe, &jobs[i].ray, OLX_TRACER_HIZ),
                           *all = &answers[i];
    assert_int_equal(all->status, one.status);
    assert_int_equal(all->texel, one.texel);
    assert_int_equal(all->steps, one.steps);
    assert_true(same_bits(all->t, one.t) && same_bits(all->gap, one.gap));
  }
  free(answers);
}

// The number of rays of each status.
typedef struct counts {
  uint32_t of[3];
} counts;

static void compare(const olx_field *field, uint32_t rays, float scale, counts *c) {
  olx_probe_job *jobs = calloc(rays, sizeof *jobs);
  for (uint32_t i = 0; i < rays; i++) {
    const uint32_t probe = i % field->info.probes.count;
    const olx_probe_ray ray = random_ray(i, scale);
    jobs[i] = (olx_probe_job){probe, ray};
    const olx_probe_answer truth = olx_trace_probe(field, probe, &ray, OLX_TRACER_TEXEL);
    c->of[truth.status]++;
    assert_same(field, probe, &ray, OLX_TRACER_TWO_LEVEL, &truth, i);
    assert_same(field, probe, &ray, OLX_TRACER_HIZ, &truth, i);
  }
  assert_same_together(field, jobs, rays);
  free(jobs);
}

static void in_rooms_of_every_size(void **state) {
  (void)state;
  counts c = {0};
  for (uint32_t n = 8; n <= 2048; n *= 2) {
    const uint32_t rays = n <= 256 ? 8000 : 1600;
    olx_field *field = analytic_field_make(&furnished, n <= 512 ? &pair : &single, n, 16);
    compare(field, rays, 2.0f, &c);
    analytic_field_free(field);
    field = analytic_field_make(&open_court, &single, n, 16);
    compare(field, rays, 2.0f, &c);
    analytic_field_free(field);
  }
  for (uint32_t s = 0; s < 3; s++) assert_true(c.of[s] > 4000);
}

// Maps of distances that no real room has.
typedef uint16_t (*distances)(uint32_t x, uint32_t y, uint32_t n);

static uint16_t noise(uint32_t x, uint32_t y, uint32_t n) {
  return olx_half_pack(0.05f + 0.4f * olx_unit_float(olx_hash3(x, y, n)));
}
static uint16_t checkers(uint32_t x, uint32_t y, uint32_t n) {
  (void)n;
  return olx_half_pack((x ^ y) & 1 ? 0.05f : 0.4f);
}
static uint16_t sky_with_specks(uint32_t x, uint32_t y, uint32_t n) {
  return olx_hash3(x, y, n) % 61 == 0 ? olx_half_pack(0.2f) | 0x8000 : 0x7C00;
}
static uint16_t shell(uint32_t x, uint32_t y, uint32_t n) {
  (void)x, (void)y, (void)n;
  return olx_half_pack(0.2f);
}
static uint16_t stripes(uint32_t x, uint32_t y, uint32_t n) {
  (void)y;
  return olx_half_pack(x * 16 / n % 2 ? 0.1f : 0.3f);
}
static uint16_t smallest_and_largest(uint32_t x, uint32_t y, uint32_t n) {
  const uint16_t codes[] = {0, 1, 0x3FF, 0x400, 0x7BFF, 0x7C00, 0x3400, 0x3400};
  return codes[olx_hash3(x, y, n) % 8];
}

static olx_field *made_up_field(uint32_t n, distances make) {
  olx_field *f = analytic_field_make(&open_court, &single, n, 16);
  uint16_t *distance = (uint16_t *)(uintptr_t)f->distance, *normal = (uint16_t *)(uintptr_t)f->normal;
  const int32_t size = (int32_t)n;
  for (int32_t y = -1; y <= size; y++) {
    for (int32_t x = -1; x <= size; x++) {
      int32_t sx, sy;
      olx_border_source(x, y, size, &sx, &sy);
      const size_t at = olx_map_index(f->stride, x, y);
      const olx_vec3 d = olx_texel_direction((uint32_t)sx, (uint32_t)sy, n);
      const olx_vec3 tilt = random_direction(olx_hash3((uint32_t)sx, (uint32_t)sy, 5));
      distance[at] = make((uint32_t)sx, (uint32_t)sy, n);
      normal[at] = olx_normal_pack(olx_normalize(olx_madd(olx_negate(d), tilt, 0.9f)));
    }
  }
  const olx_pyramid_base base = olx_pyramid_over_texels(distance + f->stride + 1, f->stride);
  olx_pyramid_make(&f->pyramid, &base, (uint16_t *)(uintptr_t)f->least, (uint16_t *)(uintptr_t)f->greatest);
  return f;
}

static void among_distances_that_no_room_has(void **state) {
  (void)state;
  const distances kinds[] = {noise, checkers, sky_with_specks, shell, stripes, smallest_and_largest};
  counts c = {0};
  for (uint32_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    for (uint32_t n = 8; n <= 1024; n *= k < 2 ? 2 : 4) {
      olx_field *field = made_up_field(n, kinds[k]);
      compare(field, n <= 256 ? 4000 : 1200, 0.3f * field->distance_scale, &c);
      analytic_field_free(field);
    }
  }
  for (uint32_t s = 0; s < 3; s++) assert_true(c.of[s] > 5000);
}

static void assert_same_hits(const olx_field *field, uint32_t rays, uint64_t steps[3]) {
  olx_sample_settings settings = olx_sample_settings_default();
  const olx_vec3 low = field->info.scene.bounds_min, size = olx_sub(field->info.scene.bounds_max, low);
  for (uint32_t i = 0; i < rays; i++) {
    const olx_vec3 o = olx_add(low, olx_mul(size, olx_v3(unit(i, 1), unit(i, 2), unit(i, 3)))),
                   d = random_direction(i ^ 77);
    olx_trace_hit hits[3];
    for (uint32_t tracer = 0; tracer < 3; tracer++) {
      settings.tracer = (olx_tracer)tracer;
      hits[tracer] = olx_trace(field, &settings, o, d, INFINITY);
      steps[tracer] += hits[tracer].texel_steps;
      hits[tracer].texel_steps = 0;
    }
    assert_memory_equal(&hits[0], &hits[1], offsetof(olx_trace_hit, emitter));
    assert_memory_equal(&hits[0], &hits[2], offsetof(olx_trace_hit, emitter));
    assert_int_equal(hits[0].probe, hits[2].probe);
    assert_int_equal(hits[0].probes_tried, hits[2].probes_tried);
  }
}

// Asserts that olx_trace_rays gives the same hits as olx_trace, for any number of rays and any selector.
static void assert_rays_together(const olx_field *field, uint32_t count) {
  olx_vec3 *origins = calloc(count, sizeof *origins), *directions = calloc(count, sizeof *directions);
  olx_trace_hit *hits = calloc(count, sizeof *hits);
  const olx_vec3 low = field->info.scene.bounds_min, size = olx_sub(field->info.scene.bounds_max, low);
  for (uint32_t i = 0; i < count; i++) {
    origins[i] = olx_add(low, olx_mul(size, olx_v3(unit(i, 21), unit(i, 22), unit(i, 23))));
    directions[i] = i % 50 == 7 ? olx_v3(0, 0, i % 100 == 7 ? 0 : -1) : random_direction(i ^ 99);
  }
  olx_sample_settings settings = olx_sample_settings_default();
  for (uint32_t k = 0; k < 5; k++) {
    settings.tracer = k == 4 ? OLX_TRACER_TWO_LEVEL : OLX_TRACER_HIZ;
    settings.select = (olx_select[]){OLX_SELECT_BRICKS, OLX_SELECT_CAGE, OLX_SELECT_EXHAUSTIVE, OLX_SELECT_BRICKS,
                                     OLX_SELECT_BRICKS}[k];
    settings.max_probes = k == 3 ? 2 : 128;
    const float t_max = k == 3 ? 1.5f : INFINITY;
    for (uint32_t i = 0, some; i < count; i += some) {
      some = i % 7 == 3 ? 1 : i % 5 == 2 ? 13 : 300;
      if (some > count - i) some = count - i;
      olx_trace_rays(field, &settings, some, origins + i, directions + i, t_max, hits + i);
    }
    for (uint32_t i = 0; i < count; i++) {
      const olx_trace_hit one = olx_trace(field, &settings, origins[i], directions[i], t_max);
      assert_memory_equal(&hits[i], &one, offsetof(olx_trace_hit, emitter));
      assert_int_equal(hits[i].emitter, one.emitter);
      assert_memory_equal(&hits[i].probe, &one.probe, sizeof one - offsetof(olx_trace_hit, probe));
    }
  }
  free(origins);
  free(directions);
  free(hits);
}

// Asserts that queries of visibility for many points give the same answers as single ones, including points at the
// probes' centres and far outside.
static void assert_sight_together(const olx_field *field) {
  enum { PLACES = 3003 };
  static uint32_t probes[PLACES];
  static olx_vec3 places[PLACES], directions[PLACES];
  static bool seen[PLACES];
  const olx_vec3 low = field->info.scene.bounds_min, size = olx_sub(field->info.scene.bounds_max, low);
  uint32_t count = 0;
  for (uint32_t i = 0; i < PLACES; i++) {
    probes[i] = i % field->info.probes.count;
    const olx_vec3 centre = field->probe_positions[probes[i]];
    directions[i] = random_direction(i);
    places[i] = olx_add(low, olx_mul(size, olx_v3(unit(i, 31), unit(i, 32), unit(i, 33))));
    if (i % 3 == 0) { // a point near a stored surface
      const size_t texel = olx_texel_towards(field, directions[i]);
      const float distance = olx_texel_distance(field, probes[i], texel);
      if (distance < INFINITY) places[i] = olx_madd(centre, directions[i], distance * (0.99f + 0.02f * unit(i, 34)));
    }
    if (i % 100 == 1) places[i] = centre;
    if (i % 100 == 2) places[i] = olx_v3(centre.x - 1.0f, centre.y, centre.z);
  }
  for (uint32_t start = 0; start < 2; start++) {
    const float slack = start ? OLX_SIGHT_START : OLX_SIGHT_STUCK;
    olx_probes_see(field, PLACES, probes, places, slack, start ? directions : NULL, seen);
    for (uint32_t i = 0; i < PLACES; i++) {
      assert_int_equal(seen[i], olx_probe_sees(field, probes[i], places[i], slack, start ? &directions[i] : NULL));
      count += seen[i];
    }
  }
  assert_in_range(count, PLACES / 5, 2 * PLACES - PLACES / 5);
}

static void in_baked_fields_with_fewer_fetches(void **state) {
  (void)state;
  enum { RAYS = 6000 };
  const char *scenes[] = {"builtin:cornell-glossy", "builtin:temple", "builtin:pillars"};
  for (uint32_t i = 0; i < 6; i++) {
    const uint32_t k = i / 2;
    const bool blocks = i % 2 == 0;
    char path[] = "/tmp/octalux-tracers-XXXXXX";
    close(mkstemp(path));
    olx_scene *scene;
    assert_int_equal(olx_scene_load(scenes[k], &scene), OLX_OK);
    olx_bake_settings settings = olx_bake_settings_default(scene);
    assert_int_equal(olx_scene_probe_grid(scene, (const uint32_t[3]){3, 2, 3}, &settings.grid), OLX_OK);
    settings.radiance_size = 128;
    settings.select_mask = 1u << OLX_SELECT_CAGE | 1u << OLX_SELECT_BRICKS;
    settings.samples = 1;
    settings.bounces = 0;
    settings.irradiance_size = 8;
    settings.irradiance_grid.count[0] = settings.irradiance_grid.count[1] = settings.irradiance_grid.count[2] = 1;
    settings.irradiance_grid.spacing = olx_splat(0.0f);
    settings.fit = false;
    settings.light = OLX_LIGHT_REFERENCE; // light does not matter here, so the cheapest solver will do
    settings.reference_paths = 1;
    settings.uncompressed = !blocks;
    assert_int_equal(olx_bake(scene, &settings, path, NULL, NULL), OLX_OK);
    olx_scene_free(scene);
    olx_field *field;
    assert_int_equal(olx_field_open(path, &field), OLX_OK);
    uint64_t steps[3] = {0};
    assert_same_hits(field, RAYS, steps);
    print_message("%s, %s: %.1f, %.1f, %.1f distances read a ray\n", scenes[k], blocks ? "blocks" : "texels",
                  (double)steps[0] / RAYS, (double)steps[1] / RAYS, (double)steps[2] / RAYS);
    assert_true(steps[2] < steps[blocks ? 0 : 1]); // two-level tracing also reads a block of 16 texels at once
    assert_rays_together(field, 2000);
    assert_sight_together(field);
    olx_field_close(field);
    unlink(path);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(in_rooms_of_every_size),
      cmocka_unit_test(among_distances_that_no_room_has),
      cmocka_unit_test(in_baked_fields_with_fewer_fetches),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
