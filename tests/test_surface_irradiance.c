// Tests diffuse light that is read from stored surfaces: points of a surface get the light that is stored for it, and
// no other.
#include "analytic_field.h"

#include "core/sampling.h"
#include "field/maps.h"
#include "shade/surface_irradiance.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const analytic_scene empty_room = {.room = {{0, 0, 0}, {4, 3, 5}}};
static const olx_grid cage = {.origin = {0.6f, 0.5f, 0.7f}, .spacing = {2.8f, 1.9f, 3.5f}, .count = {2, 2, 2}};
static const olx_grid single = {.origin = {1.9f, 1.4f, 2.7f}, .count = {1, 1, 1}};

typedef analytic_hit (*caster)(const analytic_scene *scene, olx_vec3 origin, olx_vec3 direction);
typedef olx_vec3 (*lighting)(olx_vec3 position, olx_vec3 normal, uint32_t probe);

// Makes a field of the surfaces that `cast` meets, with light of this kind stored at every texel. Irradiance probes
// hold 1, 2, 3, ... as in all analytic fields, so that the test can recognise light from the volume.
static olx_field *field_of(const analytic_scene *scene, const olx_grid *grid, uint32_t n, caster cast, lighting light) {
  olx_field *f = analytic_field_make(scene, grid, n, 16);
  uint16_t *distance = (uint16_t *)(uintptr_t)f->distance, *normal = (uint16_t *)(uintptr_t)f->normal;
  uint32_t *indirect = (uint32_t *)(uintptr_t)f->surfaces.indirect;
  for (uint32_t probe = 0; probe < f->info.probes.count; probe++) {
    for (int32_t i = 0; i < (int32_t)f->texels; i++) {
      const int32_t x = i % (int32_t)f->stride - 1, y = i / (int32_t)f->stride - 1;
      int32_t sx, sy;
      olx_border_source(x, y, (int32_t)n, &sx, &sy);
      const olx_vec3 d = olx_texel_direction((uint32_t)sx, (uint32_t)sy, n), o = f->probe_positions[probe];
      const analytic_hit hit = cast(scene, o, d);
      const size_t at = f->texels * probe + (size_t)i;
      distance[at] = olx_half_pack(hit.t / f->distance_scale);
      normal[at] = olx_normal_pack(hit.normal);
      indirect[at] = hit.t < INFINITY ? olx_rgb9e5_pack(light(olx_madd(o, d, hit.t), hit.normal, probe)) : 0;
    }
  }
  return f;
}

static olx_surface_light light_at(const olx_field *f, olx_vec3 position, olx_vec3 normal) {
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_surface_point point = {position, normal, normal, normal, normal};
  return olx_surface_light_at(f, &settings, &point);
}

static void assert_light(const olx_field *f, olx_vec3 p, olx_vec3 n, float expected) {
  const olx_surface_light light = light_at(f, p, n);
  if (light.probes > 0 && fabsf(light.irradiance.x - expected) <= 1e-5f * expected) return;
  fail_msg("(%g %g %g): %g from %u probes, not %g", (double)p.x, (double)p.y, (double)p.z, (double)light.irradiance.x,
           light.probes, (double)expected);
}

// Returns a random point of the room's walls, floor and ceiling, and the normal there.
static olx_vec3 on_room(uint32_t i, const analytic_box *room, olx_vec3 *normal) {
  const olx_vec2 a = olx_stratified2(i, 3), b = olx_stratified2(i, 4);
  const uint32_t axis = i % 3;
  const bool high = i / 3 % 2;
  float unit[3] = {a.x, a.y, b.x}, n[3] = {0};
  unit[axis] = high ? 1.0f : 0.0f;
  n[axis] = high ? -1.0f : 1.0f;
  *normal = olx_load3(n);
  return olx_add(room->min, olx_mul(olx_load3(unit), olx_sub(room->max, room->min)));
}

// ---- stored light

static olx_vec3 colored(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)p, (void)n, (void)probe;
  return olx_v3(0.5f, 2.0f, 3.0f);
}

static void even_light_is_answered_as_it_is(void **state) {
  (void)state;
  olx_field *f = field_of(&empty_room, &cage, 64, analytic_cast, colored);
  for (uint32_t i = 0; i < 3000; i++) {
    olx_vec3 n;
    const olx_vec3 p = on_room(i, &empty_room.room, &n);
    const olx_surface_light light = light_at(f, p, n);
    const olx_vec3 off = olx_sub(light.irradiance, colored(p, n, 0));
    if (light.probes == 0 || olx_length(off) > 1e-5f) {
      fail_msg("(%g %g %g): off by %g from %u probes", (double)p.x, (double)p.y, (double)p.z, (double)olx_length(off),
               light.probes);
    }
  }
  analytic_field_free(f);
}

