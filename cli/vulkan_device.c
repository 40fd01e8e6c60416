#include "vulkan_device.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEVICES = 16, MAX_FAMILIES = 32 };

static const char VALIDATION[] = "VK_LAYER_KHRONOS_validation";

static VKAPI_ATTR VkBool32 VKAPI_CALL count_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                    VkDebugUtilsMessageTypeFlagsEXT type,
                                                    const VkDebugUtilsMessengerCallbackDataEXT *message, void *user) {
  (void)severity, (void)type;
  vulkan_device *device = user;
  device->validation_messages++;
  fprintf(stderr, "validation: %s\n", message->pMessage);
  return VK_FALSE;
}

static bool has_validation(PFN_vkGetInstanceProcAddr get) {
  const PFN_vkEnumerateInstanceLayerProperties enumerate =
      (PFN_vkEnumerateInstanceLayerProperties)get(NULL, "vkEnumerateInstanceLayerProperties");
  uint32_t count = 0;
  if (enumerate(&count, NULL) != VK_SUCCESS) return false;
  VkLayerProperties *layers = calloc(count + 1, sizeof *layers);
  bool found = false;
  if (layers && enumerate(&count, layers) == VK_SUCCESS) {
    for (uint32_t i = 0; i < count; i++) found = found || strcmp(layers[i].layerName, VALIDATION) == 0;
  }
  free(layers);
  return found;
}

static const char *open_loader(vulkan_device *d) {
  d->loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!d->loader) return "no Vulkan loader (libvulkan.so.1) is installed";
  void *symbol = dlsym(d->loader, "vkGetInstanceProcAddr");
  memcpy(&d->host.get_instance_proc_addr, &symbol, sizeof symbol);
  return symbol ? NULL : "the Vulkan loader has no vkGetInstanceProcAddr";
}

static const char *create_instance(vulkan_device *d, bool validate) {
  const PFN_vkGetInstanceProcAddr get = d->host.get_instance_proc_addr;
  if (validate && !has_validation(get)) return "the Vulkan validation layers are not installed";
  const VkDebugUtilsMessengerCreateInfoEXT messenger = {
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      .pfnUserCallback = count_message,
      .pUserData = d};
  const VkValidationFeatureEnableEXT synchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                            .pNext = &messenger,
                                            .enabledValidationFeatureCount = 1,
                                            .pEnabledValidationFeatures = &synchronisation};
  const char *layers[] = {VALIDATION}, *extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
  const VkApplicationInfo application = {
      .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "octalux", .apiVersion = VK_API_VERSION_1_2};
  const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                     .pNext = validate ? &features : NULL,
                                     .pApplicationInfo = &application,
                                     .enabledLayerCount = validate ? 1 : 0,
                                     .ppEnabledLayerNames = layers,
                                     .enabledExtensionCount = validate ? 1 : 0,
                                     .ppEnabledExtensionNames = extensions};
  const PFN_vkCreateInstance create = (PFN_vkCreateInstance)get(NULL, "vkCreateInstance");
  if (!create || create(&info, NULL, &d->host.instance) != VK_SUCCESS) return "no Vulkan 1.2 instance can be created";
#define LOAD(name) d->name = (PFN_vk##name)get(d->host.instance, "vk" #name);
  INSTANCE_FUNCTIONS(LOAD)
#undef LOAD
  if (!validate) return NULL;
  const PFN_vkCreateDebugUtilsMessengerEXT listen =
      (PFN_vkCreateDebugUtilsMessengerEXT)get(d->host.instance, "vkCreateDebugUtilsMessengerEXT");
  const bool heard = listen && listen(d->host.instance, &messenger, NULL, &d->messenger) == VK_SUCCESS;
  return heard ? NULL : "the validation layers cannot be listened to";
}

static int rank(VkPhysicalDeviceType type) {
  switch (type) {
  case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 4;
  case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 3;
  case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
  default: return 1;
  }
}

// The first family of a device that does compute and graphics, else compute alone; UINT32_MAX without.
static uint32_t find_family(const vulkan_device *d, VkPhysicalDevice physical) {
  VkQueueFamilyProperties families[MAX_FAMILIES];
  uint32_t count = MAX_FAMILIES, found = UINT32_MAX;
  d->GetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
  for (uint32_t i = count; i-- > 0;) {
    if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT && found == UINT32_MAX) found = i;
    const VkQueueFlags both = VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT;
    if ((families[i].queueFlags & both) == both) found = i;
  }
  return found;
}

