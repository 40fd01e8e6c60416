// Tests the denoiser on pictures made by hand: what it must keep, what it must discard, and what must never spread.
#include "core/sampling.h"
#include "render/denoise.h"
#include "tiny_scenes.h"

#define ASSERT_NEAR(a, b, tolerance) assert_true(fabs((double)(a) - (double)(b)) <= (double)(tolerance))

enum { SIZE = 40, PIXELS = SIZE * SIZE };

// A camera at `x` that looks along -z at a wall, SIZE x SIZE pixels; at depth 1 a pixel is 2 / SIZE wide.
typedef struct view {
  float depth[PIXELS], roughness[PIXELS];
  olx_vec3 normal[PIXELS];
  olx_guide guide;
} view;

static void look_at_wall(view *v, float eye_x, float depth) {
  for (uint32_t i = 0; i < PIXELS; i++) {
    v->depth[i] = depth;
    v->roughness[i] = 0.5f;
    v->normal[i] = olx_v3(0, 0, 1);
  }
  v->guide =
      (olx_guide){.width = SIZE, .height = SIZE, .depth = v->depth, .normal = v->normal, .roughness = v->roughness};
  v->guide.camera =
      (olx_camera_frame){.eye = {eye_x, 0, 0}, .forward = {0, 0, -1}, .right = {1, 0, 0}, .up = {0, 1, 0}};
}

static view *make_wall(float eye_x, float depth) {
  view *v = calloc(1, sizeof *v);
  assert_non_null(v);
  look_at_wall(v, eye_x, depth);
  return v;
}

typedef struct light_buffers {
  uint32_t ray_spacing;
  olx_incident sample[PIXELS];
  olx_history history[2];
  uint32_t frame;
  olx_vec3 filtered[PIXELS];
} light_buffers;

static light_buffers *make_light(void) {
  light_buffers *light = calloc(1, sizeof *light);
  assert_non_null(light);
  light->ray_spacing = 1;
  for (int i = 0; i < 2; i++) ASSERT_OK(olx_history_create(SIZE, SIZE, &light->history[i]));
  return light;
}

static void free_light(light_buffers *light) {
  for (int i = 0; i < 2; i++) olx_history_free(&light->history[i]);
  free(light);
}

static void fill(light_buffers *light, float value) {
  for (uint32_t i = 0; i < PIXELS; i++) light->sample[i] = (olx_incident){olx_splat(value), 1.0f};
}

static const olx_history *accumulate(light_buffers *light, const olx_lobe_filter *filter, const view *before,
                                     const view *now) {
  const olx_ray_turn turn = olx_ray_turn_of(light->ray_spacing, light->frame);
  const uint32_t to = light->frame++ & 1;
  ASSERT_OK(olx_denoise_accumulate(filter, &turn, &now->guide, light->sample, &before->guide, &light->history[to ^ 1],
                                   &light->history[to], 2));
  return &light->history[to];
}

static void filter_light(light_buffers *light, const olx_lobe_filter *filter, olx_lobe lobe, const view *v) {
  const olx_history *history = &light->history[(light->frame & 1) ^ 1];
  ASSERT_OK(
      olx_denoise_filter(filter, lobe, &v->guide, history, &light->history[light->frame & 1], light->filtered, 2));
}

static uint32_t at(uint32_t x, uint32_t y) { return x + SIZE * y; }

static void each_filter(void (*check)(const olx_lobe_filter *filter, olx_lobe lobe)) {
  const olx_denoise_settings settings[] = {olx_denoise_settings_default(), olx_denoise_settings_published(),
                                           olx_denoise_settings_none()};
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
    check(&settings[i].diffuse, OLX_LOBE_DIFFUSE);
    check(&settings[i].glossy, OLX_LOBE_GLOSSY);
  }
}

static void keep_constant(const olx_lobe_filter *filter, olx_lobe lobe, uint32_t ray_spacing, uint32_t frames) {
  view *a = make_wall(0, 2), *b = make_wall(0.0137f, 2);
  light_buffers *light = make_light();
  light->ray_spacing = ray_spacing;
  fill(light, 0.7f);
  for (uint32_t f = 0; f < frames; f++) {
    accumulate(light, filter, f & 1 ? b : a, f & 1 ? a : b);
    filter_light(light, filter, lobe, f & 1 ? a : b);
    for (uint32_t i = 0; i < PIXELS; i++) ASSERT_NEAR(light->filtered[i].y, 0.7f, 2e-6f);
  }
  free_light(light);
  free(a);
  free(b);
}

