// Takes what the runtime needs from the host's device (functions, limits, memory types), and turns Vulkan results into
// errors with messages.
#include "vulkan/context.h"

#include <stdbool.h>

static olx_result load_functions(olx_vulkan_context *c) {
  const olx_vulkan_host *host = &c->host;
  const char *missing = NULL;
#define OLX_LOAD(name)                                                                                                 \
  c->vk.name = (PFN_vk##name)host->get_instance_proc_addr(host->instance, "vk" #name);                                 \
  if (!c->vk.name) missing = "vk" #name;
  OLX_VULKAN_INSTANCE_FUNCTIONS(OLX_LOAD)
#undef OLX_LOAD
  if (missing) return olx_fail(OLX_ERROR_UNSUPPORTED, "the Vulkan instance lacks %s", missing);
#define OLX_LOAD(name)                                                                                                 \
  c->vk.name = (PFN_vk##name)c->vk.GetDeviceProcAddr(host->device, "vk" #name);                                        \
  if (!c->vk.name) missing = "vk" #name;
  OLX_VULKAN_DEVICE_FUNCTIONS(OLX_LOAD)
#undef OLX_LOAD
  if (missing) return olx_fail(OLX_ERROR_UNSUPPORTED, "the Vulkan device lacks %s", missing);
  return OLX_OK;
}

static olx_result check_queue_family(const olx_vulkan_context *c) {
  VkQueueFamilyProperties families[64];
  uint32_t count = sizeof families / sizeof families[0];
  c->vk.GetPhysicalDeviceQueueFamilyProperties(c->host.physical_device, &count, families);
  if (c->host.queue_family >= count) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the device has no queue family %u", c->host.queue_family);
  }
  if (!(families[c->host.queue_family].queueFlags & VK_QUEUE_COMPUTE_BIT)) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "queue family %u cannot compute", c->host.queue_family);
  }
  return OLX_OK;
}

olx_result olx_vulkan_context_make(const olx_vulkan_host *host, olx_vulkan_context *context) {
  *context = (olx_vulkan_context){.host = *host};
  if (!host->get_instance_proc_addr || !host->instance || !host->physical_device || !host->device || !host->queue) {
    return olx_fail(OLX_ERROR_ARGUMENT, "the Vulkan host lacks its loader function, instance, device or queue");
  }
  const olx_result loaded = load_functions(context);
  if (loaded != OLX_OK) {
    context->vk = (olx_vulkan_functions){0};
    return loaded;
  }
  VkPhysicalDeviceProperties properties;
  context->vk.GetPhysicalDeviceProperties(host->physical_device, &properties);
  if (properties.apiVersion < VK_API_VERSION_1_2) {
    return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: Vulkan %u.%u, but 1.2 is needed", properties.deviceName,
                    VK_API_VERSION_MAJOR(properties.apiVersion), VK_API_VERSION_MINOR(properties.apiVersion));
  }
  context->limits = properties.limits;
  context->vk.GetPhysicalDeviceMemoryProperties(host->physical_device, &context->memory);
  return check_queue_family(context);
}

olx_result olx_vulkan_check(VkResult result, const char *call, const char *what) {
  switch (result) {
  case VK_SUCCESS: return OLX_OK;
  case VK_ERROR_OUT_OF_HOST_MEMORY: return olx_fail(OLX_ERROR_MEMORY, "%s: out of host memory in %s", what, call);
  case VK_ERROR_OUT_OF_DEVICE_MEMORY: return olx_fail(OLX_ERROR_MEMORY, "%s: out of device memory in %s", what, call);
  case VK_ERROR_OUT_OF_POOL_MEMORY:
  case VK_ERROR_FRAGMENTED_POOL: return olx_fail(OLX_ERROR_MEMORY, "%s: out of pool memory in %s", what, call);
  case VK_ERROR_DEVICE_LOST: return olx_fail(OLX_ERROR_GPU, "%s: the device was lost in %s", what, call);
  default: return olx_fail(OLX_ERROR_GPU, "%s: %s returned %d", what, call, (int)result);
  }
}

olx_result olx_vulkan_allocate(const olx_vulkan_context *c, const VkMemoryRequirements *requirements,
                               VkMemoryPropertyFlags properties, const char *what, VkDeviceMemory *memory) {
  for (uint32_t type = 0; type < c->memory.memoryTypeCount; type++) {
    if (!(requirements->memoryTypeBits >> type & 1u)) continue;
    if ((c->memory.memoryTypes[type].propertyFlags & properties) != properties) continue;
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = requirements->size, .memoryTypeIndex = type};
    const VkResult result = c->vk.AllocateMemory(c->host.device, &info, NULL, memory);
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY) {
      return olx_fail(OLX_ERROR_MEMORY, "%s: out of device memory for %llu bytes", what,
                      (unsigned long long)requirements->size);
    }
    return olx_vulkan_check(result, "vkAllocateMemory", what);
  }
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: the device has no memory of a fitting type", what);
}

static VkDescriptorType binding_type(const olx_set_bindings *b, uint32_t binding) {
  if (b->uniforms >> binding & 1u) return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  if (b->buffers >> binding & 1u) return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  return b->sampled >> binding & 1u ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
}

olx_result olx_vulkan_set_layout_create(const olx_vulkan_context *c, const olx_set_bindings *b, const char *what,
                                        VkDescriptorSetLayout *layout) {
  enum { MOST_BINDINGS = 32 };
  VkDescriptorSetLayoutBinding bindings[MOST_BINDINGS];
  uint32_t count = 0;
  for (uint32_t left = b->uniforms | b->buffers | b->sampled | b->stored; left; left &= left - 1) {
    const uint32_t i = (uint32_t)__builtin_ctz(left);
    bindings[count++] = (VkDescriptorSetLayoutBinding){
        .binding = i, .descriptorType = binding_type(b, i), .descriptorCount = 1, .stageFlags = b->stages};
  }
  const VkDescriptorSetLayoutCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = count, .pBindings = bindings};
  return olx_vulkan_check(c->vk.CreateDescriptorSetLayout(c->host.device, &info, NULL, layout),
                          "vkCreateDescriptorSetLayout", what);
}

olx_result olx_staging_create(const olx_vulkan_context *c, VkDeviceSize bytes, const char *what, olx_staging *s) {
  *s = (olx_staging){.mapped = NULL};
  const VkBufferCreateInfo info = {
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes, .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT};
  OLX_TRY(olx_vulkan_check(c->vk.CreateBuffer(c->host.device, &info, NULL, &s->buffer), "vkCreateBuffer", what));
  VkMemoryRequirements requirements;
  c->vk.GetBufferMemoryRequirements(c->host.device, s->buffer, &requirements);
  OLX_TRY(olx_vulkan_allocate(
      c, &requirements, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, what, &s->memory));
  OLX_TRY(
      olx_vulkan_check(c->vk.BindBufferMemory(c->host.device, s->buffer, s->memory, 0), "vkBindBufferMemory", what));
  void *mapped;
  OLX_TRY(
      olx_vulkan_check(c->vk.MapMemory(c->host.device, s->memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory", what));
  s->mapped = mapped;
  return OLX_OK;
}

void olx_staging_destroy(const olx_vulkan_context *c, olx_staging *s) {
  c->vk.DestroyBuffer(c->host.device, s->buffer, NULL);
  c->vk.FreeMemory(c->host.device, s->memory, NULL);
}
