// Tests frames against the renderer that averages camera samples: the same rays give the same light.
#include "analytic_field.h"
#include "baked_field.h"
#include "tiny_scenes.h"

enum { WIDTH = 24, HEIGHT = 18, FRAME_PIXELS = WIDTH * HEIGHT };

static const analytic_scene room = {.room = {{-1, -1, -1}, {1, 1, 1}}};
static const olx_grid grid = {.origin = {-0.4f, -0.4f, -0.4f}, .spacing = {0.8f, 0.8f, 0.8f}, .count = {2, 2, 2}};

typedef struct fixture {
  olx_scene *scene;
  olx_field *field;
  olx_camera camera, opposite;
} fixture;

static int set_up(void **state) {
  fixture *f = calloc(1, sizeof *f);
  if (!f) return 1;
  const olx_material walls = tiny_plastic(0.6f, 0.4f), plate = tiny_metal(0.7f, 0.2f);
  f->scene = tiny_scene();
  tiny_box(f->scene, &walls);
  tiny_quad(f->scene, &plate, olx_v3(0, -0.999f, 0), olx_v3(0, 0, 1), olx_v3(1, 0, 0));
  const olx_light lamp = {.type = OLX_LIGHT_POINT, .position = {0.2f, 0.5f, 0.1f}, .emission = {1, 2, 3}};
  ASSERT_OK(olx_scene_add_light(f->scene, &lamp));
  ASSERT_OK(
      olx_scene_add_rect_light(f->scene, olx_v3(0, 0.98f, 0), olx_v3(0.5f, 0, 0), olx_v3(0, 0, 0.5f), olx_splat(8)));
  tiny_finish(f->scene);
  f->field = analytic_field_make(&room, &grid, 64, 16);
  f->field->info.scene.hash = f->scene->hash;
  f->camera = tiny_camera(olx_v3(0.5f, 0.3f, 0.6f), olx_v3(-0.4f, -0.6f, -0.5f), 70);
  f->opposite = tiny_camera(olx_v3(0.5f, 0.3f, 0.6f), olx_v3(1.4f, 1.2f, 1.7f), 40);
  *state = f;
  return 0;
}

static int tear_down(void **state) {
  fixture *f = *state;
  analytic_field_free(f->field);
  olx_scene_free(f->scene);
  free(f);
  return 0;
}

static olx_render_settings frame_settings(bool traced) {
  olx_render_settings settings = olx_render_settings_default(OLX_METHOD_FIELD);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  settings.spp = 1;
  settings.diffuse = traced ? OLX_DIFFUSE_TRACED : OLX_DIFFUSE_IRRADIANCE;
  settings.diffuse_samples = settings.glossy_samples = 1;
  return settings;
}

// Renders `count` frames from one camera.
static olx_image render_frames(const fixture *f, const olx_render_settings *settings, uint32_t count,
                               olx_render_stats *stats) {
  olx_camera cameras[64];
  for (uint32_t i = 0; i < count; i++) cameras[i] = f->camera;
  olx_image image;
  ASSERT_OK(olx_render_frames(f->scene, f->field, cameras, count, settings, NULL, &image, stats));
  return image;
}

static void assert_same_layer(const olx_image *a, const olx_image *b, olx_layer layer) {
  for (size_t i = 0; i < FRAME_PIXELS; i++) {
    const olx_vec3 p = a->layers[layer][i], q = b->layers[layer][i];
    const float tolerance = 2e-5f * (1.0f + olx_max3(q));
    if (olx_length(olx_sub(p, q)) <= tolerance) continue;
    fail_msg("%s, pixel %zu: (%g %g %g), not (%g %g %g)", olx_layer_name(layer), i, (double)p.x, (double)p.y,
             (double)p.z, (double)q.x, (double)q.y, (double)q.z);
  }
}

static void assert_same_image(const olx_image *a, const olx_image *b) {
  for (uint32_t layer = 0; layer < OLX_LAYER_STANDARD_ERROR; layer++) {
    if (layer != OLX_LAYER_DEPTH) assert_same_layer(a, b, (olx_layer)layer);
  }
}

