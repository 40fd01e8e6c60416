// Creates what a frame needs on a device: pipelines for the passes that the host's images call for, the sets that bind
// these images, and the constants of a dispatch.
#include "vulkan/vulkan_frame.h"

#include "core/hooks.h"
#include "shade/ray_turn.h"

enum { MAX_SIZE = 16384, MAX_SAMPLES = 4096 };

enum { ALL_PASSES = (1 << (OLX_PASS_COMPOSITE + 1)) - 1 };
_Static_assert(OLX_VULKAN_PASS_IRRADIANCE == 1 << OLX_PASS_IRRADIANCE &&
                   OLX_VULKAN_PASS_DIFFUSE == 1 << OLX_PASS_DIFFUSE && OLX_VULKAN_PASS_GLOSSY == 1 << OLX_PASS_TRACE &&
                   OLX_VULKAN_PASS_COMPOSITE == 1 << OLX_PASS_COMPOSITE,
               "the bits of passes");

enum {
  ALL_TRACERS = (1 << OLX_GPU_TRACERS) - 1,
  ALL_SELECTS = OLX_SELECT_GPU_MASK | 1 << OLX_SELECT_EXHAUSTIVE | 1 << OLX_SELECT_BEST,
  ALL_HITS = 1 << OLX_HITS_SHADED | 1 << OLX_HITS_STORED
};

static const char WHAT[] = "a frame's passes";
static const char *const TRACERS[] = {"texel", "two-level", "hiz"};
static const char *const HITS[] = {"shaded", "stored"};

olx_vulkan_settings olx_vulkan_settings_default(void) {
  return (olx_vulkan_settings){.sample = olx_sample_settings_default(),
                               .diffuse_samples = 1,
                               .glossy_samples = 1,
                               .denoise = {.filters = olx_denoise_settings_default()}};
}

// Formats that a surface's images may have; `unorm` marks formats that hold 0 to 1 instead of signed numbers.
typedef struct input_format {
  VkFormat format;
  bool unorm;
} input_format;

static const input_format INPUT_FORMATS[] = {
    {VK_FORMAT_R8_UNORM, true},
    {VK_FORMAT_R8G8_UNORM, true},
    {VK_FORMAT_R8G8B8A8_UNORM, true},
    {VK_FORMAT_R8G8B8A8_SRGB, true},
    {VK_FORMAT_B8G8R8A8_UNORM, true},
    {VK_FORMAT_B8G8R8A8_SRGB, true},
    {VK_FORMAT_A8B8G8R8_UNORM_PACK32, true},
    {VK_FORMAT_A8B8G8R8_SRGB_PACK32, true},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, true},
    {VK_FORMAT_A2R10G10B10_UNORM_PACK32, true},
    {VK_FORMAT_R16_UNORM, true},
    {VK_FORMAT_R16G16_UNORM, true},
    {VK_FORMAT_R16G16B16A16_UNORM, true},
    {VK_FORMAT_R8G8B8A8_SNORM, false},
    {VK_FORMAT_R16G16B16A16_SNORM, false},
    {VK_FORMAT_R16_SFLOAT, false},
    {VK_FORMAT_R16G16_SFLOAT, false},
    {VK_FORMAT_R16G16B16A16_SFLOAT, false},
    {VK_FORMAT_R32_SFLOAT, false},
    {VK_FORMAT_R32G32_SFLOAT, false},
    {VK_FORMAT_R32G32B32A32_SFLOAT, false},
    {VK_FORMAT_B10G11R11_UFLOAT_PACK32, false},
    {VK_FORMAT_D16_UNORM, true},
    {VK_FORMAT_X8_D24_UNORM_PACK32, true},
    {VK_FORMAT_D32_SFLOAT, false},
    {VK_FORMAT_D16_UNORM_S8_UINT, true},
    {VK_FORMAT_D24_UNORM_S8_UINT, true},
    {VK_FORMAT_D32_SFLOAT_S8_UINT, false},
};

