// Compares the baseline (docs/maths.md, "The baseline") with the integrals that its maps approximate, and with scenes
// whose light is known.
#include "bake/irradiance/classic_filter.h"
#include "baked_field.h"
#include "core/bsdf.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/sampling.h"
#include "field/field_data.h"
#include "shade/classic.h"

#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// --- The reflection model, integrated here on its own

typedef struct vector {
  double x, y, z;
} vector;

static double masking(double alpha, double cosine) {
  const double k = alpha / 2.0;
  return cosine / (cosine * (1.0 - k) + k);
}

// Returns Cook-Torrance times the cosine at the light, for a surface with normal +z.
static double reflection(double alpha, vector v, vector l, double f0) {
  if (l.z <= 0.0) return 0.0;
  vector h = {v.x + l.x, v.y + l.y, v.z + l.z};
  const double length = sqrt(h.x * h.x + h.y * h.y + h.z * h.z);
  h = (vector){h.x / length, h.y / length, h.z / length};
  const double a2 = alpha * alpha, d = (h.x * h.x + h.y * h.y) + h.z * h.z * a2, vh = v.x * h.x + v.y * h.y + v.z * h.z;
  const double distribution = a2 / ((double)OLX_PI * d * d), fresnel = f0 + (1.0 - f0) * pow(1.0 - vh, 5.0);
  return distribution * fresnel * masking(alpha, v.z) * masking(alpha, l.z) / (4.0 * v.z);
}

// Returns the share of light reflected towards `v` under light of 1 from everywhere, integrated over half vectors (x =
// tan theta / alpha in growing steps, and azimuth), not over draws from the distribution.
static double albedo(double alpha, double cosine, double f0) {
  enum { STEPS = 500, TURNS = 100 };
  const vector v = {sqrt(1.0 - cosine * cosine), 0.0, cosine};
  double sum = 0.0;
  for (int i = 0; i < STEPS; i++) {
    const double q = (i + 0.5) / STEPS, x = q / (1.0 - q), dx = 1.0 / (STEPS * (1.0 - q) * (1.0 - q));
    const double tangent = alpha * x, c = 1.0 / sqrt(1.0 + tangent * tangent), s = tangent * c;
    for (int k = 0; k < TURNS; k++) {
      const double phi = (double)OLX_PI * (k + 0.5) / TURNS;
      const vector h = {s * cos(phi), s * sin(phi), c};
      const double vh = v.x * h.x + v.z * h.z;
      if (vh <= 0.0) continue;
      const vector l = {2.0 * vh * h.x - v.x, 2.0 * vh * h.y, 2.0 * vh * h.z - v.z};
      // The solid angle of h is s d theta d phi, with d theta = alpha c^2 dx; that of l is 4 v.h times larger.
      sum += reflection(alpha, v, l, f0) * 4.0 * vh * s * alpha * c * c * dx * 2.0 * (double)OLX_PI / TURNS;
    }
  }
  return sum;
}

static const float roughnesses[] = {0.1f, 0.15f, 0.2f, 0.3f, 0.41f, 0.5f, 0.63f, 0.77f, 0.9f, 1.0f};
static const float cosines[] = {0.02f, 0.05f, 0.1f, 0.23f, 0.37f, 0.5f, 0.66f, 0.81f, 0.95f, 1.0f};

static uint32_t *table_make(void) {
  uint32_t *table = olx_allocate(OLX_CLASSIC_TABLE_ENTRIES, sizeof *table);
  assert_int_equal(olx_classic_table_make(table, 0), OLX_OK);
  return table;
}

static void the_table_holds_the_integrals_it_stands_for(void **state) {
  (void)state;
  uint32_t *table = table_make();
  double worst = 0.0;
  for (uint32_t i = 0; i < 10; i++) {
    for (uint32_t k = 0; k < 10; k++) {
      const double alpha = (double)(roughnesses[i] * roughnesses[i]);
      const double none = albedo(alpha, (double)cosines[k], 0.0), full = albedo(alpha, (double)cosines[k], 1.0);
      const olx_vec2 stored = olx_classic_reflectance(table, cosines[k], roughnesses[i]);
      const double bias = fabs((double)stored.y - none), scale = fabs((double)stored.x - (full - none));
      if (bias > 0.005 || scale > 0.005) {
        fail_msg("roughness %g, cosine %g: scale %f for %f, bias %f for %f", (double)roughnesses[i], (double)cosines[k],
                 (double)stored.x, full - none, (double)stored.y, none);
      }
      worst = fmax(worst, fmax(bias, scale));
    }
  }
  print_message("table: off by %.5f at most\n", worst);
  olx_release(table);
}

