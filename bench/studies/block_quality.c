// Measures blocks of 4 x 4 texels for a baked field (docs/maths.md, "Blocks"): bytes, errors against the
// values that the field stores, and the time of encoding and decoding.
//
//   block-quality FIELD.olx [TOLERANCE] [LEAST_COSINE] [SCENE]
//
// With the field's scene, random rays are traced through the field before and after its distances and normals have been
// replaced by those of decoded planes.
#include "block/bc1_encode.h"
#include "block/bc4_encode.h"
#include "block/bc6h_encode.h"
#include "block/geometry_encode.h"
#include "block/reflectance.h"
#include "field/texels.h"
#include "options.h"
#include "studies.h"

#include <octalux/render.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const char NAME[] = BENCH_PROGRAM " block-quality";

enum { TEXELS = OLX_BLOCK_TEXELS };

// Errors are relative to a texel's light, or to this share of the brightest light in its block where that is greater.
static const float LEAST_BRIGHTNESS = 0.01f;

// The blocks of one probe: input and decoded output.
typedef struct probe_blocks {
  uint32_t count;
  olx_block_place *places;
  uint32_t *seen; // a bit for each texel that is not sky
  olx_geometry_texel *surfaces;
  olx_vec3 *direct, *indirect;
  float *brightness; // largest channel of all light of each texel
  uint32_t *base;    // base colour and roughness
  uint8_t *roughness, *reflectance;
  olx_geometry_code *codes;
  olx_bc6h_block *light;
  olx_vec3 *decoded;
} probe_blocks;

// Values that are sorted to compute quantiles.
typedef struct samples {
  float *values;
  size_t count, capacity;
} samples;

typedef struct light_report {
  double error, square, relative;
  samples each; // errors, relative to brightness
  double encode_seconds, decode_seconds;
} light_report;

// The cost and the errors of a method of coding materials.
typedef struct material_report {
  double error, square; // mean and squared error of base colour
  samples color, bytes; // relative errors of base colours; errors of roughness or reflectance, of 255
  double encode_seconds, decode_seconds;
} material_report;

typedef struct report {
  uint64_t blocks, texels, seen;
  uint64_t forms[5]; // number of blocks with one plane, two, planes of the pool, sky alone, sky beside a plane
  uint64_t pooled,
      odd; // planes in the pool; texels in blocks of the pool that are not on their two most frequent planes
  samples miss, radial, angle;
  double encode_seconds, decode_seconds;
  light_report direct, indirect;
  material_report bc1, bc4_roughness, bc4_reflectance;
} report;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void add_sample(samples *s, double value) {
  if (s->count == s->capacity) {
    s->capacity = s->capacity ? 2 * s->capacity : 4096;
    s->values = realloc(s->values, s->capacity * sizeof *s->values);
    if (!s->values) exit(1);
  }
  s->values[s->count++] = (float)value;
}

static int by_value(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return x < y ? -1 : x > y;
}

static double quantile(samples *s, double share) {
  if (!s->count) return 0.0;
  const size_t at = (size_t)(share * (double)(s->count - 1));
  return (double)s->values[at];
}

static void print_quantiles(const char *what, samples *s) {
  if (!s->count) return;
  qsort(s->values, s->count, sizeof *s->values, by_value);
  printf("  %-34s median %.5f  99 %% %.4f  99.9 %% %.4f  most %.4f\n", what, quantile(s, 0.5), quantile(s, 0.99),
         quantile(s, 0.999), quantile(s, 1.0));
}

static void *allocate(size_t count, size_t size) {
  void *memory = calloc(count ? count : 1, size);
  if (!memory) exit(1);
  return memory;
}

static probe_blocks make_blocks(uint32_t n) {
  const uint32_t side = n / OLX_BLOCK_SIDE, count = side * side, texels = count * TEXELS;
  probe_blocks b = {.count = count,
                    .places = allocate(count, sizeof *b.places),
                    .seen = allocate(count, sizeof *b.seen),
                    .surfaces = allocate(texels, sizeof *b.surfaces),
                    .direct = allocate(texels, sizeof *b.direct),
                    .indirect = allocate(texels, sizeof *b.indirect),
                    .brightness = allocate(texels, sizeof *b.brightness),
                    .base = allocate(texels, sizeof *b.base),
                    .roughness = allocate(texels, sizeof *b.roughness),
                    .reflectance = allocate(texels, sizeof *b.reflectance),
                    .codes = allocate(count, sizeof *b.codes),
                    .light = allocate(count, sizeof *b.light),
                    .decoded = allocate(texels, sizeof *b.decoded)};
  for (uint32_t i = 0; i < count; i++) b.places[i] = (olx_block_place){n, i % side, i / side};
  return b;
}

