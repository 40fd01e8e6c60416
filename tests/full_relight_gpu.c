// Tests frames of a relighter on a device: when lights change, the light of each frame is that of olx_relight_frame;
// data that does not fit or is missing is refused.
#include "core/hooks.h"
#include "relight/relighter.h"
#include "scene_files.h"
#include "tiny_scenes.h"
#include "vulkan/vulkan_frame.h"
#include "vulkan/vulkan_relight.h"
#include "vulkan_faults.h"
#include "vulkan_host.h"

#include <octalux/bake.h>

enum { WIDTH = 48, HEIGHT = 32, PIXELS = WIDTH * HEIGHT, TILE_TEXELS = 1024, MOST_FRAMES = 1000, SURFEL_PARTS = 3 };

static const analytic_scene ROOM = {.room = {{-1, -1, -1}, {1, 1, 1}}};
static const host_view VIEW = {.scene = &ROOM, .eye = {0.3f, 0.2f, 0.8f}, .width = WIDTH, .height = HEIGHT};

static gpu_device device;
static scene_folder folder;
static olx_scene *scene;
static olx_field *field;
static host_images images;       // of the frame that renders all pictures
static olx_vulkan_field *framed; // the field for which this frame was made
static olx_vulkan_frame *frame;
static gpu_buffer copied; // light of the device's surfels: direct, indirect, and highlights in the indirect light

static olx_field *bake(const char *name) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = (olx_grid){{-0.6f, -0.6f, -0.6f}, {1.2f, 1.2f, 1.2f}, {2, 2, 2}};
  settings.radiance_size = 64;
  settings.volume_cells = 4;
  settings.noise = 0.2f;
  settings.relight = true;
  char path[400];
  snprintf(path, sizeof path, "%s/%s", folder.path, name);
  ASSERT_OK(olx_bake(scene, &settings, path, NULL, NULL));
  olx_field *baked;
  ASSERT_OK(olx_field_open(path, &baked));
  return baked;
}

// Makes the frame of all pictures: its pipelines, whose compilation takes seconds on a CPU device, fit every field of
// the same room, since all have the same set layouts.
static void make_frame(void) {
  images = host_images_make(&device, WIDTH, HEIGHT, VK_FORMAT_R32G32B32A32_SFLOAT);
  images.targets.passes = OLX_VULKAN_PASS_IRRADIANCE | OLX_VULKAN_PASS_GLOSSY;
  images.targets.dynamic = host_input(&images, HOST_DYNAMIC);
  ASSERT_OK(olx_vulkan_field_create(&device.host, field, &framed));
  ASSERT_OK(olx_vulkan_frame_create(framed, &images.targets, &frame));
}

// Makes a coloured box with a glossy floor, a screen that casts shadows, and a small lamp.
static int set_up(void **unused) {
  (void)unused;
  if (!host_open_device(&device, true)) return 0;
  if (!scene_folder_create(&folder)) return -1;
  scene = tiny_scene();
  olx_material walls = tiny_lambert(0.6f, 0.0f), screen = tiny_lambert(0.3f, 0.0f), lamp = tiny_lambert(0.0f, 2.0f);
  const olx_material floor = tiny_plastic(0.4f, 0.3f);
  walls.base_color = olx_v3(0.7f, 0.5f, 0.4f);
  tiny_box(scene, &walls);
  tiny_quad(scene, &floor, olx_v3(0, -0.99f, 0), olx_v3(0, 0, 1.98f), olx_v3(1.98f, 0, 0));
  tiny_quad(scene, &screen, olx_v3(0.1f, -0.35f, 0.05f), olx_v3(0, 0, 0.7f), olx_v3(0.6f, 0.1f, 0));
  tiny_quad(scene, &lamp, olx_v3(0, 0.99f, 0), olx_v3(0.4f, 0, 0), olx_v3(0, 0, 0.4f));
  tiny_finish(scene);
  field = bake("box.olx");
  const olx_relight_header *h = field->relight.header;
  print_message("%u surfels, %u links, %u sites, %u volume probes\n", h->surfels, h->links, h->sites, h->volume_probes);
  assert_true(h->surfels > 500 && h->links > h->surfels && h->volume_probes > 8);
  make_frame();
  const VkDeviceSize bytes = SURFEL_PARTS * sizeof(olx_vec3) * h->surfels;
  return gpu_buffer_create(&device, "copied light", bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, &copied) ? 0 : -1;
}

