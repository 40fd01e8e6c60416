// Runs functions of shaders/lib on a device and their C twins on the same random and extreme inputs, and checks how far
// the results differ.
#include "parity.h"

#include "bake/selectors/voronoi_build.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "field/field_file.h"
#include "field/texels.h"
#include "gpu_pipeline.h"
#include "select/bricks.h"
#include "vulkan_host.h"

#include <stdio.h>
#include <stdlib.h>

#define ROOM                                                                                                           \
  {                                                                                                                    \
    {0, 0, 0}, { 4, 3, 5 }                                                                                             \
  }
#define FURNITURE                                                                                                      \
  {                                                                                                                    \
    {{0.9f, 0.0f, 1.1f}, {1.7f, 1.3f, 2.1f}}, {                                                                        \
      {2.3f, 0.0f, 2.6f}, { 3.1f, 2.1f, 3.3f }                                                                         \
    }                                                                                                                  \
  }

typedef struct parity_room {
  const char *name, *title;
  analytic_scene scene;
  olx_grid grid;
  uint32_t n, irradiance_n;
  bool bricks, voronoi;
  uint32_t classic; // texels along a side of classic maps, or 0 for none
  uint32_t lights;  // how many of LIGHTS the room has
  bool volume, compressed;
  bool on_device; // textures of blocks on the device
  bool planes;    // geometry stored as blocks
} parity_room;

static const parity_room ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {.name = "in_a_furnished_room",
                               .title = "furnished room, 2 x 2 x 2 probes, 64 texels",
                               .scene = {.room = ROOM, .box_count = 2, .boxes = FURNITURE},
                               .grid = {{0.5f, 0.5f, 0.5f}, {3.0f, 2.0f, 4.0f}, {2, 2, 2}},
                               .n = 64,
                               .irradiance_n = 16,
                               .bricks = true,
                               .voronoi = true,
                               .lights = 3,
                               .volume = true,
                               .compressed = true},
    [PARITY_OPEN_COURT] = {.name = "in_an_open_court",
                           .title = "open court, 3 x 1 x 2 probes, 32 texels",
                           .scene = {.room = ROOM, .open = true, .box_count = 2, .boxes = FURNITURE},
                           .grid = {{0.5f, 1.2f, 0.5f}, {1.5f, 0.0f, 4.0f}, {3, 1, 2}},
                           .n = 32,
                           .irradiance_n = 8,
                           .bricks = true,
                           .lights = 4},
    [PARITY_MANY_PROBES] = {.name = "where_maps_share_layers",
                            .title = "many probes, 8 texels",
                            .scene = {.room = ROOM, .box_count = 2, .boxes = FURNITURE},
                            .grid = {{0.1f, 0.1f, 0.1f}, {0.3f, 0.23f, 0.38f}, {13, 13, 13}},
                            .n = 8,
                            .irradiance_n = 8,
                            .voronoi = true,
                            .compressed = true,
                            .planes = true},
    [PARITY_ROOM_OF_BLOCKS] = {.name = "in_a_room_of_blocks",
                               .title = "furnished room, 2 x 2 x 2 probes, 64 texels in blocks",
                               .scene = {.room = ROOM, .box_count = 2, .boxes = FURNITURE},
                               .grid = {{0.5f, 0.5f, 0.5f}, {3.0f, 2.0f, 4.0f}, {2, 2, 2}},
                               .n = 64,
                               .irradiance_n = 16,
                               .bricks = true,
                               .lights = 3,
                               .compressed = true,
                               .on_device = true,
                               .planes = true},
    [PARITY_CLASSIC_ROOM] = {.name = "in_a_room_of_classic_probes",
                             .title = "2 x 2 x 2 probes, 64 classic texels",
                             .scene = {.room = ROOM},
                             .grid = {{0.5f, 0.5f, 0.5f}, {3.0f, 2.0f, 4.0f}, {2, 2, 2}},
                             .n = 8,
                             .irradiance_n = 8,
                             .classic = 64},
    [PARITY_CLASSIC_WALL] = {.name = "along_a_wall_of_classic_probes",
                             .title = "5 x 1 x 3 probes, 32 classic texels",
                             .scene = {.room = ROOM},
                             .grid = {{0.2f, 1.0f, 0.5f}, {0.8f, 0.0f, 2.0f}, {5, 1, 3}},
                             .n = 8,
                             .irradiance_n = 8,
                             .classic = 32}};

