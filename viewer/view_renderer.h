// A frame of the viewer: surfaces and direct light, Octalux's passes, the viewer's own, the window.
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
  olx_vulkan_frame *lit;                       // the host's side of Octalux's passes; NULL before the first picture
  uint32_t lit_passes;                         // OLX_VULKAN_PASS_*: those that it has
  uint32_t lit_tracers, lit_selects, lit_hits; // that were chosen so far, as olx_vulkan_targets has them
  rasteriser raster;
  gpu_scene object;
  view_screen screen;
  view_passes passes;
  view_meter meter;
  gpu_timer timer;
  float near_metres;
  uint32_t frame; // so far
  // The lights that the lamps and the relighter have.
  olx_scene_content content;
  view_lights lights;
  lamp_list *lamps;
  view_relight *relight; // NULL: indirect light stays as it was baked
  bool light_moves;      // in this picture
  // What the denoiser's history knows.
  uint32_t history; // frames
  view_state history_of;
  olx_vulkan_view previous;
  // What the shadow maps and the object were made for.
  bool shadowed, shadow_of_object;
  olx_vec3 object_position;
  float object_radius, object_roughness, object_metallic;
} view_renderer;

// Upload scene and field, make pipelines and images of the size that is lit. False with a message in device->problem;
// destroy it in either case. It must stay where it is, and what the scene lies in as long.
bool view_renderer_create(gpu_device *device, const olx_scene *scene, const olx_field *field,
                          const uint32_t lit_size[2], view_renderer *renderer);
// Let indirect light follow the lights, as view_relight_create does. `field` is the one that the renderer was made
// with.
bool view_renderer_relight(view_renderer *renderer, const olx_scene *scene, const olx_field *field, bool in_step);
void view_renderer_destroy(view_renderer *renderer);

// How many pixels are lit for a picture of a size.
void view_renderer_lit_size(const view_state *state, const uint32_t size[2], uint32_t lit_size[2]);

// Where a frame goes.
typedef struct view_output {
  uint32_t size[2];       // pixels, each above 0
  view_panel *panel;      // NULL: none is drawn
  view_swapchain *chain;  // NULL: no window
  const char *screenshot; // NULL: none
} view_output;

// Whether all shaders of a state are compiled; else view_renderer_draw compiles them first, which may take seconds.
bool view_renderer_is_ready(const view_renderer *renderer, const view_state *state);

// Draw, show and save a frame, and wait until it is done.
bool view_renderer_draw(view_renderer *renderer, const view_state *state, const view_camera *camera,
                        const view_output *output, view_timings *timings);

#endif