static const input_format *find_format(VkFormat format) {
  for (size_t i = 0; i < sizeof INPUT_FORMATS / sizeof INPUT_FORMATS[0]; i++) {
    if (INPUT_FORMATS[i].format == format) return &INPUT_FORMATS[i];
  }
  return NULL;
}

static bool readable_layout(VkImageLayout layout) {
  switch (layout) {
  case VK_IMAGE_LAYOUT_GENERAL:
  case VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL:
  case VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL:
  case VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL:
  case VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL: return true;
  default: return false;
  }
}

static olx_result check_input(const olx_vulkan_context *c, const olx_vulkan_image *image, const char *name) {
  if (!image->view) return olx_fail(OLX_ERROR_ARGUMENT, "the frame has no %s image", name);
  if (!find_format(image->format)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the %s image's VkFormat %d is not one that passes read", name,
                    (int)image->format);
  }
  if (!readable_layout(image->layout)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the %s image cannot be sampled in VkImageLayout %d", name, (int)image->layout);
  }
  VkFormatProperties properties;
  c->vk.GetPhysicalDeviceFormatProperties(c->host.physical_device, image->format, &properties);
  if (!(properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT)) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "the device cannot sample the %s image's VkFormat %d", name,
                    (int)image->format);
  }
  return OLX_OK;
}

// Refuses settings that need probe light on a field without it, which has no grid of irradiance probes on the device.
static olx_result check_probe_light(const olx_vulkan_field *field, const char *what) {
  if (field->constants.irradiance_grid.count.w) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT,
                  "%s: the field was baked without probe light (`octalux bake --probe-light` stores it)", what);
}

static olx_result check_targets(const olx_vulkan_field *field, const olx_vulkan_targets *t) {
  const olx_vulkan_context *c = &field->context;
  if (t->width < 1 || t->width > MAX_SIZE || t->height < 1 || t->height > MAX_SIZE) {
    return olx_fail(OLX_ERROR_ARGUMENT, "frame size %u x %u is not within 1 to %d", t->width, t->height, MAX_SIZE);
  }
  OLX_TRY(check_input(c, &t->depth, "depth"));
  OLX_TRY(check_input(c, &t->normal, "normal"));
  OLX_TRY(check_input(c, &t->albedo, "albedo"));
  OLX_TRY(check_input(c, &t->roughness, "roughness"));
  if (t->geometric_normal.view) OLX_TRY(check_input(c, &t->geometric_normal, "geometric normal"));
  if (t->vertex_normal.view) OLX_TRY(check_input(c, &t->vertex_normal, "vertex normal"));
  if (t->dynamic.view) OLX_TRY(check_input(c, &t->dynamic, "dynamic"));
  if (!t->irradiance || !t->glossy || !t->color) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the frame has no %s image",
                    !t->irradiance ? "irradiance"
                    : !t->glossy   ? "glossy"
                                   : "color");
  }
  if (t->denoise & ~(uint32_t)(OLX_VULKAN_LOBE_DIFFUSE | OLX_VULKAN_LOBE_GLOSSY)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "there is no lobe %#x to denoise", t->denoise);
  }
  if (t->passes & ~(uint32_t)ALL_PASSES) return olx_fail(OLX_ERROR_ARGUMENT, "there is no pass %#x", t->passes);
  if (t->tracers & ~(uint32_t)ALL_TRACERS) return olx_fail(OLX_ERROR_ARGUMENT, "there is no tracer in %#x", t->tracers);
  if (t->hits & ~(uint32_t)ALL_HITS) return olx_fail(OLX_ERROR_ARGUMENT, "there is no light of hits in %#x", t->hits);
  if (t->hits & 1u << OLX_HITS_STORED) OLX_TRY(check_probe_light(field, "light of hits 'stored'"));
  for (uint32_t select = 0; select < 32; select++) {
    if (!(t->selects >> select & ~((uint32_t)ALL_SELECTS >> select) & 1u)) continue;
    return olx_fail(OLX_ERROR_UNSUPPORTED, "the selector '%s' does not run on the GPU",
                    olx_select_name((olx_select)select));
  }
  return OLX_OK;
}

