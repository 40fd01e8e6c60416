// Tests the denoiser's passes on any Vulkan device, under the validation layers: they write what the CPU's denoiser
// makes of the same rays, for any views, and fail with messages when something is missing.
#include "core/bsdf.h"
#include "core/sampling.h"
#include "render/denoise.h"
#include "shade/emission.h"
#include "shade/glossy.h"
#include "vulkan/vulkan_frame.h"
#include "vulkan_faults.h"
#include "vulkan_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum {
  WIDTH = 52,
  HEIGHT = 36,
  BOTH = OLX_VULKAN_LOBE_DIFFUSE | OLX_VULKAN_LOBE_GLOSSY,
  PASSES = OLX_VULKAN_PASS_DIFFUSE | OLX_VULKAN_PASS_GLOSSY
};

static gpu_device device;

static host_images make_images(uint32_t width, uint32_t height, uint32_t lobes) {
  host_images host = host_images_make(&device, width, height, VK_FORMAT_R32G32B32A32_SFLOAT);
  host.targets.denoise = lobes;
  host.targets.passes = PASSES;
  host.targets.geometric_normal = host_input(&host, HOST_GEOMETRIC_NORMAL);
  return host;
}

// Makes a fixture whose pipelines are empty, so that its frame cannot run.
static host_fixture make_fixture(uint32_t width, uint32_t height, uint32_t lobes) {
  host_fixture f = host_fixture_make(&device, 64, 16);
  faults_install(&device, &f.uploaded->context.vk);
  f.images = make_images(width, height, lobes);
  host_fixture_add_frame(&f);
  return f;
}

// A fixture whose shaders are compiled once, since compiling takes long. Tests resize its frame.
static host_fixture running;

static int set_up(void **unused) {
  (void)unused;
  if (!host_open_device(&device, true)) return 0;
  running = host_fixture_make(&device, 64, 16);
  running.images = make_images(WIDTH, HEIGHT, BOTH);
  host_fixture_add_frame(&running);
  return 0;
}

static int tear_down(void **unused) {
  (void)unused;
  if (!device.host.device) return 0;
  host_fixture_free(&running);
  return host_close_device(&device);
}

// Gives the running fixture images of another size, and no history.
static host_fixture *resize_running(uint32_t width, uint32_t height, uint32_t lobes) {
  host_need_device(&device);
  host_images host = make_images(width, height, lobes);
  if (olx_vulkan_frame_resize(running.frame, &host.targets) != OLX_OK) fail_msg("%s", olx_last_error());
  host_images_free(&running.images);
  running.images = host;
  return &running;
}

static void assert_silent(const host_fixture *f) { assert_int_equal(device.validation_messages, f->messages); }

static host_view view_of_frame(const host_fixture *f, uint32_t frame, olx_vec2 shift) {
  const float t = (float)frame;
  return (host_view){.scene = &HOST_ROOM,
                     .eye = {3.1f + 0.02f * t, 1.6f, 4.2f - 0.03f * t},
                     .width = f->images.width,
                     .height = f->images.height,
                     .shift = shift};
}

static olx_vulkan_settings settings_of(const olx_denoise_settings *filters, uint32_t lobes) {
  olx_vulkan_settings settings = olx_vulkan_settings_default();
  settings.denoise.lobes = lobes;
  settings.denoise.filters = *filters;
  return settings;
}

static void record_frame(const host_fixture *f, const olx_vulkan_view *view, olx_vulkan_settings *settings,
                         uint32_t frame) {
  settings->sample_index = settings->denoise.frame = frame;
  assert_int_equal(olx_vulkan_record_diffuse(f->frame, device.commands, view, settings), OLX_OK);
  assert_int_equal(olx_vulkan_record_glossy(f->frame, device.commands, view, settings), OLX_OK);
  if (olx_vulkan_record_denoise(f->frame, device.commands, view, settings) != OLX_OK) fail_msg("%s", olx_last_error());
  settings->denoise.previous = *view;
}