static size_t texel_index(const olx_field *field, olx_block_place place, uint32_t i) {
  return olx_map_index(field->stride, (int32_t)(OLX_BLOCK_SIDE * place.x + i % OLX_BLOCK_SIDE),
                       (int32_t)(OLX_BLOCK_SIDE * place.y + i / OLX_BLOCK_SIDE));
}

static void read_block(const olx_field *field, uint32_t probe, probe_blocks *b, uint32_t block) {
  b->seen[block] = 0;
  for (uint32_t i = 0; i < TEXELS; i++) {
    const size_t texel = texel_index(field, b->places[block], i), at = TEXELS * block + i;
    const float distance = olx_texel_distance(field, probe, texel);
    b->surfaces[at] = (olx_geometry_texel){distance, olx_texel_normal(field, probe, texel)};
    b->seen[block] |= (uint32_t)(distance < INFINITY) << i;
    b->direct[at] = olx_texel_direct(field, probe, texel);
    b->indirect[at] = olx_texel_indirect(field, probe, texel);
    b->brightness[at] = olx_max3(olx_add(b->direct[at], b->indirect[at]));
    const uint32_t specular = field->surfaces.specular[field->texels * probe + texel];
    b->base[at] = field->surfaces.base[field->texels * probe + texel];
    b->roughness[at] = (uint8_t)(b->base[at] >> 24);
    b->reflectance[at] =
        olx_reflectance_pack((olx_reflectance){olx_byte_unpack_unit(specular), olx_byte_unpack_unit(specular >> 8)});
  }
}

static void judge_texel(report *r, olx_vec3 plane, olx_block_place place, uint32_t i, olx_geometry_texel t) {
  const uint32_t x = OLX_BLOCK_SIDE * place.x + i % OLX_BLOCK_SIDE, y = OLX_BLOCK_SIDE * place.y + i / OLX_BLOCK_SIDE;
  const olx_vec3 d = olx_texel_direction(x, y, place.n);
  const double footprint = (double)t.distance * sqrt(olx_texel_solid_angle(x, y, place.n));
  const double length = sqrt((double)plane.x * plane.x + (double)plane.y * plane.y + (double)plane.z * plane.z);
  const double along = (double)plane.x * d.x + (double)plane.y * d.y + (double)plane.z * d.z;
  add_sample(&r->miss, fabs(along * t.distance - 1.0) / length / footprint);
  add_sample(&r->radial, fabs(1.0 / along - (double)t.distance) / footprint);
  const double cosine = (double)olx_dot(olx_plane_normal(plane), olx_normalize(t.normal));
  add_sample(&r->angle, acos(fmin(cosine, 1.0)) * 57.29577951);
}

static void count_form(report *r, const olx_geometry_code *code, uint32_t seen) {
  const uint32_t form = code->block.words[3] >> 30;
  r->forms[seen == 0 ? 3 : form == OLX_GEOMETRY_TWO && seen != 0xFFFFu ? 4 : form]++;
  r->pooled += code->pooled;
  if (form != OLX_GEOMETRY_POOL) return;
  uint32_t counts[TEXELS] = {0}, most = 0, second = 0;
  for (uint32_t i = 0; i < TEXELS; i++) counts[olx_geometry_pooled(&code->block, i)]++;
  for (uint32_t i = 0; i < TEXELS; i++) {
    if (counts[i] > most) second = most, most = counts[i];
    else if (counts[i] > second) second = counts[i];
  }
  r->odd += TEXELS - most - second;
}