static void check_constant(const olx_lobe_filter *filter, olx_lobe lobe) { keep_constant(filter, lobe, 1, 70); }

static void test_constant_light_stays_constant(void **state) {
  (void)state;
  each_filter(check_constant);
}

// Lights everything left of the edge and nothing right of it.
static void check_edge(const olx_lobe_filter *filter, olx_lobe lobe, const view *v) {
  light_buffers *light = make_light();
  for (uint32_t i = 0; i < PIXELS; i++) {
    light->sample[i] = (olx_incident){olx_splat(i % SIZE < SIZE / 2 ? 1.0f : 0.0f), 0.0f};
  }
  for (int i = 0; i < 3; i++) accumulate(light, filter, v, v);
  filter_light(light, filter, lobe, v);
  for (uint32_t i = 0; i < PIXELS; i++) {
    ASSERT_NEAR(light->filtered[i].x, i % SIZE < SIZE / 2 ? 1.0f : 0.0f, 1e-6f);
  }
  free_light(light);
}

static void check_edges(const olx_lobe_filter *filter, olx_lobe lobe) {
  view *v = make_wall(0, 2);
  for (uint32_t i = 0; i < PIXELS; i++) {
    if (i % SIZE >= SIZE / 2) v->normal[i] = olx_v3(1, 0, 0);
  }
  check_edge(filter, lobe, v);
  look_at_wall(v, 0, 2);
  for (uint32_t i = 0; i < PIXELS; i++) {
    if (i % SIZE >= SIZE / 2) v->depth[i] = 6.0f; // far behind, since a pixel is 0.1 m wide at 2 m
  }
  check_edge(filter, lobe, v);
  look_at_wall(v, 0, 2);
  for (uint32_t i = 0; i < PIXELS; i++) {
    if (i % SIZE >= SIZE / 2) v->depth[i] = INFINITY; // sky in the right half
  }
  check_edge(filter, lobe, v);
  free(v);
}

static void test_edges_in_normal_and_depth_are_not_blurred_over(void **state) {
  (void)state;
  each_filter(check_edges);
}

static void test_a_slanted_plane_is_one_surface(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().diffuse;
  view *v = make_wall(0, 2);
  const olx_vec3 normal = olx_normalize(olx_v3(1, 0, 0.5f));
  // This is the plane through (-2, 0, 0): dot(normal, p) = -2 normal.x.
  for (uint32_t i = 0; i < PIXELS; i++) {
    const float across = 2.0f * ((float)(i % SIZE) + 0.5f) / SIZE - 1.0f;
    v->depth[i] = -2.0f * normal.x / (normal.x * across - normal.z);
    if (!(v->depth[i] > 0.0f)) v->depth[i] = INFINITY;
    v->normal[i] = normal;
  }
  light_buffers *light = make_light();
  fill(light, 0);
  light->sample[at(8, 20)].light = olx_splat(1); // one lit sample, whose light must spread as far as the radius
  accumulate(light, &filter, v, v);
  filter_light(light, &filter, OLX_LOBE_DIFFUSE, v);
  assert_true(light->filtered[at(2, 20)].x > 0 && light->filtered[at(8, 10)].x > 0);
  assert_true(light->filtered[at(8, 20)].x < 0.05f);
  free_light(light);
  free(v);
}

static void test_history_is_a_mean_that_becomes_exponential(void **state) {
  (void)state;
  const olx_lobe_filter filters[] = {olx_denoise_settings_published().diffuse, olx_denoise_settings_published().glossy};
  view *v = make_wall(0, 2);
  for (int f = 0; f < 2; f++) {
    light_buffers *light = make_light();
    double expected = 0;
    const double largest = f ? 0.75 : 0.98;
    for (int n = 1; n <= 80; n++) {
      const float value = (float)(n * n % 17);
      const double share = fmin(1 - 1.0 / n, largest); // weight of the history: 1 - 1/n, up to the published weight
      expected = share * expected + (1 - share) * (double)value;
      fill(light, value);
      const olx_history *history = accumulate(light, &filters[f], v, v);
      ASSERT_NEAR(history->incident[at(7, 9)].light.x, expected, 1e-4);
      ASSERT_NEAR(history->count[at(7, 9)], fmin(n, 1 / (1 - largest)), 1e-3);
    }
    free_light(light);
  }
  free(v);
}

