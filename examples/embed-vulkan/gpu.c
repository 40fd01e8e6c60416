// Represents the Vulkan code that every engine already has: opens a device, and makes buffers, images and shaders. It
// does not use Octalux.
#include "gpu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEVICES = 16, MAX_FAMILIES = 32, MAX_LAYERS = 64 };

static const char *const VALIDATION = "VK_LAYER_KHRONOS_validation";

void gpu_need(VkResult result, const char *what) {
  if (result == VK_SUCCESS) return;
  fprintf(stderr, "embed_vulkan: Vulkan refuses %s (VkResult %d)\n", what, (int)result);
  exit(1);
}

static VKAPI_ATTR VkBool32 VKAPI_CALL hear(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                           VkDebugUtilsMessageTypeFlagsEXT type,
                                           const VkDebugUtilsMessengerCallbackDataEXT *message, void *user) {
  (void)severity, (void)type;
  ((gpu *)user)->validation_messages++;
  fprintf(stderr, "validation: %s\n", message->pMessage);
  return VK_FALSE;
}

static bool has_validation(void) {
  VkLayerProperties layers[MAX_LAYERS];
  uint32_t count = MAX_LAYERS;
  if (vkEnumerateInstanceLayerProperties(&count, layers) < 0) return false;
  for (uint32_t i = 0; i < count; i++) {
    if (strcmp(layers[i].layerName, VALIDATION) == 0) return true;
  }
  return false;
}

static VkResult make_instance(gpu *g, bool validate) {
  g->validated = validate && has_validation();
  if (validate && !g->validated) fprintf(stderr, "embed_vulkan: the validation layers are not installed\n");
  const VkDebugUtilsMessengerCreateInfoEXT messenger = {
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = hear,
      .pUserData = g};
  const VkValidationFeatureEnableEXT synchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                            .pNext = &messenger,
                                            .enabledValidationFeatureCount = 1,
                                            .pEnabledValidationFeatures = &synchronisation};
  const char *const extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                         .pApplicationName = "embed_vulkan",
                                         .apiVersion = VK_API_VERSION_1_2};
  const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                     .pNext = g->validated ? &features : NULL,
                                     .pApplicationInfo = &application,
                                     .enabledLayerCount = g->validated ? 1 : 0,
                                     .ppEnabledLayerNames = &VALIDATION,
                                     .enabledExtensionCount = g->validated ? 1 : 0,
                                     .ppEnabledExtensionNames = &extension};
  const VkResult result = vkCreateInstance(&info, NULL, &g->instance);
  if (result != VK_SUCCESS || !g->validated) return result;
  const PFN_vkCreateDebugUtilsMessengerEXT listen =
      (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(g->instance, "vkCreateDebugUtilsMessengerEXT");
  return listen(g->instance, &messenger, NULL, &g->messenger);
}

static int rank(VkPhysicalDeviceType type) {
  return type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ? 3 : type == VK_PHYSICAL_DEVICE_TYPE_CPU ? 1 : 2;
}

static bool choose_device(gpu *g) {
  VkPhysicalDevice devices[MAX_DEVICES];
  uint32_t count = MAX_DEVICES;
  if (vkEnumeratePhysicalDevices(g->instance, &count, devices) < 0) return false;
  int best = 0;
  for (uint32_t i = 0; i < count; i++) {
    VkPhysicalDeviceProperties properties;
    VkQueueFamilyProperties families[MAX_FAMILIES];
    uint32_t family_count = MAX_FAMILIES;
    vkGetPhysicalDeviceProperties(devices[i], &properties);
    vkGetPhysicalDeviceQueueFamilyProperties(devices[i], &family_count, families);
    if (properties.apiVersion < VK_API_VERSION_1_2 || rank(properties.deviceType) <= best) continue;
    for (uint32_t f = 0; f < family_count; f++) {
      const VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
      if ((families[f].queueFlags & both) != both) continue;
      g->physical_device = devices[i];
      g->queue_family = f;
      memcpy(g->name, properties.deviceName, sizeof g->name);
      best = rank(properties.deviceType);
      break;
    }
  }
  return best > 0;
}

bool gpu_open(gpu *g, bool validate) {
  *g = (gpu){.name = ""};
  if (make_instance(g, validate) != VK_SUCCESS || !choose_device(g)) {
    gpu_close(g);
    return false;
  }
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                         .queueFamilyIndex = g->queue_family,
                                         .queueCount = 1,
                                         .pQueuePriorities = &priority};
  VkPhysicalDeviceFeatures has;
  vkGetPhysicalDeviceFeatures(g->physical_device, &has);
  g->texture_compression_bc = has.textureCompressionBC;
  const VkPhysicalDeviceFeatures features = {.textureCompressionBC = has.textureCompressionBC};
  const VkDeviceCreateInfo device = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .pEnabledFeatures = &features};
  gpu_need(vkCreateDevice(g->physical_device, &device, NULL, &g->device), "a device");
  vkGetDeviceQueue(g->device, g->queue_family, 0, &g->queue);
  const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                        .queueFamilyIndex = g->queue_family};
  gpu_need(vkCreateCommandPool(g->device, &pool, NULL, &g->pool), "a command pool");
  const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .commandPool = g->pool,
                                                .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                .commandBufferCount = 1};
  gpu_need(vkAllocateCommandBuffers(g->device, &commands, &g->commands), "a command buffer");
  return true;
}

