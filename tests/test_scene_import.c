// Tests that the contents of OBJ, MTL and glTF files arrive in the scene, and that broken contents are skipped with a
// warning or refused with a message that names file and element.
#include "core/hooks.h"
#include "scene/affine.h"
#include "scene/import/model_files.h"
#include "scene/scene_build.h"
#include "scene/texture.h"
#include "scene_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static olx_scene *load(const char *path) {
  olx_scene *scene = NULL;
  if (olx_scene_load(path, &scene) != OLX_OK) fail_msg("%s", olx_last_error());
  return scene;
}

static bool has_warning(const olx_scene *scene, const char *part) {
  for (uint32_t i = 0; i < scene->warning_count; ++i) {
    if (strstr(scene->warnings[i], part)) return true;
  }
  return false;
}

static void assert_near(float a, float b) {
  if (!(fabsf(a - b) <= 1e-5f)) fail_msg("%g is not %g", (double)a, (double)b);
}

static void assert_vec(olx_vec3 v, float x, float y, float z) {
  if (!(olx_length(olx_sub(v, olx_v3(x, y, z))) <= 1e-5f)) {
    fail_msg("(%g %g %g) is not (%g %g %g)", (double)v.x, (double)v.y, (double)v.z, (double)x, (double)y, (double)z);
  }
}

static void assert_refused(const char *path, olx_result expected, const char *part) {
  olx_scene *scene = NULL;
  const olx_result result = olx_scene_load(path, &scene);
  olx_scene_free(scene);
  assert_int_equal(result, expected);
  if (!strstr(olx_last_error(), part)) fail_msg("\"%s\" does not say \"%s\"", olx_last_error(), part);
}

static const olx_material *find_material(const olx_scene *scene, const char *name) {
  for (uint32_t i = 0; i < scene->material_count; ++i) {
    if (strcmp(scene->materials[i].name, name) == 0) return &scene->materials[i];
  }
  fail_msg("no material %s", name);
  return NULL;
}

static olx_vec3 winding_normal(const olx_scene *scene, uint32_t triangle) {
  const uint32_t *i = scene->indices + (size_t)triangle * 3;
  const olx_vec3 a = scene->positions[i[0]];
  return olx_normalize(olx_cross(olx_sub(scene->positions[i[1]], a), olx_sub(scene->positions[i[2]], a)));
}

// ---- OBJ and MTL

static olx_scene *load_square(const scene_folder *folder, const char *mtl) {
  scene_folder_write_text(folder, "square.mtl", mtl);
  return load(scene_folder_write_text(folder, "square.obj", scene_files_obj));
}

static void obj_quad_becomes_two_triangles(void **state) {
  olx_scene *scene = load_square(*state, "newmtl square\nKd 0.5 0.25 0.125\n");
  const olx_scene_info info = olx_scene_describe(scene);
  assert_int_equal(info.triangles, 2);
  assert_int_equal(info.materials, 1);
  assert_int_equal(info.lights, 0);
  assert_vec(info.bounds_min, 0, 0, 0);
  assert_vec(info.bounds_max, 1, 1, 0);
  for (uint32_t t = 0; t < 2; ++t) assert_vec(winding_normal(scene, t), 0, 0, 1);
  assert_vec(find_material(scene, "square")->base_color, 0.5f, 0.25f, 0.125f);
  assert_int_equal(info.warnings, 0);
  olx_scene_free(scene);
}

static void mtl_specular_decides_between_lambert_and_ggx(void **state) {
  olx_scene *scene = load_square(*state, "newmtl square\nKd 0.5 0.5 0.5\nKs 0 0 0\nNs 100\n");
  assert_near(find_material(scene, "square")->specular_weight, 0.0f);
  olx_scene_free(scene);
  scene = load_square(*state, "newmtl square\nKd 0.5 0.5 0.5\nKs 0.03 0 0\nNs 30\n");
  const olx_material *m = find_material(scene, "square");
  assert_near(m->specular_weight, 1.0f);
  assert_near(m->metallic, 0.0f);
  // alpha = roughness^2 = sqrt(2 / (30 + 2)) = 1/4
  assert_near(m->roughness, 0.5f);
  olx_scene_free(scene);
}

static void mtl_roughness_and_metallic_go_before_the_exponent(void **state) {
  olx_scene *scene = load_square(*state, "newmtl square\nKd 0.5 0.5 0.5\nKs 1 1 1\nNs 30\nPr 0.3\nPm 0.7\n");
  assert_near(find_material(scene, "square")->roughness, 0.3f);
  assert_near(find_material(scene, "square")->metallic, 0.7f);
  olx_scene_free(scene);
}

static void mtl_bump_is_a_height_map(void **state) {
  uint8_t tga[34];
  scene_folder_write(*state, "four.tga", tga, scene_files_tga(tga));
  olx_scene *scene = load_square(*state, "newmtl square\nKd 0.5 0.5 0.5\nmap_bump -bm 0.5 four.tga\nmap_Ke four.tga\n");
  const olx_material *m = find_material(scene, "square");
  assert_true(m->normal_is_height);
  assert_near(m->normal_scale, 0.5f);
  assert_false(scene->textures[m->normal_texture].srgb);
  // An emission map without Ke gives a surface that emits the map's light.
  assert_vec(m->emission, 1, 1, 1);
  assert_true(scene->textures[m->emission_texture].srgb);
  olx_scene_free(scene);
}

