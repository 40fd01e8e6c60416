// Runs octalux-view: a window with a scene that a field lights. `octalux view` starts it.
#include "clock.h"
#include "options.h"
#include "view_lights.h"
#include "view_options.h"
#include "view_renderer.h"
#include "view_script.h"
#include "view_window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float SCRIPT_SECONDS = 1.0f / 60.0f; // time step of a frame, so that scripts are reproducible

typedef struct viewer {
  view_options options;
  olx_scene *scene;
  olx_field *field;
  olx_camera *cameras;
  view_script *script;
  view_window window;
  bool compiling; // the window's title reports it
  view_input input;
  gpu_device device;
  view_renderer renderer;
  view_swapchain chain;
  view_panel *panel;
  view_facts facts;
  view_state state;
  view_camera camera;
  view_timings timings;
  view_pick pick;
  uint32_t size[2]; // size of the image when there is no window
  uint32_t frame;
  uint32_t screenshots; // number taken with the key
} viewer;

static bool gpu_failure(const viewer *v) {
  failure("view", "%s", v->device.problem);
  return false;
}

static bool load_cameras(viewer *v) {
  const olx_scene_info info = olx_scene_describe(v->scene);
  v->facts.camera_count = info.cameras > 0 ? info.cameras : 1;
  v->cameras = calloc(v->facts.camera_count, sizeof *v->cameras);
  if (!v->cameras) return failure("view", "out of memory") == EXIT_DONE;
  for (uint32_t i = 0; i < info.cameras; i++) v->cameras[i] = olx_scene_camera(v->scene, i);
  if (info.cameras == 0) olx_scene_find_camera(v->scene, NULL, &v->cameras[0]);
  v->facts.cameras = v->cameras;
  olx_camera first;
  if (olx_scene_find_camera(v->scene, v->options.camera, &first) != OLX_OK) return library_failure("view") == EXIT_DONE;
  for (uint32_t i = v->facts.camera_count; i-- > 0;) {
    if (strcmp(v->cameras[i].name, first.name) == 0) v->state.camera = i;
  }
  v->camera = view_camera_of(&first);
  return true;
}

// Returns a radius of balls that leaves most of the space between probes free.
static float fit_ball(const olx_field_info *field, float diagonal) {
  if (!field->probes.has_grid) return 0.012f * diagonal;
  const float spacing[3] = {field->probes.grid.spacing.x, field->probes.grid.spacing.y, field->probes.grid.spacing.z};
  float least = 0.2f * diagonal;
  for (int axis = 0; axis < 3; axis++) {
    if (field->probes.grid.count[axis] > 1) least = fminf(least, spacing[axis]);
  }
  return 0.07f * least;
}

// Initializes the values that depend on the scene's size.
static void fit_state(viewer *v) {
  const olx_scene_info info = olx_scene_describe(v->scene);
  const olx_vec3 low = info.bounds_min, high = info.bounds_max;
  const float diagonal = hypotf(hypotf(high.x - low.x, high.y - low.y), high.z - low.z);
  view_state *s = &v->state;
  s->speed = 0.15f * diagonal;
  s->probe_radius = fit_ball(&v->facts.field, diagonal);
  s->object_radius = 0.05f * diagonal;
  if (v->options.object) return;
  const olx_camera camera = view_camera_get(&v->camera);
  const float ahead = 0.25f * diagonal;
  s->object_position = (olx_vec3){camera.eye.x + (camera.target.x - camera.eye.x) * ahead,
                                  camera.eye.y + (camera.target.y - camera.eye.y) * ahead,
                                  camera.eye.z + (camera.target.z - camera.eye.z) * ahead};
}

