// Tests what glTF says of materials and of how vertices change them: colours and alpha of vertices, tangents,
// KHR_materials_specular, and cooked scenes that keep these. Each file is made here and has one feature.
#include "data_uris.h"
#include "gltf_square.h"
#include "scene/bvh.h"
#include "scene/scene_build.h"

#include <octalux/export.h>
#include <octalux/render.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// ---- colours, tangents, materials

static void vertex_colours_multiply_the_base_colour(void **state) {
  const float colors[12] = {1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, colors, sizeof colors, 4, GLTF_FLOAT, "VEC3", false);
  const char *more = ", \"materials\": [{\"name\": \"m\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, 0.5, "
                     "0.5, 1], \"metallicFactor\": 0}}]";
  const char *path = write_square_model(&m, *state, square_with(", \"COLOR_0\": 4"), "[{\"mesh\": 0}]", more);
  olx_scene *scene = load_model(path);
  assert_near_vector(look_at_square(scene, 0.5f, 0.25f).base_color, 0.375f, 0.125f, 0, 1e-5f);
  olx_scene_free(scene);
  // A colour in the description replaces vertex colours.
  scene = load_model(scene_folder_write_text(
      *state, "made.json", "{\"model\": \"made.gltf\", \"materials\": {\"m\": {\"base_color\": [0.25, 0.25, 0.25]}}}"));
  assert_near_vector(look_at_square(scene, 0.5f, 0.25f).base_color, 0.25f, 0.25f, 0.25f, 1e-5f);
  olx_scene_free(scene);
}

static void white_vertices_are_as_good_as_none(void **state) {
  const uint8_t white[16] = {255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, white, sizeof white, 4, GLTF_UINT8, "VEC4", true);
  olx_scene *scene = load_model(
      write_square_model(&m, *state, square_with(", \"COLOR_0\": 4"), "[{\"mesh\": 0}]", ", \"materials\": [{}]"));
  assert_null(scene->colors);
  assert_false(scene->materials[0].vertex_colors);
  olx_scene_free(scene);
}

static void the_alpha_of_vertices_masks(void **state) {
  const uint16_t colors[16] = {65535, 65535, 65535, 0,     65535, 65535, 65535, 65535,
                               65535, 65535, 65535, 65535, 65535, 65535, 65535, 0};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, colors, sizeof colors, 4, GLTF_UINT16, "VEC4", true);
  olx_scene *scene = load_model(write_square_model(&m, *state, square_with(", \"COLOR_0\": 4"), "[{\"mesh\": 0}]",
                                                   ", \"materials\": [{\"alphaMode\": \"MASK\"}]"));
  const olx_ray absent = {{0.25f, 0.5f, 1.0f}, {0.0f, 0.0f, -1.0f}, 0.0f, INFINITY};
  assert_int_equal(olx_bvh_intersect(scene->bvh, &absent).triangle, OLX_NO_HIT);
  look_at_square(scene, 0.75f, 0.5f);
  olx_scene_free(scene);
}

// A normal map of one texel, (1, 0.5, 0.5), whose normals point along the tangent.
#define SIDEWAYS "data:image/png;base64,AAACAAAAAAAAAAAAAQABACAogID//w=="
#define BUMPED                                                                                                         \
  ", \"materials\": [{\"normalTexture\": {\"index\": 0}}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": "   \
  "\"" SIDEWAYS "\"}]"

static void tangents_of_the_file_go_before_texture_coordinates(void **state) {
  const float tangents[16] = {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, tangents, sizeof tangents, 4, GLTF_FLOAT, "VEC4", false);
  olx_scene *scene = load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", BUMPED));
  assert_true(look_at_square(scene, 0.5f, 0.25f).shading_normal.x > 0.99f);
  olx_scene_free(scene);
  scene = load_model(write_square_model(&m, *state, square_with(", \"TANGENT\": 4"), "[{\"mesh\": 0}]", BUMPED));
  assert_true(look_at_square(scene, 0.5f, 0.25f).shading_normal.y > 0.99f);
  olx_scene_free(scene);
  scene = load_model(write_square_model(
      &m, *state, square_with(", \"TANGENT\": 4"),
      "[{\"mesh\": 0, \"rotation\": [0, 0, 0.70710678, 0.70710678], \"translation\": [1, 0, 0]}]", BUMPED));
  assert_true(look_at_square(scene, 0.5f, 0.25f).shading_normal.x < -0.99f);
  olx_scene_free(scene);
}

