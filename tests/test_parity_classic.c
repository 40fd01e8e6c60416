// shaders/lib/classic.glsl against its specification: every function and its C twin on the same inputs, on whatever
// Vulkan device there is (a CPU one will do). The C file is included so that its inner functions can be called.
#include "shade/classic.c"

#include "analytic_field.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "gpu_pipeline.h"
#include "parity_classic_rows.h"
#include "vulkan_host.h"

#include <octalux/vulkan.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static const uint32_t SPIRV[] = {
#include "parity_classic.spv.inc"
};

enum { ITEMS = PARITY_CLASSIC_ITEMS, RESULTS = PARITY_CLASSIC_RESULTS };

typedef struct parity_item {
  float v[12];
  uint32_t u[4];
} parity_item;

// What C gives for an item. Words that are floats may differ a little.
typedef struct result {
  uint32_t word[RESULTS];
  bool is_float[RESULTS];
  uint32_t count;
} result;

static void put_u(result *r, uint32_t x) { r->word[r->count++] = x; }
static void put_f(result *r, float x) {
  r->is_float[r->count] = true;
  put_u(r, olx_float_bits(x));
}
static void put_3(result *r, olx_vec3 v) {
  put_f(r, v.x);
  put_f(r, v.y);
  put_f(r, v.z);
}

// What parity_classic.comp derives from an item; the names are the same.
typedef struct state {
  const olx_field *field;
  const olx_classic_maps *maps;
  olx_vec3 point, direction, view, random;
  uint32_t probe, level, bits;
  olx_sample_settings settings;
} state;

static state derive(const olx_field *field, const parity_item *item) {
  state s = {.field = field,
             .maps = &field->classic,
             .point = olx_v3(item->v[0], item->v[1], item->v[2]),
             .direction = olx_v3(item->v[3], item->v[4], item->v[5]),
             .view = olx_v3(item->v[6], item->v[7], item->v[8]),
             .random = olx_v3(item->v[9], item->v[10], item->v[11]),
             .probe = item->u[0] % field->info.irradiance_probe_count,
             .level = item->u[1] % OLX_CLASSIC_LEVELS,
             .bits = item->u[3],
             .settings = olx_sample_settings_default()};
  s.settings.keep_buried = item->u[2] & 1u;
  return s;
}

static void color(const state *s, result *r) {
  const olx_bilinear b = olx_bilinear_at((olx_vec2){s->random.x, s->random.y}, s->maps->size);
  put_3(r, map_color(s->maps->irradiance + s->maps->irradiance_texels * s->probe, &b));
}

static void reflectance(const state *s, result *r) {
  const olx_vec2 v = olx_classic_reflectance(s->maps->table, 1.2f * s->random.x - 0.1f, 1.2f * s->random.y - 0.1f);
  put_f(r, v.x);
  put_f(r, v.y);
}

static void weights(const state *s, result *r) {
  const olx_irradiance_weights w = weigh(s->field, &s->settings, s->point, s->direction);
  put_u(r, w.count);
  for (uint32_t i = 0; i < w.count; i++) {
    put_u(r, w.probe[i]);
    put_f(r, w.weight[i]);
  }
}

// clang-format off
#define ROW(name, ...) static void row_##name(const state *s, result *r) { __VA_ARGS__; }
ROW(classic_color, color(s, r))
ROW(classic_vector, put_3(r, s->maps->boxes[s->probe].low))
ROW(classic_parallax, put_3(r, olx_classic_parallax(&s->maps->boxes[s->probe],
        s->field->irradiance_positions[s->probe], s->point, s->direction)))
ROW(classic_reflectance, reflectance(s, r))
ROW(classic_side, put_u(r, olx_classic_side(s->maps->size, s->level)))
ROW(classic_radiance, put_3(r, olx_classic_radiance(s->maps, s->probe, s->direction, 1.2f * s->random.z - 0.1f)))
ROW(classic_weigh, weights(s, r))
ROW(classic_irradiance, put_3(r, olx_classic_irradiance(s->field, &s->settings, s->point, s->direction)))
ROW(classic_glossy, put_3(r, olx_classic_glossy(s->field, &s->settings, s->point, s->direction, s->view, s->random.x,
        olx_v3(fabsf(s->view.x), fabsf(s->view.y), fabsf(s->view.z)), s->random.y)))
// clang-format on