static void mtl_emits_on_both_sides(void **state) {
  olx_scene *scene = load_square(*state, "newmtl square\nKd 0 0 0\nKe 3 2 1\n");
  const olx_material *m = find_material(scene, "square");
  assert_vec(m->emission, 3, 2, 1);
  assert_true(m->emits_both_sides);
  assert_int_equal(olx_scene_describe(scene).lights, 1);
  olx_scene_free(scene);
}

static void mtl_opacity_lets_light_pass_in_part(void **state) {
  const char *values[] = {"0.6", "0.4"};
  for (uint32_t i = 0; i < 2; i++) {
    char text[80];
    snprintf(text, sizeof text, "newmtl square\nKd 0.5 0.5 0.5\nd %s\n", values[i]);
    olx_scene *scene = load_square(*state, text);
    assert_int_equal(scene->triangle_count, 2);
    assert_true(scene->materials[0].blended);
    assert_near(scene->materials[0].alpha, i == 0 ? 0.6f : 0.4f);
    assert_near(scene->materials[0].alpha_cutoff, 0.5f);
    assert_true(has_warning(scene, "partial opacity"));
    olx_scene_free(scene);
  }
  // Without other materials in the file, no triangle is left.
  scene_folder_write_text(*state, "square.mtl", "newmtl square\nKd 0.5 0.5 0.5\nd 0\n");
  assert_refused(scene_folder_write_text(*state, "square.obj", scene_files_obj), OLX_ERROR_EMPTY, "square.obj");
}

static void material_file_without_materials_is_no_error(void **state) {
  const char *const texts[] = {"", "#\n", "\n\n", "newmtl "};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i) {
    olx_scene *scene = load_square(*state, texts[i]);
    assert_int_equal(olx_scene_describe(scene).triangles, 2);
    olx_scene_free(scene);
  }
}

static void albedo_above_the_limit_is_clamped_and_told(void **state) {
  olx_scene *scene = load_square(*state, "newmtl square\nKd 1 0.5 0.99\n");
  assert_vec(scene->materials[0].base_color, 0.95f, 0.5f, 0.95f);
  assert_true(has_warning(scene, "albedo"));
  olx_scene_free(scene);
}

static void texture_lands_the_right_way_up(void **state) {
  uint8_t tga[34];
  scene_folder_write(*state, "four.tga", tga, scene_files_tga(tga));
  olx_scene *scene = load_square(*state, "newmtl square\nKd 1 1 1\nmap_Kd four.tga\n");
  const olx_material *m = find_material(scene, "square");
  assert_int_equal(scene->texture_count, 1);
  assert_true(scene->textures[m->base_color_texture].srgb);
  assert_vec(m->base_color, 1, 1, 1);
  // The quad's upper left corner (0, 1) must show the image's upper left texel, red.
  const olx_vec2 inward[4] = {{0.25f, -0.25f}, {-0.25f, -0.25f}, {-0.25f, 0.25f}, {0.25f, 0.25f}};
  const olx_vec3 expected[4] = {{0, 0, 1}, {1, 1, 1}, {0, 1, 0}, {1, 0, 0}};
  for (uint32_t v = 0; v < scene->vertex_count; ++v) {
    const olx_vec3 p = scene->positions[v];
    const uint32_t corner = p.y < 0.5f ? (p.x < 0.5f ? 0u : 1u) : (p.x < 0.5f ? 3u : 2u);
    const olx_vec2 uv = {scene->uvs[v].x + inward[corner].x, scene->uvs[v].y + inward[corner].y};
    const olx_vec3 color = olx_texture_sample(&scene->textures[m->base_color_texture], uv).color;
    assert_vec(color, expected[corner].x, expected[corner].y, expected[corner].z);
  }
  olx_scene_free(scene);
}

static void alpha_map_masks(void **state) {
  uint8_t tga[34];
  scene_folder_write(*state, "four.tga", tga, scene_files_tga(tga));
  olx_scene *scene = load_square(*state, "newmtl square\nKd 1 1 1\nmap_Kd four.tga\nmap_d four.tga\n");
  const olx_material *m = find_material(scene, "square");
  assert_near(m->alpha_cutoff, 0.5f);
  const olx_texture *mask = &scene->textures[m->alpha_texture];
  assert_false(mask->srgb);
  // The alpha channel becomes R of the mask, where only the lower right texel is cut out.
  assert_near(olx_texture_sample(mask, (olx_vec2){0.75f, 0.75f}).color.x, 0.0f);
  assert_near(olx_texture_sample(mask, (olx_vec2){0.25f, 0.75f}).color.x, 1.0f);
  // The alpha of a colour has no meaning in MTL.
  assert_near(olx_texture_alpha(&scene->textures[m->base_color_texture], (olx_vec2){0.75f, 0.75f}), 1.0f);
  olx_scene_free(scene);
}