static int tear_down(void **unused) {
  (void)unused;
  if (!device.host.device) return 0;
  gpu_buffer_destroy(&device, &copied);
  olx_vulkan_frame_destroy(frame);
  host_images_free(&images);
  olx_vulkan_field_destroy(framed);
  olx_field_close(field);
  olx_scene_free(scene);
  scene_folder_remove(&folder);
  return host_close_device(&device);
}

// Returns settings with so many shadow rays that no frame lacks any, since the device also counts rays of surfaces that
// face away.
static olx_relight_settings small_budget(void) {
  olx_relight_settings settings = olx_relight_settings_default();
  settings.shadow_rays = 1u << 30;
  settings.texels = 9 * TILE_TEXELS;
  settings.surfels = field->relight.header->surfels * 2 / 3;
  settings.volume_probes = 50;
  settings.sleep = 1e-5f;
  return settings;
}

static olx_relight *begin_relight(const olx_relight_settings *settings) {
  olx_relight *relight;
  ASSERT_OK(olx_relight_create(field, settings, &relight));
  return relight;
}

// ---- Pictures of a field on the device, with objects that take the light of the volume

enum { IRRADIANCE, GLOSSY, KINDS };

typedef struct picture {
  olx_vulkan_field *uploaded;
  olx_vec3 light[KINDS][PIXELS]; // once it is rendered
} picture;

static picture make_picture(const olx_field *from) {
  picture p = {.uploaded = NULL};
  ASSERT_OK(olx_vulkan_field_create(&device.host, from, &p.uploaded));
  return p;
}

static void free_picture(picture *p) { olx_vulkan_field_destroy(p->uploaded); }

static void render(picture *p) {
  const olx_vulkan_view view = host_vulkan_view(&VIEW);
  const olx_vulkan_settings settings = olx_vulkan_settings_default();
  frame->field = p->uploaded;
  assert_true(gpu_commands_begin(&device));
  host_upload(&images, &VIEW);
  ASSERT_OK(olx_vulkan_record_irradiance(frame, device.commands, &view, &settings));
  ASSERT_OK(olx_vulkan_record_glossy(frame, device.commands, &view, &settings));
  host_download(&images);
  assert_true(gpu_commands_run(&device));
  frame->field = framed;
  float alpha;
  for (uint32_t i = 0; i < KINDS * PIXELS; i++)
    p->light[i / PIXELS][i % PIXELS] = host_output(&images, i / PIXELS, i % PIXELS, &alpha);
}

typedef struct picture_errors {
  double surfaces, objects, glossy; // relative mean squared errors of the three kinds of light
} picture_errors;

static double add_error(const picture *a, const picture *b, uint32_t kind, bool dynamic) {
  double off = 0.0, sum = 0.0;
  for (uint32_t i = 0; i < PIXELS; i++) {
    const host_pixel p = host_pixel_at(&VIEW, i % WIDTH, i / WIDTH);
    if (p.empty || p.dynamic != dynamic) continue;
    const olx_vec3 truth = b->light[kind][i], d = olx_sub(a->light[kind][i], truth);
    off += (double)olx_dot(d, d);
    sum += (double)olx_dot(truth, truth);
  }
  return sum > 0.0 ? off / sum : off;
}

