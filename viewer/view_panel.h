// The panel over the picture: what the state holds, to be changed by hand, and what passes took. Dear ImGui behind a C
// face.
#ifndef OCTALUX_VIEW_PANEL_H
#define OCTALUX_VIEW_PANEL_H

#include "view_camera.h"
#include "view_state.h"

#include <octalux/vulkan.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct view_panel view_panel;
typedef struct GLFWwindow GLFWwindow;

// `window` may be NULL: then there is no input. NULL when there is no memory or Vulkan refuses.
view_panel *view_panel_create(const olx_vulkan_host *host, VkRenderPass render_pass, GLFWwindow *window);
// Nothing that draws it may be pending. NULL is allowed.
void view_panel_destroy(view_panel *panel);

// Once, before the first frame: record the upload of its letters; then, when the commands have run, drop what it took.
bool view_panel_upload(view_panel *panel, VkCommandBuffer commands);
void view_panel_uploaded(view_panel *panel);

// Whether the mouse or the keyboard is the panel's now.
void view_panel_takes(const view_panel *panel, bool *mouse, bool *keys);

// Lay out the panel of a frame; the state and the camera may change.
void view_panel_build(view_panel *panel, const uint32_t size[2], float seconds, const view_facts *facts,
                      const view_timings *timings, const view_pick *pick, view_state *state, view_camera *camera);
// Draw what was laid out, inside a render pass. False when Vulkan refused something.
bool view_panel_record(view_panel *panel, VkCommandBuffer commands);

#ifdef __cplusplus
}
#endif

#endif