static void missing_files_of_an_obj_warn_and_are_named(void **state) {
  olx_scene *scene = load_square(*state, "newmtl square\nKd 0.5 0.5 0.5\nmap_Kd gone.png\n");
  assert_true(has_warning(scene, "gone.png"));
  assert_int_equal(scene->texture_count, 0);
  assert_int_equal(scene->materials[0].base_color_texture, OLX_NO_TEXTURE);
  assert_vec(scene->materials[0].base_color, 0.5f, 0.5f, 0.5f);
  olx_scene_free(scene);
  scene = load_square(*state, "newmtl square\nKd 0.5 0.5 0.5\nmap_Ke gone.png\n");
  assert_true(has_warning(scene, "gone.png"));
  assert_vec(scene->materials[0].emission, 0, 0, 0);
  olx_scene_free(scene);
  scene = load(scene_folder_write_text(*state, "alone.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  assert_true(has_warning(scene, "gone.mtl"));
  assert_vec(winding_normal(scene, 0), 0, 0, 1);
  assert_vec(scene->normals[0], 0, 0, 1);
  olx_scene_free(scene);
}

// The bytes behind a name are not part of it.
static void percent_signs_without_two_digits_stay(void **state) {
  (void)state;
  static const char *const names[][2] = {{"a%20b%2F", "a b/"}, {"x%4", "x%4"},       {"x%", "x%"},
                                         {"x%4g", "x%4g"},     {"x% 4.y", "x% 4.y"}, {"x%0x41", "x%0x41"},
                                         {"x%00y", "x%00y"},   {"%%41", "%A"},       {"a\\b", "a/b"}};
  for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
    char path[64], expected[64];
    memset(path, 'z', sizeof path - 1);
    path[sizeof path - 1] = 0;
    snprintf(expected, sizeof expected, "no such folder/%s", names[i][1]);
    olx_model_file_locate("no such folder/made.gltf", names[i][0], path, sizeof path);
    assert_string_equal(path, expected);
  }
}

static void unreadable_texture_is_left_out(void **state) {
  scene_folder_write_text(*state, "broken.png", "this is no image");
  olx_scene *scene = load_square(*state, "newmtl square\nKd 0.5 0.5 0.5\nmap_Kd broken.png\n");
  assert_true(has_warning(scene, "broken.png"));
  assert_int_equal(scene->texture_count, 0);
  olx_scene_free(scene);
}

// ---- glTF

static olx_scene *load_gltf(const scene_folder *folder, const char *materials, int material, const char *nodes,
                            const char *more) {
  char *text = scene_files_gltf(materials, material, nodes, more, false);
  const char *path = scene_folder_write_text(folder, "scene.gltf", text);
  free(text);
  return load(path);
}

static void assert_gltf_refused(const scene_folder *folder, const char *nodes, const char *more, olx_result expected,
                                const char *part) {
  char *text = scene_files_gltf("[]", -1, nodes, more, false);
  const char *path = scene_folder_write_text(folder, "scene.gltf", text);
  free(text);
  assert_refused(path, expected, part);
  assert_non_null(strstr(olx_last_error(), "scene.gltf"));
}

static void nodes_place_instances(void **state) {
  olx_scene *scene = load_gltf(*state, "[]", -1,
                               "[{\"children\": [1, 2], \"translation\": [10, 0, 0]}, {\"mesh\": 0},"
                               " {\"mesh\": 0, \"translation\": [0, 5, 0], \"scale\": [2, 2, 2]}]",
                               "");
  const olx_scene_info info = olx_scene_describe(scene);
  assert_int_equal(info.triangles, 4);
  assert_vec(info.bounds_min, 10, 0, 0);
  assert_vec(info.bounds_max, 12, 7, 0);
  olx_scene_free(scene);
}

static void mirrored_node_keeps_its_front(void **state) {
  olx_scene *scene = load_gltf(*state, "[]", -1, "[{\"mesh\": 0, \"scale\": [-1, 1, 3]}]", "");
  assert_vec(olx_scene_describe(scene).bounds_min, -1, 0, 0);
  assert_vec(winding_normal(scene, 0), 0, 0, 1);
  assert_vec(scene->normals[0], 0, 0, 1);
  olx_scene_free(scene);
}

static void uneven_scale_keeps_normals_upright(void **state) {
  // When the square is turned by 45 degrees about y, then stretched along x, its normal leans towards z.
  olx_scene *scene = load_gltf(
      *state, "[]", -1,
      "[{\"children\": [1], \"scale\": [3, 1, 1]}, {\"mesh\": 0, \"rotation\": [0, 0.3826834, 0, 0.9238795]}]", "");
  const olx_vec3 expected = olx_normalize(olx_v3(1.0f / 3.0f, 0.0f, 1.0f));
  assert_vec(winding_normal(scene, 0), expected.x, expected.y, expected.z);
  assert_vec(scene->normals[0], expected.x, expected.y, expected.z);
  olx_scene_free(scene);
}

static void gltf_material_arrives_whole(void **state) {
  olx_scene *scene = load_gltf(
      *state,
      "[{\"name\": \"lamp\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [0.1, 0.2, 0.3, 1], \"metallicFactor\": "
      "0.25, \"roughnessFactor\": 0.5}, \"emissiveFactor\": [1, 0.5, 0], \"extensions\": "
      "{\"KHR_materials_emissive_strength\": {\"emissiveStrength\": 40}, \"KHR_materials_specular\": "
      "{\"specularFactor\": 0.25}}}]",
      0, "[{\"mesh\": 0}]", "");
  const olx_material *m = find_material(scene, "lamp");
  assert_vec(m->base_color, 0.1f, 0.2f, 0.3f);
  assert_near(m->metallic, 0.25f);
  assert_near(m->roughness, 0.5f);
  assert_near(m->specular_weight, 0.25f);
  assert_vec(m->emission, 40, 20, 0);
  assert_false(m->emits_both_sides);
  assert_near(m->alpha_cutoff, 0.0f);
  olx_scene_free(scene);
}

static void gltf_defaults_are_those_of_its_specification(void **state) {
  olx_scene *scene = load_gltf(*state, "[{\"name\": \"plain\", \"doubleSided\": true}]", 0, "[{\"mesh\": 0}]", "");
  const olx_material *m = find_material(scene, "plain");
  assert_near(m->metallic, 1.0f);
  assert_near(m->roughness, 1.0f);
  assert_near(m->specular_weight, 1.0f);
  assert_true(m->emits_both_sides);
  olx_scene_free(scene);
}

static void gltf_alpha_modes(void **state) {
  olx_scene *scene =
      load_gltf(*state,
                "[{\"name\": \"leaf\", \"alphaMode\": \"MASK\", \"alphaCutoff\": 0.3, \"pbrMetallicRoughness\": "
                "{\"baseColorFactor\": [1, 1, 1, 0.9]}}]",
                0, "[{\"mesh\": 0}]", "");
  assert_near(find_material(scene, "leaf")->alpha_cutoff, 0.3f);
  assert_near(find_material(scene, "leaf")->alpha, 0.9f);
  olx_scene_free(scene);
  scene = load_gltf(*state,
                    "[{\"name\": \"glass\", \"alphaMode\": \"OPAQUE\", \"pbrMetallicRoughness\": "
                    "{\"baseColorFactor\": [1, 1, 1, 0.1]}}]",
                    0, "[{\"mesh\": 0}]", "");
  assert_int_equal(scene->triangle_count, 2);
  assert_near(scene->materials[0].alpha_cutoff, 0.0f);
  olx_scene_free(scene);
  char *text = scene_files_gltf("[{\"name\": \"glass\", \"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\": "
                                "{\"baseColorFactor\": [1, 1, 1, 0]}}]",
                                0, "[{\"mesh\": 0}]", "", false);
  assert_refused(scene_folder_write_text(*state, "glass.gltf", text), OLX_ERROR_EMPTY, "glass.gltf");
  free(text);
}

// Materials are identified by their numbers: names may repeat, and unused materials are left out.
static void extensions_stay_with_their_material(void **state) {
  olx_scene *scene = load_gltf(
      *state,
      "[{\"name\": \"same\", \"emissiveFactor\": [1, 1, 1], \"extensions\": {\"KHR_materials_emissive_strength\": "
      "{\"emissiveStrength\": 2}}}, {\"name\": \"same\", \"emissiveFactor\": [1, 1, 1], \"extensions\": "
      "{\"KHR_materials_emissive_strength\": {\"emissiveStrength\": 7}}}]",
      1, "[{\"mesh\": 0}]", "");
  assert_vec(scene->materials[scene->material_index[0]].emission, 7, 7, 7);
  olx_scene_free(scene);
}

static void gltf_texture_from_the_file_itself(void **state) {
  // The texture is the TGA of scene_files_tga, in base64.
  olx_scene *scene =
      load_gltf(*state, "[{\"name\": \"textured\", \"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}]",
                0, "[{\"mesh\": 0}]",
                ", \"textures\": [{\"source\": 0}], \"images\": [{\"mimeType\": \"image/png\", \"uri\": "
                "\"data:image/png;base64,AAACAAAAAAAAAAAAAgACACAoAAD//wD/AP//AAD/////AA==\"}]");
  assert_int_equal(scene->texture_count, 1);
  const olx_texture *texture = &scene->textures[find_material(scene, "textured")->base_color_texture];
  // The square's uvs are unchanged: (0, 0) is the upper left corner, red.
  assert_vec(olx_texture_sample(texture, (olx_vec2){0.25f, 0.25f}).color, 1, 0, 0);
  for (uint32_t v = 0; v < scene->vertex_count; ++v) {
    assert_near(scene->uvs[v].x, scene->positions[v].x);
    assert_near(scene->uvs[v].y, 1.0f - scene->positions[v].y);
  }
  olx_scene_free(scene);
}

static void gltf_camera_looks_where_its_node_points(void **state) {
  // A turn by 90 degrees about y takes -z to -x.
  olx_scene *scene =
      load_gltf(*state, "[]", -1,
                "[{\"mesh\": 0, \"children\": [1]}, {\"name\": \"eye\", \"camera\": 0, \"translation\": [1, 2, 3],"
                " \"rotation\": [0, 0.70710678, 0, 0.70710678]}]",
                ", \"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": 1.0471976, "
                "\"znear\": 0.1}}]");
  assert_int_equal(olx_scene_describe(scene).cameras, 1);
  olx_camera camera;
  assert_int_equal(olx_scene_find_camera(scene, "eye", &camera), OLX_OK);
  assert_vec(camera.eye, 1, 2, 3);
  assert_vec(olx_sub(camera.target, camera.eye), -1, 0, 0);
  assert_vec(camera.up, 0, 1, 0);
  assert_true(fabsf(camera.fov_y_degrees - 60.0f) < 1e-3f);
  olx_scene_free(scene);
}

// Characters of three bytes after two letters end at neither 63 nor 127 bytes.
static void long_names_are_cut_between_characters(void **state) {
  char name[200] = "ab", materials[300], nodes[400];
  for (int i = 0; i < 50; ++i) memcpy(name + 2 + 3 * i, "\xe3\x81\x82", 4);
  snprintf(materials, sizeof materials, "[{\"name\": \"%s\"}]", name);
  snprintf(nodes, sizeof nodes, "[{\"mesh\": 0, \"children\": [1]}, {\"name\": \"%s\", \"camera\": 0}]", name);
  olx_scene *scene = load_gltf(*state, materials, 0, nodes,
                               ", \"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": 1}}]");
  name[125] = 0;
  assert_string_equal(scene->materials[0].name, name);
  name[62] = 0;
  assert_string_equal(scene->cameras[0].name, name);
  olx_scene_free(scene);
}

