// A window that reports events and that Vulkan can present to.
#ifndef OCTALUX_VIEW_WINDOW_H
#define OCTALUX_VIEW_WINDOW_H

#include "gpu_device.h"
#include "view_input.h"

typedef struct GLFWwindow GLFWwindow;

typedef struct view_window {
  GLFWwindow *glfw;
  view_input *input;
  bool mouse_taken, keys_taken; // captured by the panel: set each frame
  bool minimised;               // simulated by a script
  bool dragging;
  double drag_x, drag_y;
} view_window;

// Opens a window. Returns false, with one line on standard error, when there is no display or none that Vulkan
// supports. `window` must not be moved.
bool view_window_open(uint32_t width, uint32_t height, view_input *input, view_window *window);
void view_window_close(view_window *window);

// Fills the options that gpu_device_open needs to present to the window.
void view_window_fill(view_window *window, gpu_device_options *options);

// Handles pending events; waits briefly when the window is minimised. Returns false once the window should close.
bool view_window_poll(view_window *window);

// Sets the text after the program's name in the window's title; NULL: none.
void view_window_tell(view_window *window, const char *message);

// Gets the size in pixels; 0 x 0 when minimised.
void view_window_size(const view_window *window, uint32_t size[2]);
void view_window_resize(view_window *window, const uint32_t size[2]);

#endif
