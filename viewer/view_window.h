// A window that reports what happens to it as events, and that Vulkan can present to.
#ifndef OCTALUX_VIEW_WINDOW_H
#define OCTALUX_VIEW_WINDOW_H

#include "gpu_device.h"
#include "view_input.h"

typedef struct GLFWwindow GLFWwindow;

typedef struct view_window {
  GLFWwindow *glfw;
  view_input *input;
  bool mouse_taken, keys_taken; // by the panel: set each frame
  bool minimised;               // by a script
  bool dragging;
  double drag_x, drag_y;
} view_window;

// False, with one line on standard error, when there is no display or none for Vulkan. `window` must stay where it is.
bool view_window_open(uint32_t width, uint32_t height, view_input *input, view_window *window);
void view_window_close(view_window *window);

// What gpu_device_open needs to show on it.
void view_window_fill(view_window *window, gpu_device_options *options);

// Take what has happened; when the window is minimised, wait for a moment. False once it should close.
bool view_window_poll(view_window *window);

// What the window's title says after the program's name; NULL: nothing.
void view_window_tell(view_window *window, const char *message);

// In pixels; 0 x 0 when minimised.
void view_window_size(const view_window *window, uint32_t size[2]);
void view_window_resize(view_window *window, const uint32_t size[2]);

#endif