static void run_frame(host_fixture *f, const host_view *view, olx_vulkan_settings *settings, uint32_t frame) {
  const olx_vulkan_view vulkan_view = host_vulkan_view(view);
  assert_true(gpu_commands_begin(&device));
  host_upload(&f->images, view);
  record_frame(f, &vulkan_view, settings, frame);
  host_download(&f->images);
  assert_true(gpu_commands_run(&device));
}

// ---- the CPU's denoiser

// Sizes of the denoiser's buffers. Pictures have a margin, so that a shifted picture is a part of one that is not
// shifted.
enum {
  MARGIN = 4,
  FULL_WIDTH = WIDTH + 2 * MARGIN,
  FULL_HEIGHT = HEIGHT + 2 * MARGIN,
  FULL = FULL_WIDTH * FULL_HEIGHT
};

typedef struct cpu_frame {
  float depth[FULL], roughness[FULL];
  olx_vec3 normal[FULL];
  olx_incident samples[2][FULL];
  olx_guide guide;
} cpu_frame;

typedef struct cpu_denoiser {
  cpu_frame frames[2];
  olx_history history[2][2]; // histories of the diffuse and of the glossy lobe
  olx_vec3 light[2][FULL];
} cpu_denoiser;

static uint32_t place(const host_view *v, uint32_t x, uint32_t y) {
  return x + MARGIN + (uint32_t)(int)v->shift.x + FULL_WIDTH * (y + MARGIN + (uint32_t)(int)v->shift.y);
}

static olx_bsdf bsdf_of(const host_pixel *p) {
  const float metallic = floorf(p->metallic * 255.0f + 0.5f) / 255.0f;
  const float weight = floorf(p->weight * 255.0f + 0.5f) / 255.0f;
  const olx_vec3 color =
      olx_v3(floorf(p->color.x * 255.0f + 0.5f) / 255.0f, floorf(p->color.y * 255.0f + 0.5f) / 255.0f,
             floorf(p->color.z * 255.0f + 0.5f) / 255.0f);
  return olx_bsdf_make(color, metallic, p->roughness, weight);
}

static olx_vec3 glossy_factor(const host_pixel *p) {
  const olx_bsdf bsdf = bsdf_of(p);
  return olx_max_each(olx_fresnel(&bsdf, olx_dot(p->view, p->normal)), olx_splat(0.01f));
}

// Returns whether a direction leads behind the surface: such rays are not traced, and find no light.
static bool leads_inside(const host_pixel *p, olx_vec3 direction) {
  return olx_dot(direction, p->geometric_normal) <= 0.0f;
}

// Returns the light and distance of the device's rays where they end. A surface that reflects no diffuse light towards
// the eye has no diffuse ray.
static olx_incident sample_diffuse(const olx_field *field, const host_pixel *p, olx_vec2 random) {
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_vec3 direction = olx_from_basis(olx_sample_cosine(random), p->normal);
  const olx_bsdf bsdf = bsdf_of(p);
  if (!(olx_max3(olx_bsdf_diffuse(&bsdf, olx_dot(p->view, p->normal))) > 0.0f)) {
    return (olx_incident){.inverse_distance = -1.0f};
  }
  if (leads_inside(p, direction)) return (olx_incident){.inverse_distance = 0.0f};
  const olx_trace_hit hit = olx_trace(field, &settings, p->position, direction, INFINITY);
  return (olx_incident){hit.emitter ? olx_splat(0.0f) : olx_scale(hit.radiance, OLX_PI), olx_nearness(&hit)};
}