// --- Filtering a cube map

typedef olx_vec3 (*environment)(olx_vec3 direction);

static olx_vec3 uniform(olx_vec3 d) {
  (void)d;
  return olx_v3(1.0f, 0.5f, 4.0f);
}
static olx_vec3 linear(olx_vec3 d) { return olx_v3(1.0f + d.x, 1.0f + d.y, 1.0f - d.z); }
static olx_vec3 halved(olx_vec3 d) { return olx_splat(d.x + 0.3f * d.y > 0.0f ? 1.0f : 0.0f); }

static olx_classic_filter filtered(environment light, uint32_t size, uint32_t cube_size, uint32_t sharpness) {
  olx_classic_filter f = {.size = size, .cube_size = cube_size};
  f.sharpness = sharpness ? sharpness : olx_classic_sharpness(size, cube_size);
  assert_int_equal(olx_classic_filter_create(&f), OLX_OK);
  for (uint32_t i = 0; i < OLX_CUBE_FACES * cube_size * cube_size; i++) {
    const olx_cube_face face = olx_cube_face_of(i / (cube_size * cube_size));
    const float u = (2.0f * (float)(i % cube_size) + 1.0f) / (float)cube_size - 1.0f,
                v = (2.0f * (float)(i / cube_size % cube_size) + 1.0f) / (float)cube_size - 1.0f;
    f.cube[i] = light(olx_normalize(olx_cube_direction(&face, u, v)));
  }
  assert_int_equal(olx_classic_filter_run(&f, NULL), OLX_OK);
  return f;
}

static void assert_near(olx_vec3 value, olx_vec3 expected, float tolerance) {
  const olx_vec3 off = olx_sub(value, expected);
  if (fabsf(off.x) <= tolerance && fabsf(off.y) <= tolerance && fabsf(off.z) <= tolerance) return;
  fail_msg("(%g %g %g), not (%g %g %g)", (double)value.x, (double)value.y, (double)value.z, (double)expected.x,
           (double)expected.y, (double)expected.z);
}

// Split sum and prefiltered radiance together give the directional albedo under uniform light, within 1 %.
static void uniform_light_comes_back_as_the_directional_albedo(void **state) {
  (void)state;
  static const uint32_t sizes[3][2] = {{32, 32}, {64, 128}, {128, 64}};
  for (uint32_t i = 0; i < 3; i++) {
    olx_classic_filter f = filtered(uniform, sizes[i][0], sizes[i][1], 0);
    const uint32_t texels = f.size * f.size;
    for (uint32_t k = 0; k < texels; k += 7)
      assert_near(f.irradiance[k], olx_scale(uniform(olx_splat(0)), OLX_PI), 1e-3f);
    for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
      const uint32_t side = olx_classic_side(f.size, level);
      for (uint32_t k = 0; k < side * side; k++) assert_near(f.levels[level][k], uniform(olx_splat(0)), 1e-4f);
    }
    olx_classic_filter_free(&f);
  }
  // Prefiltered uniform light is uniform, so only the table remains to be tested.
  uint32_t *table = table_make();
  for (uint32_t i = 0; i < 10; i++) {
    for (uint32_t k = 0; k < 10; k++) {
      for (float f0 = 0.04f; f0 <= 1.0f; f0 += 0.48f) {
        const double expected = albedo((double)(roughnesses[i] * roughnesses[i]), (double)cosines[k], (double)f0);
        const olx_vec2 r = olx_classic_reflectance(table, cosines[k], roughnesses[i]);
        const double value = (double)(f0 * r.x + r.y);
        if (fabs(value - expected) <= 0.01 * expected) continue;
        fail_msg("roughness %g, cosine %g, F0 %g: %f, not %f", (double)roughnesses[i], (double)cosines[k], (double)f0,
                 value, expected);
      }
    }
  }
  olx_release(table);
}

// Returns the mean cosine of the directions that a rough lobe reflects to an eye along the normal.
static double mean_cosine(double alpha) {
  enum { STEPS = 200000 };
  double weights = 0.0, sum = 0.0;
  for (int i = 0; i < STEPS; i++) {
    const double theta = 0.25 * (double)OLX_PI * (i + 0.5) / STEPS, c = cos(theta), l = cos(2.0 * theta);
    const double d = 1.0 - c * c + c * c * alpha * alpha, weight = masking(alpha, l) / (d * d) * sin(2.0 * theta);
    weights += weight;
    sum += weight * l;
  }
  return sum / weights;
}