static void punctual_lights_arrive_one_to_one(void **state) {
  olx_scene *scene = load_gltf(
      *state, "[]", -1,
      "[{\"mesh\": 0, \"children\": [1, 2, 3, 4]},"
      "{\"translation\": [0, 9, 0], \"rotation\": [-0.70710678, 0, 0, 0.70710678], \"extensions\": "
      "{\"KHR_lights_punctual\": {\"light\": 0}}},"
      "{\"translation\": [1, 2, 3], \"extensions\": {\"KHR_lights_punctual\": {\"light\": 1}}},"
      "{\"translation\": [4, 5, 6], \"extensions\": {\"KHR_lights_punctual\": {\"light\": 1}}},"
      "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 2}}}]",
      ", \"extensionsUsed\": [\"KHR_lights_punctual\"], \"extensions\": {\"KHR_lights_punctual\": {\"lights\": ["
      "{\"type\": \"directional\", \"color\": [1, 0.5, 0.25], \"intensity\": 8},"
      "{\"type\": \"point\", \"intensity\": 5},"
      "{\"type\": \"spot\", \"spot\": {\"innerConeAngle\": 0.2, \"outerConeAngle\": 0.4}}]}}");
  assert_int_equal(scene->light_count, 4);
  const olx_light *sun = &scene->lights[0], *first = &scene->lights[1], *second = &scene->lights[2];
  assert_int_equal(sun->type, OLX_LIGHT_SUN);
  assert_vec(sun->direction, 0, -1, 0);
  assert_vec(sun->emission, 8, 4, 2);
  assert_int_equal(first->type, OLX_LIGHT_POINT);
  assert_vec(first->position, 1, 2, 3);
  assert_vec(second->position, 4, 5, 6);
  assert_vec(second->emission, 5, 5, 5);
  assert_int_equal(scene->lights[3].type, OLX_LIGHT_SPOT);
  assert_near(scene->lights[3].cosine_inner, cosf(0.2f));
  assert_near(scene->lights[3].cosine_outer, cosf(0.4f));
  olx_scene_free(scene);
}