static void test_history_follows_the_surface_that_moves_over_the_screen(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().diffuse;
  // At depth 2 a pixel is 0.1 m wide: the eye moves right by 3 pixels, so the wall moves left in the picture.
  view *before = make_wall(0, 2), *now = make_wall(0.3f, 2);
  light_buffers *light = make_light();
  for (uint32_t i = 0; i < PIXELS; i++) light->sample[i] = (olx_incident){olx_splat((float)(i % SIZE)), 1.0f};
  accumulate(light, &filter, before, before);
  for (uint32_t i = 0; i < PIXELS; i++) light->sample[i].light = olx_splat((float)(i % SIZE) + 3.0f);
  const olx_history *history = accumulate(light, &filter, before, now);
  for (uint32_t y = 0; y < SIZE; y++) {
    for (uint32_t x = 0; x < SIZE; x++) {
      const bool in_sight = x + 3 < SIZE;
      ASSERT_NEAR(history->count[at(x, y)], in_sight ? 2.0f : 1.0f, 1e-3f);
      ASSERT_NEAR(history->incident[at(x, y)].light.x, (float)x + 3.0f, 1e-3f);
    }
  }
  free_light(light);
  free(before);
  free(now);
}

static void test_a_surface_seen_in_its_place_is_still(void **state) {
  (void)state;
  olx_lobe_filter filter = olx_denoise_settings_published().glossy;
  filter.still_history = 0.98f;
  view *a = make_wall(0, 2), *b = make_wall(0.01f, 2);
  light_buffers *light = make_light();
  fill(light, 1);
  for (int i = 0; i < 30; i++) accumulate(light, &filter, a, a);
  ASSERT_NEAR(light->history[1].count[at(20, 20)], 30.0f, 1e-3f);
  const olx_history *moved = accumulate(light, &filter, a, b); // the view moves by a tenth of a pixel
  ASSERT_NEAR(moved->count[at(20, 20)], 4.0f, 1e-3f);
  free_light(light);
  free(a);
  free(b);
}

static void test_what_comes_into_sight_starts_anew(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().diffuse;
  // A post is in front of the wall; when the eye moves, the post hides other pixels of the wall.
  view *before = make_wall(0, 4), *now = make_wall(0.2f, 4);
  for (uint32_t y = 0; y < SIZE; y++) {
    for (uint32_t x = 0; x < SIZE; x++) {
      // The post moves by 4 pixels, since at depth 1 a pixel is 0.05 m wide.
      if (x >= 18 && x < 24) before->depth[at(x, y)] = 1;
      if (x >= 14 && x < 20) now->depth[at(x, y)] = 1;
    }
  }
  light_buffers *light = make_light();
  fill(light, 1);
  for (int i = 0; i < 5; i++) accumulate(light, &filter, before, before);
  fill(light, 2);
  const olx_history *history = accumulate(light, &filter, before, now);
  // The wall moved by one pixel: pixels 20..22 show what was behind the post at 21..23; pixels from 23 on show what was
  // seen from 24 on.
  for (uint32_t x = 20; x < 23; x++) {
    ASSERT_NEAR(history->count[at(x, 5)], 1.0f, 0);
    ASSERT_NEAR(history->incident[at(x, 5)].light.x, 2.0f, 0);
  }
  ASSERT_NEAR(history->count[at(25, 5)], 6.0f, 1e-3f);
  ASSERT_NEAR(history->count[at(17, 5)], 6.0f, 1e-3f); // a pixel of the post, which moved by 4 pixels
  free_light(light);
  free(before);
  free(now);
}

