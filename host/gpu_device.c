// Opens a Vulkan device through the system's loader, with or without a window and validation layers, and runs commands
// on its single queue.
#include "gpu_device.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEVICES = 16, MAX_FAMILIES = 32, MAX_EXTENSIONS = 16 };

static const char VALIDATION[] = "VK_LAYER_KHRONOS_validation";

// ---- messages

bool gpu_fail(gpu_device *d, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(d->problem, sizeof d->problem, format, arguments);
  va_end(arguments);
  return false;
}

static const char *meaning(VkResult result) {
  switch (result) {
  case VK_ERROR_OUT_OF_HOST_MEMORY: return "out of host memory";
  case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "out of device memory";
  case VK_ERROR_DEVICE_LOST: return "the Vulkan device was lost";
  case VK_ERROR_SURFACE_LOST_KHR: return "the window's surface was lost";
  case VK_ERROR_INCOMPATIBLE_DRIVER:
    return "no Vulkan driver is installed, or none can be loaded; with VK_LOADER_DEBUG=error the loader says why";
  default: return "the Vulkan device refuses";
  }
}

bool gpu_fail_result(gpu_device *d, VkResult result, const char *what) {
  return gpu_fail(d, "%s: %s (VkResult %d)", what, meaning(result), (int)result);
}

bool gpu_check(gpu_device *d, VkResult result, const char *what) {
  return result == VK_SUCCESS || gpu_fail_result(d, result, what);
}

bool gpu_check_library(gpu_device *d, olx_result result) {
  return result == OLX_OK || gpu_fail(d, "%s", olx_last_error());
}

// ---- the instance

static VKAPI_ATTR VkBool32 VKAPI_CALL count_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                    VkDebugUtilsMessageTypeFlagsEXT type,
                                                    const VkDebugUtilsMessengerCallbackDataEXT *message, void *user) {
  (void)severity, (void)type;
  gpu_device *d = user;
  d->validation_messages++;
  fprintf(stderr, "validation: %s\n", message->pMessage);
  return VK_FALSE;
}

static bool has_validation(PFN_vkGetInstanceProcAddr get) {
  const PFN_vkEnumerateInstanceLayerProperties enumerate =
      (PFN_vkEnumerateInstanceLayerProperties)get(NULL, "vkEnumerateInstanceLayerProperties");
  uint32_t count = 0;
  if (enumerate(&count, NULL) != VK_SUCCESS) return false;
  VkLayerProperties *layers = calloc((size_t)count + 1, sizeof *layers);
  bool found = false;
  if (layers && enumerate(&count, layers) == VK_SUCCESS) {
    for (uint32_t i = 0; i < count; i++) found = found || strcmp(layers[i].layerName, VALIDATION) == 0;
  }
  free(layers);
  return found;
}

static bool open_loader(gpu_device *d) {
  d->loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (!d->loader) return gpu_fail(d, "no Vulkan loader (libvulkan.so.1) is installed");
  void *symbol = dlsym(d->loader, "vkGetInstanceProcAddr");
  memcpy(&d->host.get_instance_proc_addr, &symbol, sizeof symbol);
  return symbol ? true : gpu_fail(d, "the Vulkan loader has no vkGetInstanceProcAddr");
}

