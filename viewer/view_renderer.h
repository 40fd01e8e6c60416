// Renders a frame of the viewer: surfaces and direct light, Octalux's passes, the viewer's own, the window.
#ifndef OCTALUX_VIEW_RENDERER_H
#define OCTALUX_VIEW_RENDERER_H

#include "gpu_timer.h"
#include "rasteriser.h"
#include "view_camera.h"
#include "view_lights.h"
#include "view_meter.h"
#include "view_panel.h"
#include "view_passes.h"
#include "view_relight.h"
#include "view_screen.h"
#include "view_swapchain.h"

typedef struct view_renderer {
  gpu_device *device;
  olx_field_info field_info;
  olx_vulkan_field *field;
  olx_vulkan_frame *lit;                       // the host's side of Octalux's passes; NULL before the first image
  uint32_t lit_passes;                         // OLX_VULKAN_PASS_* of `lit`
  uint32_t lit_tracers, lit_selects, lit_hits; // all choices so far, as in olx_vulkan_targets
  rasteriser raster;
  gpu_scene object;
  view_screen screen;
  view_passes passes;
  view_meter meter;
  gpu_timer timer;
  float near_metres;
  uint32_t frame; // number of frames so far
  // The current lights of the lamps and the relighter.
  olx_scene_content content;
  view_lights lights;
  lamp_list *lamps;
  view_relight *relight; // NULL: indirect light stays as baked
  bool light_moves;      // whether a light moves in this image
  // The state that the denoiser's history is valid for.
  uint32_t history; // length in frames
  view_state history_of;
  olx_vulkan_view previous;
  // The state for which the shadow maps and the object were created.
  bool shadowed, shadow_of_object;
  olx_vec3 object_position;
  float object_radius, object_roughness, object_metallic;
} view_renderer;

// Uploads scene and field, and creates pipelines and images of the lit size. Returns false with a message in
// device->problem; must be destroyed in either case. It must not be moved, and the scene's memory must outlive it.
bool view_renderer_create(gpu_device *device, const olx_scene *scene, const olx_field *field,
                          const uint32_t lit_size[2], view_renderer *renderer);
// Starts relighting, like view_relight_create. `field` is the one that the renderer was created with.
bool view_renderer_relight(view_renderer *renderer, const olx_scene *scene, const olx_field *field, bool in_step);
void view_renderer_destroy(view_renderer *renderer);

// Computes the number of pixels that are lit for an image of a size.
void view_renderer_lit_size(const view_state *state, const uint32_t size[2], uint32_t lit_size[2]);

// The destination of a frame.
typedef struct view_output {
  uint32_t size[2];       // pixels, each above 0
  view_panel *panel;      // NULL: no panel
  view_swapchain *chain;  // NULL: no window
  const char *screenshot; // NULL: none
} view_output;

// Returns whether all shaders of a state are compiled; otherwise view_renderer_draw compiles them first, which may take
// seconds.
bool view_renderer_is_ready(const view_renderer *renderer, const view_state *state);

// Draws, shows and saves a frame, and waits until it is done.
bool view_renderer_draw(view_renderer *renderer, const view_state *state, const view_camera *camera,
                        const view_output *output, view_timings *timings);

#endif
