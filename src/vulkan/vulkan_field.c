// Lays out a field on a device: an image for each kind of map, one buffer for all else, and the descriptor set through
// which every pass reads them.
#include "vulkan/vulkan_field.h"

#include "core/hooks.h"
#include "trace/texel_shade.h"
#include "vulkan/uploader.h"

static const char WHAT[] = "a field on the device";

enum { ALL_BINDINGS = (1 << OLX_FIELD_BINDINGS) - 1 };

// Lays out the blocks of a pool in rows.
static olx_result lay_out_pool(const olx_vulkan_context *c, olx_gpu_maps *maps) {
  const uint32_t most_layers = c->limits.maxImageArrayLayers;
  maps->maps_a_side = OLX_POOL_ROW;
  maps->layers = (olx_pool_rows(maps->count) + OLX_POOL_ROW - 1) / OLX_POOL_ROW;
  if (maps->layers <= most_layers) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%u blocks of surfaces do not fit into %u layers of %d on this device",
                  maps->count, most_layers, OLX_POOL_ROW * OLX_POOL_ROW);
}

// Computes how many maps share a layer, so that the image has no more layers, and layers no more texels, than the
// device allows.
static olx_result lay_out_maps(const olx_vulkan_context *c, olx_gpu_maps *maps) {
  const uint32_t most_layers = c->limits.maxImageArrayLayers, most_texels = c->limits.maxImageDimension2D;
  for (maps->maps_a_side = 1; maps->maps_a_side * maps->stride <= most_texels; maps->maps_a_side++) {
    const uint32_t maps_a_layer = maps->maps_a_side * maps->maps_a_side;
    maps->layers = (maps->count + maps_a_layer - 1) / maps_a_layer;
    if (maps->layers <= most_layers) return OLX_OK;
  }
  return olx_fail(OLX_ERROR_UNSUPPORTED,
                  "%u maps of %u x %u texels do not fit into %u layers of %u x %u on this device", maps->count,
                  maps->stride, maps->stride, most_layers, most_texels, most_texels);
}

static olx_result check_format(const olx_vulkan_context *c, const olx_gpu_maps *maps) {
  VkFormatProperties properties;
  c->vk.GetPhysicalDeviceFormatProperties(c->host.physical_device, maps->format, &properties);
  const VkFormatFeatureFlags needed =
      VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_TRANSFER_DST_BIT |
      (maps->filtered ? (VkFormatFeatureFlags)VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT : 0);
  if ((properties.optimalTilingFeatures & needed) == needed) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "the device cannot sample%s images of VkFormat %d",
                  maps->filtered ? " and filter" : "", (int)maps->format);
}

static olx_result create_image(const olx_vulkan_context *c, olx_gpu_maps *maps) {
  OLX_TRY(maps->pooled ? lay_out_pool(c, maps) : lay_out_maps(c, maps));
  OLX_TRY(check_format(c, maps));
  const uint32_t pool_rows = maps->layers > 1 ? OLX_POOL_ROW : olx_pool_rows(maps->count),
                 width = maps->pooled ? OLX_POOL_ROW * OLX_BLOCK_SIDE : maps->maps_a_side * maps->stride,
                 height = maps->pooled ? pool_rows * OLX_BLOCK_SIDE : width;
  const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                  .imageType = VK_IMAGE_TYPE_2D,
                                  .format = maps->format,
                                  .extent = {width, height, 1},
                                  .mipLevels = 1,
                                  .arrayLayers = maps->layers,
                                  .samples = VK_SAMPLE_COUNT_1_BIT,
                                  .tiling = VK_IMAGE_TILING_OPTIMAL,
                                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
  OLX_TRY(olx_vulkan_check(c->vk.CreateImage(c->host.device, &info, NULL, &maps->image), "vkCreateImage", WHAT));
  c->vk.GetImageMemoryRequirements(c->host.device, maps->image, &maps->requirements);
  return OLX_OK;
}

static VkDeviceSize align_buffer(const olx_vulkan_context *c, VkDeviceSize offset) {
  const VkDeviceSize a = c->limits.minStorageBufferOffsetAlignment, b = c->limits.minUniformBufferOffsetAlignment;
  const VkDeviceSize alignment = a > b ? a : b;
  return (offset + alignment - 1) / alignment * alignment;
}