// Adds bricks over the room with random lists: it matters only that C and GLSL read the same.
enum { BRICKS = 12, DIVIDED = 6, LISTS = 32, BRICK_WORDS = 16 + BRICKS + DIVIDED * OLX_BRICK_CELL_WORDS + 4 * LISTS };

static void add_bricks(olx_field *field, uint32_t words[BRICK_WORDS]) {
  const olx_bricks_header header = {
      .origin = {-0.1f, -0.1f, -0.1f}, .cell_metres = 0.52f, .size = {2, 2, 3}, .divided = DIVIDED, .lists = LISTS};
  memcpy(words, &header, sizeof header);
  uint32_t *word = words + 16;
  for (uint32_t i = 0; i < BRICKS; i++) *word++ = i % 2 ? OLX_BRICK_DIVIDED | i / 2 : olx_hash(i) % LISTS;
  for (uint32_t i = 0; i < DIVIDED * OLX_BRICK_CELL_WORDS; i++) {
    *word++ = olx_hash2(i, 1) % LISTS | (olx_hash2(i, 2) % LISTS) << 16;
  }
  for (uint32_t i = 0; i < LISTS; i++) { // a rotation of the probes, some of them
    const uint32_t count = field->info.probes.count < 8 ? field->info.probes.count : 8,
                   length = olx_hash2(i, 3) % (count + 1);
    for (uint32_t k = 0; k < 4; k++, word++) {
      const uint32_t low = 2 * k < length ? (2 * k + i) % count : OLX_BRICK_NO_PROBE,
                     high = 2 * k + 1 < length ? (2 * k + 1 + i) % count : OLX_BRICK_NO_PROBE;
      *word = low | high << 16;
    }
  }
  field->select_data[OLX_SELECT_BRICKS] = words;
  field->select_bytes[OLX_SELECT_BRICKS] = BRICK_WORDS * sizeof words[0];
  field->info.select_mask |= 1u << OLX_SELECT_BRICKS;
  if (olx_bricks_open(words, BRICK_WORDS * sizeof words[0], field->info.probes.count, "bricks", &field->bricks) !=
      OLX_OK) {
    fail_msg("%s", olx_last_error());
  }
}

// Adds the neighbour maps and the octree as the baker makes them, in memory that the caller releases.
static void *add_voronoi(olx_field *field) {
  const olx_selector_input input = {.positions = field->probe_positions,
                                    .flags = field->probe_flags,
                                    .count = field->info.probes.count,
                                    .radiance_size = field->n,
                                    .distance_scale = field->distance_scale,
                                    .threads = 1};
  void *data = NULL;
  const olx_result built = olx_voronoi_build(&input, &data, &field->select_bytes[OLX_SELECT_VORONOI]);
  if (built != OLX_OK) fail_msg("%s", olx_last_error());
  field->select_data[OLX_SELECT_VORONOI] = data;
  field->info.select_mask |= 1u << OLX_SELECT_VORONOI;
  return data;
}

// Makes irradiance depend on the normal: it varies by a large factor in two channels, and is 0 on one side in the
// third.
static void vary_irradiance(olx_field *field) {
  uint32_t *codes = (uint32_t *)(uintptr_t)field->irradiance;
  const int32_t n = (int32_t)field->irradiance_n;
  for (uint32_t probe = 0; probe < field->info.irradiance.probe_count; probe++) {
    for (int32_t y = -1; y <= n; y++) {
      for (int32_t x = -1; x <= n; x++) {
        int32_t sx, sy;
        olx_border_source(x, y, n, &sx, &sy);
        const olx_vec3 d = olx_texel_direction((uint32_t)sx, (uint32_t)sy, field->irradiance_n);
        uint32_t *code = &codes[field->irradiance_texels * probe + olx_map_index(field->irradiance_stride, x, y)];
        *code = olx_r11g11b10f_pack(
            olx_mul(olx_r11g11b10f_unpack(*code), olx_v3(1.0f + 0.9f * d.x, 1.0f + 0.9f * d.y, olx_max(d.z, 0.0f))));
      }
    }
  }
}