// Returns the errors of a picture against a picture of the CPU's field, uploaded in whole.
static picture_errors judge_picture(picture *p, const olx_field *truth) {
  picture other = make_picture(truth);
  render(p);
  render(&other);
  const picture_errors e = {add_error(p, &other, IRRADIANCE, false), add_error(p, &other, IRRADIANCE, true),
                            add_error(p, &other, GLOSSY, false)};
  free_picture(&other);
  return e;
}

// ---- Frames on both sides

typedef struct both_sides {
  olx_relight *cpu, *gpu; // the frames of `gpu` are computed on the device
  picture picture;
  olx_vulkan_relight *frames;
} both_sides;

static both_sides make_both(const olx_relight_settings *settings, uint32_t in_flight) {
  both_sides b = {.cpu = begin_relight(settings), .gpu = begin_relight(settings)};
  b.picture = make_picture(field);
  const olx_vulkan_relight_settings own = {.in_flight = in_flight};
  ASSERT_OK(olx_vulkan_relight_create(b.picture.uploaded, b.gpu, &own, &b.frames));
  return b;
}

static void free_both(both_sides *b) {
  olx_vulkan_relight_destroy(b->frames);
  free_picture(&b->picture);
  olx_relight_free(b->cpu);
  olx_relight_free(b->gpu);
}

static void copy_light(const olx_vulkan_relight *v, uint32_t at, uint32_t part) {
  const VkDeviceSize bytes = sizeof(olx_vec3) * v->constants.surfels;
  const VkBufferCopy region = {((VkDeviceSize)OLX_RELIGHT_HEADER_WORDS + at) * 4, bytes * part, bytes};
  v->gpu->context.vk.CmdCopyBuffer(device.commands, v->buffers[OLX_BUFFER_STATE].buffer, copied.buffer, 1, &region);
}

static olx_vulkan_relight_stats device_frame(both_sides *b, olx_vec3 eye) {
  olx_vulkan_relight_stats stats;
  assert_true(gpu_commands_begin(&device));
  ASSERT_OK(olx_vulkan_record_relight(b->frames, device.commands, eye, &stats));
  gpu_full_barrier(&device, device.commands);
  copy_light(b->frames, b->frames->constants.direct, 0);
  copy_light(b->frames, b->frames->constants.irradiance, 1);
  copy_light(b->frames, b->frames->constants.highlights, 2);
  gpu_full_barrier(&device, device.commands);
  assert_true(gpu_commands_run(&device));
  return stats;
}

// Returns the relative mean squared error of the surfels' light: direct (0), indirect (1), highlights (2).
static double surfels_apart(const both_sides *b, uint32_t part) {
  const olx_vec3 *truths[SURFEL_PARTS] = {b->cpu->surfels.direct, b->cpu->surfels.irradiance,
                                          b->cpu->surfels.highlights},
                 *truth = truths[part];
  const uint32_t count = b->frames->constants.surfels;
  const olx_vec3 *light = (const olx_vec3 *)copied.mapped + (size_t)count * part;
  double off = 0.0, sum = 0.0;
  for (uint32_t i = 0; i < count; i++) {
    const olx_vec3 d = olx_sub(light[i], truth[i]);
    off += (double)olx_dot(d, d);
    sum += (double)olx_dot(truth[i], truth[i]);
  }
  return sum > 0.0 ? off / sum : off;
}

static const olx_light BULB = {
    .type = OLX_LIGHT_POINT, .emission = {1.0f, 2.0f, 0.5f}, .position = {0.2f, 0.7f, -0.3f}};
// A bulb over the screen, which surfels do not count among the lights: its light comes from points of the screen.
static const olx_light LOW_BULB = {
    .type = OLX_LIGHT_POINT, .emission = {0.2f, 0.1f, 0.3f}, .position = {0.1f, -0.28f, 0.05f}};
static const olx_light SPOT = {.type = OLX_LIGHT_SPOT,
                               .emission = {3.0f, 1.0f, 1.0f},
                               .position = {-0.5f, 0.8f, 0.4f},
                               .direction = {0.6f, -0.8f, 0.0f},
                               .cosine_inner = 0.95f,
                               .cosine_outer = 0.7f};
