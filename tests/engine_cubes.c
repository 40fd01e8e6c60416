// Loads exported irradiance volumes and looks them up, from descriptions of the file format and of the engine alone.
#include "engine_cubes.h"

#include "core/hooks.h"
#include "core/sampling.h"
#include "field/field_data.h"
#include "scene/bvh.h"
#include "scene/scene_data.h"
#include "shade/surface_irradiance.h"
#include "shade/volume_irradiance.h"
#include "synthetic_field.h"
#include "tiny_scenes.h"

#include <octalux/sample.h>

#include <cjson/cJSON.h>
#include <zstd.h>

// ---- The loader

static uint64_t read_word(const unsigned char *bytes, uint32_t count) {
  uint64_t value = 0;
  for (uint32_t i = 0; i < count; i++) value |= (uint64_t)bytes[i] << 8 * i;
  return value;
}
static uint32_t u32(const unsigned char *bytes) { return (uint32_t)read_word(bytes, 4); }

// The extension that defines the format says: mantissa / 2^9 times two to the power of exponent - 15.
static olx_vec3 decode_texel(uint32_t code) {
  const float scale = ldexpf(1.0f, (int)(code >> 27) - 15 - 9);
  return olx_v3((float)(code & 511) * scale, (float)(code >> 9 & 511) * scale, (float)(code >> 18 & 511) * scale);
}

static void read_numbers(const cJSON *object, const char *key, double numbers[3]) {
  const cJSON *list = cJSON_GetObjectItem(object, key);
  assert_int_equal(cJSON_GetArraySize(list), 3);
  for (int i = 0; i < 3; i++) numbers[i] = cJSON_GetArrayItem(list, i)->valuedouble;
}

static void read_transform(engine_volume *v, const char *text) {
  cJSON *object = cJSON_Parse(text);
  assert_non_null(object);
  read_numbers(object, "translation", v->translation);
  read_numbers(object, "scale", v->scale);
  cJSON_Delete(object);
}

// Entries are sorted by key; each has its length, the key, a zero, the text, a zero, and padding to four bytes.
static void read_entries(engine_volume *v, const unsigned char *bytes, uint32_t size_bytes) {
  const char *last = "";
  bool found = false;
  for (uint32_t at = 0; at < size_bytes;) {
    const uint32_t length = u32(bytes + at);
    const char *key = (const char *)bytes + at + 4, *text = key + strlen(key) + 1;
    assert_true(strcmp(last, key) < 0 && strlen(key) + strlen(text) + 2 == length);
    if (strcmp(key, "octalux.volume") == 0) {
      read_transform(v, text);
      found = true;
    }
    last = key;
    at += 4 + (length + 3) / 4 * 4;
    assert_true(at <= size_bytes);
  }
  assert_true(found);
}

static void read_texels(engine_volume *v, const unsigned char *stored, size_t stored_bytes, size_t raw_bytes) {
  unsigned char *raw = olx_allocate(raw_bytes, 1);
  const size_t count = (size_t)v->size[0] * v->size[1] * v->size[2];
  assert_int_equal(raw_bytes, 4 * count);
  if (v->compressed) assert_int_equal(ZSTD_decompress(raw, raw_bytes, stored, stored_bytes), raw_bytes);
  else memcpy(raw, stored, stored_bytes);
  v->texels = olx_allocate(count, sizeof *v->texels);
  for (size_t i = 0; i < count; i++) v->texels[i] = decode_texel(u32(raw + 4 * i));
  olx_release(raw);
}