static void test_another_normal_starts_anew(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().diffuse;
  view *before = make_wall(0, 2), *now = make_wall(0, 2);
  now->normal[at(3, 3)] = olx_normalize(olx_v3(1, 0, 1));
  light_buffers *light = make_light();
  fill(light, 1);
  accumulate(light, &filter, before, before);
  const olx_history *history = accumulate(light, &filter, before, now);
  ASSERT_NEAR(history->count[at(3, 3)], 1.0f, 0);
  ASSERT_NEAR(history->count[at(4, 3)], 2.0f, 0);
  free_light(light);
  free(before);
  free(now);
}

static void check_broken_samples(const olx_lobe_filter *filter, olx_lobe lobe) {
  const float bad[] = {NAN, INFINITY, -INFINITY};
  view *v = make_wall(0, 2);
  for (int b = 0; b < 3; b++) {
    light_buffers *light = make_light();
    fill(light, 1);
    light->sample[at(9, 9)].light.y = bad[b]; // a bad sample in the first frame
    light->sample[at(12, 9)].inverse_distance = bad[b];
    accumulate(light, filter, v, v);
    light->sample[at(20, 20)].light.z = bad[b]; // a bad sample in a later frame
    const olx_history *history = accumulate(light, filter, v, v);
    ASSERT_NEAR(history->count[at(9, 9)], 0.0f, 0);
    const bool remembers = filter->history > 0;
    ASSERT_NEAR(history->count[at(20, 20)], 1.0f, 0); // the pixel keeps its history
    ASSERT_NEAR(history->count[at(21, 20)], remembers ? 2.0f : 1.0f, 0);
    filter_light(light, filter, lobe, v);
    for (uint32_t i = 0; i < PIXELS; i++) {
      assert_true(olx_finite(light->filtered[i]));
      // Pixels without any valid sample take the light of neighbours if the filter reads any.
      const bool blind = (i == at(9, 9) || i == at(12, 9)) && filter->radius_pixels == 0;
      ASSERT_NEAR(light->filtered[i].x, blind ? 0.0f : 1.0f, 1e-5f);
    }
    free_light(light);
  }
  free(v);
}

static void test_broken_numbers_never_spread(void **state) {
  (void)state;
  each_filter(check_broken_samples);
}

static void test_broken_histories_are_not_read(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().diffuse;
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  fill(light, 1);
  accumulate(light, &filter, v, v);
  light->history[0].incident[at(5, 5)].light.x = NAN;
  light->history[0].incident[at(6, 5)].inverse_distance = NAN;
  light->history[0].count[at(7, 5)] = NAN;
  const olx_history *history = accumulate(light, &filter, v, v);
  for (uint32_t x = 5; x < 8; x++) {
    ASSERT_NEAR(history->count[at(x, 5)], 1.0f, 0);
    ASSERT_NEAR(history->incident[at(x, 5)].light.x, 1.0f, 0);
  }
  free_light(light);
  free(v);
}

static void test_pixels_without_the_lobe_lend_and_borrow_nothing(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().diffuse;
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  fill(light, 1);
  // A metal square has no diffuse light, so the contents of its samples must not be read.
  for (uint32_t y = 10; y < 16; y++) {
    for (uint32_t x = 10; x < 16; x++) light->sample[at(x, y)] = (olx_incident){olx_splat(100), -1.0f};
  }
  accumulate(light, &filter, v, v);
  filter_light(light, &filter, OLX_LOBE_DIFFUSE, v);
  for (uint32_t i = 0; i < PIXELS; i++) assert_true(light->filtered[i].x <= 1.00001f);
  free_light(light);
  free(v);
}

// One pixel has no sample, like those along edges after a cut whose squares trace for another surface.
static void check_lone_pixel(const olx_lobe_filter *filter, olx_lobe lobe) {
  view *v = make_wall(0, 2);
  for (uint32_t i = 0; i < PIXELS; i++) v->roughness[i] = 0.05f;
  // From kernels that reach far to those that reach no other pixel.
  for (float nearness = 0.1f; nearness < 1e4f; nearness *= 3) {
    light_buffers *light = make_light();
    for (uint32_t i = 0; i < PIXELS; i++) light->sample[i] = (olx_incident){olx_splat(1), nearness};
    light->sample[at(20, 20)].inverse_distance = -1.0f;
    accumulate(light, filter, v, v);
    filter_light(light, filter, lobe, v);
    assert_float_equal(light->filtered[at(20, 20)].x, 1.0f, 1e-5f);
    free_light(light);
  }
  free(v);
}