// Rounds up to whole words, because shaders read words and codes of one byte may end within one.
static VkDeviceSize whole_words(VkDeviceSize bytes) { return (bytes + 3) / 4 * 4; }

static olx_result check_range(const olx_vulkan_context *c, VkDeviceSize bytes, const char *what) {
  if (bytes <= c->limits.maxStorageBufferRange) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%llu bytes of %s are more than a storage buffer of this device holds",
                  (unsigned long long)bytes, what);
}

// Returns the number of lights with highlights, 0 where there are more than can have them. Changed lights may be more
// than those of the bake.
static uint32_t highlight_count(const olx_field *field) {
  return field->surfaces.light_count > OLX_MOST_HIGHLIGHTS ? 0 : field->surfaces.light_count;
}

// Returns the bytes of the volume's chunk, which ends with the entries of cubes; 0 for a field without a volume.
static VkDeviceSize volume_bytes(const olx_volume *v) {
  if (!v->header) return 0;
  const size_t cubes = (size_t)v->header->size[0] * v->header->size[1] * v->header->size[2];
  return (VkDeviceSize)((const char *)(v->index + cubes) - (const char *)v->header);
}

// Returns whether the device holds surfaces as tiles. Relighting writes texels.
static bool keeps_tiles(const olx_field *field) { return !field->surfaces.base && !field->relight.header; }

static olx_gpu_words tile_words(const olx_field *field, uint32_t part) {
  const olx_field_surfaces *s = &field->surfaces;
  if (!keeps_tiles(field)) return (olx_gpu_words){0};
  return (olx_gpu_words){s->tiled[part - OLX_WORDS_SURFACES].words,
                         sizeof(uint32_t) * s->tile_side * s->tile_side * (VkDeviceSize)field->info.probes.count, 0};
}

// Lays out pyramids, selectors, emission, lights and the volume one after the other from `first` on: shaders read them
// as one array of words.
static olx_result lay_out_words(olx_vulkan_field *gpu, const olx_field *field, VkDeviceSize first) {
  const olx_field_surfaces *s = &field->surfaces;
  const VkDeviceSize probes = field->info.probes.count,
                     volume_probes = field->volume.header ? field->volume.header->probes : 0,
                     light_bytes = sizeof(uint16_t) * OLX_VOLUME_HALVES * volume_probes;
  const olx_gpu_words words[OLX_GPU_WORDS] = {
      [OLX_WORDS_LEAST] = {field->least, sizeof(uint16_t) * field->pyramid.least_nodes * probes, 0},
      [OLX_WORDS_BRICKS] = {field->select_data[OLX_SELECT_BRICKS], field->select_bytes[OLX_SELECT_BRICKS], 0},
      [OLX_WORDS_VORONOI] = {field->select_data[OLX_SELECT_VORONOI], field->select_bytes[OLX_SELECT_VORONOI], 0},
      [OLX_WORDS_EMISSION] = {s->emission, sizeof(uint32_t) * s->tile_side * s->tile_side * probes, 0},
      [OLX_WORDS_TILES] = {s->tiles, sizeof(uint32_t) * OLX_EMISSION_TILE_TEXELS * (VkDeviceSize)s->tile_count, 0},
      [OLX_WORDS_PLANES] = {field->planes.planes, sizeof(olx_plane_code) * (VkDeviceSize)field->planes.count, 0},
      [OLX_WORDS_LIGHTS] = {s->lights, sizeof(olx_field_light) * highlight_count(field), 0},
      [OLX_WORDS_VOLUME] = {field->volume.header, volume_bytes(&field->volume), 0},
      [OLX_WORDS_VOLUME_LIGHT] = {field->volume.irradiance, light_bytes, 0},
  };
  gpu->light_room = field->relight.header ? OLX_MOST_HIGHLIGHTS : highlight_count(field);
  gpu->buffer_bytes = first;
  for (uint32_t i = 0; i < OLX_GPU_WORDS; i++) {
    gpu->words[i] = words[i];
    if (i >= OLX_WORDS_SURFACES && i <= OLX_WORDS_SURFACES_END) gpu->words[i] = tile_words(field, i);
    gpu->words[i].offset = gpu->buffer_bytes;
    gpu->buffer_bytes +=
        i == OLX_WORDS_LIGHTS ? sizeof(olx_field_light) * gpu->light_room : whole_words(gpu->words[i].bytes);
  }
  return check_range(&gpu->context, gpu->buffer_bytes - first,
                     "pyramids, selectors, emission, planes, lights and volume");
}