// A light of a glTF file above OLX_MOST_EMISSION is skipped: no description and no cooked scene may hold it either.
static void punctual_lights_beyond_what_scenes_hold_are_skipped(void **state) {
  olx_scene *scene =
      load_gltf(*state, "[]", -1,
                "[{\"mesh\": 0, \"children\": [1, 2]}, {\"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}, "
                "{\"extensions\": {\"KHR_lights_punctual\": {\"light\": 1}}}]",
                ", \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"point\", \"intensity\": 9e19}, "
                "{\"name\": \"nova\", \"type\": \"point\", \"color\": [0, 0, 1], \"intensity\": 1.1e20}]}}");
  assert_int_equal(scene->light_count, 1);
  assert_true(has_warning(scene, "light \"nova\" skipped"));
  olx_scene_free(scene);
}

static void glb_is_the_same_scene_as_gltf(void **state) {
  uint8_t *data;
  const char *materials = "[{\"name\": \"m\", \"emissiveFactor\": [1, 1, 1]}]", *nodes = "[{\"mesh\": 0}]";
  const size_t size_bytes = scene_files_glb(materials, 0, nodes, "", &data);
  olx_scene *binary = load(scene_folder_write(*state, "scene.glb", data, size_bytes));
  olx_scene *text = load_gltf(*state, materials, 0, nodes, "");
  assert_int_equal(binary->triangle_count, 2);
  assert_true(binary->hash == text->hash);
  olx_scene_free(binary);
  olx_scene_free(text);
  // Every shorter file is refused with a message.
  for (size_t length = 0; length < size_bytes; length += 7) {
    assert_refused(scene_folder_write(*state, "cut.glb", data, length), OLX_ERROR_FORMAT, "cut.glb");
  }
  free(data);
}

