// A room of 2 x 2 x 2 metres lit by a field on the device, and the difference of its light from the CPU's light from a
// field.
#ifndef OLX_TESTS_RELIT_ROOM_H
#define OLX_TESTS_RELIT_ROOM_H

#include "tiny_scenes.h"
#include "vulkan_host.h"

typedef struct relit_room {
  host_images images;
  olx_vulkan_field *uploaded;
  olx_vulkan_frame *frame;
} relit_room;

// Makes the room; fails the test when anything fails.
relit_room relit_room_make(gpu_device *device, const olx_field *field);
void relit_room_free(relit_room *room);

// Renders irradiance and glossy light from the field on the device.
void relit_room_render(relit_room *room);
// Computes the relative mean squared errors of irradiance and glossy light against the CPU's light from `lit`.
void relit_room_judge(const relit_room *room, const olx_field *lit, double errors[2]);

#endif