// Returns the offset of a part, in words of the array.
static uint32_t first_word(const olx_vulkan_field *gpu, olx_gpu_words_part part) {
  return (uint32_t)((gpu->words[part].offset - gpu->words[0].offset) / 4);
}

static olx_result create_buffer(olx_vulkan_field *gpu, const olx_field *field) {
  const olx_vulkan_context *c = &gpu->context;
  const olx_field_info *info = &field->info;
  // A buffer is never empty, so that descriptors are valid without irradiance probes too.
  const VkDeviceSize count = info->irradiance.probe_count ? info->irradiance.probe_count : 1;
  const VkDeviceSize probes = sizeof(olx_gpu_probe) * (VkDeviceSize)info->probes.count,
                     irradiance_probes = sizeof(olx_gpu_probe) * count;
  gpu->probes_offset = align_buffer(c, sizeof(olx_field_constants));
  gpu->irradiance_probes_offset = align_buffer(c, gpu->probes_offset + probes);
  OLX_TRY(check_range(c, probes, "light field probes"));
  OLX_TRY(check_range(c, irradiance_probes, "irradiance probes"));
  OLX_TRY(lay_out_words(gpu, field, align_buffer(c, gpu->irradiance_probes_offset + irradiance_probes)));
  const VkBufferCreateInfo buffer = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                     .size = gpu->buffer_bytes,
                                     .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                              VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  OLX_TRY(olx_vulkan_check(c->vk.CreateBuffer(c->host.device, &buffer, NULL, &gpu->buffer), "vkCreateBuffer", WHAT));
  c->vk.GetBufferMemoryRequirements(c->host.device, gpu->buffer, &gpu->buffer_requirements);
  return OLX_OK;
}

static olx_gpu_grid grid_constants(const olx_grid *grid) {
  return (olx_gpu_grid){
      .origin = {grid->origin.x, grid->origin.y, grid->origin.z, 0.0f},
      .spacing = {grid->spacing.x, grid->spacing.y, grid->spacing.z, 0.0f},
      .count = {grid->count[0], grid->count[1], grid->count[2], grid->count[0] * grid->count[1] * grid->count[2]},
  };
}

static olx_field_constants field_constants(const olx_vulkan_field *gpu, const olx_field *field) {
  const olx_field_info *info = &field->info;
  const olx_gpu_maps *distance = &gpu->maps[OLX_BINDING_DISTANCE - OLX_BINDING_RADIANCE],
                     *irradiance = &gpu->maps[OLX_BINDING_IRRADIANCE - OLX_BINDING_RADIANCE];
  const olx_tiled_maps *tiled = field->surfaces.tiled;
  return (olx_field_constants){
      .grid = info->probes.has_grid ? grid_constants(&info->probes.grid) : (olx_gpu_grid){.count = {0, 0, 0, 0}},
      .irradiance_grid = grid_constants(&info->irradiance.grid),
      .scene_min = {info->scene.bounds_min.x, info->scene.bounds_min.y, info->scene.bounds_min.z, 0.0f},
      .scene_max = {info->scene.bounds_max.x, info->scene.bounds_max.y, info->scene.bounds_max.z, 0.0f},
      .probe_count = info->probes.count,
      .n = field->n,
      .least_nodes = field->pyramid.least_nodes,
      .maps_a_side = distance->maps_a_side, // the same for all maps of light field probes
      .irradiance_n = field->irradiance_n,
      .irradiance_maps_a_side = irradiance->maps_a_side,
      .irradiance_texel = 1.0f / (float)(irradiance->maps_a_side * irradiance->stride),
      .distance_scale = field->distance_scale,
      .select_mask = info->select_mask & OLX_SELECT_GPU_MASK,
      .pyramid_levels = field->pyramid.levels,
      .bricks_first = first_word(gpu, OLX_WORDS_BRICKS),
      .voronoi_first = first_word(gpu, OLX_WORDS_VORONOI),
      .emission_first = first_word(gpu, OLX_WORDS_EMISSION),
      .tiles_first = first_word(gpu, OLX_WORDS_TILES),
      .tile_side = field->surfaces.tile_side,
      .tile_count = field->surfaces.tile_count,
      .lights_first = first_word(gpu, OLX_WORDS_LIGHTS),
      .light_count = highlight_count(field),
      .last_bounce = info->bounces.last,
      .volume_first = field->volume.header ? first_word(gpu, OLX_WORDS_VOLUME) : 0,
      .pyramid_first = {field->pyramid.first[0], field->pyramid.first[1], field->pyramid.first[2],
                        field->pyramid.first[3]},
      .map_scale = 1.0f / (float)field->stride,
      .tiled = keeps_tiles(field),
      .compressed = !field->surfaces.base,
      .planes_first = first_word(gpu, OLX_WORDS_PLANES),
      .plane_count = field->planes.count,
      .geometry_scale = field->geometry ? (float)distance->stride / (float)field->stride : 0.0f,
      .tile_words = {first_word(gpu, OLX_WORDS_SURFACES), first_word(gpu, OLX_WORDS_SURFACES + 1),
                     first_word(gpu, OLX_WORDS_SURFACES + 2), first_word(gpu, OLX_WORDS_SURFACES + 3)},
      .tile_blocks = {tiled[0].count, tiled[1].count, tiled[2].count, tiled[3].count},
  };
}