static bool load(viewer *v) {
  const view_options *o = &v->options;
  if (o->script && !(v->script = view_script_open(o->script))) return false;
  if (o->screenshot && !check_output("view", o->screenshot, true)) return false;
  if (olx_field_open(o->field, &v->field) != OLX_OK) return library_failure("view") == EXIT_DONE;
  if (load_scene("view", o->scene, &o->loading, &v->scene) != EXIT_DONE) return false;
  v->facts.field = olx_field_describe(v->field);
  snprintf(v->facts.scene_name, sizeof v->facts.scene_name, "%s", o->scene);
  const olx_sample_settings sample = {.select = (olx_select)v->state.select, .hits = (olx_hits)v->state.hits};
  if (olx_sample_settings_check(v->field, &sample) != OLX_OK) return library_failure("view") == EXIT_DONE;
  if (!view_has_overlay(&v->facts.field, v->state.overlay) && olx_probe_light_check(v->field) != OLX_OK)
    return library_failure("view") == EXIT_DONE;
  if (v->state.select == OLX_SELECT_OCTREE)
    return failure("view", "--select %s does not run on Vulkan", olx_select_name((olx_select)v->state.select)) ==
           EXIT_DONE;
  double origin[3];
  olx_field_origin(v->field, origin);
  if (memcmp(origin, olx_scene_describe(v->scene).origin, sizeof origin) != 0)
    return failure("view", "%s and %s lie elsewhere: bake the field again", o->field, o->scene) == EXIT_DONE;
  if (olx_scene_describe(v->scene).hash != v->facts.field.scene.hash && !o->relight)
    warn("%s was baked from another scene than %s", o->field, o->scene);
  if (!load_cameras(v)) return false;
  const olx_scene_content content = olx_scene_get_content(v->scene);
  v->state.lights = view_lights_of(&content);
  fit_state(v);
  return true;
}

static bool open_panel(viewer *v) {
  gpu_device *d = &v->device;
  v->panel = view_panel_create(&d->host, v->renderer.screen.render_pass, v->window.glfw);
  if (!v->panel) return gpu_fail(d, "Vulkan refuses the panel");
  if (!gpu_commands_begin(d)) return false;
  if (!view_panel_upload(v->panel, d->commands)) return gpu_fail(d, "Vulkan refuses the panel's letters");
  if (!gpu_commands_run(d)) return false;
  view_panel_uploaded(v->panel);
  return true;
}

static bool open_device(viewer *v) {
  const view_options *o = &v->options;
  gpu_device_options options = {.validate = o->validate, .device = UINT32_MAX};
  if (!o->offscreen) {
    if (!view_window_open(o->size[0], o->size[1], &v->input, &v->window)) return false;
    view_window_fill(&v->window, &options);
  }
  if (!gpu_device_open(&options, &v->device)) return gpu_failure(v);
  snprintf(v->facts.device, sizeof v->facts.device, "%s", v->device.properties.deviceName);
  uint32_t lit_size[2];
  view_renderer_lit_size(&v->state, o->size, lit_size);
  if (!view_renderer_create(&v->device, v->scene, v->field, lit_size, &v->renderer) || !open_panel(v))
    return gpu_failure(v);
  // With a script or without a window, frames wait for each other's results, so that images are reproducible.
  const bool in_step = o->offscreen || o->script;
  if (o->relight && !view_renderer_relight(&v->renderer, v->scene, v->field, in_step)) return gpu_failure(v);
  return true;
}

// Releases everything, however much was initialized. Returns false when the validation layers reported something.
static bool close_viewer(viewer *v) {
  if (v->device.host.device) v->device.DeviceWaitIdle(v->device.host.device);
  view_panel_destroy(v->panel);
  view_swapchain_destroy(&v->device, &v->chain);
  view_renderer_destroy(&v->renderer);
  gpu_device_close(&v->device);
  view_window_close(&v->window);
  view_script_free(v->script);
  free(v->cameras);
  olx_field_close(v->field);
  olx_scene_free(v->scene);
  return v->device.validation_messages == 0;
}

static void current_size(const viewer *v, uint32_t size[2]) {
  if (v->window.glfw) view_window_size(&v->window, size);
  else memcpy(size, v->size, sizeof v->size);
}

static void set_size(viewer *v, const uint32_t size[2]) {
  if (v->window.glfw) view_window_resize(&v->window, size);
  else memcpy(v->size, size, sizeof v->size);
}

// Handles events of the user and the script. *screenshot: the file to write this frame, or NULL. Returns false when the
// program should end.
static bool take_input(viewer *v, float seconds, const char **screenshot) {
  bool go_on = !v->window.glfw || view_window_poll(&v->window);
  if (v->script) {
    uint32_t size[2];
    view_script_wishes wishes;
    current_size(v, size);
    if (!view_script_step(v->script, size, &v->input, &wishes) || wishes.quit) go_on = false;
    if (wishes.resize) set_size(v, wishes.size);
    *screenshot = wishes.screenshot;
  }
  view_panel_takes(v->panel, &v->window.mouse_taken, &v->window.keys_taken);
  view_input_apply(&v->input, seconds, &v->facts, &v->state, &v->camera);
  return go_on && !v->state.quit;
}