static olx_incident sample_glossy(const olx_field *field, const host_pixel *p, olx_vec2 random) {
  const olx_sample_settings settings = olx_sample_settings_default();
  const olx_bsdf bsdf = bsdf_of(p);
  float weight, half_cosine;
  olx_trace_hit hit;
  olx_vec3 direction;
  if (!olx_glossy_draw(p->normal, p->view, p->roughness, random, &direction, &weight, &half_cosine) ||
      leads_inside(p, direction)) {
    return (olx_incident){.inverse_distance = 0.0f};
  }
  const olx_vec3 radiance =
      olx_glossy(field, &settings, p->position, p->normal, p->view, p->roughness, random, &weight, &half_cosine, &hit);
  if (weight <= 0.0f) return (olx_incident){.inverse_distance = 0.0f};
  const olx_vec3 light = olx_scale(olx_mul(olx_fresnel(&bsdf, half_cosine), radiance), weight), f = glossy_factor(p);
  return (olx_incident){olx_v3(light.x / f.x, light.y / f.y, light.z / f.z), olx_nearness(&hit)};
}

// Returns the random numbers of a pixel's ray through one lobe.
static olx_vec2 random_of(uint32_t seed, uint32_t branch, uint32_t frame) {
  return olx_stratified2(frame, olx_hash2(seed, OLX_SALT_BRANCH + branch));
}

// Gives every pixel the sample of its ray with that number.
static void fill_cpu_frame(cpu_frame *c, const olx_field *field, const host_view *v, uint32_t number) {
  for (uint32_t i = 0; i < FULL; i++) {
    c->depth[i] = INFINITY;
    c->samples[0][i] = c->samples[1][i] = (olx_incident){.inverse_distance = -1.0f};
  }
  for (uint32_t i = 0; i < v->width * v->height; i++) {
    const uint32_t x = i % v->width, y = i / v->width, at = place(v, x, y);
    const host_pixel p = host_pixel_at(v, x, y);
    if (p.empty) continue;
    c->depth[at] = p.metres;
    c->normal[at] = p.stored_normal; // filters compare the normals of the image
    c->roughness[at] = p.roughness;
    const uint32_t seed = olx_hash2(x, y);
    c->samples[0][at] = sample_diffuse(field, &p, random_of(seed, OLX_DIFFUSE_BRANCH, number));
    c->samples[1][at] = sample_glossy(field, &p, random_of(seed, OLX_GLOSSY_BRANCH, number));
  }
  c->guide = (olx_guide){
      .width = FULL_WIDTH, .height = FULL_HEIGHT, .depth = c->depth, .normal = c->normal, .roughness = c->roughness};
  c->guide.camera = (olx_camera_frame){.eye = v->eye,
                                       .forward = {0, 0, -1},
                                       .right = {HOST_SPREAD * FULL_WIDTH / WIDTH, 0, 0},
                                       .up = {0, HOST_SPREAD * FULL_HEIGHT / HEIGHT, 0}};
}

static cpu_denoiser *make_cpu_denoiser(void) {
  cpu_denoiser *c = calloc(1, sizeof *c);
  assert_non_null(c);
  for (uint32_t i = 0; i < 4; i++) {
    assert_int_equal(olx_history_create(FULL_WIDTH, FULL_HEIGHT, &c->history[i / 2][i % 2]), OLX_OK);
  }
  return c;
}

static void free_cpu_denoiser(cpu_denoiser *c) {
  for (uint32_t i = 0; i < 4; i++) olx_history_free(&c->history[i / 2][i % 2]);
  free(c);
}

static void run_cpu_frame(cpu_denoiser *c, const olx_field *field, const host_view *v,
                          const olx_denoise_settings *filters, uint32_t frame) {
  const uint32_t now = frame & 1, before = now ^ 1;
  const olx_ray_turn turn = olx_ray_turn_of(filters->ray_spacing, frame);
  fill_cpu_frame(&c->frames[now], field, v, olx_ray_turn_number(filters->ray_spacing, frame));
  if (frame == 0) c->frames[1].guide = c->frames[0].guide;
  for (uint32_t lobe = 0; lobe < 2; lobe++) {
    const olx_lobe_filter *filter = lobe ? &filters->glossy : &filters->diffuse;
    const olx_guide *guide = &c->frames[now].guide;
    olx_history *h = c->history[lobe];
    assert_int_equal(olx_denoise_accumulate(filter, &turn, guide, c->frames[now].samples[lobe],
                                            &c->frames[before].guide, &h[before], &h[now], 1),
                     OLX_OK);
    assert_int_equal(olx_denoise_filter(filter, lobe ? OLX_LOBE_GLOSSY : OLX_LOBE_DIFFUSE, guide, &h[now], &h[before],
                                        c->light[lobe], 1),
                     OLX_OK);
  }
}