static void light_that_grows_linearly_is_filtered_as_it_should(void **state) {
  (void)state;
  olx_classic_filter f = filtered(linear, 64, 64, 0);
  for (uint32_t i = 0; i < 64 * 64; i++) {
    const olx_vec3 n = olx_texel_direction(i % 64, i / 64, 64);
    const olx_vec3 growth = olx_v3(n.x, n.y, -n.z);
    assert_near(f.irradiance[i], olx_madd(olx_splat(OLX_PI), growth, 2.0f * OLX_PI / 3.0f), 0.012f);
    assert_near(f.levels[0][i], olx_add(olx_splat(1.0f), growth), 0.004f);
  }
  for (uint32_t level = 1; level < OLX_CLASSIC_LEVELS; level++) {
    const uint32_t side = olx_classic_side(64, level);
    const float roughness = (float)level / 4.0f, cosine = (float)mean_cosine((double)(roughness * roughness));
    for (uint32_t i = 0; i < side * side; i++) {
      const olx_vec3 n = olx_texel_direction(i % side, i / side, side);
      assert_near(f.levels[level][i], olx_madd(olx_splat(1.0f), olx_v3(n.x, n.y, -n.z), cosine), 0.01f);
    }
  }
  olx_classic_filter_free(&f);
}

// Returns how far from an edge the octahedral map still blurs, for a sharpness of the filter.
static float blur_of(uint32_t sharpness) {
  olx_classic_filter f = filtered(halved, 64, 128, sharpness);
  const olx_vec3 across = olx_normalize(olx_v3(1.0f, 0.3f, 0.0f));
  float widest = 0.0f;
  for (uint32_t i = 0; i < 64 * 64; i++) {
    const float sine = olx_dot(olx_texel_direction(i % 64, i / 64, 64), across), value = f.levels[0][i].x;
    assert_true(value >= 0.0f && value <= 1.0f + 1e-5f);
    if (fabsf(value - (sine > 0.0f ? 1.0f : 0.0f)) > 0.02f) widest = fmaxf(widest, fabsf(sine));
  }
  olx_classic_filter_free(&f);
  return widest;
}

static void sharpness_narrows_the_filter(void **state) {
  (void)state;
  const float wide = blur_of(100), middle = blur_of(1000), narrow = blur_of(10000);
  // The blur reaches two deviations of a lobe, 1 / root of the exponent each, and a texel.
  assert_true(wide > 0.15f && wide < 0.25f);
  assert_true(middle > 0.04f && middle < 0.08f);
  assert_true(narrow < 0.03f);
  // A lobe that falls between the texels of a coarse cube map takes the nearest texel.
  olx_classic_filter f = filtered(uniform, 256, 32, 65536);
  for (uint32_t i = 0; i < 256 * 256; i += 97) assert_near(f.levels[0][i], uniform(olx_splat(0)), 1e-4f);
  olx_classic_filter_free(&f);
}

// --- Parallax

static void a_box_room_is_seen_without_parallax(void **state) {
  (void)state;
  const olx_classic_box box = {{-1.0f, 0.0f, -2.0f}, {3.0f, 2.5f, 1.0f}};
  const olx_vec3 probe = {0.5f, 1.0f, -1.0f};
  for (uint32_t i = 0; i < 2000; i++) {
    const olx_vec3 inside = {olx_unit_float(olx_hash(3 * i)), olx_unit_float(olx_hash(3 * i + 1)),
                             olx_unit_float(olx_hash(3 * i + 2))};
    const olx_vec3 p = olx_add(box.low, olx_mul(inside, olx_sub(box.high, box.low)));
    const olx_vec3 d = olx_sample_sphere(olx_hammersley(i, 2000));
    const olx_vec3 towards = olx_classic_parallax(&box, probe, p, d);
    // The ray must meet the wall at the point where the probe's direction meets it.
    float from_probe = INFINITY, from_point = INFINITY;
    for (uint32_t axis = 0; axis < 3; axis++) {
      const float *low = &box.low.x + axis, *high = &box.high.x + axis;
      const float t = (&towards.x)[axis], u = (&d.x)[axis];
      if (t != 0.0f) from_probe = olx_min(from_probe, ((t > 0.0f ? *high : *low) - (&probe.x)[axis]) / t);
      if (u != 0.0f) from_point = olx_min(from_point, ((u > 0.0f ? *high : *low) - (&p.x)[axis]) / u);
    }
    assert_near(olx_madd(probe, towards, from_probe), olx_madd(p, d, from_point), 1e-4f);
  }
  // Directions are unit vectors even from a point outside the box, and when the box is a point.
  const olx_vec3 d = {0.0f, 0.0f, 1.0f};
  assert_near(olx_classic_parallax(&box, probe, olx_v3(9.0f, 1.0f, -1.0f), d),
              olx_normalize(olx_sub(olx_v3(3.0f, 1.0f, 1.0f), probe)), 1e-6f);
  assert_near(olx_classic_parallax(&(olx_classic_box){probe, probe}, probe, olx_splat(0.0f), d), d, 0.0f);
}

