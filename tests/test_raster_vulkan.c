// Tests the rasteriser of viewer/ on any Vulkan device, under the validation layers: its G-buffer agrees with the ray
// caster's, its direct light is near the path tracer's, and nothing is left behind.
#include "core/bsdf.h"
#include "core/pack.h"
#include "made_scenes.h"
#include "pinned_drivers.h"
#include "rasteriser.h"
#include "scene/scene_build.h"
#include "vulkan_host.h"

#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

static gpu_device device;

static int open_device(void **unused) {
  (void)unused;
  pin_drivers();
  gpu_device_open(&(gpu_device_options){.validate = true, .device = UINT32_MAX}, &device);
  return 0;
}

static int close_device(void **unused) {
  (void)unused;
  return host_close_device(&device);
}

// A frame of the rasteriser, read back.
typedef struct drawn_frame {
  float depth[PIXELS];
  olx_vec3 normal[PIXELS], base_color[PIXELS], material[PIXELS], color[PIXELS];
  uint8_t display[PIXELS][4];
} drawn_frame;

static float decode_srgb(uint8_t byte) {
  const float x = (float)byte / 255.0f;
  return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

static void read_halves(const rasteriser *raster, frame_image image, VkImageLayout layout, const gpu_buffer *buffer,
                        olx_vec3 *to) {
  assert_true(gpu_image_read(&device, &raster->images.images[image], layout, buffer));
  const uint16_t *from = buffer->mapped;
  for (uint32_t i = 0; i < PIXELS; i++, from += 4) {
    to[i] = olx_v3(olx_half_unpack(from[0]), olx_half_unpack(from[1]), olx_half_unpack(from[2]));
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

// A frame that the ray caster computes on the CPU: the reference for a drawn frame.
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
  uint32_t surfaces;                   // pixels where both see a surface
  double edges;                        // share of pixels whose distance differs, since they see another surface
  double depth;                        // largest relative difference of distances, over the other pixels
  double normal, base_color, material; // largest absolute difference of a component, over 99.5 % of the other pixels
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

// Computes relative MSE and bias of direct light, over pixels that do not emit.
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

// Asserts that both see the same surfaces: the bounds are the rounding errors of half floats and of sRGB bytes.
static void judge_surfaces(const drawn_frame *drawn, const cast_frame *cast, double most_edges, const char *name) {
  const difference d = compare(drawn, cast);
  print_message("%s: edges %.4f, depth %.1e, normal %.1e, base colour %.1e, material %.1e\n", name, d.edges, d.depth,
                d.normal, d.base_color, d.material);
  assert_true(d.surfaces > PIXELS / 4);
  assert_true(d.edges <= most_edges);
  assert_true(d.depth < 1e-4);
  assert_true(d.normal < 1e-3);
  assert_true(d.base_color < 5e-3);
  assert_true(d.material <= 0.5 / 255.0 + 1e-6);
}

static void judge_light(const drawn_frame *drawn, const cast_frame *cast, double most_error, double most_bias,
                        const char *name) {
  double error, bias;
  compare_light(drawn, cast, &error, &bias);
  print_message("%s: light: error %.4f, bias %.4f\n", name, error, bias);
  assert_true(error < most_error);
  assert_true(fabs(bias) < most_bias);
}

static drawn_frame drawn, again;

static void judge_builtin(const char *name, double most_error, double most_bias) {
  olx_scene *scene;
  olx_camera camera;
  cast_frame cast;
  assert_int_equal(olx_scene_load(name, &scene), OLX_OK);
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  cast_scene(scene, &camera, 64, &cast);
  draw_scene(scene, &camera, &drawn);
  judge_surfaces(&drawn, &cast, 0.005, name);
  judge_light(&drawn, &cast, most_error, most_bias, name);
  assert_int_equal(device.validation_messages, 0);
  release_cast(&cast);
  olx_scene_free(scene);
}

static void draws_what_rays_see(void **unused) {
  (void)unused;
  host_need_device(&device);
  judge_builtin("builtin:cornell-glossy", 0.002, 0.01);
  judge_builtin("builtin:labyrinth", 0.02, 0.08);
  // The bound is wide, since the rasteriser blurs the lamp's reflection in the polished floor into discs.
  judge_builtin("builtin:area-light", 0.1, 0.04);
}

// ---- textures, masks, bent normals

static const olx_camera FROM_ABOVE = {
    .eye = {0.2f, 2.1f, 0.9f}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov_y_degrees = 50.0f};

static uint8_t random_byte(uint32_t i) { return (uint8_t)(made_random(7, i).x * 255.0f); }

// Makes a texture of few, large texels, so that the picture magnifies it and only the finest level is read.
static uint32_t random_texture(olx_scene *scene, uint32_t seed, bool srgb, uint8_t least, uint8_t most) {
  uint8_t rgba[4 * 4 * 4];
  for (uint32_t i = 0; i < sizeof rgba; i++) {
    rgba[i] = (uint8_t)(least + random_byte(seed * 1000 + i) * (most - least) / 255);
  }
  return made_texture(scene, 4, 4, rgba, srgb);
}

static olx_material plain(void) {
  olx_material material = olx_material_default();
  material.base_color = olx_v3(0.9f, 0.7f, 0.5f);
  material.metallic = 0.5f;
  material.roughness = 0.8f;
  material.specular_weight = 1.0f;
  return material;
}

// Adds a plain square below the scene, lit by a slanting sun.
static olx_scene *made_surroundings(olx_scene *scene) {
  const olx_material below = plain();
  made_quad(scene, olx_v3(0, -0.5f, 0), olx_v3(0, 0, 8), olx_v3(8, 0, 0), made_material(scene, &below));
  scene->lights = olx_scene_array(1, sizeof *scene->lights);
  const olx_light sun = {.type = OLX_LIGHT_SUN, .direction = {0.6f, -0.8f, 0.0f}, .emission = {3.0f, 2.5f, 2.0f}};
  assert_int_equal(olx_scene_add_light(scene, &sun), OLX_OK);
  return made_finish(scene);
}

// Compares a scene, which is not finished yet, and releases it.
static void judge_scene(const char *name, olx_scene *scene, double most_edges, double most_normal) {
  cast_frame cast;
  made_surroundings(scene);
  cast_scene(scene, &FROM_ABOVE, 1, &cast);
  draw_scene(scene, &FROM_ABOVE, &drawn);
  const difference d = compare(&drawn, &cast);
  double error, bias;
  compare_light(&drawn, &cast, &error, &bias);
  print_message("%s: edges %.4f, normal %.1e, base colour %.1e, material %.1e; light: error %.4f, bias %.4f\n", name,
                d.edges, d.normal, d.base_color, d.material, error, bias);
  assert_true(d.surfaces > PIXELS / 2);
  assert_true(d.edges <= most_edges);
  assert_true(d.depth < 1e-4);
  assert_true(d.normal < most_normal);
  assert_true(d.base_color < 1e-2); // a wide bound, since texture units interpolate with eight bits
  assert_true(d.material < 1e-2);
  assert_true(error < 0.03); // the error is at the shadow's edge
  assert_true(fabs(bias) < 0.02);
  assert_int_equal(device.validation_messages, 0);
  release_cast(&cast);
  olx_scene_free(scene);
}

static void judge_material(const char *name, const olx_material *material, olx_scene *scene, double most_edges,
                           double most_normal) {
  made_square(scene, 0.0f, made_material(scene, material));
  judge_scene(name, scene, most_edges, most_normal);
}

static void textures_are_as_rays_find_them(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_material m = plain();
  judge_material("plain", &m, made_scene(), 0.005, 1e-3);
  olx_scene *scene = made_scene();
  m.base_color_texture = random_texture(scene, 1, true, 0, 255);
  m.metallic_roughness_texture = random_texture(scene, 2, false, 0, 255);
  judge_material("textured", &m, scene, 0.005, 1e-3);
  scene = made_scene();
  m.metallic_roughness_texture = random_texture(scene, 2, false, 0, 255);
  m.base_color_texture = OLX_NO_TEXTURE;
  m.specular_in_alpha = true;
  judge_material("specular weights in alpha", &m, scene, 0.005, 1e-3);
}

static void masks_leave_holes(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_material m = plain();
  olx_scene *scene = made_scene();
  m.alpha_cutoff = 0.5f;
  m.alpha_texture = random_texture(scene, 3, false, 0, 255);
  judge_material("masked", &m, scene, 0.02, 1e-3);
  m = plain();
  scene = made_scene();
  m.alpha_cutoff = 0.4f;
  m.alpha = 0.8f;
  m.base_color_texture = random_texture(scene, 4, true, 0, 255);
  judge_material("masked by its colour's alpha", &m, scene, 0.02, 1e-3);
}

static void normals_are_bent(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_material m = plain();
  olx_scene *scene = made_scene();
  m.normal_texture = random_texture(scene, 5, false, 100, 200);
  m.normal_scale = 0.7f;
  judge_material("normal map", &m, scene, 0.005, 5e-2);
  m = plain();
  scene = made_scene();
  m.normal_texture = random_texture(scene, 6, false, 0, 255);
  m.normal_is_height = true;
  m.normal_scale = 0.8f;
  judge_material("height map", &m, scene, 0.005, 5e-2);
}

// Makes a square with a material, and with every attribute that vertices may have.
static void made_rich_square(olx_scene *scene, const olx_material *material) {
  const olx_vec3 corners[4] = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}},
                 up[4] = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}};
  const olx_vec2 uvs[4] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}},
                 second_uvs[4] = {{0.25f, 0.5f}, {0.25f, 1}, {0.75f, 1}, {0.75f, 0.5f}};
  const olx_vec4 colors[4] = {{1, 0, 0, 1}, {0, 1, 0, 0.2f}, {1, 1, 1, 1}, {0.2f, 0.3f, 1, 0.8f}};
  const olx_vec4 tangents[4] = {{0, 0, 1, -1}, {0.6f, 0, 0.8f, -1}, {1, 0, 0, -1}, {0, 0, 1, -1}};
  const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
  const olx_mesh mesh = {.positions = corners,
                         .normals = up,
                         .uvs = uvs,
                         .second_uvs = second_uvs,
                         .colors = colors,
                         .tangents = tangents,
                         .indices = indices,
                         .vertex_count = 4,
                         .triangle_count = 2,
                         .material = made_material(scene, material)};
  assert_int_equal(olx_scene_append_mesh(scene, "rich square", &mesh), OLX_OK);
}

