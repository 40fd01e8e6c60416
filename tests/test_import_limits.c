// Tests that imports need no more than in proportion to their input: what a small file describes is counted before
// memory is allocated for it, refused with a message that says how to raise the limit, and loaded once the limit is
// raised. A model reads no files outside its folder.
#include "core/file.h"
#include "core/hooks.h"
#include "gltf_maker.h"
#include "scene/images/texture_file.h"
#include "scene/scene_data.h"
#include "scene_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

// A text that grows as it is printed to.
typedef struct text {
  char *data;
  size_t size;
  FILE *stream;
} text;

static void text_begin(text *t) {
  *t = (text){0};
  t->stream = open_memstream(&t->data, &t->size);
  assert_non_null(t->stream);
}

static const char *text_write(text *t, const scene_folder *folder, const char *name) {
  fclose(t->stream);
  const char *path = scene_folder_write(folder, name, t->data, t->size);
  free(t->data);
  return path;
}

static olx_scene *load_with(const char *path, const olx_scene_load_settings *settings) {
  olx_scene *scene = NULL;
  if (olx_scene_load_with(path, settings, &scene) != OLX_OK) fail_msg("%s", olx_last_error());
  return scene;
}

// Checks that a file is refused by the default limits, with all of `parts` in the message; returns the scene loaded
// with the limits `enough`.
static olx_scene *refused_then_loaded(const char *path, const char *const *parts, olx_scene_limits enough) {
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load(path, &scene), OLX_ERROR_UNSUPPORTED);
  assert_null(scene);
  for (; *parts; parts++) {
    if (!strstr(olx_last_error(), *parts)) fail_msg("\"%s\" does not say \"%s\"", olx_last_error(), *parts);
  }
  return load_with(path, &(olx_scene_load_settings){.limits = enough});
}

static const char *write_polygon(const scene_folder *folder, unsigned corners, bool continued) {
  text t;
  text_begin(&t);
  for (unsigned i = 0; i < corners; i++) {
    const double angle = 6.283185307179586 * i / corners;
    fprintf(t.stream, "v %.9g 0 %.9g\n", 100.0 * cos(angle), 100.0 * sin(angle));
  }
  fputs("f", t.stream);
  for (unsigned i = 0; i < corners; i++) fprintf(t.stream, continued ? " \\\n%u" : " %u", i + 1);
  fputs("\n", t.stream);
  return text_write(&t, folder, "polygon.obj");
}

static void test_polygons(void **state) {
  const char *const parts[] = {"polygon.obj: line 2101: ", "2100 corners", "limit of 2048",
                               "--import-limits polygon_corners=2100", NULL};
  olx_scene *scene =
      refused_then_loaded(write_polygon(*state, 2100, false), parts, (olx_scene_limits){.polygon_corners = 2100});
  assert_int_equal(scene->triangle_count, 2098);
  olx_scene_free(scene);
  olx_scene_free(load_with(write_polygon(*state, 2048, false), NULL));
  // Assimp joins lines at a backslash, so a polygon that continues over many lines is refused, too.
  assert_int_equal(olx_scene_load(write_polygon(*state, 2100, true), &scene), OLX_ERROR_UNSUPPORTED);
}

static void test_materials_of_obj(void **state) {
  text library, model;
  text_begin(&library);
  text_begin(&model);
  fputs("mtllib many.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\n", model.stream);
  for (unsigned i = 0; i < 8193; i++) {
    fprintf(library.stream, "newmtl m%u\nKd 0.5 0.5 0.5\n", i);
    fprintf(model.stream, "usemtl m%u\nf 1 2 3\n", i);
  }
  text_write(&library, *state, "many.mtl");
  const char *const parts[] = {"many.obj: line 16389", "8193 materials", "limit of 8192", "materials=8193", NULL};
  olx_scene *scene =
      refused_then_loaded(text_write(&model, *state, "many.obj"), parts, (olx_scene_limits){.materials = 9000});
  assert_int_equal(scene->material_count, 8193);
  olx_scene_free(scene);
}

