// A Vulkan device for programs without one of their own: instance, device and one queue, opened through the system's
// loader, which is found at run time, so that nothing links Vulkan. With a window or without.
//
// Functions that can fail return false and leave a sentence in device->problem; what they were to create is then empty.
// Destroying what is empty, or only half made, is allowed.
#ifndef OCTALUX_HOST_GPU_DEVICE_H
#define OCTALUX_HOST_GPU_DEVICE_H

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <octalux/vulkan.h>

#include "gpu_functions.h"

typedef struct gpu_device_options {
  bool validate;     // the validation layers check every call, synchronisation too, and print to standard error
  bool compute_only; // a queue without graphics will do
  // For making pipelines alone: no commands can be run, so that a driver's device that does not exist will do.
  bool compile_only;
  uint32_t device; // which of the machine's devices, as gpu_device_list counts them; UINT32_MAX: the best
  const char *const *instance_extensions; // that the window system asks for
  uint32_t instance_extension_count;
  // Make the window's surface; NULL: no window. The device then has VK_KHR_swapchain, and its queue presents to the
  // surface.
  VkResult (*create_surface)(void *user, PFN_vkGetInstanceProcAddr get, VkInstance instance, VkSurfaceKHR *surface);
  void *user;
} gpu_device_options;

typedef struct gpu_device {
  olx_vulkan_host host; // what Octalux is given
  VkSurfaceKHR surface; // the window's, or null
  VkPhysicalDeviceProperties properties;
  bool block_textures; // they can be made, even where host.texture_compression_bc leaves them unused
  VkPhysicalDeviceDriverProperties driver;
  VkPhysicalDeviceMemoryProperties memory;
  bool anisotropy;              // samplers may be anisotropic, up to 16
  bool statistics;              // with compile_only: VK_KHR_pipeline_executable_properties is there and on
  double timestamp_nanoseconds; // of one tick; 0: the queue has no timestamps
  uint64_t timestamp_mask;      // the bits that count
  uint32_t validation_messages; // warnings and errors so far
  char problem[512];            // of the last call that failed

  void *loader;
  VkDebugUtilsMessengerEXT messenger;
  VkCommandPool pool;
  VkCommandBuffer commands; // for gpu_commands_begin
  VkFence fence;
#define GPU_DECLARE(name) PFN_vk##name name;
  GPU_INSTANCE_FUNCTIONS(GPU_DECLARE)
  GPU_SURFACE_FUNCTIONS(GPU_DECLARE)
  GPU_DEVICE_FUNCTIONS(GPU_DECLARE)
  GPU_SWAPCHAIN_FUNCTIONS(GPU_DECLARE)
#undef GPU_DECLARE
} gpu_device;

// Needs Vulkan 1.2 and a queue with graphics and compute (and presentation). On failure nothing is left to close.
// Validation layers that are asked for must be installed.
bool gpu_device_open(const gpu_device_options *options, gpu_device *device);
void gpu_device_close(gpu_device *device);

// One line a device to standard output: number, name, driver. Opens none.
bool gpu_device_list(gpu_device *device);

// Keep a message; returns false. The second adds what Vulkan's result means.
bool gpu_fail(gpu_device *device, const char *format, ...) __attribute__((format(printf, 2, 3)));
bool gpu_fail_result(gpu_device *device, VkResult result, const char *what);
// True for success; else the message is gpu_fail_result's, or the library's last error.
bool gpu_check(gpu_device *device, VkResult result, const char *what);
bool gpu_check_library(gpu_device *device, olx_result result);

// Commands that run once: record into device->commands between these; the second submits and waits until they have run.
bool gpu_commands_begin(gpu_device *device);
bool gpu_commands_run(gpu_device *device);

#endif