static bool create_instance(gpu_device *d, const gpu_device_options *options) {
  const PFN_vkGetInstanceProcAddr get = d->host.get_instance_proc_addr;
  if (options->validate && !has_validation(get)) return gpu_fail(d, "the Vulkan validation layers are not installed");
  const char *extensions[MAX_EXTENSIONS];
  uint32_t count = 0;
  if (options->instance_extension_count >= MAX_EXTENSIONS) return gpu_fail(d, "too many instance extensions");
  for (; count < options->instance_extension_count; count++) extensions[count] = options->instance_extensions[count];
  if (options->validate) extensions[count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
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
  const char *layers[] = {VALIDATION};
  const VkApplicationInfo application = {
      .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "octalux", .apiVersion = VK_API_VERSION_1_2};
  const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                     .pNext = options->validate ? &features : NULL,
                                     .pApplicationInfo = &application,
                                     .enabledLayerCount = options->validate ? 1 : 0,
                                     .ppEnabledLayerNames = layers,
                                     .enabledExtensionCount = count,
                                     .ppEnabledExtensionNames = extensions};
  const PFN_vkCreateInstance create = (PFN_vkCreateInstance)get(NULL, "vkCreateInstance");
  if (!create) return gpu_fail(d, "the Vulkan loader has no vkCreateInstance");
  if (!gpu_check(d, create(&info, NULL, &d->host.instance), "no Vulkan 1.2 instance can be created")) return false;
#define LOAD(name) d->name = (PFN_vk##name)get(d->host.instance, "vk" #name);
  GPU_INSTANCE_FUNCTIONS(LOAD)
  if (options->create_surface) {
    GPU_SURFACE_FUNCTIONS(LOAD)
  }
#undef LOAD
  if (!options->validate) return true;
  const PFN_vkCreateDebugUtilsMessengerEXT listen =
      (PFN_vkCreateDebugUtilsMessengerEXT)get(d->host.instance, "vkCreateDebugUtilsMessengerEXT");
  const bool heard = listen && listen(d->host.instance, &messenger, NULL, &d->messenger) == VK_SUCCESS;
  return heard ? true : gpu_fail(d, "the validation layers cannot be listened to");
}

// ---- the device

static int rank(VkPhysicalDeviceType type) {
  switch (type) {
  case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 4;
  case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 3;
  case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
  default: return 1;
  }
}

// Returns the first queue family with all requested capabilities, including presentation when there is a surface;
// UINT32_MAX when there is none.
static uint32_t find_family(const gpu_device *d, VkPhysicalDevice physical, VkQueueFlags wanted,
                            VkQueueFamilyProperties *found) {
  VkQueueFamilyProperties families[MAX_FAMILIES];
  uint32_t count = MAX_FAMILIES;
  d->GetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
  for (uint32_t i = 0; i < count; i++) {
    VkBool32 presents = VK_TRUE;
    if (d->surface && d->GetPhysicalDeviceSurfaceSupportKHR(physical, i, d->surface, &presents) != VK_SUCCESS) continue;
    if ((families[i].queueFlags & wanted) != wanted || !presents) continue;
    *found = families[i];
    return i;
  }
  return UINT32_MAX;
}

static bool list_devices(gpu_device *d, VkPhysicalDevice devices[MAX_DEVICES], uint32_t *count) {
  *count = MAX_DEVICES;
  const VkResult result = d->EnumeratePhysicalDevices(d->host.instance, count, devices);
  return result == VK_INCOMPLETE || gpu_check(d, result, "listing the Vulkan devices");
}

static void describe_device(gpu_device *d) {
  d->driver = (VkPhysicalDeviceDriverProperties){.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 all = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &d->driver};
  d->GetPhysicalDeviceProperties2(d->host.physical_device, &all);
  d->properties = all.properties;
  d->driver.pNext = NULL;
}

