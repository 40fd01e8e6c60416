// Tests images: EXR round trips and hostile EXR files, PNG and its tone map, and the metrics on images with known
// answers.
#include "core/file.h"
#include "core/hooks.h"
#include "render/image_io.h"

#include <octalux/render.h>

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include <OpenEXR/openexr.h>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
// The pragma is not within push and pop, since the warning is reported at the end of the file.
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wundef"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#define ALL_LAYERS ((1u << OLX_LAYER_COUNT) - 1)

static char folder[64];

static const char *in_folder(const char *name) {
  static char paths[4][128];
  static int next;
  char *path = paths[next++ & 3];
  snprintf(path, sizeof paths[0], "%s/%s", folder, name);
  return path;
}

static int make_folder(void **state) {
  (void)state;
  snprintf(folder, sizeof folder, "/tmp/octalux-image-XXXXXX");
  return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

static int count_files(void) {
  char command[128], line[16] = "";
  snprintf(command, sizeof command, "ls -A '%s' | wc -l", folder);
  FILE *pipe = popen(command, "r");
  assert_non_null(pipe);
  assert_non_null(fgets(line, sizeof line, pipe));
  pclose(pipe);
  return atoi(line);
}

static void assert_near(double value, double expected) {
  assert_true(fabs(value - expected) <= 1e-12 * fmax(1.0, fabs(expected)));
}

static float value_at(uint32_t layer, size_t i, uint32_t component) {
  const uint32_t hash = (uint32_t)(i * 3 + component) * 2654435761u + layer * 40503u;
  return ldexpf((float)(hash >> 8), (int)(hash % 40) - 30) * (hash & 64 ? -1.0f : 1.0f);
}

static olx_image make_image(uint32_t width, uint32_t height, uint32_t layer_mask) {
  olx_image image;
  assert_int_equal(olx_image_create(width, height, layer_mask, &image), OLX_OK);
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    if (!image.layers[layer]) continue;
    for (size_t i = 0; i < (size_t)width * height; ++i) {
      image.layers[layer][i] = (olx_vec3){value_at(layer, i, 0), value_at(layer, i, 1), value_at(layer, i, 2)};
      if (layer == OLX_LAYER_DEPTH) image.layers[layer][i] = (olx_vec3){fabsf(value_at(layer, i, 0)), 0.0f, 0.0f};
    }
  }
  return image;
}

static void assert_same_image(const olx_image *a, const olx_image *b) {
  assert_int_equal(a->width, b->width);
  assert_int_equal(a->height, b->height);
  for (uint32_t layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    assert_int_equal(a->layers[layer] != NULL, b->layers[layer] != NULL);
    if (!a->layers[layer]) continue;
    assert_memory_equal(a->layers[layer], b->layers[layer], (size_t)a->width * a->height * sizeof(olx_vec3));
  }
}

static void an_exr_gives_back_every_bit_of_every_layer(void **state) {
  (void)state;
  // The heights are below, at and above a ZIP block of 16 lines.
  static const uint32_t sizes[][2] = {{1, 1}, {3, 5}, {17, 16}, {64, 33}};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
    olx_image image = make_image(sizes[i][0], sizes[i][1], ALL_LAYERS), loaded;
    image.layers[OLX_LAYER_DEPTH][0].x = INFINITY;
    assert_int_equal(olx_image_save(&image, in_folder("all.exr")), OLX_OK);
    assert_int_equal(olx_image_load(in_folder("all.exr"), &loaded), OLX_OK);
    assert_same_image(&image, &loaded);
    olx_image_free(&image);
    olx_image_free(&loaded);
  }
}