// A library of materials that no face uses counts as well.
static void test_material_library(void **state) {
  text library;
  text_begin(&library);
  for (unsigned i = 0; i < 8193; i++) fprintf(library.stream, "newmtl m%u\n", i);
  text_write(&library, *state, "square.mtl");
  const char *path = scene_folder_write_text(*state, "square.obj", scene_files_obj);
  const char *const parts[] = {"square.mtl: newmtl", "8193 materials", NULL};
  olx_scene_free(refused_then_loaded(path, parts, (olx_scene_limits){.materials = 8193}));
}

static void test_library_named_often(void **state) {
  text library, model;
  text_begin(&library);
  for (unsigned i = 0; i < 1000; i++) fprintf(library.stream, "newmtl m%u\nKd 0 0.25 0\n", i);
  text_write(&library, *state, "m.mtl");
  text_begin(&model);
  for (unsigned i = 0; i < 100; i++) fputs("mtllib m.mtl\n", model.stream);
  fputs("v 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl m7\nf 1 2 3\n", model.stream);
  olx_scene *scene = load_with(text_write(&model, *state, "often.obj"), NULL);
  assert_int_equal(scene->material_count, 1);
  assert_true(fabsf(scene->materials[0].base_color.y - 0.25f) < 1e-6f);
  olx_scene_free(scene);
}

static void test_objects(void **state) {
  text model;
  text_begin(&model);
  fputs("v 0 0 0\nv 1 0 0\nv 0 0 1\n", model.stream);
  for (unsigned i = 0; i < 32769; i++) fprintf(model.stream, "g %u\n%s", i, i ? "" : "f 1 2 3\n");
  const char *const parts[] = {"objects.obj: line 32773", "32769 nodes", "limit of 32768", NULL};
  olx_scene_free(
      refused_then_loaded(text_write(&model, *state, "objects.obj"), parts, (olx_scene_limits){.nodes = 40000}));
}

static const char *write_gltf_nodes(const scene_folder *folder, unsigned count, const char *node) {
  text nodes;
  text_begin(&nodes);
  fputs("[{\"mesh\": 0}", nodes.stream);
  for (unsigned i = 1; i < count; i++) fprintf(nodes.stream, ",%s", node);
  fputs("]", nodes.stream);
  fclose(nodes.stream);
  char *model = scene_files_gltf("[]", -1, nodes.data, "", false);
  const char *path = scene_folder_write_text(folder, "nodes.gltf", model);
  free(model);
  free(nodes.data);
  return path;
}

static void test_nodes(void **state) {
  const char *const parts[] = {"nodes.gltf: nodes: ", "32769 nodes", "limit of 32768", NULL};
  olx_scene_free(refused_then_loaded(write_gltf_nodes(*state, 32769, "{}"), parts, (olx_scene_limits){.nodes = 40000}));
}

// Every instance has triangles of its own: 2 x 1000 here.
static void test_instances(void **state) {
  olx_scene *scene;
  const char *path = write_gltf_nodes(*state, 1000, "{\"mesh\": 0}");
  const olx_scene_load_settings few = {.limits = {.triangles = 1999}}, enough = {.limits = {.triangles = 2000}};
  assert_int_equal(olx_scene_load_with(path, &few, &scene), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "nodes[999]: 2000 triangles"));
  olx_scene_free(load_with(path, &enough));
}

// A primitive of points adds no triangles, but each of its instances takes time to read.
static void test_primitives(void **state) {
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  gltf_maker m = {0};
  char nodes[8192] = "[{\"mesh\": 0}";
  olx_scene *scene;
  gltf_add(&m, corners, sizeof corners, 3, GLTF_FLOAT, "VEC3", false);
  gltf_add(&m, corners, 12, 1, GLTF_FLOAT, "VEC3", false);
  for (unsigned i = 1; i < 100; i++) gltf_append(nodes, sizeof nodes, ", {\"mesh\": 0}");
  gltf_append(nodes, sizeof nodes, "]");
  char *model = gltf_maker_text(
      &m, "{\"attributes\": {\"POSITION\": 0}}, {\"attributes\": {\"POSITION\": 1}, \"mode\": 0}", nodes, "", false);
  const char *path = scene_folder_write_text(*state, "points.gltf", model);
  free(model);
  const olx_scene_load_settings few = {.limits = {.triangles = 199}}, enough = {.limits = {.triangles = 200}};
  assert_int_equal(olx_scene_load_with(path, &few, &scene), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "nodes[99]: 200 triangles"));
  scene = load_with(path, &enough);
  assert_int_equal(scene->triangle_count, 1);
  olx_scene_free(scene);
}