static void test_one_unfiltered_frame_is_one_camera_sample(void **state) {
  const fixture *f = *state;
  for (int traced = 0; traced < 2; traced++) {
    olx_render_settings settings = frame_settings(traced);
    settings.denoise = olx_denoise_settings_none();
    olx_image frame = render_frames(f, &settings, 1, NULL),
              still = tiny_render(f->scene, f->field, &f->camera, &settings);
    assert_true(tiny_mean(&still, OLX_LAYER_INDIRECT_GLOSSY) > 0 && tiny_mean(&still, OLX_LAYER_DIRECT) > 0);
    assert_same_image(&frame, &still);
    olx_image_free(&frame);
    olx_image_free(&still);
  }
}

static void test_a_history_of_frames_is_the_mean_of_their_rays(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(true);
  settings.denoise = olx_denoise_settings_published();
  settings.denoise.diffuse.radius_pixels = settings.denoise.glossy.radius_pixels = 0;
  settings.denoise.glossy.history = settings.denoise.glossy.still_history = 0.98f;
  settings.diffuse_samples = settings.glossy_samples = 16;
  olx_image frame = render_frames(f, &settings, 16, NULL),
            still = tiny_render(f->scene, f->field, &f->camera, &settings);
  assert_same_layer(&frame, &still, OLX_LAYER_INDIRECT_DIFFUSE);
  assert_same_layer(&frame, &still, OLX_LAYER_INDIRECT_GLOSSY);
  olx_image_free(&frame);
  olx_image_free(&still);
}

// While the camera rests, pixels trace the same rays in turn as all at once, in four times as many frames.
static void test_pixels_that_take_turns_trace_the_rays_of_all(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(true);
  settings.denoise.diffuse.radius_pixels = settings.denoise.glossy.radius_pixels = 0;
  olx_render_stats all, turns;
  olx_image at_once = render_frames(f, &settings, 5, &all);
  settings.denoise.ray_spacing = 2;
  olx_image in_turn = render_frames(f, &settings, 20, &turns);
  assert_true(all.field_rays > 0);
  assert_int_equal(turns.field_rays, all.field_rays);
  assert_same_layer(&in_turn, &at_once, OLX_LAYER_INDIRECT_DIFFUSE);
  assert_same_layer(&in_turn, &at_once, OLX_LAYER_INDIRECT_GLOSSY);
  olx_image_free(&at_once);
  olx_image_free(&in_turn);
}

// Returns the mean squared difference of two layers relative to the second's mean square.
static double relative_error(const olx_image *a, const olx_image *b, olx_layer layer) {
  olx_metrics metrics;
  ASSERT_OK(olx_compare(a, b, layer, &metrics));
  return metrics.relative_mse;
}

static void test_denoising_brings_a_frame_near_the_truth(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(true);
  olx_render_settings many = settings;
  many.diffuse_samples = many.glossy_samples = 1024;
  olx_image truth = tiny_render(f->scene, f->field, &f->camera, &many);
  const olx_denoise_settings filters[] = {olx_denoise_settings_none(), olx_denoise_settings_default()};
  double error[2];
  for (int i = 0; i < 2; i++) {
    settings.denoise = filters[i];
    olx_image image = render_frames(f, &settings, 16, NULL);
    error[i] = relative_error(&image, &truth, OLX_LAYER_INDIRECT_DIFFUSE);
    olx_image_free(&image);
  }
  print_message("relative MSE of diffuse light: %.2g a frame, %.2g after 16, denoised\n", error[0], error[1]);
  assert_true(error[1] < error[0] / 20);
  olx_image_free(&truth);
}

static void test_after_a_cut_nothing_is_remembered(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(true);
  settings.denoise.diffuse.radius_pixels = settings.denoise.glossy.radius_pixels = 0;
  const olx_camera cameras[4] = {f->camera, f->camera, f->camera, f->opposite};
  olx_image image[2];
  for (int i = 0; i < 2; i++) {
    if (i) settings.denoise = olx_denoise_settings_none();
    ASSERT_OK(olx_render_frames(f->scene, f->field, cameras, 4, &settings, NULL, &image[i], NULL));
  }
  for (uint32_t layer = 0; layer < OLX_LAYER_STANDARD_ERROR; layer++) {
    assert_memory_equal(image[0].layers[layer], image[1].layers[layer], FRAME_PIXELS * sizeof(olx_vec3));
  }
  olx_image_free(&image[0]);
  olx_image_free(&image[1]);
}

