// Uploads a scene's triangles and alpha masks, and divides the triangles into chunks that can be left out of a face.
#include "cube_scene.h"

#include <stdlib.h>
#include <string.h>

enum { CHUNK_TRIANGLES = 128, BUFFERS = 5, BINDINGS = BUFFERS + 2 };
enum { SECOND_BASE_COLOR = 1, SECOND_ALPHA = 2 }; // as in shaders/cube_shared.glsl

static const VkShaderStageFlags STAGES = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
static const VkImageLayout READ = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;

static bool is_masked(const olx_material *material) { return material->alpha_cutoff > 0.0f; }

static bool upload(gpu_device *d, const char *what, const void *data, size_t bytes, gpu_buffer *buffer) {
  if (bytes > d->properties.limits.maxStorageBufferRange) {
    return gpu_fail(d, "%s take %zu bytes, and a buffer of the device at most %u", what, bytes,
                    d->properties.limits.maxStorageBufferRange);
  }
  return gpu_buffer_upload(d, what, data, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, buffer);
}

// ---- Triangles in the order of drawing

// Numbers the masked materials; mask_of[material] becomes a mask's index or CUBE_OPAQUE.
static bool number_masks(gpu_device *d, const olx_scene_content *c, uint32_t *mask_of, cube_scene *scene) {
  for (uint32_t m = 0; m < c->material_count; m++) {
    mask_of[m] = is_masked(&c->materials[m]) ? scene->mask_count++ : CUBE_OPAQUE;
  }
  scene->masks = calloc(scene->mask_count ? scene->mask_count : 1, sizeof *scene->masks);
  return scene->masks || gpu_fail(d, "out of memory for %u masks", scene->mask_count);
}

// Sorts triangles by class: opaque ones (class 0), then those of each mask, each in the scene's order. ends[k] becomes
// the end of class k.
static void sort_triangles(const olx_scene_content *c, const uint32_t *mask_of, uint32_t classes, uint32_t *ends,
                           uint32_t *order) {
  memset(ends, 0, classes * sizeof *ends);
  for (uint32_t t = 0; t < c->triangle_count; t++) ends[mask_of[c->material_index[t]] + 1]++;
  uint32_t first = 0;
  for (uint32_t k = 0; k < classes; k++) {
    const uint32_t count = ends[k];
    ends[k] = first;
    first += count;
  }
  for (uint32_t t = 0; t < c->triangle_count; t++) order[ends[mask_of[c->material_index[t]] + 1]++] = t;
}

static void bound_chunk(const olx_scene_content *c, const uint32_t *order, cube_chunk *chunk) {
  for (uint32_t i = 0; i < 3 * chunk->count; i++) {
    const olx_vec3 p = c->positions[c->indices[3 * (size_t)order[chunk->first + i / 3] + i % 3]];
    const float position[3] = {p.x, p.y, p.z};
    for (uint32_t k = 0; k < 3; k++) {
      if (i == 0 || position[k] < chunk->low[k]) chunk->low[k] = position[k];
      if (i == 0 || position[k] > chunk->high[k]) chunk->high[k] = position[k];
    }
  }
}

static bool make_chunks(gpu_device *d, const olx_scene_content *c, const uint32_t *order, const uint32_t *ends,
                        cube_scene *scene) {
  const uint32_t classes = scene->mask_count + 1;
  scene->chunks = calloc((size_t)c->triangle_count / CHUNK_TRIANGLES + classes, sizeof *scene->chunks);
  if (!scene->chunks) return gpu_fail(d, "out of memory for chunks of %u triangles", c->triangle_count);
  for (uint32_t k = 0; k < classes; k++) {
    for (uint32_t first = k ? ends[k - 1] : 0; first < ends[k]; first += CHUNK_TRIANGLES) {
      const uint32_t left = ends[k] - first;
      cube_chunk *chunk = &scene->chunks[scene->chunk_count++];
      *chunk = (cube_chunk){
          .first = first, .count = left < CHUNK_TRIANGLES ? left : CHUNK_TRIANGLES, .mask = k ? k - 1 : CUBE_OPAQUE};
      bound_chunk(c, order, chunk);
    }
  }
  return true;
}