static void test_materials_of_gltf(void **state) {
  text materials;
  text_begin(&materials);
  fputs("[{}", materials.stream);
  for (unsigned i = 1; i < 8193; i++) fprintf(materials.stream, ",{\"name\": \"m%u\"}", i);
  fputs("]", materials.stream);
  fclose(materials.stream);
  char *model = scene_files_gltf(materials.data, 0, "[{\"mesh\": 0}]", "", false);
  const char *path = scene_folder_write_text(*state, "materials.gltf", model);
  free(model);
  free(materials.data);
  const char *const parts[] = {"materials.gltf: materials: 8193", NULL};
  olx_scene_free(refused_then_loaded(path, parts, (olx_scene_limits){.materials = 8193}));
}

static void put_chunk(FILE *stream, const char *type, const uint8_t *data, uint32_t size) {
  const uint32_t crc = (uint32_t)crc32(crc32(crc32(0, NULL, 0), (const Bytef *)type, 4), data, size);
  const uint8_t length[4] = {(uint8_t)(size >> 24), (uint8_t)(size >> 16), (uint8_t)(size >> 8), (uint8_t)size};
  const uint8_t sum[4] = {(uint8_t)(crc >> 24), (uint8_t)(crc >> 16), (uint8_t)(crc >> 8), (uint8_t)crc};
  fwrite(length, 1, 4, stream);
  fwrite(type, 1, 4, stream);
  fwrite(data, 1, size, stream);
  fwrite(sum, 1, 4, stream);
}

// Writes a black RGBA PNG of side x side texels.
static void write_png(const scene_folder *folder, const char *name, uint32_t side) {
  const uint8_t s[4] = {(uint8_t)(side >> 24), (uint8_t)(side >> 16), (uint8_t)(side >> 8), (uint8_t)side};
  const uint8_t header[13] = {s[0], s[1], s[2], s[3], s[0], s[1], s[2], s[3], 8, 6, 0, 0, 0};
  const size_t row_bytes = (size_t)side * 4 + 1;
  const uint32_t rows = side <= 1024 ? side : 1; // one row is enough for a file that is refused by its header
  uint8_t *raw = calloc(rows, row_bytes);
  uLongf packed_bytes = compressBound((uLong)(rows * row_bytes));
  uint8_t *packed = malloc(packed_bytes);
  assert_true(raw && packed && compress(packed, &packed_bytes, raw, (uLong)(rows * row_bytes)) == Z_OK);
  text t;
  text_begin(&t);
  fwrite("\x89PNG\r\n\x1a\n", 1, 8, t.stream);
  put_chunk(t.stream, "IHDR", header, sizeof header);
  put_chunk(t.stream, "IDAT", packed, (uint32_t)packed_bytes);
  put_chunk(t.stream, "IEND", header, 0);
  text_write(&t, folder, name);
  free(raw);
  free(packed);
}

static void test_texels(void **state) {
  olx_scene *scene;
  write_png(*state, "a.png", 512);
  write_png(*state, "b.png", 512);
  scene_folder_write_text(*state, "square.mtl", "newmtl square\nmap_Kd a.png\nmap_Ke b.png\n");
  const char *path = scene_folder_write_text(*state, "square.obj", scene_files_obj);
  const olx_scene_load_settings few = {.limits = {.texels = 524287}}, enough = {.limits = {.texels = 524288}};
  assert_int_equal(olx_scene_load_with(path, &few, &scene), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "/b.png: image of 262144 texels: 524288 texels in the scene's images"));
  scene = load_with(path, &enough);
  assert_int_equal(scene->texture_count, 2);
  olx_scene_free(scene);
}