static const char *choose_device(vulkan_device *d) {
  VkPhysicalDevice devices[MAX_DEVICES];
  uint32_t count = MAX_DEVICES;
  const VkResult result = d->EnumeratePhysicalDevices(d->host.instance, &count, devices);
  if (result != VK_SUCCESS && result != VK_INCOMPLETE) return "the Vulkan devices cannot be listed";
  int best = 0;
  for (uint32_t i = 0; i < count; i++) {
    VkPhysicalDeviceProperties properties;
    d->GetPhysicalDeviceProperties(devices[i], &properties);
    const uint32_t family = find_family(d, devices[i]);
    if (properties.apiVersion < VK_API_VERSION_1_2 || family == UINT32_MAX || rank(properties.deviceType) <= best)
      continue;
    best = rank(properties.deviceType);
    d->host.physical_device = devices[i];
    d->host.queue_family = family;
    memcpy(d->name, properties.deviceName, sizeof d->name);
  }
  return best ? NULL : "there is no Vulkan 1.2 device with compute";
}

static const char *create_device(vulkan_device *d) {
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                         .queueFamilyIndex = d->host.queue_family,
                                         .queueCount = 1,
                                         .pQueuePriorities = &priority};
  const VkDeviceCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue};
  if (d->CreateDevice(d->host.physical_device, &info, NULL, &d->host.device) != VK_SUCCESS) {
    return "the Vulkan device cannot be opened";
  }
#define LOAD(name) d->name = (PFN_vk##name)d->GetDeviceProcAddr(d->host.device, "vk" #name);
  DEVICE_FUNCTIONS(LOAD)
#undef LOAD
  d->GetPhysicalDeviceMemoryProperties(d->host.physical_device, &d->memory);
  d->GetDeviceQueue(d->host.device, d->host.queue_family, 0, &d->host.queue);
  const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                        .queueFamilyIndex = d->host.queue_family};
  if (d->CreateCommandPool(d->host.device, &pool, NULL, &d->pool) != VK_SUCCESS) return "no command pool";
  const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .commandPool = d->pool,
                                                .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                .commandBufferCount = 1};
  if (d->AllocateCommandBuffers(d->host.device, &commands, &d->commands) != VK_SUCCESS) return "no command buffer";
  const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  return d->CreateFence(d->host.device, &fence, NULL, &d->fence) == VK_SUCCESS ? NULL : "no fence";
}

const char *vulkan_device_open(vulkan_device *d, bool validate) {
  *d = (vulkan_device){.name = ""};
  const char *problem = open_loader(d);
  if (!problem) problem = create_instance(d, validate);
  if (!problem) problem = choose_device(d);
  if (!problem) problem = create_device(d);
  if (problem) vulkan_device_close(d);
  return problem;
}

void vulkan_device_close(vulkan_device *d) {
  if (d->host.device) {
    d->DestroyFence(d->host.device, d->fence, NULL);
    d->DestroyCommandPool(d->host.device, d->pool, NULL);
    d->DestroyDevice(d->host.device, NULL);
  }
  if (d->messenger) {
    const PFN_vkDestroyDebugUtilsMessengerEXT destroy =
        (PFN_vkDestroyDebugUtilsMessengerEXT)d->host.get_instance_proc_addr(d->host.instance,
                                                                            "vkDestroyDebugUtilsMessengerEXT");
    destroy(d->host.instance, d->messenger, NULL);
  }
  if (d->host.instance) d->DestroyInstance(d->host.instance, NULL);
  if (d->loader) dlclose(d->loader);
  d->host = (olx_vulkan_host){.instance = NULL};
  d->loader = NULL;
  d->messenger = VK_NULL_HANDLE;
}

static VkResult allocate(vulkan_device *d, const VkMemoryRequirements *needed, VkMemoryPropertyFlags flags,
                         VkDeviceMemory *memory) {
  for (uint32_t type = 0; type < d->memory.memoryTypeCount; type++) {
    if (!(needed->memoryTypeBits >> type & 1u) || (d->memory.memoryTypes[type].propertyFlags & flags) != flags)
      continue;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needed->size, .memoryTypeIndex = type};
    return d->AllocateMemory(d->host.device, &info, NULL, memory);
  }
  return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

