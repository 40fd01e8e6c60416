// The rasteriser of viewer/ on whatever Vulkan device there is, under the validation layers: its G-buffer is the ray caster's, its direct
// light is near the path tracer's, and nothing is left behind.
#include "core/bsdf.h"
#include "made_scenes.h"
#include "pinned_drivers.h"
#include "rasteriser.h"

#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

static gpu_device device;
static bool opened;

static int open_device(void **unused) {
  (void)unused;
  pin_drivers();
  opened = gpu_device_open(&(gpu_device_options){.validate = true, .device = UINT32_MAX}, &device);
  return 0;
}

static int close_device(void **unused) {
  (void)unused;
  if (!opened) return 0;
  const uint32_t before = device.validation_messages;
  gpu_device_close(&device);
  return device.validation_messages == before ? 0 : 1; // the layers name what was not destroyed
}

static void need_device(void) {
  if (opened) return;
  print_message("skipped: %s\n", device.problem);
  skip();
}

// One frame, read back.
typedef struct drawn_frame {
  float depth[PIXELS];
  olx_vec3 normal[PIXELS], base_color[PIXELS], material[PIXELS], color[PIXELS];
  uint8_t display[PIXELS][4];
} drawn_frame;

static float half_float(uint16_t h) {
  const float magnitude =
      ldexpf((float)(h & 0x3FFu) + (h & 0x7C00u ? 1024.0f : 0.0f), (h & 0x7C00u ? h >> 10 & 31 : 1) - 25);
  return h & 0x8000u ? -magnitude : magnitude;
}

static float decode_srgb(uint8_t byte) {
  const float x = (float)byte / 255.0f;
  return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

static void read_halves(const rasteriser *raster, frame_image image, VkImageLayout layout, const gpu_buffer *buffer,
                        olx_vec3 *to) {
  assert_true(gpu_image_read(&device, &raster->images.images[image], layout, buffer));
  const uint16_t *from = buffer->mapped;
  for (uint32_t i = 0; i < PIXELS; i++, from += 4) {
    to[i] = olx_v3(half_float(from[0]), half_float(from[1]), half_float(from[2]));
  }
}

static const uint8_t *read_bytes(const rasteriser *raster, frame_image image, VkImageLayout layout,
                                 const gpu_buffer *buffer) {
  assert_true(gpu_image_read(&device, &raster->images.images[image], layout, buffer));
  return buffer->mapped;
}

static void read_frame(const rasteriser *raster, const raster_view *view, drawn_frame *frame) {
  const VkImageLayout read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, general = VK_IMAGE_LAYOUT_GENERAL;
  gpu_buffer buffer;
  assert_true(gpu_buffer_create(&device, "reading", 8 * PIXELS, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, &buffer));
  const float *depths =
      (const void *)read_bytes(raster, FRAME_DEPTH, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, &buffer);
  for (uint32_t i = 0; i < PIXELS; i++) frame->depth[i] = depths[i] > 0.0f ? view->near_metres / depths[i] : INFINITY;
  read_halves(raster, FRAME_NORMAL, read, &buffer, frame->normal);
  read_halves(raster, FRAME_COLOR, general, &buffer, frame->color);
  const uint8_t *bytes = read_bytes(raster, FRAME_ALBEDO, read, &buffer);
  for (uint32_t i = 0; i < PIXELS; i++, bytes += 4) {
    frame->base_color[i] = olx_v3(decode_srgb(bytes[0]), decode_srgb(bytes[1]), decode_srgb(bytes[2]));
  }
  bytes = read_bytes(raster, FRAME_MATERIAL, read, &buffer);
  for (uint32_t i = 0; i < PIXELS; i++, bytes += 4) {
    frame->material[i] = olx_scale(olx_v3(bytes[0], bytes[1], bytes[2]), 1.0f / 255.0f);
  }
  memcpy(frame->display, read_bytes(raster, FRAME_DISPLAY, general, &buffer), sizeof frame->display);
  gpu_buffer_destroy(&device, &buffer);
}

static raster_view view_of(const olx_scene_content *content, const olx_camera *camera) {
  raster_view view;
  assert_true(
      raster_view_make(camera, WIDTH, HEIGHT, raster_view_near(content->bounds_min, content->bounds_max), &view));
  return view;
}

static void draw(const rasteriser *raster, const raster_view *view, float exposure) {
  const draw_item item = draw_item_in_place(&raster->scene);
  assert_true(gpu_commands_begin(&device));
  shadow_pass_record(&device, &raster->shadows, device.commands, &item, 1);
  gbuffer_pass_record(&device, &raster->gbuffer, device.commands, &raster->images, view, &item, 1);
  direct_pass_record(&device, &raster->direct, device.commands, &raster->images, view, DIRECT_LAMPS | DIRECT_SKY);
  tone_pass_record(&device, &raster->tone, device.commands, &raster->images, exposure);
  assert_true(gpu_commands_run(&device));
}

static void draw_scene(const olx_scene *scene, const olx_camera *camera, drawn_frame *frame) {
  const olx_scene_content content = olx_scene_get_content(scene);
  lamp_settings lamps = lamp_settings_default();
  lamps.surface_samples = LAMP_MAX_SAMPLES;
  rasteriser raster;
  if (!rasteriser_create(&device, &content, &lamps, WIDTH, HEIGHT, &raster)) fail_msg("%s", device.problem);
  const raster_view view = view_of(&content, camera);
  draw(&raster, &view, 1.0f);
  read_frame(&raster, &view, frame);
  rasteriser_destroy(&device, &raster);
}

// What the ray caster sees.
typedef struct cast_frame {
  olx_image image;
  olx_gbuffer surfaces;
} cast_frame;

static void cast_scene(const olx_scene *scene, const olx_camera *camera, uint32_t spp, cast_frame *frame) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_PATH);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  settings.spp = spp;
  const olx_result result =
      olx_render_surfaces(scene, NULL, camera, &settings, NULL, &frame->image, &frame->surfaces, NULL);
  if (result != OLX_OK) fail_msg("%s", olx_last_error());
}