static void judge_geometry(report *r, probe_blocks *b, const olx_geometry_settings *settings) {
  double begin = now();
  for (uint32_t i = 0; i < b->count; i++) {
    b->codes[i] = olx_geometry_encode(b->surfaces + TEXELS * i, b->places[i], settings);
  }
  r->encode_seconds += now() - begin;
  begin = now();
  for (uint32_t i = 0; i < b->count; i++) {
    const olx_plane_pool pool = {b->codes[i].planes, b->codes[i].pooled};
    for (uint32_t k = 0; k < TEXELS; k++) {
      b->decoded[TEXELS * i + k] = olx_geometry_plane(&b->codes[i].block, &pool, b->places[i], k);
    }
  }
  r->decode_seconds += now() - begin;
  for (uint32_t i = 0; i < b->count; i++) {
    count_form(r, &b->codes[i], b->seen[i]);
    for (uint32_t k = 0; k < TEXELS; k++) {
      const uint32_t at = TEXELS * i + k;
      const bool sky = !(b->seen[i] >> k & 1u);
      if (sky != (olx_dot(b->decoded[at], b->decoded[at]) == 0.0f)) exit(failure(NAME, "sky is not kept"));
      if (!sky) judge_texel(r, b->decoded[at], b->places[i], k, b->surfaces[at]);
    }
  }
}

static float brightest(const olx_vec3 light[TEXELS]) {
  float most = 0.0f;
  for (uint32_t i = 0; i < TEXELS; i++) most = olx_max(most, olx_max3(light[i]));
  return most;
}

static void judge_light(light_report *r, probe_blocks *b, const olx_vec3 *light, const float *brightness) {
  double begin = now();
  for (uint32_t i = 0; i < b->count; i++) {
    b->light[i] = olx_bc6h_encode(light + TEXELS * i, brightness ? brightness + TEXELS * i : NULL, b->seen[i]);
  }
  r->encode_seconds += now() - begin;
  begin = now();
  for (uint32_t i = 0; i < b->count * TEXELS; i++) {
    b->decoded[i] = olx_bc6h_texel(&b->light[i / TEXELS], i % TEXELS);
  }
  r->decode_seconds += now() - begin;
  for (uint32_t i = 0; i < b->count * TEXELS; i++) {
    if (!(b->seen[i / TEXELS] >> i % TEXELS & 1u)) continue;
    const olx_vec3 off = olx_sub(b->decoded[i], light[i]);
    const double error = (double)olx_dot(off, off);
    const float least = LEAST_BRIGHTNESS * brightest(light + i / TEXELS * TEXELS);
    const float own = olx_max(brightness ? brightness[i] : olx_max3(light[i]), olx_max(least, 1e-6f));
    r->error += error;
    r->square += (double)olx_dot(light[i], light[i]);
    r->relative += error / (3.0 * (double)own * (double)own);
    add_sample(&r->each, sqrt(error / 3.0) / (double)own);
  }
}

static bool is_seen(const probe_blocks *b, uint32_t texel) { return b->seen[texel / TEXELS] >> texel % TEXELS & 1u; }

static void judge_color(material_report *r, uint32_t found, uint32_t wanted) {
  const olx_vec3 color = olx_base_color_unpack(wanted), off = olx_sub(olx_base_color_unpack(found), color);
  r->error += (double)olx_dot(off, off);
  r->square += (double)olx_dot(color, color);
  add_sample(&r->color, sqrt((double)olx_dot(off, off) / 3.0) / fmax((double)olx_max3(color), 0.01));
}

static void judge_byte(material_report *r, uint32_t found, uint32_t wanted) {
  add_sample(&r->bytes, fabs((double)(found & 255u) - (double)wanted));
}

static void judge_bc1(material_report *r, const probe_blocks *b) {
  olx_bc1_block *blocks = allocate(b->count, sizeof *blocks);
  uint32_t *found = allocate(b->count * TEXELS, sizeof *found);
  double begin = now();
  for (uint32_t i = 0; i < b->count; i++) blocks[i] = olx_bc1_encode(b->base + TEXELS * i, b->seen[i]);
  r->encode_seconds += now() - begin;
  begin = now();
  for (uint32_t i = 0; i < b->count * TEXELS; i++) found[i] = olx_bc1_texel(&blocks[i / TEXELS], i % TEXELS);
  r->decode_seconds += now() - begin;
  for (uint32_t i = 0; i < b->count * TEXELS; i++) {
    if (is_seen(b, i)) judge_color(r, found[i], b->base[i]);
  }
  free(found);
  free(blocks);
}

static void judge_bc4(material_report *r, const probe_blocks *b, const uint8_t *bytes) {
  olx_bc4_block *blocks = allocate(b->count, sizeof *blocks);
  uint32_t *found = allocate(b->count * TEXELS, sizeof *found);
  double begin = now();
  for (uint32_t i = 0; i < b->count; i++) blocks[i] = olx_bc4_encode(bytes + TEXELS * i, b->seen[i]);
  r->encode_seconds += now() - begin;
  begin = now();
  for (uint32_t i = 0; i < b->count * TEXELS; i++) found[i] = olx_bc4_texel(&blocks[i / TEXELS], i % TEXELS);
  r->decode_seconds += now() - begin;
  for (uint32_t i = 0; i < b->count * TEXELS; i++) {
    if (is_seen(b, i)) judge_byte(r, found[i], bytes[i]);
  }
  free(found);
  free(blocks);
}