static void test_a_moving_camera_keeps_its_history(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(true), many = settings;
  settings.denoise.diffuse.radius_pixels = settings.denoise.glossy.radius_pixels = 0;
  many.diffuse_samples = 1024;
  olx_image truth = tiny_render(f->scene, f->field, &f->camera, &many);
  olx_camera cameras[32];
  double error[2];
  for (int moving = 0; moving < 2; moving++) {
    for (int i = 0; i < 32; i++) {
      cameras[i] = f->camera;
      if (moving) cameras[i].eye.x += 0.004f * (float)(31 - i);
    }
    olx_image image;
    ASSERT_OK(olx_render_frames(f->scene, f->field, cameras, 32, &settings, NULL, &image, NULL));
    error[moving] = relative_error(&image, &truth, OLX_LAYER_INDIRECT_DIFFUSE);
    olx_image_free(&image);
  }
  // Reprojection averages neighbours, which lowers noise and blurs a little; without it the error would be that of one
  // ray.
  print_message("relative MSE without a filter over pixels: %.2g still, %.2g moving\n", error[0], error[1]);
  assert_true(error[1] < 2 * error[0]);
  olx_image_free(&truth);
}

static void test_any_number_of_threads_gives_the_same_bytes(void **state) {
  const fixture *f = *state;
  olx_image image[2];
  for (uint32_t i = 0; i < 2; i++) {
    olx_render_settings settings = frame_settings(true);
    settings.threads = i ? 5 : 1;
    image[i] = render_frames(f, &settings, 5, NULL);
  }
  for (uint32_t layer = 0; layer < OLX_LAYER_STANDARD_ERROR; layer++) {
    assert_memory_equal(image[0].layers[layer], image[1].layers[layer], FRAME_PIXELS * sizeof(olx_vec3));
  }
  olx_image_free(&image[0]);
  olx_image_free(&image[1]);
}

static void test_rays_are_one_a_lobe_and_pixel(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(true);
  olx_render_stats stats;
  olx_image image = render_frames(f, &settings, 3, &stats);
  assert_true(stats.field_rays > 3 * FRAME_PIXELS && stats.field_rays <= 3 * 2 * FRAME_PIXELS);
  olx_image_free(&image);
  settings.diffuse = OLX_DIFFUSE_IRRADIANCE;
  image = render_frames(f, &settings, 3, &stats);
  assert_true(stats.field_rays > 0 && stats.field_rays <= 3 * FRAME_PIXELS);
  assert_true(stats.denoise_seconds > 0 && stats.seconds > 0);
  olx_image_free(&image);
}

static void test_dim_lobes_take_irradiance_in_place_of_rays(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(false);
  settings.dim_lobe = 1.0f; // every lobe counts as dim
  olx_render_stats stats;
  olx_image frame = render_frames(f, &settings, 2, &stats),
            still = tiny_render(f->scene, f->field, &f->camera, &settings);
  assert_int_equal(stats.field_rays, 0);
  assert_same_layer(&frame, &still, OLX_LAYER_INDIRECT_GLOSSY);
  assert_same_layer(&frame, &still, OLX_LAYER_BEAUTY);
  for (size_t i = 0; i < FRAME_PIXELS; i++) assert_true(frame.layers[OLX_LAYER_INDIRECT_GLOSSY][i].x > 0);
  olx_image_free(&frame);
  olx_image_free(&still);
  // The limit of dim lobes is between the plastic's 4 % (more at grazing angles) and the metal's 70 %.
  settings.dim_lobe = 0.5f;
  frame = render_frames(f, &settings, 1, &stats);
  assert_true(stats.field_rays > 0 && stats.field_rays < FRAME_PIXELS / 2);
  olx_image_free(&frame);
  // Irradiance leaves out emitters, so that no lobe is dim where rays find them.
  settings.sample.emitters = true;
  frame = render_frames(f, &settings, 1, NULL);
  settings.dim_lobe = 0.0f;
  still = render_frames(f, &settings, 1, NULL);
  assert_same_layer(&frame, &still, OLX_LAYER_INDIRECT_GLOSSY);
  assert_same_layer(&frame, &still, OLX_LAYER_BEAUTY);
  olx_image_free(&frame);
  olx_image_free(&still);
}

