// A Vulkan device for programs without their own: instance, device and one queue, with or without a window. The
// system's loader is opened at run time, so that no program links Vulkan.
//
// Functions that can fail return false and leave a sentence in device->problem; the object that they were to create is
// then empty. Destroying an empty or partly created object is allowed.
#ifndef OCTALUX_HOST_GPU_DEVICE_H
#define OCTALUX_HOST_GPU_DEVICE_H

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <octalux/vulkan.h>

#include "gpu_functions.h"

typedef struct gpu_device_options {
  bool validate;     // the validation layers check every call, including synchronization, and print to standard error
  bool compute_only; // a queue without graphics suffices
  // Only compiles pipelines: no commands can be run, so that a driver without real hardware suffices.
  bool compile_only;
  uint32_t device;                        // index of the device, as gpu_device_list prints it; UINT32_MAX: the best
  const char *const *instance_extensions; // extensions that the window system requires
  uint32_t instance_extension_count;
  // Creates the window's surface; NULL where there is no window. The device then has VK_KHR_swapchain, and its queue
  // presents to the surface.
  VkResult (*create_surface)(void *user, PFN_vkGetInstanceProcAddr get, VkInstance instance, VkSurfaceKHR *surface);
  void *user;
} gpu_device_options;

typedef struct gpu_device {
  olx_vulkan_host host; // passed to Octalux
  VkSurfaceKHR surface; // the window's surface, or null
  VkPhysicalDeviceProperties properties;
  bool block_textures; // supported, even where host.texture_compression_bc does not use them
  VkPhysicalDeviceDriverProperties driver;
  VkPhysicalDeviceMemoryProperties memory;
  bool anisotropy;              // samplers support anisotropy up to 16
  bool statistics;              // with compile_only: VK_KHR_pipeline_executable_properties is enabled
  double timestamp_nanoseconds; // duration of a tick; 0: the queue has no timestamps
  uint64_t timestamp_mask;      // valid bits of a timestamp
  uint32_t validation_messages; // number of warnings and errors so far
  char problem[512];            // message of the last failed call

  void *loader;
  VkDebugUtilsMessengerEXT messenger;
  VkCommandPool pool;
  VkCommandBuffer commands; // used by gpu_commands_begin
  VkFence fence;
#define GPU_DECLARE(name) PFN_vk##name name;
  GPU_INSTANCE_FUNCTIONS(GPU_DECLARE)
  GPU_SURFACE_FUNCTIONS(GPU_DECLARE)
  GPU_DEVICE_FUNCTIONS(GPU_DECLARE)
  GPU_SWAPCHAIN_FUNCTIONS(GPU_DECLARE)
#undef GPU_DECLARE
} gpu_device;

// Opens a device with Vulkan 1.2 and a queue for graphics and compute (and presentation). On failure nothing has to be
// closed. Requested validation layers must be installed.
bool gpu_device_open(const gpu_device_options *options, gpu_device *device);
void gpu_device_close(gpu_device *device);

// Prints one line per device to standard output: index, name, driver. Opens no device.
bool gpu_device_list(gpu_device *device);

// gpu_fail stores a message, and gpu_fail_result one with the meaning of Vulkan's result; both return false.
bool gpu_fail(gpu_device *device, const char *format, ...) __attribute__((format(printf, 2, 3)));
bool gpu_fail_result(gpu_device *device, VkResult result, const char *what);
// Returns true for success; otherwise stores the message of gpu_fail_result, or the library's last error.
bool gpu_check(gpu_device *device, VkResult result, const char *what);
bool gpu_check_library(gpu_device *device, olx_result result);

// Commands that run once are recorded into device->commands between these two calls. The second submits them and waits
// for completion.
bool gpu_commands_begin(gpu_device *device);
bool gpu_commands_run(gpu_device *device);

#endif
