// Creates a relighter's buffers, descriptor sets and pipelines on a device. Passes are grouped so that each group stays
// within the number of storage buffers that every device supports.
#include "vulkan/vulkan_relight.h"

#include "core/hooks.h"
#include "relight/relighter.h"
#include "vulkan/uploader.h"

static const char WHAT[] = "relighting on the device";

static const uint32_t SURFELS[] = {
#include "relight_surfels.spv.inc"
};
static const uint32_t VALUES[] = {
#include "relight_values.spv.inc"
};
static const uint32_t BOUNCE[] = {
#include "relight_bounce.spv.inc"
};
static const uint32_t TEXELS[] = {
#include "relight_texels.spv.inc"
};
static const uint32_t INTERPOLATE[] = {
#include "relight_interpolate.spv.inc"
};
static const uint32_t VOLUME[] = {
#include "relight_volume.spv.inc"
};

static const olx_pass_code CODES[OLX_RELIGHT_PASSES] = {
    [OLX_RELIGHT_SURFELS] = {"relight_surfels", SURFELS, sizeof SURFELS},
    [OLX_RELIGHT_VALUES] = {"relight_values", VALUES, sizeof VALUES},
    [OLX_RELIGHT_BOUNCE] = {"relight_bounce", BOUNCE, sizeof BOUNCE},
    [OLX_RELIGHT_TEXELS] = {"relight_texels", TEXELS, sizeof TEXELS},
    [OLX_RELIGHT_INTERPOLATE] = {"relight_interpolate", INTERPOLATE, sizeof INTERPOLATE},
    [OLX_RELIGHT_VOLUME] = {"relight_volume", VOLUME, sizeof VOLUME},
};

// The buffers that a group's passes use: at most four storage buffers in all.
#define BIT(binding) (1u << (binding))
static const uint32_t OWN_MASKS[OLX_RELIGHT_GROUPS] = {
    [OLX_GROUP_SURFELS] = BIT(OLX_BINDING_STATE) | BIT(OLX_BINDING_STRUCTURE),
    [OLX_GROUP_SITES] = BIT(OLX_BINDING_STATE) | BIT(OLX_BINDING_STRUCTURE) | BIT(OLX_BINDING_VOLUME_LIGHT),
};
static const uint32_t FIELD_MASKS[OLX_RELIGHT_GROUPS] = {
    [OLX_GROUP_SURFELS] = BIT(OLX_BINDING_FIELD) | BIT(OLX_BINDING_PROBES) | BIT(OLX_BINDING_WORDS) |
                          BIT(OLX_BINDING_RADIANCE) | BIT(OLX_BINDING_NORMAL) | BIT(OLX_BINDING_DISTANCE) |
                          BIT(OLX_BINDING_INDIRECT) | BIT(OLX_BINDING_DIRECT) | BIT(OLX_BINDING_BASE) |
                          BIT(OLX_BINDING_SPECULAR),
    [OLX_GROUP_SITES] = BIT(OLX_BINDING_FIELD) | BIT(OLX_BINDING_WORDS) | BIT(OLX_BINDING_DISTANCE),
};

olx_vulkan_relight_settings olx_vulkan_relight_settings_default(void) {
  return (olx_vulkan_relight_settings){.in_flight = 2};
}

// ---- Buffers

static VkBufferUsageFlags usage_of(uint32_t buffer) {
  if (buffer == OLX_BUFFER_RESULTS) return VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  return VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
}

static const char *const NAMES[OLX_RELIGHT_BUFFERS] = {"light", "surfels and links", "sites", "results"};

// Creates the buffers, without memory yet.
static olx_result make_buffers(olx_vulkan_relight *r) {
  const olx_vulkan_context *c = &r->gpu->context;
  for (uint32_t i = 0; i < OLX_RELIGHT_BUFFERS; i++) {
    olx_relight_storage *s = &r->buffers[i];
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = s->words * sizeof(uint32_t), .usage = usage_of(i)};
    if (info.size > c->limits.maxStorageBufferRange) {
      return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: %llu bytes of %s are more than a storage buffer of this device holds",
                      WHAT, (unsigned long long)info.size, NAMES[i]);
    }
    OLX_TRY(olx_vulkan_check(c->vk.CreateBuffer(c->host.device, &info, NULL, &s->buffer), "vkCreateBuffer", WHAT));
    c->vk.GetBufferMemoryRequirements(c->host.device, s->buffer, &s->requirements);
  }
  return OLX_OK;
}

