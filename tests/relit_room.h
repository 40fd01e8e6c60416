// A room of 2 x 2 x 2 metres lit by a field on the device, and how far its light is from what the CPU makes of a field.
#ifndef OLX_TESTS_RELIT_ROOM_H
#define OLX_TESTS_RELIT_ROOM_H

#include "tiny_scenes.h"
#include "vulkan_host.h"

typedef struct relit_room {
  host_images images;
  olx_vulkan_field *uploaded;
  olx_vulkan_frame *frame;
} relit_room;

// Asserts that nothing fails.
relit_room relit_room_make(gpu_device *device, const olx_field *field);
void relit_room_free(relit_room *room);

// Irradiance and glossy light, from the field on the device.
void relit_room_render(relit_room *room);
// Relative mean squared errors of irradiance and glossy light against what the CPU makes of a field.
void relit_room_judge(const relit_room *room, const olx_field *lit, double errors[2]);

#endif