void gpu_close(gpu *g) {
  if (g->device) {
    vkDestroyCommandPool(g->device, g->pool, NULL);
    vkDestroyDevice(g->device, NULL);
  }
  if (g->messenger) {
    const PFN_vkDestroyDebugUtilsMessengerEXT destroy =
        (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(g->instance, "vkDestroyDebugUtilsMessengerEXT");
    destroy(g->instance, g->messenger, NULL);
  }
  if (g->instance) vkDestroyInstance(g->instance, NULL);
}

static VkDeviceMemory allocate(const gpu *g, VkMemoryRequirements needed, VkMemoryPropertyFlags flags) {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(g->physical_device, &memory);
  VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needed.size};
  while (info.memoryTypeIndex < memory.memoryTypeCount &&
         !(needed.memoryTypeBits >> info.memoryTypeIndex & 1 &&
           (memory.memoryTypes[info.memoryTypeIndex].propertyFlags & flags) == flags))
    info.memoryTypeIndex++;
  VkDeviceMemory allocated = VK_NULL_HANDLE;
  gpu_need(info.memoryTypeIndex < memory.memoryTypeCount ? vkAllocateMemory(g->device, &info, NULL, &allocated)
                                                         : VK_ERROR_OUT_OF_DEVICE_MEMORY,
           "memory");
  return allocated;
}

gpu_buffer gpu_make_buffer(const gpu *g, size_t bytes, VkBufferUsageFlags usage, const void *data) {
  gpu_buffer b;
  const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
  gpu_need(vkCreateBuffer(g->device, &info, NULL, &b.buffer), "a buffer");
  VkMemoryRequirements needed;
  vkGetBufferMemoryRequirements(g->device, b.buffer, &needed);
  b.memory = allocate(g, needed, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  gpu_need(vkBindBufferMemory(g->device, b.buffer, b.memory, 0), "a buffer's memory");
  gpu_need(vkMapMemory(g->device, b.memory, 0, VK_WHOLE_SIZE, 0, &b.mapped), "to map a buffer");
  if (data) memcpy(b.mapped, data, bytes);
  return b;
}

void gpu_free_buffer(const gpu *g, gpu_buffer *b) {
  vkDestroyBuffer(g->device, b->buffer, NULL);
  vkFreeMemory(g->device, b->memory, NULL);
}

static VkImageSubresourceRange whole(VkFormat format) {
  const VkImageAspectFlags aspect =
      format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  return (VkImageSubresourceRange){aspect, 0, 1, 0, 1};
}

gpu_image gpu_make_image(const gpu *g, VkExtent2D size, VkFormat format, VkImageUsageFlags usage) {
  gpu_image made = {.format = format};
  const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                  .imageType = VK_IMAGE_TYPE_2D,
                                  .format = format,
                                  .extent = {size.width, size.height, 1},
                                  .mipLevels = 1,
                                  .arrayLayers = 1,
                                  .samples = VK_SAMPLE_COUNT_1_BIT,
                                  .usage = usage};
  gpu_need(vkCreateImage(g->device, &info, NULL, &made.image), "an image");
  VkMemoryRequirements needed;
  vkGetImageMemoryRequirements(g->device, made.image, &needed);
  made.memory = allocate(g, needed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  gpu_need(vkBindImageMemory(g->device, made.image, made.memory, 0), "an image's memory");
  const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = made.image,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                      .format = format,
                                      .subresourceRange = whole(format)};
  gpu_need(vkCreateImageView(g->device, &view, NULL, &made.view), "an image view");
  return made;
}

void gpu_free_image(const gpu *g, gpu_image *image) {
  vkDestroyImageView(g->device, image->view, NULL);
  vkDestroyImage(g->device, image->image, NULL);
  vkFreeMemory(g->device, image->memory, NULL);
}

void gpu_begin(const gpu *g) {
  const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  gpu_need(vkResetCommandPool(g->device, g->pool, 0), "to reset commands");
  gpu_need(vkBeginCommandBuffer(g->commands, &info), "to record");
}

void gpu_run(const gpu *g) {
  gpu_need(vkEndCommandBuffer(g->commands), "what was recorded");
  const VkSubmitInfo info = {
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &g->commands};
  gpu_need(vkQueueSubmit(g->queue, 1, &info, VK_NULL_HANDLE), "to run commands");
  gpu_need(vkQueueWaitIdle(g->queue), "to finish commands");
}

void gpu_barrier(const gpu *g, gpu_order order) {
  const VkMemoryBarrier barrier = {
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .srcAccessMask = order.wrote, .dstAccessMask = order.access};
  vkCmdPipelineBarrier(g->commands, order.from, order.to, 0, 1, &barrier, 0, NULL, 0, NULL);
}

void gpu_change_layout(const gpu *g, const gpu_image *image, VkImageLayout old, VkImageLayout new, gpu_order order) {
  const VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                        .srcAccessMask = order.wrote,
                                        .dstAccessMask = order.access,
                                        .oldLayout = old,
                                        .newLayout = new,
                                        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                        .image = image->image,
                                        .subresourceRange = whole(image->format)};
  vkCmdPipelineBarrier(g->commands, order.from, order.to, 0, 0, NULL, 0, NULL, 1, &barrier);
}

VkShaderModule gpu_make_shader(const gpu *g, const uint32_t *words, size_t bytes) {
  const VkShaderModuleCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = bytes, .pCode = words};
  VkShaderModule made;
  gpu_need(vkCreateShaderModule(g->device, &info, NULL, &made), "a shader");
  return made;
}