// A normal map of one texel, (0.5, 1, 0.5), whose normals point along the bitangent, which is reversed where the
// texture is mirrored.
#define UPWARDS "data:image/png;base64,AAACAAAAAAAAAAAAAQABACAogP+A/w=="

static void bitangents_lie_on_the_side_that_tangents_say(void **state) {
  float tangents[16];
  for (int side = -1; side <= 1; side += 2) {
    for (int v = 0; v < 4; ++v) memcpy(tangents + 4 * v, (const float[4]){1, 0, 0, (float)side}, 4 * sizeof(float));
    gltf_maker m = {0};
    add_square(&m);
    gltf_add(&m, tangents, sizeof tangents, 4, GLTF_FLOAT, "VEC4", false);
    const char *more = ", \"materials\": [{\"normalTexture\": {\"index\": 0}}], \"textures\": [{\"source\": 0}], "
                       "\"images\": [{\"uri\": \"" UPWARDS "\"}]";
    olx_scene *scene =
        load_model(write_square_model(&m, *state, square_with(", \"TANGENT\": 4"), "[{\"mesh\": 0}]", more));
    assert_true((float)side * look_at_square(scene, 0.5f, 0.25f).shading_normal.y > 0.99f);
    olx_scene_free(scene);
    scene = load_model(write_square_model(&m, *state, square_with(", \"TANGENT\": 4"),
                                          "[{\"mesh\": 0, \"scale\": [1, -1, 1], \"translation\": [0, 1, 0]}]", more));
    assert_true((float)side * look_at_square(scene, 0.5f, 0.25f).shading_normal.y < -0.99f);
    olx_scene_free(scene);
  }
}

static void assert_not_warned(const olx_scene *scene, const char *part) {
  for (uint32_t i = 0; i < scene->warning_count; ++i) {
    if (strstr(scene->warnings[i], part)) fail_msg("a warning says \"%s\"", scene->warnings[i]);
  }
}

// Returns a square whose material "dull" has KHR_materials_specular with these members. Texture 0 has four colours.
static olx_scene *load_specular(const scene_folder *folder, const char *surface, const char *members) {
  gltf_maker m = {0};
  char more[1024];
  add_square(&m);
  snprintf(more, sizeof more,
           ", \"materials\": [{\"name\": \"dull\", \"pbrMetallicRoughness\": {%s}, \"extensions\": "
           "{\"KHR_materials_specular\": {%s}}}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": "
           "\"" FOUR_COLORS "\"}], \"extensionsUsed\": [\"KHR_materials_specular\"]",
           surface, members);
  return load_model(write_square_model(&m, folder, square_with(""), "[{\"mesh\": 0}]", more));
}

static void specular_factors_are_weights(void **state) {
  olx_scene *scene = load_specular(*state, "", "\"specularFactor\": 0.25");
  assert_near_number(scene->materials[0].specular_weight, 0.25f, 1e-6f);
  assert_not_warned(scene, "specular");
  olx_scene_free(scene);
}

static void specular_colours_count_by_their_luminance(void **state) {
  const struct {
    const char *members;
    float weight;
  } cases[] = {{"\"specularFactor\": 0.25, \"specularColorFactor\": [1, 0, 0]", 0.25f * 0.2126f},
               {"\"specularColorFactor\": [0.5, 0.5, 0.5]", 0.5f},
               {"\"specularFactor\": 0.5, \"specularColorFactor\": [1.5, 1.5, 1.5]", 0.75f},
               // F0 is 1 in blue, 25 times that of the weight 1, and more does not add to it.
               {"\"specularColorFactor\": [0, 0, 1e6]", 1.0f}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    olx_scene *scene = load_specular(*state, "", cases[i].members);
    assert_near_number(scene->materials[0].specular_weight, cases[i].weight, 1e-6f);
    assert_model_warned(scene,
                        "1 material has a specular colour: its luminance, up to 1, scales reflections at all angles "
                        "(dull)");
    olx_scene_free(scene);
  }
}

// Finds the specular weights, roughness and metalness in the middles of the texels: upper left, upper right, lower
// left, lower right.
static void assert_surfaces(const olx_scene *scene, const float weights[4], const float roughness[4],
                            const float metallic[4]) {
  for (int i = 0; i < 4; ++i) {
    const olx_surface s = look_at_square(scene, i % 2 ? 0.75f : 0.25f, i < 2 ? 0.75f : 0.25f);
    assert_near_number(s.bsdf.dielectric_weight, weights[i], 2e-3f);
    assert_near_number(s.roughness, roughness[i], 2e-3f);
    assert_near_number(s.metallic, metallic[i], 2e-3f);
  }
}