static olx_vec3 waves(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)n, (void)probe;
  return olx_splat(2.0f + sinf(2.0f * p.x) + cosf(1.5f * p.z + p.y));
}

// Returns the root mean square error over the floor, walls and ceiling.
static double error_of_waves(uint32_t n) {
  olx_field *f = field_of(&empty_room, &cage, n, analytic_cast, waves);
  double sum = 0.0;
  for (uint32_t i = 0; i < 3000; i++) {
    olx_vec3 normal;
    const olx_vec3 p = on_room(i, &empty_room.room, &normal);
    const float off = light_at(f, p, normal).irradiance.x - waves(p, normal, 0).x;
    sum += (double)off * (double)off;
  }
  analytic_field_free(f);
  return sqrt(sum / 3000.0);
}

// Bilinear interpolation is of second order: twice as many texels along a side give a quarter of the error.
static void smooth_light_is_interpolated(void **state) {
  (void)state;
  const double coarse = error_of_waves(16), fine = error_of_waves(32);
  print_message("error of waves: %.4f with 16 x 16 texels, %.4f with 32 x 32\n", coarse, fine);
  assert_true(fine < coarse / 3.0);
}

static olx_vec3 slope(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)n, (void)probe;
  return olx_splat(1.0f + 0.25f * p.x + 0.125f * p.z);
}

// Below a probe the octahedral map is folded: along four lines on the floor, the four texels are on both sides of an
// edge of the map. Light there is as accurate as on other lines, and the same on both sides.
static void texels_across_the_fold_are_the_neighbours(void **state) {
  (void)state;
  const olx_grid grid = {.origin = {2.0f, 1.0f, 2.5f}, .count = {1, 1, 1}};
  const olx_vec3 up = {0, 1, 0};
  olx_field *f = field_of(&empty_room, &grid, 64, analytic_cast, slope);
  for (int32_t i = -1000; i <= 1000; i++) {
    const float along = 0.0015f * (float)i, off = 1e-4f;
    const olx_vec3 places[2][2] = {
        {olx_v3(2.0f + along, 0.0f, 2.5f - off), olx_v3(2.0f + along, 0.0f, 2.5f + off)},
        {olx_v3(2.0f - off, 0.0f, 2.5f + along), olx_v3(2.0f + off, 0.0f, 2.5f + along)},
    };
    for (uint32_t k = 0; k < 2; k++) {
      const float one = light_at(f, places[k][0], up).irradiance.x, other = light_at(f, places[k][1], up).irradiance.x;
      // A texel is up to 0.2 m long here, and light changes by 0.28 a metre, that is by 0.028 over half a texel.
      const float error = fabsf(one - slope(places[k][0], up, 0).x);
      if (error > 0.028f || fabsf(one - other) > 1e-3f) {
        fail_msg("(%g %g): off by %g, and %g across", (double)places[k][0].x, (double)places[k][0].z, (double)error,
                 (double)(one - other));
      }
    }
  }
  analytic_field_free(f);
}

// ---- nothing bleeds

static const analytic_scene stepped = {
    .room = {{0, 0, 0}, {4, 3, 5}}, .box_count = 1, .boxes = {{{1.5f, 0.0f, 2.0f}, {2.5f, 0.15f, 3.0f}}}};

static olx_vec3 dark_step(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)n, (void)probe;
  return olx_splat(p.x > 1.49f && p.x < 2.51f && p.z > 1.99f && p.z < 3.01f && p.y > 1e-3f && p.y < 0.16f ? 1.0f
                                                                                                          : 4.0f);
}

// Returns the light of a floor beside a step that is fifty times darker; both vary.
static olx_vec3 uneven_step(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  const bool dark = dark_step(p, n, probe).x < 2.0f;
  return olx_splat(dark ? 0.2f + 0.06f * sinf(9.0f * p.z + 20.0f * p.y) : 10.0f + 3.0f * sinf(4.0f * p.x + p.z));
}

typedef struct block_errors {
  double dark, lit, worst_dark; // relative MSE on the step and on the floor, and the largest error on the dark step
} block_errors;

