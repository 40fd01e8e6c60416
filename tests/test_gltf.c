// Tests features of glTF beyond a square of floats: quantised, sparse and compressed accessors, strips and fans,
// several texture coordinates, scenes, buffers, compression. Each file is made here and has one feature.
#include "data_uris.h"
#include "gltf_square.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"

#include <octalux/export.h>
#include <octalux/render.h>

#include <meshoptimizer.h>
#include <webp/encode.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// ---- primitives

static void strips_and_fans_become_triangles_that_face_one_way(void **state) {
  const float strip[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
  const float fan[15] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0};
  const float *const shapes[2] = {strip, fan};
  for (int i = 0; i < 2; ++i) {
    gltf_maker m = {0};
    char primitive[96];
    gltf_add(&m, shapes[i], sizeof strip, 5, GLTF_FLOAT, "VEC3", false);
    snprintf(primitive, sizeof primitive, "{\"attributes\": {\"POSITION\": 0}, \"mode\": %d}", 5 + i);
    olx_scene *scene = load_model(write_square_model(&m, *state, primitive, "[{\"mesh\": 0}]", ""));
    assert_int_equal(scene->triangle_count, 3);
    for (uint32_t t = 0; t < 3; ++t) assert_near_vector(winding_normal(scene, t), 0, 0, 1, 1e-6f);
    olx_scene_free(scene);
    scene = load_model(write_square_model(&m, *state, primitive, "[{\"mesh\": 0, \"scale\": [-1, 1, 1]}]", ""));
    for (uint32_t t = 0; t < 3; ++t) assert_near_vector(winding_normal(scene, t), 0, 0, 1, 1e-6f);
    olx_scene_free(scene);
  }
}

static void points_and_lines_are_left_out_and_counted(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene =
      load_model(write_square_model(&m, *state,
                                    "{\"attributes\": {\"POSITION\": 0}, \"indices\": 3}, {\"attributes\": "
                                    "{\"POSITION\": 0}, \"mode\": 0}, {\"attributes\": {\"POSITION\": 0}, \"mode\": "
                                    "1}, {\"attributes\": {\"POSITION\": 0}, \"mode\": 3}",
                                    "[{\"mesh\": 0}]", ""));
  assert_int_equal(scene->triangle_count, 2);
  assert_model_warned(scene, "skipped 9 points and lines"); // 4 points, 2 lines, and 3 points of a strip
  olx_scene_free(scene);
}

static void indices_of_every_width_are_the_same(void **state) {
  const uint8_t bytes[6] = {0, 1, 2, 0, 2, 3};
  const uint32_t words[6] = {0, 1, 2, 0, 2, 3};
  const struct {
    const void *data;
    size_t size_bytes;
    int component;
  } kinds[] = {{bytes, sizeof bytes, GLTF_UINT8},
               {square_indices, sizeof square_indices, GLTF_UINT16},
               {words, sizeof words, GLTF_UINT32}};
  uint64_t hashes[3];
  for (int i = 0; i < 3; ++i) {
    gltf_maker m = {0};
    gltf_add(&m, square_positions, sizeof square_positions, 4, GLTF_FLOAT, "VEC3", false);
    gltf_add(&m, kinds[i].data, kinds[i].size_bytes, 6, kinds[i].component, "SCALAR", false);
    olx_scene *scene = load_model(
        write_square_model(&m, *state, "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}", "[{\"mesh\": 0}]", ""));
    assert_int_equal(scene->triangle_count, 2);
    hashes[i] = scene->hash;
    olx_scene_free(scene);
  }
  assert_true(hashes[0] == hashes[1] && hashes[1] == hashes[2]);
}

static void without_normals_triangles_are_flat(void **state) {
  const float roof[12] = {0, 0, 0, 1, 0, 1, 1, 1, 1, 2, 0, 0};
  const uint8_t indices[6] = {0, 1, 2, 1, 3, 2};
  gltf_maker m = {0};
  gltf_add(&m, roof, sizeof roof, 4, GLTF_FLOAT, "VEC3", false);
  gltf_add(&m, indices, sizeof indices, 6, GLTF_UINT8, "SCALAR", false);
  olx_scene *scene = load_model(
      write_square_model(&m, *state, "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}", "[{\"mesh\": 0}]", ""));
  assert_int_equal(scene->vertex_count, 6); // no two triangles share a normal
  for (uint32_t v = 0; v < 6; ++v) {
    const olx_vec3 n = winding_normal(scene, v / 3);
    assert_near_vector(scene->normals[scene->indices[v]], n.x, n.y, n.z, 1e-6f);
  }
  olx_scene_free(scene);
}

static void attributes_that_do_not_fit_their_positions_are_left_out(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, square_normals, 24, 2, GLTF_FLOAT, "VEC3", false);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 4}, \"indices\": 3}", "[{\"mesh\": 0}]", ""));
  assert_model_warned(scene, "1 attributes are ignored");
  assert_near_vector(scene->normals[scene->indices[0]], 0, 0, 1, 1e-6f);
  olx_scene_free(scene);
}

// ---- quantised numbers (KHR_mesh_quantization)

