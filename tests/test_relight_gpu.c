// Frames of a relighter on a device: lights that move, and the maps of each frame are those of olx_relight_frame; and
// what happens when something does not fit or is missing.
#include "relit_room.h"
#include "scene_files.h"
#include "vulkan/gpu_relight.h"
#include "vulkan_faults.h"

#include <octalux/bake.h>

static gpu_device device;
static scene_folder folder;
static olx_scene *scene;
static olx_field *field;
static gpu_buffer copied; // of the device's working maps

static olx_field *bake(const char *name, bool fit) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = (olx_grid){{-0.6f, -0.6f, -0.6f}, {1.2f, 1.2f, 1.2f}, {2, 2, 2}};
  settings.irradiance_grid = (olx_grid){{-0.6f, -0.6f, -0.6f}, {1.2f, 1.2f, 1.2f}, {2, 2, 2}};
  settings.radiance_size = 64;
  settings.irradiance_size = 32;
  settings.bounces = 2;
  settings.fit = fit;
  settings.relight = true;
  char path[400];
  snprintf(path, sizeof path, "%s/%s", folder.path, name);
  ASSERT_OK(olx_bake(scene, &settings, path, NULL, NULL));
  olx_field *baked;
  ASSERT_OK(olx_field_open(path, &baked));
  return baked;
}

// A box with a screen in it that casts shadows, of colours, a small lamp, and a panel behind which no probe looks.
static int set_up(void **unused) {
  (void)unused;
  if (!host_open_device(&device, true)) return 0;
  if (!scene_folder_create(&folder)) return -1;
  scene = tiny_scene();
  olx_material walls = tiny_lambert(0.6f, 0.0f), screen = tiny_lambert(0.3f, 0.0f), lamp = tiny_lambert(0.0f, 2.0f);
  walls.base_color = olx_v3(0.7f, 0.5f, 0.4f);
  tiny_box(scene, &walls);
  tiny_quad(scene, &screen, olx_v3(0.1f, -0.35f, 0.05f), olx_v3(0, 0, 0.7f), olx_v3(0.6f, 0.1f, 0));
  tiny_quad(scene, &screen, olx_v3(0.85f, 0.0f, 0.0f), olx_v3(0, 0, 1.0f), olx_v3(0, 1.0f, 0));
  tiny_quad(scene, &screen, olx_v3(0.87f, 0.0f, 0.0f), olx_v3(0, 1.0f, 0), olx_v3(0, 0, 1.0f));
  tiny_quad(scene, &lamp, olx_v3(0, 0.99f, 0), olx_v3(0.4f, 0, 0), olx_v3(0, 0, 0.4f));
  tiny_finish(scene);
  field = bake("box.olx", true);
  const VkDeviceSize bytes = sizeof(olx_vec3) * 34 * 34 * field->info.irradiance_probe_count;
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  return gpu_buffer_create(&device, "copied maps", bytes, usage, true, &copied) ? 0 : -1;
}

static int tear_down(void **unused) {
  (void)unused;
  if (!device.host.device) return 0;
  gpu_buffer_destroy(&device, &copied);
  olx_field_close(field);
  olx_scene_free(scene);
  scene_folder_remove(&folder);
  return host_close_device(&device);
}

static olx_relight_settings small_budget(void) {
  olx_relight_settings settings = olx_relight_settings_default();
  settings.surface_texels = 3 * 32 * 32;
  settings.radiance_texels = 5 * 1024;
  return settings;
}

static olx_relight *begin_relight(const olx_field *from, const olx_relight_settings *settings) {
  olx_relight *relight;
  ASSERT_OK(olx_relight_create(from, settings, &relight));
  return relight;
}

// ---- Frames on both sides

typedef struct both_sides {
  olx_relight *cpu, *gpu; // gpu: whose frames the device makes
  relit_room room;
  olx_vulkan_relight *frames;
} both_sides;

static both_sides make_both(const olx_field *from, const olx_relight_settings *settings, uint32_t in_flight) {
  both_sides b = {.cpu = begin_relight(from, settings), .gpu = begin_relight(from, settings)};
  b.room = relit_room_make(&device, from);
  const olx_vulkan_relight_settings own = {.in_flight = in_flight};
  ASSERT_OK(olx_vulkan_relight_create(b.room.uploaded, b.gpu, &own, &b.frames));
  return b;
}

static void free_both(both_sides *b) {
  olx_vulkan_relight_destroy(b->frames);
  relit_room_free(&b->room);
  olx_relight_free(b->cpu);
  olx_relight_free(b->gpu);
}