static void test_a_pixel_without_history_takes_light_from_beside_it_however_sharp_that_is(void **state) {
  (void)state;
  const olx_denoise_settings settings = olx_denoise_settings_default();
  check_lone_pixel(&settings.diffuse, OLX_LOBE_DIFFUSE);
  check_lone_pixel(&settings.glossy, OLX_LOBE_GLOSSY);
}

static void test_weights_that_are_hardly_there_count_for_nothing(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_default().diffuse;
  view *v = make_wall(0, 2);
  // The only samples are as far from the pixel as the filter reads, on normals that turn away from its own: for some of
  // them weights are too small to divide by their sum.
  for (float cosine = 1.0f; cosine > 1e-3f; cosine *= 0.98f) {
    light_buffers *light = make_light();
    for (uint32_t i = 0; i < PIXELS; i++) {
      const bool far = i % SIZE == 8 || i % SIZE == 32;
      light->sample[i] = (olx_incident){olx_splat(1), far ? 500.0f : -1.0f};
      if (far) v->normal[i] = olx_v3(sqrtf(1.0f - cosine * cosine), 0, cosine);
    }
    accumulate(light, &filter, v, v);
    filter_light(light, &filter, OLX_LOBE_DIFFUSE, v);
    const float borrowed = light->filtered[at(20, 20)].x;
    assert_true(borrowed == 0.0f || fabsf(borrowed - 1.0f) < 1e-5f);
    free_light(light);
  }
  free(v);
}

static void test_glossy_light_stays_on_its_material(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().glossy;
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  for (uint32_t i = 0; i < PIXELS; i++) {
    const bool left = i % SIZE < SIZE / 2;
    v->roughness[i] = left ? 0.1f : 0.5f;
    light->sample[i] = (olx_incident){olx_splat(left ? 1.0f : 0.0f), 1.0f};
  }
  accumulate(light, &filter, v, v);
  filter_light(light, &filter, OLX_LOBE_GLOSSY, v);
  for (uint32_t i = 0; i < PIXELS; i++) ASSERT_NEAR(light->filtered[i].x, light->sample[i].light.x, 1e-6f);
  free_light(light);
  free(v);
}

// Returns the mean squared difference from 1, away from the picture's edges.
static double noise(const light_buffers *light) {
  double sum = 0;
  for (uint32_t y = 13; y < SIZE - 13; y++) {
    for (uint32_t x = 13; x < SIZE - 13; x++) {
      const double d = (double)light->filtered[at(x, y)].x - 1;
      sum += d * d;
    }
  }
  return sum / ((SIZE - 26) * (SIZE - 26));
}

static double noise_after(const olx_lobe_filter *filter, uint32_t frames) {
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  for (uint32_t f = 0; f < frames; f++) {
    for (uint32_t i = 0; i < PIXELS; i++) { // light is uniform in 0..2, with variance 1/3
      light->sample[i] = (olx_incident){olx_splat(2 * olx_unit_float(olx_hash2(i, f))), 0.0f};
    }
    accumulate(light, filter, v, v);
  }
  filter_light(light, filter, OLX_LOBE_DIFFUSE, v);
  const double result = noise(light);
  free_light(light);
  free(v);
  return result;
}

// If a pixel shared no light with the next one, noise would show as a pattern of 2 x 2 pixels.
static void test_a_filter_of_stride_2_mixes_odd_and_even_rows_and_columns(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_default().diffuse;
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  for (uint32_t i = 0; i < PIXELS; i++) {
    light->sample[i] = (olx_incident){olx_splat((float)(i % SIZE & i / SIZE & 1)), 0.0f};
  }
  accumulate(light, &filter, v, v);
  filter_light(light, &filter, OLX_LOBE_DIFFUSE, v);
  for (uint32_t y = 16; y < 24; y++) {
    for (uint32_t x = 16; x < 24; x++) {
      const float share = light->filtered[at(x, y)].x; // of a light on one pixel of each 2 x 2
      assert_true(share > 0.05f && share < 0.6f);
    }
  }
  free_light(light);
  free(v);
}