static void quantised_vertices_are_those_of_floats(void **state) {
  const int16_t corners[16] = {0, 0, 0, 0, 1000, 0, 0, 0, 1000, 1000, 0, 0, 0, 1000, 0, 0};
  const int8_t normals[16] = {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0};
  const uint16_t uvs[8] = {0, 65535, 65535, 65535, 65535, 0, 0, 0};
  gltf_maker m = {0};
  char of[3][80];
  snprintf(of[0], sizeof of[0], "\"bufferView\": %u, ",
           gltf_add_view(&m, corners, sizeof corners, ", \"byteStride\": 8"));
  snprintf(of[1], sizeof of[1], "\"normalized\": true, \"bufferView\": %u, ",
           gltf_add_view(&m, normals, sizeof normals, ", \"byteStride\": 4"));
  gltf_add_accessor(&m, of[0], 4, GLTF_INT16, "VEC3");
  gltf_add_accessor(&m, of[1], 4, GLTF_INT8, "VEC3");
  gltf_add(&m, uvs, sizeof uvs, 4, GLTF_UINT16, "VEC2", true);
  gltf_add(&m, square_indices, sizeof square_indices, 6, GLTF_UINT16, "SCALAR", false);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2}, \"indices\": 3}",
      "[{\"mesh\": 0, \"scale\": [0.002, 0.002, 0.002], \"translation\": [1, 0, 0]}]",
      ", \"extensionsRequired\": [\"KHR_mesh_quantization\"]"));
  assert_int_equal(scene->warning_count, 2); // about the default material: its albedo, and that it is a metal
  for (uint32_t v = 0; v < 4; ++v) {
    const float *p = square_positions + 3 * v, *uv = square_uvs + 2 * v;
    assert_near_vector(scene->positions[v], 1.0f + 2.0f * p[0], 2.0f * p[1], 0, 1e-6f);
    assert_near_vector(scene->normals[v], 0, 0, 1, 1e-6f);
    assert_near_number(scene->uvs[v].x, uv[0], 0);
    assert_near_number(scene->uvs[v].y, uv[1], 0);
  }
  olx_scene_free(scene);
}

static void normalised_integers_reach_from_minus_one_to_one(void **state) {
  const int8_t small[12] = {-128, -127, 0, 127, -127, 0, 127, 127, 0, -127, 127, 0};
  const int16_t large[12] = {-32768, -32767, 0, 32767, -32767, 0, 32767, 32767, 0, -32767, 32767, 0};
  const uint8_t positive[12] = {0, 0, 0, 255, 0, 0, 255, 255, 0, 0, 255, 0};
  const struct {
    const void *data;
    size_t size_bytes;
    int component;
    float low;
  } kinds[] = {{small, sizeof small, GLTF_INT8, -1.0f},
               {large, sizeof large, GLTF_INT16, -1.0f},
               {positive, sizeof positive, GLTF_UINT8, 0.0f}};
  for (int i = 0; i < 3; ++i) {
    gltf_maker m = {0};
    gltf_add(&m, kinds[i].data, kinds[i].size_bytes, 4, kinds[i].component, "VEC3", true);
    gltf_add(&m, square_indices, sizeof square_indices, 6, GLTF_UINT16, "SCALAR", false);
    olx_scene *scene = load_model(
        write_square_model(&m, *state, "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}", "[{\"mesh\": 0}]", ""));
    assert_near_vector(scene->bounds_min, kinds[i].low, kinds[i].low, 0, 0);
    assert_near_vector(scene->bounds_max, 1, 1, 0, 0);
    olx_scene_free(scene);
  }
}

// ---- sparse accessors

static gltf_maker sparse_square(const char *base, uint16_t moved) {
  const float corner[3] = {3, 3, 0};
  gltf_maker m = {0};
  char of[400];
  gltf_add_view(&m, square_positions, sizeof square_positions, "");
  gltf_add_view(&m, &moved, sizeof moved, "");
  gltf_add_view(&m, corner, sizeof corner, "");
  snprintf(of, sizeof of,
           "%s\"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 1, \"componentType\": 5123}, \"values\": "
           "{\"bufferView\": 2}}, ",
           base);
  gltf_add_accessor(&m, of, 4, GLTF_FLOAT, "VEC3");
  gltf_add(&m, square_indices, sizeof square_indices, 6, GLTF_UINT16, "SCALAR", false);
  return m;
}

static void sparse_elements_replace_those_of_the_view_or_zeros(void **state) {
  const char *primitive = "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}";
  gltf_maker m = sparse_square("\"bufferView\": 0, ", 2);
  olx_scene *scene = load_model(write_square_model(&m, *state, primitive, "[{\"mesh\": 0}]", ""));
  assert_near_vector(scene->bounds_max, 3, 3, 0, 0);
  assert_int_equal(scene->triangle_count, 2);
  olx_scene_free(scene);
  // Zeros and a single other corner make no triangle.
  m = sparse_square("", 2);
  assert_model_refused(write_square_model(&m, *state, primitive, "[{\"mesh\": 0}]", ""), OLX_ERROR_EMPTY,
                       "no triangles");
  m = sparse_square("\"bufferView\": 0, ", 4);
  assert_model_refused(write_square_model(&m, *state, primitive, "[{\"mesh\": 0}]", ""), OLX_ERROR_FORMAT,
                       "accessors[0]: a sparse index is out of range");
}

