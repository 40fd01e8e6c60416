// Tests what the recorded passes write and what they refuse, on any Vulkan device, under the validation layers.
#include "core/bsdf.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "field/field_writer.h"
#include "shade/glossy.h"
#include "shade/surface_irradiance.h"
#include "vulkan/vulkan_frame.h"
#include "vulkan_faults.h"
#include "vulkan_host.h"

#include <octalux/sample.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

enum { WIDTH = 52, HEIGHT = 36, SAMPLES = 2, OUTPUTS = HOST_OUTPUTS };

static const host_view VIEW = {.scene = &HOST_ROOM, .eye = {3.1f, 1.6f, 4.2f}, .width = WIDTH, .height = HEIGHT};

static gpu_device device;

static int open_device(void **unused) {
  (void)unused;
  host_open_device(&device, true);
  return 0;
}

static int close_device(void **unused) {
  (void)unused;
  return host_close_device(&device);
}

// Makes images for the passes that run_frame records.
static host_images make_images(uint32_t width, uint32_t height, VkFormat normal) {
  host_images h = host_images_make(&device, width, height, normal);
  h.targets.passes = OLX_VULKAN_PASS_IRRADIANCE | OLX_VULKAN_PASS_GLOSSY | OLX_VULKAN_PASS_COMPOSITE;
  return h;
}

// Makes a fixture with pictures of WIDTH x HEIGHT.
static host_fixture make_fixture(uint32_t size, uint32_t irradiance_size) {
  host_fixture f = host_fixture_make(&device, size, irradiance_size);
  f.images = make_images(WIDTH, HEIGHT, VK_FORMAT_R32G32B32A32_SFLOAT);
  host_fixture_add_frame(&f);
  return f;
}

// Makes a small fixture with pipelines that cannot run, and no frame.
static host_fixture make_small_fixture(void) {
  host_fixture f = host_fixture_make(&device, 16, 8);
  f.images = make_images(8, 8, VK_FORMAT_R32G32B32A32_SFLOAT);
  faults_empty_pipelines(&device, &f.uploaded->context.vk);
  return f;
}

static void run_view(host_images *h, const host_view *seen, const olx_vulkan_frame *frame,
                     const olx_vulkan_settings *settings) {
  const olx_vulkan_view view = host_vulkan_view(seen);
  assert_true(gpu_commands_begin(&device));
  host_upload(h, seen);
  assert_int_equal(olx_vulkan_record_irradiance(frame, device.commands, &view, settings), OLX_OK);
  assert_int_equal(olx_vulkan_record_glossy(frame, device.commands, &view, settings), OLX_OK);
  assert_int_equal(olx_vulkan_record_composite(frame, device.commands, &view, settings,
                                               OLX_VULKAN_ADD_DIFFUSE | OLX_VULKAN_ADD_GLOSSY),
                   OLX_OK);
  host_download(h);
  assert_true(gpu_commands_run(&device));
}

static void run_frame(host_images *h, const olx_vulkan_frame *frame, const olx_vulkan_settings *settings) {
  run_view(h, &VIEW, frame, settings);
}

typedef struct light {
  olx_vec3 irradiance, glossy;
} light;

static olx_vec3 surface_irradiance(const olx_field *field, const olx_vulkan_settings *settings, const host_pixel *p) {
  const olx_surface_point point = {.position = p->position,
                                   .geometric_normal = p->geometric_normal,
                                   .vertex_normal = p->vertex_normal,
                                   .shading_normal = p->normal,
                                   .view = p->view};
  return olx_surface_light_at(field, &settings->sample, &point).irradiance;
}

static light expected_light(const olx_field *field, const olx_vulkan_settings *settings, const host_pixel *p,
                            const olx_bsdf *bsdf, uint32_t x, uint32_t y) {
  light l = {.irradiance = surface_irradiance(field, settings, p)};
  const uint32_t seed = olx_hash2(olx_hash2(x, y), OLX_SALT_BRANCH + OLX_GLOSSY_BRANCH);
  const uint32_t count = bsdf->alpha > 0.0f ? SAMPLES : 1;
  for (uint32_t j = 0; j < count; j++) {
    float weight, half_cosine;
    const olx_vec2 random = olx_stratified2(settings->sample_index * count + j, seed);
    olx_vec3 direction;
    if (!olx_glossy_draw(p->normal, p->view, p->roughness, random, &direction, &weight, &half_cosine) ||
        olx_dot(direction, p->geometric_normal) <= 0.0f) {
      continue;
    }
    const olx_vec3 radiance = olx_glossy(field, &settings->sample, p->position, p->normal, p->view, p->roughness,
                                         random, &weight, &half_cosine, NULL);
    const olx_vec3 reflected = olx_mul(olx_fresnel(bsdf, half_cosine), radiance);
    if (weight > 0.0f) l.glossy = olx_madd(l.glossy, reflected, weight / (float)count);
  }
  return l;
}