// Describes the image of one kind of maps of surfaces: the pool of its tiles, as blocks where the device supports them,
// else decoded, or texels.
static olx_gpu_maps surface_maps(const olx_vulkan_context *c, const olx_field *field, olx_surface_map kind) {
  static const VkFormat TEXELS[OLX_SURFACE_MAPS] = {VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8_UNORM,
                                                    VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, VK_FORMAT_E5B9G9R9_UFLOAT_PACK32},
                        BLOCKS[OLX_SURFACE_MAPS] = {VK_FORMAT_BC1_RGB_UNORM_BLOCK, VK_FORMAT_BC5_UNORM_BLOCK,
                                                    VK_FORMAT_BC6H_UFLOAT_BLOCK, VK_FORMAT_BC6H_UFLOAT_BLOCK};
  static const uint32_t TEXEL_BYTES[OLX_SURFACE_MAPS] = {4, 2, 4, 4};
  const olx_field_surfaces *s = &field->surfaces;
  const void *texels[OLX_SURFACE_MAPS] = {s->base, s->specular, s->direct, s->indirect};
  const bool tiled = !s->base, pooled = keeps_tiles(field), blocks = pooled && c->host.texture_compression_bc;
  return (olx_gpu_maps){.format = blocks ? BLOCKS[kind] : TEXELS[kind],
                        .texel_bytes = blocks ? olx_surface_block_bytes(kind) : TEXEL_BYTES[kind],
                        .stride = field->stride,
                        .count = pooled ? s->tiled[kind].count : field->info.probes.count,
                        .pooled = pooled,
                        .decoded = tiled && !blocks,
                        .kind = kind,
                        .texels = tiled ? s->tiled[kind].blocks : texels[kind]};
}

// Describes distances or geometry blocks. Every device samples images of four words, so a block is a texel.
static olx_gpu_maps geometry_maps(const olx_field *field) {
  const uint32_t probes = field->info.probes.count, side = field->n / OLX_BLOCK_SIDE;
  return field->geometry ? (olx_gpu_maps){VK_FORMAT_R32G32B32A32_UINT, 16, side, probes, .texels = field->geometry}
                         : (olx_gpu_maps){VK_FORMAT_R16_UINT, 2, field->stride, probes, .texels = field->distance};
}

// Describes an image of a single black texel for each kind of map that the field lacks.
static void fill_missing(olx_gpu_maps maps[OLX_GPU_MAPS]) {
  static const uint32_t black = 0;
  for (uint32_t i = 0; i < OLX_GPU_MAPS; i++) {
    if (maps[i].texels || maps[i].pooled) continue;
    maps[i].stride = maps[i].count = 1;
    maps[i].texels = &black;
  }
}

static olx_result check_irradiance_form(const olx_field *field) {
  if (!field->bands) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED,
                  "%s: irradiance as spherical harmonics (%s) does not run on the GPU: bake octahedral maps",
                  field->name, olx_irradiance_form_name(field->info.irradiance.form));
}

