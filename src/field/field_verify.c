// Verifies the contents of a field after its structure: reads every checksum, and searches every map for numbers that
// no writer stores, in parallel over chunks.
#include "core/hooks.h"
#include "core/parallel.h"
#include "core/result.h"
#include "field/field_chunks.h"
#include "field/geometry_map.h"

#include <assert.h>

// Means are of distances up to the scene's diagonal, 1, and of the sky, 1; probes may lie slightly outside the scene.
#define MAX_MEAN 1.01f
// How far rounding to half precision may raise mean^2 over the second moment: three half units in the last place, plus
// what the smallest half floats lose.
#define MOMENT_ROUNDING 0x1p-9f
#define MOMENT_SMALLEST 0x1p-24f
#define MAX_REFLECTANCE 2.0f

// Returns whether a colour has an exponent of 31, which would be infinity or NaN.
static inline bool is_bad_color(uint32_t code) {
  return (code & 0x7C0u) == 0x7C0u || (code & 0x3E0000u) == 0x3E0000u || (code & 0xF8000000u) == 0xF8000000u;
}

static inline bool is_bad_normal(uint16_t code) { return (code & 0xFFu) > 254 || code >> 8 > 254; }

// Returns whether a distance is NaN, or the sky marked as an emitter.
static inline bool is_bad_distance(uint16_t code) { return (code & 0x7FFFu) > 0x7C00u || code == 0xFC00u; }

static inline bool is_bad_moments(uint32_t code) {
  const float mean = olx_half_unpack((uint16_t)(code & 0xFFFFu)), square = olx_half_unpack((uint16_t)(code >> 16));
  // Written so that NaN fails.
  const bool possible = mean <= MAX_MEAN && square <= MAX_MEAN * MAX_MEAN * (1.0f + MOMENT_ROUNDING) &&
                        mean * mean <= square * (1.0f + MOMENT_ROUNDING) + MOMENT_SMALLEST;
  return !possible || (code & 0x80008000u);
}

// Defines a function that returns the index of the first bad code, or count. Compilers vectorise the plain loop over
// all codes.
#define FIRST_BAD(name, type, is_bad)                                                                                  \
  static size_t name(const type *codes, size_t count) {                                                                \
    uint32_t bad = 0;                                                                                                  \
    for (size_t i = 0; i < count; i++) bad |= is_bad(codes[i]);                                                        \
    if (!bad) return count;                                                                                            \
    size_t first = 0;                                                                                                  \
    while (!is_bad(codes[first])) first++;                                                                             \
    return first;                                                                                                      \
  }
FIRST_BAD(first_bad_color, uint32_t, is_bad_color)
FIRST_BAD(first_bad_normal, uint16_t, is_bad_normal)
FIRST_BAD(first_bad_distance, uint16_t, is_bad_distance)
FIRST_BAD(first_bad_moments, uint32_t, is_bad_moments)

static olx_result fail_at(const olx_field *field, const char *what, uint32_t probe, size_t texel, uint32_t stride,
                          uint32_t code, const char *problem) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s of probe %u, texel (%d, %d): %s (code %#x)", field->name, what, probe,
                  (int)(texel % stride) - 1, (int)(texel / stride) - 1, problem, code);
}

static olx_result check_border(const olx_field *field, const char *what, uint32_t probe, const void *map, uint32_t n,
                               size_t texel_bytes) {
  const char *texels = map;
  const int32_t size = (int32_t)n;
  const size_t stride = n + 2;
  for (int32_t y = -1; y <= size; y++) {
    for (int32_t x = -1; x <= size; x += y >= 0 && y < size ? size + 1 : 1) {
      int32_t source_x, source_y;
      olx_border_source(x, y, size, &source_x, &source_y);
      const size_t border = (size_t)(y + 1) * stride + (size_t)(x + 1);
      const size_t source = (size_t)(source_y + 1) * stride + (size_t)(source_x + 1);
      if (memcmp(texels + border * texel_bytes, texels + source * texel_bytes, texel_bytes) != 0) {
        return olx_fail(OLX_ERROR_FORMAT, "%s: %s of probe %u: border texel (%d, %d) differs from texel (%d, %d)",
                        field->name, what, probe, x, y, source_x, source_y);
      }
    }
  }
  return OLX_OK;
}

