// Hostile scene files: fuzz_scene COUNT [SEED [PART]] loads COUNT mutated descriptions, OBJ, MTL, glTF, GLB and image files, or
// those alone whose names contain PART, such as ".gl". Each must become a scene whose numbers are in order, or be refused with a
// message, within seconds and without memory out of proportion. Files are made from (seed, round) alone, so a failure can
// be had again; rounds run in a child, so that a crash inside Assimp is counted and the run goes on. Crashes, hangs and leaks of our
// own code fail it.
#include "core/hooks.h"
#include "core/sampling.h"
#include "counted_memory.h"
#include "gltf_maker.h"
#include "processor_alarm.h"
#include "scene/bvh.h"
#include "scene/surface.h"
#include "scene_files.h"

#include <execinfo.h>
#include <fcntl.h>
#include <meshoptimizer.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define BATCH 50u
#define SECONDS_A_FILE 5u
// Images of some 100 bytes may have 16384 texels a byte, an environment twelve bytes a texel and as much again to sample it.
#define MOST_BYTES_A_FILE ((size_t)64 << 20)
#define MAX_FILE_BYTES 65536u
typedef struct shared_state {
  atomic_uint round, loaded, refused;
  atomic_size_t most_bytes; // that one file asked for
  char part[32];            // of the names of the files that are mutated
} shared_state;

// ---- the files that mutations start from

typedef struct seed_file {
  const char *name, *opened; // the file that is mutated and the one that is loaded
  uint8_t *bytes;
  size_t size_bytes;
} seed_file;

enum { SEED_COUNT = 11 };

static const char description_text[] =
    "{\"model\": \"square.obj\", \"scale\": 1.5, \"models\": [{\"path\": \"square.gltf\", \"scale\": 2, \"translate\": "
    "[0, 0, 1], \"rotate_degrees\": [10, 20, 30]}],\n\"cameras\": [{\"name\": \"a\", \"eye\": [0, 0, 5], \"target\": "
    "[0, 1, "
    "0], \"up\": [0, 1, 0], \"fov_y_degrees\": 60}],\n\"lights\": [{\"type\": \"sun\", \"direction\": [0, -1, 0.2], "
    "\"irradiance\": [10, 9, 8]}, {\"type\": \"rect\", \"center\": [0, 2, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [0, "
    "0, 1], "
    "\"radiance\": [17, 12, 4]}, {\"type\": \"point\", \"position\": [0, 2, 0], \"intensity\": [5, 5, 5]}, {\"type\": "
    "\"spot\", \"position\": [0, 2, 0], \"direction\": [0, -1, 0], \"intensity\": [9, 9, 9], \"cone_degrees\": [20, "
    "30]}],\n"
    "\"environment\": {\"image\": \"sky.hdr\", \"rotation_degrees\": 30, \"gain\": 2},\n\"materials\": {\"square\": "
    "{\"base_color\": [0.7, 0.7, 0.7], \"roughness\": 0.2, \"metallic\": 0.5, \"emission\": [0, 1, 0]}, \"*\": "
    "{\"specular\": "
    "0.5}},\n\"probes\": {\"min\": [-1, -1, -1], \"max\": [1, 1, 1], \"grid\": [4, 4, 4]}}";

static const char obj_text[] =
    "mtllib square.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 2\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "vn 0 0 1\nvn 0 1 0\ng quad\nusemtl square\ns 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\nusemtl other\nf -1 -2 -3\nf 1//2 2//2 "
    "5//2\n"
    "f 1/1 2/2 5/3\nf 1 2 3 4 5\nl 1 2\n";

static const char mtl_text[] =
    "newmtl square\nNs 100.5\nKa 0 0 0\nKd 0.5 0.25 0.125\nKs 0.1 0.1 0.1\nKe 1 2 3\nNi 1.5\nd 0.9\nillum 2\n"
    "map_Kd four.tga\nmap_d four.tga\nmap_bump -bm 0.5 four.tga\n\nnewmtl other\nKd 1 1 1\nTr 0.1\nPr 0.3\nPm 0.7\n";