static double squared(olx_vec3 v) { return (double)olx_dot(v, v); }

// Computes the relative mean squared errors of irradiance and of reflected glossy light.
static void judge(const host_fixture *f, const cpu_denoiser *c, const host_view *v, double errors[2]) {
  double sums[2] = {0};
  errors[0] = errors[1] = 0;
  for (uint32_t i = 0; i < v->width * v->height; i++) {
    const uint32_t x = i % v->width, y = i / v->width;
    const host_pixel p = host_pixel_at(v, x, y);
    for (uint32_t lobe = 0; lobe < 2; lobe++) {
      float alpha;
      const olx_vec3 seen = host_output(&f->images, lobe, i, &alpha);
      assert_true(olx_finite(seen) && alpha >= 0.0f && alpha <= 1.0f);
      if (p.empty) assert_true(squared(seen) == 0.0);
      if (p.empty) continue;
      const olx_vec3 light = c->light[lobe][place(v, x, y)];
      const olx_vec3 truth = lobe ? olx_mul(light, glossy_factor(&p)) : light;
      errors[lobe] += squared(olx_sub(seen, truth));
      sums[lobe] += squared(truth);
    }
  }
  for (uint32_t lobe = 0; lobe < 2; lobe++) errors[lobe] /= sums[lobe];
}

// Compares frames of an eye that may move. `bend`: the strength of bent normals (host_view).
static void compare_frames(host_fixture *f, const olx_denoise_settings *filters, olx_vec2 shift, bool moves,
                           float bend) {
  cpu_denoiser *c = make_cpu_denoiser();
  olx_vulkan_settings settings = settings_of(filters, BOTH);
  for (uint32_t frame = 0; frame < 4; frame++) {
    host_view view = view_of_frame(f, moves ? frame : 0, shift);
    view.bend = bend;
    run_frame(f, &view, &settings, frame);
    run_cpu_frame(c, f->field, &view, filters, frame);
    double errors[2];
    judge(f, c, &view, errors);
    print_message("frame %u: relative MSE of irradiance %.2e, glossy %.2e\n", frame, errors[0], errors[1]);
    // Light and weights are stored as half floats, which adds a relative MSE of 1e-7 each time.
    assert_true(errors[0] < 1e-5 && errors[1] < 1e-5);
  }
  free_cpu_denoiser(c);
}

static void frames_are_those_of_the_cpu(void **unused) {
  (void)unused;
  host_fixture *f = resize_running(WIDTH, HEIGHT, BOTH);
  const olx_denoise_settings adaptive = olx_denoise_settings_default(), published = olx_denoise_settings_published();
  compare_frames(f, &adaptive, (olx_vec2){0, 0}, false, 0.0f);
  compare_frames(f, &adaptive, (olx_vec2){0, 0}, true, 0.0f);
  compare_frames(f, &published, (olx_vec2){0, 0}, true, 0.0f);
  compare_frames(f, &adaptive, (olx_vec2){3, -2}, true, 0.0f); // a shifted picture, as of a jittered projection
  assert_silent(f);
}

static void frames_in_which_pixels_take_turns_are_those_of_the_cpu(void **unused) {
  (void)unused;
  host_fixture *f = resize_running(WIDTH, HEIGHT, BOTH);
  olx_denoise_settings filters = olx_denoise_settings_default();
  filters.ray_spacing = 2;
  compare_frames(f, &filters, (olx_vec2){0, 0}, false, 0.0f);
  compare_frames(f, &filters, (olx_vec2){0, 0}, true, 0.0f);
  assert_silent(f);
}