static bool upload_order(gpu_device *d, const olx_scene_content *c, cube_scene *scene) {
  uint32_t *mask_of = malloc((c->material_count ? c->material_count : 1) * sizeof *mask_of);
  uint32_t *order = malloc(c->triangle_count * sizeof *order);
  bool fine = (mask_of && order) || gpu_fail(d, "out of memory for %u triangles", c->triangle_count);
  fine = fine && number_masks(d, c, mask_of, scene);
  const uint32_t classes = scene->mask_count + 1;
  uint32_t *ends = fine ? malloc(classes * sizeof *ends) : NULL;
  if (fine && !ends) fine = gpu_fail(d, "out of memory for %u masks", scene->mask_count);
  if (fine) {
    sort_triangles(c, mask_of, classes, ends, order);
    fine = make_chunks(d, c, order, ends, scene) &&
           upload(d, "triangles as they are drawn", order, c->triangle_count * sizeof *order, &scene->order);
  }
  free(mask_of);
  free(order);
  free(ends);
  return fine;
}

// ---- What masks read

// Uploads texture coordinates and alphas of vertices; in a scene without masks those of one vertex, to be bound.
static bool upload_attributes(gpu_device *d, const olx_scene_content *c, cube_scene *scene) {
  const uint32_t count = scene->mask_count ? c->vertex_count : 1;
  olx_vec4 *uvs = malloc(count * sizeof *uvs);
  float *alphas = malloc(count * sizeof *alphas);
  bool fine = (uvs && alphas) || gpu_fail(d, "out of memory for %u vertices", count);
  for (uint32_t i = 0; fine && i < count; i++) {
    const olx_vec2 second = c->second_uvs ? c->second_uvs[i] : c->uvs[i];
    uvs[i] = (olx_vec4){c->uvs[i].x, c->uvs[i].y, second.x, second.y};
    alphas[i] = c->colors ? c->colors[i].w : 1.0f;
  }
  fine = fine && upload(d, "texture coordinates", uvs, count * sizeof *uvs, &scene->uvs) &&
         upload(d, "alphas of vertices", alphas, count * sizeof *alphas, &scene->alphas);
  free(uvs);
  free(alphas);
  return fine;
}