// --- Fields

static olx_scene *load(const char *name) {
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load(name, &scene), OLX_OK);
  return scene;
}

static olx_bake_settings small_bake(const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.probe_light = true;
  settings.irradiance_grid = settings.grid; // as in the dissertation
  settings.radiance_size = 32;
  settings.irradiance_size = 32;
  settings.classic = true;
  settings.classic_size = 32;
  settings.classic_cube_size = 64;
  return settings;
}

// With emission 1 and a reflectance of one half everywhere, reflected light is 1 - 1/2^(bounces + 1). Lamps are sampled
// at random, so single texels are noisy, but their mean is not.
static void a_furnace_is_even(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:furnace");
  olx_bake_settings settings = small_bake(scene);
  settings.bounces = 4;
  olx_field *field = baked_field(scene, &settings, NULL);
  const olx_sample_settings sample = olx_sample_settings_default();
  const float light = 1.0f - 1.0f / 32.0f;
  enum { POINTS = 400 };
  for (uint32_t level = 0; level < 5; level++) {
    const float roughness = level > 0 ? (float)level / 4.0f : 0.1f;
    const double alpha = (double)(roughness * roughness);
    double excess = 0.0;
    for (uint32_t i = 0; i < POINTS; i++) {
      const olx_vec3 p = olx_sub(olx_scale(olx_v3(olx_unit_float(olx_hash(3 * i)), olx_unit_float(olx_hash(3 * i + 1)),
                                                  olx_unit_float(olx_hash(3 * i + 2))),
                                           2.0f),
                                 olx_splat(1.0f));
      const olx_vec3 n = olx_sample_sphere(olx_hammersley(i, POINTS));
      assert_near(olx_classic_irradiance(field, &sample, p, n), olx_splat(OLX_PI * light), 0.02f * OLX_PI);
      olx_vec3 tangent, bitangent;
      olx_basis(n, &tangent, &bitangent);
      const float cosine = cosines[1 + i % 8], sine = sqrtf(1.0f - cosine * cosine);
      const olx_vec3 view = olx_madd(olx_scale(n, cosine), tangent, sine);
      const olx_vec3 seen = olx_classic_glossy(field, &sample, p, n, view, roughness, olx_splat(0.9f), 1.0f);
      if (i < 8) excess -= albedo(alpha, (double)cosine, 0.9) * (double)light / 8.0;
      excess += (double)seen.x / POINTS;
    }
    if (fabs(excess) > 0.01) fail_msg("roughness %g: %f too much", (double)roughness, excess);
  }
  olx_field_close(field);
  olx_scene_free(scene);
}

static void boxes_are_the_room(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:two-rooms-sealed");
  olx_bake_settings settings = small_bake(scene);
  settings.bounces = 0;
  olx_field *field = baked_field(scene, &settings, NULL);
  for (uint32_t i = 0; i < field->info.irradiance.probe_count; i++) {
    const bool left = field->irradiance_positions[i].x < 0.0f;
    const olx_classic_box box = field->classic.boxes[i];
    assert_near(box.low, olx_v3(left ? -4.1f : 0.1f, 0.0f, -2.0f), 1e-3f);
    assert_near(box.high, olx_v3(left ? -0.1f : 4.1f, 3.0f, 2.0f), 1e-3f);
  }
  assert_int_equal(field->info.classic.size, 32);
  assert_int_equal(field->info.classic.cube_size, 64);
  assert_true(field->info.classic.sharpness == 512.0f);
  olx_field_close(field);
  olx_scene_free(scene);
}

