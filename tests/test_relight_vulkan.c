// Tests a field on the device that follows a relighter: after all copies it is the field that an upload of the
// relighter's maps would give, however few bytes a call may copy.
#include "relight/relighter.h"
#include "relit_room.h"
#include "scene_files.h"

#include <octalux/bake.h>
#include <octalux/vulkan.h>

static const analytic_scene ROOM = {.room = {{-1, -1, -1}, {1, 1, 1}}};
static const olx_light LAMP = {
    .type = OLX_LIGHT_POINT, .emission = {1.0f, 2.0f, 0.5f}, .position = {0.2f, 0.7f, -0.3f}};

static gpu_device device;
static scene_folder folder;
static olx_scene *scene;
static olx_field *field, *finer;

static void bake(const char *name, const olx_bake_settings *settings, olx_field **made) {
  char path[400];
  snprintf(path, sizeof path, "%s/%s", folder.path, name);
  ASSERT_OK(olx_bake(scene, settings, path, NULL, NULL));
  ASSERT_OK(olx_field_open(path, made));
}

// Makes a dark box whose field can be relit: its 64 x 64 texels are four tiles.
static int set_up(void **unused) {
  (void)unused;
  if (!host_open_device(&device, true)) return 0;
  if (!scene_folder_create(&folder)) return -1;
  scene = tiny_scene();
  const olx_material walls = tiny_lambert(0.5f, 0.0f);
  tiny_box(scene, &walls);
  tiny_finish(scene);
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.grid = settings.irradiance_grid = (olx_grid){{-0.6f, -0.6f, -0.6f}, {1.2f, 1.2f, 1.2f}, {2, 2, 2}};
  settings.radiance_size = 64;
  settings.noise = 0.1f;
  settings.volume_cells = 4;
  settings.relight = true;
  bake("box.olx", &settings, &field);
  settings.radiance_size = 128; // with as many volume probes
  bake("finer.olx", &settings, &finer);
  assert_int_equal(olx_field_describe(field).volume.probe_count, olx_field_describe(finer).volume.probe_count);
  return 0;
}

static int tear_down(void **unused) {
  (void)unused;
  if (!device.host.device) return 0;
  olx_field_close(field);
  olx_field_close(finer);
  olx_scene_free(scene);
  scene_folder_remove(&folder);
  return host_close_device(&device);
}

static olx_relight *begin_relight(void) {
  olx_relight_settings settings = olx_relight_settings_default();
  settings.occlusion = olx_scene_occlusion;
  settings.user = scene;
  settings.surfels = 500;
  settings.texels = 3 * 1024;
  settings.volume_probes = 100;
  olx_relight *relight;
  ASSERT_OK(olx_relight_create(field, &settings, &relight));
  ASSERT_OK(olx_relight_set_lights(relight, &LAMP, 1));
  return relight;
}

static olx_vulkan_field *upload(const olx_field *from) {
  olx_vulkan_field *uploaded;
  ASSERT_OK(olx_vulkan_field_create(&device.host, from, &uploaded));
  return uploaded;
}

static olx_vulkan_update_stats copy_once(olx_vulkan_update *update) {
  olx_vulkan_update_stats stats;
  assert_true(gpu_commands_begin(&device));
  ASSERT_OK(olx_vulkan_record_update(update, device.commands, &stats));
  assert_true(gpu_commands_run(&device));
  return stats;
}

