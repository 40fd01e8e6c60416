// Tests that textures of blocks decode on a device to the values that src/block decodes, for any bits and all modes.
// BC6H is defined to the last bit; the other formats leave rounding open.
#include "block/bc1.h"
#include "block/bc4.h"
#include "block/bc6h.h"
#include "core/sampling.h"
#include "gpu_pipeline.h"
#include "vulkan_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const uint32_t CODE[] = {
#include "fetch_blocks.spv.inc"
};

enum { SIDE = 512, TEXELS = SIDE * SIDE, BLOCKS = TEXELS / 16, MOST_WORDS = 4 * BLOCKS };

typedef struct setting {
  gpu_device device;
  gpu_buffer blocks, texels;
  gpu_compute compute;
  gpu_set set;
} setting;

static int set_up(void **state) {
  setting *s = calloc(1, sizeof *s);
  *state = s;
  gpu_device *d = &s->device;
  if (!host_open_device(d, true) && !host_open_device(d, false)) return 0; // the validation layers may be missing
  const VkDescriptorType types[2] = {VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
  assert_true(gpu_buffer_create(d, "blocks", 4 * MOST_WORDS, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true, &s->blocks));
  assert_true(gpu_buffer_create(d, "texels", 16 * TEXELS, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true, &s->texels));
  assert_true(gpu_set_create(d, "texture", types, 2, VK_SHADER_STAGE_COMPUTE_BIT, &s->set));
  assert_true(gpu_compute_create(d, "fetch", GPU_CODE(CODE), &s->set.layout, 1, sizeof(uint32_t), &s->compute));
  return 0;
}

static int tear_down(void **state) {
  setting *s = *state;
  gpu_device *d = &s->device;
  int code = 0;
  if (d->host.device) {
    gpu_compute_destroy(d, &s->compute);
    gpu_set_destroy(d, &s->set);
    gpu_buffer_destroy(d, &s->blocks);
    gpu_buffer_destroy(d, &s->texels);
    code = host_close_device(d);
  }
  free(s);
  return code;
}

// Fills a texture with blocks and reads all of its texels; returns false where the device has no such textures.
static bool fetch(setting *s, VkFormat format) {
  gpu_device *d = &s->device;
  if (!d->host.device) return false;
  VkFormatProperties properties;
  d->GetPhysicalDeviceFormatProperties(d->host.physical_device, format, &properties);
  if (!(properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT)) return false;
  gpu_image image;
  const gpu_image_info info = {.what = "blocks",
                               .format = format,
                               .width = SIDE,
                               .height = SIDE,
                               .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
  assert_true(gpu_image_create(d, &info, &image));
  assert_true(gpu_image_write(d, &image, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, &s->blocks));
  const gpu_binding bindings[2] = {{.type = VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
                                    .view = image.view,
                                    .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL},
                                   {.type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, .buffer = &s->texels}};
  gpu_set_write(d, &s->set, bindings, 2);
  const uint32_t width = SIDE;
  assert_true(gpu_commands_begin(d));
  gpu_compute_record(d, &s->compute, &s->set.set, 1, &width, sizeof width, SIDE, SIDE, d->commands);
  gpu_full_barrier(d, d->commands);
  assert_true(gpu_commands_run(d));
  gpu_image_destroy(d, &image);
  return true;
}

static uint32_t block_of(uint32_t texel) { return texel / SIDE / 4 * (SIDE / 4) + texel % SIDE / 4; }
static uint32_t place_in_block(uint32_t texel) { return texel / SIDE % 4 * 4 + texel % 4; }
static const float *fetched(const setting *s, uint32_t texel) { return (const float *)s->texels.mapped + 4 * texel; }

static void bc6h_is_what_textures_hold(void **state) {
  setting *s = *state;
  if (!s->device.host.device) skip();
  uint32_t *words = s->blocks.mapped;
  for (uint32_t i = 0; i < 4 * BLOCKS; i++) words[i] = olx_hash2(i, 1);
  // Gives each mode the same number of blocks.
  for (uint32_t i = 0; i < BLOCKS; i++) words[4 * i] = (words[4 * i] & ~31u) | i % 32;
  if (!fetch(s, VK_FORMAT_BC6H_UFLOAT_BLOCK)) skip();
  uint32_t bad[32] = {0}, all = 0;
  for (uint32_t i = 0; i < TEXELS; i++) {
    const olx_bc6h_block *block = (const olx_bc6h_block *)words + block_of(i);
    const olx_vec3 expected = olx_bc6h_texel(block, place_in_block(i));
    const float *found = fetched(s, i);
    bad[block->words[0] & 31u] += found[0] != expected.x || found[1] != expected.y || found[2] != expected.z;
  }
  for (uint32_t mode = 0; mode < 32; mode++) {
    if (bad[mode]) print_error("mode bits %u: %u texels differ\n", mode, bad[mode]);
    all += bad[mode];
  }
  assert_int_equal(all, 0);
}

// Returns whether a value is near `expected` to within `steps` steps of 1/255, for devices that interpolate with few
// bits.
static bool near(float found, uint32_t expected, float steps) {
  return fabsf(found * 255.0f - (float)expected) <= steps + 0.01f;
}

static void bc1_is_what_textures_hold(void **state) {
  setting *s = *state;
  if (!s->device.host.device) skip();
  uint32_t *words = s->blocks.mapped, bad = 0;
  for (uint32_t i = 0; i < 2 * BLOCKS; i++) words[i] = olx_hash2(i, 2);
  if (!fetch(s, VK_FORMAT_BC1_RGB_UNORM_BLOCK)) skip();
  for (uint32_t i = 0; i < TEXELS; i++) {
    const uint32_t expected = olx_bc1_texel((const olx_bc1_block *)words + block_of(i), place_in_block(i));
    const float *found = fetched(s, i);
    for (uint32_t c = 0; c < 3; c++) bad += !near(found[c], expected >> 8 * c & 255u, 1);
  }
  assert_int_equal(bad, 0);
}

// Weights of fifths, which the baker never writes, are off by 1.7 steps on a device whose weights have eight bits.
static void two_of_bc4_are_what_textures_of_bc5_hold(void **state) {
  setting *s = *state;
  if (!s->device.host.device) skip();
  uint32_t *words = s->blocks.mapped, bad = 0;
  for (uint32_t i = 0; i < 4 * BLOCKS; i++) words[i] = olx_hash2(i, 3);
  if (!fetch(s, VK_FORMAT_BC5_UNORM_BLOCK)) skip();
  for (uint32_t i = 0; i < TEXELS; i++) {
    const olx_bc4_block *pair = (const olx_bc4_block *)words + 2 * block_of(i);
    for (uint32_t c = 0; c < 2; c++) {
      const bool sevenths = (pair[c].words[0] & 255u) > (pair[c].words[0] >> 8 & 255u);
      bad += !near(fetched(s, i)[c], olx_bc4_texel(&pair[c], place_in_block(i)), sevenths ? 1 : 2);
    }
  }
  assert_int_equal(bad, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(bc6h_is_what_textures_hold, set_up, tear_down),
      cmocka_unit_test_setup_teardown(bc1_is_what_textures_hold, set_up, tear_down),
      cmocka_unit_test_setup_teardown(two_of_bc4_are_what_textures_of_bc5_hold, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