static bool choose_device(gpu_device *d, const gpu_device_options *options) {
  const uint32_t wanted = options->device;
  const char *abilities = options->compute_only ? "compute" : "graphics and compute";
  VkPhysicalDevice devices[MAX_DEVICES];
  uint32_t count;
  if (!list_devices(d, devices, &count)) return false;
  if (wanted != UINT32_MAX && wanted >= count) {
    return gpu_fail(d, "there is no Vulkan device %u; there are %u", wanted, count);
  }
  int best = 0;
  for (uint32_t i = 0; i < count; i++) {
    VkQueueFamilyProperties family;
    VkPhysicalDeviceProperties properties;
    d->GetPhysicalDeviceProperties(devices[i], &properties);
    uint32_t index = find_family(d, devices[i], VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT, &family);
    if (index == UINT32_MAX && options->compute_only) {
      index = find_family(d, devices[i], VK_QUEUE_COMPUTE_BIT, &family);
    }
    const bool able = properties.apiVersion >= VK_API_VERSION_1_2 && index != UINT32_MAX;
    if (!able || (wanted != UINT32_MAX && wanted != i) || rank(properties.deviceType) <= best) continue;
    best = rank(properties.deviceType);
    d->host.physical_device = devices[i];
    d->host.queue_family = index;
    const uint32_t bits = family.timestampValidBits;
    d->timestamp_nanoseconds = bits ? (double)properties.limits.timestampPeriod : 0.0;
    d->timestamp_mask = bits >= 64 ? UINT64_MAX : (UINT64_C(1) << bits) - 1;
  }
  if (!best) {
    return gpu_fail(d,
                    wanted == UINT32_MAX ? "there is no Vulkan 1.2 device with %s"
                                         : "that Vulkan device has no Vulkan 1.2 with %s",
                    abilities);
  }
  describe_device(d);
  return true;
}

// Returns whether the device reports statistics of compiled pipelines.
static bool has_statistics(const gpu_device *d) {
  enum { MOST = 512 };
  const PFN_vkEnumerateDeviceExtensionProperties list =
      (PFN_vkEnumerateDeviceExtensionProperties)d->host.get_instance_proc_addr(d->host.instance,
                                                                               "vkEnumerateDeviceExtensionProperties");
  VkExtensionProperties *found = calloc(MOST, sizeof *found);
  uint32_t count = MOST;
  bool has = false;
  if (found && list(d->host.physical_device, NULL, &count, found) >= 0) {
    for (uint32_t i = 0; i < count; i++) {
      has |= strcmp(found[i].extensionName, VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME) == 0;
    }
  }
  free(found);
  return has;
}

static bool create_device(gpu_device *d, bool compile_only) {
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                         .queueFamilyIndex = d->host.queue_family,
                                         .queueCount = 1,
                                         .pQueuePriorities = &priority};
  d->statistics = compile_only && has_statistics(d);
  const char *extension =
      d->statistics ? VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME : VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR statistics = {
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
      .pipelineExecutableInfo = VK_TRUE};
  VkPhysicalDeviceFeatures has;
  d->GetPhysicalDeviceFeatures(d->host.physical_device, &has);
  // Mesa's CPU device blurs magnified textures with anisotropic filtering, and is slow at it.
  d->anisotropy = has.samplerAnisotropy && d->properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU;
  // Mesa's CPU device supports block-compressed textures, but takes minutes to compile long shaders that read them:
  // fields are decoded for it.
  d->block_textures = has.textureCompressionBC;
  d->host.texture_compression_bc = has.textureCompressionBC && d->properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU;
  const VkPhysicalDeviceFeatures features = {.samplerAnisotropy = d->anisotropy,
                                             .textureCompressionBC = has.textureCompressionBC};
  const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                   .pNext = d->statistics ? &statistics : NULL,
                                   .queueCreateInfoCount = 1,
                                   .pQueueCreateInfos = &queue,
                                   .enabledExtensionCount = d->surface || d->statistics ? 1 : 0,
                                   .ppEnabledExtensionNames = &extension,
                                   .pEnabledFeatures = &features};
  const VkResult opened = d->CreateDevice(d->host.physical_device, &info, NULL, &d->host.device);
  if (!gpu_check(d, opened, "opening the Vulkan device")) return false;
#define LOAD(name) d->name = (PFN_vk##name)d->GetDeviceProcAddr(d->host.device, "vk" #name);
  GPU_DEVICE_FUNCTIONS(LOAD)
  if (d->surface) {
    GPU_SWAPCHAIN_FUNCTIONS(LOAD)
  }
#undef LOAD
  d->GetPhysicalDeviceMemoryProperties(d->host.physical_device, &d->memory);
  d->GetDeviceQueue(d->host.device, d->host.queue_family, 0, &d->host.queue);
  return true;
}

