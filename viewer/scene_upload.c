// Uploads a scene's triangles, materials and textures with mip levels to a device, in batches of one material each.
#include "scene_upload.h"

#include <stdlib.h>
#include <string.h>

enum { TEXTURE_SLOTS = 5, BUFFERS = 4, FIRST_TEXTURE = BUFFERS };

typedef struct raster_vertex {
  float position[3], u, normal[3], v;
} raster_vertex;

// Attributes that few vertices have.
typedef struct raster_rare {
  float color[4], tangent[4], second_uv[2], unused[2];
} raster_rare;

// A material, with the layout of shaders/raster_shared.glsl.
typedef struct raster_material {
  float base_color[3], alpha;
  float emission[3], alpha_cutoff;
  float metallic, roughness, specular_weight, normal_scale;
  uint32_t flags, unused[3];
} raster_material;

enum {
  EMITS_BOTH_SIDES = 1,
  NORMAL_MAP = 2,
  NORMAL_IS_HEIGHT = 4,
  ALPHA_MAP = 8,
  VERTEX_COLORS = 16,
  RARE = 32,
  SPECULAR_IN_ALPHA = 64,
  SLOTS = 8
};

static const VkShaderStageFlags STAGES = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

// ---- Geometry

static bool upload_vertices(gpu_device *d, const olx_scene_content *content, gpu_scene *scene) {
  raster_vertex *vertices = malloc((size_t)content->vertex_count * sizeof *vertices);
  if (!vertices) return gpu_fail(d, "out of memory for %u vertices", content->vertex_count);
  for (uint32_t i = 0; i < content->vertex_count; i++) {
    const olx_vec3 p = content->positions[i], n = content->normals[i];
    const olx_vec2 uv = content->uvs[i];
    vertices[i] = (raster_vertex){{p.x, p.y, p.z}, uv.x, {n.x, n.y, n.z}, uv.y};
  }
  const bool fine =
      gpu_buffer_upload(d, "the scene's vertices", vertices, (VkDeviceSize)content->vertex_count * sizeof *vertices,
                        VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &scene->vertices);
  free(vertices);
  return fine;
}

static bool has_rare(const olx_scene_content *content) {
  return content->colors || content->tangents || content->second_uvs;
}

static raster_rare rare_of(const olx_scene_content *content, uint32_t i) {
  const olx_vec4 c = content->colors ? content->colors[i] : (olx_vec4){1.0f, 1.0f, 1.0f, 1.0f};
  const olx_vec4 t = content->tangents ? content->tangents[i] : (olx_vec4){0};
  const olx_vec2 uv = content->second_uvs ? content->second_uvs[i] : content->uvs[i];
  return (raster_rare){.color = {c.x, c.y, c.z, c.w}, .tangent = {t.x, t.y, t.z, t.w}, .second_uv = {uv.x, uv.y}};
}

static bool upload_rare(gpu_device *d, const olx_scene_content *content, gpu_scene *scene) {
  const uint32_t count = has_rare(content) ? content->vertex_count : 1;
  raster_rare *rare = malloc((size_t)count * sizeof *rare);
  if (!rare) return gpu_fail(d, "out of memory for %u vertices", count);
  for (uint32_t i = 0; i < count; i++) rare[i] = rare_of(content, i);
  const bool fine = gpu_buffer_upload(d, "what few vertices have", rare, (VkDeviceSize)count * sizeof *rare,
                                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &scene->rare);
  free(rare);
  return fine;
}

// Creates one batch for each material that has triangles; starts[m] becomes the first triangle of material m.
static void make_batches(const olx_scene_content *content, uint32_t *starts, gpu_scene *scene) {
  for (uint32_t t = 0; t < content->triangle_count; t++) starts[content->material_index[t]]++;
  uint32_t first = 0;
  for (uint32_t m = 0; m < content->material_count; m++) {
    const uint32_t count = starts[m];
    starts[m] = first;
    if (count) {
      scene->batches[scene->batch_count++] = (scene_batch){.material = m,
                                                           .first_triangle = first,
                                                           .triangle_count = count,
                                                           .masked = content->materials[m].alpha_cutoff > 0.0f};
    }
    first += count;
  }
}

