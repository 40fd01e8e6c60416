// Shows how a host's own Vulkan renderer uses Octalux: embed_vulkan FIELD PICTURE [--size WxH] [--own-shader]
// [--validate].
//
// The renderer draws the Cornell box in one pass (surface_pass.c): a G-buffer, and direct light with shadows. What
// Octalux adds is in this file, in the order in which a host adds it: load_field, make_frame, record_frame,
// remove_octalux. FIELD comes from
//   octalux bake builtin:cornell-glossy -o FIELD
// and PICTURE is a .png, tone-mapped, or an .exr with the indirect layers beside. With --own-shader the diffuse light
// comes from olx_surface_irradiance, called in surface.frag, instead of the recorded pass. --validate fails on any
// message of the validation layers. Exits with 77 where there is no Vulkan 1.2 device.
#include "surface_pass.h"

#include <octalux/octalux.h>
#include <octalux/render.h> // only for olx_image_save; a host that writes no pictures links octalux::octalux alone
#include <octalux/vulkan.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NO_DEVICE = 77 };

static const VkAccessFlags COMPUTE_ACCESS = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT;

// Images that are read back: the picture before and after Octalux, and its glossy light.
enum { WITHOUT, WITH, GLOSSY, READ_BACK };

typedef struct options {
  const char *field_path, *picture_path;
  VkExtent2D size;
  bool own_shader, validate;
} options;

typedef struct renderer {
  options options;
  gpu gpu;
  // Objects of the host.
  surface_pass surfaces;
  surface_camera camera;
  float clip_to_world[16];
  gpu_buffer read_back[READ_BACK];
  // Objects that Octalux needs.
  olx_vulkan_field *field;
  gpu_image irradiance, glossy;
  olx_vulkan_frame *frame;
} renderer;

static void need_octalux(olx_result result) {
  if (result == OLX_OK) return;
  fprintf(stderr, "embed_vulkan: %s\n", olx_last_error());
  exit(1);
}

// ---- Octalux ------------------------------------------------------------------------------------------------------

// Loads a field and uploads it; once for each level.
static void load_field(renderer *r) {
  const gpu *g = &r->gpu;
  const olx_vulkan_host host = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                                .instance = g->instance,
                                .physical_device = g->physical_device,
                                .device = g->device,
                                .queue = g->queue,
                                .queue_family = g->queue_family,
                                .texture_compression_bc = g->texture_compression_bc};
  olx_field *field;
  olx_vulkan_sizes sizes;
  need_octalux(olx_field_open(r->options.field_path, &field));
  need_octalux(olx_vulkan_field_measure(&host, field, &sizes));
  printf("%s: %u probes, %.1f MiB on %s\n", r->options.field_path, olx_field_describe(field).probes.count,
         (double)sizes.device_bytes / (1 << 20), g->name);
  need_octalux(olx_vulkan_field_create(&host, field, &r->field));
  olx_field_close(field); // the device has a copy of all of it
}

// Creates the passes' frame once, which names the images that they read and write; for images of another size,
// olx_vulkan_frame_resize replaces them.
static void make_frame(renderer *r) {
  const gpu *g = &r->gpu;
  const VkImageUsageFlags written = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  r->irradiance = gpu_make_image(g, r->options.size, VK_FORMAT_R16G16B16A16_SFLOAT, written);
  r->glossy = gpu_make_image(g, r->options.size, VK_FORMAT_R16G16B16A16_SFLOAT, written);
  olx_vulkan_image inputs[SURFACE_IMAGES];
  for (uint32_t i = 0; i < SURFACE_IMAGES; i++) {
    inputs[i] = (olx_vulkan_image){r->surfaces.images[i].view, r->surfaces.images[i].format, surface_layout(i)};
  }
  const olx_vulkan_targets targets = {.width = r->options.size.width,
                                      .height = r->options.size.height,
                                      .depth = inputs[SURFACE_DEPTH],
                                      .normal = inputs[SURFACE_NORMAL],
                                      .albedo = inputs[SURFACE_ALBEDO],
                                      .roughness = inputs[SURFACE_MATERIAL],
                                      // The G-buffer's normal, since boxes are flat.
                                      .geometric_normal = inputs[SURFACE_NORMAL],
                                      .irradiance = r->irradiance.view,
                                      .glossy = r->glossy.view,
                                      .color = r->surfaces.images[SURFACE_COLOR].view,
                                      .passes = OLX_VULKAN_PASS_GLOSSY | OLX_VULKAN_PASS_COMPOSITE |
                                                (r->options.own_shader ? 0u : OLX_VULKAN_PASS_IRRADIANCE)};
  need_octalux(olx_vulkan_frame_create(r->field, &targets, &r->frame));
}

