// Replaces functions of a Vulkan device by ones that fail on demand, so that tests reach every error path, and
// pipelines by empty ones.
#include "vulkan_faults.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

vulkan_faults faults;

#define FAILING(name, parameters, arguments)                                                                           \
  static VKAPI_ATTR VkResult VKAPI_CALL failing_##name parameters {                                                    \
    return faults.calls_left-- == 0 ? faults.failure : faults.device->name arguments;                                  \
  }
// clang-format off
FAILING(AllocateMemory, (VkDevice d, const VkMemoryAllocateInfo *i, const VkAllocationCallbacks *a, VkDeviceMemory *m),
        (d, i, a, m))
FAILING(BindBufferMemory, (VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize o), (d, b, m, o))
FAILING(BindImageMemory, (VkDevice d, VkImage i, VkDeviceMemory m, VkDeviceSize o), (d, i, m, o))
FAILING(CreateBuffer, (VkDevice d, const VkBufferCreateInfo *i, const VkAllocationCallbacks *a, VkBuffer *m),
        (d, i, a, m))
FAILING(CreateImage, (VkDevice d, const VkImageCreateInfo *i, const VkAllocationCallbacks *a, VkImage *m), (d, i, a, m))
FAILING(CreateImageView, (VkDevice d, const VkImageViewCreateInfo *i, const VkAllocationCallbacks *a, VkImageView *m),
        (d, i, a, m))
FAILING(CreateShaderModule, (VkDevice d, const VkShaderModuleCreateInfo *i,
         const VkAllocationCallbacks *a, VkShaderModule *m), (d, i, a, m))
FAILING(CreatePipelineLayout, (VkDevice d, const VkPipelineLayoutCreateInfo *i,
         const VkAllocationCallbacks *a, VkPipelineLayout *m), (d, i, a, m))
FAILING(CreateDescriptorPool, (VkDevice d, const VkDescriptorPoolCreateInfo *i,
         const VkAllocationCallbacks *a, VkDescriptorPool *m), (d, i, a, m))
FAILING(CreateDescriptorSetLayout, (VkDevice d, const VkDescriptorSetLayoutCreateInfo *i,
         const VkAllocationCallbacks *a, VkDescriptorSetLayout *m), (d, i, a, m))
FAILING(AllocateDescriptorSets, (VkDevice d, const VkDescriptorSetAllocateInfo *i, VkDescriptorSet *m), (d, i, m))
// clang-format on

static const uint32_t NOTHING[] = {
#include "nothing.spv.inc"
};

static VKAPI_ATTR VkResult VKAPI_CALL failing_CreateComputePipelines(VkDevice d, VkPipelineCache cache, uint32_t count,
                                                                     const VkComputePipelineCreateInfo *infos,
                                                                     const VkAllocationCallbacks *callbacks,
                                                                     VkPipeline *pipelines) {
  if (faults.calls_left-- == 0) return faults.failure;
  const gpu_device *device = faults.device;
  const VkShaderModuleCreateInfo code = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = sizeof NOTHING, .pCode = NOTHING};
  VkComputePipelineCreateInfo info = *infos;
  assert_int_equal(count, 1);
  assert_int_equal(device->CreateShaderModule(d, &code, NULL, &info.stage.module), VK_SUCCESS);
  const VkResult result = device->CreateComputePipelines(d, cache, 1, &info, callbacks, pipelines);
  device->DestroyShaderModule(d, info.stage.module, NULL);
  faults.pipelines++;
  faults.cache = cache;
  return result;
}

void faults_empty_pipelines(const gpu_device *device, olx_vulkan_functions *vk) {
  faults = (vulkan_faults){.device = device, .calls_left = -1, .failure = VK_ERROR_OUT_OF_DEVICE_MEMORY};
  vk->CreateComputePipelines = failing_CreateComputePipelines;
}

void faults_install(const gpu_device *device, olx_vulkan_functions *vk) {
  faults_empty_pipelines(device, vk);
#define FAIL(name) vk->name = failing_##name;
  FAIL(AllocateMemory)
  FAIL(BindBufferMemory)
  FAIL(BindImageMemory)
  FAIL(CreateBuffer)
  FAIL(CreateImage)
  FAIL(CreateImageView)
  FAIL(CreateShaderModule)
  FAIL(CreatePipelineLayout)
  FAIL(CreateDescriptorPool)
  FAIL(CreateDescriptorSetLayout)
  FAIL(AllocateDescriptorSets)
#undef FAIL
}
