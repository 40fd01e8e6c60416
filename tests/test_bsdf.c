// Tests the reflection model: normalisation, sampling against densities, reciprocity, energy.
#include "core/bsdf.h"
#include "core/sampling.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const float ROUGHNESSES[] = {0.03f, 0.1f, 0.3f, 0.5f, 0.7f, 1.0f};
static const float VIEW_COSINES[] = {1.0f, 0.9f, 0.6f, 0.3f, 0.1f, 0.02f};
enum { ROUGHNESS_COUNT = 6, VIEW_COUNT = 6 };

static olx_vec3 direction(float cosine, float azimuth) {
  const float sine = sqrtf(olx_max(0.0f, 1.0f - cosine * cosine));
  return olx_v3(sine * cosf(azimuth), sine * sinf(azimuth), cosine);
}

static olx_vec2 random_pair(uint32_t i, uint32_t salt) {
  return (olx_vec2){olx_unit_float(olx_hash3(i, salt, 0)), olx_unit_float(olx_hash3(i, salt, 1))};
}

static void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance)) fail_msg("%.9g is not %.9g within %g", value, expected, tolerance);
}

// ---- the distribution of normals

// Returns a half vector for (u, turn) in [0, 1)^2: tan^2 / alpha^2 = 1 / (1 - u)^2 - 1, so that integrals over u are
// smooth for any alpha, up to grazing angles. *solid_angle is that of the whole square at this point.
static olx_vec3 half_at(float alpha, double u, double turn, double *solid_angle) {
  const double rest = 1.0 - u, a2 = (double)alpha * (double)alpha, b = 1.0 + a2 * (1.0 / (rest * rest) - 1.0);
  const double cosine = sqrt(1.0 / b), sine = sqrt(1.0 - 1.0 / b), azimuth = (2.0 * turn - 1.0) * (double)OLX_PI;
  *solid_angle = a2 / (rest * rest * rest * b * b * cosine) * 2.0 * (double)OLX_PI;
  return olx_v3((float)(sine * cos(azimuth)), (float)(sine * sin(azimuth)), (float)cosine);
}

// The projected area of the microfacets is that of the surface: the integral of D cos over the hemisphere is 1.
static void normals_project_to_the_surface(void **state) {
  (void)state;
  enum { CELLS = 4096 };
  for (uint32_t r = 0; r < ROUGHNESS_COUNT; r++) {
    const float alpha = ROUGHNESSES[r] * ROUGHNESSES[r];
    double sum = 0.0, solid_angle;
    for (uint32_t i = 0; i < CELLS; i++) {
      const olx_vec3 half = half_at(alpha, (i + 0.5) / CELLS, 0.7, &solid_angle);
      sum += (double)(olx_ggx_distribution(alpha, half) * half.z) * solid_angle / CELLS;
    }
    assert_near(sum, 1.0, 1e-5);
  }
}

// Smith's condition: the visible microfacets project to the view's cosine.
static void visible_normals_project_to_the_view(void **state) {
  (void)state;
  enum { CELLS = 256 };
  for (uint32_t r = 0; r < ROUGHNESS_COUNT; r++) {
    for (uint32_t v = 0; v < VIEW_COUNT; v++) {
      const float alpha = ROUGHNESSES[r] * ROUGHNESSES[r];
      const olx_vec3 view = direction(VIEW_COSINES[v], 0.0f);
      const double visible = 1.0 / (1.0 + (double)olx_ggx_lambda(alpha, view.z));
      double sum = 0.0, solid_angle;
      for (uint32_t i = 0; i < CELLS * CELLS; i++) {
        const olx_vec3 half = half_at(alpha, (i % CELLS + 0.5) / CELLS, (i / CELLS + 0.5) / CELLS, &solid_angle);
        const double facing = fmax(0.0, (double)olx_dot(view, half));
        sum += visible * facing * (double)olx_ggx_distribution(alpha, half) * solid_angle / (CELLS * CELLS);
      }
      assert_near(sum / (double)view.z, 1.0, 1e-3);
    }
  }
}

