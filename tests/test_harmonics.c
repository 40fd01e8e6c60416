// Tests irradiance as spherical harmonics: functions within the bands are exact, others ring as predicted, and the
// runtime shows no negative light.
#include "synthetic_field.h"

#include "bake/irradiance/projection.h"
#include "bake/irradiance/quadrature.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "shade/irradiance.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

enum { DIRECTIONS = 500, WHOLE = OLX_HARMONICS_MOST_BANDS };

static olx_vec3 random_direction(uint32_t i) {
  return olx_sample_sphere((olx_vec2){olx_unit_float(olx_hash(i)), olx_unit_float(olx_hash(i + 0x1000u))});
}

static olx_vec3 axis(void) { return olx_normalize(olx_v3(0.3f, -0.8f, 0.52f)); }

typedef float (*function)(float cosine); // a function of the cosine of the angle between normal and axis
static float even(float c) { return OLX_PI + 0.0f * c; }
static float lobe(float c) { return OLX_PI * (1.0f + 2.0f / 3.0f * c); } // irradiance of radiance 1 + c
// Irradiance with a band of 3 c^2 - 1 added.
static float quadratic(float c) { return lobe(c) + OLX_PI * 0.25f * (3.0f * c * c - 1.0f); }
static float sun(float c) { return olx_max(c, 0.0f); }

static void project_at(function f, uint32_t bands, uint32_t size, olx_vec3 *coefficients) {
  olx_projection projection;
  assert_int_equal(olx_projection_create(bands, size, &projection), OLX_OK);
  olx_vec3 *map = olx_allocate((size_t)size * size, sizeof *map);
  for (uint32_t t = 0; t < size * size; t++) {
    const float value = f(olx_dot(olx_texel_direction(t % size, t / size, size), axis()));
    map[t] = olx_v3(value, 2.0f * value, 0.5f * value);
  }
  olx_project(&projection, map, coefficients);
  olx_release(map);
  olx_projection_free(&projection);
}

static float evaluate(const olx_vec3 *coefficients, uint32_t bands, olx_vec3 normal) {
  float values[OLX_HARMONICS_MOST], sum = 0.0f;
  olx_harmonics_at(normal, values);
  for (uint32_t i = 0; i < olx_harmonics_count(bands); i++) sum += coefficients[i].x * values[i];
  return sum;
}

static float greatest_error(function f, uint32_t bands, uint32_t size) {
  olx_vec3 coefficients[OLX_HARMONICS_MOST];
  float worst = 0.0f;
  project_at(f, bands, size, coefficients);
  for (uint32_t i = 0; i < DIRECTIONS; i++) {
    const olx_vec3 normal = random_direction(i);
    worst = olx_max(worst, fabsf(evaluate(coefficients, bands, normal) - f(olx_dot(normal, axis()))));
  }
  return worst;
}

static void what_is_in_the_bands_is_exact(void **state) {
  (void)state;
  for (uint32_t size = 8; size <= 128; size *= 4) {
    assert_true(greatest_error(even, 2, size) < 1e-5f);
    assert_true(greatest_error(lobe, 2, size) < 1e-5f);
    assert_true(greatest_error(even, 3, size) < 1e-5f);
    assert_true(greatest_error(lobe, 3, size) < 1e-5f);
    assert_true(greatest_error(quadratic, 3, size) < 2e-5f);
    assert_true(greatest_error(quadratic, 2, size) > 1.0f); // without the band of 3 c^2 - 1, which is at most pi/2
  }
}

