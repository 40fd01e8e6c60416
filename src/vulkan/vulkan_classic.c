// Uploads classic maps, irradiance probes without visibility, to a device, and records the pass that lights a frame
// with them for comparison.
#include "core/hooks.h"
#include "vulkan/uploader.h"
#include "vulkan/vulkan_frame.h"

static const char WHAT[] = "classic maps on the device";

static const uint32_t WORDS[] = {
#include "classic.spv.inc"
};
static const olx_pass_code CODE = {"classic", WORDS, sizeof WORDS};

struct olx_vulkan_classic {
  olx_vulkan_field *field;
  uint32_t header[OLX_CLASSIC_HEADER_WORDS];
  VkDeviceSize bytes;
  VkBuffer buffer;
  VkDeviceMemory memory;
  VkDescriptorSetLayout set_layout, frame_set_layout, sample_set_layout; // the last one is like that of every frame
  VkDescriptorPool pool;
  VkDescriptorSet set;
  VkPipelineLayout layout;
  VkPipeline pipeline;
};

// A part of the buffer, and the word of the header that holds its offset.
typedef struct classic_part {
  const void *data;
  uint64_t words;
  uint32_t header;
} classic_part;

enum { PARTS = 4 };

static void list_parts(const olx_field *field, classic_part parts[PARTS]) {
  const olx_classic_maps *maps = &field->classic;
  const uint64_t probes = field->info.irradiance.probe_count;
  parts[0] = (classic_part){maps->table, OLX_CLASSIC_TABLE_ENTRIES, OLX_CLASSIC_TABLE};
  parts[1] = (classic_part){maps->boxes, probes * sizeof(olx_classic_box) / sizeof(uint32_t), OLX_CLASSIC_BOXES};
  parts[2] = (classic_part){maps->irradiance, probes * maps->irradiance_texels, OLX_CLASSIC_IRRADIANCE};
  parts[3] = (classic_part){maps->radiance, probes * maps->radiance_texels, OLX_CLASSIC_RADIANCE};
}

static void lay_out(olx_vulkan_classic *classic, const olx_field *field) {
  classic_part parts[PARTS];
  list_parts(field, parts);
  classic->header[OLX_CLASSIC_SIZE] = field->classic.size;
  classic->header[OLX_CLASSIC_RADIANCE_WORDS] = (uint32_t)field->classic.radiance_texels;
  uint64_t words = OLX_CLASSIC_HEADER_WORDS;
  for (uint32_t i = 0; i < PARTS; i++) {
    classic->header[parts[i].header] = (uint32_t)words;
    words += parts[i].words;
  }
  classic->bytes = words * sizeof(uint32_t);
}

static olx_result check_range(const olx_vulkan_context *c, const olx_vulkan_classic *classic, const olx_field *field) {
  if (classic->bytes <= c->limits.maxStorageBufferRange) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED,
                  "classic maps of %u probes are more than a storage buffer of this device holds",
                  field->info.irradiance.probe_count);
}

// Creates the buffer, without memory yet.
static olx_result make_buffer(const olx_vulkan_context *c, olx_vulkan_classic *classic,
                              VkMemoryRequirements *requirements) {
  const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                   .size = classic->bytes,
                                   .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  OLX_TRY(olx_vulkan_check(c->vk.CreateBuffer(c->host.device, &info, NULL, &classic->buffer), "vkCreateBuffer", WHAT));
  c->vk.GetBufferMemoryRequirements(c->host.device, classic->buffer, requirements);
  return OLX_OK;
}

olx_result olx_vulkan_classic_measure(const olx_vulkan_context *c, const olx_field *field, uint64_t *bytes) {
  *bytes = 0;
  if (field->classic.size == 0) return OLX_OK;
  olx_vulkan_classic classic = {.bytes = 0};
  VkMemoryRequirements requirements;
  lay_out(&classic, field);
  OLX_TRY(make_buffer(c, &classic, &requirements));
  c->vk.DestroyBuffer(c->host.device, classic.buffer, NULL);
  *bytes = requirements.size;
  return OLX_OK;
}

static olx_result create_buffer(olx_vulkan_classic *classic) {
  const olx_vulkan_context *c = &classic->field->context;
  VkMemoryRequirements requirements;
  OLX_TRY(make_buffer(c, classic, &requirements));
  OLX_TRY(olx_vulkan_allocate(c, &requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, WHAT, &classic->memory));
  return olx_vulkan_check(c->vk.BindBufferMemory(c->host.device, classic->buffer, classic->memory, 0),
                          "vkBindBufferMemory", WHAT);
}

static olx_result upload_parts(olx_vulkan_classic *classic, const olx_field *field, olx_uploader *uploader) {
  classic_part parts[PARTS];
  list_parts(field, parts);
  OLX_TRY(olx_uploader_copy(uploader, classic->header, sizeof classic->header, classic->buffer, 0));
  for (uint32_t i = 0; i < PARTS; i++) {
    OLX_TRY(olx_uploader_copy(uploader, parts[i].data, parts[i].words * sizeof(uint32_t), classic->buffer,
                              classic->header[parts[i].header] * sizeof(uint32_t)));
  }
  void *memory;
  VkDeviceSize offset;
  VkCommandBuffer commands;
  OLX_TRY(olx_uploader_reserve(uploader, 0, &memory, &offset, &commands));
  const VkMemoryBarrier written = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                   .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                   .dstAccessMask = VK_ACCESS_SHADER_READ_BIT};
  classic->field->context.vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                                                VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &written, 0, NULL, 0, NULL);
  return olx_uploader_finish(uploader);
}