static void test_traced_emitters_replace_their_direct_light(void **state) {
  const fixture *f = *state;
  olx_render_settings settings = frame_settings(true);
  olx_image sampled = render_frames(f, &settings, 2, NULL);
  settings.sample.emitters = true;
  uint16_t *distance = (uint16_t *)(uintptr_t)f->field->distance;
  for (size_t i = 0; i < f->field->info.probes.count * f->field->texels; i++) distance[i] |= 0x8000u;
  uint32_t *emission = (uint32_t *)(uintptr_t)f->field->surfaces.emission; // the one tile of an analytic field, for all
  const size_t tiles = (size_t)f->field->surfaces.tile_side * f->field->surfaces.tile_side;
  for (size_t i = 0; i < f->field->info.probes.count * tiles; i++) emission[i] = 1;
  olx_image traced = render_frames(f, &settings, 2, NULL);
  assert_true(tiny_mean(&traced, OLX_LAYER_INDIRECT_DIFFUSE) > 0.1);
  assert_true(tiny_mean(&traced, OLX_LAYER_DIRECT) < 0.8 * tiny_mean(&sampled, OLX_LAYER_DIRECT));
  settings.sample.emitters = false;
  olx_image neither = render_frames(f, &settings, 2, NULL);
  // Emitters keep their reflected light.
  const double reflected = tiny_mean(&sampled, OLX_LAYER_INDIRECT_DIFFUSE);
  assert_true(reflected > 0.01 && tiny_mean(&neither, OLX_LAYER_INDIRECT_DIFFUSE) == reflected);
  assert_true(tiny_mean(&traced, OLX_LAYER_INDIRECT_DIFFUSE) > reflected + 0.1);
  olx_image_free(&sampled);
  olx_image_free(&traced);
  olx_image_free(&neither);
}

static olx_field *bake(const olx_scene *scene) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  ASSERT_OK(olx_scene_probe_grid(scene, (const uint32_t[3]){2, 2, 4}, &settings.grid));
  settings.radiance_size = 64;
  settings.noise = 0.1f;
  settings.bounces = 0;
  return baked_field(scene, &settings, NULL);
}

static void test_emitters_seen_from_behind_are_dark(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material walls = tiny_plastic(0.5f, 0.5f);
  tiny_box(scene, &walls);
  // The light shines into the room; behind it, where there is no probe, is a wall 40 cm away.
  ASSERT_OK(olx_scene_add_rect_light(scene, olx_v3(0, 0, -0.6f), olx_v3(1, 0, 0), olx_v3(0, 1, 0), olx_splat(9)));
  tiny_finish(scene);
  olx_field *field = bake(scene);
  const olx_camera camera = tiny_camera(olx_v3(0.9f, 0, -0.75f), olx_v3(0.2f, 0, -1), 50);
  olx_render_settings settings = frame_settings(true);
  settings.diffuse_samples = settings.glossy_samples = 64;
  olx_image sampled = tiny_render(scene, field, &camera, &settings);
  settings.sample.emitters = true;
  olx_image traced = tiny_render(scene, field, &camera, &settings);
  const double truth = tiny_mean(&sampled, OLX_LAYER_BEAUTY), found = tiny_mean(&traced, OLX_LAYER_BEAUTY);
  print_message("behind the lamp: %.3g with sampled, %.3g with traced emitters\n", truth, found);
  assert_true(truth > 0 && found < 1.2 * truth);
  olx_image_free(&sampled);
  olx_image_free(&traced);
  olx_field_close(field);
  olx_scene_free(scene);
}

