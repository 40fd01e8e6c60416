// Opens a window, converts its events to the viewer's, and provides a surface for Vulkan.
#include "view_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <stdio.h>

static int key_of(int key) {
  if (key >= GLFW_KEY_SPACE && key <= GLFW_KEY_GRAVE_ACCENT) return key; // ASCII
  switch (key) {
  case GLFW_KEY_LEFT_SHIFT:
  case GLFW_KEY_RIGHT_SHIFT: return VIEW_KEY_SHIFT;
  case GLFW_KEY_LEFT_CONTROL:
  case GLFW_KEY_RIGHT_CONTROL: return VIEW_KEY_CONTROL;
  case GLFW_KEY_TAB: return VIEW_KEY_TAB;
  case GLFW_KEY_ESCAPE: return VIEW_KEY_ESCAPE;
  case GLFW_KEY_UP: return VIEW_KEY_UP;
  case GLFW_KEY_DOWN: return VIEW_KEY_DOWN;
  case GLFW_KEY_LEFT: return VIEW_KEY_LEFT;
  case GLFW_KEY_RIGHT: return VIEW_KEY_RIGHT;
  case GLFW_KEY_PAGE_UP: return VIEW_KEY_PAGE_UP;
  case GLFW_KEY_PAGE_DOWN: return VIEW_KEY_PAGE_DOWN;
  case GLFW_KEY_F12: return VIEW_KEY_F12;
  case GLFW_KEY_KP_ADD: return '=';
  case GLFW_KEY_KP_SUBTRACT: return '-';
  default: return 0;
  }
}

static view_window *window_of(GLFWwindow *glfw) { return glfwGetWindowUserPointer(glfw); }

static void push(view_window *window, view_event_kind kind, int key, double x, double y) {
  view_input_push(window->input, (view_event){.kind = kind, .key = key, .x = (float)x, .y = (float)y});
}

static void on_key(GLFWwindow *glfw, int code, int scan, int action, int modifiers) {
  (void)scan, (void)modifiers;
  view_window *window = window_of(glfw);
  const int key = key_of(code);
  if (!key || action == GLFW_REPEAT || (window->keys_taken && action == GLFW_PRESS)) return;
  push(window, action == GLFW_PRESS ? VIEW_EVENT_PRESS : VIEW_EVENT_RELEASE, key, 0, 0);
}

static void on_button(GLFWwindow *glfw, int button, int action, int modifiers) {
  (void)modifiers;
  view_window *window = window_of(glfw);
  if (button == GLFW_MOUSE_BUTTON_RIGHT) {
    window->dragging = action == GLFW_PRESS && !window->mouse_taken;
    glfwSetInputMode(glfw, GLFW_CURSOR, window->dragging ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    glfwGetCursorPos(glfw, &window->drag_x, &window->drag_y);
  }
  if (button != GLFW_MOUSE_BUTTON_LEFT || action != GLFW_PRESS || window->mouse_taken) return;
  double x, y;
  int width, height;
  glfwGetCursorPos(glfw, &x, &y);
  glfwGetWindowSize(glfw, &width, &height);
  if (width > 0 && height > 0) push(window, VIEW_EVENT_CLICK, 0, x / width, y / height);
}

static void on_move(GLFWwindow *glfw, double x, double y) {
  view_window *window = window_of(glfw);
  if (!window->dragging) return;
  push(window, VIEW_EVENT_LOOK, 0, x - window->drag_x, y - window->drag_y);
  window->drag_x = x;
  window->drag_y = y;
}

static void on_scroll(GLFWwindow *glfw, double x, double y) {
  (void)x;
  view_window *window = window_of(glfw);
  if (!window->mouse_taken) push(window, VIEW_EVENT_WHEEL, 0, 0, y);
}

static void on_focus(GLFWwindow *glfw, int focused) {
  if (!focused) push(window_of(glfw), VIEW_EVENT_FORGET, 0, 0, 0);
}

static bool refuse(const char *what) {
  const char *reason = NULL;
  glfwGetError(&reason);
  fprintf(stderr, "octalux view: %s%s%s; --offscreen needs no display\n", what, reason ? ": " : "",
          reason ? reason : "");
  glfwTerminate();
  return false;
}

bool view_window_open(uint32_t width, uint32_t height, view_input *input, view_window *window) {
  *window = (view_window){.input = input};
  if (!glfwInit()) return refuse("there is no display");
  if (!glfwVulkanSupported()) return refuse("the display cannot show what Vulkan draws");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  window->glfw = glfwCreateWindow((int)width, (int)height, "Octalux", NULL, NULL);
  if (!window->glfw) return refuse("no window can be opened");
  glfwSetWindowUserPointer(window->glfw, window);
  glfwSetKeyCallback(window->glfw, on_key);
  glfwSetMouseButtonCallback(window->glfw, on_button);
  glfwSetCursorPosCallback(window->glfw, on_move);
  glfwSetScrollCallback(window->glfw, on_scroll);
  glfwSetWindowFocusCallback(window->glfw, on_focus);
  return true;
}

void view_window_close(view_window *window) {
  if (!window->glfw) return;
  glfwDestroyWindow(window->glfw);
  glfwTerminate();
  window->glfw = NULL;
}

static VkResult create_surface(void *user, PFN_vkGetInstanceProcAddr get, VkInstance instance, VkSurfaceKHR *surface) {
  (void)get;
  const view_window *window = user;
  return glfwCreateWindowSurface(instance, window->glfw, NULL, surface);
}

void view_window_fill(view_window *window, gpu_device_options *options) {
  options->instance_extensions = glfwGetRequiredInstanceExtensions(&options->instance_extension_count);
  options->create_surface = create_surface;
  options->user = window;
}

void view_window_tell(view_window *window, const char *message) {
  char title[128];
  snprintf(title, sizeof title, "Octalux%s%s", message ? ": " : "", message ? message : "");
  glfwSetWindowTitle(window->glfw, title);
}

bool view_window_poll(view_window *window) {
  int width, height;
  glfwGetFramebufferSize(window->glfw, &width, &height);
  if (width > 0 && height > 0) glfwPollEvents();
  else glfwWaitEventsTimeout(0.1);
  return !glfwWindowShouldClose(window->glfw);
}

void view_window_size(const view_window *window, uint32_t size[2]) {
  int width = 0, height = 0;
  if (!window->minimised) glfwGetFramebufferSize(window->glfw, &width, &height);
  size[0] = (uint32_t)width;
  size[1] = (uint32_t)height;
}

void view_window_resize(view_window *window, const uint32_t size[2]) {
  window->minimised = size[0] == 0 || size[1] == 0;
  if (!window->minimised) glfwSetWindowSize(window->glfw, (int)size[0], (int)size[1]);
}