// Records a copy of an image that compute shaders write before and after it, in layout GENERAL.
static void record_copy(const renderer *r, const gpu_image *image, uint32_t to) {
  const gpu *g = &r->gpu;
  const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL, source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  const gpu_order before = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                            VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT};
  const gpu_order after = {VK_PIPELINE_STAGE_TRANSFER_BIT, 0, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, COMPUTE_ACCESS};
  const VkBufferImageCopy region = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {r->options.size.width, r->options.size.height, 1}};
  gpu_change_layout(g, image, general, source, before);
  vkCmdCopyImageToBuffer(g->commands, image->image, source, r->read_back[to].buffer, 1, &region);
  gpu_change_layout(g, image, source, general, after);
}

// Records a frame: the host's passes come first, then Octalux's; at the end `color` contains all light.
static void record_frame(const renderer *r) {
  const gpu *g = &r->gpu;
  const gpu_image *color = &r->surfaces.images[SURFACE_COLOR];
  surface_pass_record(g, &r->surfaces, &r->camera, olx_vulkan_field_set(r->field));
  record_copy(r, color, WITHOUT); // only to show what Octalux adds; a renderer would not copy this

  // Octalux needs its outputs in layout GENERAL; contents of an earlier frame may be discarded.
  const gpu_order earlier = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                             COMPUTE_ACCESS};
  gpu_change_layout(g, &r->irradiance, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, earlier);
  gpu_change_layout(g, &r->glossy, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, earlier);
  // The dependency at the end of surface_pass.c's render pass orders the host's writes before Octalux's passes.

  olx_vulkan_view view = {.eye = {r->camera.eye[0], r->camera.eye[1], r->camera.eye[2]}, .empty_depth = 0.0f};
  memcpy(view.clip_to_world, r->clip_to_world, sizeof view.clip_to_world);
  olx_vulkan_settings settings = olx_vulkan_settings_default();
  settings.glossy_samples = 16; // a renderer takes 1, increments sample_index, and filters over time
  uint32_t add = OLX_VULKAN_ADD_GLOSSY;
  if (!r->options.own_shader) {
    need_octalux(olx_vulkan_record_irradiance(r->frame, g->commands, &view, &settings));
    add |= OLX_VULKAN_ADD_DIFFUSE;
  }
  need_octalux(olx_vulkan_record_glossy(r->frame, g->commands, &view, &settings));
  need_octalux(olx_vulkan_record_composite(r->frame, g->commands, &view, &settings, add));

  // Octalux's writes must be ordered before the host's use of the picture: tone mapping, or here copies, which begin
  // with a barrier.
  record_copy(r, color, WITH);
  record_copy(r, &r->glossy, GLOSSY);
  gpu_barrier(g, (gpu_order){VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                             VK_ACCESS_HOST_READ_BIT});
}

static void remove_octalux(renderer *r) {
  olx_vulkan_frame_destroy(r->frame); // must be destroyed before its field
  olx_vulkan_field_destroy(r->field);
  gpu_free_image(&r->gpu, &r->irradiance);
  gpu_free_image(&r->gpu, &r->glossy);
}

// ---- The host -----------------------------------------------------------------------------------------------------

// The camera is "front" of builtin:cornell-glossy, which looks along +z with +x on the left. Depth is reversed and
// infinite: NEAR / distance. clip_to_world is the inverse of world_to_clip, in closed form.
static void place_camera(renderer *r) {
  const float eye[3] = {0.278f, 0.273f, -0.8f}, near = 0.05f;
  const float y = tanf(39.3077f / 2.0f * 3.14159265f / 180.0f);
  const float x = y * (float)r->options.size.width / (float)r->options.size.height;
  const float world_to_clip[16] = {-1 / x, 0, 0, 0, 0, -1 / y, 0, 0, 0, 0, 0, 1, eye[0] / x, eye[1] / y, near, -eye[2]};
  const float clip_to_world[16] = {-x * near, 0, 0, 0, 0, -y * near, 0, 0, eye[0], eye[1], eye[2], 1, 0, 0, near, 0};
  memcpy(r->camera.world_to_clip, world_to_clip, sizeof world_to_clip);
  memcpy(r->clip_to_world, clip_to_world, sizeof clip_to_world);
  memcpy(r->camera.eye, eye, sizeof eye);
}