static void bound_batches(const olx_scene_content *content, const uint32_t *sorted, gpu_scene *scene) {
  for (uint32_t b = 0; b < scene->batch_count; b++) {
    scene_batch *batch = &scene->batches[b];
    const uint32_t *corner = sorted + 3 * (size_t)batch->first_triangle;
    for (uint32_t i = 0; i < 3 * batch->triangle_count; i++) {
      const olx_vec3 p = content->positions[corner[i]];
      const float position[3] = {p.x, p.y, p.z};
      for (uint32_t k = 0; k < 3; k++) {
        if (i == 0 || position[k] < batch->low[k]) batch->low[k] = position[k];
        if (i == 0 || position[k] > batch->high[k]) batch->high[k] = position[k];
      }
    }
  }
}

static bool upload_indices(gpu_device *d, const olx_scene_content *content, gpu_scene *scene) {
  const size_t bytes = (size_t)content->triangle_count * 3 * sizeof(uint32_t);
  uint32_t *sorted = malloc(bytes), *starts = calloc(content->material_count, sizeof *starts);
  scene->batches = calloc(content->material_count, sizeof *scene->batches);
  bool fine = sorted && starts && scene->batches;
  if (fine) {
    make_batches(content, starts, scene);
    for (uint32_t t = 0; t < content->triangle_count; t++) {
      const size_t place = starts[content->material_index[t]]++;
      memcpy(sorted + 3 * place, content->indices + 3 * (size_t)t, 3 * sizeof *sorted);
    }
    bound_batches(content, sorted, scene);
    fine = gpu_buffer_upload(d, "the scene's triangles", sorted, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                             &scene->indices);
  } else {
    gpu_fail(d, "out of memory for %u triangles", content->triangle_count);
  }
  free(sorted);
  free(starts);
  return fine;
}

// ---- Materials and textures

static raster_material material_of(const olx_material *m, bool rare) {
  return (raster_material){
      .base_color = {m->base_color.x, m->base_color.y, m->base_color.z},
      .alpha = m->alpha,
      .emission = {m->emission.x, m->emission.y, m->emission.z},
      .alpha_cutoff = m->alpha_cutoff,
      .metallic = m->metallic,
      .roughness = m->roughness,
      .specular_weight = m->specular_weight,
      .normal_scale = m->normal_scale,
      .flags = (m->emits_both_sides ? EMITS_BOTH_SIDES : 0u) | (m->normal_texture != OLX_NO_TEXTURE ? NORMAL_MAP : 0u) |
               (m->normal_is_height ? NORMAL_IS_HEIGHT : 0u) | (m->alpha_texture != OLX_NO_TEXTURE ? ALPHA_MAP : 0u) |
               (m->vertex_colors ? VERTEX_COLORS : 0u) | (rare ? RARE : 0u) |
               (m->specular_in_alpha ? SPECULAR_IN_ALPHA : 0u) | m->second_uvs << SLOTS,
  };
}

static bool upload_materials(gpu_device *d, const olx_scene_content *content, gpu_scene *scene) {
  raster_material *materials = malloc((size_t)content->material_count * sizeof *materials);
  if (!materials) return gpu_fail(d, "out of memory for %u materials", content->material_count);
  const bool rare = has_rare(content);
  for (uint32_t i = 0; i < content->material_count; i++) materials[i] = material_of(&content->materials[i], rare);
  const bool fine = gpu_buffer_upload(d, "the scene's materials", materials,
                                      (VkDeviceSize)content->material_count * sizeof *materials,
                                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, &scene->materials);
  free(materials);
  return fine;
}

static uint32_t half(uint32_t size) { return size > 1 ? size / 2 : 1; }