// Returns the errors of light from blocks on the step and around it, against light from texels.
static block_errors errors_of_blocks(void) {
  olx_field *texels = field_of(&stepped, &cage, 64, analytic_cast, uneven_step),
            *blocks = field_of(&stepped, &cage, 64, analytic_cast, uneven_step);
  analytic_field_compress(blocks);
  double off[2] = {0.0, 0.0}, all[2] = {0.0, 0.0}, worst = 0.0;
  for (uint32_t i = 0; i < 4000; i++) {
    const olx_vec2 u = olx_stratified2(i, 3);
    const bool top = u.x > 0.25f && u.x < 0.75f && u.y > 0.25f && u.y < 0.75f, side = i % 4 == 0;
    const olx_vec3 p = side ? olx_v3(1.5f, 0.005f + 0.14f * u.x, 2.05f + 0.9f * u.y)
                            : olx_v3(1.0f + 2.0f * u.x, top ? 0.15f : 0.0f, 1.5f + 2.0f * u.y),
                   n = side ? olx_v3(-1, 0, 0) : olx_v3(0, 1, 0);
    const olx_surface_light truth = light_at(texels, p, n), found = light_at(blocks, p, n);
    assert_int_equal(truth.probes, found.probes);
    const bool dark = side || top;
    const double difference = (double)found.irradiance.x - (double)truth.irradiance.x;
    off[dark] += difference * difference;
    all[dark] += (double)truth.irradiance.x * (double)truth.irradiance.x;
    if (dark) worst = fmax(worst, fabs(difference));
  }
  analytic_field_free(texels);
  analytic_field_free(blocks);
  return (block_errors){off[1] / all[1], off[0] / all[0], worst};
}

// Blocks of 4 x 4 texels contain both surfaces, and each surface keeps its own light to a few per cent; less than a
// hundredth of the brighter light leaks into the darker one, the limit relative to which the encoder measures errors of
// dark texels.
static void blocks_do_not_bleed(void **state) {
  (void)state;
  const block_errors e = errors_of_blocks();
  print_message("relative MSE of blocks: %.2g where it is dark (%.2g of 10 at most), %.2g where it is lit\n", e.dark,
                e.worst_dark, e.lit);
  assert_true(e.lit < 1e-3 && e.dark < 4e-3 && e.worst_dark < 0.1);
}

static void edges_do_not_bleed(void **state) {
  (void)state;
  olx_field *f = field_of(&stepped, &cage, 64, analytic_cast, dark_step);
  for (uint32_t i = 0; i < 400; i++) {
    const float z = 2.05f + 0.9f * (float)i / 400.0f, off = 0.001f + 0.1f * (float)(i % 7) / 7.0f;
    assert_light(f, olx_v3(1.5f - off, 0.0f, z), olx_v3(0, 1, 0), 4.0f);
    assert_light(f, olx_v3(2.5f + off, 0.0f, z), olx_v3(0, 1, 0), 4.0f);
    assert_light(f, olx_v3(1.5f + off, 0.15f, z), olx_v3(0, 1, 0), 1.0f);
    assert_light(f, olx_v3(1.5f, 0.005f + 0.14f * (float)i / 400.0f, z), olx_v3(-1, 0, 0), 1.0f);
  }
  analytic_field_free(f);
}

static const analytic_scene framed = {
    .room = {{0, 0, 0}, {4, 3, 5}}, .box_count = 1, .boxes = {{{-0.1f, 1.0f, 2.0f}, {0.01f, 1.8f, 3.0f}}}};

static olx_vec3 bright_frame(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)n, (void)probe;
  return olx_splat(p.x > 0.005f && p.x < 0.1f && p.y > 0.99f && p.y < 1.81f && p.z > 1.99f && p.z < 3.01f ? 4.0f
                                                                                                          : 1.0f);
}

// The picture frame hangs a centimetre before the wall, a quarter of a texel's side as seen from the probe.
static void a_picture_frame_and_its_wall_get_their_own_light(void **state) {
  (void)state;
  const olx_grid grid = {.origin = {1.5f, 1.4f, 2.5f}, .count = {1, 1, 1}};
  olx_field *f = field_of(&framed, &grid, 128, analytic_cast, bright_frame);
  uint32_t widened = 0;
  for (uint32_t i = 0; i < 300; i++) {
    const float y = 1.05f + 0.7f * (float)i / 300.0f, off = 0.012f + 0.05f * (float)(i % 7) / 7.0f;
    const olx_vec3 wall = olx_v3(0.0f, y, 2.0f - off), frame = olx_v3(0.01f, y, 1.99f + off), n = olx_v3(1, 0, 0);
    assert_light(f, wall, n, 1.0f);
    assert_light(f, frame, n, 4.0f);
    olx_sample_settings settings = olx_sample_settings_default();
    settings.surface_tolerance = 1.0f;
    widened += olx_surface_irradiance(f, &settings, wall, n, n, n).x > 1.01f;
  }
  // With a surface tolerance, as for levels of detail, the wall also takes light of the frame.
  assert_true(widened > 30);
  analytic_field_free(f);
}