#define ROUGH "\"roughnessFactor\": 0.5, \"metallicFactor\": 0.25"
static const float half_rough[4] = {0.5f, 0.5f, 0.5f, 0.5f}, quarter_metallic[4] = {0.25f, 0.25f, 0.25f, 0.25f};

static void specular_textures_are_weights_texel_by_texel(void **state) {
  olx_scene *scene = load_specular(*state, ROUGH, "\"specularFactor\": 0.75, \"specularTexture\": {\"index\": 0}");
  assert_surfaces(scene, (const float[4]){0.75f, 0.75f, 0.75f, 0}, half_rough, quarter_metallic);
  assert_not_warned(scene, "specular");
  assert_int_equal(scene->texture_count, 1);
  olx_scene_free(scene);
  scene =
      load_specular(*state, ROUGH, "\"specularColorFactor\": [0.5, 1, 10], \"specularColorTexture\": {\"index\": 0}");
  assert_surfaces(scene, (const float[4]){0.1063f, 0.7152f, 0.722f, 1}, half_rough, quarter_metallic);
  assert_model_warned(scene, "a specular colour");
  olx_scene_free(scene);
}

// Both textures, that of roughness in G and metalness in B, and the factors; in the model, cooked and exported.
static void specular_textures_join_that_of_roughness(void **state) {
  const float weights[4] = {0.1063f, 0.3576f, 0.0361f, 0}, roughness[4] = {0, 0.5f, 0, 0.5f},
              metallic[4] = {0, 0, 0.25f, 0.25f};
  olx_scene *scene = load_specular(*state, ROUGH ", \"metallicRoughnessTexture\": {\"index\": 0}",
                                   "\"specularFactor\": 0.5, \"specularTexture\": {\"index\": 0}, "
                                   "\"specularColorTexture\": {\"index\": 0}");
  char cooked[600], exported[600];
  snprintf(cooked, sizeof cooked, "%s/made.olxs", ((scene_folder *)*state)->path);
  snprintf(exported, sizeof exported, "%s/made.glb", ((scene_folder *)*state)->path);
  assert_surfaces(scene, weights, roughness, metallic);
  assert_int_equal(scene->texture_count, 1);
  assert_int_equal(olx_scene_cook(scene, cooked, NULL), OLX_OK);
  assert_int_equal(olx_export_scene(scene, exported, NULL), OLX_OK);
  const uint64_t hash = scene->hash;
  olx_scene_free(scene);
  scene = load_model(cooked);
  assert_true(scene->hash == hash);
  assert_surfaces(scene, weights, roughness, metallic);
  olx_scene_free(scene);
  scene = load_model(exported);
  assert_surfaces(scene, weights, roughness, metallic);
  olx_scene_free(scene);
}

// ---- partial opacity

// Returns a square whose material "pane" has these members.
static olx_scene *load_pane(const scene_folder *folder, const char *members) {
  gltf_maker m = {0};
  char more[1024];
  add_square(&m);
  snprintf(more, sizeof more,
           ", \"materials\": [{\"name\": \"pane\", %s}], \"textures\": [{\"source\": 0}], \"images\": "
           "[{\"uri\": \"" FOUR_COLORS "\"}]",
           members);
  return load_model(write_square_model(&m, folder, square_with(""), "[{\"mesh\": 0}]", more));
}

// Checks a pane in the model, cooked and exported.
static void expect_in_all_forms(scene_folder *folder, const char *members,
                                void (*check)(const olx_scene *scene, const float *expected), const float *expected) {
  olx_scene *scene = load_pane(folder, members);
  char cooked[600], exported[600];
  snprintf(cooked, sizeof cooked, "%s/made.olxs", folder->path);
  snprintf(exported, sizeof exported, "%s/made.glb", folder->path);
  assert_model_warned(scene, "1 material has partial opacity");
  assert_int_equal(olx_scene_cook(scene, cooked, NULL), OLX_OK);
  assert_int_equal(olx_export_scene(scene, exported, NULL), OLX_OK);
  for (uint32_t form = 0; form < 3; form++) {
    check(scene, expected);
    olx_scene_free(scene);
    scene = form < 2 ? load_model(form == 0 ? cooked : exported) : NULL;
  }
}

static void expect_opacity(const olx_scene *scene, const float *alpha) {
  assert_true(scene->materials[0].blended);
  assert_near_number(scene->materials[0].alpha, *alpha, 1e-6f);
  assert_near_number(scene->materials[0].alpha_cutoff, 0.5f, 0.0f);
}