static const char gltf_materials[] =
    "[{\"name\": \"square\", \"doubleSided\": true, \"alphaMode\": \"MASK\", \"alphaCutoff\": 0.25, "
    "\"pbrMetallicRoughness\": "
    "{\"baseColorFactor\": [0.1, 0.2, 0.3, 0.9], \"metallicFactor\": 0.25, \"roughnessFactor\": 0.5, "
    "\"baseColorTexture\": "
    "{\"index\": 0}, \"metallicRoughnessTexture\": {\"index\": 0}}, \"normalTexture\": {\"index\": 0, \"scale\": 0.5}, "
    "\"emissiveFactor\": [1, 0.5, 0], \"extensions\": {\"KHR_materials_emissive_strength\": {\"emissiveStrength\": "
    "40}, "
    "\"KHR_materials_specular\": {\"specularFactor\": 0.25}}}, {\"name\": \"spare\", \"alphaMode\": \"BLEND\"}]";

static const char gltf_nodes[] = "[{\"children\": [1, 2, 3], \"translation\": [1, 0, 0]}, {\"mesh\": 0, \"rotation\": "
                                 "[0, 0.7071, 0, 0.7071], \"scale\": "
                                 "[1, 2, 3]}, {\"name\": \"eye\", \"camera\": 0, \"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, "
                                 "0, 0, 1, 0, 4, 5, 6, 1]}, {\"mesh\": 0, "
                                 "\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}]";

static const char gltf_more[] =
    ",\n\"textures\": [{\"source\": 0, \"sampler\": 0}], \"samplers\": [{\"wrapS\": 10497}], \"images\": [{\"uri\": "
    "\"four.tga\"}],\n\"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": 1, \"znear\": 0.1}}],\n"
    "\"extensionsUsed\": [\"KHR_lights_punctual\"], \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": "
    "\"spot\", \"color\": [1, 1, 0.5], \"intensity\": 7, \"spot\": {\"innerConeAngle\": 0.1, \"outerConeAngle\": "
    "0.5}}]}}";