// Creates images and buffers, without memory yet.
static olx_result create_resources(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_field *gpu) {
  OLX_TRY(check_irradiance_form(field));
  OLX_TRY(olx_vulkan_context_make(host, &gpu->context));
  const uint32_t probes = field->info.probes.count, irradiance_probes = field->info.irradiance.probe_count;
  const olx_gpu_maps maps[OLX_GPU_MAPS] = {
      [OLX_BINDING_RADIANCE - OLX_BINDING_RADIANCE] = {VK_FORMAT_B10G11R11_UFLOAT_PACK32, 4, field->stride, probes,
                                                       .texels = field->radiance},
      [OLX_BINDING_NORMAL -
          OLX_BINDING_RADIANCE] = {VK_FORMAT_R16_UINT, 2, field->stride, probes, .texels = field->normal},
      [OLX_BINDING_DISTANCE - OLX_BINDING_RADIANCE] = geometry_maps(field),
      [OLX_BINDING_IRRADIANCE - OLX_BINDING_RADIANCE] = {VK_FORMAT_B10G11R11_UFLOAT_PACK32, 4, field->irradiance_stride,
                                                         irradiance_probes, .filtered = true,
                                                         .texels = field->irradiance},
      [OLX_BINDING_MOMENTS - OLX_BINDING_RADIANCE] = {VK_FORMAT_R16G16_SFLOAT, 4, field->irradiance_stride,
                                                      irradiance_probes, .filtered = true, .texels = field->moments},
      [OLX_BINDING_INDIRECT - OLX_BINDING_RADIANCE] = surface_maps(&gpu->context, field, OLX_SURFACE_INDIRECT),
      [OLX_BINDING_DIRECT - OLX_BINDING_RADIANCE] = surface_maps(&gpu->context, field, OLX_SURFACE_DIRECT),
      [OLX_BINDING_BASE - OLX_BINDING_RADIANCE] = surface_maps(&gpu->context, field, OLX_SURFACE_BASE),
      [OLX_BINDING_SPECULAR - OLX_BINDING_RADIANCE] = surface_maps(&gpu->context, field, OLX_SURFACE_SPECULAR),
  };
  memcpy(gpu->maps, maps, sizeof maps);
  fill_missing(gpu->maps);
  for (uint32_t i = 0; i < OLX_GPU_MAPS; i++) OLX_TRY(create_image(&gpu->context, &gpu->maps[i]));
  OLX_TRY(create_buffer(gpu, field));
  gpu->constants = field_constants(gpu, field);
  return OLX_OK;
}

static olx_result bind_memory(olx_vulkan_field *gpu) {
  const olx_vulkan_context *c = &gpu->context;
  for (uint32_t i = 0; i < OLX_GPU_MAPS; i++) {
    olx_gpu_maps *maps = &gpu->maps[i];
    OLX_TRY(olx_vulkan_allocate(c, &maps->requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, WHAT, &maps->memory));
    OLX_TRY(olx_vulkan_check(c->vk.BindImageMemory(c->host.device, maps->image, maps->memory, 0), "vkBindImageMemory",
                             WHAT));
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = maps->image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
        .format = maps->format,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, maps->layers},
    };
    OLX_TRY(
        olx_vulkan_check(c->vk.CreateImageView(c->host.device, &view, NULL, &maps->view), "vkCreateImageView", WHAT));
  }
  OLX_TRY(olx_vulkan_allocate(c, &gpu->buffer_requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, WHAT,
                              &gpu->buffer_memory));
  return olx_vulkan_check(c->vk.BindBufferMemory(c->host.device, gpu->buffer, gpu->buffer_memory, 0),
                          "vkBindBufferMemory", WHAT);
}

static olx_result create_sampler(const olx_vulkan_context *c, VkFilter filter, VkSampler *sampler) {
  const VkSamplerCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                    .magFilter = filter,
                                    .minFilter = filter,
                                    .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
  return olx_vulkan_check(c->vk.CreateSampler(c->host.device, &info, NULL, sampler), "vkCreateSampler", WHAT);
}