static void an_exr_holds_the_layers_that_were_there(void **state) {
  (void)state;
  const uint32_t masks[] = {1u << OLX_LAYER_BEAUTY, 1u << OLX_LAYER_NORMAL | 1u << OLX_LAYER_BEAUTY,
                            1u << OLX_LAYER_DEPTH | 1u << OLX_LAYER_INDIRECT_GLOSSY};
  for (size_t i = 0; i < sizeof masks / sizeof masks[0]; ++i) {
    olx_image image = make_image(9, 4, masks[i]), loaded;
    assert_int_equal(olx_image_save(&image, in_folder("some.exr")), OLX_OK);
    assert_int_equal(olx_image_load(in_folder("some.exr"), &loaded), OLX_OK);
    assert_same_image(&image, &loaded);
    olx_image_free(&image);
    olx_image_free(&loaded);
  }
}

static void saving_replaces_the_old_file_and_leaves_nothing_beside_it(void **state) {
  (void)state;
  const int before = count_files();
  olx_image small = make_image(2, 2, 1u), large = make_image(40, 40, 1u), loaded;
  assert_int_equal(olx_image_save(&large, in_folder("again.exr")), OLX_OK);
  assert_int_equal(olx_image_save(&small, in_folder("again.exr")), OLX_OK);
  assert_int_equal(count_files(), before + 1);
  assert_int_equal(olx_image_load(in_folder("again.exr"), &loaded), OLX_OK);
  assert_same_image(&small, &loaded);
  olx_image_free(&small);
  olx_image_free(&large);
  olx_image_free(&loaded);
}

static void saving_where_no_file_can_be_says_so(void **state) {
  (void)state;
  olx_image image = make_image(2, 2, 1u);
  assert_int_equal(olx_image_save(&image, "/nonexistent/folder/a.exr"), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "/nonexistent/folder/a.exr"));
  assert_int_equal(olx_image_save(&image, "/nonexistent/folder/a.png"), OLX_ERROR_FILE);
  assert_int_equal(olx_image_save(&image, in_folder("a.jpg")), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_image_save(&image, in_folder("png")), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_image_save_layer_png(&image, OLX_LAYER_DIRECT, 1.0f, in_folder("a.png")), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_image_save_layer_png(&image, OLX_LAYER_BEAUTY, 0.0f, in_folder("a.png")), OLX_ERROR_ARGUMENT);
  olx_image_free(&image);
}

static void sizes_outside_the_range_are_refused(void **state) {
  (void)state;
  olx_image image;
  assert_int_equal(olx_image_create(0, 4, 1u, &image), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_image_create(4, 16385, 1u, &image), OLX_ERROR_ARGUMENT);
  assert_null(image.layers[0]);
}

static uint8_t srgb(double linear) {
  const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
  return (uint8_t)(255.0 * encoded + 0.5);
}

static void a_png_keeps_colours_below_the_shoulder_and_never_wraps_above(void **state) {
  (void)state;
  olx_image image;
  assert_int_equal(olx_image_create(256, 2, 1u, &image), OLX_OK);
  for (uint32_t x = 0; x < 256; ++x) {
    const float value = (float)x / 255.0f * 0.6f;
    image.layers[0][x] = (olx_vec3){value, value * 0.5f, 0.0f};
    image.layers[0][256 + x] = (olx_vec3){0.6f * powf(1.05f, (float)x), -1.0f, INFINITY};
  }
  assert_int_equal(olx_image_save(&image, in_folder("ramp.png")), OLX_OK);
  int width, height, channels;
  stbi_uc *rgb = stbi_load(in_folder("ramp.png"), &width, &height, &channels, 0);
  assert_non_null(rgb);
  assert_int_equal(width, 256);
  assert_int_equal(height, 2);
  assert_int_equal(channels, 3);
  for (int x = 0; x < 256; ++x) {
    const float value = (float)x / 255.0f * 0.6f;
    assert_in_range(rgb[3 * x], srgb((double)value) ? srgb((double)value) - 1 : 0, srgb((double)value) + 1);
    assert_in_range(rgb[3 * x + 1], srgb((double)value / 2) ? srgb((double)value / 2) - 1 : 0,
                    srgb((double)value / 2) + 1);
    assert_int_equal(rgb[3 * x + 2], 0);
    const stbi_uc *bright = rgb + 3 * (256 + x);
    if (x > 0) assert_true(bright[0] >= bright[-3]);
    assert_int_equal(bright[1], 0);
    assert_int_equal(bright[2], 255);
  }
  stbi_image_free(rgb);
  olx_image_free(&image);
}