// Records the mip levels, each filtered from the previous one in linear light.
static void record_levels(const gpu_device *d, const gpu_image *image) {
  const VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  uint32_t width = image->width, height = image->height;
  for (uint32_t level = 0; level < image->levels; level++, width = half(width), height = half(height)) {
    gpu_level_barrier(d, d->commands, image, level, target, source);
    if (level + 1 == image->levels) break;
    const VkImageBlit blit = {.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1},
                              .srcOffsets = {{0, 0, 0}, {(int32_t)width, (int32_t)height, 1}},
                              .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level + 1, 0, 1},
                              .dstOffsets = {{0, 0, 0}, {(int32_t)half(width), (int32_t)half(height), 1}}};
    d->CmdBlitImage(d->commands, image->image, source, image->image, target, 1, &blit, VK_FILTER_LINEAR);
  }
  gpu_image_barrier(d, d->commands, image, source, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

static uint32_t level_count(uint32_t width, uint32_t height) {
  uint32_t levels = 1;
  for (uint32_t size = width > height ? width : height; size > 1; size /= 2) levels++;
  return levels;
}

static bool upload_texture(gpu_device *d, const olx_texture *texture, gpu_image *image) {
  const gpu_image_info info = {.what = "a texture",
                               .format = texture->srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM,
                               .width = texture->width,
                               .height = texture->height,
                               .levels = level_count(texture->width, texture->height),
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                        VK_IMAGE_USAGE_TRANSFER_DST_BIT};
  if (!gpu_image_create(d, &info, image)) return false;
  const VkDeviceSize bytes = (VkDeviceSize)texture->width * texture->height * 4;
  gpu_buffer staging;
  if (!gpu_buffer_create(d, "a texture's staging", bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, &staging))
    return false;
  memcpy(staging.mapped, texture->texels, bytes);
  bool fine = gpu_commands_begin(d);
  if (fine) {
    const VkBufferImageCopy region = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {texture->width, texture->height, 1}};
    gpu_image_barrier(d, d->commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    d->CmdCopyBufferToImage(d->commands, staging.buffer, image->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                            &region);
    record_levels(d, image);
    fine = gpu_commands_run(d);
  }
  gpu_buffer_destroy(d, &staging);
  return fine;
}

static bool upload_textures(gpu_device *d, const olx_scene_content *content, gpu_scene *scene) {
  uint8_t white_texel[4] = {255, 255, 255, 255};
  const olx_texture white = {.width = 1, .height = 1, .texels = white_texel};
  const uint32_t count = content->texture_count + 1;
  scene->textures = calloc(count, sizeof *scene->textures);
  if (!scene->textures) return gpu_fail(d, "out of memory for %u textures", count);
  for (scene->texture_count = 0; scene->texture_count < count; scene->texture_count++) {
    const uint32_t i = scene->texture_count;
    if (!upload_texture(d, i < content->texture_count ? &content->textures[i] : &white, &scene->textures[i])) {
      scene->texture_count++; // counted first, so that a partly created texture is released with the others
      return false;
    }
  }
  const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                       .magFilter = VK_FILTER_LINEAR,
                                       .minFilter = VK_FILTER_LINEAR,
                                       .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                       .anisotropyEnable = d->anisotropy,
                                       .maxAnisotropy = 8.0f,
                                       .maxLod = VK_LOD_CLAMP_NONE};
  return gpu_check(d, d->CreateSampler(d->host.device, &sampler, NULL, &scene->sampler), "a sampler for textures");
}

// ---- Descriptors

static bool create_set_layout(gpu_device *d, gpu_scene *scene) {
  VkDescriptorSetLayoutBinding bindings[BUFFERS + TEXTURE_SLOTS];
  for (uint32_t i = 0; i < BUFFERS + TEXTURE_SLOTS; i++) {
    bindings[i] = (VkDescriptorSetLayoutBinding){
        .binding = i,
        .descriptorType = i < BUFFERS ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        .descriptorCount = 1,
        .stageFlags = STAGES};
  }
  const VkDescriptorSetLayoutCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                .bindingCount = BUFFERS + TEXTURE_SLOTS,
                                                .pBindings = bindings};
  return gpu_check(d, d->CreateDescriptorSetLayout(d->host.device, &info, NULL, &scene->set_layout),
                   "a layout of the scene's descriptors");
}

static void write_set(const gpu_device *d, const olx_material *m, const gpu_scene *scene, VkDescriptorSet set) {
  const gpu_buffer *from[BUFFERS] = {&scene->vertices, &scene->indices, &scene->materials, &scene->rare};
  const uint32_t textures[TEXTURE_SLOTS] = {m->base_color_texture, m->alpha_texture, m->metallic_roughness_texture,
                                            m->emission_texture, m->normal_texture};
  VkDescriptorBufferInfo buffers[BUFFERS];
  VkDescriptorImageInfo images[TEXTURE_SLOTS];
  for (uint32_t i = 0; i < BUFFERS; i++) buffers[i] = (VkDescriptorBufferInfo){from[i]->buffer, 0, VK_WHOLE_SIZE};
  for (uint32_t i = 0; i < TEXTURE_SLOTS; i++) {
    const uint32_t texture = textures[i] == OLX_NO_TEXTURE ? scene->texture_count - 1 : textures[i];
    images[i] = (VkDescriptorImageInfo){scene->sampler, scene->textures[texture].view,
                                        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  }
  VkWriteDescriptorSet writes[BUFFERS + TEXTURE_SLOTS];
  for (uint32_t i = 0; i < BUFFERS + TEXTURE_SLOTS; i++) {
    const bool buffer = i < BUFFERS;
    writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                       .dstSet = set,
                                       .dstBinding = i,
                                       .descriptorCount = 1,
                                       .descriptorType = buffer ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                                                : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                       .pBufferInfo = buffer ? &buffers[i] : NULL,
                                       .pImageInfo = buffer ? NULL : &images[i - FIRST_TEXTURE]};
  }
  d->UpdateDescriptorSets(d->host.device, BUFFERS + TEXTURE_SLOTS, writes, 0, NULL);
}