static olx_result check_probe_flags(const olx_field *field, const char *kind, uint32_t probe, uint8_t flags) {
  if ((flags & ~OLX_PROBE_BURIED) == 0) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: flags of %s probe %u: unknown bits (%#x)", field->name, kind, probe, flags);
}

static olx_result fail_at_node(const olx_field *field, const char *what, uint32_t probe, uint32_t level, uint32_t x,
                               uint32_t y, uint16_t code, uint16_t expected) {
  return olx_fail(OLX_ERROR_FORMAT, "%s: %s distance of probe %u, level %u, node (%u, %u): %#x, but it is %#x",
                  field->name, what, probe, level, x, y, code, expected);
}

static olx_result check_pyramid_level(const olx_field *field, const olx_pyramid_base *base, uint32_t probe,
                                      uint32_t level) {
  const olx_pyramid_shape *shape = &field->pyramid;
  const uint16_t *least = field->least + (size_t)shape->least_nodes * probe,
                 *greatest = field->greatest + (size_t)shape->greatest_nodes * probe;
  const uint32_t side = shape->side[level];
  for (uint32_t y = 0; y < side; y++) {
    for (uint32_t x = 0; x < side; x++) {
      const uint32_t at = shape->first[level] + olx_pyramid_index(side, x, y);
      const uint16_t smallest = olx_pyramid_least(shape, base, least, level, x, y);
      if (least[at] != smallest) return fail_at_node(field, "least", probe, level, x, y, least[at], smallest);
      if (level < shape->greatest_level) continue;
      const uint16_t largest = olx_pyramid_greatest(shape, base, greatest, level, x, y);
      if (greatest[at] != largest) return fail_at_node(field, "greatest", probe, level, x, y, greatest[at], largest);
    }
  }
  return OLX_OK;
}

static olx_result check_pyramid(const olx_field *field, const olx_pyramid_base *base, uint32_t probe) {
  for (uint32_t level = field->pyramid.least_level; level < field->pyramid.levels; level++) {
    OLX_TRY(check_pyramid_level(field, base, probe, level));
  }
  return OLX_OK;
}

static olx_result check_texels(const olx_field *field, uint32_t probe) {
  const size_t texels = field->texels;
  const uint16_t *normal = field->normal + texels * probe, *distance = field->distance + texels * probe;
  size_t bad = first_bad_normal(normal, texels);
  if (bad < texels) return fail_at(field, "normal", probe, bad, field->stride, normal[bad], "a coordinate beyond 254");
  bad = first_bad_distance(distance, texels);
  if (bad < texels) {
    return fail_at(field, "distance", probe, bad, field->stride, distance[bad], "NaN or a marked sky");
  }
  OLX_TRY(check_border(field, "normal", probe, normal, field->n, 2));
  OLX_TRY(check_border(field, "distance", probe, distance, field->n, 2));
  const olx_pyramid_base base = olx_pyramid_over_texels(distance + field->stride + 1, field->stride);
  return check_pyramid(field, &base, probe);
}

static olx_result check_block_pyramid(const olx_field *field, uint32_t probe, size_t count) {
  const olx_geometry_map map = {field->geometry + count * probe, field->planes};
  uint16_t *least = olx_allocate(2 * count, sizeof *least);
  if (!least) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for a pyramid", field->name);
  const olx_pyramid_base base = olx_pyramid_over_blocks(&map, field->n, field->distance_scale, least, least + count);
  const olx_result result = check_pyramid(field, &base, probe);
  olx_release(least);
  return result;
}

static olx_result check_blocks(const olx_field *field, uint32_t probe) {
  const uint32_t side = field->n / OLX_BLOCK_SIDE, count = side * side;
  for (uint32_t i = 0; i < count; i++) {
    const olx_geometry_block *block = &field->geometry[(size_t)count * probe + i];
    const olx_block_place place = {field->n, i % side, i / side};
    const char *problem = olx_geometry_check(block, field->planes.count);
    if (!problem && block->words[3] >> 30 == OLX_GEOMETRY_POOL &&
        (block->words[3] & 0x3FFFFFFFu) != olx_geometry_nearest_code(block, &field->planes, place)) {
      problem = "planes that come nearer or less near than it says";
    }
    if (!problem) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: geometry of probe %u, block (%u, %u): %s", field->name, probe, i % side,
                    i / side, problem);
  }
  return check_block_pyramid(field, probe, count);
}