// Creates the layouts of sets 0 to 2: the field, the host's images, and the samples of a lobe.
static olx_result create_layouts(olx_vulkan_frame *f) {
  const olx_vulkan_context *c = &f->field->context;
  OLX_TRY(olx_gpu_set_layout_create(c, OLX_FRAME_BINDINGS, OLX_BINDING_OUT_IRRADIANCE, &f->set_layout));
  OLX_TRY(olx_gpu_set_layout_create(c, OLX_SAMPLE_BINDINGS, 0, &f->sample_set_layout));
  const VkDescriptorSetLayout sets[] = {f->field->set_layout, f->set_layout, f->sample_set_layout};
  return olx_gpu_layout_create(c, 3, sets, sizeof(olx_frame_constants), &f->layout);
}

static bool traces(uint32_t pass) { return pass == OLX_PASS_DIFFUSE || pass == OLX_PASS_TRACE; }

static VkPipeline *pipeline_of(olx_vulkan_frame *f, uint32_t pass, const olx_pass_constants *constants) {
  if (!traces(pass)) return &f->pipelines[pass][0][0][0];
  return &f->pipelines[pass][constants->tracer][constants->select][constants->hits];
}

static olx_result create_pipeline(olx_vulkan_frame *f, uint32_t pass, const olx_pass_constants *constants) {
  static const olx_pass_code *const codes[OLX_PASS_COUNT] = {&olx_irradiance_pass, &olx_diffuse_pass, &olx_trace_pass,
                                                             &olx_composite_pass, &olx_dim_pass};
  VkPipeline *pipeline = pipeline_of(f, pass, constants);
  if (*pipeline) return OLX_OK;
  OLX_TRY(olx_gpu_pipeline_create(&f->field->context, codes[pass], constants, f->layout, pipeline));
  f->passes |= 1u << pass;
  return OLX_OK;
}

// Creates the pipelines of a pass that traces: one for each tracer, selector and kind of hit light that the targets
// call for.
static olx_result create_variants(olx_vulkan_frame *f, uint32_t pass, const olx_vulkan_targets *t) {
  const uint32_t tracers = t->tracers ? t->tracers : 1u << OLX_TRACER_HIZ;
  const uint32_t selects = t->selects ? t->selects : 1u << OLX_SELECT_BEST;
  const uint32_t all_hits = t->hits ? t->hits : 1u << OLX_HITS_SHADED;
  for (uint32_t tracer = 0; tracer < OLX_GPU_TRACERS; tracer++) {
    for (uint32_t select = 0; select <= OLX_SELECT_BEST; select++) {
      if (!(tracers >> tracer & 1u) || !(selects >> select & 1u)) continue;
      for (uint32_t hits = 0; hits < OLX_GPU_HITS; hits++) {
        const olx_select used = olx_vulkan_field_select(f->field, (olx_select)select);
        const olx_pass_constants constants = {(olx_tracer)tracer, used, hits, olx_gpu_field_geometry(f->field)};
        if (all_hits >> hits & 1u) OLX_TRY(create_pipeline(f, pass, &constants));
      }
    }
  }
  return OLX_OK;
}

// Creates the pipelines that the targets call for and that do not exist yet.
static olx_result create_pipelines(olx_vulkan_frame *f, const olx_vulkan_targets *t) {
  const olx_pass_constants usual = {OLX_TRACER_HIZ, OLX_SELECT_BRICKS, OLX_HITS_SHADED,
                                    olx_gpu_field_geometry(f->field)};
  for (uint32_t pass = 0; pass < OLX_PASS_COUNT; pass++) {
    const uint32_t named = pass == OLX_PASS_DIM ? OLX_PASS_TRACE : pass;
    if (t->passes != 0 && !(t->passes >> named & 1u)) continue;
    OLX_TRY(traces(pass) ? create_variants(f, pass, t) : create_pipeline(f, pass, &usual));
  }
  return OLX_OK;
}