// ---- sampling against the density

enum { RINGS = 20, SECTORS = 20, FINE = 16, DRAWS = 1 << 16 };

// Returns the cell of half_at's square that a half vector falls into.
static uint32_t half_cell(float alpha, olx_vec3 half) {
  const float u = 1.0f - 1.0f / sqrtf(1.0f + (half.x * half.x + half.y * half.y) / olx_square(half.z * alpha));
  const float turn = (atan2f(half.y, half.x) + OLX_PI) / (2.0f * OLX_PI);
  return (uint32_t)olx_min(u * RINGS, RINGS - 1) * SECTORS + (uint32_t)olx_min(turn * SECTORS, SECTORS - 1);
}

// Integrates the density of directions over each cell, for directions above the surface.
static void expected_shares(float alpha, olx_vec3 view, double *shares) {
  for (uint32_t cell = 0; cell < RINGS * SECTORS; cell++) {
    double sum = 0.0, solid_angle;
    for (uint32_t i = 0; i < FINE * FINE; i++) {
      const double u = (cell / SECTORS + (i % FINE + 0.5) / FINE) / RINGS;
      const olx_vec3 half = half_at(alpha, u, (cell % SECTORS + (i / FINE + 0.5) / FINE) / SECTORS, &solid_angle);
      const float cosine = olx_dot(view, half);
      if (cosine <= 0.0f) continue;
      sum += (double)(olx_ggx_pdf(alpha, view, olx_reflect(olx_negate(view), half)) * 4.0f * cosine) * solid_angle;
    }
    shares[cell] = sum / (FINE * FINE * RINGS * SECTORS);
  }
}

// Returns Pearson's statistic over the cells with enough expected draws; all other cells and directions below the
// surface count as one more cell.
static double deviation(const uint32_t *counts, const double *shares) {
  double statistic = 0.0, rest_share = 1.0, rest_count = DRAWS, freedom = 0.0;
  for (uint32_t i = 0; i < RINGS * SECTORS; i++) {
    const double expected = shares[i] * DRAWS;
    if (expected < 20.0) continue;
    statistic += (counts[i] - expected) * (counts[i] - expected) / expected;
    rest_share -= shares[i];
    rest_count -= counts[i];
    freedom += 1.0;
  }
  const double rest = rest_share * DRAWS;
  statistic += (rest_count - rest) * (rest_count - rest) / fmax(rest, 20.0);
  return (statistic - freedom) / sqrt(2.0 * freedom);
}

static void sampled_directions_follow_the_density(void **state) {
  (void)state;
  for (uint32_t r = 1; r < ROUGHNESS_COUNT; r++) {
    for (uint32_t v = 0; v < VIEW_COUNT; v++) {
      const float alpha = ROUGHNESSES[r] * ROUGHNESSES[r];
      const olx_vec3 view = direction(VIEW_COSINES[v], 0.4f);
      double shares[RINGS * SECTORS];
      uint32_t counts[RINGS * SECTORS] = {0};
      expected_shares(alpha, view, shares);
      for (uint32_t i = 0; i < DRAWS; i++) {
        float weight, half_cosine;
        const olx_vec3 light = olx_ggx_sample(alpha, view, random_pair(i, r * 16 + v), &weight, &half_cosine);
        assert_true(fabsf(olx_length(light) - 1.0f) < 1e-4f);
        assert_true((light.z > 0.0f) == (weight > 0.0f));
        if (light.z > 0.0f) counts[half_cell(alpha, olx_normalize(olx_add(view, light)))]++;
      }
      const double off = deviation(counts, shares);
      if (off > 4.5) fail_msg("alpha %g, cosine %g: %.1f deviations", (double)alpha, (double)view.z, off);
    }
  }
}