// The message names the library's own limit, not stb_image's "too large".
static void test_large_image(void **state) {
  write_png(*state, "large.png", 30000);
  scene_folder_write_text(*state, "square.mtl", "newmtl square\nmap_Kd large.png\n");
  olx_scene *scene = load_with(scene_folder_write_text(*state, "square.obj", scene_files_obj), NULL);
  assert_int_equal(scene->texture_count, 0);
  assert_true(scene->warning_count > 0);
  assert_non_null(strstr(scene->warnings[0],
                         "large.png: an image of 30000 x 30000 texels, of which a side can have 16384 at most"));
  olx_scene_free(scene);
}

// stb_image alone would write a table of more than 256 codes beyond its end.
static void test_damaged_jpeg(void **state) {
  uint8_t jpeg[512] = {0xFF, 0xD8, 0xFF, 0xFE, 0, 6, 0xFF, 0xC4, 9, 9, 0xFF, 0xC4, 1, 0x13, 0x00};
  jpeg[17] = 200;
  jpeg[18] = 57;
  olx_texture texture;
  assert_int_equal(olx_texture_load("damaged.jpg", jpeg, sizeof jpeg, OLX_TEXTURE_COLOR, &texture), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "damaged.jpg: a Huffman table of this JPEG is damaged"));
  jpeg[18] = 56; // the table is valid, while the rest of the image is missing
  assert_int_equal(olx_texture_load("damaged.jpg", jpeg, sizeof jpeg, OLX_TEXTURE_COLOR, &texture), OLX_ERROR_FORMAT);
  assert_null(strstr(olx_last_error(), "Huffman table"));
  (void)state;
}