// Diffuse and glossy rays that a bent normal sends behind the surface bring no light, and count as rays.
static void no_light_comes_from_behind_the_surface(void **unused) {
  (void)unused;
  host_fixture *f = resize_running(WIDTH, HEIGHT, BOTH);
  const olx_denoise_settings filters = olx_denoise_settings_default();
  compare_frames(f, &filters, (olx_vec2){0, 0}, false, 0.8f);
  assert_silent(f);
}

static void any_number_of_frames_may_be_recorded_ahead(void **unused) {
  (void)unused;
  host_fixture *f = resize_running(WIDTH, HEIGHT, BOTH);
  const olx_denoise_settings filters = olx_denoise_settings_default();
  const host_view view = view_of_frame(f, 0, (olx_vec2){0, 0});
  const olx_vulkan_view vulkan_view = host_vulkan_view(&view);
  olx_vulkan_settings settings = settings_of(&filters, BOTH);
  for (uint32_t frame = 0; frame < 5; frame++) run_frame(f, &view, &settings, frame);
  const size_t bytes = (size_t)16 * WIDTH * HEIGHT * 2;
  void *apart = malloc(bytes);
  assert_non_null(apart);
  memcpy(apart, f->images.staging.mapped, bytes);
  assert_true(gpu_commands_begin(&device));
  host_upload(&f->images, &view);
  for (uint32_t frame = 0; frame < 5; frame++) record_frame(f, &vulkan_view, &settings, frame);
  host_download(&f->images);
  assert_true(gpu_commands_run(&device));
  for (uint32_t i = 0; i < 2; i++) { // for irradiance and for glossy light
    const size_t at = (size_t)16 * WIDTH * HEIGHT * i;
    assert_memory_equal((char *)apart + at, (char *)f->images.staging.mapped + at, (size_t)8 * WIDTH * HEIGHT);
  }
  free(apart);
  assert_silent(f);
}

static void glossy_light_alone_needs_no_other_history(void **unused) {
  (void)unused;
  host_fixture *f = resize_running(WIDTH, HEIGHT, OLX_VULKAN_LOBE_GLOSSY);
  cpu_denoiser *c = make_cpu_denoiser();
  const olx_denoise_settings filters = olx_denoise_settings_default();
  olx_vulkan_settings settings = settings_of(&filters, OLX_VULKAN_LOBE_GLOSSY);
  for (uint32_t frame = 0; frame < 3; frame++) {
    const host_view view = view_of_frame(f, frame, (olx_vec2){0, 0});
    run_frame(f, &view, &settings, frame);
    run_cpu_frame(c, f->field, &view, &filters, frame);
    double errors[2];
    judge(f, c, &view, errors);
    assert_true(errors[1] < 1e-5 && errors[0] > 1e-3); // diffuse light is unfiltered, as its ray found it
  }
  free_cpu_denoiser(c);
  assert_silent(f);
}

// ---- sizes

static void memory_is_told_before(void **unused) {
  (void)unused;
  host_fixture f = make_fixture(WIDTH, HEIGHT, 0);
  olx_vulkan_sizes sizes;
  assert_int_equal(olx_vulkan_frame_measure(f.uploaded, &f.images.targets, &sizes), OLX_OK);
  assert_true(sizes.device_bytes == 0 && sizes.allocations == 0 && f.frame->history.memory == VK_NULL_HANDLE);
  for (uint32_t lobes = 1; lobes <= BOTH; lobes++) {
    f.images.targets.denoise = lobes;
    assert_int_equal(olx_vulkan_frame_measure(f.uploaded, &f.images.targets, &sizes), OLX_OK);
    assert_true(sizes.device_bytes >= (uint64_t)WIDTH * HEIGHT * (lobes == BOTH ? 64 : 48));
    assert_true(sizes.allocations == 1 && sizes.staging_bytes == 0);
    assert_int_equal(olx_vulkan_frame_resize(f.frame, &f.images.targets), OLX_OK);
    assert_int_equal(f.frame->history.requirements.size, sizes.device_bytes);
  }
  host_fixture_free(&f);
}