bool olx_gpu_field_relights(const olx_vulkan_field *gpu, const olx_field *field) {
  const olx_gpu_maps *maps = &gpu->maps[OLX_BINDING_INDIRECT - OLX_BINDING_RADIANCE];
  const VkDeviceSize volume = sizeof(uint16_t) * OLX_VOLUME_HALVES * (VkDeviceSize)field->info.volume.probe_count;
  return maps->count == field->info.probes.count && gpu->constants.n == field->n && !maps->pooled &&
         gpu->words[OLX_WORDS_VOLUME_LIGHT].bytes == volume;
}

static VkDescriptorType binding_type(uint32_t binding) {
  if (binding == OLX_BINDING_FIELD) return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  if (binding < OLX_BINDING_RADIANCE) return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
}

olx_result olx_gpu_field_set_layout(const olx_vulkan_context *c, uint32_t mask, VkDescriptorSetLayout *layout) {
  const uint32_t uniforms = 1u << OLX_BINDING_FIELD, images = ALL_BINDINGS & ~((1u << OLX_BINDING_RADIANCE) - 1);
  const olx_set_bindings bindings = {.uniforms = mask & uniforms,
                                     .buffers = mask & ~(uniforms | images),
                                     .sampled = mask & images,
                                     .stages = OLX_HOST_STAGES};
  return olx_vulkan_set_layout_create(c, &bindings, WHAT, layout);
}

static olx_result create_set(olx_vulkan_field *gpu) {
  const olx_vulkan_context *c = &gpu->context;
  OLX_TRY(olx_gpu_field_set_layout(c, ALL_BINDINGS, &gpu->set_layout));
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, OLX_FIELD_STORAGE_BUFFERS},
                                        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, OLX_GPU_MAPS}};
  const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                           .maxSets = 1,
                                           .poolSizeCount = sizeof sizes / sizeof sizes[0],
                                           .pPoolSizes = sizes};
  OLX_TRY(olx_vulkan_check(c->vk.CreateDescriptorPool(c->host.device, &pool, NULL, &gpu->pool),
                           "vkCreateDescriptorPool", WHAT));
  const VkDescriptorSetAllocateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = gpu->pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &gpu->set_layout};
  return olx_vulkan_check(c->vk.AllocateDescriptorSets(c->host.device, &set, &gpu->set), "vkAllocateDescriptorSets",
                          WHAT);
}

void olx_gpu_field_write_set(const olx_vulkan_field *gpu, uint32_t mask, VkDescriptorSet set) {
  const VkDescriptorBufferInfo buffers[OLX_FIELD_BINDINGS] = {
      [OLX_BINDING_FIELD] = {gpu->buffer, 0, sizeof(olx_field_constants)},
      [OLX_BINDING_PROBES] = {gpu->buffer, gpu->probes_offset, gpu->irradiance_probes_offset - gpu->probes_offset},
      [OLX_BINDING_IRRADIANCE_PROBES] = {gpu->buffer, gpu->irradiance_probes_offset,
                                         gpu->words[0].offset - gpu->irradiance_probes_offset},
      [OLX_BINDING_WORDS] = {gpu->buffer, gpu->words[0].offset, gpu->buffer_bytes - gpu->words[0].offset},
  };
  VkDescriptorImageInfo images[OLX_GPU_MAPS];
  VkWriteDescriptorSet writes[OLX_FIELD_BINDINGS];
  uint32_t count = 0;
  for (uint32_t i = 0; i < OLX_FIELD_BINDINGS; i++) {
    if (!(mask >> i & 1u)) continue;
    VkWriteDescriptorSet *write = &writes[count++];
    *write = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                    .dstSet = set,
                                    .dstBinding = i,
                                    .descriptorCount = 1,
                                    .descriptorType = binding_type(i)};
    if (binding_type(i) != VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER) {
      write->pBufferInfo = &buffers[i];
      continue;
    }
    const olx_gpu_maps *maps = &gpu->maps[i - OLX_BINDING_RADIANCE];
    images[i - OLX_BINDING_RADIANCE] = (VkDescriptorImageInfo){maps->filtered ? gpu->linear : gpu->nearest, maps->view,
                                                               VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    write->pImageInfo = &images[i - OLX_BINDING_RADIANCE];
  }
  gpu->context.vk.UpdateDescriptorSets(gpu->context.host.device, count, writes, 0, NULL);
}