// Programs that compress meshes leave accessors behind to which nothing refers any more.
static void accessors_without_data_are_refused_where_they_are_used(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  gltf_add_accessor(&m, "", 4, GLTF_FLOAT, "VEC3");
  olx_scene *scene =
      load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", ", \"materials\": [{}]"));
  assert_int_equal(scene->triangle_count, 2);
  olx_scene_free(scene);
  m = (gltf_maker){0};
  add_square(&m);
  gltf_add_accessor(&m, "", 4, GLTF_FLOAT, "VEC3");
  assert_model_refused(write_square_model(&m, *state, "{\"attributes\": {\"POSITION\": 4}, \"indices\": 3}",
                                          "[{\"mesh\": 0}]", ", \"materials\": [{}]"),
                       OLX_ERROR_FORMAT, "accessors[4]: it has no data");
}

static void zeros_out_of_proportion_to_the_file_are_refused(void **state) {
  // A sparse accessor's zeros take a few bytes in the file and gigabytes in memory.
  gltf_maker m = {0};
  add_square(&m);
  gltf_add_accessor(&m,
                    "\"sparse\": {\"count\": 1, \"indices\": {\"bufferView\": 3, \"componentType\": 5123}, \"values\": "
                    "{\"bufferView\": 0}}, ",
                    100000000, GLTF_FLOAT, "VEC3");
  assert_model_refused(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", ", \"materials\": [{}]"),
                       OLX_ERROR_FORMAT,
                       "accessors[4]: it has no bufferView, and more elements than the file has bytes");
}

// ---- textures and their coordinates

#define TEXTURED(base, emission)                                                                                       \
  ", \"materials\": [{\"emissiveFactor\": [1, 1, 1], \"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": "    \
  "0" base "}}, \"emissiveTexture\": {\"index\": 0" emission                                                           \
  "}}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": \"" FOUR_COLORS "\"}]"

static void two_sets_of_texture_coordinates(void **state) {
  const float upside_down[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, upside_down, sizeof upside_down, 4, GLTF_FLOAT, "VEC2", false);
  olx_scene *scene = load_model(write_square_model(&m, *state, square_with(", \"TEXCOORD_1\": 4"), "[{\"mesh\": 0}]",
                                                   TEXTURED("", ", \"texCoord\": 1")));
  assert_int_equal(scene->materials[0].second_uvs, OLX_SLOT_EMISSION);
  const olx_surface top = look_at_square(scene, 0.25f, 0.75f);
  assert_near_vector(top.base_color, 0.95f, 0, 0, 1e-5f);
  assert_near_vector(top.emission, 0, 0, 1, 1e-5f);
  olx_scene_free(scene);
  // When all textures use the second set, it becomes the only one.
  scene = load_model(write_square_model(&m, *state, square_with(", \"TEXCOORD_1\": 4"), "[{\"mesh\": 0}]",
                                        TEXTURED(", \"texCoord\": 1", ", \"texCoord\": 1")));
  assert_null(scene->second_uvs);
  assert_near_vector(look_at_square(scene, 0.25f, 0.75f).base_color, 0, 0, 0.95f, 1e-5f);
  olx_scene_free(scene);
}

// The transform is the example of the extension's specification: it selects the lower left quarter of the image, turned
// clockwise by 90 degrees.
static void texture_transforms_scale_turn_and_move(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, square_with(""), "[{\"mesh\": 0}]",
      TEXTURED(TRANSFORM("\"offset\": [0, 1], \"rotation\": 1.57079632679, \"scale\": [0.5, 0.5]"), "")));
  const olx_vec2 upper_left = scene->uvs[3], upper_right = scene->uvs[2], lower_left = scene->uvs[0];
  assert_near_number(upper_left.x, 0.0f, 1e-6f); // (0, 0) is mapped to the lower left of the image
  assert_near_number(upper_left.y, 1.0f, 1e-6f);
  assert_near_number(upper_right.x, 0.0f, 1e-6f); // u increases upwards
  assert_near_number(upper_right.y, 0.5f, 1e-6f);
  assert_near_number(lower_left.x, 0.5f, 1e-6f); // v increases to the right
  assert_near_number(lower_left.y, 1.0f, 1e-6f);
  assert_near_vector(look_at_square(scene, 0.5f, 0.5f).base_color, 0, 0, 0.95f, 1e-5f);
  assert_near_vector(look_at_square(scene, 0.25f, 0.75f).emission, 1, 0, 0,
                     1e-5f); // the emission texture has no transform
  olx_scene_free(scene);
}

static void a_texture_transform_may_name_another_set(void **state) {
  const float upside_down[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, upside_down, sizeof upside_down, 4, GLTF_FLOAT, "VEC2", false);
  olx_scene *scene =
      load_model(write_square_model(&m, *state, square_with(", \"TEXCOORD_1\": 4"), "[{\"mesh\": 0}]",
                                    TEXTURED(TRANSFORM("\"texCoord\": 1"), TRANSFORM("\"texCoord\": 1"))));
  assert_null(scene->second_uvs);
  assert_near_vector(look_at_square(scene, 0.25f, 0.75f).base_color, 0, 0, 0.95f, 1e-5f);
  olx_scene_free(scene);
}