static bool create_commands(gpu_device *d) {
  const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                        .queueFamilyIndex = d->host.queue_family};
  if (!gpu_check(d, d->CreateCommandPool(d->host.device, &pool, NULL, &d->pool), "a command pool")) return false;
  const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                .commandPool = d->pool,
                                                .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                .commandBufferCount = 1};
  const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  return gpu_check(d, d->AllocateCommandBuffers(d->host.device, &commands, &d->commands), "a command buffer") &&
         gpu_check(d, d->CreateFence(d->host.device, &fence, NULL, &d->fence), "a fence");
}

static bool open_instance(gpu_device *d, const gpu_device_options *options) {
  *d = (gpu_device){.problem = ""};
  return open_loader(d) && create_instance(d, options);
}

bool gpu_device_open(const gpu_device_options *options, gpu_device *d) {
  bool fine = open_instance(d, options);
  if (fine && options->create_surface) {
    const VkResult made =
        options->create_surface(options->user, d->host.get_instance_proc_addr, d->host.instance, &d->surface);
    fine = gpu_check(d, made, "a surface for the window");
  }
  fine = fine && choose_device(d, options) && create_device(d, options->compile_only) &&
         (options->compile_only || create_commands(d));
  if (!fine) gpu_device_close(d);
  return fine;
}

void gpu_device_close(gpu_device *d) {
  if (d->host.device) {
    d->DestroyFence(d->host.device, d->fence, NULL);
    d->DestroyCommandPool(d->host.device, d->pool, NULL);
    d->DestroyDevice(d->host.device, NULL);
  }
  if (d->surface) d->DestroySurfaceKHR(d->host.instance, d->surface, NULL);
  if (d->messenger) {
    const PFN_vkDestroyDebugUtilsMessengerEXT destroy =
        (PFN_vkDestroyDebugUtilsMessengerEXT)d->host.get_instance_proc_addr(d->host.instance,
                                                                            "vkDestroyDebugUtilsMessengerEXT");
    destroy(d->host.instance, d->messenger, NULL);
  }
  if (d->host.instance) d->DestroyInstance(d->host.instance, NULL);
  if (d->loader) dlclose(d->loader);
  d->host = (olx_vulkan_host){.instance = NULL};
  d->surface = VK_NULL_HANDLE;
  d->messenger = VK_NULL_HANDLE;
  d->fence = VK_NULL_HANDLE;
  d->pool = VK_NULL_HANDLE;
  d->loader = NULL;
}

bool gpu_device_list(gpu_device *d) {
  VkPhysicalDevice devices[MAX_DEVICES];
  uint32_t count = 0;
  const bool fine = open_instance(d, &(gpu_device_options){.validate = false}) && list_devices(d, devices, &count);
  for (uint32_t i = 0; fine && i < count; i++) {
    d->host.physical_device = devices[i];
    describe_device(d);
    printf("%u  %s (%s %s)\n", i, d->properties.deviceName, d->driver.driverName, d->driver.driverInfo);
  }
  gpu_device_close(d);
  return fine;
}

// ---- commands that run once

bool gpu_commands_begin(gpu_device *d) {
  const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  return gpu_check(d, d->ResetCommandPool(d->host.device, d->pool, 0), "resetting the command pool") &&
         gpu_check(d, d->BeginCommandBuffer(d->commands, &info), "beginning commands");
}

bool gpu_commands_run(gpu_device *d) {
  VkResult result = d->EndCommandBuffer(d->commands);
  const VkSubmitInfo info = {
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &d->commands};
  if (result == VK_SUCCESS) result = d->QueueSubmit(d->host.queue, 1, &info, d->fence);
  if (result == VK_SUCCESS) result = d->WaitForFences(d->host.device, 1, &d->fence, VK_TRUE, UINT64_MAX);
  if (result == VK_SUCCESS) result = d->ResetFences(d->host.device, 1, &d->fence);
  return gpu_check(d, result, "running commands");
}