static void vertices_are_as_rays_find_them(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_material m = plain();
  olx_scene *scene = made_scene();
  m.alpha_cutoff = 0.4f;
  made_rich_square(scene, &m);
  judge_scene("colours of vertices, and their alpha", scene, 0.02, 1e-3);
  m = plain();
  scene = made_scene();
  m.base_color_texture = random_texture(scene, 1, true, 0, 255);
  m.metallic_roughness_texture = random_texture(scene, 2, false, 0, 255);
  m.second_uvs = OLX_SLOT_METALLIC_ROUGHNESS;
  made_rich_square(scene, &m);
  judge_scene("second texture coordinates", scene, 0.005, 1e-3);
  m = plain();
  scene = made_scene();
  m.normal_texture = random_texture(scene, 5, false, 100, 200);
  m.second_uvs = OLX_SLOT_NORMAL;
  made_rich_square(scene, &m);
  judge_scene("tangents", scene, 0.005, 5e-2);
}

// ---- light

static void add_light(olx_scene *scene, const olx_light *light) {
  assert_int_equal(olx_scene_add_light(scene, light), OLX_OK);
}

// Compares the shadow that a square casts on a floor under a light.
static void judge_lamp(const char *name, const olx_light *light, double most_error, double most_bias) {
  olx_scene *scene = made_scene();
  const olx_material m = plain();
  const uint32_t material = made_material(scene, &m);
  made_quad(scene, olx_v3(0, 0.7f, 0), olx_v3(0, 0, 0.8f), olx_v3(0.8f, 0, 0), material);
  made_quad(scene, olx_v3(0, 0, 0), olx_v3(0, 0, 8), olx_v3(8, 0, 0), material);
  add_light(scene, light);
  made_finish(scene);
  cast_frame cast;
  cast_scene(scene, &FROM_ABOVE, 1, &cast);
  draw_scene(scene, &FROM_ABOVE, &drawn);
  judge_light(&drawn, &cast, most_error, most_bias, name);
  assert_int_equal(device.validation_messages, 0);
  release_cast(&cast);
  olx_scene_free(scene);
}