static void a_third_kind_of_coordinates_is_warned_about(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, square_with(""), "[{\"mesh\": 0}]",
      ", \"materials\": [{\"name\": \"busy\", \"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}, "
      "\"normalTexture\": {\"index\": 0" TRANSFORM(
          "\"scale\": [2, 2]") "}, \"emissiveTexture\": {\"index\": "
                               "0" TRANSFORM("\"scale\": [3, 3]") "}}], \"textures\": "
                                                                  "[{\"source\": 0}], "
                                                                  "\"images\": "
                                                                  "[{\"uri\": "
                                                                  "\"" FOUR_COLORS "\"}]"));
  assert_model_warned(scene, "1 material has textures with more than two kinds of coordinates");
  assert_model_warned(scene, "(busy)");
  olx_scene_free(scene);
}

static void mirrored_textures_are_warned_about_once(void **state) {
  static const char *const samplers[] = {"{}, {\"wrapS\": 33648}, {\"wrapT\": 33648, \"wrapS\": 10497}",
                                         "{}, {\"wrapS\": 33071}, {\"wrapT\": 10497}"};
  for (size_t i = 0; i < 2; ++i) {
    gltf_maker m = {0};
    char more[600];
    add_square(&m);
    snprintf(more, sizeof more,
             ", \"materials\": [{}], \"textures\": [{}, {\"sampler\": 0}, {\"sampler\": 1}, {\"sampler\": 2}], "
             "\"samplers\": [%s]",
             samplers[i]);
    olx_scene *scene = load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", more));
    if (i == 0) assert_model_warned(scene, "2 textures repeat without being mirrored");
    assert_int_equal(scene->warning_count, i == 0 ? 2 : 1); // the other one is about the albedo
    olx_scene_free(scene);
  }
}

static void textures_without_their_sampler_are_refused(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  assert_model_refused(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]",
                                          ", \"materials\": [{}], \"textures\": [{}, {\"sampler\": 1}], "
                                          "\"samplers\": [{}]"),
                       OLX_ERROR_FORMAT, "textures[1]: its sampler does not exist");
}

static void images_of_other_kinds_are_refused_or_replaced_by_their_source(void **state) {
  static const char *const kinds[] = {"KHR_texture_basisu", "EXT_texture_avif"};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; ++i) {
    gltf_maker m = {0};
    char more[600];
    add_square(&m);
    const char *form = ", \"materials\": [{\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}], "
                       "\"textures\": [{%s\"extensions\": {\"%s\": {\"source\": 0}}}], \"images\": [{\"uri\": \"%s\"}]";
    snprintf(more, sizeof more, form, "", kinds[i], FOUR_COLORS);
    assert_model_refused(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", more),
                         OLX_ERROR_UNSUPPORTED, kinds[i]);
    snprintf(more, sizeof more, form, "\"source\": 0, ", kinds[i], FOUR_COLORS);
    olx_scene *scene = load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", more));
    assert_int_equal(scene->texture_count, 1);
    olx_scene_free(scene);
  }
}

static void textures_without_an_image_are_reported_once(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, square_with(""), "[{\"mesh\": 0}]",
      ", \"materials\": [{\"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, 0.25, 0.125, 1], \"metallicFactor\": "
      "0, "
      "\"baseColorTexture\": {\"index\": 0}}, \"normalTexture\": {\"index\": 0}}], \"textures\": [{}]"));
  assert_int_equal(scene->warning_count, 1);
  assert_model_warned(scene, "texture left out: ");
  assert_model_warned(scene, "textures[0]: it has no image");
  assert_int_equal(scene->texture_count, 0);
  assert_near_vector(look_at_square(scene, 0.5f, 0.5f).base_color, 0.5f, 0.25f, 0.125f, 1e-5f);
  olx_scene_free(scene);
}

// Encodes a square of 2 x 2 texels whose upper left one is half red and half transparent.
static char *webp_uri(void) {
  const uint8_t texels[16] = {188, 0, 0, 128, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};
  uint8_t *encoded = NULL;
  const size_t size_bytes = WebPEncodeLosslessRGBA(texels, 2, 2, 8, &encoded);
  char *uri = make_data_uri(encoded, size_bytes);
  WebPFree(encoded);
  return uri;
}

static void images_may_be_webp(void **state) {
  char *uri = webp_uri(), more[700];
  gltf_maker m = {0};
  add_square(&m);
  snprintf(more, sizeof more,
           ", \"extensionsRequired\": [\"EXT_texture_webp\"], \"materials\": [{\"pbrMetallicRoughness\": "
           "{\"baseColorTexture\": {\"index\": 0}}}], \"textures\": [{\"extensions\": {\"EXT_texture_webp\": "
           "{\"source\": 0}}}], \"images\": [{\"uri\": \"%s\"}]",
           uri);
  olx_scene *scene = load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", more));
  assert_int_equal(scene->texture_count, 1);
  assert_memory_equal(scene->textures[0].texels, ((uint8_t[4]){188, 0, 0, 128}), 4);
  assert_near_vector(look_at_square(scene, 0.75f, 0.75f).base_color, 0, 0.95f, 0, 1e-6f);
  olx_scene_free(scene);
  free(uri);
}

static void damaged_webp_is_left_out_with_a_warning(void **state) {
  const uint8_t header[] = "RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\xff\xff\xff\x07\0\0\0\0\0\0\0\0";
  char *greedy = make_data_uri(header, sizeof header - 1), *whole = webp_uri(), more[700];
  const char *const messages[] = {"bytes cannot hold", "cannot decode this WebP image"};
  whole[strlen(whole) - 24] = 0; // three times 24 / 4 bytes are missing
  for (int i = 0; i < 2; ++i) {
    gltf_maker m = {0};
    add_square(&m);
    snprintf(more, sizeof more,
             ", \"materials\": [{\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}], \"textures\": "
             "[{\"extensions\": {\"EXT_texture_webp\": {\"source\": 0}}}], \"images\": [{\"uri\": \"%s\"}]",
             i ? whole : greedy);
    olx_scene *scene = load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", more));
    assert_int_equal(scene->texture_count, 0);
    assert_model_warned(scene, messages[i]);
    olx_scene_free(scene);
  }
  free(greedy);
  free(whole);
}