static const olx_light SUN = {
    .type = OLX_LIGHT_SUN, .emission = {4.0f, 4.0f, 5.0f}, .direction = {0.48f, -0.8f, 0.36f}};
static const olx_light PANEL = {.type = OLX_LIGHT_RECT,
                                .emission = {2.0f, 2.0f, 4.0f},
                                .position = {-0.3f, 0.95f, -0.3f},
                                .edge_u = {0.6f, 0.0f, 0.0f},
                                .edge_v = {0.0f, 0.0f, 0.6f}};
static const olx_light FLAG = {.type = OLX_LIGHT_TRIANGLE,
                               .emission = {5.0f, 1.0f, 1.0f},
                               .position = {0.8f, -0.5f, -0.5f},
                               .edge_u = {0.0f, 0.5f, 0.0f},
                               .edge_v = {0.0f, 0.0f, 0.5f},
                               .both_sides = true};
static const olx_light SKY = {.type = OLX_LIGHT_SKY, .emission = {0.3f, 0.4f, 0.6f}};

static void give_lights(both_sides *b, const olx_light *lights, uint32_t count) {
  ASSERT_OK(olx_relight_set_lights(b->cpu, lights, count));
  ASSERT_OK(olx_relight_set_lights(b->gpu, lights, count));
}

// Computes `frames` frames on both sides, which must do the same work, and the largest errors of surfels after a frame.
static void run_both(both_sides *b, uint32_t frames, double worst[SURFEL_PARTS]) {
  const olx_vec3 eye = olx_v3(0.1f, 0.2f, 0.3f);
  for (uint32_t part = 0; part < SURFEL_PARTS; part++) worst[part] = 0.0;
  for (uint32_t i = 0; i < frames; i++) {
    olx_relight_stats cpu;
    ASSERT_OK(olx_relight_frame(b->cpu, eye, &cpu));
    const olx_vulkan_relight_stats gpu = device_frame(b, eye);
    assert_int_equal(cpu.surfels_lit, gpu.surfels_lit);
    assert_int_equal(cpu.surfels_gathered, gpu.surfels_gathered);
    assert_true(gpu.texels <= 9 * TILE_TEXELS && gpu.volume_probes <= 50);
    for (uint32_t part = 0; part < SURFEL_PARTS; part++) worst[part] = fmax(worst[part], surfels_apart(b, part));
  }
}

// Computes frames until both sides have settled; returns the number of the device's frames.
static uint32_t run_to_rest(both_sides *b) {
  olx_relight_stats cpu = {.awake = 1};
  olx_vulkan_relight_stats gpu = {.awake = 1};
  uint32_t frames = 0;
  for (uint32_t i = 0; i < MOST_FRAMES && cpu.awake; i++) ASSERT_OK(olx_relight_frame(b->cpu, olx_splat(0.0f), &cpu));
  for (; frames < MOST_FRAMES && gpu.awake; frames++) gpu = device_frame(b, olx_splat(0.0f));
  assert_true(cpu.awake == 0 && gpu.awake == 0);
  const olx_vulkan_relight_stats none = {.awake = 0};
  gpu = device_frame(b, olx_splat(0.0f));
  assert_memory_equal(&gpu, &none, sizeof none);
  return frames;
}

static void expect_same_rest(both_sides *b, const char *what) {
  const uint32_t frames = run_to_rest(b);
  const picture_errors e = judge_picture(&b->picture, olx_relight_field(b->cpu));
  const double direct = surfels_apart(b, 0), indirect = surfels_apart(b, 1), highlights = surfels_apart(b, 2);
  print_message(
      "%s, at rest after %u frames: direct %.2g, indirect %.2g, highlights %.2g; surfaces %.2g, objects %.2g, "
      "glossy %.2g\n",
      what, frames, direct, indirect, highlights, e.surfaces, e.objects, e.glossy);
  if (direct > 1e-6 || indirect > 1e-7 || highlights > 1e-6 || e.surfaces > 1e-6 || e.objects > 1e-6 || e.glossy > 1e-5)
    fail_msg("%s", what);
}