// Alpha of BLEND, and what KHR_materials_transmission lets through, tinted by the base colour; in the model, cooked and
// exported.
static void light_passes_by_alpha_and_transmission(void **state) {
  const struct {
    const char *members;
    float alpha;
  } cases[] = {
      {"\"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 0.3]}", 0.3f},
      {"\"pbrMetallicRoughness\": {\"metallicFactor\": 0}, \"extensions\": {\"KHR_materials_transmission\": "
       "{\"transmissionFactor\": 0.75}}",
       0.25f},
      {"\"pbrMetallicRoughness\": {\"metallicFactor\": 0.5}, \"extensions\": {\"KHR_materials_transmission\": "
       "{\"transmissionFactor\": 0.75}}",
       0.625f},
      {"\"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"baseColorFactor\": [0.2, 0.5, 0.5, 1]}, "
       "\"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}}",
       0.6f},
      {"\"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"baseColorFactor\": [1, 1, "
       "1, 0.5]}, \"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 0.5}}",
       0.25f}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    expect_in_all_forms(*state, cases[i].members, expect_opacity, &cases[i].alpha);
  }
}

#define TRANSMITS(factor) ", \"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": " factor "}}"

// Finds the opacity in the middles of the texels: upper left, upper right, lower left, lower right.
static void expect_opacities(const olx_scene *scene, const float *opacities) {
  for (int i = 0; i < 4; ++i) {
    const float x = i % 2 ? 0.75f : 0.25f, y = i < 2 ? 0.75f : 0.25f;
    const float opacity = x > y ? olx_surface_opacity(scene, 0, x - y, y) : olx_surface_opacity(scene, 1, x, y - x);
    assert_near_number(opacity, opacities[i], 3e-3f);
  }
}

// Three texels have a mean of 1/3, the last one is white with alpha 0; in B, which is metalness, two are 0 and two 1.
// In the model, cooked and exported.
static void glass_is_as_opaque_as_its_texels_are_dark_or_metal(void **state) {
  const struct {
    const char *members;
    float opacities[4];
  } cases[] = {
      {"\"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"baseColorTexture\": {\"index\": 0}}" TRANSMITS("0.75"),
       {0.75f, 0.75f, 0.75f, 0.25f}},
      {"\"pbrMetallicRoughness\": {\"metallicFactor\": 0.5, \"baseColorFactor\": [0.5, 1, 1, 1], "
       "\"baseColorTexture\": {\"index\": 0}}" TRANSMITS("1"),
       {1 - 0.25f / 3, 1 - 0.5f / 3, 1 - 0.5f / 3, 1 - 1.25f / 3}},
      {"\"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"baseColorFactor\": [1, 1, 1, "
       "0.5], \"baseColorTexture\": {\"index\": 0}}" TRANSMITS("1"),
       {1.0f / 3, 1.0f / 3, 1.0f / 3, 0}},
      {"\"pbrMetallicRoughness\": {\"metallicRoughnessTexture\": {\"index\": 0}}" TRANSMITS("0.75"),
       {0.25f, 0.25f, 1, 1}},
      {"\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}, \"metallicRoughnessTexture\": {\"index\": "
       "0}}" TRANSMITS("0.75"),
       {0.75f, 0.75f, 1, 1}},
      {"\"pbrMetallicRoughness\": {\"metallicFactor\": 0.5, \"baseColorTexture\": {\"index\": 0}, "
       "\"metallicRoughnessTexture\": {\"index\": 0" TRANSFORM("\"scale\": [2, 2]") "}}" TRANSMITS("1"),
       {5.0f / 6, 5.0f / 6, 5.0f / 6, 0.5f}}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    expect_in_all_forms(*state, cases[i].members, expect_opacities, cases[i].opacities);
  }
}

// A description that replaces the colour keeps the opacity.
static void descriptions_keep_the_opacity_of_glass(void **state) {
  olx_scene_free(load_pane(*state, "\"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"baseColorTexture\": "
                                   "{\"index\": 0}}" TRANSMITS("0.75")));
  olx_scene *scene = load_model(scene_folder_write_text(
      *state, "made.json", "{\"model\": \"made.gltf\", \"materials\": {\"pane\": {\"base_color\": [0, 0, 0]}}}"));
  expect_opacities(scene, (const float[4]){0.75f, 0.75f, 0.75f, 0.25f});
  olx_scene_free(scene);
}