static olx_result create_sets(olx_vulkan_frame *f) {
  const olx_vulkan_context *c = &f->field->context;
  OLX_TRY(olx_gpu_pool_create(c, 5, OLX_BINDING_OUT_IRRADIANCE, OLX_FRAME_BINDINGS - OLX_BINDING_OUT_IRRADIANCE + 4,
                              &f->pool));
  for (uint32_t i = 0; i < 4; i++) {
    OLX_TRY(olx_gpu_set_allocate(c, f->pool, f->sample_set_layout, &f->sample_sets[i / 2][i % 2]));
  }
  return olx_gpu_set_allocate(c, f->pool, f->set_layout, &f->set);
}

static uint32_t flags_of_normal(const olx_vulkan_image *image, uint32_t given, uint32_t unorm) {
  if (!image->view) return 0;
  return given | (find_format(image->format)->unorm ? unorm : 0u);
}

static uint32_t flags_of_images(const olx_vulkan_targets *t) {
  return flags_of_normal(&t->normal, 0, OLX_FRAME_NORMAL_UNORM) |
         flags_of_normal(&t->geometric_normal, OLX_FRAME_GEOMETRIC_NORMAL, OLX_FRAME_GEOMETRIC_UNORM) |
         flags_of_normal(&t->vertex_normal, OLX_FRAME_VERTEX_NORMAL, OLX_FRAME_VERTEX_UNORM) |
         (t->dynamic.view ? OLX_FRAME_DYNAMIC : 0u);
}

static void write_sets(olx_vulkan_frame *f, const olx_vulkan_targets *t) {
  const olx_vulkan_context *c = &f->field->context;
  const olx_vulkan_image inputs[] = {t->depth,
                                     t->normal,
                                     t->albedo,
                                     t->roughness,
                                     t->geometric_normal.view ? t->geometric_normal : t->normal,
                                     t->vertex_normal.view ? t->vertex_normal : t->normal,
                                     t->dynamic.view ? t->dynamic : t->roughness};
  const VkImageView outputs[] = {t->irradiance, t->glossy, t->color};
  VkDescriptorImageInfo images[OLX_FRAME_BINDINGS];
  for (uint32_t i = 0; i < OLX_FRAME_BINDINGS; i++) {
    images[i] =
        i < OLX_BINDING_OUT_IRRADIANCE
            ? (VkDescriptorImageInfo){f->field->nearest, inputs[i].view, inputs[i].layout}
            : (VkDescriptorImageInfo){VK_NULL_HANDLE, outputs[i - OLX_BINDING_OUT_IRRADIANCE], VK_IMAGE_LAYOUT_GENERAL};
  }
  olx_gpu_set_write(c, f->set, OLX_FRAME_BINDINGS, OLX_BINDING_OUT_IRRADIANCE, images);
  for (uint32_t lobe = 0; lobe < 2; lobe++) {
    const uint32_t kind = lobe ? OLX_HISTORY_GLOSSY : OLX_HISTORY_DIFFUSE;
    for (uint32_t now = 0; now < 2; now++) {
      const VkImageView view = olx_gpu_history_has(&f->history, kind) ? f->history.views[kind][now] : outputs[lobe];
      const VkDescriptorImageInfo sample = {VK_NULL_HANDLE, view, VK_IMAGE_LAYOUT_GENERAL};
      olx_gpu_set_write(c, f->sample_sets[lobe][now], OLX_SAMPLE_BINDINGS, 0, &sample);
    }
  }
  if (f->history.lobes) olx_gpu_denoiser_write(f, t);
}