static void expect_same(both_sides *b, uint32_t frames, const char *what) {
  double worst[SURFEL_PARTS];
  run_both(b, frames, worst);
  print_message("%s: direct %.2g, indirect %.2g, highlights %.2g\n", what, worst[0], worst[1], worst[2]);
  if (worst[0] > 1e-6 || worst[1] > 1e-7 || worst[2] > 1e-6) fail_msg("%s", what);
  expect_same_rest(b, what);
}

static void frames_are_those_of_the_cpu(void **unused) {
  (void)unused;
  host_need_device(&device);
  const uint32_t before = device.validation_messages;
  const olx_relight_settings settings = small_budget();
  both_sides b = make_both(&settings, 1);
  assert_int_equal(olx_relight_frame(b.gpu, olx_splat(0.0f), NULL), OLX_ERROR_ARGUMENT);
  assert_int_equal(device_frame(&b, olx_splat(0.0f)).awake, 0); // no lights are set yet
  ASSERT_OK(olx_relight_frame(b.cpu, olx_splat(0.0f), NULL));
  const olx_light small[] = {BULB, SPOT, SUN, LOW_BULB}, all[] = {SKY, BULB, PANEL, SPOT, FLAG};
  give_lights(&b, small, 1);
  expect_same(&b, 4, "a bulb");
  give_lights(&b, small, 4);
  assert_true(b.cpu->lights.lamps.count > 16);
  expect_same(&b, 2, "lights without an area, one close to a surface");
  give_lights(&b, all, 5);
  expect_same(&b, 5, "lights of every kind");
  give_lights(&b, NULL, 0);
  expect_same(&b, 2, "darkness");
  free_both(&b);
  assert_int_equal(device.validation_messages, before);
}

// With other settings (several frames in flight, more samples than a dispatch has rays, few rays a frame) and lights
// that change before light settles, both sides settle to the same light.
static void many_frames_in_flight_come_to_the_same_rest(void **unused) {
  (void)unused;
  host_need_device(&device);
  const uint32_t before = device.validation_messages;
  olx_relight_settings settings = small_budget();
  settings.shadow_rays = 4000;
  settings.light_samples = 6;
  both_sides b = make_both(&settings, 3);
  const olx_light first[] = {SUN}, lights[] = {BULB, PANEL};
  give_lights(&b, first, 1);
  for (uint32_t i = 0; i < 3; i++) {
    ASSERT_OK(olx_relight_frame(b.cpu, olx_splat(0.0f), NULL));
    device_frame(&b, olx_splat(0.0f));
  }
  give_lights(&b, lights, 2);
  expect_same_rest(&b, "three frames in flight");
  free_both(&b);
  assert_int_equal(device.validation_messages, before);
}

// ---- Refusals