static void print_material(const char *name, material_report *r, const report *all) {
  printf("%s, %.0f ns a block to encode, %.1f ns a texel to decode\n", name,
         1e9 * r->encode_seconds / (double)all->blocks, 1e9 * r->decode_seconds / (double)all->texels);
  if (r->color.count) printf("  relative MSE of base colour %.2e\n", r->error / r->square);
  if (r->color.count) print_quantiles("relative error of base colour", &r->color);
  if (r->bytes.count) print_quantiles("error of a byte", &r->bytes);
}

static void print_light(const char *name, light_report *r, const report *all) {
  printf(
      "%s: 1 byte a texel, relative MSE %.2e, mean squared relative error of texels %.2e, %.0f ns a block to encode, "
      "%.1f ns a texel to decode\n",
      name, r->error / r->square, r->relative / (double)r->each.count, 1e9 * r->encode_seconds / (double)all->blocks,
      1e9 * r->decode_seconds / (double)all->texels);
  print_quantiles("relative error of a texel", &r->each);
}

static void print_geometry(report *r) {
  const double blocks = (double)r->blocks / 100.0;
  printf("geometry: %.3f bytes a texel, %.0f ns a block to encode, %.1f ns a texel to decode\n",
         1.0 + (double)(r->pooled * sizeof(olx_plane_code)) / (double)r->texels,
         1e9 * r->encode_seconds / (double)r->blocks, 1e9 * r->decode_seconds / (double)r->texels);
  printf("  %.2f %% of blocks one plane, %.2f %% two, %.2f %% one and sky, %.2f %% sky, %.2f %% in the pool with %.2f "
         "planes "
         "each; %.2f %% of texels on none of two planes\n",
         (double)r->forms[0] / blocks, (double)r->forms[1] / blocks, (double)r->forms[4] / blocks,
         (double)r->forms[3] / blocks, (double)r->forms[2] / blocks,
         (double)r->pooled / (double)(r->forms[2] ? r->forms[2] : 1), 100.0 * (double)r->odd / (double)r->texels);
  print_quantiles("footprints off the plane", &r->miss);
  print_quantiles("footprints along the ray", &r->radial);
  print_quantiles("degrees between normals", &r->angle);
}

// Replaces a probe's distances and normals by those of the decoded planes; marks and sky are unchanged.
static void replace_geometry(olx_field *field, uint32_t probe, const probe_blocks *b) {
  const size_t first = field->texels * probe;
  uint16_t *distance = (uint16_t *)(uintptr_t)field->distance + first,
           *normal = (uint16_t *)(uintptr_t)field->normal + first;
  for (uint32_t i = 0; i < b->count * TEXELS; i++) {
    if (!is_seen(b, i)) continue;
    const olx_block_place place = b->places[i / TEXELS];
    const olx_plane_pool pool = {b->codes[i / TEXELS].planes, b->codes[i / TEXELS].pooled};
    const olx_vec3 plane = olx_geometry_plane(&b->codes[i / TEXELS].block, &pool, place, i % TEXELS);
    const float metres = olx_plane_distance(plane, olx_normalize(olx_block_texel_point(place, i % TEXELS)));
    const size_t at = texel_index(field, place, i % TEXELS);
    distance[at] = (uint16_t)((distance[at] & 0x8000u) | olx_half_pack(metres / field->distance_scale));
    normal[at] = olx_normal_pack(olx_plane_normal(plane));
  }
  const int32_t n = (int32_t)field->n;
  for (int32_t y = -1; y <= n; y++) {
    for (int32_t x = -1; x <= n; x++) {
      int32_t source_x, source_y;
      olx_border_source(x, y, n, &source_x, &source_y);
      distance[olx_map_index(field->stride, x, y)] = distance[olx_map_index(field->stride, source_x, source_y)];
      normal[olx_map_index(field->stride, x, y)] = normal[olx_map_index(field->stride, source_x, source_y)];
    }
  }
  const olx_pyramid_base base = olx_pyramid_over_texels(distance + field->stride + 1, field->stride);
  olx_pyramid_make(&field->pyramid, &base,
                   (uint16_t *)(uintptr_t)field->least + (size_t)field->pyramid.least_nodes * probe,
                   (uint16_t *)(uintptr_t)field->greatest + (size_t)field->pyramid.greatest_nodes * probe);
}