// Lights of every type, and one whose emission is infinite.
static const olx_field_light LIGHTS[] = {
    {.type = OLX_LIGHT_SUN, .direction = {0.6f, -0.64f, 0.48f}, .emission = {1.0f, 0.9f, 0.5f}},
    {.type = OLX_LIGHT_POINT, .position = {2.0f, 2.6f, 1.0f}, .emission = {3.0f, 1.0f, 0.2f}},
    {.type = OLX_LIGHT_SPOT,
     .position = {1.0f, 2.9f, 4.0f},
     .direction = {0.0f, -1.0f, 0.0f},
     .emission = {2.0f, 4.0f, 6.0f},
     .cosine_inner = 0.9f,
     .cosine_outer = 0.4f},
    {.type = OLX_LIGHT_POINT, .position = {0.0f, 1.0f, 0.0f}, .emission = {INFINITY, 0.0f, 0.0f}}};

// Sets random materials of all kinds, direct light, and emission where texels are marked. Values are alike within
// blocks of 3 x 3 texels, which do not end where the tiles of emission do.
static void vary_surfaces(olx_field *field, uint32_t lights) {
  olx_field_surfaces *s = &field->surfaces;
  uint32_t *base = (uint32_t *)(uintptr_t)s->base, *direct = (uint32_t *)(uintptr_t)s->direct;
  uint16_t *specular = (uint16_t *)(uintptr_t)s->specular;
  for (size_t i = 0; i < field->texels * field->info.probes.count; i++) {
    const uint32_t x = (uint32_t)(i % field->stride) / 3, y = (uint32_t)(i / field->stride) / 3;
    const uint32_t a = olx_hash2(x, y), b = olx_hash(a), c = olx_hash(b);
    const float metal = a & 1u ? 0.0f : olx_unit_float(a), weight = a & 6u ? olx_unit_float(b) : 0.0f;
    const olx_vec3 color = {olx_unit_float(b), olx_unit_float(c), olx_unit_float(a)};
    const olx_texel_material_codes codes = olx_material_pack(color, a & 24u ? olx_unit_float(c) : 0.0f, metal, weight);
    base[i] = codes.base;
    specular[i] = codes.specular;
    direct[i] = a & 32u ? olx_rgb9e5_pack(olx_scale(color, 2.0f * olx_unit_float(olx_hash(c)))) : 0;
  }
  s->tile_count = 5;
  s->tiles = realloc((void *)(uintptr_t)s->tiles, sizeof *s->tiles * OLX_EMISSION_TILE_TEXELS * s->tile_count);
  for (uint32_t i = 0; i < OLX_EMISSION_TILE_TEXELS * s->tile_count; i++) {
    ((uint32_t *)(uintptr_t)s->tiles)[i] = olx_hash2(i, 17) & 0x87FFFFFFu; // emission up to 511 / 256
  }
  for (uint32_t i = 0; i < s->tile_side * s->tile_side * field->info.probes.count; i++) {
    ((uint32_t *)(uintptr_t)s->emission)[i] = olx_hash2(i, 19) % (s->tile_count + 2); // one is not there
  }
  s->lights = LIGHTS;
  s->light_count = lights;
  field->info.bounces.last = 0.25f;
}

// Sizes of a volume over the room and beyond, with cells, blocks, splits, and places that no probe covers.
enum {
  VOLUME_CUBES = 3 * 2 * 3,
  VOLUME_CELLS = 8,
  VOLUME_PROBES = 20,
  VOLUME_WORDS = 16 + 2 * 8 + 8 * VOLUME_CELLS + OLX_VOLUME_BLOCK_ENTRIES + VOLUME_CUBES
};

typedef struct parity_volume {
  uint32_t words[VOLUME_WORDS];
  uint16_t irradiance[OLX_VOLUME_HALVES * VOLUME_PROBES];
} parity_volume;

static uint32_t volume_entry(uint32_t i, uint32_t level, uint32_t split) {
  if (i % 6 == 0) return 0;
  if (i % 6 == 1) return OLX_VOLUME_SPLIT | split;
  return OLX_VOLUME_CELL | level << OLX_VOLUME_LEVEL_SHIFT | olx_hash(i) % VOLUME_CELLS;
}