static olx_result check_surface_borders(const olx_field *field, uint32_t probe) {
  const olx_field_surfaces *s = &field->surfaces;
  const size_t first = field->texels * probe;
  OLX_TRY(check_border(field, "base colour", probe, s->base + first, field->n, 4));
  OLX_TRY(check_border(field, "specular", probe, s->specular + first, field->n, 2));
  OLX_TRY(check_border(field, "direct light", probe, s->direct + first, field->n, 4));
  return check_border(field, "indirect light", probe, s->indirect + first, field->n, 4);
}

olx_result olx_probe_flags_verify(const olx_field *field, uint32_t probe) {
  return check_probe_flags(field, "light field", probe, field->probe_flags[probe]);
}

olx_result olx_geometry_verify(const olx_field *field, uint32_t probe) {
  return field->geometry ? check_blocks(field, probe) : check_texels(field, probe);
}

static olx_result check_color_map(const olx_field *field, const char *what, uint32_t probe, const uint32_t *map,
                                  uint32_t n) {
  const size_t texels = (size_t)(n + 2) * (n + 2), bad = first_bad_color(map, texels);
  if (bad < texels) return fail_at(field, what, probe, bad, n + 2, map[bad], "not a finite number");
  return check_border(field, what, probe, map, n, 4);
}

olx_result olx_radiance_verify(const olx_field *field, uint32_t probe) {
  return check_color_map(field, "radiance", probe, field->radiance + field->texels * probe, field->n);
}

olx_result olx_surfaces_verify(const olx_field *field, uint32_t probe) {
  if (!field->info.maps.compressed) OLX_TRY(check_surface_borders(field, probe));
  return olx_surface_contents_verify(field, probe);
}

olx_result olx_irradiance_flags_verify(const olx_field *field, uint32_t probe) {
  return check_probe_flags(field, "irradiance", probe, field->irradiance_flags[probe]);
}

static olx_result check_harmonics(const olx_field *field, uint32_t probe) {
  const uint16_t *halves = field->harmonics + (size_t)field->harmonic_halves * probe;
  const uint32_t bad = olx_harmonics_first_bad(halves, field->bands);
  if (bad == field->harmonic_halves) return OLX_OK;
  return olx_fail(OLX_ERROR_FORMAT, "%s: irradiance of probe %u: coefficient %u: impossible (code %#x)", field->name,
                  probe, bad / 3, halves[bad]);
}

olx_result olx_irradiance_verify(const olx_field *field, uint32_t probe) {
  if (field->bands) return check_harmonics(field, probe);
  const uint32_t *map = field->irradiance + field->irradiance_texels * probe;
  return check_color_map(field, "irradiance", probe, map, field->irradiance_n);
}

olx_result olx_moments_verify(const olx_field *field, uint32_t probe) {
  const size_t texels = field->irradiance_texels;
  const uint32_t n = field->irradiance_n, *moments = field->moments + texels * probe;
  const size_t bad = first_bad_moments(moments, texels);
  if (bad < texels) return fail_at(field, "moments", probe, bad, n + 2, moments[bad], "impossible moments");
  return check_border(field, "moments", probe, moments, n, 4);
}