static void any_size_begins_anew(void **unused) {
  (void)unused;
  olx_denoise_settings filters = olx_denoise_settings_published();
  const uint32_t sizes[][2] = {{1, 1}, {1, 70}, {640, 2}, {130, 101}, {1, 1}, {51, 35}};
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    filters.ray_spacing = 1 + (i & 1);
    host_fixture *f = resize_running(sizes[i][0], sizes[i][1], BOTH);
    olx_vulkan_settings settings = settings_of(&filters, BOTH);
    settings.sample.select = OLX_SELECT_CAGE;
    for (uint32_t frame = 0; frame < 2; frame++) {
      const host_view view = view_of_frame(f, frame, (olx_vec2){0, 0});
      run_frame(f, &view, &settings, frame);
      for (uint32_t k = 0; k < 2 * f->images.width * f->images.height; k++) {
        float alpha;
        assert_true(olx_finite(host_output(&f->images, k & 1, k / 2, &alpha)));
      }
    }
    assert_silent(f);
  }
}

// ---- what goes wrong

static void wrong_settings_are_refused(void **unused) {
  (void)unused;
  host_fixture f = make_fixture(8, 8, OLX_VULKAN_LOBE_GLOSSY);
  const host_view view = view_of_frame(&f, 0, (olx_vec2){0, 0});
  const olx_vulkan_view good = host_vulkan_view(&view);
  const olx_denoise_settings filters = olx_denoise_settings_default();
  const olx_vulkan_settings sane = settings_of(&filters, OLX_VULKAN_LOBE_GLOSSY);
  struct {
    olx_vulkan_settings settings;
    olx_vulkan_view view;
    const char *message;
  } cases[] = {{sane, good, "the settings name no lobe"},
               {sane, good, "was not made to denoise lobe 0x1"},
               {sane, good, "glossy filter has a setting out of range"},
               {sane, good, "0 diffuse rays"},
               {sane, good, "rays are 1 or 2 pixels apart, not 3"},
               {sane, good, "the view's clip_to_world is not that of a perspective"},
               {sane, good, "the previous view's clip_to_world"}};
  cases[0].settings.denoise.lobes = 0;
  cases[1].settings.denoise.lobes = BOTH;
  cases[2].settings.denoise.filters.glossy.stride_pixels = 0;
  cases[3].settings.diffuse_samples = 0;
  cases[4].settings.denoise.filters.ray_spacing = 3;
  const float parallel[16] = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1};
  memcpy(cases[5].view.clip_to_world, parallel, sizeof parallel);
  cases[6].settings.denoise.frame = 1; // a later frame without a previous view
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    assert_int_equal(olx_vulkan_record_denoise(f.frame, device.commands, &cases[i].view, &cases[i].settings),
                     OLX_ERROR_ARGUMENT);
    if (!strstr(olx_last_error(), cases[i].message)) fail_msg("'%s' lacks '%s'", olx_last_error(), cases[i].message);
  }
  f.images.targets.denoise = 4;
  assert_int_equal(olx_vulkan_frame_resize(f.frame, &f.images.targets), OLX_ERROR_ARGUMENT);
  host_fixture_free(&f);
}

static void a_device_with_too_small_images_is_refused(void **unused) {
  (void)unused;
  host_fixture f = make_fixture(32, 8, BOTH);
  f.uploaded->context.limits.maxImageDimension2D = 31;
  olx_vulkan_sizes sizes;
  assert_int_equal(olx_vulkan_frame_measure(f.uploaded, &f.images.targets, &sizes), OLX_ERROR_UNSUPPORTED);
  assert_int_equal(olx_vulkan_frame_resize(f.frame, &f.images.targets), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "no images of 32 x 8"));
  host_fixture_free(&f);
}

