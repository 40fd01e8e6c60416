// Makes one call of Vulkan fail, as a layer: FAULT=submit:7:-4 lets the 7th vkQueueSubmit of the process return -4
// (VK_ERROR_DEVICE_LOST). Calls are submit, memory (vkAllocateMemory), acquire and present; FAULT=version:1:0 makes
// every device report Vulkan 1.1. The layer serves one device at a time.
#include <vulkan/vk_layer.h>

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

static struct {
  PFN_vkGetInstanceProcAddr instance_proc;
  PFN_vkGetDeviceProcAddr device_proc;
  PFN_vkGetPhysicalDeviceProperties properties;
  PFN_vkQueueSubmit submit;
  PFN_vkAllocateMemory memory;
  PFN_vkAcquireNextImageKHR acquire;
  PFN_vkQueuePresentKHR present;
} next;

static atomic_int calls;

// Returns whether this call of `name` is the one to fail, and with which result.
static int fault(const char *name) {
  const char *wish = getenv("FAULT");
  char wanted[16];
  int number, result;
  if (!wish || sscanf(wish, "%15[a-z]:%d:%d", wanted, &number, &result) != 3 || strcmp(wanted, name) != 0) return 0;
  return ++calls == number ? result : 0;
}

static VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo *infos, VkFence fence) {
  const int result = fault("submit");
  return result ? (VkResult)result : next.submit(queue, count, infos, fence);
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate(VkDevice device, const VkMemoryAllocateInfo *info,
                                               const VkAllocationCallbacks *callbacks, VkDeviceMemory *memory) {
  const int result = fault("memory");
  return result ? (VkResult)result : next.memory(device, info, callbacks, memory);
}

static VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice device, VkSwapchainKHR chain, uint64_t timeout,
                                              VkSemaphore semaphore, VkFence fence, uint32_t *index) {
  const int result = fault("acquire");
  return result ? (VkResult)result : next.acquire(device, chain, timeout, semaphore, fence, index);
}

static VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR *info) {
  const VkResult shown = next.present(queue, info);
  const int result = fault("present");
  return result ? (VkResult)result : shown;
}

static VKAPI_ATTR void VKAPI_CALL describe(VkPhysicalDevice physical, VkPhysicalDeviceProperties *properties) {
  next.properties(physical, properties);
  if (strncmp(getenv("FAULT") ? getenv("FAULT") : "", "version:", 8) == 0) properties->apiVersion = VK_API_VERSION_1_1;
}

// Returns the link of the chain that leads to the next layer.
static void *find_link(const void *chain, VkStructureType type) {
  for (VkLayerInstanceCreateInfo *link = (VkLayerInstanceCreateInfo *)chain; link;
       link = (VkLayerInstanceCreateInfo *)link->pNext) {
    if (link->sType == type && link->function == VK_LAYER_LINK_INFO) return link;
  }
  return NULL;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo *info,
                                                      const VkAllocationCallbacks *callbacks, VkInstance *instance) {
  VkLayerInstanceCreateInfo *link = find_link(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  next.instance_proc = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const PFN_vkCreateInstance create = (PFN_vkCreateInstance)next.instance_proc(NULL, "vkCreateInstance");
  const VkResult result = create(info, callbacks, instance);
  if (result != VK_SUCCESS) return result;
  next.properties = (PFN_vkGetPhysicalDeviceProperties)next.instance_proc(*instance, "vkGetPhysicalDeviceProperties");
  return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo *info,
                                                    const VkAllocationCallbacks *callbacks, VkDevice *device) {
  VkLayerDeviceCreateInfo *link = find_link(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (!link) return VK_ERROR_INITIALIZATION_FAILED;
  const PFN_vkGetInstanceProcAddr get = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  next.device_proc = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const PFN_vkCreateDevice create = (PFN_vkCreateDevice)get(NULL, "vkCreateDevice");
  const VkResult result = create(physical, info, callbacks, device);
  if (result != VK_SUCCESS) return result;
  next.submit = (PFN_vkQueueSubmit)next.device_proc(*device, "vkQueueSubmit");
  next.memory = (PFN_vkAllocateMemory)next.device_proc(*device, "vkAllocateMemory");
  next.acquire = (PFN_vkAcquireNextImageKHR)next.device_proc(*device, "vkAcquireNextImageKHR");
  next.present = (PFN_vkQueuePresentKHR)next.device_proc(*device, "vkQueuePresentKHR");
  return VK_SUCCESS;
}

static PFN_vkVoidFunction own_device_function(const char *name) {
  if (strcmp(name, "vkQueueSubmit") == 0) return (PFN_vkVoidFunction)submit;
  if (strcmp(name, "vkAllocateMemory") == 0) return (PFN_vkVoidFunction)allocate;
  if (strcmp(name, "vkAcquireNextImageKHR") == 0 && next.acquire) return (PFN_vkVoidFunction)acquire;
  if (strcmp(name, "vkQueuePresentKHR") == 0 && next.present) return (PFN_vkVoidFunction)present;
  return NULL;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_proc(VkDevice device, const char *name) {
  if (strcmp(name, "vkGetDeviceProcAddr") == 0) return (PFN_vkVoidFunction)device_proc;
  const PFN_vkVoidFunction own = own_device_function(name);
  return own ? own : next.device_proc(device, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_proc(VkInstance instance, const char *name) {
  if (strcmp(name, "vkGetInstanceProcAddr") == 0) return (PFN_vkVoidFunction)instance_proc;
  if (strcmp(name, "vkGetDeviceProcAddr") == 0) return (PFN_vkVoidFunction)device_proc;
  if (strcmp(name, "vkCreateInstance") == 0) return (PFN_vkVoidFunction)create_instance;
  if (strcmp(name, "vkGetPhysicalDeviceProperties") == 0) return (PFN_vkVoidFunction)describe;
  if (strcmp(name, "vkCreateDevice") == 0) return (PFN_vkVoidFunction)create_device;
  const PFN_vkVoidFunction own = own_device_function(name);
  return own ? own : next.instance_proc(instance, name);
}

EXPORT VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface *interface);

EXPORT VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface *interface) {
  if (interface->loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  interface->loaderLayerInterfaceVersion = 2;
  interface->pfnGetInstanceProcAddr = instance_proc;
  interface->pfnGetDeviceProcAddr = device_proc;
  interface->pfnGetPhysicalDeviceProcAddr = NULL;
  return VK_SUCCESS;
}