static const analytic_scene halved = {
    .room = {{0, 0, 0}, {4, 3, 5}}, .box_count = 1, .boxes = {{{1.99f, -1.0f, -1.0f}, {2.01f, 4.0f, 6.0f}}}};

static olx_vec3 lit_on_the_right(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)n, (void)probe;
  return olx_splat(p.x < 2.0f ? 1.0f : 4.0f);
}

static void each_side_of_a_thin_wall_gets_its_own_light(void **state) {
  (void)state;
  olx_field *f = field_of(&halved, &cage, 32, analytic_cast, lit_on_the_right);
  for (uint32_t i = 0; i < 500; i++) {
    const olx_vec2 u = olx_stratified2(i, 9);
    const float y = 0.05f + 2.9f * u.x, z = 0.05f + 4.9f * u.y, off = 0.001f + 0.05f * (float)(i % 5);
    assert_light(f, olx_v3(1.99f, y, z), olx_v3(-1, 0, 0), 1.0f);
    assert_light(f, olx_v3(2.01f, y, z), olx_v3(1, 0, 0), 4.0f);
    assert_light(f, olx_v3(1.99f - off, 0.0f, z), olx_v3(0, 1, 0), 1.0f);
    assert_light(f, olx_v3(2.01f + off, 0.0f, z), olx_v3(0, 1, 0), 4.0f);
  }
  analytic_field_free(f);
}

// ---- curved surfaces

static const olx_vec3 ball = {2.0f, 1.4f, 2.4f};
static const float ball_radius = 0.6f;

// Returns the normal of the ball's flat facet at n; facets span 12 by 12 degrees.
static olx_vec3 facet_of(olx_vec3 n) {
  const float step = OLX_PI / 15.0f;
  const float theta = (floorf(acosf(olx_clamp(n.y, -1.0f, 1.0f)) / step) + 0.5f) * step;
  const float phi = (floorf(atan2f(n.z, n.x) / step) + 0.5f) * step;
  return olx_v3(sinf(theta) * cosf(phi), cosf(theta), sinf(theta) * sinf(phi));
}

static analytic_hit cast_ball(const analytic_scene *scene, olx_vec3 o, olx_vec3 d) {
  const olx_vec3 way = olx_sub(ball, o);
  const float along = olx_dot(way, d), squared = olx_dot(way, way) - along * along;
  if (along <= 0.0f || squared >= ball_radius * ball_radius) return analytic_cast(scene, o, d);
  const float t = along - sqrtf(ball_radius * ball_radius - squared);
  return (analytic_hit){t, facet_of(olx_normalize(olx_sub(olx_madd(o, d, t), ball)))};
}

// Returns light from above for the smooth normal, as a bake stores it for normals that are interpolated between a
// triangle's corners.
static olx_vec3 from_above(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)n, (void)probe;
  return olx_splat(2.0f + olx_normalize(olx_sub(p, ball)).y);
}

static void a_ball_of_facets_is_smooth(void **state) {
  (void)state;
  olx_field *f = field_of(&empty_room, &cage, 64, cast_ball, from_above);
  enum { STEPS = 4000 };
  float before = 0.0f, largest = 0.0f;
  uint32_t stored = 0;
  for (uint32_t i = 0; i < STEPS; i++) {
    // The points follow a spiral from pole to pole, in steps of at most 0.6 degrees.
    const float y = 1.0f - 2.0f * ((float)i + 0.5f) / STEPS, r = sqrtf(1.0f - y * y), phi = 0.01f * (float)i;
    const olx_vec3 n = olx_v3(r * cosf(phi), y, r * sinf(phi)), p = olx_madd(ball, n, ball_radius);
    const olx_surface_point point = {p, facet_of(n), n, n, n};
    const olx_sample_settings settings = olx_sample_settings_default();
    const olx_surface_light light = olx_surface_light_at(f, &settings, &point);
    stored += light.probes > 0;
    if (light.probes == 0) continue;
    const float off = fabsf(light.irradiance.x - from_above(p, n, 0).x);
    // Texels are up to 0.1 radians apart on the ball, and their light differs by as much; the error of their mean is
    // much smaller.
    if (off > 0.06f) fail_msg("step %u: off by %g", i, (double)off);
    if (before > 0.0f) largest = olx_max(largest, fabsf(light.irradiance.x - before));
    before = light.irradiance.x;
  }
  print_message("ball: %u of %d stored, largest step %.4f\n", stored, STEPS, (double)largest);
  assert_true(stored > STEPS * 99 / 100);
  assert_true(largest < 0.05f);
  analytic_field_free(f);
}

