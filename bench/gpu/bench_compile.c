// Compiles every pipeline of the library for a device on which nothing runs, and prints the compiler's statistics. The
// library is given Vulkan functions of which those that make pipelines are the driver's, and the others do nothing.
#include "bench_compile.h"

#include <octalux/relight.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_STATISTICS = 32, MOST_NAMES = 12, SIDE = 8 };

// The pipelines that one call of the library creates, in this order.
typedef struct compile_step {
  const char *names[MOST_NAMES];
  uint32_t count;
} compile_step;

// Global, because Vulkan's functions take no pointer of the caller's.
static struct {
  gpu_device *device;
  const compile_step *step;
  uint32_t made;
  const char *suffix; // appended to names: tracer and selector
  bool json;
  uint32_t printed;
  PFN_vkGetDeviceProcAddr get;
  PFN_vkCreateComputePipelines create;
  PFN_vkGetPipelineExecutableStatisticsKHR statistics;
} job;

static double processor_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// ---- Output

static void print_value(const VkPipelineExecutableStatisticKHR *s) {
  switch (s->format) {
  case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR: printf("%u", s->value.b32); break;
  case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR: printf("%lld", (long long)s->value.i64); break;
  case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_FLOAT64_KHR: printf("%g", s->value.f64); break;
  default: printf("%llu", (unsigned long long)s->value.u64);
  }
}

static void print_pipeline(const char *name, double seconds, const VkPipelineExecutableStatisticKHR *s,
                           uint32_t count) {
  if (job.json) printf("%s\"%s%s\":{\"processor seconds\":%.3f", job.printed ? "," : "", name, job.suffix, seconds);
  else printf("%s%s: %.2f s", name, job.suffix, seconds);
  for (uint32_t i = 0; i < count; i++) {
    printf(job.json ? ",\"%s\":" : ", %s ", s[i].name);
    print_value(&s[i]);
  }
  printf(job.json ? "}" : "\n");
  job.printed++;
}

static void report(VkPipeline pipeline, double seconds) {
  VkPipelineExecutableStatisticKHR found[MOST_STATISTICS];
  for (uint32_t i = 0; i < MOST_STATISTICS; i++) {
    found[i] = (VkPipelineExecutableStatisticKHR){.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR};
  }
  uint32_t count = 0;
  if (job.statistics) {
    const VkPipelineExecutableInfoKHR which = {.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR,
                                               .pipeline = pipeline};
    count = MOST_STATISTICS;
    if (job.statistics(job.device->host.device, &which, &count, found) < 0) count = 0;
  }
  print_pipeline(job.made < job.step->count ? job.step->names[job.made] : "?", seconds, found, count);
  job.made++;
}

// ---- A device that only creates pipelines

static VKAPI_ATTR VkResult VKAPI_CALL create_pipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                       const VkComputePipelineCreateInfo *infos,
                                                       const VkAllocationCallbacks *allocator, VkPipeline *pipelines) {
  for (uint32_t i = 0; i < count; i++) {
    VkComputePipelineCreateInfo info = infos[i];
    if (job.statistics) info.flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
    const double start = processor_seconds();
    const VkResult result = job.create(device, cache, 1, &info, allocator, &pipelines[i]);
    if (result != VK_SUCCESS) return result;
    report(pipelines[i], processor_seconds() - start);
  }
  return VK_SUCCESS;
}

// The library only fills and reads memory: a memory handle is its address, and a buffer handle is its size.
static VKAPI_ATTR VkResult VKAPI_CALL create_buffer(VkDevice device, const VkBufferCreateInfo *info,
                                                    const VkAllocationCallbacks *allocator, VkBuffer *buffer) {
  (void)device, (void)allocator;
  *buffer = (VkBuffer)(uintptr_t)info->size;
  return VK_SUCCESS;
}

static VKAPI_ATTR void VKAPI_CALL buffer_requirements(VkDevice device, VkBuffer buffer, VkMemoryRequirements *needs) {
  (void)device;
  *needs = (VkMemoryRequirements){.size = (uintptr_t)buffer, .alignment = 256, .memoryTypeBits = UINT32_MAX};
}

