// Compares shaders/lib/volume_irradiance.glsl with its specification, src/shade/volume_irradiance.c, on a volume with
// cells of all sizes, walls through them, and points inside, outside and on surfaces.
#include "bake/volume/volume_cells.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "gpu_pipeline.h"
#include "made_scenes.h"
#include "parity_rows.h"
#include "scene/builtin/builtin_shapes.h"
#include "shade/volume_irradiance.h"
#include "vulkan_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const uint32_t CODE[] = {
#include "parity_volume.spv.inc"
};

typedef struct volume_item {
  float position[4], normal[4];
} volume_item;

// A test's volume of a room divided by a wall with a gap, with random light.
typedef struct setting {
  olx_scene *scene;
  olx_volume_cells cells;
  uint16_t *irradiance;
  olx_field field;
  gpu_device device;
  gpu_buffer buffers[3]; // the buffers of items, of results and of the volume's words
  gpu_set set;
  gpu_compute compute;
} setting;

static void make_volume(setting *s) {
  s->scene = made_scene();
  olx_material material = olx_material_default();
  const uint32_t grey = made_material(s->scene, &material), materials[6] = {grey, grey, grey, grey, grey, grey};
  assert_int_equal(olx_add_room(s->scene, "room", olx_v3(-2.1f, -1, -1), olx_v3(1.9f, 1.3f, 1.4f), materials), OLX_OK);
  made_quad(s->scene, olx_v3(0.137f, -0.3f, 0.2f), olx_v3(0, 0, 2.5f), olx_v3(0, 1.5f, 0), grey);
  made_finish(s->scene);
  const olx_vec3 probe = {-1, 0, 0};
  const uint8_t flags = 0;
  olx_volume_space space;
  assert_int_equal(olx_volume_space_create(s->scene, &probe, &flags, 1, 64, 2, &space), OLX_OK);
  assert_int_equal(olx_volume_cells_create(&space, 16, 1 << 15, 2, &s->cells), OLX_OK);
  olx_volume_space_free(&space);
  assert_int_equal(olx_volume_open(s->cells.data, s->cells.size_bytes, "made", &s->field.volume), OLX_OK);
  assert_true(s->field.volume.header->splits > 0 && s->field.volume.header->blocks > 1);
  const size_t halves = (size_t)OLX_VOLUME_HALVES * s->cells.probe_count;
  s->irradiance = malloc(halves * sizeof *s->irradiance);
  for (size_t i = 0; i < halves; i++) {
    s->irradiance[i] = olx_half_pack(2.0f * olx_unit_float(olx_hash((uint32_t)i)) - 1.0f);
  }
  s->field.volume.irradiance = s->irradiance;
}

static void fill_items(volume_item *items) {
  for (uint32_t i = 0; i < PARITY_ITEMS; i++) {
    float p[3];
    for (uint32_t k = 0; k < 3; k++) p[k] = 5.0f * olx_unit_float(olx_hash3(i, k, 1)) - 2.5f;
    if (i % 8 == 0) p[0] = 0.137f; // a point on the wall
    olx_vec3 normal = olx_sample_sphere(olx_stratified2(i, 5));
    if (i % 16 == 0) normal = olx_v3(i % 32 ? 1.0f : -1.0f, 0, 0);
    items[i] = (volume_item){{p[0], p[1], p[2], 0}, {normal.x, normal.y, normal.z, 0}};
  }
  items[1].position[0] = INFINITY;
  items[2].position[1] = -1e30f;
}

static int set_up(void **state) {
  setting *s = calloc(1, sizeof *s);
  *state = s;
  make_volume(s);
  gpu_device *d = &s->device;
  if (!host_open_device(d, true) && !host_open_device(d, false)) return 0; // the validation layers may be missing
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  const size_t light = (size_t)OLX_VOLUME_HALVES * s->cells.probe_count * sizeof *s->irradiance;
  assert_true(gpu_buffer_create(d, "items", sizeof(volume_item) * PARITY_ITEMS, usage, true, &s->buffers[0]));
  assert_true(gpu_buffer_create(d, "results", 4u * PARITY_RESULTS * PARITY_ITEMS, usage, true, &s->buffers[1]));
  assert_true(gpu_buffer_create(d, "words", s->cells.size_bytes + light, usage, true, &s->buffers[2]));
  fill_items(s->buffers[0].mapped);
  memcpy(s->buffers[2].mapped, s->cells.data, s->cells.size_bytes);
  memcpy((char *)s->buffers[2].mapped + s->cells.size_bytes, s->irradiance, light);
  const VkDescriptorType storage = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, types[3] = {storage, storage, storage};
  const gpu_binding bindings[3] = {{.type = storage, .buffer = &s->buffers[0]},
                                   {.type = storage, .buffer = &s->buffers[1]},
                                   {.type = storage, .buffer = &s->buffers[2]}};
  assert_true(gpu_set_create(d, "volume", types, 3, VK_SHADER_STAGE_COMPUTE_BIT, &s->set));
  gpu_set_write(d, &s->set, bindings, 3);
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
    for (uint32_t i = 0; i < 3; i++) gpu_buffer_destroy(d, &s->buffers[i]);
    code = host_close_device(d);
  }
  olx_volume_cells_free(&s->cells);
  olx_scene_free(s->scene);
  free(s->irradiance);
  free(s);
  return code;
}

// The results of C for an item: whole numbers first, then floats.
typedef struct answer {
  uint32_t wholes[2], whole_count, float_count;
  float floats[18];
} answer;