static void add_volume(olx_field *field, parity_volume *v) {
  const olx_volume_header header = {.origin = {-0.6f, -0.6f, -0.4f},
                                    .cube_metres = 2.0f,
                                    .size = {3, 2, 3},
                                    .blocks = 1,
                                    .splits = 2,
                                    .cells = VOLUME_CELLS,
                                    .probes = VOLUME_PROBES};
  const olx_volume_split splits[2] = {
      {.normal = {1, 0, 0}, .offset = 2.1f, .behind = OLX_VOLUME_CELL | 1, .front = OLX_VOLUME_CELL | 2},
      {.normal = {0.6f, 0, 0.8f}, .offset = 1.9f, .behind = volume_entry(2, 2, 0), .front = 0}};
  uint32_t *word = v->words;
  memcpy(word, &header, sizeof header);
  memcpy(word += 16, splits, sizeof splits);
  word += 16;
  for (uint32_t i = 0; i < 8 * VOLUME_CELLS; i++) *word++ = olx_hash2(i, 5) % VOLUME_PROBES;
  for (uint32_t i = 0; i < OLX_VOLUME_BLOCK_ENTRIES; i++) *word++ = volume_entry(i, 2, 1);
  for (uint32_t i = 0; i < VOLUME_CUBES; i++) *word++ = i % 4 == 3 ? OLX_VOLUME_BLOCK : volume_entry(i, 0, 0);
  for (uint32_t i = 0; i < sizeof v->irradiance / 2; i++) {
    v->irradiance[i] =
        olx_half_pack(2.0f * olx_unit_float(olx_hash2(i, 7)) - (i % OLX_VOLUME_HALVES < 3 ? 0.0f : 1.0f));
  }
  if (olx_volume_open(v->words, sizeof v->words, "volume", &field->volume) != OLX_OK) fail_msg("%s", olx_last_error());
  field->volume.irradiance = v->irradiance;
}

// Compresses surfaces into tiles. Their materials use only the two end values of each block, since devices may round
// the values between them differently.
static void compress_surfaces(olx_field *field) {
  analytic_field_compress(field);
  const uint32_t tiles = field->surfaces.tile_side * field->surfaces.tile_side * field->info.probes.count;
  for (uint32_t i = 0; i < OLX_SURFACE_MAPS * tiles; i += 3) { // some of half resolution, by a block that is there
    uint32_t *word = (uint32_t *)(uintptr_t)field->surfaces.tiled[i / tiles].words + i % tiles;
    if (*word) *word = olx_tile_first(*word) | OLX_TILE_HALF << OLX_TILE_FORM_SHIFT;
  }
  const olx_tiled_maps *tiled = field->surfaces.tiled;
  olx_bc1_block *base = (olx_bc1_block *)(uintptr_t)tiled[OLX_SURFACE_BASE].blocks;
  olx_bc5_block *specular = (olx_bc5_block *)(uintptr_t)tiled[OLX_SURFACE_SPECULAR].blocks;
  for (uint32_t i = 0; i < tiled[OLX_SURFACE_BASE].count; i++) base[i].words[1] &= 0x55555555u;
  for (uint32_t i = 0; i < tiled[OLX_SURFACE_SPECULAR].count; i++) {
    olx_bc4_block *pair[2] = {&specular[i].red, &specular[i].green};
    for (uint32_t k = 0; k < 2; k++) {
      pair[k]->words[0] &= 0x9249FFFFu;
      pair[k]->words[1] &= 0x24924924u;
    }
  }
}

// Decodes light into texels, as a device that cannot read blocks holds it.
static void decode_light(olx_field *field) {
  const size_t texels = field->texels * field->info.probes.count;
  uint32_t *direct = calloc(texels, 4), *indirect = calloc(texels, 4);
  for (uint32_t row = 0; row < field->stride * field->info.probes.count; row++) {
    const uint32_t probe = row / field->stride;
    olx_surface_row(field, OLX_SURFACE_DIRECT, probe, row % field->stride, direct + (size_t)field->stride * row);
    olx_surface_row(field, OLX_SURFACE_INDIRECT, probe, row % field->stride, indirect + (size_t)field->stride * row);
  }
  field->surfaces.direct = direct;
  field->surfaces.indirect = indirect;
}