static void test_noise_falls_as_the_weights_say(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_published().diffuse;
  // Gaussian weights of sigma 6 on every second pixel average as much as 4 pi sigma^2 / 4 = 113 equal weights, a little
  // less since they are cut off.
  const double one = noise_after(&filter, 1);
  assert_true(one > 1.0 / 3 / 113 / 1.6 && one < 1.0 / 3 / 113 * 1.6);
  // A history of 98 % averages (1 + 0.98) / (1 - 0.98) = 99 frames at the end; after 40 frames it is their mean.
  olx_lobe_filter time_alone = filter;
  time_alone.radius_pixels = 0;
  const double forty = noise_after(&time_alone, 40);
  assert_true(forty > 1.0 / 3 / 40 / 1.4 && forty < 1.0 / 3 / 40 * 1.4);
}

static void test_kernels_narrow_to_where_light_comes_from(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_default().diffuse;
  view *v = make_wall(0, 2);
  const float near = 1.0f / 0.008f, far = 0.0f; // hits a twelfth of a pixel away, and the sky
  for (int i = 0; i < 2; i++) {
    light_buffers *light = make_light();
    for (uint32_t k = 0; k < PIXELS; k++) light->sample[k] = (olx_incident){olx_splat(0), i ? far : near};
    light->sample[at(20, 20)].light = olx_splat(1);
    accumulate(light, &filter, v, v);
    filter_light(light, &filter, OLX_LOBE_DIFFUSE, v);
    const float kept = light->filtered[at(20, 20)].x;
    assert_true(i ? kept < 0.02f : kept > 0.9f);
    free_light(light);
  }
  free(v);
}

static void test_mirrors_are_not_blurred(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_default().glossy;
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  for (uint32_t i = 0; i < PIXELS; i++) {
    v->roughness[i] = 0;
    light->sample[i] = (olx_incident){olx_splat((float)(i * 7 % 5)), 0.3f};
  }
  accumulate(light, &filter, v, v);
  filter_light(light, &filter, OLX_LOBE_GLOSSY, v);
  for (uint32_t i = 0; i < PIXELS; i++) ASSERT_NEAR(light->filtered[i].x, light->sample[i].light.x, 0);
  free_light(light);
  free(v);
}

static void test_no_filter_shows_the_last_frame(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_none().diffuse;
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  for (int f = 0; f < 3; f++) {
    for (uint32_t i = 0; i < PIXELS; i++) light->sample[i] = (olx_incident){olx_splat((float)(i * 3 + f)), 0.3f};
    accumulate(light, &filter, v, v);
  }
  filter_light(light, &filter, OLX_LOBE_DIFFUSE, v);
  for (uint32_t i = 0; i < PIXELS; i++) ASSERT_NEAR(light->filtered[i].x, light->sample[i].light.x, 0);
  free_light(light);
  free(v);
}

// ---- One pixel of each 2 x 2 traces

static void test_every_pixel_of_a_square_has_its_turn_in_four_frames(void **state) {
  (void)state;
  for (uint32_t round = 0; round < 3; round++) {
    uint32_t turns[4] = {0};
    for (uint32_t i = 0; i < 4; i++) {
      const olx_ray_turn turn = olx_ray_turn_of(2, 4 * round + i);
      assert_int_equal(olx_ray_turn_number(2, 4 * round + i), round);
      for (uint32_t p = 0; p < 4; p++) turns[p] += olx_ray_turn_is(&turn, 6 + (p & 1), 8 + (p >> 1));
    }
    for (uint32_t p = 0; p < 4; p++) assert_int_equal(turns[p], 1);
  }
  const olx_ray_turn all = olx_ray_turn_of(1, 3);
  assert_true(olx_ray_turn_is(&all, 7, 4) && olx_ray_turn_number(1, 3) == 3);
}

// Gives every pixel that traces a sample of its own, and all others a wrong one, which nobody may read.
static void fill_turns(light_buffers *light) {
  const olx_ray_turn turn = olx_ray_turn_of(2, light->frame);
  for (uint32_t i = 0; i < PIXELS; i++) {
    const bool traces = olx_ray_turn_is(&turn, i % SIZE, i / SIZE);
    light->sample[i] = (olx_incident){olx_splat(traces ? (float)i : NAN), traces ? 1.0f : -1.0f};
  }
}