static size_t make_hdr(uint8_t *bytes) {
  const char header[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n";
  const size_t length = sizeof header - 1;
  memcpy(bytes, header, length);
  for (uint32_t i = 0; i < 64; ++i) bytes[length + i] = (uint8_t)(i % 4 == 3 ? 130 : i * 4);
  return length + 64;
}

static seed_file text_seed(const char *name, const char *opened, const char *text) {
  return (seed_file){.name = name, .opened = opened, .bytes = (uint8_t *)strdup(text), .size_bytes = strlen(text)};
}

static const float square_positions[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

// Quantised, sparse and interleaved vertices with everything that a vertex can have, strips and fans.
static void make_rich(gltf_maker *m) {
  const int16_t corners[16] = {0, 0, 0, 0, 1000, 0, 0, 0, 1000, 1000, 0, 0, 0, 1000, 0, 0};
  const int8_t normals[16] = {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0};
  const uint16_t uvs[8] = {0, 65535, 65535, 65535, 65535, 0, 0, 0}, moved = 2;
  const uint8_t colors[16] = {255, 0, 0, 255, 255, 255, 0, 255, 0, 255, 0, 128, 0, 0, 255, 255},
                strip[4] = {0, 1, 3, 2};
  const float tangents[16] = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1}, corner[3] = {2, 2, 1};
  gltf_add_view(m, corners, sizeof corners, ", \"byteStride\": 8");
  gltf_add_view(m, normals, sizeof normals, ", \"byteStride\": 4");
  gltf_add_accessor(m, "\"bufferView\": 0, ", 4, GLTF_INT16, "VEC3");
  gltf_add_accessor(m, "\"bufferView\": 1, \"normalized\": true, ", 4, GLTF_INT8, "VEC3");
  gltf_add(m, uvs, sizeof uvs, 4, GLTF_UINT16, "VEC2", true);
  gltf_add(m, colors, sizeof colors, 4, GLTF_UINT8, "VEC4", true);
  gltf_add(m, tangents, sizeof tangents, 4, GLTF_FLOAT, "VEC4", false);
  gltf_add(m, strip, sizeof strip, 4, GLTF_UINT8, "SCALAR", false);
  gltf_add(m, square_positions, sizeof square_positions, 4, GLTF_FLOAT, "VEC3", false);
  gltf_add_view(m, &moved, sizeof moved, "");
  gltf_add_view(m, corner, sizeof corner, "");
  gltf_add_accessor(m,
                    "\"bufferView\": 6, \"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 7, "
                    "\"componentType\": 5123}, \"values\": {\"bufferView\": 8}}, ",
                    4, GLTF_FLOAT, "VEC3");
}

static const char rich_primitives[] =
    "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2, \"TEXCOORD_1\": 2, \"COLOR_0\": 3, "
    "\"TANGENT\": 4}, \"indices\": 5, \"mode\": 5, \"material\": 0}, {\"attributes\": {\"POSITION\": 7}, \"mode\": 6}";
static const char rich_nodes[] = "[{\"children\": [1], \"scale\": [0.001, 0.001, 0.001]}, {\"mesh\": 0, \"skin\": 0}]";
static const char rich_more[] =
    ", \"scene\": 0, \"materials\": [{\"alphaMode\": \"MASK\", \"pbrMetallicRoughness\": {\"baseColorTexture\": "
    "{\"index\": "
    "0}}, \"normalTexture\": {\"index\": 0, \"texCoord\": 1, \"extensions\": {\"KHR_texture_transform\": {\"offset\": "
    "[0.5, "
    "0], \"rotation\": 1, \"scale\": [2, 3], \"texCoord\": 1}}}, \"emissiveTexture\": {\"index\": 0}, "
    "\"emissiveFactor\": [1, "
    "1, 1]}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": "
    "\"data:image/png;base64,AAACAAAAAAAAAAAAAgACACAoAAD//wD/AP//AAD/////AA==\"}], \"extensionsUsed\": "
    "[\"KHR_mesh_quantization\", \"KHR_texture_transform\"]";

static void make_packed(gltf_maker *m) {
  const char *name = "EXT_meshopt_compression";
  const float up[16] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  float positions[12];
  int8_t normals[16];
  meshopt_encodeFilterExp(positions, 4, 12, 15, square_positions);
  meshopt_encodeFilterOct(normals, 4, 4, 8, up);
  gltf_add_vertices(m, name, positions, 12, ", \"filter\": \"EXPONENTIAL\"", "", GLTF_FLOAT);
  gltf_add_vertices(m, name, normals, 4, ", \"filter\": \"OCTAHEDRAL\"", "\"normalized\": true, ", GLTF_INT8);
  gltf_add_indices(m, name, true);
  gltf_add_indices(m, name, false);
}

static const char packed_primitives[] = "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1}, \"indices\": 2}, "
                                        "{\"attributes\": {\"POSITION\": 0}, \"indices\": 3}";

// Two seeds of a made file: as text and as .glb.
static void make_gltf_seeds(const gltf_maker *m, const char *primitives, const char *nodes, const char *more,
                            const char *const names[2], seed_file seeds[2]) {
  char *text = gltf_maker_text(m, primitives, nodes, more, true);
  seeds[0] = (seed_file){.name = names[0], .opened = names[0]};
  seeds[0].bytes = (uint8_t *)gltf_maker_text(m, primitives, nodes, more, false);
  seeds[0].size_bytes = strlen((char *)seeds[0].bytes);
  seeds[1] = (seed_file){.name = names[1], .opened = names[1]};
  seeds[1].size_bytes = gltf_make_glb(text, strlen(text), m->bytes, m->size_bytes, &seeds[1].bytes);
  free(text);
}

static void make_seeds(seed_file seeds[SEED_COUNT]) {
  seeds[0] = text_seed("scene.json", "scene.json", description_text);
  seeds[1] = text_seed("square.obj", "square.obj", obj_text);
  seeds[2] = text_seed("square.mtl", "square.obj", mtl_text);
  seeds[3] = (seed_file){.name = "square.gltf", .opened = "square.gltf"};
  seeds[3].bytes = (uint8_t *)scene_files_gltf(gltf_materials, 0, gltf_nodes, gltf_more, false);
  seeds[3].size_bytes = strlen((char *)seeds[3].bytes);
  seeds[4] = (seed_file){.name = "square.glb", .opened = "square.glb"};
  seeds[4].size_bytes = scene_files_glb(gltf_materials, 0, gltf_nodes, gltf_more, &seeds[4].bytes);
  seeds[5] = (seed_file){.name = "four.tga", .opened = "square.obj", .bytes = malloc(34)};
  seeds[5].size_bytes = scene_files_tga(seeds[5].bytes);
  seeds[6] = (seed_file){.name = "sky.hdr", .opened = "scene.json", .bytes = malloc(256)};
  seeds[6].size_bytes = make_hdr(seeds[6].bytes);
  gltf_maker rich = {0}, packed = {0};
  make_rich(&rich);
  make_gltf_seeds(&rich, rich_primitives, rich_nodes, rich_more, (const char *const[]){"rich.gltf", "rich.glb"},
                  seeds + 7);
  make_packed(&packed);
  make_gltf_seeds(&packed, packed_primitives, "[{\"mesh\": 0}]", "", (const char *const[]){"packed.gltf", "packed.glb"},
                  seeds + 9);
}

// ---- mutations

typedef struct random_stream {
  uint32_t seed, round, drawn;
} random_stream;

static uint32_t draw(random_stream *r, uint32_t below) {
  const uint32_t bits = olx_hash3(r->seed, r->round, r->drawn++);
  return below ? (uint32_t)(((uint64_t)bits * below) >> 32) : 0;
}

typedef struct mutant {
  uint8_t bytes[MAX_FILE_BYTES];
  size_t size_bytes;
} mutant;

// Replace `removed` bytes at `at` by others.
static void splice_bytes(mutant *m, size_t at, size_t removed, const void *bytes, size_t size_bytes) {
  uint8_t inserted[MAX_FILE_BYTES / 4];
  if (size_bytes > sizeof inserted || m->size_bytes - removed + size_bytes > sizeof m->bytes) return;
  memcpy(inserted, bytes, size_bytes); // it may come from the mutant itself
  memmove(m->bytes + at + size_bytes, m->bytes + at + removed, m->size_bytes - at - removed);
  memcpy(m->bytes + at, inserted, size_bytes);
  m->size_bytes += size_bytes - removed;
}

static bool in_number(uint8_t byte) { return (byte >= '0' && byte <= '9') || byte == '.' || byte == '-'; }

static void replace_number(mutant *m, random_stream *r) {
  static const char *const numbers[] = {
      "NaN",        "1e38",  "-1",   "4294967295", "0",    "1e-45", "1e999", "inf",
      "2147483648", "-1e38", "7",    "65535",      "1e20", "-0",    "1.5",   "99999999999999999999",
      "null",       "0x7f",  "2",    "3",          "4",    "8",     "5120",  "5121",
      "5122",       "5123",  "5125", "5126"};
  size_t at = draw(r, (uint32_t)m->size_bytes);
  for (size_t tried = 0; tried < m->size_bytes && !in_number(m->bytes[at]); ++tried) at = (at + 1) % m->size_bytes;
  if (!in_number(m->bytes[at])) return;
  size_t end = at;
  while (at > 0 && in_number(m->bytes[at - 1])) --at;
  while (end < m->size_bytes && in_number(m->bytes[end])) ++end;
  const char *number = numbers[draw(r, sizeof numbers / sizeof *numbers)];
  splice_bytes(m, at, end - at, number, strlen(number));
}

static void insert_token(mutant *m, random_stream *r) {
  static const char *const tokens[] = {"{",    "}",         "[",        "]",     "\"",        ",",
                                       ":",    "\n",        "\\",       "\xff",  "f 1 2 3\n", "f 9/9/9 1 -9\n",
                                       "/",    "usemtl \n", "mtllib\n", "v 1\n", "-",         "%",
                                       "null", "\\u0000",   "map_Kd\n", "f\n"};
  const char *token = tokens[draw(r, sizeof tokens / sizeof *tokens)];
  splice_bytes(m, draw(r, (uint32_t)m->size_bytes + 1), 0, token, strlen(token));
}

// Another word of glTF in place of one: "VEC3" or "mode".
static void replace_word(mutant *m, random_stream *r) {
  static const char *const words[] = {"SCALAR",     "VEC2",     "VEC3",       "VEC4",       "MAT4",        "ATTRIBUTES",
                                      "TRIANGLES",  "INDICES",  "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "NONE",
                                      "POSITION",   "NORMAL",   "TANGENT",    "TEXCOORD_0", "TEXCOORD_1",  "COLOR_0",
                                      "indices",    "count",    "byteStride", "byteOffset", "byteLength",  "buffer",
                                      "bufferView", "children", "mesh",       "source"};
  size_t at = draw(r, (uint32_t)m->size_bytes);
  while (at < m->size_bytes && m->bytes[at] != '"') ++at;
  size_t end = at + 1;
  while (end < m->size_bytes && m->bytes[end] != '"') ++end;
  const char *word = words[draw(r, sizeof words / sizeof *words)];
  if (end < m->size_bytes && end - at < 32) splice_bytes(m, at + 1, end - at - 1, word, strlen(word));
}

static void mutate_once(mutant *m, random_stream *r) {
  if (m->size_bytes == 0) return;
  const uint32_t size = (uint32_t)m->size_bytes, at = draw(r, size);
  const uint32_t length = 1 + draw(r, size - at < 200 ? size - at : 200);
  const uint32_t kind = draw(r, 16);
  if (kind == 0) m->size_bytes = at;
  else if (kind <= 3) m->bytes[at] ^= (uint8_t)(1u << draw(r, 8));
  else if (kind == 4) m->bytes[at] = (uint8_t)draw(r, 256);
  else if (kind == 5) splice_bytes(m, at, length > size - at ? size - at : length, "", 0);
  else if (kind == 6) splice_bytes(m, draw(r, size), 0, m->bytes + at, length > size - at ? size - at : length);
  else if (kind == 7) insert_token(m, r);
  else if (kind <= 9) replace_word(m, r);
  else replace_number(m, r);
}

static void set_mutant(mutant *m, const uint8_t *bytes, size_t size_bytes) {
  m->size_bytes = size_bytes < sizeof m->bytes ? size_bytes : sizeof m->bytes;
  memcpy(m->bytes, bytes, m->size_bytes);
}

static void mutate(mutant *m, random_stream *r) {
  for (uint32_t count = 1 + draw(r, 3); count > 0; --count) mutate_once(m, r);
}

// Only one of the two parts of a .glb, inside a frame that is right.
static void mutate_part(const seed_file *from, mutant *m, random_stream *r) {
  uint32_t text_bytes;
  uint8_t *made;
  memcpy(&text_bytes, from->bytes + 12, sizeof text_bytes);
  const uint8_t *text = from->bytes + 20, *bytes = text + text_bytes + 8;
  const size_t size_bytes = from->size_bytes - 28 - text_bytes;
  const bool json = draw(r, 2) == 0;
  set_mutant(m, json ? text : bytes, json ? text_bytes : size_bytes);
  mutate(m, r);
  const size_t total = json ? gltf_make_glb((const char *)m->bytes, m->size_bytes, bytes, size_bytes, &made)
                            : gltf_make_glb((const char *)text, text_bytes, m->bytes, m->size_bytes, &made);
  set_mutant(m, made, total);
  free(made);
}

static const seed_file *make_mutant(const seed_file seeds[SEED_COUNT], const char *part, uint32_t seed, uint32_t round,
                                    mutant *m) {
  random_stream r = {.seed = seed, .round = round};
  const seed_file *from;
  do from = &seeds[draw(&r, SEED_COUNT)];
  while (!strstr(from->name, part));
  if (strstr(from->name, ".glb") && draw(&r, 4)) {
    mutate_part(from, m, &r);
  } else {
    set_mutant(m, from->bytes, from->size_bytes);
    mutate(m, &r);
  }
  return from;
}

// ---- one round, in the child

static void demand(bool holds, const char *what) {
  if (holds) return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

static bool texture_fits(const olx_scene *scene, uint32_t texture) {
  return texture == OLX_NO_TEXTURE || texture < scene->texture_count;
}

static void check_materials(const olx_scene *scene) {
  for (uint32_t i = 0; i < scene->material_count; ++i) {
    const olx_material *m = &scene->materials[i];
    demand(m->metallic >= 0.0f && m->metallic <= 1.0f && m->roughness >= 0.0f && m->roughness <= 1.0f,
           "material factors");
    demand(m->specular_weight >= 0.0f && m->specular_weight <= 1.0f, "specular weight");
    demand(olx_finite(m->base_color) && olx_max3(m->base_color) <= 1.0f, "base colour");
    demand(olx_finite(m->emission) && m->emission.x >= 0.0f && m->emission.y >= 0.0f && m->emission.z >= 0.0f,
           "emission");
    demand(texture_fits(scene, m->base_color_texture) && texture_fits(scene, m->alpha_texture) &&
               texture_fits(scene, m->metallic_roughness_texture) && texture_fits(scene, m->emission_texture) &&
               texture_fits(scene, m->normal_texture),
           "texture indices");
  }
}

static void check_geometry(const olx_scene *scene) {
  demand(scene->triangle_count > 0, "triangles");
  demand(olx_finite(scene->bounds_min) && olx_finite(scene->bounds_max), "bounds");
  for (uint32_t t = 0; t < scene->triangle_count; ++t) {
    demand(scene->material_index[t] < scene->material_count, "material index");
    const uint32_t *i = scene->indices + (size_t)t * 3;
    for (uint32_t k = 0; k < 3; ++k) {
      demand(i[k] < scene->vertex_count, "vertex index");
      demand(olx_finite(scene->positions[i[k]]), "position");
      demand(fabsf(olx_length(scene->normals[i[k]]) - 1.0f) < 1e-2f, "normal");
      demand(isfinite(scene->uvs[i[k]].x) && isfinite(scene->uvs[i[k]].y), "uv");
    }
  }
}

static void cast_some_rays(const olx_scene *scene) {
  const olx_vec3 center = olx_scale(olx_add(scene->bounds_min, scene->bounds_max), 0.5f);
  for (uint32_t i = 0; i < 32; ++i) {
    const olx_ray ray = {
        .origin = center, .direction = olx_sample_sphere(olx_hammersley(i, 32)), .t_min = 0.0f, .t_max = INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    demand(hit.triangle < scene->triangle_count, "hit");
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    demand(olx_finite(surface.bsdf.albedo) && olx_max3(surface.bsdf.albedo) <= 0.95f, "albedo of a surface");
  }
}

static void load_one(const scene_folder *folder, const seed_file seeds[SEED_COUNT], uint32_t seed, uint32_t round,
                     shared_state *shared) {
  static mutant m;
  char path[600];
  const seed_file *from = make_mutant(seeds, shared->part, seed, round, &m);
  scene_folder_write(folder, from->name, m.bytes, m.size_bytes);
  counted_memory_asked();
  snprintf(path, sizeof path, "%s/%s", folder->path, from->opened);
  olx_scene *scene = NULL;
  const olx_result result = olx_scene_load(path, &scene);
  if (result == OLX_OK) {
    check_geometry(scene);
    check_materials(scene);
    cast_some_rays(scene);
    atomic_fetch_add(&shared->loaded, 1);
  } else {
    demand(scene == NULL && olx_last_error()[0], "a refusal without a message");
    atomic_fetch_add(&shared->refused, 1);
  }
  olx_scene_free(scene);
  demand(counted_memory_held() == 0, "memory that was not released");
  const size_t asked = counted_memory_asked();
  if (asked > atomic_load(&shared->most_bytes)) atomic_store(&shared->most_bytes, asked);
  demand(asked <= MOST_BYTES_A_FILE, "memory out of proportion");
  scene_folder_write(folder, from->name, from->bytes, from->size_bytes);
}

static void name_stack(int signal_number) {
  void *frames[64];
  const char *what = signal_number == PROCESSOR_ALARM ? "hang\n" : "crash\n";
  (void)!write(STDERR_FILENO, what, strlen(what));
  const int depth = backtrace(frames, 64); // the first is this function
  if (depth > 1) backtrace_symbols_fd(frames + 1, depth - 1, STDERR_FILENO);
  _exit(signal_number == PROCESSOR_ALARM ? 3 : 2);
}

static void run_child(const scene_folder *folder, const char *trace_path, const seed_file seeds[SEED_COUNT],
                      uint32_t seed, uint32_t first, uint32_t end, shared_state *shared) {
  const int trace = open(trace_path, O_CREAT | O_TRUNC | O_WRONLY, 0600);
  if (trace < 0 || dup2(trace, STDERR_FILENO) < 0) _exit(1);
  const int signals[] = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, PROCESSOR_ALARM};
  void *warm_up[1];
  backtrace(warm_up, 1); // loads what it needs while memory is in order
  for (size_t i = 0; i < sizeof signals / sizeof *signals; ++i) signal(signals[i], name_stack);
  counted_memory_begin();
  for (uint32_t round = first; round < end; ++round) {
    atomic_store(&shared->round, round);
    set_processor_alarm(SECONDS_A_FILE);
    load_one(folder, seeds, seed, round, shared);
  }
  _exit(0);
}

// ---- the parent

typedef enum blame { BLAME_ASSIMP, BLAME_US } blame;

// The innermost frame that belongs neither to the C and C++ libraries nor to a sanitizer.
static blame find_blame(const char *trace_path, char *frame, size_t frame_bytes) {
  static const char *const passed_over[] = {"libc.so",   "libstdc++",   "libgcc", "libasan",      "libpthread",
                                            "sanitizer", "interceptor", "__asan", "operator new", "[vdso]"};
  FILE *file = fopen(trace_path, "r");
  char line[2048];
  snprintf(frame, frame_bytes, "no stack");
  while (file && fgets(line, sizeof line, file)) {
    line[strcspn(line, "\n")] = 0;
    bool passed = !strstr(line, "0x");
    for (size_t i = 0; i < sizeof passed_over / sizeof *passed_over; ++i)
      passed |= strstr(line, passed_over[i]) != NULL;
    // Sanitizers print addresses in prose before the numbered frames.
    if (passed || (line[0] == '=' && line[1] == '=') || strncmp(line, "READ", 4) == 0 ||
        strncmp(line, "WRITE", 5) == 0) {
      continue;
    }
    snprintf(frame, frame_bytes, "%.300s", line);
    break;
  }
  if (file) fclose(file);
  return strstr(frame, "libassimp") ? BLAME_ASSIMP : BLAME_US;
}

static void keep_failure(const scene_folder *kept, const char *trace_path, const seed_file *from, const mutant *m,
                         uint32_t round) {
  char name[96], command[1400];
  snprintf(name, sizeof name, "%u-%s", round, from->name);
  scene_folder_write(kept, name, m->bytes, m->size_bytes);
  snprintf(command, sizeof command, "cp '%s' '%s/%u-stack.txt'", trace_path, kept->path, round);
  (void)!system(command);
}

typedef struct tally {
  uint32_t ours, assimp_crashes, assimp_hangs;
} tally;

static void record_failure(const scene_folder *kept, const char *trace_path, const seed_file seeds[SEED_COUNT],
                           const char *part, uint32_t seed, uint32_t round, int status, tally *counts) {
  static mutant m;
  char frame[400];
  const seed_file *from = make_mutant(seeds, part, seed, round, &m);
  const bool hang = WIFEXITED(status) && WEXITSTATUS(status) == 3;
  const blame guilty = find_blame(trace_path, frame, sizeof frame);
  keep_failure(kept, trace_path, from, &m, round);
  printf("round %u: %s: %s in %s: %s\n", round, from->name, hang ? "hang" : "crash",
         guilty == BLAME_ASSIMP ? "Assimp" : "our code", frame);
  if (guilty == BLAME_US) ++counts->ours;
  else if (hang) ++counts->assimp_hangs;
  else ++counts->assimp_crashes;
}

static void run_all(uint32_t count, uint32_t seed, shared_state *shared, const scene_folder *kept, tally *counts) {
  static seed_file seeds[SEED_COUNT];
  scene_folder folder;
  char trace_path[400];
  if (!scene_folder_create(&folder)) exit(1);
  make_seeds(seeds);
  for (uint32_t i = 0; i < SEED_COUNT; ++i) {
    scene_folder_write(&folder, seeds[i].name, seeds[i].bytes, seeds[i].size_bytes);
  }
  snprintf(trace_path, sizeof trace_path, "%s/trace.txt", folder.path);
  for (uint32_t next = 0; next < count;) {
    const uint32_t end = count - next < BATCH ? count : next + BATCH;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) run_child(&folder, trace_path, seeds, seed, next, end, shared);
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) exit(1);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
      next = end;
      continue;
    }
    const uint32_t round = atomic_load(&shared->round);
    record_failure(kept, trace_path, seeds, shared->part, seed, round, status, counts);
    next = round + 1;
    for (uint32_t i = 0; i < SEED_COUNT; ++i) {
      scene_folder_write(&folder, seeds[i].name, seeds[i].bytes, seeds[i].size_bytes);
    }
  }
  for (uint32_t i = 0; i < SEED_COUNT; ++i) free(seeds[i].bytes);
  scene_folder_remove(&folder);
}

int main(int argc, char **argv) {
  const uint32_t count = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 200;
  const uint32_t seed = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
  shared_state *shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  scene_folder kept;
  tally counts = {0};
  if (shared == MAP_FAILED || !scene_folder_create(&kept)) return 1;
  snprintf(shared->part, sizeof shared->part, "%s", argc > 3 ? argv[3] : "");
  run_all(count, seed, shared, &kept, &counts);
  const uint32_t failures = counts.ours + counts.assimp_crashes + counts.assimp_hangs;
  if (failures) printf("the files are kept in %s\n", kept.path);
  else scene_folder_remove(&kept);
  printf("fuzz_scene: %u files, seed %u: %u loaded, %u refused, %u crashes and %u hangs inside Assimp, %u failures of "
         "our own; %.1f MiB asked for at most\n",
         count, seed, atomic_load(&shared->loaded), atomic_load(&shared->refused), counts.assimp_crashes,
         counts.assimp_hangs, counts.ours, (double)atomic_load(&shared->most_bytes) / 1048576.0);
  return counts.ours ? 1 : 0;
}