static void test_pixels_without_surfaces_show_the_sky(void **state) {
  (void)state;
  olx_scene *scene = tiny_scene();
  const olx_material floor = tiny_plastic(0.5f, 0.3f);
  tiny_floor(scene, &floor);
  scene->environment.radiance = olx_splat(3);
  tiny_finish(scene);
  olx_field *field = analytic_field_make(&room, &grid, 64, 16);
  field->info.scene.hash = scene->hash;
  const olx_render_settings settings = frame_settings(true);
  const olx_camera camera = tiny_camera(olx_v3(0, 0.5f, 0.5f), olx_v3(0, 0.3f, -2), 70);
  const olx_camera cameras[2] = {camera, camera};
  olx_image image;
  ASSERT_OK(olx_render_frames(scene, field, cameras, 2, &settings, NULL, &image, NULL));
  uint32_t sky = 0;
  for (size_t i = 0; i < FRAME_PIXELS; i++) {
    const bool seen = isfinite(image.layers[OLX_LAYER_DEPTH][i].x);
    sky += !seen;
    assert_true(olx_finite(image.layers[OLX_LAYER_BEAUTY][i]));
    if (!seen) assert_true(image.layers[OLX_LAYER_BEAUTY][i].x == 3.0f);
    if (!seen) assert_true(olx_max3(image.layers[OLX_LAYER_INDIRECT_DIFFUSE][i]) == 0.0f);
  }
  assert_true(sky > 50 && sky < FRAME_PIXELS - 50);
  olx_image_free(&image);
  analytic_field_free(field);
  olx_scene_free(scene);
}

#define EXPECT_REFUSED(change)                                                                                         \
  do {                                                                                                                 \
    olx_render_settings settings = frame_settings(true);                                                               \
    uint32_t count = 1;                                                                                                \
    change;                                                                                                            \
    olx_image image;                                                                                                   \
    assert_int_equal(olx_render_frames(f->scene, f->field, &f->camera, count, &settings, NULL, &image, NULL),          \
                     OLX_ERROR_ARGUMENT);                                                                              \
    assert_null(image.layers[0]);                                                                                      \
    assert_true(olx_last_error()[0] != 0);                                                                             \
  } while (0)

static void test_settings_out_of_range_are_refused(void **state) {
  const fixture *f = *state;
  EXPECT_REFUSED(count = 0);
  EXPECT_REFUSED(settings.method = OLX_METHOD_PATH);
  EXPECT_REFUSED(settings.denoise.diffuse.radius_pixels = 65);
  EXPECT_REFUSED(settings.denoise.glossy.stride_pixels = 0);
  EXPECT_REFUSED(settings.denoise.diffuse.history = 1.0f);
  EXPECT_REFUSED(settings.denoise.glossy.still_history = NAN);
  EXPECT_REFUSED(settings.denoise.glossy.reach = -1.0f);
  EXPECT_REFUSED(settings.dim_lobe = 1.5f);
  EXPECT_REFUSED(settings.width = 0);
}

static bool cancel(void *user, const char *stage, float done) {
  (void)user;
  (void)stage;
  (void)done;
  return false;
}

static void test_a_cancelled_run_leaves_nothing(void **state) {
  const fixture *f = *state;
  const olx_render_settings settings = frame_settings(true);
  const olx_progress progress = {.report = cancel};
  olx_camera cameras[64];
  for (int i = 0; i < 64; i++) cameras[i] = f->camera;
  olx_image image;
  const olx_result result = olx_render_frames(f->scene, f->field, cameras, 64, &settings, &progress, &image, NULL);
  if (result == OLX_OK) olx_image_free(&image); // the frames were done before the first report
  else assert_true(result == OLX_ERROR_CANCELLED && !image.layers[0]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_one_unfiltered_frame_is_one_camera_sample, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_a_history_of_frames_is_the_mean_of_their_rays, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_pixels_that_take_turns_trace_the_rays_of_all, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_denoising_brings_a_frame_near_the_truth, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_after_a_cut_nothing_is_remembered, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_a_moving_camera_keeps_its_history, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_any_number_of_threads_gives_the_same_bytes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_rays_are_one_a_lobe_and_pixel, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_dim_lobes_take_irradiance_in_place_of_rays, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_traced_emitters_replace_their_direct_light, set_up, tear_down),
      cmocka_unit_test(test_emitters_seen_from_behind_are_dark),
      cmocka_unit_test(test_pixels_without_surfaces_show_the_sky),
      cmocka_unit_test_setup_teardown(test_settings_out_of_range_are_refused, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_a_cancelled_run_leaves_nothing, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
