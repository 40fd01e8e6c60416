// Tests which blocks of pixels the experiment `surfaces` compares with the reference.
#include "bench/surfaces/picture_blocks.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { BLOCK = 8, LEFT = 16, TOP = 8, QUARTER = BLOCK * BLOCK / 4 };

static void set(olx_image *image, uint32_t x, uint32_t y, float light) {
  image->layers[OLX_LAYER_INDIRECT_DIFFUSE][y * image->width + x] = (olx_vec3){light, light, light};
}

// Makes a picture of light 1, in which the first `lit` pixels of one block have `light` and its other pixels none.
static olx_image picture(uint32_t lit, float light) {
  olx_image image;
  assert_int_equal(olx_image_create(4 * BLOCK, 3 * BLOCK, 1u << OLX_LAYER_INDIRECT_DIFFUSE, &image), OLX_OK);
  for (uint32_t y = 0; y < image.height; y++) {
    for (uint32_t x = 0; x < image.width; x++) set(&image, x, y, 1.0f);
  }
  for (uint32_t i = 0; i < BLOCK * BLOCK; i++) {
    set(&image, LEFT + i % BLOCK, TOP + i / BLOCK, i < lit ? light : 0.0f);
  }
  return image;
}

static void compare(uint32_t lit, float reference_light, float light, double *least, double *most) {
  olx_image reference = picture(lit, reference_light), image = picture(lit, light);
  surface_compare_blocks(&image, &reference, least, most);
  olx_image_free(&reference);
  olx_image_free(&image);
}

static void a_block_is_compared_where_a_quarter_of_its_pixels_hold_light(void **state) {
  (void)state;
  double least, most;
  compare(BLOCK * BLOCK, 1.0f, 3.0f, &least, &most);
  assert_float_equal(most, 3.0, 1e-6);
  assert_float_equal(least, 1.0, 0.0);
  compare(QUARTER, 1.0f, 3.0f, &least, &most);
  assert_float_equal(most, 3.0, 1e-6);
  compare(QUARTER, 1.0f, 0.0f, &least, &most);
  assert_float_equal(least, 0.0, 1e-6);
}

static void a_sliver_of_light_is_left_out(void **state) {
  (void)state;
  double least, most;
  compare(QUARTER - 1, 1.0f, 3.0f, &least, &most);
  assert_float_equal(most, 1.0, 0.0);
  compare(QUARTER - 1, 1.0f, 0.0f, &least, &most);
  assert_float_equal(least, 1.0, 0.0);
}

// The mean of the picture is about 1, so that a block of light 0.005 is darker than 1 % of it.
static void a_dark_block_is_left_out(void **state) {
  (void)state;
  double least, most;
  compare(BLOCK * BLOCK, 0.005f, 1.0f, &least, &most);
  assert_float_equal(most, 1.0, 0.0);
  compare(BLOCK * BLOCK, 0.02f, 1.0f, &least, &most);
  assert_float_equal(most, 50.0, 1e-3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_block_is_compared_where_a_quarter_of_its_pixels_hold_light),
      cmocka_unit_test(a_sliver_of_light_is_left_out),
      cmocka_unit_test(a_dark_block_is_left_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