static void functions_are_orthogonal(void **state) {
  (void)state;
  double product[OLX_HARMONICS_MOST][OLX_HARMONICS_MOST] = {{0.0}};
  const uint32_t n = 128;
  for (uint32_t t = 0; t < n * n; t++) {
    float values[OLX_HARMONICS_MOST];
    olx_harmonics_at(olx_texel_direction(t % n, t / n, n), values);
    for (uint32_t k = 0; k < OLX_HARMONICS_MOST * OLX_HARMONICS_MOST; k++) {
      product[k / OLX_HARMONICS_MOST][k % OLX_HARMONICS_MOST] += olx_texel_solid_angle(t % n, t / n, n) *
                                                                 (double)values[k / OLX_HARMONICS_MOST] *
                                                                 (double)values[k % OLX_HARMONICS_MOST];
    }
  }
  for (uint32_t i = 0; i < OLX_HARMONICS_MOST; i++) {
    for (uint32_t j = 0; j < OLX_HARMONICS_MOST; j++) {
      assert_true(fabs(product[i][j] / (4.0 * 3.14159265358979) -
                       (i == j ? (double)olx_harmonics_mean_square(i) : 0.0)) < 1e-3);
    }
  }
}

// Of light from one direction, max(c, 0), two bands keep 1/4 + c/2, and three bands 5/32 (3 c^2 - 1) more (Ramamoorthi
// and Hanrahan 2001).
static void a_sun_rings(void **state) {
  (void)state;
  olx_vec3 two[OLX_HARMONICS_MOST], three[OLX_HARMONICS_MOST];
  project_at(sun, 2, 128, two);
  project_at(sun, 3, 128, three);
  float least[2] = {1.0f, 1.0f};
  for (uint32_t i = 0; i < DIRECTIONS; i++) {
    const olx_vec3 normal = random_direction(i);
    const float c = olx_dot(normal, axis()), kept = 0.25f + 0.5f * c;
    const float found[2] = {evaluate(two, 2, normal), evaluate(three, 3, normal)};
    assert_float_equal(found[0], kept, 1e-3f);
    assert_float_equal(found[1], kept + 5.0f / 32.0f * (3.0f * c * c - 1.0f), 1e-3f);
    for (uint32_t k = 0; k < 2; k++) least[k] = olx_min(least[k], found[k]);
  }
  assert_float_equal(least[0], -0.25f, 5e-3f);   // two bands: opposite to the sun
  assert_float_equal(least[1], -0.0396f, 2e-3f); // three bands: a little beyond the terminator
  assert_float_equal(evaluate(three, 3, olx_negate(axis())), 0.0625f, 1e-3f); // three bands: light opposite to the sun
}

static olx_vec3 uniform(void) { return olx_v3(1.0f, 2.0f, 0.5f); }

// Uniform radiance passes through the baker's irradiance, the projection and the file's half floats.
static void a_constant_environment_is_pi_l(void **state) {
  (void)state;
  const uint32_t n = 8;
  olx_quadrature q;
  assert_int_equal(olx_quadrature_create(n, &q), OLX_OK);
  olx_vec3 *cells = olx_allocate((size_t)q.cells * q.cells, sizeof *cells), map[64], coefficients[OLX_HARMONICS_MOST];
  for (uint32_t c = 0; c < q.cells * q.cells; c++) cells[c] = uniform();
  for (uint32_t row = 0; row < n / OLX_BLOCK_ROWS; row++) olx_quadrature_irradiance(&q, cells, n, row, map, n);
  for (uint32_t bands = 2; bands <= WHOLE; bands++) {
    olx_projection projection;
    uint16_t halves[OLX_HARMONICS_MOST_HALVES];
    assert_int_equal(olx_projection_create(bands, n, &projection), OLX_OK);
    olx_project(&projection, map, coefficients);
    olx_harmonics_pack(coefficients, bands, halves);
    assert_int_equal(olx_harmonics_first_bad(halves, bands), olx_harmonics_halves(bands));
    for (uint32_t i = 0; i < DIRECTIONS; i++) {
      float values[OLX_HARMONICS_MOST];
      olx_harmonics_at(random_direction(i), values);
      const olx_vec3 found = olx_harmonics_irradiance(halves, bands, values);
      assert_float_equal(found.x / OLX_PI, 1.0f, 6e-4f); // the 2^-11 of a half float, and the remainder of other bands
      assert_float_equal(found.y / OLX_PI, 2.0f, 12e-4f);
      assert_float_equal(found.z / OLX_PI, 0.5f, 3e-4f);
    }
    olx_projection_free(&projection);
  }
  olx_release(cells);
  olx_quadrature_free(&q);
}