static bool refresh_swapchain(viewer *v, const uint32_t size[2]) {
  if (!v->window.glfw) return true;
  const bool fits = v->chain.swapchain && !v->chain.stale && v->chain.width == size[0] && v->chain.height == size[1];
  return fits || view_swapchain_create(&v->device, size[0], size[1], !v->options.no_wait, &v->chain);
}

// Shows in the window's title that shaders are being compiled.
static void tell_compiling(viewer *v, const view_state *shown, bool begins) {
  static const char message[] = "compiling shaders ...";
  if (!v->window.glfw || (begins && view_renderer_is_ready(&v->renderer, shown))) return;
  if (begins) fprintf(stderr, "%s\n", message);
  if (begins || v->compiling) view_window_tell(&v->window, begins ? message : NULL);
  v->compiling = begins;
}

static bool draw(viewer *v, const uint32_t size[2], float seconds, const char *screenshot) {
  char name[64];
  if (v->state.take_screenshot && !screenshot) {
    snprintf(name, sizeof name, "octalux-%03u.png", ++v->screenshots);
    screenshot = name;
  }
  v->state.take_screenshot = false;
  // A screenshot shows the panel only when an option says so.
  view_state shown = v->state;
  if (screenshot && !v->options.panel) shown.panel = false;
  const bool hidden = shown.panel != v->state.panel;
  view_panel_build(v->panel, size, seconds, &v->facts, &v->timings, &v->pick, &shown, &v->camera);
  tell_compiling(v, &shown, true);
  const view_output output = {{size[0], size[1]}, v->panel, v->window.glfw ? &v->chain : NULL, screenshot};
  if (!refresh_swapchain(v, size) || !view_renderer_draw(&v->renderer, &shown, &v->camera, &output, &v->timings))
    return gpu_failure(v);
  tell_compiling(v, &shown, false);
  if (hidden) shown.panel = v->state.panel;
  v->state = shown;
  // The first image sets the exposure at once; later it adapts gradually.
  if (v->state.auto_exposure)
    v->state.exposure = view_meter_follow(&v->renderer.meter, v->state.exposure, v->frame ? seconds : INFINITY);
  if (v->state.picked) v->pick = view_passes_read_pick(&v->renderer.passes);
  if (screenshot) fprintf(stderr, "%s\n", screenshot);
  return true;
}

// Draws frames until the program should end. Where --screenshot asks for the last frame, one follows the input that
// ends the program.
static bool run(viewer *v) {
  const view_options *o = &v->options;
  double before = clock_seconds(CLOCK_MONOTONIC);
  for (bool last = false; !last; v->frame++) {
    const double at = clock_seconds(CLOCK_MONOTONIC);
    const float seconds = v->script ? SCRIPT_SECONDS : (float)fmin(at - before, 0.1);
    before = at;
    const char *screenshot = NULL;
    const bool ended = !take_input(v, seconds, &screenshot);
    if (ended && !o->screenshot) return true;
    last = ended || v->frame + 1 == o->frames;
    if (last && o->screenshot) screenshot = o->screenshot;
    uint32_t size[2];
    current_size(v, size);
    const bool visible = size[0] > 0 && size[1] > 0;
    if (visible && !draw(v, size, seconds, screenshot)) return false;
    if (!visible && screenshot) return failure("view", "%s: the frame has no pixels", screenshot) == EXIT_DONE;
  }
  return true;
}

int main(int argc, char **argv) {
  viewer v = {.frame = 0};
  int code;
  if (!view_options_read(argc, argv, &v.options, &code)) return code;
  v.state = v.options.state;
  memcpy(v.size, v.options.size, sizeof v.size);
  bool fine = load(&v) && open_device(&v) && run(&v);
  if (!close_viewer(&v)) fine = failure("view", "%u validation messages", v.device.validation_messages) == EXIT_DONE;
  return fine ? EXIT_DONE : EXIT_FAILED;
}