static void every_lamp_casts_its_shadow(void **unused) {
  (void)unused;
  host_need_device(&device);
  const olx_light sun = {.type = OLX_LIGHT_SUN, .direction = {0.3f, -0.9f, 0.2f}, .emission = {3, 2, 1}};
  const olx_light point = {.type = OLX_LIGHT_POINT, .position = {0.3f, 1.4f, -0.2f}, .emission = {5, 4, 3}};
  const olx_light narrow = {.type = OLX_LIGHT_SPOT,
                            .position = {0.3f, 1.6f, -0.2f},
                            .direction = {-0.1f, -1.0f, 0.0f},
                            .emission = {9, 8, 7},
                            .cosine_inner = 0.95f,
                            .cosine_outer = 0.8f};
  olx_light wide = narrow; // a cone wider than one view of a shadow map can show
  wide.cosine_inner = 0.2f;
  wide.cosine_outer = -0.1f;
  judge_lamp("sun", &sun, 0.02, 0.02);
  judge_lamp("point", &point, 0.02, 0.02);
  judge_lamp("narrow spot", &narrow, 0.02, 0.02);
  judge_lamp("wide spot", &wide, 0.02, 0.02);
}

// The sky surrounds a small square: every direction is looked up as by the path tracer, and lights the square from all
// sides.
static void the_sky_is_where_rays_find_it(void **unused) {
  (void)unused;
  host_need_device(&device);
  enum { SKY_WIDTH = 16, SKY_HEIGHT = 8 };
  olx_scene *scene = made_scene();
  const olx_material m = plain();
  made_square(scene, 0.0f, made_material(scene, &m));
  olx_environment *e = &scene->environment;
  *e = (olx_environment){
      .radiance = {1.0f, 0.8f, 0.6f}, .width = SKY_WIDTH, .height = SKY_HEIGHT, .rotation_radians = 0.7f};
  e->texels = olx_scene_array(3 * SKY_WIDTH * SKY_HEIGHT, sizeof *e->texels);
  for (uint32_t i = 0; i < 3 * SKY_WIDTH * SKY_HEIGHT; i++) e->texels[i] = made_random(9, i).x;
  made_finish(scene);
  const olx_camera camera = {.eye = {2.5f, 1.0f, 0.5f}, .target = {0, 0.3f, 0}, .up = {0, 1, 0}, .fov_y_degrees = 90};
  cast_frame cast;
  cast_scene(scene, &camera, 256, &cast);
  draw_scene(scene, &camera, &drawn);
  uint32_t skies = 0;
  for (uint32_t i = 0; i < PIXELS; i++) {
    if (!isinf(drawn.depth[i])) continue;
    assert_true(largest_component(drawn.color[i], cast.image.layers[OLX_LAYER_BEAUTY][i]) < 2e-3);
    skies++;
  }
  assert_true(skies > PIXELS / 2);
  judge_light(&drawn, &cast, 0.1, 0.1, "sky");
  assert_int_equal(device.validation_messages, 0);
  release_cast(&cast);
  olx_scene_free(scene);
}