// ---- scenes and nodes

static void the_scene_of_the_file_is_the_one_that_is_read(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  const char *nodes = "[{\"mesh\": 0}, {\"mesh\": 0, \"translation\": [5, 0, 0]}]";
  char *uri = make_data_uri(m.bytes, m.size_bytes);
  const struct {
    const char *scenes;
    uint32_t triangles;
    float low;
  } cases[] = {{"\"scenes\": [{\"nodes\": [0]}, {\"nodes\": [1]}], \"scene\": 1, ", 2, 5.0f},
               {"\"scenes\": [{\"nodes\": [0]}, {\"nodes\": [1]}], ", 2, 0.0f},
               {"", 4, 0.0f}}; // the whole file when it has no scenes
  for (int i = 0; i < 3; ++i) {
    char text[32768];
    snprintf(text, sizeof text,
             "{\"asset\": {\"version\": \"2.0\"}, %s\"nodes\": %s, \"meshes\": [{\"primitives\": [{\"attributes\": "
             "{\"POSITION\": 0}, \"indices\": 3}]}], \"accessors\": [%s], \"bufferViews\": [%s], \"buffers\": "
             "[{\"byteLength\": %zu, \"uri\": \"%s\"}]}",
             cases[i].scenes, nodes, m.accessors, m.views, m.size_bytes, uri);
    olx_scene *scene = load_model(scene_folder_write_text(*state, "made.gltf", text));
    assert_int_equal(scene->triangle_count, cases[i].triangles);
    assert_near_vector(scene->bounds_min, cases[i].low, 0, 0, 0);
    olx_scene_free(scene);
  }
  free(uri);
}

static void nodes_may_be_nested_but_not_without_end(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  const int depths[2] = {200, 300};
  for (int i = 0; i < 2; ++i) {
    char nodes[16384] = "[";
    for (int n = 0; n < depths[i]; ++n) gltf_append(nodes, sizeof nodes, "{\"children\": [%d]}, ", n + 1);
    gltf_append(nodes, sizeof nodes, "{\"mesh\": 0}]");
    const char *path = write_square_model(&m, *state, square_with(""), nodes, ", \"materials\": [{}]");
    if (i == 0) olx_scene_free(load_model(path));
    else assert_model_refused(path, OLX_ERROR_FORMAT, "nested too deep");
  }
}

// ---- EXT_mesh_gpu_instancing

#define PLACED                                                                                                         \
  "[{\"mesh\": 0, \"translation\": [0, 0, 5], \"extensions\": {\"EXT_mesh_gpu_instancing\": {\"attributes\": {%s}}}}]"

static const char *write_placed_square(gltf_maker *m, void *state, const char *attributes) {
  char nodes[400];
  snprintf(nodes, sizeof nodes, PLACED, attributes);
  return write_square_model(m, state, square_with(""), nodes,
                            ", \"materials\": [{}], \"extensionsRequired\": [\"EXT_mesh_gpu_instancing\"]");
}

static void a_node_puts_its_mesh_in_many_places(void **state) {
  const float translations[9] = {0, 0, 0, 10, 0, 0, 0, 20, 0}, scales[9] = {1, 1, 1, 2, 3, 1, 1, 1, -1};
  const int8_t rotations[12] = {0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 127, 0}; // the last one turns by half about z
  gltf_maker m = {0};
  add_square(&m);
  const uint32_t first = gltf_add(&m, translations, sizeof translations, 3, GLTF_FLOAT, "VEC3", false);
  gltf_add(&m, rotations, sizeof rotations, 3, GLTF_INT8, "VEC4", true);
  gltf_add(&m, scales, sizeof scales, 3, GLTF_FLOAT, "VEC3", false);
  char attributes[160];
  snprintf(attributes, sizeof attributes, "\"TRANSLATION\": %u, \"ROTATION\": %u, \"SCALE\": %u, \"_ID\": 99", first,
           first + 1, first + 2);
  olx_scene *scene = load_model(write_placed_square(&m, *state, attributes));
  assert_int_equal(scene->triangle_count, 6);
  for (uint32_t v = 0; v < 4; ++v) {
    const float x = square_positions[3 * v], y = square_positions[3 * v + 1];
    assert_near_vector(scene->positions[v], x, y, 5, 1e-6f);
    assert_near_vector(scene->positions[4 + v], 10 + 2 * x, 3 * y, 5, 1e-5f);
    assert_near_vector(scene->positions[8 + v], -x, 20 - y, 5, 1e-5f);
  }
  assert_near_vector(scene->normals[0], 0, 0, 1, 1e-6f);
  assert_near_vector(scene->normals[8], 0, 0, -1, 1e-6f); // mirrored
  olx_scene_free(scene);
}