static olx_field *make_field(const parity_room *p) {
  olx_field *field = analytic_field_make(&p->scene, &p->grid, p->n, p->irradiance_n);
  uint16_t *distance = (uint16_t *)(uintptr_t)field->distance;
  for (size_t i = 0; i < field->texels * field->info.probes.count; i += 7) distance[i] |= 0x8000u; // emitters
  uint8_t *flags = (uint8_t *)(uintptr_t)field->probe_flags;
  for (uint32_t i = 0; i < field->info.probes.count; i += 5) flags[i] = OLX_PROBE_BURIED;
  vary_irradiance(field);
  vary_surfaces(field, p->lights);
  if (p->compressed) compress_surfaces(field);
  if (p->planes) analytic_field_block_geometry(field);
  if (p->classic) {
    analytic_field_add_classic(field, p->classic);
    uint8_t *buried = (uint8_t *)(uintptr_t)field->irradiance_flags;
    for (uint32_t i = 0; i < field->info.irradiance.probe_count; i++) buried[i] = i % 7 < 4 ? OLX_PROBE_BURIED : 0;
  }
  return field;
}

// Fills items with random numbers, among them directions along axes and in coordinate planes, points on walls, and
// numbers at the ends of their ranges.
static void fill_items(parity_item *items) {
  for (uint32_t i = 0; i < PARITY_ITEMS; i++) {
    parity_item *item = &items[i];
    for (uint32_t k = 0; k < 4; k++) item->u[k] = olx_hash3(i, k, 99);
    const olx_vec2 p = olx_stratified2(i, 1), q = olx_stratified2(i, 2);
    olx_vec3 point = olx_v3(0.02f + 3.96f * p.x, 0.02f + 2.96f * p.y, 0.02f + 4.96f * q.x);
    olx_vec3 direction = olx_sample_sphere(olx_stratified2(i, 3));
    if (i % 16 == 3) direction = olx_v3(0.0f, i & 32 ? -1.0f : 1.0f, 0.0f);
    if (i % 16 == 5) direction = olx_v3(i & 32 ? 0.6f : -1.0f, 0.0f, i & 32 ? 0.8f : 0.0f);
    if (i % 16 == 7) point.y = 0.0f;
    if (i % 64 == 9) point = olx_madd(point, direction, 3.0f);
    const olx_vec3 view = olx_from_basis(olx_sample_cosine(olx_stratified2(i, 4)), direction);
    const olx_vec2 a = olx_stratified2(i, 5), b = olx_stratified2(i, 6), c = olx_stratified2(i, 7);
    const float values[16] = {point.x,
                              point.y,
                              point.z,
                              direction.x,
                              direction.y,
                              direction.z,
                              view.x,
                              view.y,
                              view.z,
                              a.x,
                              a.y,
                              b.x,
                              b.y,
                              0.3f * q.y,
                              i % 4 ? INFINITY : 0.5f + 4.0f * c.x,
                              0.1f + 3.0f * c.y};
    memcpy(item->v, values, sizeof values);
    if (i % 64 == 11) item->v[9] = item->v[10] = 0.0f;
    if (i % 64 == 13) item->v[11] = 0.01f; // the roughness of a mirror
  }
}

static struct {
  const parity_suite *suite;
  gpu_device device;
  gpu_buffer items, results;
  gpu_set set;
  gpu_compute computes[PARITY_MOST_CODES];
} gpu;

static int set_up(void **unused) {
  (void)unused;
  gpu_device *d = &gpu.device;
  if (!host_open_device(d, true) && !host_open_device(d, false)) return 0; // the validation layers may be missing
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  assert_true(gpu_buffer_create(d, "items", sizeof(parity_item) * PARITY_ITEMS, usage, true, &gpu.items));
  assert_true(gpu_buffer_create(d, "results", 4u * PARITY_RESULTS * PARITY_ITEMS, usage, true, &gpu.results));
  fill_items(gpu.items.mapped);
  const VkDescriptorType storage = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, types[2] = {storage, storage};
  const gpu_binding bindings[2] = {{.type = storage, .buffer = &gpu.items}, {.type = storage, .buffer = &gpu.results}};
  assert_true(gpu_set_create(d, "items and results", types, 2, VK_SHADER_STAGE_COMPUTE_BIT, &gpu.set));
  gpu_set_write(d, &gpu.set, bindings, 2);
  return 0;
}