// A mirror shows the colour of the wall that it faces when its probe is beside it: red and green in the Cornell box.
static void mirrors_show_the_walls(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = small_bake(scene);
  settings.classic_size = 64;
  settings.bounces = 1;
  olx_field *field = baked_field(scene, &settings, NULL);
  const olx_sample_settings sample = olx_sample_settings_default();
  const olx_vec3 p = {0.278f, 0.45f, 0.1f}, white = olx_splat(1.0f);
  for (float roughness = 0.0f; roughness <= 0.3f; roughness += 0.15f) {
    const olx_vec3 left = {1.0f, 0.0f, 0.0f}, right = {-1.0f, 0.0f, 0.0f};
    const olx_vec3 a = olx_classic_glossy(field, &sample, p, left, left, roughness, white, 1.0f),
                   b = olx_classic_glossy(field, &sample, p, right, right, roughness, white, 1.0f);
    const bool a_is_red = a.x > a.y;
    const olx_vec3 red = a_is_red ? a : b, green = a_is_red ? b : a;
    assert_true(red.x > 3.0f * red.y && green.y > 1.5f * green.x);
  }
  olx_field_close(field);
  olx_scene_free(scene);
}

static void bytes_do_not_depend_on_threads(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell-glossy");
  olx_bake_settings settings = small_bake(scene);
  settings.noise = 0.2f;
  baked_field_at_any_threads(scene, &settings);
  olx_scene_free(scene);
}

// Asserts that a field without classic maps answers 0.
static void assert_dark(const olx_field *field) {
  const olx_sample_settings sample = olx_sample_settings_default();
  const olx_vec3 p = field->irradiance_positions[0], n = {0.0f, 1.0f, 0.0f}, white = olx_splat(1.0f);
  assert_int_equal(olx_classic_check(field), OLX_ERROR_ARGUMENT);
  assert_near(olx_classic_irradiance(field, &sample, p, n), olx_splat(0.0f), 0.0f);
  assert_near(olx_classic_glossy(field, &sample, p, n, n, 0.5f, white, 1.0f), olx_splat(0.0f), 0.0f);
}

// A bake without --classic writes no classic maps, and a bake with them changes no other chunk.
static void classic_maps_are_added_to_the_same_field(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  olx_bake_settings settings = small_bake(scene);
  settings.noise = 0.2f;
  olx_field *with = baked_field(scene, &settings, NULL);
  settings.classic = false;
  olx_field *without = baked_field(scene, &settings, NULL);
  assert_int_equal(without->info.classic.size, 0);
  assert_int_equal(without->info.bytes.classic, 0);
  assert_dark(without);
  const size_t probes = with->info.probes.count, others = with->info.irradiance.probe_count;
  assert_memory_equal(with->radiance, without->radiance, 4 * probes * with->texels);
  assert_memory_equal(with->irradiance, without->irradiance, 4 * others * with->irradiance_texels);
  const size_t added = with->size_bytes - without->size_bytes, maps = with->info.bytes.classic;
  assert_true(added >= maps && added <= maps + 4 * (64 + 64)); // and their entries in the table, and padding
  olx_field_close(with);
  olx_field_close(without);
  olx_scene_free(scene);
}

static void settings_out_of_range_are_refused(void **state) {
  (void)state;
  olx_scene *scene = load("builtin:cornell");
  const olx_bake_settings good = small_bake(scene);
  olx_bake_settings settings = good;
#define REFUSED(change, message)                                                                                       \
  settings.change;                                                                                                     \
  assert_int_equal(olx_bake(scene, &settings, "/nonexistent/a.olx", NULL, NULL), OLX_ERROR_ARGUMENT);                  \
  assert_non_null(strstr(olx_last_error(), message));                                                                  \
  settings = good
  REFUSED(classic_size = 16, "classic size of 16 texels");
  REFUSED(classic_size = 512, "classic size of 512 texels");
  REFUSED(classic_size = 96, "classic size of 96 texels");
  REFUSED(classic_cube_size = 16, "cube size of 16 texels");
  REFUSED(classic_cube_size = 2048, "cube size of 2048 texels");
  REFUSED(classic_sharpness = 63, "sharpness 63");
  REFUSED(classic_sharpness = 65537, "sharpness 65537");
#undef REFUSED
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_table_holds_the_integrals_it_stands_for),
      cmocka_unit_test(uniform_light_comes_back_as_the_directional_albedo),
      cmocka_unit_test(light_that_grows_linearly_is_filtered_as_it_should),
      cmocka_unit_test(sharpness_narrows_the_filter),
      cmocka_unit_test(a_box_room_is_seen_without_parallax),
      cmocka_unit_test(a_furnace_is_even),
      cmocka_unit_test(boxes_are_the_room),
      cmocka_unit_test(mirrors_show_the_walls),
      cmocka_unit_test(bytes_do_not_depend_on_threads),
      cmocka_unit_test(classic_maps_are_added_to_the_same_field),
      cmocka_unit_test(settings_out_of_range_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
