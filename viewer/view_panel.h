// The panel over the image: controls for the state, and the times of passes. A C interface to Dear ImGui.
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

// Creates the panel. `window` may be NULL for no input. Returns NULL when memory runs out or Vulkan fails.
view_panel *view_panel_create(const olx_vulkan_host *host, VkRenderPass render_pass, GLFWwindow *window);
// Destroys the panel, which no pending work may draw. NULL is allowed.
void view_panel_destroy(view_panel *panel);

// Called twice before the first frame: first records the upload of its letters; then, when the commands have run, frees
// the staging memory.
bool view_panel_upload(view_panel *panel, VkCommandBuffer commands);
void view_panel_uploaded(view_panel *panel);

// Reports whether the panel currently captures the mouse or the keyboard.
void view_panel_takes(const view_panel *panel, bool *mouse, bool *keys);

// Lays out the panel of a frame; the state and the camera may change.
void view_panel_build(view_panel *panel, const uint32_t size[2], float seconds, const view_facts *facts,
                      const view_timings *timings, const view_pick *pick, view_state *state, view_camera *camera);
// Draws the layout, inside a render pass. Returns false when Vulkan failed.
bool view_panel_record(view_panel *panel, VkCommandBuffer commands);

#ifdef __cplusplus
}
#endif

#endif