static int tear_down(void **unused) {
  (void)unused;
  gpu_device *d = &gpu.device;
  if (!d->host.device) return 0;
  for (uint32_t i = 0; i < PARITY_MOST_CODES; i++) gpu_compute_destroy(d, &gpu.computes[i]);
  gpu_set_destroy(d, &gpu.set);
  gpu_buffer_destroy(d, &gpu.items);
  gpu_buffer_destroy(d, &gpu.results);
  return host_close_device(d);
}

// A room's field and classic maps on the device.
typedef struct uploaded_room {
  olx_vulkan_field *field;
  olx_vulkan_classic *classic; // NULL for a room without classic maps
} uploaded_room;

// Makes the pipelines once: they fit every field of a suite, since all fields have the same set layouts.
static void make_pipelines(const uploaded_room *room) {
  if (gpu.computes[0].pipeline) return;
  const VkDescriptorSetLayout sets[] = {olx_vulkan_field_set_layout(room->field), gpu.set.layout,
                                        room->classic ? olx_vulkan_classic_set_layout(room->classic) : VK_NULL_HANDLE};
  assert_true(gpu.suite->code_count <= PARITY_MOST_CODES);
  for (uint32_t i = 0; i < gpu.suite->code_count; i++) {
    assert_true(gpu_compute_create(&gpu.device, "rows", gpu.suite->codes[i].code, sets, room->classic ? 3 : 2,
                                   sizeof(uint32_t), &gpu.computes[i]));
  }
}

static const gpu_compute *compute_of(uint32_t row) {
  uint32_t code = 0;
  while (row >= gpu.suite->codes[code].end) code++;
  return &gpu.computes[code];
}

// Runs one row over all items.
static void run_row(const uploaded_room *room, uint32_t row) {
  gpu_device *d = &gpu.device;
  const VkDescriptorSet sets[] = {olx_vulkan_field_set(room->field), gpu.set.set,
                                  room->classic ? olx_vulkan_classic_set(room->classic) : VK_NULL_HANDLE};
  assert_true(gpu_commands_begin(d));
  const uint32_t width = PARITY_ITEMS / 8; // a workgroup has 64 items
  gpu_compute_record(d, compute_of(row), sets, room->classic ? 3 : 2, &row, sizeof row, width, 8, d->commands);
  gpu_full_barrier(d, d->commands);
  assert_true(gpu_commands_run(d));
}

static float difference(uint32_t a_bits, uint32_t b_bits) {
  const float a = olx_bits_float(a_bits), b = olx_bits_float(b_bits);
  if (a == b || (isnan(a) && isnan(b))) return 0.0f;
  const float d = fabsf(a - b) / olx_max(fabsf(b), 1.0f);
  return d < INFINITY ? d : INFINITY;
}

static void derive(parity_state *s) {
  const parity_item *item = s->item;
  s->point = olx_v3(item->v[0], item->v[1], item->v[2]);
  s->direction = olx_v3(item->v[3], item->v[4], item->v[5]);
  s->view = olx_v3(item->v[6], item->v[7], item->v[8]);
  memcpy(s->random, &item->v[9], sizeof s->random);
  memcpy(s->bits, item->u, sizeof s->bits);
  s->probe = s->bits[0] % s->field->info.probes.count;
  s->irradiance_probe = s->bits[0] % s->field->info.irradiance.probe_count;
  s->x = s->bits[1] % s->field->n;
  s->y = s->bits[2] % s->field->n;
  s->settings = olx_sample_settings_default();
  s->settings.tracer = (olx_tracer)((s->bits[3] >> 8) % 3u);
  s->settings.visibility = s->bits[3] & 6u ? OLX_VISIBILITY_CHEBYSHEV : OLX_VISIBILITY_NONE;
  s->settings.keep_buried = (s->bits[3] & 8u) != 0;
  s->settings.emitters = (s->bits[3] & 16u) != 0;
  s->settings.hits = s->bits[3] & 0x1800u ? OLX_HITS_SHADED : OLX_HITS_STORED;
  const olx_select selects[] = {OLX_SELECT_EXHAUSTIVE, OLX_SELECT_CAGE, OLX_SELECT_BRICKS, OLX_SELECT_VORONOI,
                                OLX_SELECT_BEST};
  s->settings.select = selects[(s->bits[3] >> 5) % 5u];
  s->source = olx_irradiance_source_of(s->field);
  const olx_vec3 color = olx_v3(fabsf(s->direction.x), fabsf(s->direction.y), fabsf(s->direction.z));
  s->bsdf = olx_bsdf_make(color, s->random[0], s->random[1], s->random[2]);
}