static void exposure_scales_before_the_tone_map(void **state) {
  (void)state;
  uint8_t once[3], twice[3];
  olx_tone_map((olx_vec3){0.2f, 0.9f, 3.0f}, 2.0f, once);
  olx_tone_map((olx_vec3){0.4f, 1.8f, 6.0f}, 1.0f, twice);
  assert_memory_equal(once, twice, 3);
  olx_tone_map((olx_vec3){NAN, 0.0f, 0.0f}, 1.0f, once);
  assert_memory_equal(once, ((uint8_t[]){255, 0, 255}), 3);
}

static void fill(olx_image *image, olx_layer layer, olx_vec3 value) {
  for (size_t i = 0; i < (size_t)image->width * image->height; ++i) image->layers[layer][i] = value;
}

static void metrics_of_constant_images_are_what_the_definitions_say(void **state) {
  (void)state;
  olx_image a = make_image(8, 4, 1u), b = make_image(8, 4, 1u);
  fill(&a, OLX_LAYER_BEAUTY, (olx_vec3){1.5f, 2.0f, 3.0f});
  fill(&b, OLX_LAYER_BEAUTY, (olx_vec3){1.0f, 2.0f, 4.0f});
  olx_metrics metrics;
  assert_int_equal(olx_compare(&a, &b, OLX_LAYER_BEAUTY, &metrics), OLX_OK);
  assert_near(metrics.mse, (0.25 + 0.0 + 1.0) / 3.0);
  assert_near(metrics.relative_mse, 1.25 / 21.0);
  assert_near(metrics.bias, -0.5 / 7.0);
  assert_near(metrics.max, 1.0);
  assert_near(metrics.psnr, 10.0 * log10(16.0 / (1.25 / 3.0)));
  olx_image_free(&a);
  olx_image_free(&b);
}

static void metrics_see_one_pixel(void **state) {
  (void)state;
  olx_image a = make_image(10, 10, 1u), b = make_image(10, 10, 1u);
  fill(&a, OLX_LAYER_BEAUTY, (olx_vec3){1.0f, 1.0f, 1.0f});
  fill(&b, OLX_LAYER_BEAUTY, (olx_vec3){1.0f, 1.0f, 1.0f});
  a.layers[OLX_LAYER_BEAUTY][37].y = 4.0f;
  olx_metrics metrics;
  assert_int_equal(olx_compare(&a, &b, OLX_LAYER_BEAUTY, &metrics), OLX_OK);
  assert_near(metrics.mse, 9.0 / 300.0);
  assert_near(metrics.relative_mse, 9.0 / 300.0);
  assert_near(metrics.bias, 3.0 / 300.0);
  assert_near(metrics.max, 3.0);
  olx_image_free(&a);
  olx_image_free(&b);
}

static void equal_images_have_no_error_even_black_ones(void **state) {
  (void)state;
  olx_image a = make_image(5, 5, 1u | 1u << OLX_LAYER_DIRECT);
  fill(&a, OLX_LAYER_DIRECT, (olx_vec3){0.0f, 0.0f, 0.0f});
  olx_metrics metrics;
  for (int layer = 0; layer < 2; ++layer) {
    assert_int_equal(olx_compare(&a, &a, (olx_layer)layer, &metrics), OLX_OK);
    assert_true(metrics.mse == 0.0 && metrics.relative_mse == 0.0 && metrics.bias == 0.0 && metrics.max == 0.0);
    assert_true(isinf(metrics.psnr));
  }
  olx_image b = make_image(5, 5, 1u << OLX_LAYER_DIRECT);
  fill(&b, OLX_LAYER_DIRECT, (olx_vec3){1.0f, 0.0f, 0.0f});
  assert_int_equal(olx_compare(&b, &a, OLX_LAYER_DIRECT, &metrics), OLX_OK);
  assert_true(isinf(metrics.relative_mse));
  olx_image_free(&a);
  olx_image_free(&b);
}