// A second material of the same glass takes no texture of its own; one that transmits less does.
static void equal_glass_shares_a_texture(void **state) {
  static const char *const factors[] = {"0.75", "0.5"};
  for (uint32_t i = 0; i < 2; ++i) {
    gltf_maker m = {0};
    char more[1024], primitives[600];
    add_square(&m);
    const char *pane = "{\"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"baseColorTexture\": {\"index\": 0}}";
    snprintf(more, sizeof more,
             ", \"materials\": [%s" TRANSMITS("0.75") "}, %s" TRANSMITS("%s") "}], \"textures\": [{\"source\": 0}], "
                                                                              "\"images\": [{\"uri\": \"" FOUR_COLORS
                                                                              "\"}]",
             pane, pane, factors[i]);
    snprintf(primitives, sizeof primitives, "%s, {\"attributes\": {\"POSITION\": 0}, \"indices\": 3, \"material\": 1}",
             square_with(""));
    olx_scene *scene = load_model(write_square_model(&m, *state, primitives, "[{\"mesh\": 0}]", more));
    const olx_material *a = &scene->materials[0], *b = &scene->materials[1];
    assert_int_equal(scene->texture_count, 2 + i);
    assert_int_equal(b->base_color_texture, a->base_color_texture + i);
    olx_scene_free(scene);
  }
}

static void metal_transmits_nothing(void **state) {
  static const char *const metals[] = {"\"alphaMode\": \"OPAQUE\"" TRANSMITS("1"),
                                       "\"pbrMetallicRoughness\": {\"metallicFactor\": 1}" TRANSMITS("1")};
  for (size_t i = 0; i < sizeof metals / sizeof *metals; ++i) {
    olx_scene *scene = load_pane(*state, metals[i]);
    assert_false(scene->materials[0].blended);
    assert_near_number(scene->materials[0].alpha, 1.0f, 0.0f);
    assert_not_warned(scene, "transmission");
    olx_scene_free(scene);
  }
}

#define DIELECTRIC "\"pbrMetallicRoughness\": {\"metallicFactor\": 0}, "

static void masks_lamps_and_textures_of_transmission_stay_opaque(void **state) {
  const struct {
    const char *members;
    float cutoff;
  } cases[] = {{DIELECTRIC "\"alphaMode\": \"MASK\", \"alphaCutoff\": 0.25" TRANSMITS("1"), 0.25f},
               {DIELECTRIC "\"emissiveFactor\": [1, 0.5, 0]" TRANSMITS("1"), 0.0f},
               {DIELECTRIC "\"doubleSided\": true" TRANSMITS("1, \"transmissionTexture\": {\"index\": 0}"), 0.0f}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    olx_scene *scene = load_pane(*state, cases[i].members);
    assert_false(scene->materials[0].blended);
    assert_near_number(scene->materials[0].alpha_cutoff, cases[i].cutoff, 0.0f);
    expect_opacities(scene, (const float[4]){1, 1, 1, 1});
    assert_model_warned(scene, "1 material has transmission beside emission, a mask or a texture of it");
    olx_scene_free(scene);
  }
}

static void descriptions_replace_specular_textures(void **state) {
  olx_scene_free(load_specular(*state, ROUGH ", \"metallicRoughnessTexture\": {\"index\": 0}",
                               "\"specularTexture\": {\"index\": 0}"));
  olx_scene *scene = load_model(scene_folder_write_text(
      *state, "made.json", "{\"model\": \"made.gltf\", \"materials\": {\"dull\": {\"specular\": 0.5}}}"));
  assert_surfaces(scene, half_rough, (const float[4]){0, 0.5f, 0, 0.5f}, (const float[4]){0, 0, 0.25f, 0.25f});
  olx_scene_free(scene);
}

static void specular_textures_that_lie_elsewhere_are_left_out(void **state) {
  olx_scene *scene =
      load_specular(*state, ROUGH ", \"metallicRoughnessTexture\": {\"index\": 0}",
                    "\"specularFactor\": 0.5, \"specularTexture\": {\"index\": 0" TRANSFORM("\"scale\": [2, 2]") "}");
  assert_surfaces(scene, half_rough, (const float[4]){0, 0.5f, 0, 0.5f}, (const float[4]){0, 0, 0.25f, 0.25f});
  assert_model_warned(scene,
                      "1 material has specular textures with other coordinates than the roughness texture: they are "
                      "left out (dull)");
  olx_scene_free(scene);
}