static void packing_keeps_numbers_possible(void **state) {
  (void)state;
  const olx_vec3 wild[OLX_HARMONICS_MOST] = {{-1e-6f, 1e9f, -0.0f}, {-1e9f, 1e9f, 0.25f}, {3.0f, -4.0f, 5.0f}};
  uint16_t halves[OLX_HARMONICS_MOST_HALVES];
  for (uint32_t bands = 2; bands <= WHOLE; bands++) {
    assert_int_equal(olx_harmonics_halves(bands), bands == 2 ? 12 : 28);
    olx_harmonics_pack(wild, bands, halves);
    assert_int_equal(olx_harmonics_first_bad(halves, bands), olx_harmonics_halves(bands));
    assert_true(olx_harmonics_coefficient(halves, 0).x == 0.0f);
    assert_true(olx_harmonics_coefficient(halves, 0).y == 65504.0f);
    assert_true(olx_harmonics_coefficient(halves, 1).x == -65504.0f);
    assert_true(olx_harmonics_coefficient(halves, 2).y == -4.0f);
  }
}

// Interpolated irradiance is the weighted sum of the probes' harmonics, clamped at 0, with the same weights as for
// maps.
static void the_runtime_shows_no_negative_light(void **state) {
  (void)state;
  char path[] = "/tmp/octalux-harmonics-XXXXXX";
  close(mkstemp(path));
  for (olx_irradiance_form form = OLX_IRRADIANCE_SH2; form <= OLX_IRRADIANCE_SH3; form++) {
    const synthetic_shape shape = {
        .grid = {1, 1, 1}, .irradiance_grid = {2, 3, 2}, .n = 8, .irradiance_n = 8, .irradiance_form = form};
    olx_field *field;
    assert_int_equal(synthetic_write(path, &shape, NULL), OLX_OK);
    assert_int_equal(olx_field_open(path, &field), OLX_OK);
    const olx_sample_settings settings = olx_sample_settings_default();
    const olx_irradiance_source source = olx_irradiance_source_of(field);
    uint32_t dark = 0, negative = 0;
    for (uint32_t i = 0; i < DIRECTIONS; i++) {
      const olx_vec3 normal = random_direction(i), place = olx_scale(random_direction(i + 77), 1.5f);
      const olx_irradiance_weights weights =
          olx_irradiance_weigh(&source, OLX_WEIGHT_ALL, false, place, normal, normal);
      olx_vec3 sum = {0};
      for (uint32_t k = 0; k < weights.count; k++) {
        const olx_vec3 held = olx_probe_irradiance(field, weights.probe[k], normal);
        assert_false(olx_field_irradiance_probe_buried(field, weights.probe[k]));
        negative += held.x < 0.0f;
        sum = olx_madd(sum, held, weights.weight[k]);
      }
      const olx_vec3 found = olx_irradiance(field, &settings, place, normal, normal);
      assert_true(found.x >= 0.0f && found.y >= 0.0f && found.z >= 0.0f);
      assert_true(found.x == olx_max(sum.x, 0.0f) && found.y == olx_max(sum.y, 0.0f));
      dark += sum.x < 0.0f;
    }
    assert_true(negative > DIRECTIONS / 20 && dark > 0);
    olx_field_close(field);
  }
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_in_the_bands_is_exact),
      cmocka_unit_test(functions_are_orthogonal),
      cmocka_unit_test(a_sun_rings),
      cmocka_unit_test(a_constant_environment_is_pi_l),
      cmocka_unit_test(packing_keeps_numbers_possible),
      cmocka_unit_test(the_runtime_shows_no_negative_light),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
