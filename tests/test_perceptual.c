// Tests SSIM and FLIP on pictures whose result is known in closed form, or was computed by the program of FLIP's
// authors.
#include "render/perceptual.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define WIDTH 64
#define HEIGHT 48
#define PPD 67.0f

typedef struct picture {
  uint8_t rgb[3 * WIDTH * HEIGHT];
} picture;

static picture uniform(uint8_t r, uint8_t g, uint8_t b) {
  picture p;
  for (size_t i = 0; i < sizeof p.rgb; ++i) p.rgb[i] = i % 3 == 0 ? r : i % 3 == 1 ? g : b;
  return p;
}

// Makes ramps of every channel, stripes of `stripe` pixels, and noise of an integer hash.
static picture pattern(uint32_t stripe, uint32_t noise) {
  picture p;
  for (uint32_t y = 0; y < HEIGHT; ++y) {
    for (uint32_t x = 0; x < WIDTH; ++x) {
      uint8_t *rgb = p.rgb + 3 * (y * WIDTH + x);
      const uint32_t hash = (x * 73856093u ^ y * 19349663u) * 2654435761u >> 24;
      const uint32_t jitter = hash * noise / 256;
      rgb[0] = (uint8_t)(x * 3 + jitter);
      rgb[1] = (uint8_t)(y * 4 + (x / stripe % 2 ? 30 : 0) + jitter / 2);
      rgb[2] = (uint8_t)(190 - x * 2 - y + (y / stripe % 2 ? 40 : 0) + jitter);
    }
  }
  return p;
}

static double mean_flip(const picture *a, const picture *b, float pixels_per_degree) {
  static float map[WIDTH * HEIGHT];
  double sum = 0.0;
  assert_int_equal(olx_flip(a->rgb, b->rgb, WIDTH, HEIGHT, pixels_per_degree, 1, map), OLX_OK);
  for (size_t i = 0; i < WIDTH * HEIGHT; ++i) {
    assert_true(map[i] >= 0.0f && map[i] <= 1.0f);
    sum += (double)map[i];
  }
  return sum / (WIDTH * HEIGHT);
}

static double mean_ssim(const picture *a, const picture *b) {
  double ssim;
  assert_int_equal(olx_ssim(a->rgb, b->rgb, WIDTH, HEIGHT, &ssim), OLX_OK);
  return ssim;
}

static void assert_close(double value, double expected, double tolerance) {
  if (fabs(value - expected) > tolerance) fail_msg("%.9g is not %.9g within %g", value, expected, tolerance);
}

static void ssim_of_uniform_pictures_compares_their_means(void **state) {
  (void)state;
  const uint8_t grays[][2] = {{0, 255}, {100, 110}, {20, 200}};
  for (size_t i = 0; i < 3; ++i) {
    const picture a = uniform(grays[i][0], grays[i][0], grays[i][0]),
                  b = uniform(grays[i][1], grays[i][1], grays[i][1]);
    const double x = grays[i][0] / 255.0, y = grays[i][1] / 255.0;
    assert_close(mean_ssim(&a, &b), (2 * x * y + 1e-4) / (x * x + y * y + 1e-4), 1e-12);
  }
}

// Rows that alternate by +-d around one mean have in any window the variance d^2 - (s d)^2 and a mean shifted by s d,
// where s is the alternating sum of the window's weights. Half the contrast halves the shift and the deviation.
static void ssim_of_halved_contrast_is_in_closed_form(void **state) {
  (void)state;
  picture a, b;
  for (size_t i = 0; i < 3 * WIDTH * HEIGHT; ++i) {
    const bool odd = i / (3 * WIDTH) % 2 == 1;
    a.rgb[i] = odd ? 168 : 88;
    b.rgb[i] = odd ? 148 : 108;
  }
  double weights = 0.0, alternating = 0.0;
  for (int i = -5; i <= 5; ++i) {
    const double weight = exp(-i * i / 4.5);
    weights += weight;
    alternating += i % 2 ? -weight : weight;
  }
  // Windows are centred on odd rows as often as on even ones: there are 48 - 10 rows of them.
  double expected = 0.0;
  for (int sign = -1; sign <= 1; sign += 2) {
    const double d = 40.0 / 255.0, mean = 128.0 / 255.0, shift = sign * alternating / weights * d;
    const double ma = mean + shift, mb = mean + shift / 2, variance = d * d - shift * shift;
    expected += (2 * ma * mb + 1e-4) * (variance + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (1.25 * variance + 9e-4)) / 2;
  }
  assert_close(mean_ssim(&a, &b), expected, 1e-12);
}