engine_volume engine_volume_load(const char *path) {
  static const unsigned char magic[] = {0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32, 0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
  engine_volume v = {.texels = NULL};
  size_t size_bytes;
  unsigned char *bytes = synthetic_read_file(path, &size_bytes);
  assert_true(bytes && size_bytes > 104 && memcmp(bytes, magic, sizeof magic) == 0);
  assert_int_equal(u32(bytes + 12), 123); // VK_FORMAT_E5B9G9R9_UFLOAT_PACK32
  for (uint32_t i = 0; i < 3; i++) v.size[i] = u32(bytes + 20 + 4 * i);
  assert_true(u32(bytes + 32) == 0 && u32(bytes + 36) == 1 && u32(bytes + 40) == 1); // layers, faces, levels
  assert_true(u32(bytes + 44) == 0 || u32(bytes + 44) == 2);
  v.compressed = u32(bytes + 44) == 2;
  read_entries(&v, bytes + u32(bytes + 56), u32(bytes + 60));
  const size_t offset = read_word(bytes + 80, 8), stored = read_word(bytes + 88, 8);
  assert_true(offset % 4 == 0 && offset + stored == size_bytes);
  read_texels(&v, bytes + offset, stored, read_word(bytes + 96, 8));
  olx_release(bytes);
  return v;
}

void engine_volume_free(engine_volume *volume) {
  olx_release(volume->texels);
  volume->texels = NULL;
}

// ---- The look-up

// A linear filter at a coordinate in texels, whose centres are halfway between whole numbers. It is clamped to the
// edge.
typedef struct filter {
  uint32_t texels[2];
  float share; // of the second
} filter;

static filter filter_at(float coordinate, uint32_t size) {
  const float at = coordinate - 0.5f, low = floorf(at), last = (float)size - 1.0f;
  return (filter){{(uint32_t)olx_clamp(low, 0.0f, last), (uint32_t)olx_clamp(low + 1.0f, 0.0f, last)}, at - low};
}

static olx_vec3 sample(const engine_volume *v, float s, float t, float p) {
  const filter f[3] = {filter_at(s, v->size[0]), filter_at(t, v->size[1]), filter_at(p, v->size[2])};
  olx_vec3 sum = {0};
  for (uint32_t i = 0; i < 8; i++) {
    const uint32_t bits[3] = {i & 1, i >> 1 & 1, i >> 2};
    float weight = 1.0f;
    for (uint32_t axis = 0; axis < 3; axis++) weight *= bits[axis] ? f[axis].share : 1.0f - f[axis].share;
    const size_t row = f[1].texels[bits[1]] + (size_t)v->size[1] * f[2].texels[bits[2]];
    sum = olx_madd(sum, v->texels[f[0].texels[bits[0]] + v->size[0] * row], weight);
  }
  return sum;
}

olx_vec3 engine_light(const engine_volume *v, olx_vec3 position, olx_vec3 normal) {
  const float place[3] = {position.x, position.y, position.z}, n[3] = {normal.x, normal.y, normal.z};
  const uint32_t voxels[3] = {v->size[0], v->size[1] / 2, v->size[2] / 3};
  float at[3];
  for (uint32_t i = 0; i < 3; i++) { // in the cube about 0; then in voxels, half a voxel off the faces
    const float in_cube = (float)(((double)place[i] - v->translation[i]) / v->scale[i]), count = (float)voxels[i];
    assert_true(fabsf(in_cube) <= 0.5f);
    at[i] = olx_clamp((in_cube + 0.5f) * count, 0.5f, count - 0.5f);
  }
  olx_vec3 sum = {0};
  for (uint32_t axis = 0; axis < 3; axis++) {
    const float half = n[axis] < 0.0f ? (float)voxels[1] : 0.0f;
    const olx_vec3 light = sample(v, at[0], at[1] + half, at[2] + (float)(axis * voxels[2]));
    sum = olx_madd(sum, light, n[axis] * n[axis]);
  }
  return sum;
}

// ---- What is compared with

static lit_points room_for(uint32_t count) {
  return (lit_points){.positions = olx_allocate(count, sizeof(olx_vec3)),
                      .normals = olx_allocate(count, sizeof(olx_vec3)),
                      .irradiance = olx_allocate(count, sizeof(olx_vec3))};
}

void lit_points_free(lit_points *points) {
  olx_release(points->positions);
  olx_release(points->normals);
  olx_release(points->irradiance);
}

static void add_point(lit_points *points, olx_vec3 position, olx_vec3 normal, olx_vec3 irradiance) {
  points->positions[points->count] = position;
  points->normals[points->count] = normal;
  points->irradiance[points->count++] = irradiance;
}

static float random_number(uint32_t i, uint32_t of) { return olx_unit_float(olx_hash3(i, of, 0x43554245)); }

// Returns a place on a triangle and the triangle's normal, as long as twice its area.
static olx_vec3 on_triangle(const olx_scene_content *s, uint32_t triangle, float a, float b, olx_vec3 *normal) {
  const uint32_t *i = s->indices + 3 * (size_t)triangle;
  const olx_vec3 p = s->positions[i[0]], u = olx_sub(s->positions[i[1]], p), w = olx_sub(s->positions[i[2]], p);
  if (a + b > 1.0f) {
    a = 1.0f - a;
    b = 1.0f - b;
  }
  *normal = olx_cross(u, w);
  return olx_madd(olx_madd(p, u, a), w, b);
}

static float *areas_up_to(const olx_scene_content *s) {
  float *sums = olx_allocate(s->triangle_count, sizeof *sums);
  double sum = 0.0;
  for (uint32_t i = 0; i < s->triangle_count; i++) {
    olx_vec3 normal;
    on_triangle(s, i, 0.0f, 0.0f, &normal);
    sum += (double)olx_length(normal);
    sums[i] = (float)sum;
  }
  return sums;
}

static uint32_t find_triangle(const float *sums, uint32_t count, float share) {
  uint32_t low = 0, high = count - 1;
  while (low < high) {
    const uint32_t middle = (low + high) / 2;
    if (sums[middle] < share * sums[count - 1]) low = middle + 1;
    else high = middle;
  }
  return low;
}

// Returns whether a ray from a probe reaches that side of the surface; the light of others is only guessed.
static bool is_seen(const olx_scene *scene, const olx_field *field, olx_vec3 place, olx_vec3 normal) {
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) {
    const olx_vec3 from = olx_field_probe_position(field, probe), way = olx_sub(place, from);
    if (olx_field_probe_buried(field, probe) || !(olx_dot(way, normal) < 0.0f)) continue;
    const float reach = olx_length(way) * (1.0f - 1e-3f);
    const olx_ray ray = {from, olx_normalize(way), 0.0f, reach};
    if (!olx_bvh_occluded(scene->bvh, &ray)) return true;
  }
  return false;
}