// stb_image alone would allocate the memory that the chunk claims.
static void test_damaged_png(void **state) {
  uint8_t png[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\0\0\0\0\x3a\x7e\x9b\x55"
                  "\0\0\0\x0aIDAT\x78\x9c\x63\x68\0\0\0\x82\0\x81\x77\xcd\x72\xb6\0\0\0\0IEND\xae\x42\x60\x82";
  olx_texture texture = {0};
  assert_int_equal(olx_texture_load("one.png", png, sizeof png - 1, OLX_TEXTURE_DATA, &texture), OLX_OK);
  assert_int_equal(texture.texels[0], 128);
  olx_release(texture.texels);
  png[33] = 0x62; // a wrong length of the data
  assert_int_equal(olx_texture_load("one.png", png, sizeof png - 1, OLX_TEXTURE_DATA, &texture), OLX_ERROR_FORMAT);
  assert_non_null(strstr(olx_last_error(), "one.png: a chunk of this PNG is longer than the file"));
  (void)state;
}

static olx_result load_radiance(const char *rows, size_t size_bytes) {
  char file[256];
  olx_texture texture = {0};
  const int header = snprintf(file, sizeof file, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n");
  memcpy(file + header, rows, size_bytes);
  const olx_result result = olx_texture_load("sky.hdr", file, (size_t)header + size_bytes, OLX_TEXTURE_DATA, &texture);
  olx_release(texture.texels);
  return result;
}

// stb_image alone would wait forever for missing texels, and read uninitialised memory as texels.
static void test_damaged_radiance(void **state) {
  // The image has two rows of runs: one of 8 texels each for red, green, blue and the exponent; then 8 stored ones.
  static const char runs[] = "\x02\x02\x00\x08\x88\x40\x88\x50\x88\x60\x88\x81"
                             "\x02\x02\x00\x08\x08"
                             "abcdefgh"
                             "\x88\x50\x88\x60\x84\x81\x04"
                             "\x81\x82\x81\x82";
  char rows[64];
  memcpy(rows, runs, sizeof runs - 1);
  assert_int_equal(load_radiance(rows, sizeof runs - 1), OLX_OK);
  for (size_t size_bytes = 0; size_bytes < sizeof runs - 1; size_bytes++) {
    assert_int_equal(load_radiance(rows, size_bytes), OLX_ERROR_FORMAT);
  }
  assert_non_null(strstr(olx_last_error(), "sky.hdr: the texels of this Radiance image are damaged or end early"));
  rows[4] = 0; // a run of length 0
  assert_int_equal(load_radiance(rows, sizeof runs - 1), OLX_ERROR_FORMAT);
  rows[4] = (char)0x89; // a run beyond the row's end
  assert_int_equal(load_radiance(rows, sizeof runs - 1), OLX_ERROR_FORMAT);
  memset(rows, 'a', sizeof rows); // an image without runs
  assert_int_equal(load_radiance(rows, 64), OLX_OK);
  assert_int_equal(load_radiance(rows, 63), OLX_ERROR_FORMAT);
  (void)state;
}

// Materials with the same masked texture share the texture that keeps its alpha.
static void test_masks(void **state) {
  uint8_t tga[34];
  scene_folder_write(*state, "t.tga", tga, scene_files_tga(tga));
  char *model = scene_files_gltf(
      "[{\"name\": \"a\", \"alphaMode\": \"MASK\", \"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}},"
      "{\"name\": \"b\", \"alphaMode\": \"MASK\", \"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}]",
      0, "[{\"mesh\": 0}, {\"mesh\": 0}]", ", \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": \"t.tga\"}]",
      false);
  scene_folder_write_text(*state, "m.gltf", model);
  free(model);
  const char *path = scene_folder_write_text(*state, "d.json",
                                             "{\"models\": [{\"path\": \"m.gltf\"}, {\"path\": \"m.gltf\"}], "
                                             "\"materials\": {\"*\": {\"base_color\": [0, 0, 0]},"
                                             "\"a\": {\"base_color\": [0.5, 0.5, 0.5]}}}");
  olx_scene *scene = load_with(path, NULL);
  assert_int_equal(scene->material_count, 2);
  assert_int_equal(scene->texture_count, 4); // one texture of each model, and its alpha
  olx_scene_free(scene);
}

// Makes a model in folder/models/deep, and images beside it, in a sibling folder, and outside.
static void make_folders(const scene_folder *folder, char *deep, size_t size) {
  snprintf(deep, size, "%s/models", folder->path);
  assert_int_equal(mkdir(deep, 0700), 0);
  snprintf(deep, size, "%s/models/textures", folder->path);
  assert_int_equal(mkdir(deep, 0700), 0);
  snprintf(deep, size, "%s/models/deep", folder->path);
  assert_int_equal(mkdir(deep, 0700), 0);
}

static olx_result load_textured(const scene_folder *folder, const char *image, bool allow, uint32_t *textures) {
  char material[600];
  snprintf(material, sizeof material, "newmtl square\nmap_Kd %s\n", image);
  scene_folder_write_text(folder, "models/deep/square.mtl", material);
  const char *path = scene_folder_write_text(folder, "models/deep/square.obj", scene_files_obj);
  olx_scene *scene = NULL;
  const olx_result result = olx_scene_load_with(path, &(olx_scene_load_settings){.allow_outside = allow}, &scene);
  *textures = scene ? scene->texture_count : 0;
  olx_scene_free(scene);
  return result;
}

static void test_outside_images(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  uint32_t textures;
  uint8_t tga[34];
  const size_t size = scene_files_tga(tga);
  make_folders(folder, path, sizeof path);
  scene_folder_write(folder, "models/deep/beside.tga", tga, size);
  scene_folder_write(folder, "models/textures/sibling.tga", tga, size);
  scene_folder_write(folder, "secret.tga", tga, size);
  const char *const inside[] = {"beside.tga", "../textures/sibling.tga", "../deep/../deep/beside.tga"};
  for (size_t i = 0; i < sizeof inside / sizeof *inside; i++) {
    assert_int_equal(load_textured(folder, inside[i], false, &textures), OLX_OK);
    assert_int_equal(textures, 1);
  }
  snprintf(path, sizeof path, "%s/models/deep/link.tga", folder->path);
  assert_int_equal(symlink("../../secret.tga", path), 0);
  snprintf(path, sizeof path, "%s/secret.tga", folder->path);
  const char *const outside[] = {"../../secret.tga", path, "link.tga"};
  for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
    assert_int_equal(load_textured(folder, outside[i], false, &textures), OLX_ERROR_UNSUPPORTED);
    assert_non_null(strstr(olx_last_error(), "square.obj: it names "));
    assert_non_null(strstr(olx_last_error(), "/secret.tga, which lies outside "));
    assert_non_null(strstr(olx_last_error(), "--allow-outside"));
    assert_int_equal(load_textured(folder, outside[i], true, &textures), OLX_OK);
    assert_int_equal(textures, 1);
  }
  // A file that does not exist is a missing texture, even outside.
  assert_int_equal(load_textured(folder, "../../../../nothing/here.tga", false, &textures), OLX_OK);
}

static void test_outside_buffers(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  make_folders(folder, path, sizeof path);
  static const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  scene_folder_write(folder, "secret.bin", corners, sizeof corners);
  scene_folder_write(folder, "models/triangle.bin", corners, sizeof corners);
  static const char form[] =
      "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}],"
      "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}}]}],"
      "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}],"
      "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}], \"buffers\": [{\"byteLength\": 36, \"uri\": \"%s\"}]}";
  olx_scene *scene = NULL;
  char model[1024];
  snprintf(model, sizeof model, form, "../triangle.bin");
  olx_scene_free(load_with(scene_folder_write_text(folder, "models/deep/in.gltf", model), NULL));
  snprintf(model, sizeof model, form, "../../secret.bin");
  const char *out = scene_folder_write_text(folder, "models/deep/out.gltf", model);
  assert_int_equal(olx_scene_load(out, &scene), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "secret.bin, which lies outside"));
  olx_scene_free(load_with(out, &(olx_scene_load_settings){.allow_outside = true}));
}