static void instances_may_lack_attributes(void **state) {
  const float translations[6] = {1, 0, 0, 2, 0, 0};
  gltf_maker m = {0};
  add_square(&m);
  char attributes[40];
  snprintf(attributes, sizeof attributes, "\"TRANSLATION\": %u",
           gltf_add(&m, translations, sizeof translations, 2, GLTF_FLOAT, "VEC3", false));
  olx_scene *scene = load_model(write_placed_square(&m, *state, attributes));
  assert_int_equal(scene->triangle_count, 4);
  assert_near_vector(scene->positions[4], 2.0f + square_positions[0], square_positions[1], 5, 1e-6f);
  olx_scene_free(scene);
  scene = load_model(write_placed_square(&m, *state, ""));
  assert_int_equal(scene->triangle_count, 2);
  olx_scene_free(scene);
}

static void instances_that_do_not_fit_are_refused(void **state) {
  const float numbers[9] = {0};
  gltf_maker m = {0};
  char text[80];
  add_square(&m);
  const uint32_t three = gltf_add(&m, numbers, sizeof numbers, 3, GLTF_FLOAT, "VEC3", false);
  const uint32_t two = gltf_add(&m, numbers, 24, 2, GLTF_FLOAT, "VEC3", false);
  assert_model_refused(write_placed_square(&m, *state, "\"SCALE\": 77"), OLX_ERROR_FORMAT,
                       "nodes[0]: an attribute of its instances does not exist");
  snprintf(text, sizeof text, "\"ROTATION\": %u", three);
  assert_model_refused(write_placed_square(&m, *state, text), OLX_ERROR_FORMAT,
                       "nodes[0]: an attribute of its instances is of another type");
  snprintf(text, sizeof text, "\"TRANSLATION\": %u, \"SCALE\": %u", three, two);
  assert_model_refused(write_placed_square(&m, *state, text), OLX_ERROR_FORMAT,
                       "nodes[0]: the attributes of its instances differ in their count");
}

// Small files may ask for many copies, so the limit on nodes bounds them before memory is allocated.
static void instances_count_as_nodes(void **state) {
  const float translations[9] = {0};
  const olx_scene_load_settings few = {.limits = {.nodes = 2}};
  gltf_maker m = {0};
  char attributes[40];
  olx_scene *scene = NULL;
  add_square(&m);
  snprintf(attributes, sizeof attributes, "\"TRANSLATION\": %u",
           gltf_add(&m, translations, sizeof translations, 3, GLTF_FLOAT, "VEC3", false));
  const char *path = write_placed_square(&m, *state, attributes);
  assert_int_equal(olx_scene_load_with(path, &few, &scene), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "3 nodes in a model, more than the limit of 2"));
  olx_scene_free(load_model(path));
}

static void morph_targets_are_warned_about(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, "{\"attributes\": {\"POSITION\": 0}, \"indices\": 3, \"targets\": [{\"POSITION\": 0}]}",
      "[{\"mesh\": 0}]", ""));
  assert_model_warned(scene, "the morph targets of 1 meshes are ignored");
  olx_scene_free(scene);
}

// ---- buffers

static void buffers_lie_in_files_beside_the_model(void **state) {
  static const char form[] =
      "{\"asset\": {\"version\": \"2.0\"}, \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}], \"meshes\": "
      "[{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"indices\": 3}]}], \"accessors\": [%s], "
      "\"bufferViews\": "
      "[%s], \"buffers\": [{\"byteLength\": %zu, \"uri\": \"%s\"}]}";
  gltf_maker m = {0};
  char text[32768];
  add_square(&m);
  scene_folder_write(*state, "with space.bin", m.bytes, m.size_bytes);
  snprintf(text, sizeof text, form, m.accessors, m.views, m.size_bytes, "with%20space.bin");
  olx_scene *scene = load_model(scene_folder_write_text(*state, "made.gltf", text));
  assert_int_equal(scene->triangle_count, 2);
  char path[600];
  snprintf(path, sizeof path, "%s/with space.bin", ((scene_folder *)*state)->path);
  assert_true(olx_scene_was_read_from(scene, path));
  olx_scene_free(scene);
  snprintf(text, sizeof text, form, m.accessors, m.views, m.size_bytes, "gone.bin");
  assert_model_refused(scene_folder_write_text(*state, "made.gltf", text), OLX_ERROR_FILE, "buffers[0]: ");
  assert_non_null(strstr(olx_last_error(), "gone.bin"));
  snprintf(text, sizeof text, form, m.accessors, m.views, m.size_bytes + 1, "with%20space.bin");
  assert_model_refused(scene_folder_write_text(*state, "made.gltf", text), OLX_ERROR_FORMAT,
                       "buffers[0]: it has 140 bytes, not the 141 that its byteLength says");
  snprintf(text, sizeof text, form, m.accessors, m.views, m.size_bytes, "data:text/plain,hello");
  assert_model_refused(scene_folder_write_text(*state, "made.gltf", text), OLX_ERROR_FORMAT,
                       "buffers[0]: its data: URI is not in base64");
}

static void extensions_that_a_file_needs_are_refused_by_name(void **state) {
  static const char *const names[] = {"KHR_texture_basisu", "EXT_texture_avif", "EXT_lights_ies", "ABC_unheard_of"};
  static const char *const remedies[] = {"export the model again with textures in PNG, JPEG or WebP",
                                         "export the model again with textures in PNG, JPEG or WebP", "EXT", "ABC"};
  for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
    gltf_maker m = {0};
    char more[128];
    add_square(&m);
    snprintf(more, sizeof more, ", \"materials\": [{}], \"extensionsRequired\": [\"%s\"]", names[i]);
    assert_model_refused(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", more),
                         OLX_ERROR_UNSUPPORTED, names[i]);
    assert_non_null(strstr(olx_last_error(), remedies[i]));
  }
}