static VKAPI_ATTR void VKAPI_CALL image_requirements(VkDevice device, VkImage image, VkMemoryRequirements *needs) {
  (void)device, (void)image;
  *needs = (VkMemoryRequirements){.size = 256, .alignment = 256, .memoryTypeBits = UINT32_MAX};
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice device, const VkMemoryAllocateInfo *info,
                                                      const VkAllocationCallbacks *allocator, VkDeviceMemory *memory) {
  (void)device, (void)allocator;
  *memory = (VkDeviceMemory)(uintptr_t)calloc(1, (size_t)info->allocationSize);
  return *memory ? VK_SUCCESS : VK_ERROR_OUT_OF_HOST_MEMORY;
}

static VKAPI_ATTR void VKAPI_CALL free_memory(VkDevice device, VkDeviceMemory memory,
                                              const VkAllocationCallbacks *allocator) {
  (void)device, (void)allocator;
  free((void *)(uintptr_t)memory);
}

static VKAPI_ATTR VkResult VKAPI_CALL map_memory(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset,
                                                 VkDeviceSize size, VkMemoryMapFlags flags, void **data) {
  (void)device, (void)size, (void)flags;
  *data = (char *)(uintptr_t)memory + offset;
  return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_commands(VkDevice device, const VkCommandBufferAllocateInfo *info,
                                                        VkCommandBuffer *commands) {
  (void)device;
  for (uint32_t i = 0; i < info->commandBufferCount; i++) commands[i] = (VkCommandBuffer)(uintptr_t)1;
  return VK_SUCCESS;
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_sets(VkDevice device, const VkDescriptorSetAllocateInfo *info,
                                                    VkDescriptorSet *sets) {
  (void)device;
  for (uint32_t i = 0; i < info->descriptorSetCount; i++) sets[i] = (VkDescriptorSet)(uintptr_t)1;
  return VK_SUCCESS;
}

// Creates any other object, of which the library uses only the handle.
static VKAPI_ATTR VkResult VKAPI_CALL create_other(VkDevice device, const void *info,
                                                   const VkAllocationCallbacks *allocator, void **handle) {
  (void)device, (void)info, (void)allocator;
  *handle = (void *)(uintptr_t)1;
  return VK_SUCCESS;
}

// Replaces all functions that only use created objects: it ignores its arguments and succeeds.
static VKAPI_ATTR VkResult VKAPI_CALL do_nothing(void) { return VK_SUCCESS; }

static bool begins_with(const char *name, const char *word) { return strncmp(name, word, strlen(word)) == 0; }

// Forwards only the driver's functions that create and destroy layouts and pipelines.
static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_function(VkDevice device, const char *name) {
  static const char *const real[] = {"vkCreateDescriptorSetLayout",
                                     "vkDestroyDescriptorSetLayout",
                                     "vkCreatePipelineLayout",
                                     "vkDestroyPipelineLayout",
                                     "vkCreateShaderModule",
                                     "vkDestroyShaderModule",
                                     "vkDestroyPipeline"};
  static const struct {
    const char *name;
    PFN_vkVoidFunction function;
  } ours[] = {{"vkCreateComputePipelines", (PFN_vkVoidFunction)create_pipelines},
              {"vkCreateBuffer", (PFN_vkVoidFunction)create_buffer},
              {"vkGetBufferMemoryRequirements", (PFN_vkVoidFunction)buffer_requirements},
              {"vkGetImageMemoryRequirements", (PFN_vkVoidFunction)image_requirements},
              {"vkAllocateMemory", (PFN_vkVoidFunction)allocate_memory},
              {"vkFreeMemory", (PFN_vkVoidFunction)free_memory},
              {"vkMapMemory", (PFN_vkVoidFunction)map_memory},
              {"vkAllocateCommandBuffers", (PFN_vkVoidFunction)allocate_commands},
              {"vkAllocateDescriptorSets", (PFN_vkVoidFunction)allocate_sets}};
  for (uint32_t i = 0; i < sizeof real / sizeof real[0]; i++) {
    if (strcmp(name, real[i]) == 0) return job.get(device, name);
  }
  for (uint32_t i = 0; i < sizeof ours / sizeof ours[0]; i++) {
    if (strcmp(name, ours[i].name) == 0) return ours[i].function;
  }
  return begins_with(name, "vkCreate") ? (PFN_vkVoidFunction)create_other : (PFN_vkVoidFunction)do_nothing;
}

// Reports a single memory type for everything, because devices that do not exist have none.
static VKAPI_ATTR void VKAPI_CALL memory_properties(VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties *memory) {
  (void)device;
  *memory = (VkPhysicalDeviceMemoryProperties){
      .memoryTypeCount = 1, .memoryTypes = {{.propertyFlags = ~(VkMemoryPropertyFlags)0}}, .memoryHeapCount = 1};
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_function(VkInstance instance, const char *name) {
  if (strcmp(name, "vkGetDeviceProcAddr") == 0) return (PFN_vkVoidFunction)get_device_function;
  if (strcmp(name, "vkGetPhysicalDeviceMemoryProperties") == 0) return (PFN_vkVoidFunction)memory_properties;
  return job.device->host.get_instance_proc_addr(instance, name);
}

// ---- Compilation

static bool begin_step(const compile_step *step, const char *suffix) {
  job.step = step;
  job.suffix = suffix;
  job.made = 0;
  return true;
}

// Ends a step, and checks that the library created the expected pipelines.
static bool end_step(olx_result result) {
  if (!gpu_check_library(job.device, result)) return false;
  if (job.made == job.step->count) return true;
  return gpu_fail(job.device, "%u pipelines were made with %s, in place of %u", job.made, job.step->names[0],
                  job.step->count);
}

// Creates targets of images that are never read.
static olx_vulkan_targets make_targets(void) {
  const VkImageView view = (VkImageView)(uintptr_t)1;
  const olx_vulkan_image input = {view, VK_FORMAT_R16G16B16A16_SFLOAT, VK_IMAGE_LAYOUT_GENERAL};
  return (olx_vulkan_targets){.width = SIDE,
                              .height = SIDE,
                              .depth = input,
                              .normal = input,
                              .albedo = input,
                              .roughness = input,
                              .irradiance = view,
                              .glossy = view,
                              .color = view,
                              .denoise = OLX_VULKAN_LOBE_DIFFUSE | OLX_VULKAN_LOBE_GLOSSY};
}

// Compiles the passes of a frame as most games record them, and traced diffuse light.
static bool compile_frame(olx_vulkan_frame **frame, olx_vulkan_field *field, olx_vulkan_targets targets) {
  static const compile_step plain = {{"irradiance", "composite", "accumulate", "filter"}, 4};
  static const compile_step glossy = {{"glossy", "dim"}, 2}, diffuse = {{"diffuse"}, 1};
  targets.passes = OLX_VULKAN_PASS_IRRADIANCE | OLX_VULKAN_PASS_COMPOSITE;
  bool fine = begin_step(&plain, "") && end_step(olx_vulkan_frame_create(field, &targets, frame));
  targets.passes = OLX_VULKAN_PASS_GLOSSY;
  targets.hits = 1u << OLX_HITS_SHADED;
  fine = fine && begin_step(&glossy, "") && end_step(olx_vulkan_frame_resize(*frame, &targets));
  targets.passes = OLX_VULKAN_PASS_DIFFUSE;
  return fine && begin_step(&diffuse, "") && end_step(olx_vulkan_frame_resize(*frame, &targets));
}

// Compiles the glossy pass with other tracers, selectors and light at hits.
static bool compile_variants(olx_vulkan_frame *frame, olx_vulkan_field *field, bool has_probe_light,
                             olx_vulkan_targets targets) {
  static const compile_step again = {{"glossy"}, 1};
  static const compile_step stored = {{"glossy, stored"}, 1};
  static const char *const tracers[] = {", texel", ", two-level", ", hi-Z"};
  static const struct {
    olx_select select;
    const char *name;
  } selectors[] = {{OLX_SELECT_CAGE, ", cage"},
                   {OLX_SELECT_BRICKS, ", bricks"},
                   {OLX_SELECT_VORONOI, ", voronoi"},
                   {OLX_SELECT_EXHAUSTIVE, ", exhaustive"}};
  const olx_select best = olx_vulkan_field_select(field, OLX_SELECT_BEST); // already compiled
  bool fine = true;
  targets.passes = OLX_VULKAN_PASS_GLOSSY;
  if (has_probe_light) {
    targets.hits = 1u << OLX_HITS_STORED;
    fine = fine && begin_step(&stored, "") && end_step(olx_vulkan_frame_resize(frame, &targets));
  }
  targets.hits = 1u << OLX_HITS_SHADED;
  for (olx_tracer tracer = OLX_TRACER_TEXEL; fine && tracer < OLX_TRACER_HIZ; tracer++) {
    targets.tracers = 1u << tracer;
    fine = begin_step(&again, tracers[tracer]) && end_step(olx_vulkan_frame_resize(frame, &targets));
  }
  targets.tracers = 1u << OLX_TRACER_HIZ;
  for (uint32_t i = 0; fine && i < sizeof selectors / sizeof selectors[0]; i++) {
    const olx_select select = selectors[i].select;
    if (select == best || olx_vulkan_field_select(field, select) != select) continue; // already compiled, or absent
    targets.selects = 1u << select;
    fine = begin_step(&again, selectors[i].name) && end_step(olx_vulkan_frame_resize(frame, &targets));
  }
  return fine;
}

static bool compile_classic(olx_vulkan_field *uploaded, const olx_field *field) {
  static const compile_step step = {{"classic"}, 1};
  if (olx_classic_check(field) != OLX_OK) return true;
  olx_vulkan_classic *classic = NULL;
  const bool fine = begin_step(&step, "") && end_step(olx_vulkan_classic_create(uploaded, field, &classic));
  olx_vulkan_classic_destroy(classic);
  return fine;
}

static bool compile_relight(olx_vulkan_field *uploaded, const olx_field *field) {
  static const compile_step step = {{"relight_surfels", "relight_values", "relight_bounce", "relight_texels",
                                     "relight_interpolate", "relight_volume"},
                                    6};
  if (olx_field_describe(field).relight.surfels == 0) return true;
  const olx_relight_settings settings = olx_relight_settings_default();
  const olx_vulkan_relight_settings on_device = olx_vulkan_relight_settings_default();
  olx_relight *relight = NULL;
  olx_vulkan_relight *made = NULL;
  const bool fine = gpu_check_library(job.device, olx_relight_create(field, &settings, &relight)) &&
                    begin_step(&step, "") && end_step(olx_vulkan_relight_create(uploaded, relight, &on_device, &made));
  olx_vulkan_relight_destroy(made);
  olx_relight_free(relight);
  return fine;
}

static bool compile_all(const olx_field *field, bool quick) {
  olx_vulkan_host host = job.device->host;
  host.get_instance_proc_addr = get_function;
  const bool has_probe_light = olx_probe_light_check(field) == OLX_OK;
  olx_vulkan_field *uploaded = NULL;
  olx_vulkan_frame *frame = NULL;
  bool fine = gpu_check_library(job.device, olx_vulkan_field_create(&host, field, &uploaded)) &&
              compile_frame(&frame, uploaded, make_targets());
  if (!quick) {
    fine =
        fine && compile_variants(frame, uploaded, has_probe_light, make_targets()) && compile_classic(uploaded, field);
  }
  fine = fine && compile_relight(uploaded, field);
  olx_vulkan_frame_destroy(frame);
  olx_vulkan_field_destroy(uploaded);
  return fine;
}

bool bench_compile(gpu_device *d, const char *field_path, bool quick, bool json) {
  olx_field *field;
  if (!gpu_check_library(d, olx_field_open(field_path, &field))) return false;
  memset(&job, 0, sizeof job);
  job.device = d;
  job.json = json;
  job.get = d->GetDeviceProcAddr;
  job.create = d->CreateComputePipelines;
  if (d->statistics) {
    job.statistics = (PFN_vkGetPipelineExecutableStatisticsKHR)d->GetDeviceProcAddr(
        d->host.device, "vkGetPipelineExecutableStatisticsKHR");
  }
  if (json) {
    printf("{\"device\":\"%s\",\"driver\":\"%s %s\",\"quick\":%s,\"pipelines\":{", d->properties.deviceName,
           d->driver.driverName, d->driver.driverInfo, quick ? "true" : "false");
  } else {
    printf("%s (%s %s)\n", d->properties.deviceName, d->driver.driverName, d->driver.driverInfo);
  }
  const bool fine = compile_all(field, quick);
  if (json) printf("}}\n");
  olx_field_close(field);
  return fine;
}