static void metrics_refuse_what_cannot_be_compared(void **state) {
  (void)state;
  olx_image a = make_image(4, 4, 1u), b = make_image(4, 5, 1u), c = make_image(4, 4, 1u << OLX_LAYER_DIRECT);
  olx_metrics metrics;
  assert_int_equal(olx_compare(&a, &b, OLX_LAYER_BEAUTY, &metrics), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_compare(&a, &c, OLX_LAYER_BEAUTY, &metrics), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_compare(&a, &c, OLX_LAYER_DIRECT, &metrics), OLX_ERROR_ARGUMENT);
  olx_image_free(&a);
  olx_image_free(&b);
  olx_image_free(&c);
}

static void a_pixel_that_is_no_number_is_named(void **state) {
  (void)state;
  olx_image a = make_image(7, 5, 1u), b = make_image(7, 5, 1u);
  a.layers[OLX_LAYER_BEAUTY][7 * 3 + 2].z = NAN;
  olx_metrics metrics;
  assert_int_equal(olx_compare(&a, &b, OLX_LAYER_BEAUTY, &metrics), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "pixel (2, 3) of the image"));
  assert_int_equal(olx_compare(&b, &a, OLX_LAYER_BEAUTY, &metrics), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "pixel (2, 3) of the reference"));
  assert_int_equal(olx_compare_heatmap(&a, &b, OLX_LAYER_BEAUTY, in_folder("nan.png")), OLX_ERROR_FORMAT);
  assert_int_not_equal(access(in_folder("nan.png"), F_OK), 0);
  olx_image_free(&a);
  olx_image_free(&b);
}

static void the_sky_is_infinitely_deep_in_both_or_an_error(void **state) {
  (void)state;
  olx_image a = make_image(2, 1, 1u << OLX_LAYER_DEPTH), b = make_image(2, 1, 1u << OLX_LAYER_DEPTH);
  a.layers[OLX_LAYER_DEPTH][0].x = b.layers[OLX_LAYER_DEPTH][0].x = INFINITY;
  a.layers[OLX_LAYER_DEPTH][1].x = 3.0f;
  b.layers[OLX_LAYER_DEPTH][1].x = 2.0f;
  olx_metrics metrics;
  assert_int_equal(olx_compare(&a, &b, OLX_LAYER_DEPTH, &metrics), OLX_OK);
  assert_near(metrics.mse, 1.0);
  assert_near(metrics.relative_mse, 0.25);
  assert_near(metrics.bias, 0.5);
  b.layers[OLX_LAYER_DEPTH][0].x = 1.0f;
  assert_int_equal(olx_compare(&a, &b, OLX_LAYER_DEPTH, &metrics), OLX_ERROR_FORMAT);
  olx_image_free(&a);
  olx_image_free(&b);
}

static void a_heat_map_is_black_where_images_agree_and_bright_where_not(void **state) {
  (void)state;
  olx_image a = make_image(32, 64, 1u), b = make_image(32, 64, 1u);
  fill(&a, OLX_LAYER_BEAUTY, (olx_vec3){0.5f, 0.5f, 0.5f});
  fill(&b, OLX_LAYER_BEAUTY, (olx_vec3){0.5f, 0.5f, 0.5f});
  a.layers[OLX_LAYER_BEAUTY][32 * 10 + 20] = (olx_vec3){2.0f, 2.0f, 2.0f};
  assert_int_equal(olx_compare_heatmap(&a, &b, OLX_LAYER_BEAUTY, in_folder("heat.png")), OLX_OK);
  int width, height, channels;
  stbi_uc *rgb = stbi_load(in_folder("heat.png"), &width, &height, &channels, 0);
  assert_non_null(rgb);
  assert_true(width > 32);
  assert_int_equal(height, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 32; ++x) {
      const stbi_uc *pixel = rgb + 3 * (y * width + x);
      const int light = pixel[0] + pixel[1] + pixel[2];
      if (x == 20 && y == 10) assert_true(light > 500);
      else assert_int_equal(light, 0);
    }
  }
  stbi_image_free(rgb);
  olx_image_free(&a);
  olx_image_free(&b);
}

