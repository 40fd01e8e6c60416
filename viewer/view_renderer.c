// Renders a frame of the viewer: surfaces and direct light, indirect light from the field, overlays, and the panel, as
// the state requests.
#include "view_renderer.h"
#include "view_object.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool upload_field(view_renderer *r, const olx_field *field) {
  r->field_info = olx_field_describe(field);
  return gpu_check_library(r->device, olx_vulkan_field_create(&r->device->host, field, &r->field));
}

// Returns the passes of Octalux that a state needs; each is created on first use.
static uint32_t wanted_passes(const view_state *s) {
  uint32_t passes = OLX_VULKAN_PASS_COMPOSITE;
  if (s->mode == VIEW_PROBES) return passes;
  if (s->diffuse) passes |= s->mode == VIEW_PREFILTERED ? OLX_VULKAN_PASS_IRRADIANCE : OLX_VULKAN_PASS_DIFFUSE;
  return passes | (s->glossy ? OLX_VULKAN_PASS_GLOSSY : 0u);
}

// Attaches new images or passes to those passes that are not the rasteriser's.
static bool attach(view_renderer *r, const view_state *s) {
  olx_vulkan_targets targets = frame_images_targets(&r->raster.images);
  targets.denoise = OLX_VULKAN_LOBE_DIFFUSE | OLX_VULKAN_LOBE_GLOSSY;
  targets.passes = r->lit_passes |= wanted_passes(s);
  targets.tracers = r->lit_tracers |= 1u << s->tracer;
  targets.selects = r->lit_selects |= 1u << s->select;
  targets.hits = r->lit_hits |= 1u << s->hits;
  r->history = 0;
  const olx_result result =
      r->lit ? olx_vulkan_frame_resize(r->lit, &targets) : olx_vulkan_frame_create(r->field, &targets, &r->lit);
  if (!gpu_check_library(r->device, result)) return false;
  view_passes_attach(r->device, &r->passes, &r->raster.images);
  view_meter_attach(r->device, &r->meter, &r->raster.images);
  return true;
}

bool view_renderer_create(gpu_device *device, const olx_scene *scene, const olx_field *field,
                          const uint32_t lit_size[2], view_renderer *r) {
  *r = (view_renderer){.device = device};
  r->content = olx_scene_get_content(scene);
  r->lights = view_lights_of(&r->content);
  r->lamps = calloc(1, sizeof *r->lamps);
  if (!r->lamps) return gpu_fail(device, "out of memory for the lamps");
  const lamp_settings lamps = lamp_settings_default();
  r->near_metres = raster_view_near(r->content.bounds_min, r->content.bounds_max);
  return upload_field(r, field) &&
         rasteriser_create(device, &r->content, &lamps, lit_size[0], lit_size[1], &r->raster) &&
         view_screen_create(device, &r->screen) &&
         view_passes_create(device, r->field, r->screen.render_pass, &r->passes) &&
         view_meter_create(device, &r->meter) && gpu_timer_create(device, &r->timer);
}

bool view_renderer_relight(view_renderer *r, const olx_scene *scene, const olx_field *field, bool in_step) {
  r->relight = view_relight_create(r->device, scene, field, r->field, in_step);
  if (r->relight) view_relight_lights(r->relight, &r->lights);
  return r->relight != NULL;
}

void view_renderer_destroy(view_renderer *r) {
  gpu_device *d = r->device;
  free(r->lamps);
  r->lamps = NULL;
  if (!d || !d->host.device) return;
  d->DeviceWaitIdle(d->host.device);
  view_relight_destroy(r->relight);
  gpu_timer_destroy(d, &r->timer);
  view_meter_destroy(d, &r->meter);
  view_passes_destroy(d, &r->passes);
  view_screen_destroy(d, &r->screen);
  olx_vulkan_frame_destroy(r->lit);
  olx_vulkan_field_destroy(r->field);
  gpu_scene_destroy(d, &r->object);
  rasteriser_destroy(d, &r->raster);
}

void view_renderer_lit_size(const view_state *state, const uint32_t size[2], uint32_t lit_size[2]) {
  for (int i = 0; i < 2; i++) lit_size[i] = (uint32_t)fmaxf(1.0f, roundf((float)size[i] * state->scale));
}

// Returns whether the frame has the pipelines that a state needs.
static bool has_pipelines(const view_renderer *r, const view_state *s) {
  return r->lit && !(wanted_passes(s) & ~r->lit_passes) && r->lit_tracers >> s->tracer & 1u &&
         r->lit_selects >> s->select & 1u && r->lit_hits >> s->hits & 1u;
}

bool view_renderer_is_ready(const view_renderer *r, const view_state *s) {
  return has_pipelines(r, s) && view_passes_are_ready(&r->passes, s);
}