static void weights_are_reflectance_over_density(void **state) {
  (void)state;
  const olx_bsdf perfect = {.f0 = {1, 1, 1}, .f90 = 1.0f};
  for (uint32_t r = 0; r < ROUGHNESS_COUNT; r++) {
    for (uint32_t v = 0; v < VIEW_COUNT; v++) {
      olx_bsdf b = perfect;
      b.alpha = ROUGHNESSES[r] * ROUGHNESSES[r];
      const olx_vec3 view = direction(VIEW_COSINES[v], 1.0f);
      for (uint32_t i = 0; i < 1000; i++) {
        float weight, half_cosine;
        const olx_vec3 light = olx_ggx_sample(b.alpha, view, random_pair(i, 9), &weight, &half_cosine);
        if (weight == 0.0f) continue;
        const float density = olx_ggx_pdf(b.alpha, view, light);
        assert_true(density > 0.0f);
        assert_near((double)(olx_bsdf_specular(&b, view, light).x / density), (double)weight, 1e-4);
        assert_near((double)half_cosine, (double)olx_dot(view, olx_normalize(olx_add(view, light))), 2e-3);
        assert_true(weight <= 1.0f);
      }
    }
  }
}

static void directions_below_the_surface_carry_nothing(void **state) {
  (void)state;
  const olx_bsdf b = olx_bsdf_make(olx_splat(0.5f), 1.0f, 0.5f, 1.0f);
  const olx_vec3 up = direction(0.5f, 0.0f), down = direction(-0.5f, 1.0f);
  assert_true(olx_max3(olx_bsdf_specular(&b, up, down)) == 0.0f);
  assert_true(olx_max3(olx_bsdf_specular(&b, down, up)) == 0.0f);
  assert_true(olx_ggx_pdf(b.alpha, up, down) == 0.0f);
  assert_true(olx_ggx_pdf(b.alpha, down, up) == 0.0f);
  float weight, half_cosine;
  olx_ggx_sample(b.alpha, down, (olx_vec2){0.3f, 0.6f}, &weight, &half_cosine);
  assert_true(weight == 0.0f);
  olx_ggx_sample(0.0f, down, (olx_vec2){0.3f, 0.6f}, &weight, &half_cosine);
  assert_true(weight == 0.0f);
}

static void a_smooth_surface_is_a_mirror(void **state) {
  (void)state;
  const olx_bsdf b = olx_bsdf_make(olx_splat(0.5f), 1.0f, 0.5f * OLX_MIRROR_ROUGHNESS, 1.0f);
  assert_true(b.alpha == 0.0f);
  const olx_vec3 view = direction(0.3f, 2.0f);
  float weight, half_cosine;
  const olx_vec3 light = olx_ggx_sample(b.alpha, view, (olx_vec2){0.3f, 0.6f}, &weight, &half_cosine);
  assert_true(weight == 1.0f && half_cosine == view.z);
  assert_true(light.x == -view.x && light.y == -view.y && light.z == view.z);
}

// ---- symmetry and energy

static void specular_reflection_is_reciprocal(void **state) {
  (void)state;
  for (uint32_t i = 0; i < 20000; i++) {
    const olx_vec2 p = random_pair(i, 1), q = random_pair(i, 2), s = random_pair(i, 3);
    const olx_bsdf b = olx_bsdf_make(olx_v3(0.9f, 0.5f, 0.1f), s.x, 0.03f + 0.97f * s.y, 1.0f);
    const olx_vec3 view = olx_sample_cosine(p), light = olx_sample_cosine(q);
    if (view.z < 1e-3f || light.z < 1e-3f) continue;
    const olx_vec3 there = olx_scale(olx_bsdf_specular(&b, view, light), 1.0f / light.z);
    const olx_vec3 back = olx_scale(olx_bsdf_specular(&b, light, view), 1.0f / view.z);
    assert_near((double)there.x, (double)back.x, 1e-4 * (double)(there.x + back.x));
    assert_near((double)there.z, (double)back.z, 1e-4 * (double)(there.z + back.z));
  }
}