// Writes a file of one part with OpenEXR itself: half floats, another compression, a data window away from the origin.
static void write_foreign_exr(const char *path, exr_storage_t storage, exr_pixel_type_t type,
                              exr_compression_t compression, bool with_blue, const uint16_t *pixels, int32_t width,
                              int32_t height) {
  exr_context_t context;
  exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
  assert_int_equal(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &settings), 0);
  int part;
  assert_int_equal(exr_add_part(context, NULL, storage, &part), 0);
  const exr_attr_box2i_t window = {.min = {.x = -3, .y = 7}, .max = {.x = -3 + width - 1, .y = 7 + height - 1}};
  const exr_attr_v2f_t centre = {.x = 0.0f, .y = 0.0f};
  assert_int_equal(exr_initialize_required_attr(context, part, &window, &window, 1.0f, &centre, 1.0f,
                                                EXR_LINEORDER_INCREASING_Y, compression),
                   0);
  if (storage == EXR_STORAGE_TILED) {
    assert_int_equal(exr_set_tile_descriptor(context, part, 16, 16, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN), 0);
  }
  const char *names[] = {"A", "R", "G", "B"};
  for (int i = 0; i < (with_blue ? 4 : 3); ++i) {
    assert_int_equal(exr_add_channel(context, part, names[i], type, EXR_PERCEPTUALLY_LINEAR, 1, 1), 0);
  }
  assert_int_equal(exr_write_header(context), 0);
  if (storage == EXR_STORAGE_SCANLINE) {
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    int32_t lines;
    exr_get_scanlines_per_chunk(context, part, &lines);
    for (int32_t row = 0; row < height; row += lines) {
      exr_chunk_info_t chunk;
      assert_int_equal(exr_write_scanline_chunk_info(context, part, 7 + row, &chunk), 0);
      if (row == 0) assert_int_equal(exr_encoding_initialize(context, part, &chunk, &pipeline), 0);
      else assert_int_equal(exr_encoding_update(context, part, &chunk, &pipeline), 0);
      for (int16_t i = 0; i < pipeline.channel_count; ++i) {
        exr_coding_channel_info_t *channel = &pipeline.channels[i];
        const int component = channel->channel_name[0] == 'R' ? 0 : channel->channel_name[0] == 'G' ? 1 : 2;
        channel->encode_from_ptr = (const uint8_t *)(pixels + 3 * row * width + component);
        channel->user_bytes_per_element = 2;
        channel->user_data_type = EXR_PIXEL_HALF;
        channel->user_pixel_stride = 6;
        channel->user_line_stride = 6 * width;
      }
      if (row == 0) assert_int_equal(exr_encoding_choose_default_routines(context, part, &pipeline), 0);
      assert_int_equal(exr_encoding_run(context, part, &pipeline), 0);
    }
    exr_encoding_destroy(context, &pipeline);
  } else {
    const uint8_t tile[16 * 16 * 4 * 2] = {0};
    assert_int_equal(exr_write_tile_chunk(context, part, 0, 0, 0, 0, tile, sizeof tile), 0);
  }
  assert_int_equal(exr_finish(&context), 0);
}