static void test_outside_materials(void **state) {
  const scene_folder *folder = *state;
  char path[512];
  make_folders(folder, path, sizeof path);
  scene_folder_write_text(folder, "secret.mtl", "newmtl square\nKd 0 0 0\n");
  const char *model = scene_folder_write_text(folder, "models/deep/out.obj",
                                              "mtllib ../../secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  olx_scene *scene = NULL;
  assert_int_equal(olx_scene_load(model, &scene), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "secret.mtl, which lies outside"));
  olx_scene_free(load_with(model, &(olx_scene_load_settings){.allow_outside = true}));
}

static void test_defaults(void **state) {
  (void)state;
  const olx_scene_load_settings settings = olx_scene_load_settings_default();
  assert_int_equal(settings.limits.triangles, 1u << 26);
  assert_int_equal(settings.limits.texels, 1u << 29);
  assert_int_equal(settings.limits.polygon_corners, 2048);
  assert_int_equal(settings.limits.materials, 8192);
  assert_int_equal(settings.limits.nodes, 32768);
  assert_false(settings.allow_outside);
}

#define IN_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_set_up, scene_folder_tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_defaults),
      IN_FOLDER(test_polygons),
      IN_FOLDER(test_materials_of_obj),
      IN_FOLDER(test_material_library),
      IN_FOLDER(test_library_named_often),
      IN_FOLDER(test_objects),
      IN_FOLDER(test_nodes),
      IN_FOLDER(test_instances),
      IN_FOLDER(test_primitives),
      IN_FOLDER(test_materials_of_gltf),
      IN_FOLDER(test_texels),
      IN_FOLDER(test_large_image),
      cmocka_unit_test(test_damaged_jpeg),
      cmocka_unit_test(test_damaged_png),
      cmocka_unit_test(test_damaged_radiance),
      IN_FOLDER(test_masks),
      IN_FOLDER(test_outside_images),
      IN_FOLDER(test_outside_buffers),
      IN_FOLDER(test_outside_materials),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