// Computes frames of a relighter with a copy after each, then copies until nothing is waiting.
static void follow(olx_relight *relight, olx_vulkan_field *uploaded, uint32_t bytes) {
  enum { TILE_BYTES = 56 * 1024 }; // the largest piece that is copied at once, the volume probes

  olx_vulkan_update_settings settings = olx_vulkan_update_settings_default();
  settings.bytes = bytes;
  settings.in_flight = 1 + bytes % 3;
  olx_vulkan_update *update;
  ASSERT_OK(olx_vulkan_update_create(uploaded, relight, &settings, &update));
  olx_vulkan_update_stats stats;
  const uint32_t most = bytes > TILE_BYTES ? bytes + 15 : TILE_BYTES;
  for (uint32_t frame = 0; frame < 12; frame++) {
    ASSERT_OK(olx_relight_frame(relight, olx_splat(0.0f), NULL));
    stats = copy_once(update);
    assert_true(stats.bytes > 0 && stats.bytes <= most);
  }
  for (uint64_t waiting = stats.waiting_bytes; waiting > 0; waiting = stats.waiting_bytes) {
    stats = copy_once(update);
    assert_true(stats.bytes > 0 && stats.bytes <= most);
    if (bytes == 1) assert_true(stats.tiles <= 1); // one piece alone
    assert_int_equal(stats.bytes + stats.waiting_bytes, waiting);
  }
  assert_int_equal(copy_once(update).bytes, 0);
  olx_vulkan_update_destroy(update);
}

static void copies_end_with_the_maps_of_the_relighter(void **unused) {
  (void)unused;
  host_need_device(&device);
  const uint32_t before = device.validation_messages;
  olx_relight *relight = begin_relight();
  relit_room room = relit_room_make(&device, field);
  double errors[2];
  relit_room_render(&room);
  relit_room_judge(&room, field, errors);
  assert_true(errors[0] == 0.0 && errors[1] == 0.0); // the field is dark, as baked
  const uint32_t budgets[] = {4 << 20, 100000, 1};
  for (uint32_t i = 0; i < 3; i++) {
    olx_light lamp = LAMP;
    lamp.position.x -= 0.4f * (float)i;
    lamp.emission = olx_scale(lamp.emission, 1.0f + (float)i);
    ASSERT_OK(olx_relight_set_lights(relight, &lamp, 1));
    follow(relight, room.uploaded, budgets[i]);
    relit_room_judge(&room, olx_relight_field(relight), errors);
    assert_true(errors[0] > 0.01 && errors[1] > 0.01); // the picture is still the earlier one
    relit_room_render(&room);
    relit_room_judge(&room, olx_relight_field(relight), errors);
    if (errors[0] > 1e-5 || errors[1] > 1e-5) fail_msg("%u bytes: %g, %g", budgets[i], errors[0], errors[1]);
  }
  relit_room_free(&room);
  olx_relight_free(relight);
  assert_int_equal(device.validation_messages, before);
}

static void what_does_not_fit_is_refused(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_relight *relight = begin_relight();
  olx_vulkan_field *uploaded = upload(field);
  const olx_vulkan_update_settings good = olx_vulkan_update_settings_default();
  olx_vulkan_update *update;
#define REFUSED(change, message)                                                                                       \
  do {                                                                                                                 \
    olx_vulkan_update_settings settings = good;                                                                        \
    settings.change;                                                                                                   \
    update = (void *)1;                                                                                                \
    assert_int_equal(olx_vulkan_update_create(uploaded, relight, &settings, &update), OLX_ERROR_ARGUMENT);             \
    assert_null(update);                                                                                               \
    assert_non_null(strstr(olx_last_error(), message));                                                                \
  } while (0)
  REFUSED(bytes = 0, "0 bytes");
  REFUSED(bytes = (1u << 28) + 1, "2^28");
  REFUSED(in_flight = 0, "0 frames");
  REFUSED(in_flight = 9, "9 frames");
#undef REFUSED
  const olx_grid grid = {{-0.5f, -0.5f, -0.5f}, {1, 1, 1}, {2, 2, 2}};
  olx_field *other = analytic_field_make(&ROOM, &grid, 32, 16);
  olx_vulkan_field *another = upload(other);
  assert_int_equal(olx_vulkan_update_create(another, relight, &good, &update), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "number or size"));
  olx_vulkan_field_destroy(another);
  analytic_field_free(other);
  another = upload(finer);
  assert_int_equal(olx_vulkan_update_create(another, relight, &good, &update), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "number or size"));
  olx_vulkan_field_destroy(another);
  olx_vulkan_update_destroy(NULL);
  olx_vulkan_field_destroy(uploaded);
  olx_relight_free(relight);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(copies_end_with_the_maps_of_the_relighter),
      cmocka_unit_test(what_does_not_fit_is_refused),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
