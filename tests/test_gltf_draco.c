// Tests glTF primitives that Draco compressed (KHR_draco_mesh_compression): they are the scene that their uncompressed
// form is, and whatever does not fit together is refused by name.
#include "draco_maker.h"
#include "gltf_square.h"

#include <octalux/export.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};

// Adds a view of the square, moved along z; returns its number.
static uint32_t add_stream(gltf_maker *m, float z, bool sequential) {
  float positions[12];
  uint8_t stream[1024];
  for (int i = 0; i < 12; ++i) positions[i] = i % 3 == 2 ? z : square_positions[i];
  const size_t size_bytes = draco_encode(&(draco_mesh){.positions = positions,
                                                       .normals = square_normals,
                                                       .uvs = square_uvs,
                                                       .points = 4,
                                                       .indices = indices,
                                                       .faces = 2,
                                                       .sequential = sequential},
                                         stream, sizeof stream);
  assert_true(size_bytes > 0);
  return gltf_add_view(m, stream, size_bytes, "");
}

// Adds accessors without views: positions, normals, coordinates, indices.
static void add_accessors(gltf_maker *m, uint32_t points, uint32_t corners) {
  gltf_add_accessor(m, "", points, GLTF_FLOAT, "VEC3");
  gltf_add_accessor(m, "", points, GLTF_FLOAT, "VEC3");
  gltf_add_accessor(m, "", points, GLTF_FLOAT, "VEC2");
  gltf_add_accessor(m, "", corners, GLTF_UINT16, "SCALAR");
}

#define ATTRIBUTES "\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2}"
#define IDS "\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2}"
#define COMPRESSED(view) "\"extensions\": {\"KHR_draco_mesh_compression\": {\"bufferView\": " view ", " IDS "}}"
#define REQUIRED ", \"extensionsRequired\": [\"KHR_draco_mesh_compression\"]"
#define TEXTURED                                                                                                       \
  ", \"materials\": [{\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}], \"textures\": "              \
  "[{\"source\": 0}], \"images\": [{\"uri\": \"" FOUR_COLORS "\"}]"

static const char one[] = "{" ATTRIBUTES ", \"indices\": 3, \"material\": 0, " COMPRESSED("0") "}";

static void streams_are_the_square_that_they_were_made_of(void **state) {
  for (int sequential = 0; sequential < 2; ++sequential) {
    gltf_maker m = {0};
    add_stream(&m, 0.0f, sequential);
    add_accessors(&m, 4, 6);
    olx_scene *scene = load_model(write_square_model(&m, *state, one, "[{\"mesh\": 0}]", REQUIRED TEXTURED));
    assert_int_equal(scene->triangle_count, 2);
    for (uint32_t t = 0; t < 2; ++t) assert_near_vector(winding_normal(scene, t), 0, 0, 1, 1e-6f);
    const struct {
      float x, y;
      olx_vec3 color;
    } corners[] = {{0.2f, 0.8f, {1, 0, 0}}, {0.8f, 0.8f, {0, 1, 0}}, {0.2f, 0.2f, {0, 0, 1}}};
    for (int i = 0; i < 3; ++i) {
      const olx_surface surface = look_at_square(scene, corners[i].x, corners[i].y);
      assert_near_vector(surface.shading_normal, 0, 0, 1, 1e-6f);
      const olx_vec3 c = corners[i].color;
      assert_true((surface.base_color.x > 0.5f) == (c.x > 0.5f) && (surface.base_color.y > 0.5f) == (c.y > 0.5f) &&
                  (surface.base_color.z > 0.5f) == (c.z > 0.5f));
    }
    olx_scene_free(scene);
  }
}

// Writers give accessors without views once for all primitives that they describe alike.
static void primitives_that_share_accessors_have_elements_of_their_own(void **state) {
  gltf_maker m = {0};
  add_stream(&m, 0.0f, false);
  add_stream(&m, 3.0f, false);
  add_accessors(&m, 4, 6);
  olx_scene *scene = load_model(write_square_model(
      &m, *state,
      "{" ATTRIBUTES ", \"indices\": 3, " COMPRESSED("0") "}, {" ATTRIBUTES ", \"indices\": 3, " COMPRESSED("1") "}",
      "[{\"mesh\": 0, \"children\": [1]}, {\"mesh\": 0, \"translation\": [0, 0, 10]}]", REQUIRED));
  assert_int_equal(scene->triangle_count, 8);
  const float heights[4] = {0.0f, 3.0f, 10.0f, 13.0f};
  for (uint32_t t = 0; t < 8; ++t) {
    for (uint32_t k = 0; k < 3; ++k) {
      assert_near_number(scene->positions[scene->indices[3 * t + k]].z, heights[t / 2], 1e-6f);
    }
  }
  olx_scene_free(scene);
}