// ---- frames

// Returns the tone map's value: a shoulder above 0.6, then sRGB.
static float tone(float x) {
  const float bent = x <= 0.6f ? x : 0.6f + 0.4f * (1.0f - expf((0.6f - x) / 0.4f));
  return 255.0f * (bent <= 0.0031308f ? 12.92f * bent : 1.055f * powf(bent, 1.0f / 2.4f) - 0.055f);
}

static void the_picture_is_tone_mapped(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_scene *scene;
  olx_camera camera;
  assert_int_equal(olx_scene_load("builtin:cornell", &scene), OLX_OK);
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  draw_scene(scene, &camera, &drawn);
  for (uint32_t i = 0; i < PIXELS; i++) {
    const float shown[3] = {tone(drawn.color[i].x), tone(drawn.color[i].y), tone(drawn.color[i].z)};
    for (uint32_t k = 0; k < 3; k++) assert_true(fabsf(shown[k] - (float)drawn.display[i][k]) <= 1.01f);
    assert_int_equal(drawn.display[i][3], 255);
  }
  olx_scene_free(scene);
}

// A camera that moves with the scene sees the same picture.
static void scenes_can_be_moved(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_scene *scene;
  olx_camera camera;
  rasteriser raster;
  assert_int_equal(olx_scene_load("builtin:cornell-glossy", &scene), OLX_OK);
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  const olx_scene_content content = olx_scene_get_content(scene);
  const lamp_settings none = {.map_size = 16, .sun_tiles = 1};
  assert_true(rasteriser_create(&device, &content, &none, 8, 8, &raster));
  assert_int_equal(raster.shadows.lamp_count, 0); // only emissive surfaces light this scene
  assert_true(rasteriser_resize(&device, &raster, WIDTH, HEIGHT));
  const draw_item here = draw_item_in_place(&raster.scene);
  // The transform is a quarter turn about y, twice the size, and a shift: (x, y, z) to (2z + 3, 2y - 1, 2 - 2x).
  const draw_item there = {.scene = &raster.scene, .to_world = {0, 0, 2, 3, 0, 2, 0, -1, -2, 0, 0, 2}};
  olx_camera moved = camera;
  moved.eye = olx_v3(2 * camera.eye.z + 3, 2 * camera.eye.y - 1, 2 - 2 * camera.eye.x);
  moved.target = olx_v3(2 * camera.target.z + 3, 2 * camera.target.y - 1, 2 - 2 * camera.target.x);
  const raster_view from_here = view_of(&content, &camera), from_there = view_of(&content, &moved);
  for (uint32_t k = 0; k < 2; k++) {
    const raster_view *view = k ? &from_there : &from_here;
    assert_true(gpu_commands_begin(&device));
    gbuffer_pass_record(&device, &raster.gbuffer, device.commands, &raster.images, view, k ? &there : &here, 1);
    assert_true(gpu_commands_run(&device));
    read_frame(&raster, view, k ? &again : &drawn);
  }
  uint32_t differ = 0;
  for (uint32_t i = 0; i < PIXELS; i++) {
    const olx_vec3 n = again.normal[i], back = olx_v3(-n.z, n.y, n.x);
    const bool same = isinf(drawn.depth[i]) ? isinf(again.depth[i])
                                            : fabsf(again.depth[i] / (2.0f * drawn.depth[i]) - 1.0f) < 1e-3f &&
                                                  largest_component(back, drawn.normal[i]) < 2e-3 &&
                                                  largest_component(again.color[i], drawn.color[i]) == 0.0;
    differ += !same;
  }
  assert_true(differ < PIXELS / 200);
  assert_int_equal(device.validation_messages, 0);
  rasteriser_destroy(&device, &raster);
  olx_scene_free(scene);
}