static void what_does_not_fit_is_refused(void **unused) {
  (void)unused;
  host_need_device(&device);
  const olx_relight_settings settings = small_budget();
  const olx_vulkan_relight_settings good = olx_vulkan_relight_settings_default();
  olx_vulkan_field *uploaded;
  ASSERT_OK(olx_vulkan_field_create(&device.host, field, &uploaded));
  olx_relight *relight = begin_relight(&settings);
  olx_vulkan_relight *frames;
  olx_vulkan_sizes sizes;
#define REFUSED(of, own, message)                                                                                      \
  do {                                                                                                                 \
    frames = (void *)1;                                                                                                \
    assert_int_equal(olx_vulkan_relight_create(uploaded, of, own, &frames), OLX_ERROR_ARGUMENT);                       \
    assert_null(frames);                                                                                               \
    assert_non_null(strstr(olx_last_error(), message));                                                                \
    assert_int_equal(olx_vulkan_relight_measure(uploaded, of, own, &sizes), OLX_ERROR_ARGUMENT);                       \
  } while (0)
  REFUSED(relight, (&(olx_vulkan_relight_settings){.in_flight = 0}), "0 frames");
  REFUSED(relight, (&(olx_vulkan_relight_settings){.in_flight = 9}), "9 frames");
  ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), NULL));
  REFUSED(relight, &good, "made frames already");
  olx_relight_free(relight);
  olx_relight_settings others = settings;
  others.occlusion = olx_scene_occlusion;
  others.user = scene;
  relight = begin_relight(&others);
  REFUSED(relight, &good, "occlusion");
  olx_relight_free(relight);
  relight = begin_relight(&settings);
  const analytic_scene room = {.room = {{-1, -1, -1}, {1, 1, 1}}};
  const olx_grid grid = {{-0.5f, -0.5f, -0.5f}, {1, 1, 1}, {2, 2, 2}};
  olx_field *other = analytic_field_make(&room, &grid, 32, 16);
  olx_vulkan_field *another = uploaded;
  ASSERT_OK(olx_vulkan_field_create(&device.host, other, &uploaded));
  REFUSED(relight, &good, "number or size");
#undef REFUSED
  uploaded->context.limits.maxStorageBufferRange = 1000;
  olx_vulkan_field_destroy(uploaded);
  another->context.limits.maxStorageBufferRange = 1000;
  assert_int_equal(olx_vulkan_relight_create(another, relight, &good, &frames), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "more than a storage buffer"));
  ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), NULL)); // the relighter is unchanged
  olx_vulkan_relight_destroy(NULL);
  olx_vulkan_field_destroy(another);
  analytic_field_free(other);
  olx_relight_free(relight);
}

static void memory_that_runs_out_leaves_nothing_behind(void **unused) {
  (void)unused;
  host_need_device(&device);
  const uint32_t before = device.validation_messages;
  const olx_relight_settings settings = small_budget();
  const olx_vulkan_relight_settings own = olx_vulkan_relight_settings_default();
  olx_relight *relight = begin_relight(&settings);
  olx_vulkan_field *uploaded;
  ASSERT_OK(olx_vulkan_field_create(&device.host, field, &uploaded));
  faults_install(&device, &uploaded->context.vk);
  olx_vulkan_sizes sizes;
  ASSERT_OK(olx_vulkan_relight_measure(uploaded, relight, &own, &sizes));
  assert_true(sizes.device_bytes > 0 && sizes.allocations == OLX_RELIGHT_BUFFERS);
  olx_vulkan_relight *frames = NULL;
  int calls = 0;
  for (; !frames; calls++) {
    faults.calls_left = calls;
    const olx_result result = olx_vulkan_relight_create(uploaded, relight, &own, &frames);
    assert_int_equal(result, frames ? OLX_OK : OLX_ERROR_MEMORY);
  }
  assert_true(calls > 30);
  uint64_t bytes = 0;
  for (uint32_t i = 0; i < OLX_BUFFER_RESULTS; i++) bytes += frames->buffers[i].requirements.size;
  assert_int_equal(bytes, sizes.device_bytes);
  olx_vulkan_relight_destroy(frames);
  assert_int_equal(olx_vulkan_relight_create(uploaded, relight, &own, &frames),
                   OLX_ERROR_ARGUMENT); // the relighter has been taken over before
  olx_vulkan_field_destroy(uploaded);
  olx_relight_free(relight);
  assert_int_equal(device.validation_messages, before);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_are_those_of_the_cpu),
      cmocka_unit_test(many_frames_in_flight_come_to_the_same_rest),
      cmocka_unit_test(what_does_not_fit_is_refused),
      cmocka_unit_test(memory_that_runs_out_leaves_nothing_behind),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
