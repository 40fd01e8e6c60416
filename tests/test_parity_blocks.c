// Compares shaders/lib/geometry_block.glsl with its specification, src/block/geometry_block.h, on blocks of all forms
// with any bits: planes and depths, on which decisions depend, agree to the last bit.
#include "block/geometry_block.h"
#include "core/sampling.h"
#include "gpu_pipeline.h"
#include "parity_rows.h"
#include "vulkan_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const uint32_t CODE[] = {
#include "parity_blocks.spv.inc"
};

typedef struct block_item {
  olx_geometry_block block;
  olx_plane_code pooled;
  uint32_t texel, unused;
  olx_block_place place;
  uint32_t padding;
  olx_vec3 point;
  float zero;
} block_item;

typedef struct setting {
  gpu_device device;
  gpu_buffer buffers[2]; // the buffers of items and of results
  gpu_set set;
  gpu_compute compute;
} setting;

// Returns a word with any bits, except exponents of floats that devices may treat differently: floats of planes are
// within 2^-32 and 2^32.
static uint32_t float_word(uint32_t bits) { return (bits & 0x807FFFFFu) | (95u + (bits >> 23 & 63u)) << 23; }

static block_item make_item(uint32_t i) {
  const uint32_t n = 8u << olx_hash2(i, 1) % 9u, side = n / OLX_BLOCK_SIDE, form = olx_hash2(i, 2) % 3u;
  block_item item = {.pooled = {{olx_hash2(i, 3), olx_hash2(i, 4)}},
                     .texel = olx_hash2(i, 5) % OLX_BLOCK_TEXELS,
                     .place = {n, olx_hash2(i, 6) % side, olx_hash2(i, 7) % side}};
  // Every fourth block lies on a fold of the map.
  if (i % 4 == 0) item.place.y = side / 2 - 1 - item.place.x % (side / 2), item.place.x %= side / 2;
  for (uint32_t k = 0; k < 4; k++) item.block.words[k] = olx_hash3(i, k, 8);
  if (form == OLX_GEOMETRY_ONE) {
    for (uint32_t k = 0; k < 3; k++) item.block.words[k] = float_word(item.block.words[k]);
  }
  item.block.words[3] = (item.block.words[3] & 0x3FFFFFFFu) | form << 30;
  if (i % 64 == 1) item.block = (olx_geometry_block){{0, 0, 0, 0}};
  // The item's point is on the plane, or near it, to the precision of floats.
  const olx_vec3 plane = olx_geometry_plane_of(&item.block, item.pooled, item.place, item.texel);
  const olx_vec3 direction = olx_sample_sphere(olx_stratified2(i, 9));
  const float distance = olx_plane_distance(plane, direction);
  item.point = olx_scale(direction, i % 2 && distance < 0x1p100f ? distance : 1.0f);
  return item;
}

static int set_up(void **state) {
  setting *s = calloc(1, sizeof *s);
  *state = s;
  gpu_device *d = &s->device;
  if (!host_open_device(d, true) && !host_open_device(d, false)) return 0; // the validation layers may be missing
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  assert_true(gpu_buffer_create(d, "items", sizeof(block_item) * PARITY_ITEMS, usage, true, &s->buffers[0]));
  assert_true(gpu_buffer_create(d, "results", 4u * PARITY_RESULTS * PARITY_ITEMS, usage, true, &s->buffers[1]));
  for (uint32_t i = 0; i < PARITY_ITEMS; i++) ((block_item *)s->buffers[0].mapped)[i] = make_item(i);
  const VkDescriptorType storage = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, types[2] = {storage, storage};
  const gpu_binding bindings[2] = {{.type = storage, .buffer = &s->buffers[0]},
                                   {.type = storage, .buffer = &s->buffers[1]}};
  assert_true(gpu_set_create(d, "blocks", types, 2, VK_SHADER_STAGE_COMPUTE_BIT, &s->set));
  gpu_set_write(d, &s->set, bindings, 2);
  assert_true(gpu_compute_create(d, "rows", GPU_CODE(CODE), &s->set.layout, 1, sizeof(uint32_t), &s->compute));
  return 0;
}

static int tear_down(void **state) {
  setting *s = *state;
  gpu_device *d = &s->device;
  int code = 0;
  if (d->host.device) {
    gpu_compute_destroy(d, &s->compute);
    gpu_set_destroy(d, &s->set);
    for (uint32_t i = 0; i < 2; i++) gpu_buffer_destroy(d, &s->buffers[i]);
    code = host_close_device(d);
  }
  free(s);
  return code;
}