static void half_float_images_of_other_programs_are_read(void **state) {
  (void)state;
  enum { width = 21, height = 40 };
  uint16_t pixels[3 * width * height];
  // Half floats of 1 + (i mod 1024) / 1024.
  for (int i = 0; i < 3 * width * height; ++i) pixels[i] = (uint16_t)(0x3c00 + i % 1024);
  const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                            EXR_COMPRESSION_ZIP, EXR_COMPRESSION_PIZ};
  for (size_t c = 0; c < sizeof compressions / sizeof compressions[0]; ++c) {
    write_foreign_exr(in_folder("half.exr"), EXR_STORAGE_SCANLINE, EXR_PIXEL_HALF, compressions[c], true, pixels, width,
                      height);
    olx_image image;
    assert_int_equal(olx_image_load(in_folder("half.exr"), &image), OLX_OK);
    assert_int_equal(image.width, width);
    assert_int_equal(image.height, height);
    const float *values = &image.layers[OLX_LAYER_BEAUTY][0].x;
    for (int i = 0; i < 3 * width * height; ++i) assert_true(values[i] == 1.0f + (float)(i % 1024) / 1024.0f);
    olx_image_free(&image);
  }
}

static void images_of_another_kind_are_turned_away_with_a_reason(void **state) {
  (void)state;
  uint16_t pixels[3 * 16 * 16] = {0};
  olx_image image;
  write_foreign_exr(in_folder("tiled.exr"), EXR_STORAGE_TILED, EXR_PIXEL_HALF, EXR_COMPRESSION_NONE, true, pixels, 16,
                    16);
  assert_int_equal(olx_image_load(in_folder("tiled.exr"), &image), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "tiled"));
  write_foreign_exr(in_folder("rg.exr"), EXR_STORAGE_SCANLINE, EXR_PIXEL_HALF, EXR_COMPRESSION_ZIP, false, pixels, 16,
                    16);
  assert_int_equal(olx_image_load(in_folder("rg.exr"), &image), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "R G B"));
  assert_int_equal(olx_image_load(in_folder("none.exr"), &image), OLX_ERROR_FILE);
  assert_int_equal(olx_image_load(folder, &image), OLX_ERROR_FILE);
  assert_null(image.layers[OLX_LAYER_BEAUTY]);
}

static uint8_t *read_bytes(const char *path, size_t *size_bytes) {
  olx_mapped_file file;
  assert_int_equal(olx_map_file(path, &file), OLX_OK);
  uint8_t *bytes = malloc(file.size_bytes);
  assert_non_null(bytes);
  memcpy(bytes, file.data, file.size_bytes);
  *size_bytes = file.size_bytes;
  olx_unmap_file(&file);
  return bytes;
}

static void every_truncation_is_an_error(void **state) {
  (void)state;
  olx_image image = make_image(12, 40, 1u | 1u << OLX_LAYER_DEPTH), loaded;
  assert_int_equal(olx_image_save(&image, in_folder("whole.exr")), OLX_OK);
  size_t size_bytes;
  uint8_t *bytes = read_bytes(in_folder("whole.exr"), &size_bytes);
  for (size_t length = 0; length < size_bytes; length += length < 1200 ? 1 : 97) {
    assert_int_equal(olx_write_file(in_folder("cut.exr"), bytes, length), OLX_OK);
    const olx_result result = olx_image_load(in_folder("cut.exr"), &loaded);
    assert_int_not_equal(result, OLX_OK);
    assert_non_null(strstr(olx_last_error(), "cut.exr"));
    assert_null(loaded.layers[OLX_LAYER_BEAUTY]);
  }
  free(bytes);
  olx_image_free(&image);
}

