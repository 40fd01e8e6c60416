// The Vulkan functions that the runtime calls, fetched through the host's vkGetInstanceProcAddr.
#ifndef OLX_VULKAN_FUNCTIONS_H
#define OLX_VULKAN_FUNCTIONS_H

#define VK_NO_PROTOTYPES
#include <octalux/vulkan.h>

#define OLX_VULKAN_INSTANCE_FUNCTIONS(X)                                                                               \
  X(GetDeviceProcAddr)                                                                                                 \
  X(GetPhysicalDeviceFormatProperties)                                                                                 \
  X(GetPhysicalDeviceMemoryProperties)                                                                                 \
  X(GetPhysicalDeviceProperties)                                                                                       \
  X(GetPhysicalDeviceQueueFamilyProperties)

#define OLX_VULKAN_DEVICE_FUNCTIONS(X)                                                                                 \
  X(AllocateCommandBuffers)                                                                                            \
  X(AllocateDescriptorSets)                                                                                            \
  X(AllocateMemory)                                                                                                    \
  X(BeginCommandBuffer)                                                                                                \
  X(BindBufferMemory)                                                                                                  \
  X(BindImageMemory)                                                                                                   \
  X(CmdBindDescriptorSets)                                                                                             \
  X(CmdBindPipeline)                                                                                                   \
  X(CmdCopyBuffer)                                                                                                     \
  X(CmdCopyBufferToImage)                                                                                              \
  X(CmdDispatch)                                                                                                       \
  X(CmdPipelineBarrier)                                                                                                \
  X(CmdPushConstants)                                                                                                  \
  X(CmdUpdateBuffer)                                                                                                   \
  X(CreateBuffer)                                                                                                      \
  X(CreateCommandPool)                                                                                                 \
  X(CreateComputePipelines)                                                                                            \
  X(CreateDescriptorPool)                                                                                              \
  X(CreateDescriptorSetLayout)                                                                                         \
  X(CreateFence)                                                                                                       \
  X(CreateImage)                                                                                                       \
  X(CreateImageView)                                                                                                   \
  X(CreatePipelineLayout)                                                                                              \
  X(CreateSampler)                                                                                                     \
  X(CreateShaderModule)                                                                                                \
  X(DestroyBuffer)                                                                                                     \
  X(DestroyCommandPool)                                                                                                \
  X(DestroyDescriptorPool)                                                                                             \
  X(DestroyDescriptorSetLayout)                                                                                        \
  X(DestroyFence)                                                                                                      \
  X(DestroyImage)                                                                                                      \
  X(DestroyImageView)                                                                                                  \
  X(DestroyPipeline)                                                                                                   \
  X(DestroyPipelineLayout)                                                                                             \
  X(DestroySampler)                                                                                                    \
  X(DestroyShaderModule)                                                                                               \
  X(EndCommandBuffer)                                                                                                  \
  X(FreeMemory)                                                                                                        \
  X(GetBufferMemoryRequirements)                                                                                       \
  X(GetImageMemoryRequirements)                                                                                        \
  X(MapMemory)                                                                                                         \
  X(QueueSubmit)                                                                                                       \
  X(ResetFences)                                                                                                       \
  X(UpdateDescriptorSets)                                                                                              \
  X(WaitForFences)

typedef struct olx_vulkan_functions {
#define OLX_DECLARE(name) PFN_vk##name name;
  OLX_VULKAN_INSTANCE_FUNCTIONS(OLX_DECLARE)
  OLX_VULKAN_DEVICE_FUNCTIONS(OLX_DECLARE)
#undef OLX_DECLARE
} olx_vulkan_functions;

#endif