static double squared(olx_vec3 v) { return (double)olx_dot(v, v); }

// Computes the relative mean squared errors of irradiance, glossy light and the composite against the CPU.
static void judge_view(const host_images *h, const host_view *view, const olx_field *field,
                       const olx_vulkan_settings *settings, double errors[OUTPUTS]) {
  double sums[OUTPUTS] = {0};
  memset(errors, 0, OUTPUTS * sizeof errors[0]);
  for (uint32_t i = 0; i < h->width * h->height; i++) {
    const uint32_t x = i % h->width, y = i / h->width;
    const host_pixel p = host_pixel_at(view, x, y);
    float alpha[OUTPUTS];
    const olx_vec3 seen[OUTPUTS] = {host_output(h, 0, i, &alpha[0]), host_output(h, 1, i, &alpha[1]),
                                    host_output(h, 2, i, &alpha[2])};
    const olx_vec3 before = HOST_BEFORE;
    if (p.empty) {
      assert_true(squared(seen[0]) == 0 && alpha[0] == 0.0f && squared(seen[1]) == 0 && alpha[1] == 1.0f);
      assert_true(squared(olx_sub(seen[2], before)) == 0 && alpha[2] == 1.0f);
      continue;
    }
    assert_true(alpha[0] == 1.0f && alpha[1] >= 0.0f && alpha[1] <= 1.0f && alpha[2] == 1.0f);
    const float metallic = floorf(p.metallic * 255.0f + 0.5f) / 255.0f,
                weight = floorf(p.weight * 255.0f + 0.5f) / 255.0f;
    const olx_vec3 color =
        olx_v3(floorf(p.color.x * 255.0f + 0.5f) / 255.0f, floorf(p.color.y * 255.0f + 0.5f) / 255.0f,
               floorf(p.color.z * 255.0f + 0.5f) / 255.0f);
    const olx_bsdf bsdf = olx_bsdf_make(color, metallic, p.roughness, weight);
    const light l = expected_light(field, settings, &p, &bsdf, x, y);
    const olx_vec3 reflectance = olx_bsdf_diffuse(&bsdf, olx_dot(p.view, p.normal));
    const olx_vec3 diffuse = olx_scale(olx_mul(reflectance, l.irradiance), 1.0f / OLX_PI);
    const olx_vec3 truth[OUTPUTS] = {l.irradiance, l.glossy, olx_add(before, olx_add(diffuse, l.glossy))};
    for (uint32_t k = 0; k < OUTPUTS; k++) {
      errors[k] += squared(olx_sub(seen[k], truth[k]));
      sums[k] += squared(truth[k]);
    }
  }
  for (uint32_t k = 0; k < OUTPUTS; k++) errors[k] /= sums[k];
}

static void judge_frame(const host_images *h, const olx_field *field, const olx_vulkan_settings *settings,
                        double errors[OUTPUTS]) {
  judge_view(h, &VIEW, field, settings, errors);
}

static olx_vulkan_settings test_settings(void) {
  olx_vulkan_settings settings = olx_vulkan_settings_default();
  settings.glossy_samples = SAMPLES;
  settings.sample_index = 3;
  return settings;
}

static void passes_give_the_light_of_the_cpu(void **unused) {
  (void)unused;
  host_fixture f = make_fixture(128, 16);
  const olx_vulkan_settings settings = test_settings();
  double errors[OUTPUTS];
  run_frame(&f.images, f.frame, &settings);
  judge_frame(&f.images, f.field, &settings, errors);
  print_message("%s: relative MSE of irradiance %.2e, glossy %.2e, composite %.2e\n", device.properties.deviceName,
                errors[0], errors[1], errors[2]);
  for (uint32_t k = 0; k < OUTPUTS; k++) assert_true(errors[k] < 1e-5);
  host_fixture_free(&f);
}

// The error of irradiance against the CPU.
typedef struct misses {
  double relative_mse, share; // share of pixels that are off by more than one part in a hundred
} misses;

typedef olx_vec3 (*irradiance_function)(const olx_field *field, const olx_vulkan_settings *settings,
                                        const host_pixel *pixel);