static olx_vulkan_relight_stats device_frame(both_sides *b, olx_vec3 eye) {
  olx_vulkan_relight *v = b->frames;
  const VkDeviceSize bytes = sizeof(olx_vec3) * b->gpu->map_texels * b->gpu->counts[0];
  const VkBufferCopy region = {((VkDeviceSize)OLX_RELIGHT_HEADER_WORDS + v->constants.maps) * 4, 0, bytes};
  olx_vulkan_relight_stats stats;
  assert_true(gpu_commands_begin(&device));
  ASSERT_OK(olx_vulkan_record_relight(v, device.commands, eye, &stats));
  gpu_full_barrier(&device, device.commands);
  v->gpu->context.vk.CmdCopyBuffer(device.commands, v->buffers[OLX_BUFFER_STATE].buffer, copied.buffer, 1, &region);
  gpu_full_barrier(&device, device.commands);
  assert_true(gpu_commands_run(&device));
  return stats;
}

// Relative mean squared error of all working maps.
static double maps_apart(const both_sides *b) {
  const olx_relight *r = b->cpu;
  const olx_vec3 *maps = copied.mapped;
  double off = 0.0, sum = 0.0;
  for (size_t i = 0; i < r->map_texels * r->counts[0]; i++) {
    const olx_vec3 d = olx_sub(maps[i], r->maps[i]);
    off += (double)olx_dot(d, d);
    sum += (double)olx_dot(r->maps[i], r->maps[i]);
  }
  return sum > 0.0 ? off / sum : off;
}

static const olx_relight_light BULB = {
    .type = OLX_RELIGHT_POINT, .emission = {1.0f, 2.0f, 0.5f}, .position = {0.2f, 0.7f, -0.3f}};
static const olx_relight_light SPOT = {.type = OLX_RELIGHT_SPOT,
                                       .emission = {3.0f, 1.0f, 1.0f},
                                       .position = {-0.5f, 0.8f, 0.4f},
                                       .direction = {0.6f, -0.8f, 0.0f},
                                       .cosine_inner = 0.95f,
                                       .cosine_outer = 0.7f};
static const olx_relight_light SUN = {
    .type = OLX_RELIGHT_SUN, .emission = {4.0f, 4.0f, 5.0f}, .direction = {0.48f, -0.8f, 0.36f}};
static const olx_relight_light PANEL = {.type = OLX_RELIGHT_RECT,
                                        .emission = {2.0f, 2.0f, 4.0f},
                                        .position = {-0.3f, 0.95f, -0.3f},
                                        .edge_u = {0.6f, 0.0f, 0.0f},
                                        .edge_v = {0.0f, 0.0f, 0.6f}};
static const olx_relight_light FLAG = {.type = OLX_RELIGHT_TRIANGLE,
                                       .emission = {5.0f, 1.0f, 1.0f},
                                       .position = {0.8f, -0.5f, -0.5f},
                                       .edge_u = {0.0f, 0.5f, 0.0f},
                                       .edge_v = {0.0f, 0.0f, 0.5f},
                                       .both_sides = true};
static const olx_relight_light SKY = {.type = OLX_RELIGHT_SKY, .emission = {0.3f, 0.4f, 0.6f}};

static void give_lights(both_sides *b, const olx_relight_light *lights, uint32_t count) {
  ASSERT_OK(olx_relight_set_lights(b->cpu, lights, count));
  ASSERT_OK(olx_relight_set_lights(b->gpu, lights, count));
}

// So many frames on both sides; the worst error of a frame's maps, and the time of all frames.
static double run_both(both_sides *b, uint32_t frames, olx_vec3 eye, double seconds[2]) {
  double worst = 0.0;
  seconds[0] = seconds[1] = 0.0;
  for (uint32_t i = 0; i < frames; i++) {
    olx_relight_stats cpu;
    ASSERT_OK(olx_relight_frame(b->cpu, eye, &cpu));
    const double start = olx_seconds();
    const olx_vulkan_relight_stats gpu = device_frame(b, eye);
    seconds[0] += cpu.seconds;
    seconds[1] += olx_seconds() - start;
    assert_int_equal(cpu.irradiance_probes, gpu.irradiance_probes);
    assert_int_equal(cpu.radiance_texels, gpu.radiance_texels);
    assert_true(gpu.surface_texels <= 3 * 32 * 32 && gpu.radiance_tiles <= 5);
    const double apart = maps_apart(b);
    worst = apart > worst ? apart : worst;
  }
  return worst;
}