static void malformed_gltf_is_refused_by_name(void **state) {
  const char *mesh = "[{\"mesh\": 0}]";
  assert_gltf_refused(*state, "[{\"mesh\": 3}]", "", OLX_ERROR_FORMAT, "nodes[0]");
  assert_gltf_refused(*state, "[{\"mesh\": 0, \"camera\": 0}]", "", OLX_ERROR_FORMAT,
                      "nodes[0]: its camera does not exist");
  assert_gltf_refused(*state, "[{\"mesh\": 0, \"extensions\": {\"KHR_lights_punctual\": {\"light\": 7}}}]", "",
                      OLX_ERROR_FORMAT, "nodes[0]: its light does not exist");
  assert_gltf_refused(*state, "[{\"mesh\": 0, \"children\": [1]}, {\"children\": [2]}, {\"children\": [1]}]", "",
                      OLX_ERROR_FORMAT, "nodes[1]");
  assert_gltf_refused(*state, "[{\"mesh\": 0, \"children\": [0]}]", "", OLX_ERROR_FORMAT, "child");
  assert_gltf_refused(*state, "[{\"mesh\": 0}, {\"children\": [2]}, {\"children\": [3]}, {\"children\": [1]}]", "",
                      OLX_ERROR_FORMAT, "nodes contain each other");
  assert_gltf_refused(*state, mesh, ", \"extensionsRequired\": [\"KHR_texture_basisu\"]", OLX_ERROR_UNSUPPORTED,
                      "KHR_texture_basisu");
  assert_gltf_refused(*state, mesh, ", \"images\": [{\"bufferView\": 9}]", OLX_ERROR_FORMAT, "images[0]");
  assert_refused(scene_folder_write_text(*state, "old.gltf", "{\"asset\": {\"version\": \"1.0\"}}"), OLX_ERROR_VERSION,
                 "old.gltf");
  assert_refused(scene_folder_write_text(*state, "bad.gltf", "{\n\n\"asset\": oops}"), OLX_ERROR_FORMAT, "line 3");
  assert_refused(scene_folder_write_text(*state, "empty.gltf", ""), OLX_ERROR_FORMAT, "empty.gltf");
}

static void accessors_past_their_buffer_are_refused(void **state) {
  const struct {
    const char *from, *to, *element;
  } changes[] = {
      {"\"count\": 6", "\"count\": 7", "accessors[3]"},
      {"\"count\": 6", "\"count\": -1", "accessors[3]"},
      {"\"count\": 6", "\"count\": 4294967295", "accessors[3]"},
      {"\"byteOffset\": 24", "\"byteOffset\": 25", "accessors[2]"},
      {"\"byteLength\": 12}", "\"byteLength\": 13}", "bufferViews[1]"},
      {"\"byteStride\": 32", "\"byteStride\": 4", "accessors[0]"},
      {"\"bufferView\": 1", "\"bufferView\": 2", "accessors[3]"},
      {"\"POSITION\": 0", "\"POSITION\": 4", "meshes[0]"},
      {"\"POSITION\": 0", "\"POSITION\": 3", "meshes[0]"},
      {"\"indices\": 3", "\"indices\": 0", "meshes[0]"},
      {"\"indices\": 3", "\"indices\": 3, \"mode\": 7", "meshes[0]"},
      {"\"count\": 6", "\"count\": 2", "meshes[0]"},
      {"\"scene\": 0", "\"scene\": 1e38", "scene"},
      {"\"componentType\": 5123", "\"componentType\": 99", "accessors[3]"},
  };
  char *text = scene_files_gltf("[]", -1, "[{\"mesh\": 0}]", "", false);
  for (size_t i = 0; i < sizeof changes / sizeof *changes; ++i) {
    char changed[8192];
    const char *at = strstr(text, changes[i].from);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, changes[i].to, at + strlen(changes[i].from));
    olx_scene *scene = NULL;
    assert_int_not_equal(olx_scene_load(scene_folder_write_text(*state, "scene.gltf", changed), &scene), OLX_OK);
    if (!strstr(olx_last_error(), changes[i].element)) fail_msg("%s: %s", changes[i].to, olx_last_error());
  }
  free(text);
}

// ---- building and identity