static misses judge_irradiance(const host_fixture *f, const host_view *view, const olx_vulkan_settings *settings,
                               irradiance_function expected) {
  const olx_vulkan_view seen = host_vulkan_view(view);
  assert_true(gpu_commands_begin(&device));
  host_upload((host_images *)(uintptr_t)&f->images, view);
  if (olx_vulkan_record_irradiance(f->frame, device.commands, &seen, settings) != OLX_OK) {
    fail_msg("%s", olx_last_error());
  }
  host_download((host_images *)(uintptr_t)&f->images);
  assert_true(gpu_commands_run(&device));
  double off = 0, sum = 0, bad = 0, pixels = 0;
  for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
    const host_pixel p = host_pixel_at(view, i % WIDTH, i / WIDTH);
    if (p.empty) continue;
    float alpha;
    const olx_vec3 truth = expected(f->field, settings, &p);
    const double miss = squared(olx_sub(host_output(&f->images, 0, i, &alpha), truth));
    off += miss;
    sum += squared(truth);
    bad += miss > 1e-4 * squared(truth);
    pixels++;
  }
  return (misses){off / sum, bad / pixels};
}

static olx_vec3 probe_irradiance(const olx_field *field, const olx_vulkan_settings *settings, const host_pixel *p) {
  return olx_irradiance(field, &settings->sample, p->position, p->normal, p->view);
}

static olx_vec3 masked_irradiance(const olx_field *field, const olx_vulkan_settings *settings, const host_pixel *p) {
  return p->dynamic ? probe_irradiance(field, settings, p) : surface_irradiance(field, settings, p);
}

// Normals of all three kinds have their effect on light, in 32 bits a channel and in 8.
static void images_tell_normals_and_what_is_dynamic(void **unused) {
  (void)unused;
  static const VkFormat formats[] = {VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM};
  static const double limits[] = {1e-5, 2e-3}; // a normal of eight bits is off by up to 1/255 along each axis
  host_view view = VIEW;
  view.bend = 0.5f;
  for (uint32_t i = 0; i < 2; i++) {
    host_fixture f = host_fixture_make(&device, 128, 16);
    f.images = make_images(WIDTH, HEIGHT, formats[i]);
    f.images.targets.geometric_normal = host_input(&f.images, HOST_GEOMETRIC_NORMAL);
    f.images.targets.vertex_normal = host_input(&f.images, HOST_VERTEX_NORMAL);
    f.images.targets.dynamic = host_input(&f.images, HOST_DYNAMIC);
    host_fixture_add_frame(&f);
    olx_vulkan_settings settings = test_settings();
    const double masked = judge_irradiance(&f, &view, &settings, masked_irradiance).relative_mse;
    settings.irradiance_probes = true;
    const double probes = judge_irradiance(&f, &view, &settings, probe_irradiance).relative_mse;
    settings.irradiance_probes = false;
    const double other = judge_irradiance(&f, &view, &settings, surface_irradiance).relative_mse;
    print_message("relative MSE with a mask %.2e, by irradiance probes %.2e; of all as static %.2e\n", masked, probes,
                  other);
    assert_true(masked < limits[i] && probes < limits[i] && other > 1e-2);
    host_fixture_free(&f);
  }
}

// Rays that a bent normal sends below the geometric one bring no light, where the host gives the geometric normal. A
// normal that faces away from the eye is turned towards it, so that its pixel is not black.
static void nothing_is_reflected_from_below_the_surface(void **unused) {
  (void)unused;
  host_view view = VIEW;
  view.bend = 0.8f;
  host_fixture f = host_fixture_make(&device, 128, 16);
  f.images = make_images(WIDTH, HEIGHT, VK_FORMAT_R32G32B32A32_SFLOAT);
  f.images.targets.geometric_normal = host_input(&f.images, HOST_GEOMETRIC_NORMAL);
  host_fixture_add_frame(&f);
  const olx_vulkan_settings settings = test_settings();
  double errors[OUTPUTS];
  run_view(&f.images, &view, f.frame, &settings);
  judge_view(&f.images, &view, f.field, &settings, errors);
  uint32_t away = 0;
  for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
    const host_pixel p = host_pixel_at(&view, i % WIDTH, i / WIDTH);
    away += !p.empty && olx_dot(p.stored_normal, p.view) < 0.0f;
  }
  print_message("relative MSE of glossy light with bent normals %.2e, %u of which face away\n", errors[1], away);
  assert_true(errors[1] < 1e-5 && away > WIDTH * HEIGHT / 100);
  host_fixture_free(&f);
}

// A volume whose only row of cubes fills the half of the room towards x = 0.
typedef struct half_volume {
  uint32_t words[16 + OLX_VOLUME_CORNERS + 6];
  uint16_t irradiance[OLX_VOLUME_CORNERS * OLX_VOLUME_HALVES];
} half_volume;

