// Tests what the library needs of a device: memory and bindings are reported beforehand and not exceeded, a device that
// fails gives errors, and nothing is left behind.
#include "core/hooks.h"
#include "field/field_writer.h"
#include "vulkan/vulkan_frame.h"
#include "vulkan_faults.h"
#include "vulkan_host.h"

#include <octalux/sample.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static gpu_device device;

static int open_device(void **unused) {
  (void)unused;
  host_open_device(&device, true);
  return 0;
}

static int close_device(void **unused) {
  (void)unused;
  return host_close_device(&device);
}

static host_images make_images(uint32_t width, uint32_t height, VkFormat normal) {
  host_images h = host_images_make(&device, width, height, normal);
  h.targets.passes = OLX_VULKAN_PASS_IRRADIANCE | OLX_VULKAN_PASS_GLOSSY | OLX_VULKAN_PASS_COMPOSITE;
  return h;
}

// Replacements of Vulkan functions that fail at the n-th call.
static PFN_vkAllocateMemory real_allocate;
static PFN_vkFreeMemory real_free;
static int allocations_left, memory_held;
static uint64_t bytes_allocated;

static VKAPI_ATTR VkResult VKAPI_CALL failing_allocate(VkDevice d, const VkMemoryAllocateInfo *info,
                                                       const VkAllocationCallbacks *callbacks, VkDeviceMemory *memory) {
  if (allocations_left-- <= 0) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  memory_held++;
  bytes_allocated += info->allocationSize;
  return real_allocate(d, info, callbacks, memory);
}

static VKAPI_ATTR void VKAPI_CALL counting_free(VkDevice d, VkDeviceMemory memory,
                                                const VkAllocationCallbacks *callbacks) {
  memory_held -= memory != VK_NULL_HANDLE;
  real_free(d, memory, callbacks);
}

static VKAPI_ATTR VkResult VKAPI_CALL lost_submit(VkQueue queue, uint32_t count, const VkSubmitInfo *infos,
                                                  VkFence fence) {
  (void)queue, (void)count, (void)infos, (void)fence;
  return VK_ERROR_DEVICE_LOST;
}