// Results off by more than `bound` are apart; of all items a share of `allowed` may be.
typedef struct parity_row {
  uint32_t number;
  const char *name;
  void (*evaluate)(const state *s, result *r);
  float bound;
  double allowed;
} parity_row;

#define PARITY(name, bound, allowed)                                                                                   \
  { ROW_olx_##name, #name, row_##name, bound, allowed }

// clang-format off
static const parity_row ROWS[] = {
    PARITY(classic_color, 1e-5f, 0),
    PARITY(classic_vector, 0.0f, 0),
    PARITY(classic_parallax, 1e-4f, 1e-3),
    PARITY(classic_reflectance, 1e-5f, 0),
    PARITY(classic_side, 0.0f, 0),
    PARITY(classic_radiance, 1e-4f, 1e-3),
    PARITY(classic_weigh, 1e-5f, 1e-3),
    PARITY(classic_irradiance, 1e-4f, 1e-3),
    PARITY(classic_glossy, 1e-4f, 1e-3),
};
// clang-format on

// --- A field with classic maps at random: what matters is that both sides read the same

static olx_field *make_field(const olx_grid *grid, uint32_t size) {
  const analytic_scene scene = {.room = {{0, 0, 0}, {4, 3, 5}}};
  olx_field *field = analytic_field_make(&scene, grid, 8, 8);
  analytic_field_add_classic(field, size);
  uint8_t *flags = (uint8_t *)(uintptr_t)field->irradiance_flags;
  for (uint32_t i = 0; i < field->info.irradiance_probe_count; i++) flags[i] = i % 7 < 4 ? OLX_PROBE_BURIED : 0;
  return field;
}

static void fill_items(parity_item *items) {
  for (uint32_t i = 0; i < ITEMS; i++) {
    parity_item *item = &items[i];
    for (uint32_t k = 0; k < 4; k++) item->u[k] = olx_hash3(i, k, 77);
    const olx_vec2 p = olx_stratified2(i, 1), q = olx_stratified2(i, 2), a = olx_stratified2(i, 5);
    olx_vec3 point = olx_v3(4.0f * p.x, 3.0f * p.y, 5.0f * q.x), direction = olx_sample_sphere(olx_stratified2(i, 3));
    if (i % 16 == 3) direction = olx_v3(0.0f, i & 32 ? -1.0f : 1.0f, 0.0f);
    if (i % 16 == 5) direction = olx_v3(i & 32 ? 0.6f : -1.0f, 0.0f, i & 32 ? 0.8f : 0.0f);
    if (i % 64 == 9) point = olx_madd(point, direction, 3.0f);
    const olx_vec3 view = olx_from_basis(olx_sample_cosine(olx_stratified2(i, 4)), direction);
    const float values[12] = {point.x, point.y, point.z, direction.x, direction.y, direction.z,
                              view.x,  view.y,  view.z,  a.x,         a.y,         q.y};
    memcpy(item->v, values, sizeof values);
  }
}

// --- The device

typedef struct harness {
  gpu_device device;
  gpu_buffer items, results;
  gpu_set set;
  gpu_compute compute;
} harness;

static void make_pipeline(harness *gpu, const olx_vulkan_field *field, const olx_vulkan_classic *classic) {
  gpu_device *d = &gpu->device;
  const VkDescriptorType storage = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, types[2] = {storage, storage};
  const gpu_binding bindings[2] = {{.type = storage, .buffer = &gpu->items},
                                   {.type = storage, .buffer = &gpu->results}};
  assert_true(gpu_set_create(d, "items and results", types, 2, VK_SHADER_STAGE_COMPUTE_BIT, &gpu->set));
  gpu_set_write(d, &gpu->set, bindings, 2);
  const VkDescriptorSetLayout sets[] = {olx_vulkan_field_set_layout(field), gpu->set.layout,
                                        olx_vulkan_classic_set_layout(classic)};
  assert_true(gpu_compute_create(d, "rows", GPU_CODE(SPIRV), sets, 3, sizeof(uint32_t), &gpu->compute));
}

// Run one row over all items.
static void run_row(harness *gpu, const olx_vulkan_field *field, const olx_vulkan_classic *classic, uint32_t row) {
  gpu_device *d = &gpu->device;
  const VkDescriptorSet sets[] = {olx_vulkan_field_set(field), gpu->set.set, olx_vulkan_classic_set(classic)};
  const uint32_t width = ITEMS / 8; // a group has 64 items
  assert_true(gpu_commands_begin(d));
  gpu_compute_record(d, &gpu->compute, sets, 3, &row, sizeof row, width, 8, d->commands);
  gpu_full_barrier(d, d->commands);
  assert_true(gpu_commands_run(d));
}

static float difference(uint32_t a_bits, uint32_t b_bits) {
  const float a = olx_bits_float(a_bits), b = olx_bits_float(b_bits);
  if (a == b) return 0.0f;
  const float d = fabsf(a - b) / olx_max(fabsf(b), 1.0f);
  return d < INFINITY ? d : INFINITY;
}

// Whether a row keeps what it promises.
static bool judge_row(const harness *gpu, const olx_field *field, const parity_row *row) {
  uint32_t bad = 0;
  float worst = 0.0f;
  for (uint32_t i = 0; i < ITEMS; i++) {
    const state s = derive(field, (const parity_item *)gpu->items.mapped + i);
    result r = {.count = 0};
    row->evaluate(&s, &r);
    const uint32_t *words = (const uint32_t *)gpu->results.mapped + (size_t)RESULTS * i;
    float largest = 0.0f;
    for (uint32_t k = 0; k < r.count; k++) {
      const float d = r.is_float[k] ? difference(words[k], r.word[k]) : words[k] == r.word[k] ? 0.0f : INFINITY;
      largest = olx_max(largest, d);
    }
    if (largest <= row->bound) worst = olx_max(worst, largest);
    else bad++;
  }
  const double share = (double)bad / ITEMS;
  print_message("  %-28s off by %.2g at most, %.4f %% apart\n", row->name, (double)worst, 100.0 * share);
  return share <= row->allowed;
}

static void compare(const char *name, const olx_grid *grid, uint32_t size) {
  harness gpu = {.items = {0}};
  gpu_device *d = &gpu.device;
  host_open_device(d, true);
  host_need_device(d);
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  assert_true(gpu_buffer_create(d, "items", sizeof(parity_item) * ITEMS, usage, true, &gpu.items));
  assert_true(gpu_buffer_create(d, "results", 4u * RESULTS * ITEMS, usage, true, &gpu.results));
  fill_items(gpu.items.mapped);
  olx_field *field = make_field(grid, size);
  olx_vulkan_field *uploaded = NULL;
  olx_vulkan_classic *classic = NULL;
  if (olx_vulkan_field_create(&d->host, field, &uploaded) != OLX_OK) fail_msg("%s", olx_last_error());
  if (olx_vulkan_classic_create(uploaded, field, &classic) != OLX_OK) fail_msg("%s", olx_last_error());
  make_pipeline(&gpu, uploaded, classic);
  print_message("%s on %s\n", name, d->properties.deviceName);
  uint32_t failures = 0;
  for (uint32_t i = 0; i < sizeof ROWS / sizeof ROWS[0]; i++) {
    run_row(&gpu, uploaded, classic, ROWS[i].number);
    failures += !judge_row(&gpu, field, &ROWS[i]);
  }
  gpu_compute_destroy(d, &gpu.compute);
  gpu_set_destroy(d, &gpu.set);
  olx_vulkan_classic_destroy(classic);
  olx_vulkan_classic_destroy(NULL);
  // A field without the maps says which option is missing, and leaves nothing behind.
  analytic_field_remove_classic(field);
  field->classic = (olx_classic_maps){.size = 0};
  assert_int_equal(olx_vulkan_classic_create(uploaded, field, &classic), OLX_ERROR_ARGUMENT);
  assert_null(classic);
  assert_non_null(strstr(olx_last_error(), "bake --classic"));
  olx_vulkan_field_destroy(uploaded);
  analytic_field_free(field);
  gpu_buffer_destroy(d, &gpu.items);
  gpu_buffer_destroy(d, &gpu.results);
  assert_int_equal(failures, 0);
  assert_int_equal(d->validation_messages, 0);
  assert_int_equal(host_close_device(d), 0);
}

static void in_a_room(void **unused) {
  (void)unused;
  compare("2 x 2 x 2 probes, 64 texels", &(olx_grid){{0.5f, 0.5f, 0.5f}, {3.0f, 2.0f, 4.0f}, {2, 2, 2}}, 64);
}

static void along_a_wall(void **unused) {
  (void)unused;
  compare("5 x 1 x 3 probes, 32 texels", &(olx_grid){{0.2f, 1.0f, 0.5f}, {0.8f, 0.0f, 2.0f}, {5, 1, 3}}, 32);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(in_a_room), cmocka_unit_test(along_a_wall)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