// The words that C gives for an item.
typedef struct answer {
  uint32_t words[4], count;
} answer;

static void put(answer *a, uint32_t word) { a->words[a->count++] = word; }
static void put_3(answer *a, olx_vec3 v) {
  put(a, olx_float_bits(v.x));
  put(a, olx_float_bits(v.y));
  put(a, olx_float_bits(v.z));
}

static olx_vec3 plane_of(const block_item *i) {
  return olx_geometry_plane_of(&i->block, i->pooled, i->place, i->texel);
}

static void plane_decode(const block_item *i, answer *a) { put_3(a, olx_plane_decode(i->pooled, i->place)); }
static void geometry_pooled(const block_item *i, answer *a) { put(a, olx_geometry_pooled(&i->block, i->texel)); }
static void geometry_plane_of(const block_item *i, answer *a) { put_3(a, plane_of(i)); }
static void geometry_nearest(const block_item *i, answer *a) {
  put(a, olx_float_bits(olx_geometry_nearest(&i->block)));
}
static void plane_depth(const block_item *i, answer *a) {
  const float depth = olx_plane_depth(plane_of(i), i->point);
  put(a, olx_float_bits(depth));
  put(a, depth < 1.0f);
}
static void plane_normal(const block_item *i, answer *a) { put_3(a, olx_plane_normal(plane_of(i))); }
static void plane_distance(const block_item *i, answer *a) {
  put(a, olx_float_bits(olx_plane_distance(plane_of(i), i->point)));
}
static void block_texel_point(const block_item *i, answer *a) { put_3(a, olx_block_texel_point(i->place, i->texel)); }

// A row whose results may differ by `bound` relatively, where roots or divisions contribute; with 0 they must have the
// same bits.
typedef struct block_row {
  uint32_t number;
  const char *name;
  void (*evaluate)(const block_item *item, answer *a);
  float bound;
} block_row;

#define PARITY(name, bound)                                                                                            \
  { ROW_olx_##name, #name, name, bound }

// clang-format off
static const block_row ROWS[] = {
    PARITY(plane_decode, 0),
    PARITY(geometry_pooled, 0),
    PARITY(geometry_plane_of, 0),
    PARITY(geometry_nearest, 0),
    PARITY(plane_depth, 0),
    PARITY(plane_normal, 1e-6f),
    PARITY(plane_distance, 1e-6f),
    PARITY(block_texel_point, 0),
};
// clang-format on

static bool agrees(const answer *a, const uint32_t *words, float bound) {
  for (uint32_t k = 0; k < a->count; k++) {
    const float expected = olx_bits_float(a->words[k]), found = olx_bits_float(words[k]);
    const bool same = a->words[k] == words[k] || (isnan(expected) && isnan(found));
    if (!same && !(bound > 0.0f && fabsf(found - expected) <= bound * olx_max(fabsf(expected), 0x1p-60f))) return false;
  }
  return true;
}

static void shaders_agree_with_c(void **state) {
  setting *s = *state;
  gpu_device *d = &s->device;
  if (!d->host.device) skip();
  for (uint32_t r = 0; r < sizeof ROWS / sizeof ROWS[0]; r++) {
    const uint32_t row = ROWS[r].number;
    assert_true(gpu_commands_begin(d));
    gpu_compute_record(d, &s->compute, &s->set.set, 1, &row, sizeof row, PARITY_ITEMS / 8, 8, d->commands);
    gpu_full_barrier(d, d->commands);
    assert_true(gpu_commands_run(d));
    uint32_t bad = 0, front = 0;
    for (uint32_t i = 0; i < PARITY_ITEMS; i++) {
      answer a = {.count = 0};
      ROWS[r].evaluate((const block_item *)s->buffers[0].mapped + i, &a);
      front += row == ROW_olx_plane_depth && a.words[1];
      bad += !agrees(&a, (const uint32_t *)s->buffers[1].mapped + (size_t)PARITY_RESULTS * i, ROWS[r].bound);
    }
    print_message("  %-20s %u of %u apart\n", ROWS[r].name, bad, PARITY_ITEMS);
    if (bad) fail_msg("%s: %u apart", ROWS[r].name, bad);
    if (row == ROW_olx_plane_depth) assert_true(front > PARITY_ITEMS / 4 && front < PARITY_ITEMS * 3 / 4);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(shaders_agree_with_c, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