static olx_result upload(olx_vulkan_classic *classic, const olx_field *field) {
  olx_uploader uploader;
  olx_result result = olx_uploader_begin(&classic->field->context, &uploader);
  if (result == OLX_OK) result = upload_parts(classic, field, &uploader);
  olx_uploader_end(&uploader);
  return result;
}

static olx_result create_set(olx_vulkan_classic *classic) {
  const olx_vulkan_context *c = &classic->field->context;
  const olx_set_bindings bindings = {.buffers = 1, .stages = OLX_HOST_STAGES};
  OLX_TRY(olx_vulkan_set_layout_create(c, &bindings, WHAT, &classic->set_layout));
  const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1};
  const VkDescriptorPoolCreateInfo pool = {
      .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
  OLX_TRY(olx_vulkan_check(c->vk.CreateDescriptorPool(c->host.device, &pool, NULL, &classic->pool),
                           "vkCreateDescriptorPool", WHAT));
  OLX_TRY(olx_gpu_set_allocate(c, classic->pool, classic->set_layout, &classic->set));
  const VkDescriptorBufferInfo buffer = {classic->buffer, 0, classic->bytes};
  const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                      .dstSet = classic->set,
                                      .descriptorCount = 1,
                                      .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                      .pBufferInfo = &buffer};
  c->vk.UpdateDescriptorSets(c->host.device, 1, &write, 0, NULL);
  return OLX_OK;
}

static olx_result create_classic(olx_vulkan_classic *classic, const olx_field *field) {
  const olx_vulkan_context *c = &classic->field->context;
  lay_out(classic, field);
  OLX_TRY(check_range(c, classic, field));
  OLX_TRY(create_buffer(classic));
  OLX_TRY(upload(classic, field));
  OLX_TRY(create_set(classic));
  OLX_TRY(olx_gpu_set_layout_create(c, OLX_FRAME_BINDINGS, OLX_BINDING_OUT_IRRADIANCE, &classic->frame_set_layout));
  OLX_TRY(olx_gpu_set_layout_create(c, OLX_SAMPLE_BINDINGS, 0, &classic->sample_set_layout));
  const VkDescriptorSetLayout sets[] = {classic->field->set_layout, classic->frame_set_layout,
                                        classic->sample_set_layout, classic->set_layout};
  OLX_TRY(olx_gpu_layout_create(c, 4, sets, sizeof(olx_frame_constants), &classic->layout));
  return olx_gpu_pipeline_create(c, &CODE, NULL, classic->layout, &classic->pipeline);
}

olx_result olx_vulkan_classic_create(olx_vulkan_field *uploaded, const olx_field *field, olx_vulkan_classic **created) {
  *created = NULL;
  OLX_TRY(olx_classic_check(field));
  olx_vulkan_classic *classic = olx_allocate_zero(1, sizeof *classic);
  if (!classic) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for their handle", WHAT);
  classic->field = uploaded;
  const olx_result result = create_classic(classic, field);
  if (result != OLX_OK) {
    olx_vulkan_classic_destroy(classic);
    return result;
  }
  *created = classic;
  return OLX_OK;
}

void olx_vulkan_classic_destroy(olx_vulkan_classic *classic) {
  if (!classic) return;
  const olx_vulkan_functions *vk = &classic->field->context.vk;
  const VkDevice device = classic->field->context.host.device;
  vk->DestroyPipeline(device, classic->pipeline, NULL);
  vk->DestroyPipelineLayout(device, classic->layout, NULL);
  vk->DestroyDescriptorPool(device, classic->pool, NULL);
  vk->DestroyDescriptorSetLayout(device, classic->set_layout, NULL);
  vk->DestroyDescriptorSetLayout(device, classic->frame_set_layout, NULL);
  vk->DestroyDescriptorSetLayout(device, classic->sample_set_layout, NULL);
  vk->DestroyBuffer(device, classic->buffer, NULL);
  vk->FreeMemory(device, classic->memory, NULL);
  olx_release(classic);
}

VkDescriptorSetLayout olx_vulkan_classic_set_layout(const olx_vulkan_classic *classic) { return classic->set_layout; }
VkDescriptorSet olx_vulkan_classic_set(const olx_vulkan_classic *classic) { return classic->set; }

olx_result olx_vulkan_record_classic(const olx_vulkan_frame *f, const olx_vulkan_classic *classic,
                                     VkCommandBuffer commands, const olx_vulkan_view *view,
                                     const olx_vulkan_settings *settings) {
  OLX_TRY(olx_vulkan_check_settings(f, settings));
  const olx_vulkan_functions *vk = &f->field->context.vk;
  const olx_frame_constants constants = olx_gpu_frame_constants(f, view, settings, 0);
  const VkDescriptorSet sets[] = {f->field->set, f->set};
  vk->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, classic->pipeline);
  vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, classic->layout, 0, 2, sets, 0, NULL);
  vk->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, classic->layout, 3, 1, &classic->set, 0, NULL);
  vk->CmdPushConstants(commands, classic->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
  olx_vulkan_dispatch(f, commands);
  return OLX_OK;
}