static olx_result bind_buffers(olx_vulkan_relight *r) {
  const olx_vulkan_context *c = &r->gpu->context;
  for (uint32_t i = 0; i < OLX_RELIGHT_BUFFERS; i++) {
    olx_relight_storage *s = &r->buffers[i];
    const VkMemoryPropertyFlags properties =
        i == OLX_BUFFER_RESULTS ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
                                : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    OLX_TRY(olx_vulkan_allocate(c, &s->requirements, properties, WHAT, &s->memory));
    OLX_TRY(
        olx_vulkan_check(c->vk.BindBufferMemory(c->host.device, s->buffer, s->memory, 0), "vkBindBufferMemory", WHAT));
  }
  void *mapped;
  OLX_TRY(olx_vulkan_check(
      c->vk.MapMemory(c->host.device, r->buffers[OLX_BUFFER_RESULTS].memory, 0, VK_WHOLE_SIZE, 0, &mapped),
      "vkMapMemory", WHAT));
  r->results = mapped;
  return OLX_OK;
}

// ---- Sets and pipelines

static void write_own_set(const olx_vulkan_relight *r, olx_relight_group group, VkDescriptorSet set) {
  const olx_vulkan_field *gpu = r->gpu;
  const uint32_t mask = OWN_MASKS[group];
  const olx_relight_buffer structure = group == OLX_GROUP_SURFELS ? OLX_BUFFER_SURFELS : OLX_BUFFER_SITES;
  const VkDescriptorBufferInfo buffers[OLX_RELIGHT_BINDINGS] = {
      [OLX_BINDING_STATE] = {r->buffers[OLX_BUFFER_STATE].buffer, 0, VK_WHOLE_SIZE},
      [OLX_BINDING_STRUCTURE] = {r->buffers[structure].buffer, 0, VK_WHOLE_SIZE},
      [OLX_BINDING_VOLUME_LIGHT] = {gpu->buffer, gpu->words[0].offset, gpu->buffer_bytes - gpu->words[0].offset},
  };
  VkWriteDescriptorSet writes[OLX_RELIGHT_BINDINGS];
  uint32_t count = 0;
  for (uint32_t i = 0; i < OLX_RELIGHT_BINDINGS; i++) {
    if (!(mask >> i & 1u)) continue;
    writes[count++] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                             .dstSet = set,
                                             .dstBinding = i,
                                             .descriptorCount = 1,
                                             .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                             .pBufferInfo = &buffers[i]};
  }
  r->gpu->context.vk.UpdateDescriptorSets(r->gpu->context.host.device, count, writes, 0, NULL);
}

static olx_result make_pool(olx_vulkan_relight *r) {
  const olx_vulkan_context *c = &r->gpu->context;
  enum { SETS = 2 * OLX_RELIGHT_GROUPS };
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, OLX_RELIGHT_GROUPS},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 4 * SETS},
                                        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, OLX_GPU_MAPS * OLX_RELIGHT_GROUPS}};
  const VkDescriptorPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                           .maxSets = SETS,
                                           .poolSizeCount = sizeof sizes / sizeof sizes[0],
                                           .pPoolSizes = sizes};
  return olx_vulkan_check(c->vk.CreateDescriptorPool(c->host.device, &info, NULL, &r->pool), "vkCreateDescriptorPool",
                          WHAT);
}

static olx_result make_group(olx_vulkan_relight *r, olx_relight_group index) {
  const olx_vulkan_context *c = &r->gpu->context;
  olx_gpu_group *g = &r->groups[index];
  const uint32_t own = OWN_MASKS[index], field = FIELD_MASKS[index];
  const olx_set_bindings bindings = {.buffers = own, .stages = VK_SHADER_STAGE_COMPUTE_BIT};
  OLX_TRY(olx_vulkan_set_layout_create(c, &bindings, WHAT, &g->own_layout));
  OLX_TRY(olx_gpu_set_allocate(c, r->pool, g->own_layout, &g->own));
  write_own_set(r, index, g->own);
  OLX_TRY(olx_gpu_field_set_layout(c, field, &g->field_layout));
  OLX_TRY(olx_gpu_set_allocate(c, r->pool, g->field_layout, &g->field));
  olx_gpu_field_write_set(r->gpu, field, g->field);
  const VkDescriptorSetLayout sets[] = {g->own_layout, g->field_layout};
  return olx_gpu_layout_create(c, 2, sets, sizeof(olx_gpu_relight_call), &g->layout);
}

static olx_result make_pipelines(olx_vulkan_relight *r) {
  OLX_TRY(make_pool(r));
  for (uint32_t i = 0; i < OLX_RELIGHT_GROUPS; i++) OLX_TRY(make_group(r, i));
  const olx_pass_constants constants = {OLX_TRACER_HIZ, olx_vulkan_field_select(r->gpu, OLX_SELECT_BEST),
                                        OLX_HITS_STORED, olx_gpu_field_geometry(r->gpu)};
  for (uint32_t i = 0; i < OLX_RELIGHT_PASSES; i++) {
    OLX_TRY(olx_gpu_pipeline_create(&r->gpu->context, &CODES[i], &constants, r->groups[olx_relight_group_of(i)].layout,
                                    &r->pipelines[i]));
  }
  return OLX_OK;
}