olx_result olx_vulkan_field_measure(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_sizes *sizes) {
  *sizes = (olx_vulkan_sizes){.staging_bytes = (uint64_t)OLX_STAGING_SLOTS * OLX_STAGING_SLOT_BYTES};
  olx_vulkan_field *gpu = olx_allocate_zero(1, sizeof *gpu);
  if (!gpu) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for its handle", WHAT);
  olx_result result = create_resources(host, field, gpu);
  if (result == OLX_OK) {
    sizes->device_bytes = gpu->buffer_requirements.size;
    for (uint32_t i = 0; i < OLX_GPU_MAPS; i++) sizes->device_bytes += gpu->maps[i].requirements.size;
    sizes->allocations = OLX_GPU_MAPS + 1;
    result = olx_vulkan_classic_measure(&gpu->context, field, &sizes->classic_bytes);
  }
  olx_vulkan_field_destroy(gpu);
  return result;
}

static olx_result create_field(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_field *gpu) {
  OLX_TRY(create_resources(host, field, gpu));
  OLX_TRY(bind_memory(gpu));
  OLX_TRY(olx_vulkan_field_upload(gpu, field));
  OLX_TRY(create_sampler(&gpu->context, VK_FILTER_NEAREST, &gpu->nearest));
  OLX_TRY(create_sampler(&gpu->context, VK_FILTER_LINEAR, &gpu->linear));
  OLX_TRY(create_set(gpu));
  olx_gpu_field_write_set(gpu, ALL_BINDINGS, gpu->set);
  return OLX_OK;
}

olx_result olx_vulkan_field_create(const olx_vulkan_host *host, const olx_field *field, olx_vulkan_field **uploaded) {
  *uploaded = NULL;
  olx_vulkan_field *gpu = olx_allocate_zero(1, sizeof *gpu);
  if (!gpu) return olx_fail(OLX_ERROR_MEMORY, "%s: no memory for its handle", WHAT);
  const olx_result result = create_field(host, field, gpu);
  if (result != OLX_OK) {
    olx_vulkan_field_destroy(gpu);
    return result;
  }
  *uploaded = gpu;
  return OLX_OK;
}

void olx_vulkan_field_destroy(olx_vulkan_field *gpu) {
  if (!gpu) return;
  const olx_vulkan_functions *vk = &gpu->context.vk;
  const VkDevice device = gpu->context.host.device;
  if (vk->DestroyImage) { // otherwise the host's functions were never found, and nothing was created
    vk->DestroyDescriptorPool(device, gpu->pool, NULL);
    vk->DestroyDescriptorSetLayout(device, gpu->set_layout, NULL);
    vk->DestroySampler(device, gpu->nearest, NULL);
    vk->DestroySampler(device, gpu->linear, NULL);
    vk->DestroyBuffer(device, gpu->buffer, NULL);
    vk->FreeMemory(device, gpu->buffer_memory, NULL);
    for (uint32_t i = 0; i < OLX_GPU_MAPS; i++) {
      vk->DestroyImageView(device, gpu->maps[i].view, NULL);
      vk->DestroyImage(device, gpu->maps[i].image, NULL);
      vk->FreeMemory(device, gpu->maps[i].memory, NULL);
    }
  }
  olx_release(gpu);
}

olx_select olx_vulkan_field_select(const olx_vulkan_field *gpu, olx_select asked) {
  static const olx_select best[] = {OLX_SELECT_BRICKS, OLX_SELECT_CAGE, OLX_SELECT_VORONOI};
  const uint32_t mask = gpu->constants.select_mask;
  if (asked < OLX_SELECT_EXHAUSTIVE) return mask >> asked & 1u ? asked : OLX_SELECT_EXHAUSTIVE;
  for (uint32_t i = 0; asked == OLX_SELECT_BEST && i < sizeof best / sizeof best[0]; i++) {
    if (mask >> best[i] & 1u) return best[i];
  }
  return OLX_SELECT_EXHAUSTIVE;
}

VkDescriptorSetLayout olx_vulkan_field_set_layout(const olx_vulkan_field *field) { return field->set_layout; }
VkDescriptorSet olx_vulkan_field_set(const olx_vulkan_field *field) { return field->set; }