static bool submit_is_lost;

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL failing_device_function(VkDevice d, const char *name) {
  if (strcmp(name, "vkAllocateMemory") == 0) return (PFN_vkVoidFunction)failing_allocate;
  if (strcmp(name, "vkFreeMemory") == 0) return (PFN_vkVoidFunction)counting_free;
  if (submit_is_lost && strcmp(name, "vkQueueSubmit") == 0) return (PFN_vkVoidFunction)lost_submit;
  return device.GetDeviceProcAddr(d, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL failing_function(VkInstance instance, const char *name) {
  if (strcmp(name, "vkGetDeviceProcAddr") == 0) return (PFN_vkVoidFunction)failing_device_function;
  return device.host.get_instance_proc_addr(instance, name);
}

static olx_vulkan_host failing_host(int allocations, bool lost) {
  real_allocate = device.AllocateMemory;
  real_free = device.FreeMemory;
  allocations_left = allocations;
  bytes_allocated = 0;
  submit_is_lost = lost;
  olx_vulkan_host host = device.host;
  host.get_instance_proc_addr = failing_function;
  return host;
}

static void running_out_of_memory_leaves_nothing_behind(void **unused) {
  (void)unused;
  host_need_device(&device);
  const uint32_t before = device.validation_messages;
  olx_field *field = host_field_make(16, 8);
  olx_vulkan_sizes sizes;
  assert_int_equal(olx_vulkan_field_measure(&device.host, field, &sizes), OLX_OK);
  assert_true(sizes.device_bytes >= 8 * (18 * 18 * 8 + 10 * 10 * 8) && sizes.staging_bytes > 0);
  for (int n = 0; n <= (int)sizes.allocations; n++) { // the last allocation is the staging memory
    const olx_vulkan_host host = failing_host(n, false);
    olx_vulkan_field *uploaded = (void *)1;
    assert_int_equal(olx_vulkan_field_create(&host, field, &uploaded), OLX_ERROR_MEMORY);
    assert_null(uploaded);
    assert_non_null(strstr(olx_last_error(), "out of device memory"));
    assert_int_equal(memory_held, 0);
  }
  const olx_vulkan_host host = failing_host((int)sizes.allocations + 1, false);
  olx_vulkan_field *uploaded;
  assert_int_equal(olx_vulkan_field_create(&host, field, &uploaded), OLX_OK);
  assert_int_equal(memory_held, (int)sizes.allocations);
  olx_vulkan_field_destroy(uploaded);
  assert_int_equal(memory_held, 0);
  analytic_field_free(field);
  assert_int_equal(device.validation_messages, before);
}

static void a_lost_device_is_reported(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_field *field = host_field_make(16, 8);
  const olx_vulkan_host host = failing_host(100, true);
  olx_vulkan_field *uploaded;
  assert_int_equal(olx_vulkan_field_create(&host, field, &uploaded), OLX_ERROR_GPU);
  assert_non_null(strstr(olx_last_error(), "the device was lost in vkQueueSubmit"));
  assert_null(uploaded);
  assert_int_equal(memory_held, 0);
  analytic_field_free(field);
}

// Asserts that the size a bake reports beforehand is the size on the device, except for alignment, unused slots of
// maps, and probes.
static void assert_planned(const olx_field *field, uint64_t device_bytes) {
  olx_field_header header = {.info = field->info};
  olx_field_layout layout;
  memcpy(header.select_bytes, field->select_bytes, sizeof header.select_bytes);
  olx_field_lay_out(&header, &layout);
  assert_true(device_bytes >= layout.device_bytes && device_bytes <= 2 * layout.device_bytes + 0x100000);
}

// Asserts that measuring a field gives the sizes that creating it, and its classic maps, allocates.
static void assert_measured(const olx_field *field) {
  olx_vulkan_sizes sizes;
  assert_int_equal(olx_vulkan_field_measure(&device.host, field, &sizes), OLX_OK);
  assert_planned(field, sizes.device_bytes + sizes.classic_bytes);
  const olx_vulkan_host host = failing_host(100, false);
  olx_vulkan_field *uploaded;
  assert_int_equal(olx_vulkan_field_create(&host, field, &uploaded), OLX_OK);
  assert_int_equal(bytes_allocated, sizes.device_bytes + sizes.staging_bytes);
  assert_int_equal(memory_held, sizes.allocations);
  assert_true((sizes.classic_bytes > 0) == (field->classic.size > 0));
  if (sizes.classic_bytes > 0) {
    olx_vulkan_classic *classic;
    bytes_allocated = 0;
    assert_int_equal(olx_vulkan_classic_create(uploaded, field, &classic), OLX_OK);
    assert_int_equal(bytes_allocated, sizes.classic_bytes + sizes.staging_bytes);
    assert_int_equal(memory_held, sizes.allocations + 1);
    olx_vulkan_classic_destroy(classic);
  }
  olx_vulkan_field_destroy(uploaded);
  assert_int_equal(memory_held, 0);
}

static void all_memory_is_told_before(void **unused) {
  (void)unused;
  host_need_device(&device);
  enum { BRICK_BYTES = 4096, VORONOI_BYTES = 1000001 };
  olx_field *field = host_field_make(16, 8);
  olx_vulkan_sizes without, with;
  assert_int_equal(olx_vulkan_field_measure(&device.host, field, &without), OLX_OK);
  assert_measured(field);
  void *words = olx_allocate_zero(VORONOI_BYTES, 1);
  field->select_data[OLX_SELECT_BRICKS] = field->select_data[OLX_SELECT_VORONOI] = words;
  field->select_bytes[OLX_SELECT_BRICKS] = BRICK_BYTES;
  field->select_bytes[OLX_SELECT_VORONOI] = VORONOI_BYTES;
  assert_int_equal(olx_vulkan_field_measure(&device.host, field, &with), OLX_OK);
  assert_true(with.device_bytes >= without.device_bytes + BRICK_BYTES + VORONOI_BYTES);
  assert_measured(field);
  analytic_field_add_classic(field, 32);
  assert_measured(field);
  analytic_field_remove_classic(field);
  analytic_field_free(field);
  olx_release(words);
}

// The limits for a stage that Vulkan guarantees on every device.
enum { MOST_STORAGE_BUFFERS = 4, MOST_STORAGE_IMAGES = 4, MOST_UNIFORM_BUFFERS = 12, MOST_SAMPLED_IMAGES = 16 };
static const struct {
  VkDescriptorType type;
  uint32_t most;
} PROMISED[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, MOST_STORAGE_BUFFERS},
                {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, MOST_STORAGE_IMAGES},
                {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, MOST_UNIFORM_BUFFERS},
                {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, MOST_SAMPLED_IMAGES}};
enum { PROMISES = sizeof PROMISED / sizeof PROMISED[0], MOST_LAYOUTS = 64 };

// Set layouts that were created, how many descriptors of each type they have, and the stages of the first.
static struct {
  VkDescriptorSetLayout layout;
  VkShaderStageFlags stages;
  uint32_t count[PROMISES];
} set_layouts[MOST_LAYOUTS];
static uint32_t set_layout_count, pipeline_layout_count;

static VKAPI_ATTR VkResult VKAPI_CALL counting_set_layout(VkDevice d, const VkDescriptorSetLayoutCreateInfo *info,
                                                          const VkAllocationCallbacks *callbacks,
                                                          VkDescriptorSetLayout *layout) {
  const PFN_vkCreateDescriptorSetLayout real =
      (PFN_vkCreateDescriptorSetLayout)device.GetDeviceProcAddr(d, "vkCreateDescriptorSetLayout");
  const VkResult result = real(d, info, callbacks, layout);
  assert_true(set_layout_count < MOST_LAYOUTS);
  set_layouts[set_layout_count].layout = *layout;
  set_layouts[set_layout_count].stages = info->pBindings[0].stageFlags;
  for (uint32_t k = 0; k < PROMISES; k++) {
    uint32_t *count = &set_layouts[set_layout_count].count[k];
    *count = 0;
    for (uint32_t i = 0; i < info->bindingCount; i++) {
      if (info->pBindings[i].descriptorType == PROMISED[k].type) *count += info->pBindings[i].descriptorCount;
    }
  }
  set_layout_count++;
  return result;
}

static uint32_t number_of_set_layout(VkDescriptorSetLayout layout) {
  uint32_t made = set_layout_count;
  while (made > 0 && set_layouts[made - 1].layout != layout) made--;
  assert_true(made > 0);
  return made - 1;
}

static VKAPI_ATTR VkResult VKAPI_CALL judging_layout(VkDevice d, const VkPipelineLayoutCreateInfo *info,
                                                     const VkAllocationCallbacks *callbacks, VkPipelineLayout *layout) {
  assert_true(info->setLayoutCount <= 4);
  for (uint32_t k = 0; k < PROMISES; k++) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < info->setLayoutCount; i++) {
      count += set_layouts[number_of_set_layout(info->pSetLayouts[i])].count[k];
    }
    if (count > PROMISED[k].most) fail_msg("%u bindings of VkDescriptorType %d", count, (int)PROMISED[k].type);
  }
  pipeline_layout_count++;
  const PFN_vkCreatePipelineLayout real =
      (PFN_vkCreatePipelineLayout)device.GetDeviceProcAddr(d, "vkCreatePipelineLayout");
  return real(d, info, callbacks, layout);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL judging_device_function(VkDevice d, const char *name) {
  if (strcmp(name, "vkCreateDescriptorSetLayout") == 0) return (PFN_vkVoidFunction)counting_set_layout;
  if (strcmp(name, "vkCreatePipelineLayout") == 0) return (PFN_vkVoidFunction)judging_layout;
  return device.GetDeviceProcAddr(d, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL judging_function(VkInstance instance, const char *name) {
  if (strcmp(name, "vkGetDeviceProcAddr") == 0) return (PFN_vkVoidFunction)judging_device_function;
  return device.host.get_instance_proc_addr(instance, name);
}

static void assert_read_by_all_stages_of_hosts(VkDescriptorSetLayout layout) {
  assert_int_equal(set_layouts[number_of_set_layout(layout)].stages,
                   VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT);
}

// The passes need no more bindings a stage than Vulkan guarantees, and the sets that hosts bind themselves serve
// vertex, fragment and compute shaders, as octalux/vulkan.h promises.
static void passes_bind_no_more_than_every_device_has(void **unused) {
  (void)unused;
  host_need_device(&device);
  olx_field *field = host_field_make(16, 8);
  analytic_field_add_classic(field, 32);
  olx_vulkan_host host = device.host;
  host.get_instance_proc_addr = judging_function;
  olx_vulkan_field *uploaded;
  olx_vulkan_classic *classic;
  olx_vulkan_frame *frame;
  assert_int_equal(olx_vulkan_field_create(&host, field, &uploaded), OLX_OK);
  faults_empty_pipelines(&device, &uploaded->context.vk);
  assert_int_equal(olx_vulkan_classic_create(uploaded, field, &classic), OLX_OK);
  assert_read_by_all_stages_of_hosts(olx_vulkan_field_set_layout(uploaded));
  assert_read_by_all_stages_of_hosts(olx_vulkan_classic_set_layout(classic));
  host_images h = make_images(8, 8, VK_FORMAT_R32G32B32A32_SFLOAT);
  h.targets.denoise = OLX_VULKAN_LOBE_DIFFUSE | OLX_VULKAN_LOBE_GLOSSY;
  assert_int_equal(olx_vulkan_frame_create(uploaded, &h.targets, &frame), OLX_OK);
  assert_true(pipeline_layout_count >= 4); // the passes of a frame, both steps of the denoiser, the baseline
  olx_vulkan_frame_destroy(frame);
  olx_vulkan_classic_destroy(classic);
  host_images_free(&h);
  olx_vulkan_field_destroy(uploaded);
  analytic_field_remove_classic(field);
  analytic_field_free(field);
}

static void a_host_without_a_queue_is_refused(void **unused) {
  (void)unused;
  olx_field *field = host_field_make(16, 8);
  const olx_vulkan_host nothing = {.instance = VK_NULL_HANDLE};
  olx_vulkan_field *uploaded;
  olx_vulkan_sizes sizes;
  assert_int_equal(olx_vulkan_field_create(&nothing, field, &uploaded), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_vulkan_field_measure(&nothing, field, &sizes), OLX_ERROR_ARGUMENT);
  if (device.host.device) {
    olx_vulkan_host host = device.host;
    host.queue_family = 1000;
    assert_int_equal(olx_vulkan_field_create(&host, field, &uploaded), OLX_ERROR_ARGUMENT);
  }
  olx_vulkan_field_destroy(NULL);
  olx_vulkan_frame_destroy(NULL);
  analytic_field_free(field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(running_out_of_memory_leaves_nothing_behind),
      cmocka_unit_test(a_lost_device_is_reported),
      cmocka_unit_test(all_memory_is_told_before),
      cmocka_unit_test(passes_bind_no_more_than_every_device_has),
      cmocka_unit_test(a_host_without_a_queue_is_refused),
  };
  return cmocka_run_group_tests(tests, open_device, close_device);
}