// ---- The whole relighter

static olx_result check(const olx_vulkan_field *gpu, const olx_relight *relight, const olx_vulkan_relight_settings *s) {
  if (!olx_gpu_field_relights(gpu, &relight->field)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: the relighter's field has maps of other number or size", WHAT);
  }
  if (s->in_flight < 1 || s->in_flight > OLX_RELIGHT_MOST_IN_FLIGHT) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: %u frames in flight: must be from 1 to %d", WHAT, s->in_flight,
                    OLX_RELIGHT_MOST_IN_FLIGHT);
  }
  if (relight->settings.occlusion) {
    return olx_fail(OLX_ERROR_ARGUMENT,
                    "%s: shadow rays are traced through the field there, and the relighter has an "
                    "occlusion function",
                    WHAT);
  }
  if (olx_relit_has_begun(relight)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "%s: the relighter has made frames already", WHAT);
  }
  return OLX_OK;
}

static olx_result begin(olx_vulkan_field *gpu, const olx_relight *relight, const olx_vulkan_relight_settings *settings,
                        olx_vulkan_relight **created) {
  OLX_TRY(check(gpu, relight, settings));
  olx_vulkan_relight *r = olx_allocate_zero(1, sizeof *r);
  if (!r) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for its handle", WHAT);
  r->gpu = gpu;
  r->lights = &relight->lights;
  r->settings = *settings;
  olx_gpu_relight_lay_out(r, relight);
  const olx_result result = make_buffers(r);
  if (result == OLX_OK) *created = r;
  else olx_vulkan_relight_destroy(r);
  return result;
}

static olx_result finish(olx_vulkan_relight *r, const olx_relight *relight) {
  OLX_TRY(bind_buffers(r));
  OLX_TRY(olx_gpu_relight_fill(r, relight));
  return make_pipelines(r);
}

olx_result olx_vulkan_relight_measure(olx_vulkan_field *field, olx_relight *relight,
                                      const olx_vulkan_relight_settings *settings, olx_vulkan_sizes *sizes) {
  *sizes = (olx_vulkan_sizes){.allocations = OLX_RELIGHT_BUFFERS};
  olx_vulkan_relight *r = NULL;
  OLX_TRY(begin(field, relight, settings, &r));
  for (uint32_t i = 0; i < OLX_BUFFER_RESULTS; i++) sizes->device_bytes += r->buffers[i].requirements.size;
  sizes->staging_bytes =
      r->buffers[OLX_BUFFER_RESULTS].requirements.size + (uint64_t)OLX_STAGING_SLOTS * OLX_STAGING_SLOT_BYTES;
  olx_vulkan_relight_destroy(r);
  return OLX_OK;
}

olx_result olx_vulkan_relight_create(olx_vulkan_field *field, olx_relight *relight,
                                     const olx_vulkan_relight_settings *settings, olx_vulkan_relight **created) {
  *created = NULL;
  olx_vulkan_relight *r = NULL;
  OLX_TRY(begin(field, relight, settings, &r));
  const olx_result result = finish(r, relight);
  if (result != OLX_OK) {
    olx_vulkan_relight_destroy(r);
    return result;
  }
  r->schedule = olx_relit_hand_over(relight);
  *created = r;
  return OLX_OK;
}

void olx_vulkan_relight_destroy(olx_vulkan_relight *r) {
  if (!r) return;
  const olx_vulkan_functions *vk = &r->gpu->context.vk;
  const VkDevice device = r->gpu->context.host.device;
  for (uint32_t i = 0; i < OLX_RELIGHT_PASSES; i++) vk->DestroyPipeline(device, r->pipelines[i], NULL);
  for (uint32_t i = 0; i < OLX_RELIGHT_GROUPS; i++) {
    vk->DestroyPipelineLayout(device, r->groups[i].layout, NULL);
    vk->DestroyDescriptorSetLayout(device, r->groups[i].own_layout, NULL);
    vk->DestroyDescriptorSetLayout(device, r->groups[i].field_layout, NULL);
  }
  vk->DestroyDescriptorPool(device, r->pool, NULL);
  for (uint32_t i = 0; i < OLX_RELIGHT_BUFFERS; i++) {
    vk->DestroyBuffer(device, r->buffers[i].buffer, NULL);
    vk->FreeMemory(device, r->buffers[i].memory, NULL);
  }
  olx_release(r);
}