static void meshes_beyond_a_few_share_one_warning(void **state) {
  (void)state;
  olx_scene scene = {0};
  const olx_vec3 positions[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const uint32_t indices[] = {0, 1, 2, 0, 1, 1, 2, 2, 1};
  const olx_material material = olx_material_default();
  assert_int_equal(olx_scene_add_material(&scene, &material, NULL), OLX_OK);
  for (int model = 1; model <= 2; ++model) {
    for (int mesh = 0; mesh < 7; ++mesh) {
      assert_int_equal(olx_scene_add_mesh(&scene, "broken", positions, NULL, NULL, 3, indices, 3, 0), OLX_OK);
    }
    olx_scene_warn_about_rest(&scene, "model.obj");
    assert_int_equal(scene.warning_count, 5 * model);
    assert_non_null(strstr(scene.warnings[5 * model - 2], "broken: skipped 2 of 3 triangles"));
    assert_string_equal(scene.warnings[5 * model - 1], "model.obj: skipped 6 more triangles of 3 more meshes");
  }
  olx_scene *owned = olx_allocate_zero(1, sizeof *owned);
  *owned = scene;
  olx_scene_free(owned);
}

static void broken_triangles_are_skipped_and_counted(void **state) {
  (void)state;
  olx_scene scene = {0};
  const olx_vec3 positions[5] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}, {2, 0, 0}};
  const uint32_t indices[] = {0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 5, 0, 4294967295u, 2, 2, 2, 1};
  const olx_material material = olx_material_default();
  assert_int_equal(olx_scene_add_material(&scene, &material, NULL), OLX_OK);
  for (int with_normals = 0; with_normals < 2; ++with_normals) {
    const olx_vec3 normals[5] = {{0, 0, 2}, {NAN, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 0, 1}};
    assert_int_equal(
        olx_scene_add_mesh(&scene, "broken", positions, with_normals ? normals : NULL, NULL, 5, indices, 6, 0), OLX_OK);
  }
  assert_int_equal(scene.triangle_count, 2);
  assert_int_equal(scene.warning_count, 2);
  assert_non_null(strstr(scene.warnings[0], "broken: skipped 5 of 6 triangles (2 without area, 1 with"));
  for (uint32_t t = 0; t < 2; ++t) {
    for (uint32_t k = 0; k < 3; ++k) assert_vec(scene.normals[scene.indices[t * 3 + k]], 0, 0, 1);
  }
  olx_scene *owned = olx_allocate_zero(1, sizeof *owned);
  *owned = scene;
  olx_scene_free(owned);
}

static void rectangle_light_shines_along_u_cross_v(void **state) {
  (void)state;
  olx_scene *scene = olx_allocate_zero(1, sizeof *scene);
  assert_int_equal(olx_scene_add_rect_light(scene, olx_v3(1, 2, 3), olx_v3(2, 0, 0), olx_v3(0, 0, 4), olx_splat(5)),
                   OLX_OK);
  assert_int_equal(scene->triangle_count, 2);
  for (uint32_t t = 0; t < 2; ++t) assert_vec(winding_normal(scene, t), 0, -1, 0);
  assert_false(scene->materials[0].emits_both_sides);
  assert_int_equal(olx_scene_finish(scene), OLX_OK);
  assert_vec(scene->bounds_min, 0, 2, 1);
  assert_vec(scene->bounds_max, 2, 2, 5);
  assert_int_equal(olx_scene_describe(scene).lights, 1);
  assert_int_equal(olx_scene_add_rect_light(scene, olx_v3(0, 0, 0), olx_v3(1, 0, 0), olx_v3(2, 0, 0), olx_splat(5)),
                   OLX_ERROR_ARGUMENT);
  olx_scene_free(scene);
}

static uint64_t hash_of(const scene_folder *folder, const char *obj, const char *mtl) {
  scene_folder_write_text(folder, "square.mtl", mtl);
  olx_scene *scene = load(scene_folder_write_text(folder, "hashed.obj", obj));
  const uint64_t hash = olx_scene_describe(scene).hash;
  olx_scene_free(scene);
  return hash;
}

static void hash_follows_what_changes_the_light(void **state) {
  const char *mtl = "newmtl square\nKd 0.5 0.5 0.5\n";
  const uint64_t hash = hash_of(*state, scene_files_obj, mtl);
  assert_true(hash == hash_of(*state, scene_files_obj, mtl));
  assert_true(hash != hash_of(*state, scene_files_obj, "newmtl square\nKd 0.5 0.5 0.51\n"));
  assert_true(hash != hash_of(*state, scene_files_obj, "newmtl square\nKd 0.5 0.5 0.5\nKe 0.001 0 0\n"));
  char moved[512];
  snprintf(moved, sizeof moved, "%s", scene_files_obj);
  char *digit = strstr(moved, "v 1 1 0") + 2;
  *digit = '2';
  assert_true(hash != hash_of(*state, moved, mtl));
}

static void placement_scales_rotates_then_moves(void **state) {
  (void)state;
  const olx_placement about_x_then_y = {.scale = 2.0f, .translate = {10, 0, 0}, .rotate_degrees = {90, 90, 0}};
  const olx_affine a = olx_affine_from_placement(&about_x_then_y, (const double[3]){0.0, 0.0, 0.0});
  // The rotation takes y to z about x, then to x about y.
  assert_vec(olx_affine_point(&a, olx_v3(0, 1, 0)), 12, 0, 0);
  assert_vec(olx_affine_point(&a, olx_v3(1, 0, 0)), 10, 0, -2);
  const olx_placement about_z = {.scale = 1.0f, .rotate_degrees = {0, 0, 90}};
  const olx_affine z = olx_affine_from_placement(&about_z, (const double[3]){0.0, 0.0, 0.0});
  assert_vec(olx_affine_point(&z, olx_v3(1, 0, 0)), 0, 1, 0);
}

