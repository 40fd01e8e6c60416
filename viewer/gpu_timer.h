// Measures parts of a command buffer in milliseconds by timestamp queries. One timer per frame in flight.
#ifndef OCTALUX_VIEWER_GPU_TIMER_H
#define OCTALUX_VIEWER_GPU_TIMER_H

#include "gpu_device.h"

enum { GPU_TIMER_MARKS = 16 };

typedef struct gpu_timer {
  VkQueryPool pool; // null when the queue has no timestamps, so that every time is 0
  uint32_t marks;
  const char *names[GPU_TIMER_MARKS];
} gpu_timer;

bool gpu_timer_create(gpu_device *device, gpu_timer *timer);
void gpu_timer_destroy(gpu_device *device, gpu_timer *timer);

// Record the beginning, outside a render pass, then a mark at the end of each part; `name` (static text) names the part
// since the previous mark. At most GPU_TIMER_MARKS - 1 parts.
void gpu_timer_begin(const gpu_device *device, gpu_timer *timer, VkCommandBuffer commands);
void gpu_timer_mark(const gpu_device *device, gpu_timer *timer, VkCommandBuffer commands, const char *name);

// Reads the results once the commands have run: part i is called names[i] and took milliseconds[i]. Returns the number
// of parts.
uint32_t gpu_timer_read(gpu_device *device, const gpu_timer *timer, double milliseconds[GPU_TIMER_MARKS],
                        const char *names[GPU_TIMER_MARKS]);

#endif