// FBX2glTF leaves the numbers that a mesh had before it was compressed. Draco leaves out triangles without area.
static void the_numbers_of_points_and_triangles_are_the_streams(void **state) {
  for (int sequential = 0; sequential < 2; ++sequential) {
    for (uint32_t claimed = 3; claimed <= 4 + 2 * !sequential; ++claimed) {
      gltf_maker m = {0};
      add_stream(&m, 0.0f, sequential);
      add_stream(&m, 3.0f, sequential);
      add_accessors(&m, claimed, claimed == 4 ? 9 : 6);
      olx_scene *scene =
          load_model(write_square_model(&m, *state,
                                        "{" ATTRIBUTES ", \"indices\": 3, " COMPRESSED(
                                            "0") "}, {" ATTRIBUTES ", \"indices\": 3, " COMPRESSED("1") "}",
                                        "[{\"mesh\": 0}]", REQUIRED));
      assert_int_equal(scene->vertex_count, 8);
      assert_int_equal(scene->triangle_count, 4);
      for (uint32_t t = 0; t < 4; ++t) assert_near_vector(winding_normal(scene, t), 0, 0, 1, 1e-6f);
      olx_scene_free(scene);
    }
  }
}

static void an_uncompressed_form_is_read_instead(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  const uint32_t junk = gltf_add_view(&m, "DRACO?", 6, "");
  char primitive[300];
  snprintf(primitive, sizeof primitive,
           "{" ATTRIBUTES ", \"indices\": 3, \"extensions\": {\"KHR_draco_mesh_compression\": {\"bufferView\": %u, " IDS
           "}}}",
           junk);
  olx_scene *scene = load_model(write_square_model(&m, *state, primitive, "[{\"mesh\": 0}]", ""));
  assert_int_equal(scene->triangle_count, 2);
  olx_scene_free(scene);
}

// ---- Refusals

static void assert_refused(void *state, const gltf_maker *m, const char *primitive, const char *part) {
  assert_model_refused(write_square_model(m, state, primitive, "[{\"mesh\": 0}]", ", \"materials\": [{}]"),
                       OLX_ERROR_FORMAT, part);
}