// ---- EXT_meshopt_compression

#define COMPRESSED "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1}, \"indices\": 2}"

static void compressed_views_are_decoded(void **state) {
  static const char *const names[] = {"EXT_meshopt_compression", "KHR_meshopt_compression", "MESHOPT_compression"};
  for (size_t i = 0; i < 3; ++i) {
    float positions[12];
    int8_t normals[16];
    const float up[16] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    char more[80];
    gltf_maker m = {0};
    meshopt_encodeFilterExp(positions, 4, 12, 15, square_positions);
    meshopt_encodeFilterOct(normals, 4, 4, 8, up);
    gltf_add_vertices(&m, names[i], positions, 12, ", \"filter\": \"EXPONENTIAL\"", "", GLTF_FLOAT);
    gltf_add_vertices(&m, names[i], normals, 4, ", \"filter\": \"OCTAHEDRAL\"", "\"normalized\": true, ", GLTF_INT8);
    gltf_add_indices(&m, names[i], i != 0);
    snprintf(more, sizeof more, ", \"extensionsRequired\": [\"%s\"]", names[i]);
    olx_scene *scene = load_model(write_square_model(&m, *state, COMPRESSED, "[{\"mesh\": 0}]", more));
    assert_int_equal(scene->triangle_count, 2);
    for (uint32_t v = 0; v < 4; ++v) {
      const float *p = square_positions + 3 * v;
      assert_near_vector(scene->positions[v], p[0], p[1], p[2], 1e-4f);
      assert_near_vector(scene->normals[v], 0, 0, 1, 1e-6f);
    }
    olx_scene_free(scene);
  }
}

static void broken_compression_is_refused_by_its_view(void **state) {
  const char *name = "EXT_meshopt_compression";
  uint8_t code[512];
  const size_t size_bytes = meshopt_encodeVertexBuffer(code, sizeof code, square_positions, 4, 12);
  const struct {
    uint32_t count, stride;
    const char *mode, *message;
    bool cut;
  } cases[] = {
      {4, 12, "\"mode\": \"SPIRAL\"", "bufferViews[0]: its meshopt mode is not known", false},
      {4, 12, "\"mode\": \"ATTRIBUTES\", \"filter\": \"COLOR\"", "its meshopt filter is not known", false},
      {4, 12, "\"mode\": \"ATTRIBUTES\", \"filter\": \"OCTAHEDRAL\"", "filter does not fit", false},
      {4, 13, "\"mode\": \"ATTRIBUTES\"", "its meshopt byteStride", false},
      {4, 12, "\"mode\": \"TRIANGLES\"", "its meshopt byteStride", false},
      {4, 4, "\"mode\": \"TRIANGLES\"", "not that of triangles", false},
      {100000, 12, "\"mode\": \"ATTRIBUTES\"", "its bytes cannot hold so many elements", false},
      {5, 12, "\"mode\": \"ATTRIBUTES\"", "its meshopt data cannot be decoded", true},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    gltf_maker m = {0};
    char of[64];
    const uint32_t view = gltf_add_compressed(&m, name, code, cases[i].cut ? 20 : size_bytes, cases[i].count,
                                              cases[i].stride, cases[i].mode);
    snprintf(of, sizeof of, "\"bufferView\": %u, ", view);
    gltf_add_accessor(&m, of, 4, GLTF_FLOAT, "VEC3");
    assert_model_refused(write_square_model(&m, *state, "{\"attributes\": {\"POSITION\": 0}}", "[{\"mesh\": 0}]", ""),
                         OLX_ERROR_FORMAT, cases[i].message);
  }
}

static void compressed_views_share_no_bytes(void **state) {
  uint8_t code[512];
  const size_t size_bytes = meshopt_encodeVertexBuffer(code, sizeof code, square_positions, 4, 12);
  gltf_maker m = {0};
  gltf_add_compressed(&m, "EXT_meshopt_compression", code, size_bytes, 4, 12, "\"mode\": \"ATTRIBUTES\"");
  gltf_append(m.views, sizeof m.views,
              ", {\"buffer\": 1, \"byteLength\": 48, \"extensions\": {\"EXT_meshopt_compression\": {\"buffer\": 0, "
              "\"byteLength\": %zu, \"byteStride\": 12, \"count\": 4, \"mode\": \"ATTRIBUTES\"}}}",
              size_bytes);
  gltf_add_accessor(&m, "\"bufferView\": 1, ", 4, GLTF_FLOAT, "VEC3");
  assert_model_refused(write_square_model(&m, *state, "{\"attributes\": {\"POSITION\": 0}}", "[{\"mesh\": 0}]", ""),
                       OLX_ERROR_FORMAT, "bufferViews[1]: it shares its bytes with other compressed views");
}

static void fallback_buffers_are_not_read(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  gltf_append(m.views, sizeof m.views, ", {\"buffer\": 1, \"byteLength\": 48}");
  assert_model_refused(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", ", \"materials\": [{}]"),
                       OLX_ERROR_FORMAT, "bufferViews[4]: its buffer is a fallback");
}