static void unusable_names_are_refused(void **state) {
  char path[300];
  snprintf(path, sizeof path, "%s/nowhere.obj", ((scene_folder *)*state)->path);
  assert_refused(path, OLX_ERROR_FILE, "nowhere.obj");
  snprintf(path, sizeof path, "%s/nowhere.gltf", ((scene_folder *)*state)->path);
  assert_refused(path, OLX_ERROR_FILE, "nowhere.gltf");
  scene_folder_write_text(*state, "square.mtl", "# colours\n\nKd 1 0 0\nnewmtl square\n");
  assert_refused(scene_folder_write_text(*state, "square.obj", scene_files_obj), OLX_ERROR_FORMAT,
                 "square.mtl: line 3: expected newmtl");
  assert_refused("picture.png", OLX_ERROR_UNSUPPORTED, "picture.png");
  assert_refused(scene_folder_write_text(*state, "empty.obj", ""), OLX_ERROR_FORMAT, "empty.obj");
  assert_refused(scene_folder_write_text(*state, "points.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\n"),
                 OLX_ERROR_EMPTY, "points.obj");
}

// ---- real scenes, where their files are present

static void real_scenes_arrive_complete(void **state) {
  (void)state;
  const struct {
    const char *name;
    uint32_t triangles, left_out, materials, textures;
  } scenes[] = {
      // One triangle of Sponza has three corners on a line.
      {"sponza/sponza.gltf", 262267, 1, 25, 24},         {"living-room/living_room.obj", 28656, 0, 41, 16},
      {"white-room/white-room.gltf", 237299, 0, 43, 13}, {"godot-rooms/rooms-3x1.gltf", 6072, 0, 3, 0},
      {"veach-ajar/veach-ajar.gltf", 4484, 0, 10, 4},    {"bevy-examples/cornell-box-556.glb", 36, 0, 5, 0},
  };
  for (size_t i = 0; i < sizeof scenes / sizeof *scenes; ++i) {
    char path[4096];
    if (!scene_files_real(scenes[i].name, path, sizeof path)) {
      print_message("%s is not there: skipped\n", scenes[i].name);
      skip();
    }
    olx_scene *scene = load(path);
    assert_int_equal(scene->triangle_count, scenes[i].triangles - scenes[i].left_out);
    assert_int_equal(scene->material_count, scenes[i].materials);
    assert_int_equal(scene->texture_count, scenes[i].textures);
    olx_scene_free(scene);
  }
}

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, scene_folder_set_up, scene_folder_tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(obj_quad_becomes_two_triangles),
      WITH_FOLDER(mtl_specular_decides_between_lambert_and_ggx),
      WITH_FOLDER(mtl_roughness_and_metallic_go_before_the_exponent),
      WITH_FOLDER(mtl_bump_is_a_height_map),
      WITH_FOLDER(mtl_emits_on_both_sides),
      WITH_FOLDER(mtl_opacity_lets_light_pass_in_part),
      WITH_FOLDER(material_file_without_materials_is_no_error),
      WITH_FOLDER(albedo_above_the_limit_is_clamped_and_told),
      WITH_FOLDER(texture_lands_the_right_way_up),
      WITH_FOLDER(alpha_map_masks),
      WITH_FOLDER(missing_files_of_an_obj_warn_and_are_named),
      WITH_FOLDER(unreadable_texture_is_left_out),
      cmocka_unit_test(percent_signs_without_two_digits_stay),
      WITH_FOLDER(nodes_place_instances),
      WITH_FOLDER(mirrored_node_keeps_its_front),
      WITH_FOLDER(uneven_scale_keeps_normals_upright),
      WITH_FOLDER(gltf_material_arrives_whole),
      WITH_FOLDER(gltf_defaults_are_those_of_its_specification),
      WITH_FOLDER(gltf_alpha_modes),
      WITH_FOLDER(extensions_stay_with_their_material),
      WITH_FOLDER(gltf_texture_from_the_file_itself),
      WITH_FOLDER(gltf_camera_looks_where_its_node_points),
      WITH_FOLDER(long_names_are_cut_between_characters),
      WITH_FOLDER(punctual_lights_arrive_one_to_one),
      WITH_FOLDER(punctual_lights_beyond_what_scenes_hold_are_skipped),
      WITH_FOLDER(glb_is_the_same_scene_as_gltf),
      WITH_FOLDER(malformed_gltf_is_refused_by_name),
      WITH_FOLDER(accessors_past_their_buffer_are_refused),
      cmocka_unit_test(meshes_beyond_a_few_share_one_warning),
      cmocka_unit_test(broken_triangles_are_skipped_and_counted),
      cmocka_unit_test(rectangle_light_shines_along_u_cross_v),
      WITH_FOLDER(hash_follows_what_changes_the_light),
      cmocka_unit_test(placement_scales_rotates_then_moves),
      WITH_FOLDER(unusable_names_are_refused),
      WITH_FOLDER(real_scenes_arrive_complete),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