static void no_flipped_byte_crashes_the_loader(void **state) {
  (void)state;
  olx_image image = make_image(9, 20, 1u), loaded;
  assert_int_equal(olx_image_save(&image, in_folder("good.exr")), OLX_OK);
  size_t size_bytes;
  uint8_t *bytes = read_bytes(in_folder("good.exr"), &size_bytes);
  int refused = 0;
  for (size_t i = 0; i < size_bytes; i += i < 400 ? 1 : 13) {
    for (int bit = 0; bit < 8; bit += 7) {
      bytes[i] ^= (uint8_t)(1 << bit);
      assert_int_equal(olx_write_file(in_folder("bad.exr"), bytes, size_bytes), OLX_OK);
      if (olx_image_load(in_folder("bad.exr"), &loaded) == OLX_OK) olx_image_free(&loaded);
      else ++refused;
      bytes[i] ^= (uint8_t)(1 << bit);
    }
  }
  assert_true(refused > 0);
  free(bytes);
  olx_image_free(&image);
}

static void a_small_file_cannot_claim_a_huge_image(void **state) {
  (void)state;
  olx_image image = make_image(9, 20, 1u), loaded;
  assert_int_equal(olx_image_save(&image, in_folder("small.exr")), OLX_OK);
  size_t size_bytes;
  uint8_t *bytes = read_bytes(in_folder("small.exr"), &size_bytes);
  static const char name[] = "dataWindow\0box2i";
  uint8_t *window = memmem(bytes, size_bytes, name, sizeof name);
  assert_non_null(window);
  window += sizeof name + 4; // behind the attribute's size: min x, min y, max x, max y
  static const int32_t windows[][4] = {{0, 0, 16383, 16383}, {0, 0, 1 << 30, 1 << 30},
                                       {0, 0, INT32_MAX, 3}, {INT32_MIN, 0, INT32_MAX, 19},
                                       {5, 5, 2, 2},         {0, INT32_MIN, 8, -2}};
  for (size_t i = 0; i < sizeof windows / sizeof windows[0]; ++i) {
    memcpy(window, windows[i], sizeof windows[i]);
    assert_int_equal(olx_write_file(in_folder("huge.exr"), bytes, size_bytes), OLX_OK);
    assert_int_not_equal(olx_image_load(in_folder("huge.exr"), &loaded), OLX_OK);
    assert_non_null(strstr(olx_last_error(), "huge.exr"));
  }
  free(bytes);
  olx_image_free(&image);
}

static void layers_have_the_names_that_files_use(void **state) {
  (void)state;
  const char *names[OLX_LAYER_COUNT] = {"beauty", "direct", "indirect_diffuse", "indirect_glossy", "albedo",
                                        "normal", "depth",  "standard_error"};
  for (int layer = 0; layer < OLX_LAYER_COUNT; ++layer) {
    assert_string_equal(olx_layer_name((olx_layer)layer), names[layer]);
  }
}

static void no_image_has_a_layer_that_does_not_exist(void **state) {
  (void)state;
  const olx_layer beyond[] = {OLX_LAYER_COUNT, (olx_layer)1000, (olx_layer)-1};
  olx_image image;
  assert_int_equal(olx_image_create(16, 16, UINT32_MAX, &image), OLX_OK);
  for (uint32_t i = 0; i < sizeof beyond / sizeof *beyond; ++i) {
    olx_metrics metrics;
    olx_perceptual perceptual;
    const olx_perceptual_settings settings = olx_perceptual_settings_default();
    assert_int_equal(olx_compare(&image, &image, beyond[i], &metrics), OLX_ERROR_ARGUMENT);
    assert_int_equal(olx_compare_perceptual(&image, &image, beyond[i], &settings, NULL, &perceptual),
                     OLX_ERROR_ARGUMENT);
    assert_int_equal(olx_compare_heatmap(&image, &image, beyond[i], "/nowhere/a.png"), OLX_ERROR_ARGUMENT);
    assert_int_equal(olx_image_save_layer_png(&image, beyond[i], 1.0f, "/nowhere/a.png"), OLX_ERROR_ARGUMENT);
    assert_false(olx_layer_is_color(beyond[i]));
  }
  olx_image_free(&image);
}