static void add_volume(olx_field *field, half_volume *v) {
  const olx_volume_header header = {
      .origin = {0, 0, 0}, .cube_metres = 2.0f, .size = {1, 2, 3}, .cells = 1, .probes = OLX_VOLUME_CORNERS};
  memcpy(v->words, &header, sizeof header);
  for (uint32_t i = 0; i < OLX_VOLUME_CORNERS; i++) v->words[16 + i] = i;
  for (uint32_t i = 0; i < 6; i++) v->words[16 + OLX_VOLUME_CORNERS + i] = OLX_VOLUME_CELL;
  for (uint32_t i = 0; i < sizeof v->irradiance / 2; i++) {
    v->irradiance[i] = olx_half_pack(olx_unit_float(olx_hash(i)) + (i % OLX_VOLUME_HALVES < 3 ? 3.0f : -0.5f));
  }
  assert_int_equal(olx_volume_open(v->words, sizeof v->words, "half", &field->volume), OLX_OK);
  field->volume.irradiance = v->irradiance;
}

static olx_vec3 masked_volume(const olx_field *field, const olx_vulkan_settings *settings, const host_pixel *p) {
  return p->dynamic ? olx_volume_irradiance(field, p->position, p->normal) : surface_irradiance(field, settings, p);
}

// Dynamic objects take light from the volume, and none where it has no cell; in the other half of the room, static
// surfaces without stored light take it from irradiance probes.
static void dynamic_objects_take_the_irradiance_volume(void **unused) {
  (void)unused;
  host_need_device(&device);
  host_fixture f = {.device = &device, .messages = device.validation_messages, .field = host_field_make(128, 16)};
  half_volume volume;
  add_volume(f.field, &volume);
  assert_int_equal(olx_vulkan_field_create(&device.host, f.field, &f.uploaded), OLX_OK);
  f.images = make_images(WIDTH, HEIGHT, VK_FORMAT_R32G32B32A32_SFLOAT);
  f.images.targets.geometric_normal = host_input(&f.images, HOST_GEOMETRIC_NORMAL);
  f.images.targets.vertex_normal = host_input(&f.images, HOST_VERTEX_NORMAL);
  f.images.targets.dynamic = host_input(&f.images, HOST_DYNAMIC);
  host_fixture_add_frame(&f);
  host_view view = VIEW;
  view.bend = 0.5f;
  olx_vulkan_settings settings = test_settings();
  const double masked = judge_irradiance(&f, &view, &settings, masked_volume).relative_mse,
               probes = judge_irradiance(&f, &view, &settings, masked_irradiance).relative_mse;
  settings.sample.max_probes = 0; // no stored light
  const double fallen = judge_irradiance(&f, &view, &settings, masked_volume).relative_mse;
  print_message("relative MSE by the volume %.2e, without stored light %.2e; as if by irradiance probes %.2e\n", masked,
                fallen, probes);
  assert_true(masked < 1e-5 && fallen < 1e-5 && probes > 1e-2);
  host_fixture_free(&f);
}

// Returns the same field without probe light; on the device one black texel replaces the missing maps.
static olx_field without_probe_light(const olx_field *field) {
  olx_field plain = *field;
  plain.radiance = plain.irradiance = plain.moments = NULL;
  plain.irradiance_positions = NULL;
  plain.irradiance_flags = NULL;
  plain.irradiance_n = 0;
  plain.info.irradiance.probe_count = plain.info.irradiance.size = 0;
  plain.info.irradiance.grid = (olx_grid){.count = {0, 0, 0}};
  return plain;
}

static void expect_probe_light_asked_for(olx_result result) {
  assert_int_equal(result, OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "bake --probe-light"));
}

// Frames are lit with a volume and without, where surfaces have only their stored light.
static void a_field_without_probe_light_lights_frames(void **unused) {
  (void)unused;
  host_need_device(&device);
  for (uint32_t with_volume = 0; with_volume < 2; with_volume++) {
    host_fixture f = {.device = &device, .messages = device.validation_messages, .field = host_field_make(128, 16)};
    half_volume volume;
    if (with_volume) add_volume(f.field, &volume);
    olx_field *whole = f.field, plain = without_probe_light(whole);
    f.field = &plain;
    assert_int_equal(olx_vulkan_field_create(&device.host, f.field, &f.uploaded), OLX_OK);
    f.images = make_images(WIDTH, HEIGHT, VK_FORMAT_R32G32B32A32_SFLOAT);
    host_fixture_add_frame(&f);
    olx_vulkan_settings settings = test_settings();
    double errors[OUTPUTS];
    run_frame(&f.images, f.frame, &settings);
    judge_frame(&f.images, f.field, &settings, errors);
    print_message("relative MSE of irradiance %.2e, glossy %.2e, composite %.2e\n", errors[0], errors[1], errors[2]);
    for (uint32_t k = 0; k < OUTPUTS; k++) assert_true(errors[k] < 1e-5);
    const olx_vulkan_view view = host_vulkan_view(&VIEW);
    settings.irradiance_probes = true;
    assert_true(gpu_commands_begin(&device));
    expect_probe_light_asked_for(olx_vulkan_record_irradiance(f.frame, device.commands, &view, &settings));
    assert_true(gpu_commands_run(&device));
    f.images.targets.hits = 1u << OLX_HITS_STORED;
    expect_probe_light_asked_for(olx_vulkan_frame_resize(f.frame, &f.images.targets));
    f.field = whole;
    host_fixture_free(&f);
  }
}