static void put_3(answer *a, olx_vec3 v) {
  olx_store3(a->floats + a->float_count, v);
  a->float_count += 3;
}

static void volume_find(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a) {
  (void)i, (void)n;
  olx_volume_place place = {.probes = NULL};
  const olx_volume *v = &s->field.volume;
  a->whole_count = 2;
  a->float_count = 8;
  a->wholes[0] = olx_volume_find(v, p, &place);
  a->wholes[1] = a->wholes[0] ? (uint32_t)(place.probes - (const uint32_t *)(const void *)v->header) : 0;
  memcpy(a->floats, place.weights, sizeof place.weights);
}

static void volume_coefficient(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a) {
  (void)p, (void)n;
  const uint16_t *halves = s->irradiance + (size_t)OLX_VOLUME_HALVES * (i % s->cells.probe_count);
  for (uint32_t k = 0; k < 6; k++) put_3(a, olx_harmonics_coefficient(halves, k + 3));
}

static void harmonics_at(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a) {
  (void)s, (void)i, (void)p;
  a->float_count = OLX_HARMONICS_MOST;
  olx_harmonics_at(n, a->floats);
}

static void volume_weight(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a) {
  (void)s, (void)i, (void)p;
  const float x = n.x - floorf(n.x), y = n.y - floorf(n.y), z = n.z - floorf(n.z);
  a->float_count = 8;
  for (uint32_t k = 0; k < 8; k++) a->floats[k] = (k & 1 ? x : 1 - x) * (k & 2 ? y : 1 - y) * (k & 4 ? z : 1 - z);
}

// The row's answer is the offset of a probe's light, which follows the structure.
static void volume_light(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a) {
  (void)p, (void)n;
  a->whole_count = 1;
  a->wholes[0] = (uint32_t)(s->cells.size_bytes / 4 + OLX_VOLUME_HALVES / 2 * (i % s->cells.probe_count));
}

static olx_vec3 probe_towards(const setting *s, uint32_t probe, olx_vec3 n) {
  const uint16_t *halves = s->irradiance + (size_t)OLX_VOLUME_HALVES * probe;
  float values[OLX_HARMONICS_MOST];
  olx_harmonics_at(n, values);
  olx_vec3 sum = {0, 0, 0};
  for (uint32_t k = 0; k < OLX_HARMONICS_MOST; k++) {
    sum = olx_madd(sum, olx_harmonics_coefficient(halves, k), values[k]);
  }
  return sum;
}

static void volume_probe(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a) {
  (void)p;
  const uint32_t probe = i % s->cells.probe_count;
  const olx_vec3 bent = {n.y, n.z, n.x}, behind = probe_towards(s, probe, olx_negate(n));
  put_3(a, probe_towards(s, probe, n));
  put_3(a, olx_madd(probe_towards(s, probe, bent), behind, 0.5f * olx_dot(n, bent) - 0.5f));
}

static void volume_both(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a) {
  (void)i;
  olx_volume_light_at light = {.coefficients = {{0}}};
  a->whole_count = 1;
  a->wholes[0] = olx_volume_gather(&s->field, p, n, &light);
  put_3(a, olx_volume_towards(&light, n));
  put_3(a, olx_volume_bent(&light, n, olx_v3(n.y, n.z, n.x)));
}

typedef struct volume_row {
  uint32_t number;
  const char *name;
  void (*evaluate)(const setting *s, uint32_t i, olx_vec3 p, olx_vec3 n, answer *a);
} volume_row;

// clang-format off
#define PARITY(name, evaluate) { ROW_olx_##name, #name, evaluate }

static const volume_row ROWS[] = {
    PARITY(volume_find, volume_find),
    PARITY(volume_weight, volume_weight),
    PARITY(volume_light, volume_light),
    PARITY(volume_coefficient, volume_coefficient),
    PARITY(harmonics_at, harmonics_at),
    PARITY(volume_probe, volume_probe),
    PARITY(volume_both, volume_both),
};
// clang-format on

static bool agrees(const answer *a, const uint32_t *words) {
  for (uint32_t k = 0; k < a->whole_count; k++) {
    if (words[k] != a->wholes[k]) return false;
  }
  for (uint32_t k = 0; k < a->float_count; k++) {
    float found;
    memcpy(&found, &words[a->whole_count + k], sizeof found);
    if (!(fabsf(found - a->floats[k]) <= 1e-5f * olx_max(fabsf(a->floats[k]), 1.0f))) return false;
  }
  return true;
}

// Results that depend on a comparison may differ at one point in a thousand, since devices round divisions differently.
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
    uint32_t bad = 0, found = 0;
    for (uint32_t i = 0; i < PARITY_ITEMS; i++) {
      const volume_item *item = (const volume_item *)s->buffers[0].mapped + i;
      answer a = {.float_count = 0};
      ROWS[r].evaluate(s, i, olx_load3(item->position), olx_load3(item->normal), &a);
      found += a.whole_count && a.wholes[0];
      bad += !agrees(&a, (const uint32_t *)s->buffers[1].mapped + (size_t)PARITY_RESULTS * i);
    }
    print_message("  %-20s %u of %u apart\n", ROWS[r].name, bad, PARITY_ITEMS);
    if (bad > PARITY_ITEMS / 1000) fail_msg("%s: %u apart", ROWS[r].name, bad);
    if (row == ROW_olx_volume_find) assert_true(found > PARITY_ITEMS / 8 && found < PARITY_ITEMS);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(shaders_agree_with_c, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
