// Tests the baker's integrals over directions: irradiance and filtered distances against their closed forms.
#include "bake/irradiance/quadrature.h"
#include "core/hooks.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static olx_vec3 cell_direction(const olx_quadrature *q, uint32_t c) {
  return olx_normalize(olx_v3(q->moment_x[c], q->moment_y[c], q->moment_z[c]));
}

static olx_vec3 *make_cells(const olx_quadrature *q, olx_vec3 (*radiance)(olx_vec3)) {
  const uint32_t count = q->cells * q->cells;
  olx_vec3 *cells = olx_allocate(count, sizeof *cells);
  for (uint32_t c = 0; c < count; c++) cells[c] = radiance(cell_direction(q, c));
  return cells;
}

static olx_vec3 constant(olx_vec3 d) {
  (void)d;
  return olx_v3(1.0f, 2.0f, 0.5f);
}

static olx_vec3 linear(olx_vec3 d) { return olx_v3(1.0f + d.x, 1.0f + d.y, 1.0f - d.z); }

// Irradiance of radiance 1 + a . d is pi + 2/3 pi a . n.
static void irradiance_is_exact(void **state) {
  (void)state;
  const uint32_t sizes[] = {8, 16, 32, 64, 128, 256};
  for (uint32_t s = 0; s < 6; s++) {
    const uint32_t n = sizes[s];
    olx_quadrature q;
    assert_int_equal(olx_quadrature_create(n, &q), OLX_OK);
    olx_vec3 *even = make_cells(&q, constant), *slope = make_cells(&q, linear);
    olx_vec3 *map = olx_allocate((size_t)n * n, sizeof *map), *map2 = olx_allocate((size_t)n * n, sizeof *map);
    const uint32_t step = n > 64 ? n / 32 : 1;
    for (uint32_t row = 0; row < n / OLX_BLOCK_ROWS; row += step) {
      olx_quadrature_irradiance(&q, even, n, row, map, n);
      olx_quadrature_irradiance(&q, slope, n, row, map2, n);
      for (uint32_t i = row * OLX_BLOCK_ROWS * n; i < (row + 1) * OLX_BLOCK_ROWS * n; i++) {
        const olx_vec3 d = olx_texel_direction(i % n, i / n, n);
        assert_float_equal(map[i].x, OLX_PI, 1e-5f * OLX_PI);
        assert_float_equal(map[i].y, 2.0f * OLX_PI, 2e-5f * OLX_PI);
        assert_float_equal(map[i].z, 0.5f * OLX_PI, 0.5e-5f * OLX_PI);
        assert_float_equal(map2[i].x, OLX_PI * (1.0f + 2.0f / 3.0f * d.x), 0.001f * OLX_PI);
        assert_float_equal(map2[i].y, OLX_PI * (1.0f + 2.0f / 3.0f * d.y), 0.001f * OLX_PI);
        assert_float_equal(map2[i].z, OLX_PI * (1.0f - 2.0f / 3.0f * d.z), 0.001f * OLX_PI);
      }
    }
    olx_release(even);
    olx_release(slope);
    olx_release(map);
    olx_release(map2);
    olx_quadrature_free(&q);
  }
}

static void solid_angles_sum_to_the_sphere(void **state) {
  (void)state;
  olx_quadrature q;
  assert_int_equal(olx_quadrature_create(128, &q), OLX_OK);
  double samples = 0.0, cells = 0.0, distances = 0.0;
  for (uint32_t i = 0; i < q.sample_size * q.sample_size; i++) samples += q.sample_solid_angle[i];
  for (uint32_t i = 0; i < q.cells * q.cells; i++) cells += q.cell_solid_angle[i];
  for (uint32_t i = 0; i < q.distance_cells * q.distance_cells; i++) distances += q.distance_weight[i];
  assert_float_equal((float)samples, 4.0f * OLX_PI, 2e-5f);
  assert_float_equal((float)cells, 4.0f * OLX_PI, 2e-5f);
  assert_float_equal((float)distances, 4.0f * OLX_PI, 2e-5f);
  olx_quadrature_free(&q);
}

// For distances a + b . d, which are linear in direction, a lobe cos^e returns a + b . n (e + 1) / (e + 2).
static void moments_are_filtered_with_the_lobe(void **state) {
  (void)state;
  const uint32_t sizes[] = {16, 64, 128};
  for (uint32_t s = 0; s < 3; s++) {
    const uint32_t n = sizes[s];
    olx_quadrature q;
    assert_int_equal(olx_quadrature_create(n, &q), OLX_OK);
    const uint32_t cells = q.distance_cells * q.distance_cells;
    olx_vec2 *distances = olx_allocate(cells, sizeof *distances), *map = olx_allocate((size_t)n * n, sizeof *map);
    const olx_vec3 slope = olx_v3(0.2f, -0.1f, 0.15f);
    for (uint32_t c = 0; c < cells; c++) {
      const float r = 0.5f + olx_dot(slope, olx_v3(q.distance_x[c], q.distance_y[c], q.distance_z[c]));
      distances[c] = (olx_vec2){r, r * r};
    }
    const float e = (float)q.lobe_exponent, shrink = (e + 1.0f) / (e + 2.0f);
    for (uint32_t row = 0; row < n / OLX_BLOCK_ROWS; row++) olx_quadrature_moments(&q, distances, row, map, n);
    for (uint32_t i = 0; i < n * n; i++) {
      const float along = olx_dot(slope, olx_texel_direction(i % n, i / n, n));
      assert_float_equal(map[i].x, 0.5f + shrink * along, 5e-4f);
      assert_true(map[i].y >= map[i].x * map[i].x);
      // The mean square over the lobe is E[(b . d)^2] = along^2 E[c^2] + |b across|^2 E[1 - c^2] / 2, with E[c^2] = (e
      // + 1) / (e + 3).
      const float c2 = (e + 1.0f) / (e + 3.0f), across = olx_dot(slope, slope) - along * along;
      const float square = 0.25f + shrink * along + along * along * c2 + across * (1.0f - c2) * 0.5f;
      assert_float_equal(map[i].y, square, 5e-4f);
    }
    olx_release(distances);
    olx_release(map);
    olx_quadrature_free(&q);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(irradiance_is_exact),
      cmocka_unit_test(solid_angles_sum_to_the_sphere),
      cmocka_unit_test(moments_are_filtered_with_the_lobe),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