lit_points lit_surfaces(const olx_scene *scene, const olx_field *field, uint32_t tries) {
  const olx_scene_content content = olx_scene_get_content(scene);
  const olx_sample_settings settings = olx_sample_settings_default();
  lit_points points = room_for(tries);
  float *sums = areas_up_to(&content);
  for (uint32_t i = 0; i < tries; i++) {
    olx_vec3 normal;
    const uint32_t triangle = find_triangle(sums, content.triangle_count, random_number(i, 0));
    const olx_vec3 place = on_triangle(&content, triangle, random_number(i, 1), random_number(i, 2), &normal);
    normal = olx_scale(olx_normalize(normal), i & 1 ? -1.0f : 1.0f);
    const olx_surface_point point = {place, normal, normal, normal, normal};
    const olx_surface_light light = olx_surface_light_at(field, &settings, &point);
    if (light.probes && is_seen(scene, field, place, normal)) add_point(&points, place, normal, light.irradiance);
  }
  olx_release(sums);
  return points;
}

lit_points lit_space(const olx_field *field, uint32_t tries) {
  const olx_vec3 low = field->info.scene.bounds_min, size = olx_sub(field->info.scene.bounds_max, low);
  lit_points points = room_for(tries);
  for (uint32_t i = 0; i < tries; i++) {
    const olx_vec3 share = olx_v3(random_number(i, 3), random_number(i, 4), random_number(i, 5));
    const olx_vec3 place = olx_add(low, olx_mul(share, size)), normal = olx_sample_sphere(olx_stratified2(i, 6));
    olx_volume_light_at light;
    if (olx_volume_gather(field, place, normal, &light)) {
      add_point(&points, place, normal, olx_volume_towards(&light, normal));
    }
  }
  return points;
}

double engine_error(const engine_volume *volume, const lit_points *points) {
  double squares = 0.0, all = 0.0;
  for (uint32_t i = 0; i < points->count; i++) {
    const olx_vec3 light = engine_light(volume, points->positions[i], points->normals[i]);
    const olx_vec3 expected = points->irradiance[i], off = olx_sub(olx_scale(light, OLX_PI), expected);
    squares += (double)olx_dot(off, off);
    all += (double)olx_dot(expected, expected);
  }
  assert_true(all > 0.0);
  return squares / all;
}