olx_result olx_vulkan_frame_resize(olx_vulkan_frame *f, const olx_vulkan_targets *t) {
  const olx_vulkan_context *c = &f->field->context;
  OLX_TRY(check_targets(f->field, t));
  OLX_TRY(create_pipelines(f, t));
  olx_gpu_history history;
  olx_result result = olx_gpu_history_begin(c, t->width, t->height, t->denoise, &history);
  if (result == OLX_OK) result = olx_gpu_history_allocate(c, &history);
  if (result == OLX_OK && t->denoise && !f->denoiser.filter) {
    result = olx_gpu_denoiser_create(f);
    if (result != OLX_OK) olx_gpu_denoiser_destroy(f);
  }
  if (result != OLX_OK) {
    olx_gpu_history_destroy(c, &history);
    return result;
  }
  olx_gpu_history_destroy(c, &f->history);
  f->history = history;
  f->width = t->width;
  f->height = t->height;
  f->image_flags = flags_of_images(t);
  write_sets(f, t);
  return OLX_OK;
}

olx_result olx_vulkan_frame_measure(const olx_vulkan_field *field, const olx_vulkan_targets *targets,
                                    olx_vulkan_sizes *sizes) {
  *sizes = (olx_vulkan_sizes){.device_bytes = 0};
  OLX_TRY(check_targets(field, targets));
  olx_gpu_history history;
  const olx_result result =
      olx_gpu_history_begin(&field->context, targets->width, targets->height, targets->denoise, &history);
  if (result == OLX_OK && targets->denoise) {
    sizes->device_bytes = history.requirements.size;
    sizes->allocations = 1;
  }
  olx_gpu_history_destroy(&field->context, &history);
  return result;
}

static olx_result create_frame(olx_vulkan_frame *f, const olx_vulkan_targets *targets) {
  OLX_TRY(check_targets(f->field, targets));
  OLX_TRY(create_layouts(f));
  OLX_TRY(create_sets(f));
  return olx_vulkan_frame_resize(f, targets);
}

olx_result olx_vulkan_frame_create(olx_vulkan_field *field, const olx_vulkan_targets *targets,
                                   olx_vulkan_frame **frame) {
  *frame = NULL;
  olx_vulkan_frame *f = olx_allocate_zero(1, sizeof *f);
  if (!f) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for their handle", WHAT);
  f->field = field;
  const olx_result result = create_frame(f, targets);
  if (result != OLX_OK) {
    olx_vulkan_frame_destroy(f);
    return result;
  }
  *frame = f;
  return OLX_OK;
}

void olx_vulkan_frame_destroy(olx_vulkan_frame *f) {
  if (!f) return;
  const olx_vulkan_functions *vk = &f->field->context.vk;
  const VkDevice device = f->field->context.host.device;
  olx_gpu_denoiser_destroy(f);
  olx_gpu_history_destroy(&f->field->context, &f->history);
  vk->DestroyDescriptorPool(device, f->pool, NULL);
  VkPipeline *const pipelines = &f->pipelines[0][0][0][0];
  for (uint32_t i = 0; i < sizeof f->pipelines / sizeof *pipelines; i++)
    vk->DestroyPipeline(device, pipelines[i], NULL);
  vk->DestroyPipelineLayout(device, f->layout, NULL);
  vk->DestroyDescriptorSetLayout(device, f->set_layout, NULL);
  vk->DestroyDescriptorSetLayout(device, f->sample_set_layout, NULL);
  olx_release(f);
}