static bool upload_texture(gpu_device *d, const olx_texture *texture, gpu_image *image) {
  const gpu_image_info info = {.what = "a texture of a mask",
                               .format = texture->srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM,
                               .width = texture->width,
                               .height = texture->height,
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
  const VkDeviceSize bytes = (VkDeviceSize)texture->width * texture->height * 4;
  gpu_buffer staging;
  if (!gpu_image_create(d, &info, image) ||
      !gpu_buffer_create(d, "a texture's staging", bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, &staging))
    return false;
  memcpy(staging.mapped, texture->texels, bytes);
  const bool fine = gpu_image_write(d, image, READ, &staging);
  gpu_buffer_destroy(d, &staging);
  return fine;
}

// Returns whether a mask reads a texture.
static bool is_read(const olx_scene_content *c, uint32_t texture) {
  for (uint32_t m = 0; m < c->material_count; m++) {
    const olx_material *material = &c->materials[m];
    if (!is_masked(material)) continue;
    if (material->base_color_texture == texture || material->alpha_texture == texture) return true;
  }
  return false;
}

static bool upload_textures(gpu_device *d, const olx_scene_content *c, cube_scene *scene) {
  uint8_t texel[4] = {255, 255, 255, 255};
  const olx_texture white = {.width = 1, .height = 1, .texels = texel};
  scene->texture_count = c->texture_count + 1;
  scene->textures = calloc(scene->texture_count, sizeof *scene->textures);
  if (!scene->textures) return gpu_fail(d, "out of memory for %u textures", scene->texture_count);
  for (uint32_t i = 0; i < c->texture_count; i++) {
    if (is_read(c, i) && !upload_texture(d, &c->textures[i], &scene->textures[i])) return false;
  }
  const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  return upload_texture(d, &white, &scene->textures[c->texture_count]) &&
         gpu_check(d, d->CreateSampler(d->host.device, &sampler, NULL, &scene->sampler), "a sampler for masks");
}

// ---- Descriptors

static bool create_set(gpu_device *d, const cube_scene *scene, uint32_t base_color, uint32_t alpha, gpu_set *set) {
  const gpu_buffer *buffers[BUFFERS] = {&scene->positions, &scene->indices, &scene->order, &scene->uvs, &scene->alphas};
  const uint32_t textures[BINDINGS - BUFFERS] = {base_color, alpha}, white = scene->texture_count - 1;
  VkDescriptorType types[BINDINGS];
  gpu_binding bindings[BINDINGS];
  for (uint32_t i = 0; i < BINDINGS; i++) {
    types[i] = i < BUFFERS ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    bindings[i] = (gpu_binding){.type = types[i]};
    if (i < BUFFERS) {
      bindings[i].buffer = buffers[i];
      continue;
    }
    const uint32_t texture = textures[i - BUFFERS];
    bindings[i].view = scene->textures[texture == OLX_NO_TEXTURE ? white : texture].view;
    bindings[i].sampler = scene->sampler;
    bindings[i].layout = READ;
  }
  if (!gpu_set_create(d, "the scene's descriptors", types, BINDINGS, STAGES, set)) return false;
  gpu_set_write(d, set, bindings, BINDINGS);
  return true;
}

static bool create_masks(gpu_device *d, const olx_scene_content *c, cube_scene *scene) {
  cube_mask *mask = scene->masks;
  for (uint32_t i = 0; i < c->material_count; i++) {
    const olx_material *m = &c->materials[i];
    if (!is_masked(m)) continue;
    mask->flags = (m->second_uvs & OLX_SLOT_BASE_COLOR ? SECOND_BASE_COLOR : 0u) |
                  (m->second_uvs & OLX_SLOT_ALPHA ? SECOND_ALPHA : 0u);
    mask->alpha = m->alpha;
    mask->alpha_cutoff = m->alpha_cutoff;
    if (!create_set(d, scene, m->base_color_texture, m->alpha_texture, &mask->set)) return false;
    mask++;
  }
  return true;
}

bool cube_scene_create(gpu_device *d, const olx_scene_content *c, cube_scene *scene) {
  *scene = (cube_scene){.chunk_count = 0};
  if (!c->triangle_count) return gpu_fail(d, "a scene without triangles");
  return upload(d, "the scene's positions", c->positions, c->vertex_count * sizeof *c->positions, &scene->positions) &&
         upload(d, "the scene's triangles", c->indices, c->triangle_count * 3 * sizeof *c->indices, &scene->indices) &&
         upload_order(d, c, scene) && upload_attributes(d, c, scene) && upload_textures(d, c, scene) &&
         create_set(d, scene, OLX_NO_TEXTURE, OLX_NO_TEXTURE, &scene->opaque) && create_masks(d, c, scene);
}

void cube_scene_destroy(gpu_device *d, cube_scene *scene) {
  for (uint32_t i = 0; scene->masks && i < scene->mask_count; i++) gpu_set_destroy(d, &scene->masks[i].set);
  gpu_set_destroy(d, &scene->opaque);
  for (uint32_t i = 0; scene->textures && i < scene->texture_count; i++) gpu_image_destroy(d, &scene->textures[i]);
  if (scene->sampler) d->DestroySampler(d->host.device, scene->sampler, NULL);
  gpu_buffer *const buffers[] = {&scene->positions, &scene->indices, &scene->order, &scene->uvs, &scene->alphas};
  for (uint32_t i = 0; i < BUFFERS; i++) gpu_buffer_destroy(d, buffers[i]);
  free(scene->textures);
  free(scene->masks);
  free(scene->chunks);
  *scene = (cube_scene){.chunk_count = 0};
}