// Points without stored light have none without a volume.
static void without_any_source_places_are_dark(void **unused) {
  (void)unused;
  host_need_device(&device);
  host_fixture f = {.device = &device, .messages = device.validation_messages, .field = host_field_make(64, 16)};
  olx_field *whole = f.field, plain = without_probe_light(whole);
  assert_int_equal(olx_vulkan_field_create(&device.host, &plain, &f.uploaded), OLX_OK);
  f.images = make_images(WIDTH, HEIGHT, VK_FORMAT_R32G32B32A32_SFLOAT);
  host_fixture_add_frame(&f);
  olx_vulkan_settings settings = test_settings();
  settings.sample.max_probes = 0; // no stored light
  run_frame(&f.images, f.frame, &settings);
  for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
    float alpha;
    assert_true(squared(host_output(&f.images, 0, i, &alpha)) == 0.0);
  }
  host_fixture_free(&f);
}

// When the camera moves, irradiance at each point remains that of the CPU, where it depends on position and normals
// alone, whether the geometric normal is given or computed from depth.
static void irradiance_stays_as_the_eye_moves(void **unused) {
  (void)unused;
  host_fixture f = make_fixture(128, 16);
  const olx_vulkan_settings settings = test_settings();
  for (uint32_t given = 0; given < 2; given++) {
    if (given) f.images.targets.geometric_normal = host_input(&f.images, HOST_GEOMETRIC_NORMAL);
    assert_int_equal(olx_vulkan_frame_resize(f.frame, &f.images.targets), OLX_OK);
    misses worst = {0};
    for (uint32_t i = 0; i < 8; i++) {
      host_view view = VIEW;
      view.eye = olx_add(view.eye, olx_v3(-0.03f * (float)i, 0.01f * (float)i, -0.05f * (float)i));
      view.shift = (olx_vec2){0.1f * (float)i, -0.07f * (float)i};
      const misses m = judge_irradiance(&f, &view, &settings, surface_irradiance);
      worst.relative_mse = fmax(worst.relative_mse, m.relative_mse);
      worst.share = fmax(worst.share, m.share);
    }
    print_message("geometric normals %s: relative MSE %.2e, %.4f %% of pixels off by more than 1 %%\n",
                  given ? "given" : "derived", worst.relative_mse, 100.0 * worst.share);
    assert_true(worst.relative_mse < 1e-5 && worst.share < 2e-3);
  }
  host_fixture_free(&f);
}

static void a_frame_can_be_resized_and_reads_other_formats(void **unused) {
  (void)unused;
  host_fixture f = host_fixture_make(&device, 64, 16);
  const host_images full = make_images(WIDTH, HEIGHT, VK_FORMAT_R8G8B8A8_UNORM);
  f.images = make_images(WIDTH, 9, VK_FORMAT_R32G32B32A32_SFLOAT);
  host_fixture_add_frame(&f);
  const olx_vulkan_settings settings = test_settings();
  run_frame(&f.images, f.frame, &settings);
  olx_vulkan_targets wrong = full.targets;
  wrong.depth.format = VK_FORMAT_R32_UINT;
  assert_int_equal(olx_vulkan_frame_resize(f.frame, &wrong), OLX_ERROR_ARGUMENT);
  run_frame(&f.images, f.frame, &settings); // the frame still has the old images
  host_images_free(&f.images);
  f.images = full;
  if (olx_vulkan_frame_resize(f.frame, &full.targets) != OLX_OK) fail_msg("%s", olx_last_error());
  run_frame(&f.images, f.frame, &settings);
  double errors[OUTPUTS];
  judge_frame(&f.images, f.field, &settings, errors);
  // The bounds allow for normals of eight bits, which are off by up to 1/255 along each axis.
  print_message("relative MSE of irradiance %.2e, glossy %.2e, composite %.2e\n", errors[0], errors[1], errors[2]);
  for (uint32_t k = 0; k < OUTPUTS; k++) assert_true(errors[k] < 2e-3);
  host_fixture_free(&f);
}

static const uint32_t COUNT_READS[] = {
#include "count_reads.spv.inc"
};

// The number of reads of the field's images for a pixel that shows a surface.
typedef struct reads {
  double filtered, fetched;
} reads;