// Creates a frame again and again, each time with one more call before the one that fails. The validation layers count
// objects that are left behind.
static void create_failing(host_fixture *f, VkResult result, olx_result expected, int step) {
  faults.failure = result;
  olx_result got = expected;
  int n = 0;
  for (; got != OLX_OK; n += step) {
    faults.calls_left = n;
    olx_vulkan_frame *frame = (void *)1;
    got = olx_vulkan_frame_create(f->uploaded, &f->images.targets, &frame);
    if (got != OLX_OK) {
      assert_int_equal(got, expected);
      assert_null(frame);
      assert_true(strlen(olx_last_error()) > 0);
    } else {
      olx_vulkan_frame_destroy(frame);
    }
  }
  assert_true(n > 40);
}

static void a_frame_that_fails_at_any_call_leaves_nothing_behind(void **unused) {
  (void)unused;
  host_fixture f = make_fixture(8, 8, BOTH);
  create_failing(&f, VK_ERROR_OUT_OF_DEVICE_MEMORY, OLX_ERROR_MEMORY, 1);
  create_failing(&f, VK_ERROR_OUT_OF_HOST_MEMORY, OLX_ERROR_MEMORY, 7);
  create_failing(&f, VK_ERROR_DEVICE_LOST, OLX_ERROR_GPU, 7);
  host_fixture_free(&f);
}

static void a_frame_that_cannot_grow_stays_as_it_is(void **unused) {
  (void)unused;
  host_fixture *f = resize_running(WIDTH, HEIGHT, BOTH);
  cpu_denoiser *c = make_cpu_denoiser();
  const olx_denoise_settings filters = olx_denoise_settings_default();
  olx_vulkan_settings settings = settings_of(&filters, BOTH);
  host_images larger = make_images(2 * WIDTH, HEIGHT, BOTH);
  const olx_vulkan_functions working = f->uploaded->context.vk;
  faults_install(&device, &f->uploaded->context.vk);
  for (uint32_t frame = 0; frame < 4; frame++) {
    faults.calls_left = 0; // fails at the first image
    assert_int_equal(olx_vulkan_frame_resize(f->frame, &larger.targets), OLX_ERROR_MEMORY);
    faults.calls_left = 6 + (int)frame; // fails at the memory, or at an image's view
    assert_int_equal(olx_vulkan_frame_resize(f->frame, &larger.targets), OLX_ERROR_MEMORY);
    const host_view view = view_of_frame(f, frame, (olx_vec2){0, 0});
    run_frame(f, &view, &settings, frame);
    run_cpu_frame(c, f->field, &view, &filters, frame);
    double errors[2];
    judge(f, c, &view, errors);
    assert_true(errors[0] < 1e-5 && errors[1] < 1e-5);
  }
  faults.calls_left = 1000;
  assert_int_equal(olx_vulkan_frame_resize(f->frame, &larger.targets), OLX_OK);
  assert_int_equal(olx_vulkan_frame_resize(f->frame, &f->images.targets), OLX_OK);
  f->uploaded->context.vk = working;
  host_images_free(&larger);
  free_cpu_denoiser(c);
  assert_silent(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_are_those_of_the_cpu),
      cmocka_unit_test(frames_in_which_pixels_take_turns_are_those_of_the_cpu),
      cmocka_unit_test(no_light_comes_from_behind_the_surface),
      cmocka_unit_test(any_number_of_frames_may_be_recorded_ahead),
      cmocka_unit_test(glossy_light_alone_needs_no_other_history),
      cmocka_unit_test(memory_is_told_before),
      cmocka_unit_test(any_size_begins_anew),
      cmocka_unit_test(wrong_settings_are_refused),
      cmocka_unit_test(a_device_with_too_small_images_is_refused),
      cmocka_unit_test(a_frame_that_fails_at_any_call_leaves_nothing_behind),
      cmocka_unit_test(a_frame_that_cannot_grow_stays_as_it_is),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