olx_result olx_classic_irradiance_verify(const olx_field *field, uint32_t probe) {
  const olx_classic_maps *maps = &field->classic;
  const uint32_t *map = maps->irradiance + maps->irradiance_texels * probe;
  return check_color_map(field, "classic irradiance", probe, map, maps->size);
}

olx_result olx_classic_radiance_verify(const olx_field *field, uint32_t probe) {
  const olx_classic_maps *maps = &field->classic;
  for (uint32_t level = 0; level < OLX_CLASSIC_LEVELS; level++) {
    const uint32_t *map = maps->radiance + maps->radiance_texels * probe + maps->level_first[level];
    OLX_TRY(check_color_map(field, "classic radiance", probe, map, olx_classic_side(maps->size, level)));
  }
  return OLX_OK;
}

// Checks the table of classic maps, irradiance probes without visibility. Scale plus bias is at most the light that a
// lobe without absorption reflects; the fit may exceed it a little.
olx_result olx_classic_table_verify(const olx_field *field, uint32_t record) {
  (void)record;
  for (uint32_t i = 0; i < OLX_CLASSIC_TABLE_ENTRIES; i++) {
    const uint32_t code = field->classic.table[i];
    const float scale = olx_half_unpack((uint16_t)(code & 0xFFFFu)), bias = olx_half_unpack((uint16_t)(code >> 16));
    if (scale >= 0.0f && bias >= 0.0f && scale + bias <= MAX_REFLECTANCE && !(code & 0x80008000u)) continue;
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk CLAS: entry %u of the table: impossible reflectance (%#x)",
                    field->name, i, code);
  }
  return OLX_OK;
}

static olx_result check_chunk(const olx_field *field, uint32_t index) {
  const olx_chunk_file file = olx_field_file(field);
  return olx_chunk_check_content(&file, index);
}

typedef olx_result (*check_function)(const olx_field *field, uint32_t index);

typedef struct checks {
  const olx_field *field;
  check_function check;
  atomic_uint first_bad;
} checks;

static void run_check(void *user, uint32_t index) {
  checks *c = user;
  uint32_t first = atomic_load_explicit(&c->first_bad, memory_order_relaxed);
  if (index >= first || c->check(c->field, index) == OLX_OK) return;
  while (index < first && !atomic_compare_exchange_weak(&c->first_bad, &first, index)) continue;
}

// Reports the first failure by index, in whatever order the threads run.
static olx_result check_all(const olx_field *field, check_function check, uint32_t count) {
  checks c = {.field = field, .check = check};
  atomic_init(&c.first_bad, count);
  OLX_TRY(olx_parallel_for(count, 0, run_check, &c, NULL, 0));
  const uint32_t first = atomic_load(&c.first_bad);
  // The last message is kept per thread, so the check runs again on this one.
  return first < count ? check(field, first) : OLX_OK;
}

// Verifies every record of a chunk, if the file has it.
static olx_result verify_kind(const olx_field *field, const olx_chunk_file *file, olx_chunk_kind kind) {
  const olx_chunk_traits *k = &olx_chunk_kinds[kind];
  const olx_file_chunk *chunk;
  if (!k->verify) return OLX_OK;
  OLX_TRY(olx_chunk_find_any(file, olx_chunk_form_of(&field->info, kind)->type, &chunk));
  return chunk ? check_all(field, k->verify, (uint32_t)k->records_of(&field->info)) : OLX_OK;
}

olx_result olx_field_verify(const olx_field *field) {
  assert(field);
  const olx_chunk_file file = olx_field_file(field);
  const olx_file_header *header = field->data;
  OLX_TRY(check_all(field, check_chunk, header->chunk_count));
  for (uint32_t k = 0; k < OLX_CHUNK_KINDS; k++) OLX_TRY(verify_kind(field, &file, k));
  return OLX_OK;
}