static void release_cast(cast_frame *frame) {
  olx_image_free(&frame->image);
  olx_gbuffer_free(&frame->surfaces);
}

typedef struct difference {
  uint32_t surfaces;                   // pixels where both see one
  double edges;                        // share of pixels whose distance differs: they see another surface
  double depth;                        // largest relative difference of distances, over the others
  double normal, base_color, material; // largest absolute difference of a component, over 99.5 % of the others
} difference;

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

static double largest_component(olx_vec3 a, olx_vec3 b) {
  return (double)olx_max(fabsf(a.x - b.x), olx_max(fabsf(a.y - b.y), fabsf(a.z - b.z)));
}

static double percentile(double *values, uint32_t count) {
  qsort(values, count, sizeof *values, by_value);
  return count ? values[(size_t)((count - 1) * 0.995)] : 0.0;
}

static difference compare(const drawn_frame *drawn, const cast_frame *cast) {
  static double normals[PIXELS], colors[PIXELS], materials[PIXELS];
  difference d = {0};
  uint32_t edges = 0;
  for (uint32_t i = 0; i < PIXELS; i++) {
    const float inverse = cast->surfaces.inverse_depth[i];
    const float distance = inverse > 0.0f ? 1.0f / inverse : INFINITY;
    if (isinf(distance) && isinf(drawn->depth[i])) continue;
    const double off = fabs((double)drawn->depth[i] / (double)distance - 1.0);
    if (!(off < 2e-3) || largest_component(drawn->normal[i], cast->surfaces.normal[i]) > 0.5) {
      edges++;
      continue;
    }
    d.depth = fmax(d.depth, off);
    normals[d.surfaces] = largest_component(drawn->normal[i], cast->surfaces.normal[i]);
    colors[d.surfaces] = largest_component(drawn->base_color[i], cast->surfaces.base_color[i]);
    materials[d.surfaces] = largest_component(drawn->material[i], cast->surfaces.material[i]);
    d.surfaces++;
  }
  d.edges = (double)edges / PIXELS;
  d.normal = percentile(normals, d.surfaces);
  d.base_color = percentile(colors, d.surfaces);
  d.material = percentile(materials, d.surfaces);
  return d;
}

// Relative MSE and bias of direct light, over pixels that do not themselves shine.
static void compare_light(const drawn_frame *drawn, const cast_frame *cast, double *error, double *bias) {
  double squares = 0.0, reference = 0.0, sum = 0.0, excess = 0.0;
  for (uint32_t i = 0; i < PIXELS; i++) {
    const olx_vec3 a = drawn->color[i], b = cast->image.layers[OLX_LAYER_DIRECT][i];
    if (olx_max3(olx_sub(cast->image.layers[OLX_LAYER_BEAUTY][i], b)) > 0.0f) continue;
    const olx_vec3 off = olx_sub(a, b);
    squares += (double)olx_dot(off, off);
    reference += (double)olx_dot(b, b);
    excess += (double)(off.x + off.y + off.z);
    sum += (double)(b.x + b.y + b.z);
  }
  *error = squares / reference;
  *bias = excess / sum;
}

static void judge_builtin(const char *name, double most_edges, double most_error, double most_bias) {
  static drawn_frame drawn;
  olx_scene *scene;
  olx_camera camera;
  cast_frame cast;
  assert_int_equal(olx_scene_load(name, &scene), OLX_OK);
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  cast_scene(scene, &camera, 64, &cast);
  draw_scene(scene, &camera, &drawn);
  const difference d = compare(&drawn, &cast);
  double error, bias;
  compare_light(&drawn, &cast, &error, &bias);
  print_message(
      "%s: edges %.4f, depth %.1e, normal %.1e, base colour %.1e, material %.1e; light: error %.4f, bias %.4f\n", name,
      d.edges, d.depth, d.normal, d.base_color, d.material, error, bias);
  assert_true(d.surfaces > PIXELS / 2);
  assert_true(d.edges <= most_edges);
  assert_true(d.depth < 1e-4);
  assert_true(d.normal < 1e-3);     // a half float's rounding
  assert_true(d.base_color < 5e-3); // an sRGB byte's
  assert_true(d.material <= 0.5 / 255.0 + 1e-6);

  assert_true(error < most_error);
  assert_true(fabs(bias) < most_bias);
  assert_int_equal(device.validation_messages, 0);
  release_cast(&cast);
  olx_scene_free(scene);
}

static void draws_what_rays_see(void **unused) {
  (void)unused;
  need_device();
  judge_builtin("builtin:cornell", 0.005, 0.002, 0.01);
  judge_builtin("builtin:cornell-glossy", 0.005, 0.002, 0.01);
  judge_builtin("builtin:labyrinth", 0.005, 0.02, 0.08);
  judge_builtin("builtin:area-light", 0.005, 0.1, 0.04); // the lamp in the polished floor is blurred discs
  judge_builtin("builtin:temple", 0.005, 0.03, 0.08);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(draws_what_rays_see),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