static reads count_reads(const host_fixture *f, const olx_vulkan_settings *settings) {
  run_frame((host_images *)(uintptr_t)&f->images, f->frame, settings);
  reads sum = {0};
  uint32_t pixels = 0;
  for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
    float surface;
    const olx_vec3 result = host_output(&f->images, 0, i, &surface);
    if (surface == 0.0f) continue;
    pixels++;
    sum.filtered += (double)result.x;
    sum.fetched += (double)result.y;
  }
  return (reads){sum.filtered / pixels, sum.fetched / pixels};
}

static void diffuse_light_takes_hardly_more_reads_than_it_must(void **unused) {
  (void)unused;
  host_fixture f = make_fixture(64, 32);
  const VkShaderModuleCreateInfo code = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = sizeof COUNT_READS, .pCode = COUNT_READS};
  VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                      .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                .pName = "main"},
                                      .layout = f.frame->layout};
  assert_int_equal(device.CreateShaderModule(device.host.device, &code, NULL, &info.stage.module), VK_SUCCESS);
  VkPipeline *pipeline = &f.frame->pipelines[OLX_PASS_IRRADIANCE][0][0][0];
  device.DestroyPipeline(device.host.device, *pipeline, NULL);
  assert_int_equal(device.CreateComputePipelines(device.host.device, VK_NULL_HANDLE, 1, &info, NULL, pipeline),
                   VK_SUCCESS);
  device.DestroyShaderModule(device.host.device, info.stage.module, NULL);
  // Stored light reads four texels of a probe, each with distance, normal and light; 1.3 probes are read on average,
  // since the second is read only where its light may have enough weight. Irradiance probes read irradiance and moments
  // of eight probes.
  olx_vulkan_settings settings = test_settings();
  const reads stored = count_reads(&f, &settings);
  settings.irradiance_probes = true;
  const reads volume = count_reads(&f, &settings);
  print_message("stored: %.2f texels, %.2f filtered; volume: %.2f filtered\n", stored.fetched, stored.filtered,
                volume.filtered);
  assert_true(stored.fetched >= 12.0 && stored.fetched <= 2.5 * 12.0 && stored.filtered <= 1.0);
  assert_true(volume.fetched == 0.0 && volume.filtered <= 1.3 * 24.0);
  host_fixture_free(&f);
}

static void wrong_images_are_named(void **unused) {
  (void)unused;
  host_fixture f = make_small_fixture();
  struct {
    olx_vulkan_targets targets;
    const char *message;
  } cases[] = {
      {{.width = 0, .height = 8}, "frame size 0 x 8"},
      {{.width = 8, .height = 20000}, "frame size 8 x 20000"},
      {{.width = 8, .height = 8}, "no depth image"},
      {f.images.targets, "normal image's VkFormat"},
      {f.images.targets, "albedo image cannot be sampled in VkImageLayout 0"},
      {f.images.targets, "no glossy image"},
      {f.images.targets, "no pass 0x10"},
      {f.images.targets, "no tracer in 0x9"},
      {f.images.targets, "no light of hits in 0x5"},
      {f.images.targets, "geometric normal image's VkFormat"},
      {f.images.targets, "dynamic image cannot be sampled in VkImageLayout 0"},
  };
  cases[3].targets.normal.format = VK_FORMAT_R8G8B8A8_UINT;
  cases[4].targets.albedo.layout = VK_IMAGE_LAYOUT_UNDEFINED;
  cases[5].targets.glossy = VK_NULL_HANDLE;
  cases[6].targets.passes = 16;
  cases[7].targets.tracers = 9;
  cases[8].targets.hits = 5;
  cases[9].targets.geometric_normal = host_input(&f.images, HOST_GEOMETRIC_NORMAL);
  cases[9].targets.geometric_normal.format = VK_FORMAT_R8G8B8A8_UINT;
  cases[10].targets.dynamic = host_input(&f.images, HOST_DYNAMIC);
  cases[10].targets.dynamic.layout = VK_IMAGE_LAYOUT_UNDEFINED;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    olx_vulkan_frame *frame = (void *)1;
    assert_int_equal(olx_vulkan_frame_create(f.uploaded, &cases[i].targets, &frame), OLX_ERROR_ARGUMENT);
    assert_null(frame);
    if (!strstr(olx_last_error(), cases[i].message)) fail_msg("'%s' lacks '%s'", olx_last_error(), cases[i].message);
  }
  olx_vulkan_frame *frame;
  f.images.targets.selects = 1u << OLX_SELECT_OCTREE;
  assert_int_equal(olx_vulkan_frame_create(f.uploaded, &f.images.targets, &frame), OLX_ERROR_UNSUPPORTED);
  host_fixture_free(&f);
}