static void assert_not_encoded(bool as_jpeg, uint32_t width, uint32_t height, uint32_t channels, uint32_t quality) {
  uint8_t pixel[8] = {0}, *file = pixel;
  size_t size_bytes = 1;
  const olx_result result = as_jpeg ? olx_jpeg_encode(width, height, channels, pixel, quality, &file, &size_bytes)
                                    : olx_png_encode(width, height, channels, pixel, &file, &size_bytes);
  assert_int_equal(result, OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), as_jpeg ? "JPEG" : "PNG"));
  assert_null(file);
  assert_int_equal(size_bytes, 0);
}

static void pictures_that_no_file_can_hold_are_refused(void **state) {
  (void)state;
  for (int as_jpeg = 0; as_jpeg < 2; as_jpeg++) {
    assert_not_encoded(as_jpeg, 0, 1, 3, 90);
    assert_not_encoded(as_jpeg, 1, 0, 3, 90);
    assert_not_encoded(as_jpeg, 1, 1, 0, 90);
    assert_not_encoded(as_jpeg, 1, 1, 2, 90);
    assert_not_encoded(as_jpeg, 1, 1, 7, 90);
    assert_not_encoded(as_jpeg, 65536, 65536, 3, 90);
    assert_not_encoded(as_jpeg, UINT32_MAX, UINT32_MAX, 4, 90);
    assert_not_encoded(as_jpeg, 1, UINT32_MAX, 3, 90);
  }
  assert_not_encoded(true, 65536, 1, 3, 90);
  assert_not_encoded(true, 1, 1, 1, 90);
  assert_not_encoded(true, 1, 1, 3, 0);
  assert_not_encoded(true, 1, 1, 3, 101);
  assert_non_null(strstr(olx_last_error(), "quality of 101"));
  static const uint32_t channels[] = {1, 3, 4, 3, 4};
  for (uint32_t i = 0; i < 5; i++) {
    const uint8_t pixels[16] = {0};
    uint8_t *file;
    size_t size_bytes;
    assert_int_equal(i < 3 ? olx_png_encode(2, 2, channels[i], pixels, &file, &size_bytes)
                           : olx_jpeg_encode(2, 2, channels[i], pixels, 100, &file, &size_bytes),
                     OLX_OK);
    assert_true(size_bytes > 0);
    olx_png_free(file);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_exr_gives_back_every_bit_of_every_layer),
      cmocka_unit_test(an_exr_holds_the_layers_that_were_there),
      cmocka_unit_test(saving_replaces_the_old_file_and_leaves_nothing_beside_it),
      cmocka_unit_test(saving_where_no_file_can_be_says_so),
      cmocka_unit_test(sizes_outside_the_range_are_refused),
      cmocka_unit_test(a_png_keeps_colours_below_the_shoulder_and_never_wraps_above),
      cmocka_unit_test(exposure_scales_before_the_tone_map),
      cmocka_unit_test(metrics_of_constant_images_are_what_the_definitions_say),
      cmocka_unit_test(metrics_see_one_pixel),
      cmocka_unit_test(equal_images_have_no_error_even_black_ones),
      cmocka_unit_test(metrics_refuse_what_cannot_be_compared),
      cmocka_unit_test(a_pixel_that_is_no_number_is_named),
      cmocka_unit_test(the_sky_is_infinitely_deep_in_both_or_an_error),
      cmocka_unit_test(a_heat_map_is_black_where_images_agree_and_bright_where_not),
      cmocka_unit_test(half_float_images_of_other_programs_are_read),
      cmocka_unit_test(images_of_another_kind_are_turned_away_with_a_reason),
      cmocka_unit_test(every_truncation_is_an_error),
      cmocka_unit_test(no_flipped_byte_crashes_the_loader),
      cmocka_unit_test(a_small_file_cannot_claim_a_huge_image),
      cmocka_unit_test(layers_have_the_names_that_files_use),
      cmocka_unit_test(no_image_has_a_layer_that_does_not_exist),
      cmocka_unit_test(pictures_that_no_file_can_hold_are_refused),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