static void test_pixels_borrow_from_their_square_until_their_turn(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_default().diffuse;
  view *v = make_wall(0, 2);
  light_buffers *light = make_light();
  light->ray_spacing = 2;
  const uint32_t lenders[4] = {at(0, 0), at(1, 1), at(1, 0), at(0, 1)};
  for (uint32_t f = 0; f < 4; f++) {
    fill_turns(light);
    const olx_history *h = accumulate(light, &filter, v, v);
    for (uint32_t k = 0; k < 4; k++) {
      const uint32_t pixel = at(10, 20) + lenders[k];
      // What a pixel borrows in the first frame stays until its own ray replaces it.
      const uint32_t wanted = k <= f ? pixel : at(10, 20);
      assert_true(h->incident[pixel].light.x == (float)wanted &&
                  h->count[pixel] == (k <= f ? 1.0f : OLX_BORROWED_COUNT));
    }
  }
  free_light(light);
  free(v);
}

static void test_pixels_borrow_nothing_from_another_surface(void **state) {
  (void)state;
  const olx_lobe_filter filter = olx_denoise_settings_default().diffuse;
  view *v = make_wall(0, 2);
  v->depth[at(4, 4)] = 1.0f;             // the lender is nearer,
  v->normal[at(8, 4)] = olx_v3(1, 0, 0); // faces another way,
  v->roughness[at(12, 4)] = 0.7f;        // is rougher,
  v->depth[at(16, 4)] = INFINITY;        // shows the sky,
  light_buffers *light = make_light();
  light->ray_spacing = 2;
  fill_turns(light);
  light->sample[at(20, 4)].inverse_distance = -1.0f; // or has no such lobe
  const olx_history *h = accumulate(light, &filter, v, v);
  for (uint32_t x = 4; x <= 20; x += 4) {
    assert_true(h->count[at(x + 1, 4)] == 0.0f && h->count[at(x, 5)] == 0.0f && h->count[at(x + 1, 5)] == 0.0f);
  }
  assert_true(h->count[at(25, 5)] == OLX_BORROWED_COUNT);
  free_light(light);
  free(v);
}

static void test_a_pixel_alone_on_its_surface_shows_its_square_until_its_turn(void **state) {
  (void)state;
  const olx_denoise_settings settings = olx_denoise_settings_default();
  view *v = make_wall(0, 2);
  v->depth[at(21, 21)] = 1.0f;
  light_buffers *light = make_light();
  light->ray_spacing = 2;
  for (uint32_t i = 0; i < PIXELS; i++) light->sample[i] = (olx_incident){olx_splat(1), 1.0f};
  light->sample[at(20, 20)].light = olx_splat(3); // of the pixel that traces first
  const olx_history *h = accumulate(light, &settings.glossy, v, v);
  assert_true(h->count[at(21, 21)] == 0.0f);
  filter_light(light, &settings.glossy, OLX_LOBE_GLOSSY, v);
  assert_true(light->filtered[at(21, 21)].x == 3.0f);
  h = accumulate(light, &settings.glossy, v, v); // the pixel's own turn
  filter_light(light, &settings.glossy, OLX_LOBE_GLOSSY, v);
  assert_true(h->count[at(21, 21)] == 1.0f && light->filtered[at(21, 21)].x == 1.0f);
  free_light(light);
  free(v);
}

static void check_constant_with_turns(const olx_lobe_filter *filter, olx_lobe lobe) {
  keep_constant(filter, lobe, 2, 9);
}

static void test_constant_light_stays_constant_when_pixels_take_turns(void **state) {
  (void)state;
  each_filter(check_constant_with_turns);
}

