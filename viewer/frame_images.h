// The images of a frame: the G-buffer that Octalux reads, its outputs, and the displayed image.
//
// Between passes, depth is in VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL; normal, albedo and material are in
// VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL (in which the G-buffer pass leaves them); all others are always in
// VK_IMAGE_LAYOUT_GENERAL.
#ifndef OCTALUX_VIEWER_FRAME_IMAGES_H
#define OCTALUX_VIEWER_FRAME_IMAGES_H

#include "gpu_memory.h"

typedef enum frame_image {
  FRAME_NORMAL = 0, // R16G16B16A16_SFLOAT, world space, towards the eye
  FRAME_ALBEDO,     // R8G8B8A8_SRGB, base colour
  FRAME_MATERIAL,   // R8G8B8A8_UNORM: roughness, metallic, specular weight; alpha 1 where an object has been moved
  FRAME_VERTEX_NORMAL, // R16G16B16A16_SFLOAT, world space, towards the eye, without a normal map
  FRAME_COLOR,      // R16G16B16A16_SFLOAT: linear radiance
  FRAME_DEPTH,      // D32_SFLOAT, reversed
  FRAME_IRRADIANCE, // R16G16B16A16_SFLOAT, written by Octalux
  FRAME_GLOSSY,     // R16G16B16A16_SFLOAT, written by Octalux
  FRAME_DISPLAY,    // R8G8B8A8_UNORM, holding sRGB: storage, color attachment, source of copies and blits, sampled
  FRAME_IMAGES
} frame_image;

enum {
  FRAME_DRAWN = FRAME_DEPTH + 1,
  FRAME_COLORS = FRAME_DEPTH
}; // attachments of the G-buffer pass, and those that are colors

typedef struct frame_images {
  uint32_t width, height;
  gpu_image images[FRAME_IMAGES];
  VkImageView moved; // the alpha of FRAME_MATERIAL, swizzled to red
} frame_images;

// Creates the images and waits for the device, which sets their layouts.
bool frame_images_create(gpu_device *device, uint32_t width, uint32_t height, frame_images *images);
void frame_images_destroy(gpu_device *device, frame_images *images);

VkFormat frame_image_format(frame_image image);

// Returns the targets that olx_vulkan_frame_create takes.
olx_vulkan_targets frame_images_targets(const frame_images *images);

#endif