// ---- The picture --------------------------------------------------------------------------------------------------

// Converts a half float that is not negative, infinite or NaN.
static float half_float(uint16_t h) {
  const int exponent = h >> 10 & 31, mantissa = h & 1023;
  return exponent ? ldexpf((float)(mantissa + 1024), exponent - 25) : ldexpf((float)mantissa, -24);
}

static olx_vec3 pixel(const renderer *r, uint32_t image, size_t i) {
  const uint16_t *half = (const uint16_t *)r->read_back[image].mapped + 4 * i;
  return (olx_vec3){half_float(half[0]), half_float(half[1]), half_float(half[2])};
}

// Apart from glossy light, the composite pass has added diffuse light. With the host's own shader diffuse light is part
// of the picture without Octalux, so this layer is left out.
static void save_picture(const renderer *r) {
  const uint32_t diffuse = r->options.own_shader ? 0 : 1u << OLX_LAYER_INDIRECT_DIFFUSE;
  olx_image image;
  need_octalux(olx_image_create(r->options.size.width, r->options.size.height,
                                1u << OLX_LAYER_BEAUTY | 1u << OLX_LAYER_INDIRECT_GLOSSY | diffuse, &image));
  for (size_t i = 0; i < (size_t)image.width * image.height; i++) {
    const olx_vec3 before = pixel(r, WITHOUT, i), all = pixel(r, WITH, i), glossy = pixel(r, GLOSSY, i);
    image.layers[OLX_LAYER_BEAUTY][i] = all;
    image.layers[OLX_LAYER_INDIRECT_GLOSSY][i] = glossy;
    if (!diffuse) continue;
    image.layers[OLX_LAYER_INDIRECT_DIFFUSE][i] =
        (olx_vec3){all.x - glossy.x - before.x, all.y - glossy.y - before.y, all.z - glossy.z - before.z};
  }
  need_octalux(olx_image_save(&image, r->options.picture_path));
  olx_image_free(&image);
}

static bool read_options(int argc, char **argv, options *o) {
  *o = (options){.size = {640, 480}};
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--validate") == 0) {
      o->validate = true;
    } else if (strcmp(argv[i], "--own-shader") == 0) {
      o->own_shader = true;
    } else if (strcmp(argv[i], "--size") == 0) {
      if (++i == argc || sscanf(argv[i], "%ux%u", &o->size.width, &o->size.height) != 2) return false;
    } else if (argv[i][0] != '-' && !o->picture_path) {
      *(o->field_path ? &o->picture_path : &o->field_path) = argv[i];
    } else {
      return false;
    }
  }
  return o->picture_path && o->size.width - 1 < 4096 && o->size.height - 1 < 4096;
}

int main(int argc, char **argv) {
  renderer r = {.field = NULL};
  if (!read_options(argc, argv, &r.options)) {
    fprintf(stderr, "usage: embed_vulkan FIELD PICTURE [--size WxH] [--own-shader] [--validate]\n");
    return 2;
  }
  if (!gpu_open(&r.gpu, r.options.validate)) {
    fprintf(stderr, "embed_vulkan: there is no Vulkan 1.2 device\n");
    return NO_DEVICE;
  }
  load_field(&r);
  r.surfaces = surface_pass_make(&r.gpu, r.options.size, olx_vulkan_field_set_layout(r.field), r.options.own_shader);
  place_camera(&r);
  for (uint32_t i = 0; i < READ_BACK; i++) {
    const size_t bytes = (size_t)8 * r.options.size.width * r.options.size.height; // four half floats for each pixel
    r.read_back[i] = gpu_make_buffer(&r.gpu, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, NULL);
  }
  make_frame(&r);

  gpu_begin(&r.gpu);
  record_frame(&r);
  gpu_run(&r.gpu);
  save_picture(&r);

  remove_octalux(&r);
  surface_pass_free(&r.gpu, &r.surfaces);
  for (uint32_t i = 0; i < READ_BACK; i++) gpu_free_buffer(&r.gpu, &r.read_back[i]);
  gpu_close(&r.gpu);
  if (r.gpu.validated) printf("%u validation messages\n", r.gpu.validation_messages);
  return r.gpu.validation_messages ? 1 : 0;
}