static void what_cannot_be_is_refused(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_scene *scene;
  rasteriser raster;
  raster_view view;
  gpu_device other;
  assert_int_equal(olx_scene_load("builtin:cornell", &scene), OLX_OK);
  const olx_scene_content content = olx_scene_get_content(scene);
  const lamp_settings lamps = {.map_size = 16, .sun_tiles = 1};
  olx_camera camera = content.cameras[0];
  camera.target = camera.eye;
  assert_false(raster_view_make(&camera, WIDTH, HEIGHT, 0.1f, &view));
  // This allocation is larger than any device's memory: the message names its purpose, and earlier objects are
  // destroyed again.
  assert_true(rasteriser_create(&device, &content, &lamps, WIDTH, HEIGHT, &raster));
  gpu_buffer vast;
  assert_false(
      gpu_buffer_create(&device, "a vast buffer", UINT64_C(1) << 46, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, false, &vast));
  assert_non_null(strstr(device.problem, "a vast buffer: "));
  assert_null(vast.buffer);
  assert_false(rasteriser_resize(&device, &raster, 1u << 20, HEIGHT));
  assert_non_null(strstr(device.problem, "the device has no images of 1048576 x 72 pixels"));
  assert_true(rasteriser_resize(&device, &raster, HEIGHT, WIDTH)); // resizing may be tried again
  rasteriser_destroy(&device, &raster);
  assert_false(gpu_device_open(&(gpu_device_options){.device = 15}, &other));
  assert_non_null(strstr(other.problem, "there is no Vulkan device 15"));
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(draws_what_rays_see),
      cmocka_unit_test(textures_are_as_rays_find_them),
      cmocka_unit_test(masks_leave_holes),
      cmocka_unit_test(normals_are_bent),
      cmocka_unit_test(vertices_are_as_rays_find_them),
      cmocka_unit_test(every_lamp_casts_its_shadow),
      cmocka_unit_test(the_sky_is_where_rays_find_it),
      cmocka_unit_test(the_picture_is_tone_mapped),
      cmocka_unit_test(scenes_can_be_moved),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