// Compares a row's results; returns true when they are within the row's bounds.
static bool judge_row(const olx_field *field, const olx_vulkan_field *uploaded, const parity_row *row) {
  uint32_t bad = 0, first = 0;
  float worst = 0.0f;
  for (uint32_t i = 0; i < PARITY_ITEMS; i++) {
    parity_state s = {.field = field,
                      .constants = &uploaded->constants,
                      .item = (const parity_item *)gpu.items.mapped + i,
                      .index = i};
    derive(&s);
    parity_result r = {.count = 0};
    row->evaluate(&s, &r);
    const uint32_t *words = (const uint32_t *)gpu.results.mapped + (size_t)PARITY_RESULTS * i;
    float largest = 0.0f;
    for (uint32_t k = 0; k < r.count; k++) {
      const float d = r.is_float[k] ? difference(words[k], r.word[k]) : words[k] == r.word[k] ? 0.0f : INFINITY;
      largest = olx_max(largest, d);
    }
    if (largest <= row->bound) worst = olx_max(worst, largest);
    else if (bad++ == 0) first = i;
  }
  const double share = (double)bad / PARITY_ITEMS;
  print_message("  %-28s off by %.2g at most, %.4f %% apart\n", row->name, (double)worst, 100.0 * share);
  if (share <= row->allowed) return true;
  print_error("%s: %u of %d items differ by more than %g, item %u first\n", row->name, bad, PARITY_ITEMS,
              (double)row->bound, first);
  return false;
}

static void compare_room(void **state) {
  host_need_device(&gpu.device);
  const parity_room *p = *state;
  const parity_range *range = &gpu.suite->rooms[p - ROOMS];
  olx_field *field = make_field(p);
  _Alignas(64) uint32_t bricks[BRICK_WORDS];
  parity_volume volume;
  if (p->volume) add_volume(field, &volume);
  if (p->bricks) add_bricks(field, bricks);
  void *voronoi = p->voronoi ? add_voronoi(field) : NULL;
  uploaded_room room = {NULL, NULL};
  olx_vulkan_host host = gpu.device.host;
  host.texture_compression_bc = p->on_device && gpu.device.block_textures;
  if (olx_vulkan_field_create(&host, field, &room.field) != OLX_OK ||
      (p->classic && olx_vulkan_classic_create(room.field, field, &room.classic) != OLX_OK)) {
    fail_msg("%s", olx_last_error());
  }
  if (p->compressed && !host.texture_compression_bc) decode_light(field);
  make_pipelines(&room);
  print_message("%s on %s\n", p->title, gpu.device.properties.deviceName);
  uint32_t failures = 0;
  for (uint32_t i = 0; i < gpu.suite->row_count; i++) {
    const parity_row *row = &gpu.suite->rows[i];
    if (row->number < range->first || row->number >= range->end) continue;
    run_row(&room, row->number);
    failures += !judge_row(field, room.field, row);
  }
  olx_vulkan_classic_destroy(room.classic);
  olx_vulkan_field_destroy(room.field);
  if (p->classic) analytic_field_remove_classic(field);
  analytic_field_free(field);
  olx_release(voronoi);
  assert_int_equal(failures, 0);
  assert_int_equal(gpu.device.validation_messages, 0);
}

int parity_run(const parity_suite *suite) {
  struct CMUnitTest tests[PARITY_ROOMS] = {{.name = NULL}};
  size_t count = 0;
  for (uint32_t i = 0; i < PARITY_ROOMS; i++) {
    if (!suite->rooms[i].end) continue;
    tests[count++] = (struct CMUnitTest){
        .name = ROOMS[i].name, .test_func = compare_room, .initial_state = (void *)(uintptr_t)&ROOMS[i]};
  }
  gpu.suite = suite;
  return _cmocka_run_group_tests("rooms", tests, count, set_up, tear_down);
}