// ---- from probe to probe

static olx_vec3 of_probe(olx_vec3 p, olx_vec3 n, uint32_t probe) {
  (void)p, (void)n;
  return olx_splat((float)(probe + 1));
}

// Every probe stores a different light, as if bakes were noisy. Where one probe takes over from another, light changes
// smoothly.
static void probes_take_over_smoothly(void **state) {
  (void)state;
  olx_field *f = field_of(&stepped, &cage, 64, analytic_cast, of_probe);
  float before = 0.0f, largest = 0.0f;
  enum { STEPS = 20000 };
  for (uint32_t i = 0; i < STEPS; i++) {
    const float s = ((float)i + 0.5f) / STEPS; // steps of 0.25 mm beside the step, which hides some probes
    const olx_surface_light light = light_at(f, olx_v3(1.2f + 0.2f * s, 0.0f, 4.9f * s + 0.05f), olx_v3(0, 1, 0));
    assert_true(light.probes > 0);
    if (i > 0) largest = olx_max(largest, fabsf(light.irradiance.x - before));
    before = light.irradiance.x;
  }
  print_message("largest step from probe to probe: %.4f\n", (double)largest);
  assert_true(largest < 0.1f); // a small step, since the probes' lights differ by up to 7
  analytic_field_free(f);
}

static void the_nearest_probe_in_front_answers(void **state) {
  (void)state;
  olx_field *f = field_of(&empty_room, &cage, 64, analytic_cast, of_probe);
  assert_light(f, olx_v3(0.6f, 0.0f, 0.7f), olx_v3(0, 1, 0), 1.0f); // a point straight below probe 0
  assert_light(f, olx_v3(3.4f, 3.0f, 4.2f), olx_v3(0, -1, 0), 8.0f);
  ((uint8_t *)(uintptr_t)f->probe_flags)[0] = OLX_PROBE_BURIED;
  const olx_surface_light other = light_at(f, olx_v3(0.6f, 0.0f, 0.7f), olx_v3(0, 1, 0));
  assert_true(other.probes > 0 && other.irradiance.x > 1.9f);
  analytic_field_free(f);
}

// The bricks consist of one brick whose list names only probe 7. Two of all probes are asked for a point that it does
// not see.
static void bricks_name_the_probes_and_two_others_come_after_them(void **state) {
  (void)state;
  olx_field *f = field_of(&halved, &cage, 64, analytic_cast, of_probe);
  const olx_bricks_header header = {.cell_metres = 10.0f, .size = {1, 1, 1}, .lists = 1};
  const uint32_t index[1] = {0}, list[OLX_BRICK_LIST_WORDS] = {0xFFFF0007u, ~0u, ~0u, ~0u};
  f->bricks = (olx_bricks){.header = &header, .index = index, .lists = list};
  assert_light(f, olx_v3(2.6f, 0.0f, 0.7f), olx_v3(0, 1, 0), 8.0f);
  const olx_vec3 hidden = {0.6f, 0.0f, 0.7f}, up = {0, 1, 0};
  const olx_surface_light light = light_at(f, hidden, up);
  assert_true(light.probes == 1 && fabsf(light.irradiance.x - 1.0f) < 1e-5f);
  olx_sample_settings settings = olx_sample_settings_default();
  settings.select = OLX_SELECT_EXHAUSTIVE;
  assert_true(olx_surface_irradiance(f, &settings, olx_v3(3.4f, 0.0f, 0.7f), up, up, up).x < 2.01f);
  // Beside the wall, the two best of all probes are behind it, once those before it are farther away; the third stores
  // the point, and the reference alone asks it.
  const olx_vec3 beside = {1.85f, 0.0f, 0.7f};
  uint8_t *flags = (uint8_t *)(uintptr_t)f->probe_flags;
  flags[0] = flags[2] = OLX_PROBE_BURIED;
  assert_int_equal(light_at(f, beside, up).probes, 0);
  assert_true(fabsf(olx_surface_irradiance(f, &settings, beside, up, up, up).x - 7.0f) < 1e-5f);
  analytic_field_free(f);
}

// ---- points without stored light

