// The Vulkan functions that programs call, as lists for tables of pointers.
#ifndef OCTALUX_HOST_GPU_FUNCTIONS_H
#define OCTALUX_HOST_GPU_FUNCTIONS_H

// Functions of the instance.
#define GPU_INSTANCE_FUNCTIONS(X)                                                                                      \
  X(CreateDevice)                                                                                                      \
  X(DestroyInstance)                                                                                                   \
  X(EnumerateDeviceExtensionProperties)                                                                                \
  X(EnumeratePhysicalDevices)                                                                                          \
  X(GetDeviceProcAddr)                                                                                                 \
  X(GetPhysicalDeviceFeatures)                                                                                         \
  X(GetPhysicalDeviceFormatProperties)                                                                                 \
  X(GetPhysicalDeviceMemoryProperties)                                                                                 \
  X(GetPhysicalDeviceProperties)                                                                                       \
  X(GetPhysicalDeviceProperties2)                                                                                      \
  X(GetPhysicalDeviceQueueFamilyProperties)

// Functions of the instance that a window needs.
#define GPU_SURFACE_FUNCTIONS(X)                                                                                       \
  X(DestroySurfaceKHR)                                                                                                 \
  X(GetPhysicalDeviceSurfaceCapabilitiesKHR)                                                                           \
  X(GetPhysicalDeviceSurfaceFormatsKHR)                                                                                \
  X(GetPhysicalDeviceSurfacePresentModesKHR)                                                                           \
  X(GetPhysicalDeviceSurfaceSupportKHR)

// Functions of the device.
#define GPU_DEVICE_FUNCTIONS(X)                                                                                        \
  X(AllocateCommandBuffers)                                                                                            \
  X(AllocateDescriptorSets)                                                                                            \
  X(AllocateMemory)                                                                                                    \
  X(BeginCommandBuffer)                                                                                                \
  X(BindBufferMemory)                                                                                                  \
  X(BindImageMemory)                                                                                                   \
  X(CmdBeginRenderPass)                                                                                                \
  X(CmdBindDescriptorSets)                                                                                             \
  X(CmdBindIndexBuffer)                                                                                                \
  X(CmdBindPipeline)                                                                                                   \
  X(CmdBindVertexBuffers)                                                                                              \
  X(CmdBlitImage)                                                                                                      \
  X(CmdClearColorImage)                                                                                                \
  X(CmdClearDepthStencilImage)                                                                                         \
  X(CmdCopyBuffer)                                                                                                     \
  X(CmdCopyBufferToImage)                                                                                              \
  X(CmdCopyImage)                                                                                                      \
  X(CmdCopyImageToBuffer)                                                                                              \
  X(CmdDispatch)                                                                                                       \
  X(CmdDraw)                                                                                                           \
  X(CmdDrawIndexed)                                                                                                    \
  X(CmdEndRenderPass)                                                                                                  \
  X(CmdFillBuffer)                                                                                                     \
  X(CmdPipelineBarrier)                                                                                                \
  X(CmdPushConstants)                                                                                                  \
  X(CmdResetQueryPool)                                                                                                 \
  X(CmdSetScissor)                                                                                                     \
  X(CmdSetViewport)                                                                                                    \
  X(CmdUpdateBuffer)                                                                                                   \
  X(CmdWriteTimestamp)                                                                                                 \
  X(CreateBuffer)                                                                                                      \
  X(CreateCommandPool)                                                                                                 \
  X(CreateComputePipelines)                                                                                            \
  X(CreateDescriptorPool)                                                                                              \
  X(CreateDescriptorSetLayout)                                                                                         \
  X(CreateFence)                                                                                                       \
  X(CreateFramebuffer)                                                                                                 \
  X(CreateGraphicsPipelines)                                                                                           \
  X(CreateImage)                                                                                                       \
  X(CreateImageView)                                                                                                   \
  X(CreatePipelineLayout)                                                                                              \
  X(CreateQueryPool)                                                                                                   \
  X(CreateRenderPass)                                                                                                  \
  X(CreateSampler)                                                                                                     \
  X(CreateSemaphore)                                                                                                   \
  X(CreateShaderModule)                                                                                                \
  X(DestroyBuffer)                                                                                                     \
  X(DestroyCommandPool)                                                                                                \
  X(DestroyDescriptorPool)                                                                                             \
  X(DestroyDescriptorSetLayout)                                                                                        \
  X(DestroyDevice)                                                                                                     \
  X(DestroyFence)                                                                                                      \
  X(DestroyFramebuffer)                                                                                                \
  X(DestroyImage)                                                                                                      \
  X(DestroyImageView)                                                                                                  \
  X(DestroyPipeline)                                                                                                   \
  X(DestroyPipelineLayout)                                                                                             \
  X(DestroyQueryPool)                                                                                                  \
  X(DestroyRenderPass)                                                                                                 \
  X(DestroySampler)                                                                                                    \
  X(DestroySemaphore)                                                                                                  \
  X(DestroyShaderModule)                                                                                               \
  X(DeviceWaitIdle)                                                                                                    \
  X(EndCommandBuffer)                                                                                                  \
  X(FreeCommandBuffers)                                                                                                \
  X(FreeDescriptorSets)                                                                                                \
  X(FreeMemory)                                                                                                        \
  X(GetBufferMemoryRequirements)                                                                                       \
  X(GetDeviceQueue)                                                                                                    \
  X(GetImageMemoryRequirements)                                                                                        \
  X(GetQueryPoolResults)                                                                                               \
  X(MapMemory)                                                                                                         \
  X(QueueSubmit)                                                                                                       \
  X(QueueWaitIdle)                                                                                                     \
  X(ResetCommandBuffer)                                                                                                \
  X(ResetCommandPool)                                                                                                  \
  X(ResetFences)                                                                                                       \
  X(UnmapMemory)                                                                                                       \
  X(UpdateDescriptorSets)                                                                                              \
  X(WaitForFences)

// Functions of the device that a window needs.
#define GPU_SWAPCHAIN_FUNCTIONS(X)                                                                                     \
  X(AcquireNextImageKHR)                                                                                               \
  X(CreateSwapchainKHR)                                                                                                \
  X(DestroySwapchainKHR)                                                                                               \
  X(GetSwapchainImagesKHR)                                                                                             \
  X(QueuePresentKHR)

#endif