static void equal_pictures_are_equal(void **state) {
  (void)state;
  const picture a = pattern(5, 40);
  assert_true(mean_ssim(&a, &a) == 1.0);
  assert_true(mean_flip(&a, &a, PPD) == 0.0);
}

static void both_metrics_are_symmetric(void **state) {
  (void)state;
  const picture a = pattern(5, 0), b = pattern(7, 60);
  assert_true(mean_ssim(&a, &b) == mean_ssim(&b, &a));
  assert_true(mean_flip(&a, &b, PPD) == mean_flip(&b, &a, PPD));
}

static void no_window_fits_into_ten_pixels(void **state) {
  (void)state;
  const picture a = pattern(5, 0);
  double ssim;
  assert_int_equal(olx_ssim(a.rgb, a.rgb, 10, 20, &ssim), OLX_OK);
  assert_true(isnan(ssim));
  assert_int_equal(olx_ssim(a.rgb, a.rgb, 20, 10, &ssim), OLX_OK);
  assert_true(isnan(ssim));
  assert_int_equal(olx_ssim(a.rgb, a.rgb, 11, 11, &ssim), OLX_OK);
  assert_true(ssim == 1.0);
}

// Returns CIE L* of a grey of sRGB.
static double lightness(uint8_t srgb) { return 116.0 * pow((srgb / 255.0 + 0.055) / 1.055, 2.4 / 3.0) - 16.0; }

// Uniform pictures have no features, and the filters do not change them, so only colours differ. The L*a*b* of the
// primaries of sRGB are widely published.
static void flip_of_uniform_pictures_is_the_distance_of_their_colours(void **state) {
  (void)state;
  const double green[3] = {87.7347, -86.1827, 83.1793}, blue[3] = {32.2970, 79.1875, -107.8602};
  double chroma = 0.0;
  for (int i = 1; i < 3; ++i) {
    const double difference = 0.01 * green[0] * green[i] - 0.01 * blue[0] * blue[i];
    chroma += difference * difference;
  }
  const double largest = pow(green[0] - blue[0] + sqrt(chroma), 0.7), knee = 0.4 * largest;
  const picture black = uniform(0, 0, 0), white = uniform(255, 255, 255);
  const picture pure_green = uniform(0, 255, 0), pure_blue = uniform(0, 0, 255), gray = uniform(119, 119, 119);
  const double of_100 = pow(100.0, 0.7);
  assert_close(mean_flip(&black, &white, PPD), 0.95 + 0.05 * (of_100 - knee) / (largest - knee), 1e-5);
  assert_close(mean_flip(&pure_green, &pure_blue, PPD), 1.0, 1e-5);
  // Errors below the knee show the whole error of `largest`: published values of the primaries differ in the fifth
  // digit, as the matrices do from which they are computed.
  assert_close(mean_flip(&black, &gray, PPD), 0.95 * pow(lightness(119), 0.7) / knee, 5e-5);
  const picture near_gray = uniform(120, 120, 120);
  assert_close(mean_flip(&gray, &near_gray, PPD), 0.95 * pow(lightness(120) - lightness(119), 0.7) / knee, 5e-5);
}

// The expected values were computed from the same pictures with the authors' program, version 1.7.
static void flip_agrees_with_its_authors(void **state) {
  (void)state;
  const picture smooth = pattern(5, 0), striped = pattern(7, 0), noisy = pattern(5, 60);
  assert_close(mean_flip(&smooth, &striped, 67.0f), 0.287476, 2e-5);
  assert_close(mean_flip(&smooth, &noisy, 67.0f), 0.385034, 2e-5);
  assert_close(mean_flip(&smooth, &noisy, 25.0f), 0.397056, 2e-5);
  assert_close(mean_flip(&striped, &noisy, 140.0f), 0.418822, 2e-5);
}