static void test_any_number_of_threads_gives_the_same_bytes(void **state) {
  (void)state;
  const olx_denoise_settings settings = olx_denoise_settings_default();
  view *a = make_wall(0, 2), *b = make_wall(0.05f, 2);
  olx_vec3 first[2][PIXELS];
  for (uint32_t threads = 1; threads <= 7; threads += 3) {
    for (int lobe = 0; lobe < 2; lobe++) {
      const olx_lobe_filter *filter = lobe ? &settings.glossy : &settings.diffuse;
      light_buffers *light = make_light();
      for (uint32_t f = 0; f < 4; f++) {
        for (uint32_t i = 0; i < PIXELS; i++) {
          light->sample[i] = (olx_incident){olx_splat(olx_unit_float(olx_hash2(i, f))), olx_unit_float(olx_hash(i))};
        }
        const view *before = f & 1 ? a : b, *now = f & 1 ? b : a;
        const olx_ray_turn turn = olx_ray_turn_of(1, f);
        ASSERT_OK(olx_denoise_accumulate(filter, &turn, &now->guide, light->sample, &before->guide,
                                         &light->history[(f & 1) ^ 1], &light->history[f & 1], threads));
      }
      ASSERT_OK(olx_denoise_filter(filter, lobe ? OLX_LOBE_GLOSSY : OLX_LOBE_DIFFUSE, &b->guide, &light->history[1],
                                   &light->history[0], light->filtered, threads));
      if (threads == 1) memcpy(first[lobe], light->filtered, sizeof first[lobe]);
      else assert_memory_equal(first[lobe], light->filtered, sizeof first[lobe]);
      free_light(light);
    }
  }
  free(a);
  free(b);
}

static void test_points_project_to_the_pixels_that_show_them(void **state) {
  (void)state;
  view *v = make_wall(0.4f, 3);
  for (uint32_t y = 0; y < SIZE; y += 7) {
    for (uint32_t x = 0; x < SIZE; x += 7) {
      olx_vec2 pixel;
      assert_true(olx_guide_project(&v->guide, olx_guide_position(&v->guide, x, y), &pixel));
      ASSERT_NEAR(pixel.x, (float)x, 1e-4f);
      ASSERT_NEAR(pixel.y, (float)y, 1e-4f);
    }
  }
  olx_vec2 pixel;
  assert_false(olx_guide_project(&v->guide, olx_v3(0, 0, 1), &pixel)); // a point behind the eye
  free(v);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_constant_light_stays_constant),
      cmocka_unit_test(test_edges_in_normal_and_depth_are_not_blurred_over),
      cmocka_unit_test(test_a_slanted_plane_is_one_surface),
      cmocka_unit_test(test_history_is_a_mean_that_becomes_exponential),
      cmocka_unit_test(test_history_follows_the_surface_that_moves_over_the_screen),
      cmocka_unit_test(test_a_surface_seen_in_its_place_is_still),
      cmocka_unit_test(test_what_comes_into_sight_starts_anew),
      cmocka_unit_test(test_another_normal_starts_anew),
      cmocka_unit_test(test_broken_numbers_never_spread),
      cmocka_unit_test(test_broken_histories_are_not_read),
      cmocka_unit_test(test_pixels_without_the_lobe_lend_and_borrow_nothing),
      cmocka_unit_test(test_every_pixel_of_a_square_has_its_turn_in_four_frames),
      cmocka_unit_test(test_pixels_borrow_from_their_square_until_their_turn),
      cmocka_unit_test(test_pixels_borrow_nothing_from_another_surface),
      cmocka_unit_test(test_a_pixel_alone_on_its_surface_shows_its_square_until_its_turn),
      cmocka_unit_test(test_constant_light_stays_constant_when_pixels_take_turns),
      cmocka_unit_test(test_a_pixel_without_history_takes_light_from_beside_it_however_sharp_that_is),
      cmocka_unit_test(test_weights_that_are_hardly_there_count_for_nothing),
      cmocka_unit_test(test_glossy_light_stays_on_its_material),
      cmocka_unit_test(test_a_filter_of_stride_2_mixes_odd_and_even_rows_and_columns),
      cmocka_unit_test(test_noise_falls_as_the_weights_say),
      cmocka_unit_test(test_kernels_narrow_to_where_light_comes_from),
      cmocka_unit_test(test_mirrors_are_not_blurred),
      cmocka_unit_test(test_no_filter_shows_the_last_frame),
      cmocka_unit_test(test_any_number_of_threads_gives_the_same_bytes),
      cmocka_unit_test(test_points_project_to_the_pixels_that_show_them),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