// Asserts that every pass that the mask names can be recorded, and no other.
static void assert_passes(const olx_vulkan_frame *frame, uint32_t passes) {
  static const char *const names[] = {"IRRADIANCE", "DIFFUSE", "GLOSSY", "COMPOSITE"};
  const olx_vulkan_view view = host_vulkan_view(&VIEW);
  const olx_vulkan_settings s = olx_vulkan_settings_default();
  const VkCommandBuffer c = device.commands;
  assert_true(gpu_commands_begin(&device));
  for (uint32_t i = 0; i < 4; i++) {
    const olx_result result = i == 0   ? olx_vulkan_record_irradiance(frame, c, &view, &s)
                              : i == 1 ? olx_vulkan_record_diffuse(frame, c, &view, &s)
                              : i == 2 ? olx_vulkan_record_glossy(frame, c, &view, &s)
                                       : olx_vulkan_record_composite(frame, c, &view, &s, OLX_VULKAN_ADD_GLOSSY);
    const bool made = passes >> i & 1u;
    assert_int_equal(result, made ? OLX_OK : OLX_ERROR_ARGUMENT);
    char message[64];
    snprintf(message, sizeof message, "made without OLX_VULKAN_PASS_%s", names[i]);
    if (!made && !strstr(olx_last_error(), message)) fail_msg("'%s' lacks '%s'", olx_last_error(), message);
  }
  assert_true(gpu_commands_run(&device));
}

static void only_the_passes_that_are_named_are_made(void **unused) {
  (void)unused;
  host_fixture f = make_small_fixture();
  olx_vulkan_targets *targets = &f.images.targets;
  targets->passes = OLX_VULKAN_PASS_COMPOSITE;
  host_fixture_add_frame(&f);
  assert_int_equal(faults.pipelines, 1);
  assert_passes(f.frame, OLX_VULKAN_PASS_COMPOSITE);
  targets->passes = OLX_VULKAN_PASS_COMPOSITE | OLX_VULKAN_PASS_GLOSSY; // also for glossy light of dim lobes
  assert_int_equal(olx_vulkan_frame_resize(f.frame, targets), OLX_OK);
  assert_int_equal(faults.pipelines, 3);
  targets->passes = OLX_VULKAN_PASS_IRRADIANCE;
  assert_int_equal(olx_vulkan_frame_resize(f.frame, targets), OLX_OK);
  assert_int_equal(faults.pipelines, 4);
  assert_passes(f.frame, OLX_VULKAN_PASS_IRRADIANCE | OLX_VULKAN_PASS_GLOSSY | OLX_VULKAN_PASS_COMPOSITE);
  targets->passes = 0;
  assert_int_equal(olx_vulkan_frame_resize(f.frame, targets), OLX_OK);
  assert_int_equal(faults.pipelines, 5);
  assert_passes(f.frame, 15);
  olx_vulkan_frame_destroy(f.frame);
  host_fixture_add_frame(&f);
  assert_int_equal(faults.pipelines, 10);
  host_fixture_free(&f);
}

// A driver compiles each tracer with each selector and each light of hits separately, when the frame is created and not
// when it is recorded.
static void each_tracer_and_selector_has_a_pipeline(void **unused) {
  (void)unused;
  host_fixture f = make_small_fixture();
  olx_vulkan_targets *targets = &f.images.targets;
  const olx_vulkan_view view = host_vulkan_view(&VIEW);
  olx_vulkan_settings settings = olx_vulkan_settings_default();
  targets->passes = OLX_VULKAN_PASS_GLOSSY;
  targets->tracers = 1u << OLX_TRACER_TWO_LEVEL;
  targets->selects = 1u << OLX_SELECT_CAGE;
  host_fixture_add_frame(&f);
  assert_int_equal(faults.pipelines, 2);
  assert_true(gpu_commands_begin(&device));
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "made without the tracer 'hiz'"));
  settings.sample.tracer = OLX_TRACER_TWO_LEVEL;
  settings.sample.select = OLX_SELECT_EXHAUSTIVE;
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "selector 'exhaustive'"));
  targets->tracers |= 1u << OLX_TRACER_HIZ;
  targets->selects |= 1u << OLX_SELECT_EXHAUSTIVE;
  assert_int_equal(olx_vulkan_frame_resize(f.frame, targets), OLX_OK);
  assert_int_equal(faults.pipelines, 5);
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_OK);
  settings.sample.hits = OLX_HITS_STORED;
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "light of hits 'stored'"));
  settings.sample.hits = (olx_hits)2;
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "no light of hits 2"));
  settings.sample.hits = OLX_HITS_SHADED;
  assert_int_equal(faults.pipelines, 5);
  assert_true(gpu_commands_run(&device));
  host_fixture_free(&f);
}