static void specular_textures_that_cannot_be_read_leave_the_factors(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene = load_model(write_square_model(
      &m, *state, square_with(""), "[{\"mesh\": 0}]",
      ", \"materials\": [{\"extensions\": {\"KHR_materials_specular\": {\"specularFactor\": 0.5, "
      "\"specularColorFactor\": [0.5, 0.5, 0.5], \"specularTexture\": {\"index\": 0}}}}], \"textures\": [{\"source\": "
      "0}], \"images\": [{\"uri\": \"missing.png\"}]"));
  assert_near_number(look_at_square(scene, 0.5f, 0.5f).bsdf.dielectric_weight, 0.25f, 1e-6f);
  assert_model_warned(scene, "texture left out");
  olx_scene_free(scene);
}

// Returns a square with KHR_materials_pbrSpecularGlossiness and these members, in a file that also says what a reader
// without the extension would see: a green metal. Texture 0 has four colours.
static olx_scene *load_glossy(const scene_folder *folder, const char *members) {
  gltf_maker m = {0};
  char more[1024];
  add_square(&m);
  snprintf(more, sizeof more,
           ", \"materials\": [{\"name\": \"old\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0, 1, 0, 1]}, "
           "\"extensions\": {\"KHR_materials_pbrSpecularGlossiness\": {%s}}}], \"textures\": [{\"source\": 0}], "
           "\"images\": [{\"uri\": \"" FOUR_COLORS "\"}], \"extensionsUsed\": "
           "[\"KHR_materials_pbrSpecularGlossiness\"], \"extensionsRequired\": "
           "[\"KHR_materials_pbrSpecularGlossiness\"]",
           members);
  return load_model(write_square_model(&m, folder, square_with(""), "[{\"mesh\": 0}]", more));
}

// The diffuse reflectance and F0 of a surface, as it reflects light along its normal.
static void assert_reflectances(olx_surface s, olx_vec3 diffuse, olx_vec3 specular, float tolerance) {
  const float dielectric = 0.04f * s.bsdf.dielectric_weight;
  const olx_vec3 of_dielectric = olx_scale(s.base_color, (1.0f - s.metallic) * (1.0f - dielectric));
  const olx_vec3 f0 = olx_mix3(olx_splat(dielectric), s.base_color, s.metallic);
  assert_near_vector(of_dielectric, diffuse.x, diffuse.y, diffuse.z, tolerance);
  assert_near_vector(f0, specular.x, specular.y, specular.z, tolerance);
}

static void glossiness_and_the_reflectances_of_factors_are_kept(void **state) {
  const struct {
    float diffuse[3], specular[3];
  } cases[] = {{{0.8f, 0.1f, 0.3f}, {0, 0, 0}},
               {{0.8f, 0.1f, 0.3f}, {0.04f, 0.04f, 0.04f}},
               {{0.5f, 0.5f, 0.5f}, {0.02f, 0.02f, 0.02f}},
               {{0.3f, 0.3f, 0.3f}, {0.2f, 0.2f, 0.2f}},
               {{0, 0, 0}, {0.9f, 0.6f, 0.2f}}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    const float *d = cases[i].diffuse, *s = cases[i].specular;
    char members[200];
    snprintf(members, sizeof members,
             "\"diffuseFactor\": [%g, %g, %g, 1], \"specularFactor\": [%g, %g, %g], \"glossinessFactor\": 0.25",
             (double)d[0], (double)d[1], (double)d[2], (double)s[0], (double)s[1], (double)s[2]);
    olx_scene *scene = load_glossy(*state, members);
    const olx_surface surface = look_at_square(scene, 0.5f, 0.25f);
    assert_reflectances(surface, olx_scale(olx_load3(d), 1.0f - olx_max3(olx_load3(s))), olx_load3(s), 1e-4f);
    assert_near_number(surface.roughness, 0.75f, 1e-6f);
    assert_not_warned(scene, "ignored");
    olx_scene_free(scene);
  }
}

// Upper left red, upper right green, lower left blue, lower right white with alpha 0.
static void glossiness_textures_are_converted_texel_by_texel(void **state) {
  const float half_way[2] = {0.25f, 0.75f};
  olx_scene *scene = load_glossy(*state, "\"diffuseFactor\": [0.5, 0.5, 0.5, 1], \"specularFactor\": [0.04, 0.04, "
                                         "0.04], \"diffuseTexture\": {\"index\": 0}");
  assert_near_vector(look_at_square(scene, 0.25f, 0.75f).base_color, 0.5f, 0, 0, 1e-4f);
  assert_int_equal(scene->texture_count, 1);
  olx_scene_free(scene);
  // The white texel reflects a quarter, more than a dielectric does, and its alpha, the glossiness, is 0.
  scene = load_glossy(*state, "\"diffuseFactor\": [0.5, 0.5, 0.5, 1], \"specularFactor\": [0.25, 0.25, 0.25], "
                              "\"glossinessFactor\": 0.5, \"specularGlossinessTexture\": {\"index\": 0}");
  for (int i = 0; i < 4; ++i) {
    const olx_surface s = look_at_square(scene, half_way[i % 2], half_way[i < 2]);
    assert_near_number(s.roughness, i == 3 ? 1.0f : 0.5f, 3e-3f);
  }
  assert_reflectances(look_at_square(scene, 0.75f, 0.25f), olx_splat(0.375f), olx_splat(0.25f), 6e-3f);
  assert_int_equal(scene->texture_count, 2);
  olx_scene_free(scene);
}