static bool resize(view_renderer *r, const view_state *state, const uint32_t size[2]) {
  const frame_images *images = &r->raster.images;
  uint32_t lit[2];
  view_renderer_lit_size(state, size, lit);
  const bool fits = images->width == lit[0] && images->height == lit[1];
  if (!fits && !rasteriser_resize(r->device, &r->raster, lit[0], lit[1])) return false;
  if ((!fits || !has_pipelines(r, state)) && !attach(r, state)) return false;
  const gpu_image *picture = &r->screen.picture;
  if (picture->image && picture->width == size[0] && picture->height == size[1]) return true;
  return view_screen_resize(r->device, size[0], size[1], &r->screen);
}

// Creates the object on first use, and recreates it when its appearance changes.
static bool make_object(view_renderer *r, const view_state *s) {
  if (!s->object) return true;
  const bool same = r->object_roughness == s->object_roughness && r->object_metallic == s->object_metallic;
  if (r->object.batch_count > 0 && same) return true;
  gpu_scene_destroy(r->device, &r->object);
  r->object_roughness = s->object_roughness;
  r->object_metallic = s->object_metallic;
  return view_object_create(r->device, s->object_roughness, s->object_metallic, &r->object);
}

static bool same_place(olx_vec3 a, olx_vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static bool same_view(const olx_vulkan_view *a, const olx_vulkan_view *b) {
  bool same = same_place(a->eye, b->eye) && a->empty_depth == b->empty_depth;
  for (uint32_t i = 0; i < 16; i++) same = same && a->clip_to_world[i] == b->clip_to_world[i];
  return same;
}

static bool shadows_are_old(const view_renderer *r, const view_state *s) {
  if (!r->shadowed || r->shadow_of_object != s->object) return true;
  return s->object && (!same_place(r->object_position, s->object_position) || r->object_radius != s->object_radius);
}

static void record_shadows(view_renderer *r, const view_state *s, VkCommandBuffer commands, const draw_item *items,
                           uint32_t count) {
  if (!shadows_are_old(r, s)) return;
  shadow_pass_record(r->device, &r->raster.shadows, commands, items, count);
  r->shadowed = true;
  r->shadow_of_object = s->object;
  r->object_position = s->object_position;
  r->object_radius = s->object_radius;
}

static uint32_t denoised_lobes(const view_state *s) {
  if (s->mode == VIEW_PROBES || (s->denoise == 0 && s->mode != VIEW_GATHER)) return 0;
  const uint32_t diffuse = s->mode != VIEW_PREFILTERED && s->diffuse ? OLX_VULKAN_LOBE_DIFFUSE : 0u;
  return diffuse | (s->glossy ? OLX_VULKAN_LOBE_GLOSSY : 0u);
}

// Moves the lamps that have changed since the last image.
static bool move_lights(view_renderer *r, const view_state *s) {
  r->light_moves = !view_lights_same(&r->lights, &s->lights);
  if (!r->light_moves) return true;
  const lamp_settings settings = lamp_settings_default();
  r->lights = s->lights;
  r->shadowed = false;
  if (r->relight) view_relight_lights(r->relight, &s->lights);
  return (view_lights_lamps(&r->content, &s->lights, &settings, r->lamps) || gpu_fail(r->device, "out of memory")) &&
         shadow_pass_change(r->device, r->lamps, &r->raster.shadows);
}

static bool record_relight(view_renderer *r, olx_vec3 eye, VkCommandBuffer commands, view_timings *t) {
  if (!r->relight) return true;
  if (!view_relight_record(r->device, r->relight, eye, commands, &t->relight)) return false;
  r->light_moves |= t->relight.copied_bytes > 0;
  gpu_timer_mark(r->device, &r->timer, commands, "new maps");
  return true;
}

// Returns whether the history of earlier frames is valid for the light of this frame.
static bool history_holds(const view_state *a, const view_state *b) {
  return a->mode == b->mode && denoised_lobes(a) == denoised_lobes(b) && a->select == b->select && a->hits == b->hits &&
         a->visibility == b->visibility && a->keep_buried == b->keep_buried && a->emitters == b->emitters &&
         a->dim_lobe == b->dim_lobe && a->denoise == b->denoise && a->ray_spacing == b->ray_spacing;
}

// Returns whether anything has moved; gathered frames accumulate until then.
static bool has_moved(const view_renderer *r, const view_state *s, const olx_vulkan_view *view) {
  const view_state *before = &r->history_of;
  return !same_view(&r->previous, view) || s->object != before->object ||
         !same_place(s->object_position, before->object_position) || s->object_radius != before->object_radius ||
         s->object_roughness != before->object_roughness || s->object_metallic != before->object_metallic;
}

// Shortens the history while light moves, to the paper's length for glossy light.
static void shorten_memory(olx_lobe_filter *filter) {
  static const float most = 0.75f;
  filter->history = fminf(filter->history, most);
  filter->still_history = fminf(filter->still_history, most);
}

static olx_denoise_settings filters_of(const view_state *s, bool light_moves) {
  if (s->mode != VIEW_GATHER) {
    olx_denoise_settings f = s->denoise == 1 ? olx_denoise_settings_published() : olx_denoise_settings_default();
    f.ray_spacing = s->ray_spacing;
    if (light_moves) shorten_memory(&f.diffuse);
    if (light_moves) shorten_memory(&f.glossy);
    return f;
  }
  olx_denoise_settings mean = olx_denoise_settings_none();
  mean.diffuse.history = mean.diffuse.still_history = 0.999f;
  mean.glossy.history = mean.glossy.still_history = 0.999f;
  return mean;
}

static olx_vulkan_settings settings_of(view_renderer *r, const view_state *s, const olx_vulkan_view *view) {
  olx_vulkan_settings settings = olx_vulkan_settings_default();
  settings.sample.tracer = (olx_tracer)s->tracer;
  settings.sample.select = (olx_select)s->select;
  settings.sample.hits = (olx_hits)s->hits;
  settings.sample.visibility = s->visibility ? OLX_VISIBILITY_CHEBYSHEV : OLX_VISIBILITY_NONE;
  settings.sample.keep_buried = s->keep_buried;
  settings.sample.emitters = view_meets_emitters(s->mode, s->emitters);
  if (s->mode == VIEW_GATHER) settings.diffuse_samples = settings.glossy_samples = s->gather_samples;
  settings.dim_lobe = s->dim_lobe;
  settings.sample_index = r->frame;
  settings.denoise.lobes = denoised_lobes(s);
  if (!settings.denoise.lobes || !history_holds(&r->history_of, s)) r->history = 0;
  if (s->mode == VIEW_GATHER && (r->light_moves || has_moved(r, s, view))) r->history = 0;
  r->history_of = *s;
  settings.denoise.frame = r->history;
  settings.denoise.previous = r->previous;
  settings.denoise.filters = filters_of(s, r->light_moves);
  return settings;
}

static bool record_light(view_renderer *r, const view_state *s, VkCommandBuffer commands, const raster_view *view) {
  const olx_vulkan_settings settings = settings_of(r, s, &view->lit);
  const uint32_t add = (s->diffuse ? OLX_VULKAN_ADD_DIFFUSE : 0u) | (s->glossy ? OLX_VULKAN_ADD_GLOSSY : 0u);
  olx_result result = OLX_OK;
  if (s->diffuse) {
    result = s->mode == VIEW_PREFILTERED ? olx_vulkan_record_irradiance(r->lit, commands, &view->lit, &settings)
                                         : olx_vulkan_record_diffuse(r->lit, commands, &view->lit, &settings);
    gpu_timer_mark(r->device, &r->timer, commands, "diffuse");
  }
  if (result == OLX_OK && s->glossy) {
    result = olx_vulkan_record_glossy(r->lit, commands, &view->lit, &settings);
    gpu_timer_mark(r->device, &r->timer, commands, "glossy");
  }
  if (result == OLX_OK && settings.denoise.lobes) {
    result = olx_vulkan_record_denoise(r->lit, commands, &view->lit, &settings);
    gpu_timer_mark(r->device, &r->timer, commands, s->mode == VIEW_GATHER ? "mean" : "denoiser");
    r->history++;
    r->previous = view->lit;
  }
  if (result == OLX_OK && add) {
    result = olx_vulkan_record_composite(r->lit, commands, &view->lit, &settings, add);
    gpu_timer_mark(r->device, &r->timer, commands, "composite");
  }
  return gpu_check_library(r->device, result);
}

// Records the lit image, in linear light.
static bool record_picture(view_renderer *r, const view_state *s, VkCommandBuffer commands, const view_frame *frame) {
  gpu_device *d = r->device;
  const draw_item items[] = {draw_item_in_place(&r->raster.scene), view_object_place(&r->object, s)};
  const uint32_t count = s->mode == VIEW_PROBES ? 0 : s->object ? 2 : 1;
  if (count > 0) record_shadows(r, s, commands, items, count);
  gpu_timer_mark(d, &r->timer, commands, "shadows");
  gbuffer_pass_record(d, &r->raster.gbuffer, commands, &r->raster.images, frame->view, items, count);
  gpu_timer_mark(d, &r->timer, commands, "surfaces");
  if (s->mode == VIEW_PROBES) {
    r->history = 0;
    view_passes_record_primary(d, &r->passes, commands, frame);
    gpu_timer_mark(d, &r->timer, commands, "eye rays");
    return true;
  }
  const uint32_t lamps = view_meets_emitters(s->mode, s->emitters) ? DIRECT_WITHOUT_EXTENT : DIRECT_LAMPS;
  direct_pass_record(d, &r->raster.direct, commands, &r->raster.images, frame->view,
                     DIRECT_SKY | (s->direct ? lamps : 0u));
  gpu_timer_mark(d, &r->timer, commands, "direct");
  return record_light(r, s, commands, frame->view);
}

// Records the displayed image: tone-mapped, with overlays, at the window's size.
static bool record_screen(view_renderer *r, const view_state *s, VkCommandBuffer commands, const view_frame *frame,
                          view_panel *panel) {
  gpu_device *d = r->device;
  if (s->auto_exposure) view_meter_record(d, &r->meter, commands);
  tone_pass_record(d, &r->raster.tone, commands, &r->raster.images, s->exposure);
  gpu_timer_mark(d, &r->timer, commands, "tone map");
  view_passes_record_overlay(d, &r->passes, commands, frame);
  gpu_timer_mark(d, &r->timer, commands, "overlay");
  view_screen_begin(d, &r->screen, commands, &r->raster.images.images[FRAME_DISPLAY]);
  if (s->overlay >= VIEW_PROBE_INDEX && s->overlay <= VIEW_PROBE_IRRADIANCE)
    view_passes_record_balls(d, &r->passes, commands, frame);
  if (s->overlay == VIEW_MAP) view_passes_record_map(d, &r->passes, commands, frame);
  const bool drawn = !panel || view_panel_record(panel, commands) || gpu_fail(d, "Vulkan refuses the panel");
  view_screen_end(d, commands);
  gpu_timer_mark(d, &r->timer, commands, "screen");
  return drawn;
}

static void read_times(view_renderer *r, view_timings *t) {
  double milliseconds[GPU_TIMER_MARKS];
  const char *names[GPU_TIMER_MARKS];
  const uint32_t count = gpu_timer_read(r->device, &r->timer, milliseconds, names);
  bool same = count == t->pass_count || (count > VIEW_PASSES_MAX && t->pass_count == VIEW_PASSES_MAX);
  for (uint32_t i = 0; same && i < t->pass_count; i++) same = strcmp(names[i], t->names[i]) == 0;
  if (!same) {
    const view_relight_times relight = t->relight;
    *t = (view_timings){.pass_count = count < VIEW_PASSES_MAX ? count : VIEW_PASSES_MAX, .relight = relight};
  }
  const uint32_t at = t->frames++ % VIEW_HISTORY;
  t->total[at] = 0.0f;
  for (uint32_t i = 0; i < t->pass_count; i++) {
    t->names[i] = names[i];
    t->latest[i] = t->history[i][at] = (float)milliseconds[i];
    t->total[at] += t->latest[i];
  }
}

static bool record(view_renderer *r, const view_state *s, const view_frame *frame, const view_output *out,
                   uint32_t image, view_timings *timings) {
  gpu_device *d = r->device;
  if (!gpu_commands_begin(d)) return false;
  gpu_timer_begin(d, &r->timer, d->commands);
  if (!record_relight(r, frame->view->lit.eye, d->commands, timings)) return false;
  if (!record_picture(r, s, d->commands, frame) || !record_screen(r, s, d->commands, frame, out->panel)) return false;
  if (image != UINT32_MAX) view_swapchain_record(d, out->chain, image, d->commands, &r->screen.picture);
  return gpu_commands_run(d);
}

bool view_renderer_draw(view_renderer *r, const view_state *state, const view_camera *camera, const view_output *out,
                        view_timings *timings) {
  gpu_device *d = r->device;
  uint32_t image = UINT32_MAX;
  if (!resize(r, state, out->size) || !make_object(r, state) || !move_lights(r, state) ||
      !view_passes_prepare(d, &r->passes, state))
    return false;
  const olx_camera seen = view_camera_get(camera);
  raster_view view;
  if (!raster_view_make(&seen, r->raster.images.width, r->raster.images.height, r->near_metres, &view)) {
    return gpu_fail(d, "the camera has no view");
  }
  const view_frame frame = {state,        &r->field_info,    &view, &r->raster.images, out->size[0],
                            out->size[1], r->relight != NULL};
  if (out->chain && !view_swapchain_acquire(d, out->chain, &image)) return false;
  if (!record(r, state, &frame, out, image, timings)) return false;
  read_times(r, timings);
  r->frame++;
  if (image != UINT32_MAX && !view_swapchain_show(d, out->chain, image)) return false;
  return !out->screenshot || view_screen_save(d, &r->screen, out->screenshot);
}