olx_result olx_vulkan_check_settings(const olx_vulkan_frame *f, const olx_vulkan_settings *s) {
  if ((uint32_t)s->sample.tracer > OLX_TRACER_HIZ) {
    return olx_fail(OLX_ERROR_ARGUMENT, "there is no tracer %d", (int)s->sample.tracer);
  }
  if ((uint32_t)s->sample.select > OLX_SELECT_BEST) {
    return olx_fail(OLX_ERROR_ARGUMENT, "there is no selector %d", (int)s->sample.select);
  }
  if ((uint32_t)s->sample.visibility > OLX_VISIBILITY_CHEBYSHEV) {
    return olx_fail(OLX_ERROR_ARGUMENT, "there is no visibility %d", (int)s->sample.visibility);
  }
  if (s->sample.select < OLX_SELECT_EXHAUSTIVE && !(OLX_SELECT_GPU_MASK >> s->sample.select & 1u)) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "the selector '%s' does not run on the GPU",
                    olx_select_name(s->sample.select));
  }
  if ((uint32_t)s->sample.hits > OLX_HITS_STORED) {
    return olx_fail(OLX_ERROR_ARGUMENT, "there is no light of hits %d", (int)s->sample.hits);
  }
  if (s->glossy_samples < 1 || s->glossy_samples > MAX_SAMPLES) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%u glossy rays are not within 1 to %d", s->glossy_samples, MAX_SAMPLES);
  }
  if (s->diffuse_samples < 1 || s->diffuse_samples > MAX_SAMPLES) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%u diffuse rays are not within 1 to %d", s->diffuse_samples, MAX_SAMPLES);
  }
  if (!(s->dim_lobe >= 0.0f && s->dim_lobe <= 1.0f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a dim lobe's reflectance of %g is not within 0 to 1", (double)s->dim_lobe);
  }
  if (!(s->sample.surface_tolerance >= 0.0f && s->sample.surface_tolerance <= OLX_MOST_SURFACE_TOLERANCE)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "a surface tolerance of %g footprints is not within 0 to %g",
                    (double)s->sample.surface_tolerance, (double)OLX_MOST_SURFACE_TOLERANCE);
  }
  if (s->irradiance_probes) OLX_TRY(check_probe_light(f->field, "light of irradiance probes"));
  if (s->denoise.lobes & ~f->history.lobes) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the frame was not made to denoise lobe %#x",
                    s->denoise.lobes & ~f->history.lobes);
  }
  return s->denoise.lobes ? olx_denoise_settings_check(&s->denoise.filters) : OLX_OK;
}

static olx_pass_constants constants_of(const olx_vulkan_frame *f, const olx_vulkan_settings *s) {
  return (olx_pass_constants){s->sample.tracer, olx_vulkan_field_select(f->field, s->sample.select),
                              (uint32_t)s->sample.hits, olx_gpu_field_geometry(f->field)};
}

olx_result olx_vulkan_check_pass(const olx_vulkan_frame *f, olx_pass pass, const olx_vulkan_settings *s) {
  static const char *const names[OLX_PASS_COUNT] = {"IRRADIANCE", "DIFFUSE", "GLOSSY", "COMPOSITE", "GLOSSY"};
  if (!(f->passes >> pass & 1u)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the frame was made without OLX_VULKAN_PASS_%s", names[pass]);
  }
  OLX_TRY(olx_vulkan_check_settings(f, s));
  const olx_pass_constants constants = constants_of(f, s);
  if (!traces(pass) || f->pipelines[pass][constants.tracer][constants.select][constants.hits]) return OLX_OK;
  return olx_fail(OLX_ERROR_ARGUMENT,
                  "the frame was made without the tracer '%s' with the selector '%s' and light of hits '%s'",
                  TRACERS[constants.tracer], olx_select_name(constants.select), HITS[constants.hits]);
}