static void primitives_that_do_not_fit_their_stream_are_refused(void **state) {
#define WITH(members, extension) "{" members ", \"extensions\": {\"KHR_draco_mesh_compression\": {" extension "}}}"
  const struct {
    const char *primitive, *message;
  } cases[] = {
      {WITH(ATTRIBUTES ", \"indices\": 3", "\"bufferView\": 9, " IDS), "bufferView of its Draco compression"},
      {WITH(ATTRIBUTES ", \"indices\": 3, \"mode\": 5", "\"bufferView\": 0, " IDS), "not made of separate triangles"},
      {WITH(ATTRIBUTES, "\"bufferView\": 0, " IDS), "other numbers of triangles or points"},
      {WITH(ATTRIBUTES ", \"indices\": 3", "\"bufferView\": 0, \"attributes\": {\"NORMAL\": 1}"), "has no positions"},
      {WITH("\"attributes\": {\"POSITION\": 0}, \"indices\": 3", "\"bufferView\": 0, " IDS),
       "names an attribute that it does not have"},
      {WITH("\"attributes\": {\"POSITION\": 0, \"_A\": 1, \"_B\": 2}, \"indices\": 3",
            "\"bufferView\": 0, \"attributes\": {\"POSITION\": 0, \"_A\": 1, \"_B\": 2, \"_C\": 3}"),
       "names an attribute that it does not have"},
      {WITH(ATTRIBUTES ", \"indices\": 3",
            "\"bufferView\": 0, \"attributes\": {\"POSITION\": \"a\", \"NORMAL\": 1, \"TEXCOORD_0\": 2}"),
       "by something else than a number"},
      {WITH(ATTRIBUTES ", \"indices\": 3",
            "\"bufferView\": 0, \"attributes\": {\"POSITION\": 77, \"NORMAL\": 1, \"TEXCOORD_0\": 2}"),
       "accessors[0]: a Draco stream has no such elements"},
      {"{" ATTRIBUTES ", \"indices\": 3, " COMPRESSED("0") "}, {" ATTRIBUTES "}",
       "only in another primitive's Draco stream"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    gltf_maker m = {0};
    add_stream(&m, 0.0f, false);
    add_accessors(&m, 4, 6);
    assert_refused(*state, &m, cases[i].primitive, cases[i].message);
  }
}

// Adds a view of one triangle whose stream has four points, more than corners.
static void add_stream_with_an_unused_point(gltf_maker *m) {
  uint8_t stream[1024];
  const draco_mesh mesh = {.positions = square_positions,
                           .normals = square_normals,
                           .uvs = square_uvs,
                           .points = 4,
                           .indices = indices,
                           .faces = 1,
                           .sequential = true};
  const size_t size_bytes = draco_encode(&mesh, stream, sizeof stream);
  assert_true(size_bytes > 0);
  gltf_add_view(m, stream, size_bytes, "");
}

static void counts_that_no_stream_can_have_are_refused(void **state) {
  gltf_maker more = {0}, fewer = {0};
  add_stream(&more, 0.0f, false);
  add_accessors(&more, 400, 6);
  assert_refused(*state, &more, one, "other numbers of triangles or points");
  add_stream_with_an_unused_point(&fewer);
  add_accessors(&fewer, 3, 3);
  assert_refused(*state, &fewer, one, "its Draco stream cannot be decoded");
}

// Bytes 5 to 10 are the version, the kind of geometry, the method, and flags; then come the kind of traversal, the
// number of vertices and that of faces.
static void streams_with_a_wrong_header_are_refused(void **state) {
  const struct {
    uint32_t place;
    uint8_t byte;
    const char *message;
  } cases[] = {{0, 'd', "its bytes are no Draco stream"},
               {5, 1, "not of version 2.2"},
               {6, 3, "not of version 2.2"},
               {7, 0, "no triangles"},
               {8, 7, "header"},
               {10, 0x80, "metadata"},
               {13, 3, "other numbers of triangles"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    gltf_maker m = {0};
    add_stream(&m, 0.0f, false);
    add_accessors(&m, 4, 6);
    m.bytes[cases[i].place] = cases[i].byte;
    assert_refused(*state, &m, one, cases[i].message);
  }
  const uint8_t greedy[] = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 0, 4, 0xFF, 0xFF, 0xFF, 0x7F};
  gltf_maker m = {0};
  gltf_add_view(&m, greedy, sizeof greedy, "");
  add_accessors(&m, 4, 6);
  assert_refused(*state, &m, one, "its bytes cannot hold so many triangles");
}

// A stream that is cut or damaged anywhere is refused, or is a square with other numbers in it.
static void damaged_streams_are_refused_or_read(void **state) {
  uint32_t refused = 0;
  for (int sequential = 0; sequential < 2; ++sequential) {
    gltf_maker whole = {0};
    add_stream(&whole, 0.0f, sequential);
    add_accessors(&whole, 4, 6);
    for (size_t i = 0; i < whole.size_bytes; ++i) {
      for (int damage = 0; damage < 3; ++damage) {
        gltf_maker m = whole;
        m.bytes[i] = (uint8_t)(damage == 2 ? 0xFF : m.bytes[i] ^ (damage ? 0x80 : 0x01));
        olx_scene *scene = NULL;
        const olx_result result =
            olx_scene_load(write_square_model(&m, *state, one, "[{\"mesh\": 0}]", TEXTURED), &scene);
        assert_true(result == OLX_OK ? scene != NULL : olx_last_error()[0] != 0);
        if (result == OLX_OK) assert_true(scene->triangle_count <= 2);
        refused += result != OLX_OK;
        olx_scene_free(scene);
      }
    }
  }
  assert_true(refused > 30);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(streams_are_the_square_that_they_were_made_of),
      WITH_FOLDER(primitives_that_share_accessors_have_elements_of_their_own),
      WITH_FOLDER(the_numbers_of_points_and_triangles_are_the_streams),
      WITH_FOLDER(an_uncompressed_form_is_read_instead),
      WITH_FOLDER(primitives_that_do_not_fit_their_stream_are_refused),
      WITH_FOLDER(counts_that_no_stream_can_have_are_refused),
      WITH_FOLDER(streams_with_a_wrong_header_are_refused),
      WITH_FOLDER(damaged_streams_are_refused_or_read),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