// Maps that others' light has changed are packed a frame later than on the CPU: they lie apart by what a frame changes.
static void expect_same(both_sides *b, uint32_t frames, const char *what) {
  double errors[2], seconds[2];
  const double maps = run_both(b, frames, olx_v3(0.1f, 0.2f, 0.3f), seconds);
  relit_room_render(&b->room);
  relit_room_judge(&b->room, olx_relight_field(b->cpu), errors);
  print_message("%s: maps %.2g, irradiance %.2g, glossy light %.2g; %.3f s on the CPU, %.3f s on %s\n", what, maps,
                errors[0], errors[1], seconds[0], seconds[1], device.properties.deviceName);
  if (maps > 1e-9 || errors[0] > 1e-4 || errors[1] > 1e-5) fail_msg("%s", what);
}

// Rays of the fit's points that meet what no irradiance probe sees.
static uint32_t hidden_rays(const olx_relight_maps *maps, uint32_t probes) {
  const size_t words = olx_fit_words(maps);
  uint32_t count = 0;
  for (size_t i = 0; i < words * maps->points * probes; i++) {
    count += i % words >= 4 && maps->fit[i] >= maps->size * maps->size * probes && maps->fit[i] < OLX_FIT_RAY_UNKNOWN;
  }
  return count;
}

// To the device, as to the CPU without an occlusion function, they are unknown.
static void frames_are_those_of_the_cpu(void **unused) {
  (void)unused;
  host_need_device(&device);
  assert_true(hidden_rays(&field->relight, 8) > 500);
  const uint32_t before = device.validation_messages;
  olx_relight_settings settings = small_budget();
  settings.history = 0.2f;
  both_sides b = make_both(field, &settings, 1);
  assert_int_equal(olx_relight_frame(b.gpu, olx_splat(0.0f), NULL), OLX_ERROR_ARGUMENT);
  assert_int_equal(device_frame(&b, olx_splat(0.0f)).irradiance_probes, 0); // nothing is awake yet
  ASSERT_OK(olx_relight_frame(b.cpu, olx_splat(0.0f), NULL));
  const olx_relight_light small[] = {BULB, SPOT, SUN}, all[] = {SKY, BULB, PANEL, SPOT, FLAG};
  give_lights(&b, small, 1);
  expect_same(&b, 4, "a bulb");
  give_lights(&b, small, 3);
  expect_same(&b, 2, "lights without an area");
  give_lights(&b, all, 5);
  expect_same(&b, 5, "lights of every kind");
  give_lights(&b, NULL, 0);
  expect_same(&b, 2, "darkness");
  free_both(&b);
  assert_int_equal(device.validation_messages, before);
}

// Until on either side there is nothing more to do.
static void run_to_rest(both_sides *b) {
  olx_relight_stats cpu = {.awake = 1};
  olx_vulkan_relight_stats gpu = {.awake = 1};
  for (uint32_t i = 0; i < 100 && cpu.awake; i++) ASSERT_OK(olx_relight_frame(b->cpu, olx_splat(0.0f), &cpu));
  for (uint32_t i = 0; i < 100 && gpu.awake + gpu.under_way; i++) gpu = device_frame(b, olx_splat(0.0f));
  assert_true(cpu.awake == 0 && gpu.awake == 0 && gpu.under_way == 0);
}

// Other settings: several frames in flight, more samples than a dispatch has rays, no fit, radiance left alone.
static void many_frames_in_flight_come_to_the_same_rest(void **unused) {
  (void)unused;
  host_need_device(&device);
  const uint32_t before = device.validation_messages;
  olx_field *unfitted = bake("unfitted.olx", false);
  olx_relight_settings settings = small_budget();
  settings.surface_texels = 8 * 32 * 32;
  settings.radiance_texels = 0;
  settings.light_samples = 6;
  both_sides b = make_both(unfitted, &settings, 3);
  const olx_relight_light lights[] = {BULB, PANEL};
  give_lights(&b, lights, 2);
  run_to_rest(&b);
  const double maps = maps_apart(&b);
  print_message("three frames in flight: maps %.3g\n", maps);
  if (maps > 1e-4) fail_msg("%g", maps);
  free_both(&b);
  olx_field_close(unfitted);
  assert_int_equal(device.validation_messages, before);
}

// ---- What cannot be

static void what_does_not_fit_is_refused(void **unused) {
  (void)unused;
  host_need_device(&device);
  const olx_relight_settings settings = small_budget();
  const olx_vulkan_relight_settings good = olx_vulkan_relight_settings_default();
  olx_vulkan_field *uploaded;
  ASSERT_OK(olx_vulkan_field_create(&device.host, field, &uploaded));
  olx_relight *relight = begin_relight(field, &settings);
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
  relight = begin_relight(field, &others);
  REFUSED(relight, &good, "occlusion");
  olx_relight_free(relight);
  relight = begin_relight(field, &settings);
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
  ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), NULL)); // it is as it was
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
  olx_relight *relight = begin_relight(field, &settings);
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
                   OLX_ERROR_ARGUMENT); // taken over before
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