static void assert_volume(const olx_field *f, olx_vec3 p, olx_vec3 n) {
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_surface_light light = light_at(f, p, n);
  const olx_vec3 volume = olx_irradiance(f, &settings, p, n, n);
  assert_int_equal(light.probes, 0);
  assert_memory_equal(&light.irradiance, &volume, sizeof volume);
}

static void points_that_no_probe_sees_get_the_volume(void **state) {
  (void)state;
  static const analytic_scene open_court = {.room = {{0, 0, 0}, {4, 3, 5}}, .open = true};
  olx_field *f = field_of(&open_court, &single, 64, analytic_cast, colored);
  assert_true(light_at(f, olx_v3(1.0f, 0.0f, 1.0f), olx_v3(0, 1, 0)).probes == 1);
  assert_volume(f, olx_v3(1.0f, 0.0f, 1.0f), olx_v3(0, -1, 0)); // the back of the floor
  assert_volume(f, olx_v3(1.0f, 0.3f, 1.0f), olx_v3(0, 1, 0));  // a point in the air
  assert_volume(f, olx_v3(1.0f, -0.3f, 1.0f), olx_v3(0, 1, 0)); // a point below the floor
  // A ceiling that was missing in the bake, so sky is stored there.
  assert_volume(f, olx_v3(1.0f, 3.0f, 1.0f), olx_v3(0, -1, 0));
  analytic_field_free(f);
  static const analytic_scene pillar = {
      .room = {{0, 0, 0}, {4, 3, 5}}, .box_count = 1, .boxes = {{{1.0f, 0.0f, 1.0f}, {1.4f, 3.0f, 1.4f}}}};
  f = field_of(&pillar, &single, 64, analytic_cast, colored);
  assert_volume(f, olx_v3(0.8f, 0.0f, 0.5f), olx_v3(0, 1, 0)); // a point in the pillar's shadow
  analytic_field_free(f);
}

// A probe's texels are 8 cm long here. Between them are things that none of them shows, like a strip a few centimetres
// high: it gets the light of a surface that is parallel to it and less than half a texel before or behind it.
static void slivers_get_the_light_of_surfaces_close_to_them(void **state) {
  (void)state;
  olx_field *f = field_of(&empty_room, &single, 64, analytic_cast, colored);
  for (uint32_t i = 0; i < 1000; i++) {
    olx_vec3 n;
    const olx_vec3 wall = on_room(i, &empty_room.room, &n);
    const olx_vec3 p = olx_madd(wall, n, i & 1 ? 0.015f : -0.015f);
    const olx_surface_light light = light_at(f, p, n);
    const olx_vec3 off = olx_sub(light.irradiance, colored(wall, n, 0));
    // Next to edges of the room a texel may see the wall that ends there.
    const bool middle = fabsf(p.x - 2.0f) < 1.9f + fabsf(n.x) && fabsf(p.y - 1.5f) < 1.4f + fabsf(n.y) &&
                        fabsf(p.z - 2.5f) < 2.4f + fabsf(n.z);
    if (middle && olx_length(off) > 1e-5f) {
      fail_msg("(%g %g %g): off by %g from %u probes", (double)p.x, (double)p.y, (double)p.z, (double)olx_length(off),
               light.probes);
    }
  }
  assert_volume(f, olx_v3(1.0f, 0.015f, 1.0f), olx_v3(1, 0, 0)); // a step's front, which no surface nearby resembles
  analytic_field_free(f);
}

// ---- normal maps

// Sets the irradiance of every irradiance probe, by the height of the normal.
static void fill_volume(olx_field *f, olx_vec3 below, olx_vec3 above) {
  uint32_t *irradiance = (uint32_t *)(uintptr_t)f->irradiance;
  const int32_t n = (int32_t)f->irradiance_n, stride = n + 2;
  for (size_t i = 0; i < f->irradiance_texels * f->info.irradiance.probe_count; i++) {
    const int32_t texel = (int32_t)(i % f->irradiance_texels);
    int32_t x, y;
    olx_border_source(texel % stride - 1, texel / stride - 1, n, &x, &y);
    irradiance[i] =
        olx_r11g11b10f_pack(olx_texel_direction((uint32_t)x, (uint32_t)y, (uint32_t)n).y > 0.9f ? above : below);
  }
}

