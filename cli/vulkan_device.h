// A Vulkan device for programs without one of their own: opened through the system's loader, found at run time, so that
// nothing links Vulkan. Images and one-time commands for headless work.
#ifndef OCTALUX_CLI_VULKAN_DEVICE_H
#define OCTALUX_CLI_VULKAN_DEVICE_H

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <octalux/vulkan.h>

#define DEVICE_FUNCTIONS(X)                                                                                            \
  X(AllocateCommandBuffers)                                                                                            \
  X(AllocateDescriptorSets)                                                                                            \
  X(AllocateMemory)                                                                                                    \
  X(BeginCommandBuffer)                                                                                                \
  X(BindBufferMemory)                                                                                                  \
  X(BindImageMemory)                                                                                                   \
  X(CmdBindDescriptorSets)                                                                                             \
  X(CmdBindPipeline)                                                                                                   \
  X(CmdClearColorImage)                                                                                                \
  X(CmdCopyBufferToImage)                                                                                              \
  X(CmdCopyImageToBuffer)                                                                                              \
  X(CmdDispatch)                                                                                                       \
  X(CmdPipelineBarrier)                                                                                                \
  X(CmdPushConstants)                                                                                                  \
  X(CreateBuffer)                                                                                                      \
  X(CreateCommandPool)                                                                                                 \
  X(CreateComputePipelines)                                                                                            \
  X(CreateDescriptorPool)                                                                                              \
  X(CreateDescriptorSetLayout)                                                                                         \
  X(CreateFence)                                                                                                       \
  X(CreateImage)                                                                                                       \
  X(CreateImageView)                                                                                                   \
  X(CreatePipelineLayout)                                                                                              \
  X(CreateShaderModule)                                                                                                \
  X(DestroyBuffer)                                                                                                     \
  X(DestroyCommandPool)                                                                                                \
  X(DestroyDescriptorPool)                                                                                             \
  X(DestroyDescriptorSetLayout)                                                                                        \
  X(DestroyDevice)                                                                                                     \
  X(DestroyFence)                                                                                                      \
  X(DestroyImage)                                                                                                      \
  X(DestroyImageView)                                                                                                  \
  X(DestroyPipeline)                                                                                                   \
  X(DestroyPipelineLayout)                                                                                             \
  X(DestroyShaderModule)                                                                                               \
  X(EndCommandBuffer)                                                                                                  \
  X(FreeMemory)                                                                                                        \
  X(GetBufferMemoryRequirements)                                                                                       \
  X(GetDeviceQueue)                                                                                                    \
  X(GetImageMemoryRequirements)                                                                                        \
  X(MapMemory)                                                                                                         \
  X(QueueSubmit)                                                                                                       \
  X(ResetCommandPool)                                                                                                  \
  X(ResetFences)                                                                                                       \
  X(UpdateDescriptorSets)                                                                                              \
  X(WaitForFences)

#define INSTANCE_FUNCTIONS(X)                                                                                          \
  X(CreateDevice)                                                                                                      \
  X(DestroyInstance)                                                                                                   \
  X(EnumeratePhysicalDevices)                                                                                          \
  X(GetDeviceProcAddr)                                                                                                 \
  X(GetPhysicalDeviceMemoryProperties)                                                                                 \
  X(GetPhysicalDeviceProperties)                                                                                       \
  X(GetPhysicalDeviceQueueFamilyProperties)

typedef struct vulkan_device {
  olx_vulkan_host host; // what Octalux is given
  char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
  uint32_t validation_messages; // warnings and errors so far, when validation was asked for

  void *loader;
  VkDebugUtilsMessengerEXT messenger;
  VkPhysicalDeviceMemoryProperties memory;
  VkCommandPool pool;
  VkCommandBuffer commands;
  VkFence fence;
#define DECLARE(name) PFN_vk##name name;
  INSTANCE_FUNCTIONS(DECLARE)
  DEVICE_FUNCTIONS(DECLARE)
#undef DECLARE
} vulkan_device;

// Open the best device that Octalux can use, a discrete GPU before others. NULL, or what is missing; then nothing is
// left to close. With `validate`, the validation layers check every call (synchronisation too) and print to standard
// error; it is an error when they are not installed.
const char *vulkan_device_open(vulkan_device *device, bool validate);
void vulkan_device_close(vulkan_device *device);

// Memory that both sides see.
typedef struct shared_buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
  void *mapped;
} shared_buffer;

// The results below are Vulkan's; destroying what was not created, or only half, is allowed.
VkResult shared_buffer_create(vulkan_device *device, VkDeviceSize bytes, VkBufferUsageFlags usage,
                              shared_buffer *buffer);
void shared_buffer_destroy(vulkan_device *device, shared_buffer *buffer);

typedef struct device_image {
  VkImage image;
  VkImageView view;
  VkDeviceMemory memory;
  VkFormat format;
} device_image;

VkResult device_image_create(vulkan_device *device, uint32_t width, uint32_t height, VkFormat format,
                             VkImageUsageFlags usage, device_image *image);
void device_image_destroy(vulkan_device *device, device_image *image);

// Record into device->commands between these; the second submits and waits.
VkResult device_commands_begin(vulkan_device *device);
VkResult device_commands_run(vulkan_device *device);
// A barrier for everything, and a change of layout of one image where it is not NULL.
void device_barrier(vulkan_device *device, const device_image *image, VkImageLayout from, VkImageLayout to);

#endif