// Returns the share of light from everywhere that both lobes reflect to the view.
static double directional_albedo(const olx_bsdf *b, olx_vec3 view) {
  enum { COUNT = 4096 };
  double specular = 0.0;
  for (uint32_t i = 0; olx_bsdf_has_specular(b) && i < COUNT; i++) {
    float weight, half_cosine;
    olx_ggx_sample(b->alpha, view, olx_hammersley(i, COUNT), &weight, &half_cosine);
    if (weight > 0.0f) specular += (double)(weight * olx_fresnel(b, half_cosine).x);
  }
  return specular / COUNT + (double)olx_bsdf_diffuse(b, view.z).x;
}

// Fresnel's factor in place of the integral would be off by 0.4 for a rough dielectric at grazing angles, and by 0.7
// for metals.
static void the_lobes_reflectance_is_its_integral(void **state) {
  (void)state;
  static const float metallic[2] = {0.0f, 1.0f};
  static const double tolerance[2] = {0.04, 0.1};
  for (uint32_t kind = 0; kind < 2; kind++) {
    double squares = 0.0;
    for (uint32_t r = 0; r < ROUGHNESS_COUNT; r++) {
      for (uint32_t v = 0; v < VIEW_COUNT; v++) {
        const olx_bsdf b = olx_bsdf_make(olx_splat(kind ? 0.9f : 0.0f), metallic[kind], ROUGHNESSES[r], 1.0f);
        const olx_vec3 view = direction(VIEW_COSINES[v], 0.0f);
        const double truth = directional_albedo(&b, view) - (double)olx_bsdf_diffuse(&b, view.z).x;
        const double error = (double)olx_bsdf_specular_albedo(&b, view.z).x - truth;
        squares += error * error / (ROUGHNESS_COUNT * VIEW_COUNT);
        assert_near(error, 0.0, tolerance[kind]);
      }
    }
    assert_true(sqrt(squares) < 0.35 * tolerance[kind]);
  }
}

// Base colours are at most 0.95, since importers clamp them.
static void no_surface_sends_out_more_than_it_gets(void **state) {
  (void)state;
  for (uint32_t r = 0; r < ROUGHNESS_COUNT; r++) {
    for (uint32_t v = 0; v < VIEW_COUNT; v++) {
      for (uint32_t m = 0; m <= 4; m++) {
        for (uint32_t w = 0; w <= 4; w++) {
          const olx_bsdf b = olx_bsdf_make(olx_splat(0.95f), 0.25f * (float)m, ROUGHNESSES[r], 0.25f * (float)w);
          const double albedo = directional_albedo(&b, direction(VIEW_COSINES[v], 0.0f));
          if (albedo > 1.0) fail_msg("%g of the light at roughness %g", albedo, (double)ROUGHNESSES[r]);
        }
      }
    }
  }
}

// Single scattering loses little light on smooth surfaces.
static void smooth_white_metal_loses_almost_nothing(void **state) {
  (void)state;
  for (uint32_t v = 0; v < 3; v++) {
    const olx_bsdf mirror = olx_bsdf_make(olx_splat(1.0f), 1.0f, 0.0f, 1.0f);
    assert_near(directional_albedo(&mirror, direction(VIEW_COSINES[v], 0.0f)), 1.0, 1e-6);
    const olx_bsdf smooth = olx_bsdf_make(olx_splat(1.0f), 1.0f, 0.2f, 1.0f);
    assert_near(directional_albedo(&smooth, direction(VIEW_COSINES[v], 0.0f)), 1.0, 0.01);
  }
}