olx_frame_constants olx_gpu_frame_constants(const olx_vulkan_frame *f, const olx_vulkan_view *view,
                                            const olx_vulkan_settings *s, uint32_t flags) {
  olx_frame_constants constants = {
      .eye = {view->eye.x, view->eye.y, view->eye.z, view->empty_depth},
      .width = f->width,
      .height = f->height,
      .flags = flags | (s->sample.keep_buried ? OLX_FRAME_KEEP_BURIED : 0u) |
               (s->sample.emitters ? OLX_FRAME_EMITTERS : 0u) |
               (s->sample.visibility == OLX_VISIBILITY_CHEBYSHEV ? OLX_FRAME_VISIBILITY : 0u) |
               (s->irradiance_probes ? OLX_FRAME_IRRADIANCE_PROBES : 0u) |
               (s->sample.select == OLX_SELECT_EXHAUSTIVE ? OLX_FRAME_RANK_ALL : 0u) | f->image_flags,
      .max_probes = s->sample.max_probes,
      .glossy_samples = s->glossy_samples,
      .sample_index = flags & OLX_TURN_SPARSE ? olx_ray_turn_number(2, s->sample_index) : s->sample_index,
      .dim_lobe = olx_vulkan_dim_lobe(s),
      .seed = s->seed,
      .diffuse_samples = s->diffuse_samples,
      .surface_tolerance = s->sample.surface_tolerance,
  };
  memcpy(constants.clip_to_world, view->clip_to_world, sizeof constants.clip_to_world);
  return constants;
}

// Dispatches an invocation for each square of `spacing` x `spacing` pixels.
static void dispatch_apart(const olx_vulkan_frame *f, VkCommandBuffer commands, uint32_t spacing) {
  const uint32_t group = OLX_PASS_SIZE * spacing;
  f->field->context.vk.CmdDispatch(commands, (f->width + group - 1) / group, (f->height + group - 1) / group, 1);
}

void olx_vulkan_dispatch(const olx_vulkan_frame *f, VkCommandBuffer commands) { dispatch_apart(f, commands, 1); }

olx_result olx_vulkan_record_pass(const olx_vulkan_frame *f, olx_pass pass, VkCommandBuffer commands,
                                  const olx_vulkan_view *view, const olx_vulkan_settings *settings, uint32_t flags) {
  OLX_TRY(olx_vulkan_check_pass(f, pass, settings));
  const olx_vulkan_functions *vk = &f->field->context.vk;
  const olx_frame_constants constants = olx_gpu_frame_constants(f, view, settings, flags);
  const VkDescriptorSet sets[] = {f->field->set, f->set};
  const olx_pass_constants choice = constants_of(f, settings);
  const VkPipeline pipeline =
      traces(pass) ? f->pipelines[pass][choice.tracer][choice.select][choice.hits] : f->pipelines[pass][0][0][0];
  vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
  vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, f->layout, 0, 2, sets, 0, NULL);
  vk->CmdPushConstants(commands, f->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
  dispatch_apart(f, commands, flags & OLX_TURN_SPARSE ? 2 : 1);
  return OLX_OK;
}

olx_result olx_vulkan_record_rays(const olx_vulkan_frame *f, olx_pass pass, uint32_t lobe, VkCommandBuffer commands,
                                  const olx_vulkan_view *view, const olx_vulkan_settings *settings) {
  OLX_TRY(olx_vulkan_check_pass(f, pass, settings));
  const olx_vulkan_context *c = &f->field->context;
  const bool glossy = lobe == OLX_VULKAN_LOBE_GLOSSY, denoised = settings->denoise.lobes & lobe;
  const uint32_t frame = settings->denoise.frame;
  if (denoised || (frame == 0 && f->history.lobes & lobe)) { // it is bound in either case
    olx_gpu_history_barrier(c, &f->history, glossy ? OLX_HISTORY_GLOSSY : OLX_HISTORY_DIFFUSE, frame == 0, commands);
  }
  const VkDescriptorSet samples = f->sample_sets[glossy][denoised ? frame & 1u : 0u];
  c->vk.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, f->layout, 2, 1, &samples, 0, NULL);
  const uint32_t flags = denoised ? OLX_FRAME_SAMPLE | olx_gpu_turn_flags(&settings->denoise) : 0u;
  return olx_vulkan_record_pass(f, pass, commands, view, settings, flags);
}