static void print_rays(const char *when, const olx_scene *scene, const olx_field *field) {
  olx_audit_settings settings = olx_audit_settings_default();
  settings.points = 0;
  olx_audit audit;
  if (olx_audit_field(scene, field, &settings, NULL, &audit) != OLX_OK) exit(library_failure(NAME));
  printf("rays %s: of those whose hit is seen %.3f %% unresolved, %.3f %% wrong; of all %.3f %%, %.3f %%; distances "
         "off by "
         "%.2e in the median, %.2e at 99 %%\n",
         when, 100.0 * audit.rays.unresolved_seen, 100.0 * audit.rays.wrong_seen, 100.0 * audit.rays.unresolved,
         100.0 * audit.rays.wrong, audit.rays.distance_error_median, audit.rays.distance_error_p99);
}

// Reads a file into writable memory.
static void *read_file(const char *path, size_t *bytes) {
  FILE *file = fopen(path, "rb");
  if (!file || fseek(file, 0, SEEK_END) != 0) exit(failure(NAME, "cannot read %s", path));
  *bytes = (size_t)ftell(file);
  void *data = aligned_alloc(64, (*bytes + 63) / 64 * 64);
  rewind(file);
  if (!data || fread(data, 1, *bytes, file) != *bytes) exit(failure(NAME, "cannot read %s", path));
  fclose(file);
  return data;
}

static void judge_rays(const char *scene_path, olx_field *field, probe_blocks *b,
                       const olx_geometry_settings *settings) {
  olx_scene *scene = NULL;
  if (olx_scene_load(scene_path, &scene) != OLX_OK) exit(library_failure(NAME));
  print_rays("of the field", scene, field);
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) {
    for (uint32_t i = 0; i < b->count; i++) {
      read_block(field, probe, b, i);
      b->codes[i] = olx_geometry_encode(b->surfaces + TEXELS * i, b->places[i], settings);
    }
    replace_geometry(field, probe, b);
  }
  print_rays("of decoded planes", scene, field);
  olx_scene_free(scene);
}

int study_block_quality(int argc, char **argv) {
  olx_field *field;
  size_t bytes;
  void *data = read_file(argv[1], &bytes);
  if (olx_field_open_memory(data, bytes, &field) != OLX_OK) {
    free(data);
    return library_failure(NAME);
  }
  if (field->info.maps.compressed) {
    olx_field_close(field);
    free(data);
    return failure(NAME, "%s: has blocks already; bake it with --uncompressed", argv[1]);
  }
  olx_geometry_settings settings = olx_geometry_settings_default();
  if (argc > 2) settings.tolerance = (float)atof(argv[2]);
  if (argc > 3) settings.least_cosine = (float)atof(argv[3]);
  probe_blocks b = make_blocks(field->n);
  report r = {.blocks = 0};
  for (uint32_t probe = 0; probe < field->info.probes.count; probe++) {
    for (uint32_t i = 0; i < b.count; i++) read_block(field, probe, &b, i);
    r.blocks += b.count;
    r.texels += b.count * TEXELS;
    judge_geometry(&r, &b, &settings);
    judge_light(&r.direct, &b, b.direct, b.brightness);
    judge_light(&r.indirect, &b, b.indirect, NULL);
    judge_bc1(&r.bc1, &b);
    judge_bc4(&r.bc4_roughness, &b, b.roughness);
    judge_bc4(&r.bc4_reflectance, &b, b.reflectance);
  }
  printf("%u probes of %u x %u texels\n", field->info.probes.count, field->n, field->n);
  print_geometry(&r);
  print_light("direct", &r.direct, &r);
  print_light("indirect", &r.indirect, &r);
  print_material("base colour in BC1: 0.5 bytes a texel", &r.bc1, &r);
  print_material("roughness in BC4: 0.5 bytes a texel", &r.bc4_roughness, &r);
  print_material("reflectance in BC4: 0.5 bytes a texel", &r.bc4_reflectance, &r);
  if (argc > 4) judge_rays(argv[4], field, &b, &settings);
  olx_field_close(field);
  free(data);
  return 0;
}
