// The image at the window's size, with or without a window: the lit image is scaled into it; balls, a map and the panel
// are drawn over it; it is shown or saved.
#ifndef OCTALUX_VIEW_SCREEN_H
#define OCTALUX_VIEW_SCREEN_H

#include "frame_images.h"

typedef struct view_screen {
  VkRenderPass render_pass;
  gpu_image picture; // R8G8B8A8_UNORM that holds sRGB
  gpu_image depth;   // depth image for the balls
  VkFramebuffer framebuffer;
} view_screen;

bool view_screen_create(gpu_device *device, view_screen *screen); // creates the screen without an image
bool view_screen_resize(gpu_device *device, uint32_t width, uint32_t height, view_screen *screen);
void view_screen_destroy(gpu_device *device, view_screen *screen);

// Record the beginning, with the lit image, and the end, with an image in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL. Between
// them a render pass with one color and one reversed depth attachment is active.
void view_screen_begin(const gpu_device *device, const view_screen *screen, VkCommandBuffer commands,
                       const gpu_image *display);
void view_screen_end(const gpu_device *device, VkCommandBuffer commands);

// Saves the image as a .png, once the commands have run.
bool view_screen_save(gpu_device *device, const view_screen *screen, const char *path);

#endif