// ---- without memory

static long allocations_left;

static void *allocate_some(void *user, size_t size_bytes) {
  (void)user;
  return allocations_left-- > 0 ? aligned_alloc(64, (size_bytes + 63) & ~(size_t)63) : NULL;
}

static void release_some(void *user, void *memory) {
  (void)user;
  free(memory);
}

static void discard_message(void *user, olx_log_level level, const char *message) {
  (void)user, (void)level, (void)message;
}

// Loading a file with a bit of everything fails with a message wherever memory ends.
static void files_are_refused_when_memory_ends(void **state) {
  const float colors[12] = {1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0},
              tangents[16] = {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
  const uint8_t first_joint[16] = {0};
  const float weights[16] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
              matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, colors, sizeof colors, 4, GLTF_FLOAT, "VEC3", false);
  gltf_add(&m, tangents, sizeof tangents, 4, GLTF_FLOAT, "VEC4", false);
  gltf_add_indices(&m, "EXT_meshopt_compression", true);
  gltf_add(&m, first_joint, sizeof first_joint, 4, GLTF_UINT8, "VEC4", false);
  gltf_add(&m, weights, sizeof weights, 4, GLTF_FLOAT, "VEC4", false);
  gltf_add(&m, matrix, sizeof matrix, 1, GLTF_FLOAT, "MAT4", false);
  const char *path = write_square_model(
      &m, *state,
      "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2, \"COLOR_0\": 4, \"TANGENT\": 5, "
      "\"JOINTS_0\": 7, \"WEIGHTS_0\": 8}, \"indices\": 6, "
      "\"material\": 0}, {\"attributes\": {\"POSITION\": 0}, \"indices\": 3}",
      "[{\"mesh\": 0, \"skin\": 0}]",
      ", \"skins\": [{\"joints\": [0], \"inverseBindMatrices\": 9}], \"materials\": [{\"pbrMetallicRoughness\": "
      "{\"metallicFactor\": 0, \"baseColorTexture\": {\"index\": 0}}, "
      "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 0.5}}, \"normalTexture\": "
      "{\"index\": "
      "0" TRANSFORM("\"scale\": [2, 2]") "}}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": \"" FOUR_COLORS
                                         "\"}]");
  olx_set_hooks(&(olx_hooks){.allocate = allocate_some, .release = release_some, .log = discard_message});
  uint32_t refused = 0;
  olx_result result = OLX_ERROR_MEMORY;
  for (; result == OLX_ERROR_MEMORY && refused < 1000; ++refused) {
    olx_scene *scene = NULL;
    allocations_left = refused;
    result = olx_scene_load(path, &scene);
    olx_scene_free(scene);
  }
  olx_set_hooks(&(olx_hooks){.log = discard_message});
  assert_int_equal(result, OLX_OK);
  assert_true(refused > 30);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(strips_and_fans_become_triangles_that_face_one_way),
      WITH_FOLDER(points_and_lines_are_left_out_and_counted),
      WITH_FOLDER(indices_of_every_width_are_the_same),
      WITH_FOLDER(without_normals_triangles_are_flat),
      WITH_FOLDER(attributes_that_do_not_fit_their_positions_are_left_out),
      WITH_FOLDER(quantised_vertices_are_those_of_floats),
      WITH_FOLDER(normalised_integers_reach_from_minus_one_to_one),
      WITH_FOLDER(sparse_elements_replace_those_of_the_view_or_zeros),
      WITH_FOLDER(accessors_without_data_are_refused_where_they_are_used),
      WITH_FOLDER(zeros_out_of_proportion_to_the_file_are_refused),
      WITH_FOLDER(two_sets_of_texture_coordinates),
      WITH_FOLDER(texture_transforms_scale_turn_and_move),
      WITH_FOLDER(a_texture_transform_may_name_another_set),
      WITH_FOLDER(a_third_kind_of_coordinates_is_warned_about),
      WITH_FOLDER(mirrored_textures_are_warned_about_once),
      WITH_FOLDER(textures_without_their_sampler_are_refused),
      WITH_FOLDER(images_of_other_kinds_are_refused_or_replaced_by_their_source),
      WITH_FOLDER(textures_without_an_image_are_reported_once),
      WITH_FOLDER(images_may_be_webp),
      WITH_FOLDER(damaged_webp_is_left_out_with_a_warning),
      WITH_FOLDER(the_scene_of_the_file_is_the_one_that_is_read),
      WITH_FOLDER(nodes_may_be_nested_but_not_without_end),
      WITH_FOLDER(a_node_puts_its_mesh_in_many_places),
      WITH_FOLDER(instances_may_lack_attributes),
      WITH_FOLDER(instances_that_do_not_fit_are_refused),
      WITH_FOLDER(instances_count_as_nodes),
      WITH_FOLDER(morph_targets_are_warned_about),
      WITH_FOLDER(buffers_lie_in_files_beside_the_model),
      WITH_FOLDER(extensions_that_a_file_needs_are_refused_by_name),
      WITH_FOLDER(compressed_views_are_decoded),
      WITH_FOLDER(broken_compression_is_refused_by_its_view),
      WITH_FOLDER(compressed_views_share_no_bytes),
      WITH_FOLDER(fallback_buffers_are_not_read),
      WITH_FOLDER(files_are_refused_when_memory_ends),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