static void pipelines_go_through_the_host_s_cache(void **unused) {
  (void)unused;
  host_need_device(&device);
  const VkDevice d = device.host.device;
  const PFN_vkCreatePipelineCache create =
      (PFN_vkCreatePipelineCache)device.GetDeviceProcAddr(d, "vkCreatePipelineCache");
  const PFN_vkDestroyPipelineCache destroy =
      (PFN_vkDestroyPipelineCache)device.GetDeviceProcAddr(d, "vkDestroyPipelineCache");
  const VkPipelineCacheCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  VkPipelineCache cache;
  assert_int_equal(create(d, &info, NULL, &cache), VK_SUCCESS);
  device.host.pipeline_cache = cache;
  host_fixture f = make_small_fixture();
  device.host.pipeline_cache = VK_NULL_HANDLE;
  host_fixture_add_frame(&f);
  assert_true(faults.cache == cache);
  faults.cache = VK_NULL_HANDLE;
  olx_vulkan_classic *classic;
  analytic_field_add_classic(f.field, 32);
  assert_int_equal(olx_vulkan_classic_create(f.uploaded, f.field, &classic), OLX_OK);
  assert_true(faults.cache == cache);
  olx_vulkan_classic_destroy(classic);
  analytic_field_remove_classic(f.field);
  host_fixture_free(&f);
  destroy(d, cache, NULL);
}

// A missing classic map is refused with a message that names the missing option.
static void classic_maps_that_are_not_there_are_named(void **unused) {
  (void)unused;
  host_fixture f = make_small_fixture();
  olx_vulkan_classic *classic;
  assert_int_equal(olx_vulkan_classic_create(f.uploaded, f.field, &classic), OLX_ERROR_ARGUMENT);
  assert_null(classic);
  assert_non_null(strstr(olx_last_error(), "bake --classic"));
  olx_vulkan_classic_destroy(NULL);
  host_fixture_free(&f);
}

static void settings_that_cannot_be_are_refused(void **unused) {
  (void)unused;
  host_fixture f = make_small_fixture();
  host_fixture_add_frame(&f);
  const olx_vulkan_view view = host_vulkan_view(&VIEW);
  olx_vulkan_settings settings = olx_vulkan_settings_default();
  settings.glossy_samples = 0;
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  settings = olx_vulkan_settings_default();
  settings.sample.select = OLX_SELECT_OCTREE;
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "octree"));
  settings = olx_vulkan_settings_default();
  settings.sample.surface_tolerance = 2.0f * OLX_MOST_SURFACE_TOLERANCE;
  assert_int_equal(olx_vulkan_record_irradiance(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "surface tolerance of 32"));
  settings = olx_vulkan_settings_default();
  settings.sample.tracer = (olx_tracer)3;
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "there is no tracer 3"));
  settings = olx_vulkan_settings_default();
  settings.sample.select = (olx_select)(OLX_SELECT_BEST + 1);
  assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "there is no selector"));
  settings = olx_vulkan_settings_default();
  settings.sample.visibility = (olx_visibility)2;
  assert_int_equal(olx_vulkan_record_irradiance(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "there is no visibility 2"));
  static const float bad[] = {-0.1f, 1.5f, NAN, INFINITY};
  for (uint32_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    settings = olx_vulkan_settings_default();
    settings.dim_lobe = bad[i];
    assert_int_equal(olx_vulkan_record_glossy(f.frame, device.commands, &view, &settings), OLX_ERROR_ARGUMENT);
    assert_non_null(strstr(olx_last_error(), "dim lobe"));
  }
  settings = olx_vulkan_settings_default();
  assert_int_equal(olx_vulkan_record_composite(f.frame, device.commands, &view, &settings, 4), OLX_ERROR_ARGUMENT);
  host_fixture_free(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(passes_give_the_light_of_the_cpu),
      cmocka_unit_test(images_tell_normals_and_what_is_dynamic),
      cmocka_unit_test(nothing_is_reflected_from_below_the_surface),
      cmocka_unit_test(dynamic_objects_take_the_irradiance_volume),
      cmocka_unit_test(a_field_without_probe_light_lights_frames),
      cmocka_unit_test(without_any_source_places_are_dark),
      cmocka_unit_test(irradiance_stays_as_the_eye_moves),
      cmocka_unit_test(a_frame_can_be_resized_and_reads_other_formats),
      cmocka_unit_test(diffuse_light_takes_hardly_more_reads_than_it_must),
      cmocka_unit_test(wrong_images_are_named),
      cmocka_unit_test(only_the_passes_that_are_named_are_made),
      cmocka_unit_test(each_tracer_and_selector_has_a_pipeline),
      cmocka_unit_test(pipelines_go_through_the_host_s_cache),
      cmocka_unit_test(classic_maps_that_are_not_there_are_named),
      cmocka_unit_test(settings_that_cannot_be_are_refused),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