VkResult shared_buffer_create(vulkan_device *d, VkDeviceSize bytes, VkBufferUsageFlags usage, shared_buffer *b) {
  *b = (shared_buffer){.mapped = NULL};
  const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = usage};
  VkResult result = d->CreateBuffer(d->host.device, &info, NULL, &b->buffer);
  if (result != VK_SUCCESS) return result;
  VkMemoryRequirements needed;
  d->GetBufferMemoryRequirements(d->host.device, b->buffer, &needed);
  const VkMemoryPropertyFlags flags = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  result = allocate(d, &needed, flags, &b->memory);
  if (result == VK_SUCCESS) result = d->BindBufferMemory(d->host.device, b->buffer, b->memory, 0);
  if (result == VK_SUCCESS) result = d->MapMemory(d->host.device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped);
  return result;
}

void shared_buffer_destroy(vulkan_device *d, shared_buffer *b) {
  d->DestroyBuffer(d->host.device, b->buffer, NULL);
  d->FreeMemory(d->host.device, b->memory, NULL);
}

VkResult device_image_create(vulkan_device *d, uint32_t width, uint32_t height, VkFormat format,
                             VkImageUsageFlags usage, device_image *image) {
  *image = (device_image){.format = format};
  const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                  .imageType = VK_IMAGE_TYPE_2D,
                                  .format = format,
                                  .extent = {width, height, 1},
                                  .mipLevels = 1,
                                  .arrayLayers = 1,
                                  .samples = VK_SAMPLE_COUNT_1_BIT,
                                  .usage = usage};
  VkResult result = d->CreateImage(d->host.device, &info, NULL, &image->image);
  if (result != VK_SUCCESS) return result;
  VkMemoryRequirements needed;
  d->GetImageMemoryRequirements(d->host.device, image->image, &needed);
  result = allocate(d, &needed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &image->memory);
  if (result == VK_SUCCESS) result = d->BindImageMemory(d->host.device, image->image, image->memory, 0);
  const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                      .image = image->image,
                                      .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                      .format = format,
                                      .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  if (result == VK_SUCCESS) result = d->CreateImageView(d->host.device, &view, NULL, &image->view);
  return result;
}

void device_image_destroy(vulkan_device *d, device_image *image) {
  d->DestroyImageView(d->host.device, image->view, NULL);
  d->DestroyImage(d->host.device, image->image, NULL);
  d->FreeMemory(d->host.device, image->memory, NULL);
}

VkResult device_commands_begin(vulkan_device *d) {
  const VkResult result = d->ResetCommandPool(d->host.device, d->pool, 0);
  if (result != VK_SUCCESS) return result;
  const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  return d->BeginCommandBuffer(d->commands, &info);
}

VkResult device_commands_run(vulkan_device *d) {
  VkResult result = d->EndCommandBuffer(d->commands);
  const VkSubmitInfo info = {
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &d->commands};
  if (result == VK_SUCCESS) result = d->QueueSubmit(d->host.queue, 1, &info, d->fence);
  if (result == VK_SUCCESS) result = d->WaitForFences(d->host.device, 1, &d->fence, VK_TRUE, UINT64_MAX);
  if (result == VK_SUCCESS) result = d->ResetFences(d->host.device, 1, &d->fence);
  return result;
}

void device_barrier(vulkan_device *d, const device_image *image, VkImageLayout from, VkImageLayout to) {
  const VkAccessFlags writes = VK_ACCESS_MEMORY_WRITE_BIT, all = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  const VkMemoryBarrier memory = {
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .srcAccessMask = writes, .dstAccessMask = all};
  const VkImageMemoryBarrier change = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                       .srcAccessMask = writes,
                                       .dstAccessMask = all,
                                       .oldLayout = from,
                                       .newLayout = to,
                                       .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .image = image ? image->image : VK_NULL_HANDLE,
                                       .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
  d->CmdPipelineBarrier(d->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1,
                        &memory, 0, NULL, image ? 1 : 0, &change);
}