// Checks the light of a point of the floor, where (0.5, 2, 3) is stored, for a normal that a normal map bends by 45
// degrees, while the irradiance probes have `before` for the floor's own normal and `after` for the bent one.
static void assert_bent(olx_field *f, olx_vec3 before, olx_vec3 after, olx_vec3 factor) {
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_vec3 p = {1.0f, 0.0f, 1.0f}, up = {0, 1, 0}, bent = olx_normalize(olx_v3(1, 1, 0));
  fill_volume(f, after, before);
  const olx_vec3 light = olx_surface_irradiance(f, &settings, p, up, bent, up);
  const olx_vec3 wanted = olx_mul(olx_v3(0.5f, 2.0f, 3.0f), factor), off = olx_sub(light, wanted);
  if (olx_length(off) > 1e-4f) {
    fail_msg("(%g %g %g) where (%g %g %g) belongs", (double)light.x, (double)light.y, (double)light.z, (double)wanted.x,
             (double)wanted.y, (double)wanted.z);
  }
  // Stored light contains the effect of the vertices' normals, whatever the triangle's normal is.
  const olx_surface_point smooth = {p, up, bent, bent, up};
  assert_true(fabsf(olx_surface_light_at(f, &settings, &smooth).irradiance.x - 0.5f) < 1e-5f);
}

static void normal_maps_change_light_as_they_change_that_of_the_volume(void **state) {
  (void)state;
  olx_field *f = field_of(&empty_room, &cage, 64, analytic_cast, colored);
  const float even = 0.5f + 0.5f * sqrtf(0.5f);
  // Ratios of 2, of 8, which is limited to 4, and of a half, where the volume is as bright as the floor.
  assert_bent(f, olx_v3(0.5f, 2.0f, 3.0f), olx_v3(1.0f, 16.0f, 1.5f), olx_v3(2.0f, 4.0f, 0.5f));
  assert_bent(f, olx_v3(0.5f, 2.0f, 3.0f), olx_splat(0.0f), olx_splat(0.0f));
  // Where the volume is dark it says nothing, and light is even over the hemisphere.
  assert_bent(f, olx_splat(0.0f), olx_v3(1.0f, 16.0f, 1.5f), olx_splat(even));
  // In red a ratio above darkness takes the limit, and darkness that stays dark leaves light unchanged; the volume lacks
  // the red of the floor, so its ratios count as far as its luminance reaches.
  const float alike = (0.7152f * 2.0f + 0.0722f * 3.0f) / (0.2126f * 0.5f + 0.7152f * 2.0f + 0.0722f * 3.0f);
  const float same = even + (1.0f - even) * alike, most = even + (4.0f - even) * alike;
  assert_bent(f, olx_v3(0.0f, 2.0f, 3.0f), olx_v3(1.0f, 2.0f, 3.0f), olx_v3(most, same, same));
  assert_bent(f, olx_v3(0.0f, 2.0f, 3.0f), olx_v3(0.0f, 2.0f, 3.0f), olx_splat(same));
  // Where it is half as bright, or twice, its ratio counts by half.
  assert_bent(f, olx_v3(0.25f, 1.0f, 1.5f), olx_v3(0.5f, 2.0f, 3.0f), olx_splat(0.5f * (2.0f + even)));
  assert_bent(f, olx_v3(1.0f, 4.0f, 6.0f), olx_v3(1.0f, 4.0f, 6.0f), olx_splat(0.5f * (1.0f + even)));
  analytic_field_free(f);
}

// ---- hostile input

static void assert_answered(const olx_field *f, const olx_sample_settings *settings, const olx_surface_point *p) {
  const olx_vec3 light = olx_surface_light_at(f, settings, p).irradiance;
  if (olx_finite(light) && light.x >= 0.0f && light.y >= 0.0f && light.z >= 0.0f) return;
  fail_msg("(%g %g %g): %g %g %g", (double)p->position.x, (double)p->position.y, (double)p->position.z, (double)light.x,
           (double)light.y, (double)light.z);
}