static void surfaces_without_a_material_are_reported(void **state) {
  const char *plain = "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2}, \"indices\": 3}";
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene = load_model(write_square_model(&m, *state, plain, "[{\"mesh\": 0}]", ""));
  assert_near_number(look_at_square(scene, 0.5f, 0.25f).metallic, 1.0f, 0.0f);
  assert_model_warned(scene, "surfaces without a material are white metal");
  olx_scene_free(scene);
  scene = load_model(scene_folder_write_text(*state, "made.json",
                                             "{\"model\": \"made.gltf\", \"materials\": {\"*\": {\"metallic\": 0}}}"));
  assert_near_number(look_at_square(scene, 0.5f, 0.25f).metallic, 0.0f, 0.0f);
  olx_scene_free(scene);
  m = (gltf_maker){0};
  add_square(&m);
  scene = load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", ", \"materials\": [{}]"));
  assert_not_warned(scene, "without a material");
  olx_scene_free(scene);
}

static void numbers_of_extensions_outside_their_range_are_clamped_with_a_warning(void **state) {
  static const char *const extensions[] = {
      "\"KHR_materials_emissive_strength\": {\"emissiveStrength\": -1}",
      "\"KHR_materials_specular\": {\"specularFactor\": 1.5}",
      "\"KHR_materials_specular\": {\"specularColorFactor\": [1, -1, 1]}",
      "\"KHR_materials_transmission\": {\"transmissionFactor\": -0.5}",
      "\"KHR_materials_pbrSpecularGlossiness\": {\"glossinessFactor\": 2}",
      "\"KHR_materials_pbrSpecularGlossiness\": {\"specularFactor\": [2, 0, 0]}",
      "\"KHR_materials_pbrSpecularGlossiness\": {\"diffuseFactor\": [0.5, 0.5, -1, 1]}",
  };
  for (size_t i = 0; i < sizeof extensions / sizeof *extensions; ++i) {
    gltf_maker m = {0};
    char more[400];
    add_square(&m);
    // A second number outside its range does not name the material again.
    snprintf(more, sizeof more,
             ", \"materials\": [{\"name\": \"odd\", \"alphaMode\": \"MASK\", \"alphaCutoff\": %s, \"emissiveFactor\": "
             "[1, 1, "
             "1], \"extensions\": {%s}}]",
             i % 2 ? "-1" : "0.5", extensions[i]);
    olx_scene *scene = load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]", more));
    assert_model_warned(scene, "1 material has numbers outside their range, clamped (odd)");
    if (i == 0) assert_near_vector(scene->materials[0].emission, 0, 0, 0, 0.0f);
    olx_scene_free(scene);
  }
}

static void extensions_that_are_ignored_are_named(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  olx_scene *scene =
      load_model(write_square_model(&m, *state, square_with(""), "[{\"mesh\": 0}]",
                                    ", \"materials\": [{}], \"extensionsUsed\": [\"KHR_materials_unlit\", "
                                    "\"ABC_unheard_of\"]"));
  assert_model_warned(scene, "the glTF extension KHR_materials_unlit is ignored");
  assert_model_warned(scene, "the glTF extension ABC_unheard_of is ignored");
  olx_scene_free(scene);
}