static bool create_sets(gpu_device *d, const olx_scene_content *content, gpu_scene *scene) {
  const uint32_t count = content->material_count;
  scene->material_count = count;
  scene->sets = calloc(count, sizeof *scene->sets);
  if (!scene->sets) return gpu_fail(d, "out of memory for %u materials", count);
  const VkDescriptorPoolSize sizes[2] = {
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, BUFFERS * count},
      {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, TEXTURE_SLOTS * count},
  };
  const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                           .maxSets = count,
                                           .poolSizeCount = 2,
                                           .pPoolSizes = sizes};
  if (!gpu_check(d, d->CreateDescriptorPool(d->host.device, &pool, NULL, &scene->pool), "the scene's descriptors"))
    return false;
  for (uint32_t i = 0; i < count; i++) {
    const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = scene->pool,
                                              .descriptorSetCount = 1,
                                              .pSetLayouts = &scene->set_layout};
    const VkResult made = d->AllocateDescriptorSets(d->host.device, &info, &scene->sets[i]);
    if (!gpu_check(d, made, "a material's descriptors")) return false;
    write_set(d, &content->materials[i], scene, scene->sets[i]);
  }
  return true;
}

static void count_bytes(gpu_scene *scene) {
  scene->bytes = scene->vertices.bytes + scene->rare.bytes + scene->indices.bytes + scene->materials.bytes;
  for (uint32_t i = 0; i < scene->texture_count; i++) {
    uint64_t width = scene->textures[i].width, height = scene->textures[i].height;
    for (uint32_t level = 0; level < scene->textures[i].levels; level++) {
      scene->bytes += width * height * 4;
      width = width > 1 ? width / 2 : 1;
      height = height > 1 ? height / 2 : 1;
    }
  }
}

static bool check_ranges(gpu_device *d, const gpu_scene *scene) {
  const gpu_buffer *const buffers[] = {&scene->vertices, &scene->rare, &scene->indices, &scene->materials};
  const VkDeviceSize most = d->properties.limits.maxStorageBufferRange;
  for (uint32_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
    if (buffers[i]->bytes <= most) continue;
    return gpu_fail(d, "the scene has more vertices or triangles than a storage buffer of this device holds");
  }
  return true;
}

bool gpu_scene_create(gpu_device *d, const olx_scene_content *content, gpu_scene *scene) {
  *scene = (gpu_scene){.triangle_count = content->triangle_count};
  if (upload_vertices(d, content, scene) && upload_rare(d, content, scene) && upload_indices(d, content, scene) &&
      upload_materials(d, content, scene) && check_ranges(d, scene) && upload_textures(d, content, scene) &&
      create_set_layout(d, scene) && create_sets(d, content, scene)) {
    count_bytes(scene);
    return true;
  }
  gpu_scene_destroy(d, scene);
  return false;
}

void gpu_scene_destroy(gpu_device *d, gpu_scene *scene) {
  if (scene->pool) d->DestroyDescriptorPool(d->host.device, scene->pool, NULL);
  if (scene->set_layout) d->DestroyDescriptorSetLayout(d->host.device, scene->set_layout, NULL);
  if (scene->sampler) d->DestroySampler(d->host.device, scene->sampler, NULL);
  for (uint32_t i = 0; i < scene->texture_count; i++) gpu_image_destroy(d, &scene->textures[i]);
  gpu_buffer_destroy(d, &scene->vertices);
  gpu_buffer_destroy(d, &scene->rare);
  gpu_buffer_destroy(d, &scene->indices);
  gpu_buffer_destroy(d, &scene->materials);
  free(scene->textures);
  free(scene->sets);
  free(scene->batches);
  *scene = (gpu_scene){.triangle_count = 0};
}

draw_item draw_item_in_place(const gpu_scene *scene) {
  return (draw_item){.scene = scene, .to_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
}