static void every_input_has_a_finite_answer(void **state) {
  (void)state;
  olx_field *f = field_of(&stepped, &cage, 16, analytic_cast, waves);
  uint16_t *maps[] = {(uint16_t *)(uintptr_t)f->distance, (uint16_t *)(uintptr_t)f->normal};
  static const float odd[] = {0.0f, -0.0f, 1e-38f, 1e-20f, 1.0f, -1.0f, 2.0f, 1e6f, NAN, INFINITY, -INFINITY};
  enum { ODD = sizeof odd / sizeof odd[0] };
  for (uint32_t round = 0; round < 2; round++) {
    for (uint32_t i = 0; i < 40000; i++) {
      float numbers[9];
      for (uint32_t k = 0; k < 9; k++) {
        const uint32_t h = olx_hash3(i, k, round);
        numbers[k] = h % 3 ? odd[h / 3 % ODD] : 5.0f * olx_unit_float(olx_hash(h)) - 1.0f;
      }
      const olx_vec3 n = olx_load3(numbers + 3);
      olx_surface_point p = {olx_load3(numbers), n, n, olx_load3(numbers + 6), n};
      if (i % 50 == 0) p.position = f->probe_positions[i / 50 % f->info.probes.count];
      olx_sample_settings settings = olx_sample_settings_default();
      settings.surface_tolerance = i % 3 ? 0.0f : OLX_MOST_SURFACE_TOLERANCE;
      settings.max_probes = i % 7 ? 128 : 0;
      settings.keep_buried = i % 2;
      assert_answered(f, &settings, &p);
    }
    // Every texel gets random distances and normals.
    for (size_t i = 0; i < f->texels * f->info.probes.count; i++) {
      maps[0][i] = (uint16_t)olx_hash((uint32_t)i) & 0x7BFFu;
      maps[1][i] = (uint16_t)olx_hash((uint32_t)i + 77);
    }
  }
  analytic_field_free(f);
}

static void tolerances_out_of_range_are_refused(void **state) {
  (void)state;
  olx_field *f = field_of(&empty_room, &single, 8, analytic_cast, colored);
  olx_sample_settings settings = olx_sample_settings_default();
  assert_true(settings.surface_tolerance == 0.0f);
  static const float bad[] = {-0.1f, 17.0f, NAN, INFINITY};
  for (uint32_t i = 0; i < 4; i++) {
    settings.surface_tolerance = bad[i];
    assert_int_equal(olx_sample_settings_check(f, &settings), OLX_ERROR_ARGUMENT);
    assert_non_null(strstr(olx_last_error(), "surface tolerance"));
  }
  settings.surface_tolerance = OLX_MOST_SURFACE_TOLERANCE;
  assert_int_equal(olx_sample_settings_check(f, &settings), OLX_OK);
  analytic_field_free(f);
}

// Points on and off the wall and its frame get the light of the default tolerance.
static void tolerances_out_of_range_count_as_none(void **state) {
  (void)state;
  const olx_grid grid = {.origin = {1.5f, 1.4f, 2.5f}, .count = {1, 1, 1}};
  olx_field *f = field_of(&framed, &grid, 128, analytic_cast, bright_frame);
  const olx_sample_settings none = olx_sample_settings_default();
  static const float bad[] = {-0.1f, -100.0f, 17.0f, 1e30f, NAN, INFINITY, -INFINITY};
  for (uint32_t i = 0; i < 300; i++) {
    const olx_vec3 n = olx_v3(1, 0, 0), p = olx_v3(0.002f * (float)(i % 8), 1.05f + 0.7f * (float)i / 300.0f, 1.988f);
    const olx_vec3 light = olx_surface_irradiance(f, &none, p, n, n, n);
    for (uint32_t k = 0; k < sizeof bad / sizeof *bad; k++) {
      olx_sample_settings settings = none;
      settings.surface_tolerance = bad[k];
      const olx_vec3 answer = olx_surface_irradiance(f, &settings, p, n, n, n);
      assert_memory_equal(&answer, &light, sizeof light);
    }
  }
  analytic_field_free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(even_light_is_answered_as_it_is),
      cmocka_unit_test(smooth_light_is_interpolated),
      cmocka_unit_test(texels_across_the_fold_are_the_neighbours),
      cmocka_unit_test(edges_do_not_bleed),
      cmocka_unit_test(blocks_do_not_bleed),
      cmocka_unit_test(a_picture_frame_and_its_wall_get_their_own_light),
      cmocka_unit_test(each_side_of_a_thin_wall_gets_its_own_light),
      cmocka_unit_test(a_ball_of_facets_is_smooth),
      cmocka_unit_test(probes_take_over_smoothly),
      cmocka_unit_test(the_nearest_probe_in_front_answers),
      cmocka_unit_test(bricks_name_the_probes_and_two_others_come_after_them),
      cmocka_unit_test(points_that_no_probe_sees_get_the_volume),
      cmocka_unit_test(slivers_get_the_light_of_surfaces_close_to_them),
      cmocka_unit_test(normal_maps_change_light_as_they_change_that_of_the_volume),
      cmocka_unit_test(every_input_has_a_finite_answer),
      cmocka_unit_test(tolerances_out_of_range_are_refused),
      cmocka_unit_test(tolerances_out_of_range_count_as_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