static void fine_noise_fades_with_distance(void **state) {
  (void)state;
  const picture gray = uniform(128, 128, 128);
  picture noisy = gray;
  for (size_t i = 0; i < WIDTH * HEIGHT; ++i) {
    const uint8_t value = (i + i / WIDTH) % 2 ? 138 : 118;
    memset(noisy.rgb + 3 * i, value, 3);
  }
  const double near = mean_flip(&gray, &noisy, 20.0f), far = mean_flip(&gray, &noisy, 200.0f);
  assert_true(near > 0.1 && far < 0.3 * near);
}

static void a_map_is_where_the_difference_is(void **state) {
  (void)state;
  const picture a = uniform(90, 90, 90);
  picture b = a;
  memset(b.rgb + 3 * (20 * WIDTH + 30), 255, 3);
  float map[WIDTH * HEIGHT];
  assert_int_equal(olx_flip(a.rgb, b.rgb, WIDTH, HEIGHT, 20.0f, 2, map), OLX_OK);
  for (int y = 0; y < HEIGHT; ++y) {
    for (int x = 0; x < WIDTH; ++x) {
      const float value = map[y * WIDTH + x];
      assert_true(value <= map[20 * WIDTH + 30]);
      // At 20 pixels a degree the filters reach 3 pixels.
      if (abs(x - 30) > 3 || abs(y - 20) > 3) assert_true(value == 0.0f);
    }
  }
}

static void the_palette_is_dark_to_light(void **state) {
  (void)state;
  int before = -1;
  for (int i = 0; i <= 64; ++i) {
    uint8_t rgb[3];
    olx_magma((float)i / 64.0f, rgb);
    const int light = 2126 * rgb[0] + 7152 * rgb[1] + 722 * rgb[2];
    assert_true(light > before);
    before = light;
  }
  uint8_t rgb[3];
  olx_magma(NAN, rgb);
  assert_memory_equal(rgb, ((uint8_t[]){0, 0, 4}), 3);
  olx_magma(2.0f, rgb);
  assert_memory_equal(rgb, ((uint8_t[]){252, 253, 191}), 3);
}

static void layers_that_are_no_colours_and_settings_out_of_range_are_refused(void **state) {
  (void)state;
  olx_image image;
  olx_perceptual perceptual;
  olx_perceptual_settings settings = olx_perceptual_settings_default();
  assert_int_equal(olx_image_create(16, 16, 1u | 1u << OLX_LAYER_NORMAL, &image), OLX_OK);
  assert_int_equal(olx_compare_perceptual(&image, &image, OLX_LAYER_BEAUTY, &settings, NULL, &perceptual), OLX_OK);
  assert_true(perceptual.ssim == 1.0 && perceptual.flip == 0.0);
  assert_int_equal(olx_compare_perceptual(&image, &image, OLX_LAYER_NORMAL, &settings, NULL, &perceptual),
                   OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_compare_perceptual(&image, &image, OLX_LAYER_DIRECT, &settings, NULL, &perceptual),
                   OLX_ERROR_ARGUMENT);
  const float bad[][2] = {{0.0f, 67.0f}, {NAN, 67.0f}, {INFINITY, 67.0f}, {1.0f, 0.0f}, {1.0f, 1001.0f}, {1.0f, NAN}};
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
    settings.exposure = bad[i][0];
    settings.pixels_per_degree = bad[i][1];
    assert_int_equal(olx_compare_perceptual(&image, &image, OLX_LAYER_BEAUTY, &settings, NULL, &perceptual),
                     OLX_ERROR_ARGUMENT);
  }
  olx_image_free(&image);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ssim_of_uniform_pictures_compares_their_means),
      cmocka_unit_test(ssim_of_halved_contrast_is_in_closed_form),
      cmocka_unit_test(equal_pictures_are_equal),
      cmocka_unit_test(both_metrics_are_symmetric),
      cmocka_unit_test(no_window_fits_into_ten_pixels),
      cmocka_unit_test(flip_of_uniform_pictures_is_the_distance_of_their_colours),
      cmocka_unit_test(flip_agrees_with_its_authors),
      cmocka_unit_test(fine_noise_fades_with_distance),
      cmocka_unit_test(a_map_is_where_the_difference_is),
      cmocka_unit_test(the_palette_is_dark_to_light),
      cmocka_unit_test(layers_that_are_no_colours_and_settings_out_of_range_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
