// Measures the time of parts of a command buffer by timestamp queries.
#include "gpu_timer.h"

bool gpu_timer_create(gpu_device *d, gpu_timer *timer) {
  *timer = (gpu_timer){.marks = 0};
  if (!(d->timestamp_nanoseconds > 0.0)) return true;
  const VkQueryPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                      .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                      .queryCount = GPU_TIMER_MARKS};
  return gpu_check(d, d->CreateQueryPool(d->host.device, &info, NULL, &timer->pool), "timestamp queries");
}

void gpu_timer_destroy(gpu_device *d, gpu_timer *timer) {
  if (timer->pool) d->DestroyQueryPool(d->host.device, timer->pool, NULL);
  *timer = (gpu_timer){.marks = 0};
}

static void write_mark(const gpu_device *d, gpu_timer *timer, VkCommandBuffer commands, const char *name) {
  if (timer->marks >= GPU_TIMER_MARKS) return;
  timer->names[timer->marks] = name;
  if (timer->pool) {
    d->CmdWriteTimestamp(commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, timer->pool, timer->marks);
  }
  timer->marks++;
}

void gpu_timer_begin(const gpu_device *d, gpu_timer *timer, VkCommandBuffer commands) {
  timer->marks = 0;
  if (timer->pool) d->CmdResetQueryPool(commands, timer->pool, 0, GPU_TIMER_MARKS);
  write_mark(d, timer, commands, "");
}

void gpu_timer_mark(const gpu_device *d, gpu_timer *timer, VkCommandBuffer commands, const char *name) {
  write_mark(d, timer, commands, name);
}

uint32_t gpu_timer_read(gpu_device *d, const gpu_timer *timer, double milliseconds[GPU_TIMER_MARKS],
                        const char *names[GPU_TIMER_MARKS]) {
  if (timer->marks == 0) return 0;
  uint64_t ticks[GPU_TIMER_MARKS] = {0};
  if (timer->pool) {
    d->GetQueryPoolResults(d->host.device, timer->pool, 0, timer->marks, sizeof ticks, ticks, sizeof ticks[0],
                           VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
  }
  for (uint32_t i = 1; i < timer->marks; i++) {
    const uint64_t passed = (ticks[i] - ticks[i - 1]) & d->timestamp_mask;
    milliseconds[i - 1] = (double)passed * d->timestamp_nanoseconds * 1e-6;
    names[i - 1] = timer->names[i];
  }
  return timer->marks - 1;
}