static void cooked_scenes_keep_all_that_vertices_have(void **state) {
  const float colors[12] = {1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0},
              tangents[16] = {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, -1};
  gltf_maker m = {0};
  add_square(&m);
  gltf_add(&m, colors, sizeof colors, 4, GLTF_FLOAT, "VEC3", false);
  gltf_add(&m, tangents, sizeof tangents, 4, GLTF_FLOAT, "VEC4", false);
  const char *model = write_square_model(
      &m, *state, square_with(", \"COLOR_0\": 4, \"TANGENT\": 5"), "[{\"mesh\": 0}]",
      ", \"materials\": [{\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}, \"normalTexture\": "
      "{\"index\": 0" TRANSFORM(
          "\"scale\": [2, 2]") "}}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": \"" SIDEWAYS "\"}]");
  char path[600];
  snprintf(path, sizeof path, "%s/made.olxs", ((scene_folder *)*state)->path);
  olx_scene *scene = load_model(model), *cooked = NULL;
  assert_true(scene->colors && scene->tangents && scene->second_uvs);
  assert_int_equal(olx_scene_cook(scene, path, NULL), OLX_OK);
  if (olx_scene_load_cooked(path, &cooked) != OLX_OK) fail_msg("%s", olx_last_error());
  assert_true(cooked->hash == scene->hash);
  assert_memory_equal(cooked->colors, scene->colors, 4 * sizeof *scene->colors);
  assert_memory_equal(cooked->tangents, scene->tangents, 4 * sizeof *scene->tangents);
  assert_memory_equal(cooked->second_uvs, scene->second_uvs, 4 * sizeof *scene->second_uvs);
  assert_int_equal(cooked->materials[0].second_uvs, OLX_SLOT_NORMAL);
  assert_true(cooked->materials[0].vertex_colors);
  olx_scene_free(cooked);
  olx_scene_free(scene);
}

// The meshes of both other materials are left out: one is of lines, one fully transparent.
static void cooked_scenes_may_have_materials_without_triangles(void **state) {
  gltf_maker m = {0};
  add_square(&m);
  const char *placed = "\"normalTexture\": {\"index\": 0" TRANSFORM("\"scale\": [2, 2]") "}";
  char more[1024], primitives[600], path[600];
  snprintf(more, sizeof more,
           ", \"materials\": [{}, {\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}, %s}, "
           "{\"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 1, 1, 0], "
           "\"baseColorTexture\": {\"index\": 0}}, %s}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": "
           "\"" SIDEWAYS "\"}]",
           placed, placed);
  snprintf(primitives, sizeof primitives,
           "%s, {\"attributes\": {\"POSITION\": 0}, \"material\": 1, \"mode\": 1}, {\"attributes\": "
           "{\"POSITION\": 0}, \"indices\": 3, \"material\": 2}",
           square_with(""));
  snprintf(path, sizeof path, "%s/made.olxs", ((scene_folder *)*state)->path);
  olx_scene *scene = load_model(write_square_model(&m, *state, primitives, "[{\"mesh\": 0}]", more)), *cooked = NULL;
  assert_int_equal(scene->material_count, 3);
  assert_int_equal(olx_scene_cook(scene, path, NULL), OLX_OK);
  if (olx_scene_load_cooked(path, &cooked) != OLX_OK) fail_msg("%s", olx_last_error());
  assert_true(cooked->hash == scene->hash);
  olx_scene_free(cooked);
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(vertex_colours_multiply_the_base_colour),
      WITH_FOLDER(white_vertices_are_as_good_as_none),
      WITH_FOLDER(the_alpha_of_vertices_masks),
      WITH_FOLDER(tangents_of_the_file_go_before_texture_coordinates),
      WITH_FOLDER(bitangents_lie_on_the_side_that_tangents_say),
      WITH_FOLDER(specular_factors_are_weights),
      WITH_FOLDER(specular_colours_count_by_their_luminance),
      WITH_FOLDER(specular_textures_are_weights_texel_by_texel),
      WITH_FOLDER(specular_textures_join_that_of_roughness),
      WITH_FOLDER(light_passes_by_alpha_and_transmission),
      WITH_FOLDER(glass_is_as_opaque_as_its_texels_are_dark_or_metal),
      WITH_FOLDER(descriptions_keep_the_opacity_of_glass),
      WITH_FOLDER(equal_glass_shares_a_texture),
      WITH_FOLDER(metal_transmits_nothing),
      WITH_FOLDER(masks_lamps_and_textures_of_transmission_stay_opaque),
      WITH_FOLDER(descriptions_replace_specular_textures),
      WITH_FOLDER(specular_textures_that_lie_elsewhere_are_left_out),
      WITH_FOLDER(specular_textures_that_cannot_be_read_leave_the_factors),
      WITH_FOLDER(glossiness_and_the_reflectances_of_factors_are_kept),
      WITH_FOLDER(glossiness_textures_are_converted_texel_by_texel),
      WITH_FOLDER(surfaces_without_a_material_are_reported),
      WITH_FOLDER(numbers_of_extensions_outside_their_range_are_clamped_with_a_warning),
      WITH_FOLDER(extensions_that_are_ignored_are_named),
      WITH_FOLDER(cooked_scenes_keep_all_that_vertices_have),
      WITH_FOLDER(cooked_scenes_may_have_materials_without_triangles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