static void weight_zero_is_exactly_lambertian(void **state) {
  (void)state;
  const olx_vec3 color = {0.9f, 0.5f, 0.1f};
  const olx_bsdf b = olx_bsdf_make(color, 0.0f, 0.4f, 0.0f);
  assert_false(olx_bsdf_has_specular(&b));
  for (uint32_t v = 0; v < VIEW_COUNT; v++) {
    const olx_vec3 diffuse = olx_bsdf_diffuse(&b, VIEW_COSINES[v]);
    assert_memory_equal(&diffuse, &color, sizeof color);
    assert_true(olx_max3(olx_fresnel(&b, VIEW_COSINES[v])) == 0.0f);
  }
}

static void metals_have_no_diffuse_lobe(void **state) {
  (void)state;
  const olx_vec3 color = {0.9f, 0.5f, 0.1f};
  const olx_bsdf b = olx_bsdf_make(color, 1.0f, 0.4f, 1.0f);
  assert_true(olx_max3(olx_bsdf_diffuse(&b, 0.7f)) == 0.0f);
  assert_near((double)olx_fresnel(&b, 1.0f).y, (double)color.y, 1e-6);
  assert_near((double)olx_fresnel(&b, 0.0f).z, 1.0, 1e-6);
}

static void a_dielectric_reflects_four_percent_and_the_rest_is_split(void **state) {
  (void)state;
  const olx_bsdf b = olx_bsdf_make(olx_splat(1.0f), 0.0f, 0.0f, 1.0f);
  assert_near((double)olx_fresnel(&b, 1.0f).x, 0.04, 1e-7);
  // A smooth white dielectric reflects diffusely what the mirror does not reflect, so it reflects all light at any
  // angle.
  for (uint32_t v = 0; v < VIEW_COUNT; v++) {
    assert_near(directional_albedo(&b, direction(VIEW_COSINES[v], 0.0f)), 1.0, 1e-5);
  }
  for (float cosine = 0.0f; cosine < 1.0f; cosine += 0.01f) {
    assert_true(olx_fresnel(&b, cosine).x >= olx_fresnel(&b, cosine + 0.01f).x);
  }
}

// A mirror shows no lamp without area; what lies below its specular lobe is lit as ever.
static void a_mirror_shows_no_lamp(void **state) {
  (void)state;
  olx_bsdf b = {.albedo = {0.3f, 0.2f, 0.1f}, .f0 = {0.9f, 0.8f, 0.7f}, .f90 = 1.0f};
  const olx_vec3 mirror = olx_bsdf_lamp_albedo(&b);
  assert_near((double)mirror.x, 0.3, 1e-6);
  assert_near((double)mirror.z, 0.1, 1e-6);
  b.alpha = 0.01f;
  const olx_vec3 rough = olx_bsdf_lamp_albedo(&b), matte = olx_bsdf_matte(&b).albedo;
  assert_true(rough.x > 1.0f && rough.x == matte.x && rough.z == matte.z);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(normals_project_to_the_surface),
      cmocka_unit_test(visible_normals_project_to_the_view),
      cmocka_unit_test(sampled_directions_follow_the_density),
      cmocka_unit_test(weights_are_reflectance_over_density),
      cmocka_unit_test(directions_below_the_surface_carry_nothing),
      cmocka_unit_test(a_smooth_surface_is_a_mirror),
      cmocka_unit_test(specular_reflection_is_reciprocal),
      cmocka_unit_test(the_lobes_reflectance_is_its_integral),
      cmocka_unit_test(no_surface_sends_out_more_than_it_gets),
      cmocka_unit_test(smooth_white_metal_loses_almost_nothing),
      cmocka_unit_test(weight_zero_is_exactly_lambertian),
      cmocka_unit_test(metals_have_no_diffuse_lobe),
      cmocka_unit_test(a_mirror_shows_no_lamp),
      cmocka_unit_test(a_dielectric_reflects_four_percent_and_the_rest_is_split),
  };
  return cmocka_run_group_tests_name("bsdf", tests, NULL, NULL);
}
