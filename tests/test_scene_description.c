// Tests scene descriptions: what each key does, where files are searched for, and that wrong descriptions are refused
// with a message that names file and place.
#include "core/hooks.h"
#include "core/sampling.h"
#include "scene/bvh.h"
#include "scene/scene_data.h"
#include "scene_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static int set_up(void **state) {
  if (scene_folder_set_up(state) != 0) return -1;
  const scene_folder *folder = *state;
  scene_folder_write_text(folder, "square.obj", scene_files_obj);
  scene_folder_write_text(folder, "square.mtl", "newmtl square\nKd 0.5 0.5 0.5\nmap_Kd four.tga\n");
  uint8_t tga[34];
  scene_folder_write(folder, "four.tga", tga, scene_files_tga(tga));
  return 0;
}

static olx_scene *load(const scene_folder *folder, const char *text) {
  olx_scene *scene = NULL;
  if (olx_scene_load(scene_folder_write_text(folder, "scene.json", text), &scene) != OLX_OK) {
    fail_msg("%s", olx_last_error());
  }
  return scene;
}

static void assert_vec(olx_vec3 v, float x, float y, float z) {
  if (!(olx_length(olx_sub(v, olx_v3(x, y, z))) <= 1e-5f)) {
    fail_msg("(%g %g %g) is not (%g %g %g)", (double)v.x, (double)v.y, (double)v.z, (double)x, (double)y, (double)z);
  }
}

static void assert_near(float a, float b) {
  if (!(fabsf(a - b) <= 1e-5f)) fail_msg("%g is not %g", (double)a, (double)b);
}

static bool has_warning(const olx_scene *scene, const char *part) {
  for (uint32_t i = 0; i < scene->warning_count; ++i) {
    if (strstr(scene->warnings[i], part)) return true;
  }
  return false;
}

static void model_is_scaled_rotated_and_moved(void **state) {
  olx_scene *scene = load(*state, "{\"model\": \"square.obj\", \"scale\": 2}");
  assert_vec(scene->bounds_max, 2, 2, 0);
  assert_int_equal(scene->warning_count, 0);
  olx_scene_free(scene);
  scene = load(*state, "{\"models\": [{\"path\": \"square.obj\"}, {\"path\": \"square.obj\", \"scale\": 3, "
                       "\"rotate_degrees\": [0, 90, 0], \"translate\": [0, 0, -10]}]}");
  assert_int_equal(scene->triangle_count, 4);
  // The rotation turns x to -z.
  assert_vec(scene->bounds_min, 0, 0, -13);
  assert_vec(scene->bounds_max, 1, 3, 0);
  olx_scene_free(scene);
}

static void cameras_keep_order_and_names(void **state) {
  olx_scene *scene = load(*state, "{\"model\": \"square.obj\", \"scale\": 7, \"cameras\": ["
                                  "{\"name\": \"first\", \"eye\": [1, 2, 3], \"target\": [4, 5, 6], \"up\": [0, 0, 1], "
                                  "\"fov_y_degrees\": 35}, {\"eye\": [0, 0, 1], \"target\": [0, 0, 0]}]}");
  assert_int_equal(olx_scene_describe(scene).cameras, 2);
  olx_camera camera;
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  assert_string_equal(camera.name, "first");
  assert_vec(camera.eye, 1, 2, 3);
  assert_vec(camera.target, 4, 5, 6);
  assert_vec(camera.up, 0, 0, 1);
  assert_near(camera.fov_y_degrees, 35);
  assert_int_equal(olx_scene_find_camera(scene, "camera 2", &camera), OLX_OK);
  assert_vec(camera.up, 0, 1, 0);
  assert_near(camera.fov_y_degrees, 60);
  assert_int_equal(olx_scene_find_camera(scene, "third", &camera), OLX_ERROR_ARGUMENT);
  assert_non_null(strstr(olx_last_error(), "\"first\", \"camera 2\""));
  olx_scene_free(scene);
}

static void scene_without_cameras_is_seen_whole(void **state) {
  olx_scene *scene = load(*state, "{\"model\": \"square.obj\"}");
  olx_camera camera;
  assert_int_equal(olx_scene_find_camera(scene, NULL, &camera), OLX_OK);
  const olx_vec3 forward = olx_normalize(olx_sub(camera.target, camera.eye));
  for (uint32_t corner = 0; corner < 4; ++corner) {
    const olx_vec3 p = {(float)(corner & 1u), (float)(corner >> 1), 0.0f};
    const float cosine = olx_dot(olx_normalize(olx_sub(p, camera.eye)), forward);
    assert_true(acosf(cosine) <= 0.5f * camera.fov_y_degrees * OLX_PI / 180.0f);
  }
  olx_scene_free(scene);
}

static void lights_arrive(void **state) {
  olx_scene *scene =
      load(*state, "{\"model\": \"square.obj\", \"scale\": 9, \"lights\": ["
                   "{\"type\": \"sun\", \"direction\": [0, -3, 4], \"irradiance\": [10, 9, 8]},"
                   "{\"type\": \"rect\", \"center\": [0, 20, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [0, 0, 1], "
                   "\"radiance\": [17, 12, 4]},"
                   "{\"type\": \"point\", \"position\": [0, 2, 0], \"intensity\": [5, 5, 5]},"
                   "{\"type\": \"spot\", \"position\": [0, 2, 1], \"direction\": [0, -1, 0], \"intensity\": [9, 9, 9], "
                   "\"cone_degrees\": [30, 60]}]}");
  assert_int_equal(olx_scene_describe(scene).lights, 4);
  assert_int_equal(scene->light_count, 3);
  assert_int_equal(scene->lights[0].type, OLX_LIGHT_SUN);
  assert_vec(scene->lights[0].direction, 0, -0.6f, 0.8f);
  assert_vec(scene->lights[0].emission, 10, 9, 8);
  assert_int_equal(scene->lights[1].type, OLX_LIGHT_POINT);
  // Scale applies to the model alone.
  assert_vec(scene->lights[1].position, 0, 2, 0);
  assert_vec(scene->lights[2].emission, 9, 9, 9);
  assert_near(scene->lights[2].cosine_inner, sqrtf(0.75f));
  assert_near(scene->lights[2].cosine_outer, 0.5f);
  assert_int_equal(scene->triangle_count, 4);
  assert_vec(scene->bounds_max, 9, 20, 0.5f);
  const olx_material *lamp = &scene->materials[scene->material_index[3]];
  assert_vec(lamp->emission, 17, 12, 4);
  assert_vec(lamp->base_color, 0, 0, 0);
  olx_scene_free(scene);
}

static void environment_is_constant_or_an_image(void **state) {
  olx_scene *scene = load(*state, "{\"model\": \"square.obj\", \"environment\": {\"radiance\": [1, 2, 3]}}");
  assert_vec(scene->environment.radiance, 1, 2, 3);
  assert_null(scene->environment.texels);
  olx_scene_free(scene);
  // The file has two uncompressed texels: 2^(129-136) * 128 = 1 and twice that.
  const char header[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  uint8_t file[sizeof header - 1 + 8];
  memcpy(file, header, sizeof header - 1);
  memcpy(file + sizeof header - 1, (const uint8_t[8]){128, 64, 0, 129, 128, 128, 128, 130}, 8);
  scene_folder_write(*state, "sky.hdr", file, sizeof file);
  scene =
      load(*state, "{\"model\": \"square.obj\", \"environment\": {\"image\": \"sky.hdr\", \"rotation_degrees\": 90, "
                   "\"gain\": 3}}");
  assert_int_equal(scene->environment.width, 2);
  assert_int_equal(scene->environment.height, 1);
  const float *t = scene->environment.texels;
  assert_vec(olx_v3(t[0], t[1], t[2]), 1.0f, 0.5f, 0.0f);
  assert_vec(olx_v3(t[3], t[4], t[5]), 2.0f, 2.0f, 2.0f);
  assert_vec(scene->environment.radiance, 3, 3, 3);
  assert_near(scene->environment.rotation_radians, 0.5f * OLX_PI);
  olx_scene_free(scene);
}

static void materials_are_replaced_by_name_over_all(void **state) {
  olx_scene *scene = load(*state, "{\"model\": \"square.obj\", \"materials\": {"
                                  "\"square\": {\"base_color\": [0.1, 0.2, 0.3], \"emission\": [4, 5, 6]},"
                                  "\"*\": {\"base_color\": [0.7, 0.7, 0.7], \"roughness\": 0.25, \"metallic\": 1}}}");
  const olx_material *m = &scene->materials[0];
  assert_vec(m->base_color, 0.1f, 0.2f, 0.3f);
  assert_int_equal(m->base_color_texture, OLX_NO_TEXTURE);
  assert_near(m->roughness, 0.25f);
  assert_near(m->metallic, 1.0f);
  assert_near(m->specular_weight, 1.0f);
  assert_vec(m->emission, 4, 5, 6);
  olx_scene_free(scene);
  scene = load(*state, "{\"model\": \"square.obj\", \"materials\": {\"*\": {\"roughness\": 0.5, \"specular\": 0}}}");
  assert_near(scene->materials[0].specular_weight, 0.0f);
  assert_int_not_equal(scene->materials[0].base_color_texture, OLX_NO_TEXTURE);
  olx_scene_free(scene);
}

// Writes a square with a material whose texture 0 is that image.
static void write_textured(const scene_folder *folder, const char *name, const char *material, const char *image) {
  char materials[256], more[128];
  snprintf(materials, sizeof materials, "[%s]", material);
  snprintf(more, sizeof more, ", \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": \"%s\"}]", image);
  char *gltf = scene_files_gltf(materials, 0, "[{\"mesh\": 0}]", more, false);
  scene_folder_write_text(folder, name, gltf);
  free(gltf);
}

static void replaced_color_keeps_the_mask(void **state) {
  write_textured(*state, "leaf.gltf",
                 "{\"name\": \"leaf\", \"alphaMode\": \"MASK\", \"pbrMetallicRoughness\": "
                 "{\"baseColorTexture\": {\"index\": 0}}}",
                 "four.tga");
  olx_scene *scene =
      load(*state, "{\"model\": \"leaf.gltf\", \"materials\": {\"leaf\": {\"base_color\": [0.1, 0.5, 0.1]}}}");
  const olx_material *m = &scene->materials[0];
  assert_int_equal(m->base_color_texture, OLX_NO_TEXTURE);
  const olx_texture *mask = &scene->textures[m->alpha_texture];
  assert_int_equal(mask->texels[0], 255);
  assert_int_equal(mask->texels[12], 0); // the lower right texel is cut out
  olx_scene_free(scene);
}

// Roughness and metallic share a texture: green and blue.
static void a_texture_keeps_what_is_not_replaced(void **state) {
  const uint8_t texel[4] = {10, 20, 30, 255};
  uint8_t tga[18 + 4] = {0, 0, 2, [12] = 1, [14] = 1, [16] = 32, [17] = 8 | 32, 30, 20, 10, 255};
  scene_folder_write(*state, "rough.tga", tga, sizeof tga);
  write_textured(*state, "wood.gltf",
                 "{\"name\": \"wood\", \"pbrMetallicRoughness\": {\"metallicRoughnessTexture\": {\"index\": 0}}}",
                 "rough.tga");
  const struct {
    const char *change;
    uint8_t green, blue;
    float roughness, metallic;
  } cases[] = {{"\"roughness\": 0.5", 255, texel[2], 0.5f, 1.0f},
               {"\"metallic\": 0.5", texel[1], 255, 1.0f, 0.5f},
               {"\"roughness\": 0.5}, \"wood\": {\"metallic\": 0.25", 255, 255, 0.5f, 0.25f}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
    char text[256];
    snprintf(text, sizeof text, "{\"model\": \"wood.gltf\", \"materials\": {\"*\": {%s}}}", cases[i].change);
    olx_scene *scene = load(*state, text);
    const olx_material *m = &scene->materials[0];
    assert_int_not_equal(m->metallic_roughness_texture, OLX_NO_TEXTURE);
    const olx_texture *kept = &scene->textures[m->metallic_roughness_texture];
    assert_int_equal(kept->texels[1], cases[i].green);
    assert_int_equal(kept->texels[2], cases[i].blue);
    assert_near(m->roughness, cases[i].roughness);
    assert_near(m->metallic, cases[i].metallic);
    olx_scene_free(scene);
  }
  olx_scene *scene =
      load(*state, "{\"model\": \"wood.gltf\", \"materials\": {\"*\": {\"roughness\": 0.5, \"metallic\": 0}}}");
  assert_int_equal(scene->materials[0].metallic_roughness_texture, OLX_NO_TEXTURE);
  olx_scene_free(scene);
}

// The flat has a sun, a lamp and a sky. Lamps that are twice as far away are four times as strong.
static void lights_of_built_in_scenes_are_placed(void **state) {
  olx_scene *alone = NULL;
  assert_int_equal(olx_scene_load("builtin:flat", &alone), OLX_OK);
  olx_scene *placed = load(*state, "{\"model\": \"builtin:flat\", \"scale\": 2, \"rotate_degrees\": [0, 90, 0], "
                                   "\"translate\": [10, 0, 0]}");
  assert_int_equal(placed->light_count, alone->light_count);
  uint32_t suns = 0, points = 0;
  for (uint32_t i = 0; i < alone->light_count; i++) {
    const olx_light *was = &alone->lights[i], *is = &placed->lights[i];
    const olx_vec3 d = was->direction, p = was->position, e = was->emission;
    suns += was->type == OLX_LIGHT_SUN;
    points += was->type == OLX_LIGHT_POINT;
    if (was->type == OLX_LIGHT_SUN) {
      assert_vec(is->direction, d.z, d.y, -d.x);
      assert_vec(is->emission, e.x, e.y, e.z);
    } else {
      assert_vec(is->position, 10.0f + 2.0f * p.z, 2.0f * p.y, -2.0f * p.x);
      assert_vec(is->emission, 4.0f * e.x, 4.0f * e.y, 4.0f * e.z);
    }
  }
  assert_int_equal(suns, 1);
  assert_int_equal(points, 1);
  const olx_vec3 sky = alone->environment.radiance;
  assert_vec(placed->environment.radiance, sky.x, sky.y, sky.z);
  olx_scene_free(placed);
  placed = load(*state, "{\"model\": \"builtin:flat\", \"environment\": {\"radiance\": [0, 0, 0]}}");
  assert_vec(placed->environment.radiance, 0, 0, 0);
  olx_scene_free(placed);
  olx_scene_free(alone);
}

// A built-in scene can be a model, or a part beside one: it is placed like others, but its lamps remain lamps, and it
// has no volume of probes.
static void built_in_scenes_are_models(void **state) {
  olx_scene *alone = NULL;
  assert_int_equal(olx_scene_load("builtin:statue", &alone), OLX_OK);
  const olx_scene_info was = olx_scene_describe(alone);
  olx_scene *scene =
      load(*state, "{\"model\": \"square.obj\", \"models\": [{\"path\": \"builtin:statue\", \"scale\": 2,"
                   "  \"rotate_degrees\": [0, 90, 0], \"translate\": [10, 0, 0]}],"
                   "\"materials\": {\"*\": {\"roughness\": 0.5}, \"staff\": {\"roughness\": 0.25}}}");
  const olx_scene_info info = olx_scene_describe(scene);
  assert_int_equal(info.triangles, was.triangles + 2);
  assert_int_equal(info.lights, 1);
  assert_false(info.has_probe_volume);
  // A quarter turn about y maps (x, y, z) to (z, y, -x).
  assert_near(info.bounds_max.y, 2.0f * was.bounds_max.y);
  assert_near(info.bounds_max.x, 10.0f + 2.0f * was.bounds_max.z);
  const olx_camera before = olx_scene_camera(alone, 0), after = olx_scene_camera(scene, 0);
  assert_vec(after.eye, 10.0f + 2.0f * before.eye.z, 2.0f * before.eye.y, -2.0f * before.eye.x);
  assert_vec(after.up, 0.0f, 1.0f, 0.0f);
  uint32_t lamps = 0;
  for (uint32_t i = 0; i < scene->material_count; i++) {
    const olx_material *material = &scene->materials[i];
    const bool lamp = olx_max3(material->emission) > 0.0f;
    lamps += lamp;
    assert_near(material->specular_weight, lamp ? 0.0f : 1.0f);
    assert_near(material->roughness, lamp ? 1.0f : strcmp(material->name, "staff") == 0 ? 0.25f : 0.5f);
  }
  assert_int_equal(lamps, 1);
  olx_scene_free(scene);
  olx_scene_free(alone);
}

static void probe_volume_and_counts(void **state) {
  olx_scene *scene = load(*state, "{\"model\": \"square.obj\", \"probes\": {\"min\": [-1, 0, 2], \"max\": [1, 3, 2], "
                                  "\"grid\": [3, 4, 1]}}");
  olx_grid grid;
  assert_true(olx_scene_describe(scene).has_probe_volume && olx_scene_describe(scene).has_probe_count);
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  assert_int_equal(grid.count[0] * 100 + grid.count[1] * 10 + grid.count[2], 341);
  assert_vec(grid.origin, -1, 0, 2);
  assert_vec(grid.spacing, 1, 1, 0);
  const uint32_t finer[3] = {5, 2, 1};
  assert_int_equal(olx_scene_probe_grid(scene, finer, &grid), OLX_OK);
  assert_vec(grid.origin, -1, 0, 2);
  assert_vec(grid.spacing, 0.5f, 3, 0);
  olx_scene_free(scene);
}

static void without_probe_volume_the_bounds_are_filled(void **state) {
  olx_scene *scene = load(*state, "{\"models\": [{\"path\": \"square.obj\", \"scale\": 8}, {\"path\": \"square.obj\", "
                                  "\"translate\": [0, 0, 4]}]}");
  olx_grid grid;
  assert_false(olx_scene_describe(scene).has_probe_volume || olx_scene_describe(scene).has_probe_count);
  assert_int_equal(olx_scene_probe_grid(scene, NULL, &grid), OLX_OK);
  assert_int_equal(grid.count[0], 4);
  assert_vec(grid.origin, 1, 1, 0.5f);
  assert_vec(grid.spacing, 2, 2, 1);
  const uint32_t counts[3] = {1, 2, 8}, none[3] = {4, 0, 4}, huge[3] = {65536, 65536, 2};
  assert_int_equal(olx_scene_probe_grid(scene, counts, &grid), OLX_OK);
  assert_vec(grid.origin, 4, 2, 0.25f);
  assert_vec(grid.spacing, 0, 4, 0.5f);
  assert_int_equal(olx_scene_probe_grid(scene, none, &grid), OLX_ERROR_ARGUMENT);
  assert_int_equal(olx_scene_probe_grid(scene, huge, &grid), OLX_ERROR_ARGUMENT);
  olx_scene_free(scene);
}

static void unknown_keys_warn_with_their_place(void **state) {
  olx_scene *scene = load(*state, "{\"model\": \"square.obj\", \"lihgts\": [], \"cameras\": [{\"eye\": [0, 0, 1], "
                                  "\"target\": [0, 0, 0], \"fov\": 3}], \"materials\": {\"floor\": {\"base_color\": "
                                  "[0.5, 0.5, 0.5]}}}");
  assert_int_equal(olx_scene_describe(scene).warnings, 3);
  assert_true(has_warning(scene, "\"lihgts\""));
  assert_true(has_warning(scene, "\"cameras[0].fov\""));
  assert_true(has_warning(scene, "materials.floor"));
  assert_non_null(strstr(olx_scene_warning(scene, 0), "scene.json"));
  assert_null(olx_scene_warning(scene, 3));
  assert_null(olx_scene_warning(scene, UINT32_MAX));
  const olx_camera none = olx_scene_camera(scene, olx_scene_describe(scene).cameras);
  assert_true(none.name[0] == 0 && none.fov_y_degrees == 0.0f);
  olx_scene_free(scene);
}

static void description_says_what_placement_keeps_to(void **state) {
  olx_scene *scene =
      load(*state, "{\"model\": \"square.obj\", \"probes\": {\"pinned\": [[1, 2, 3], [4, 5, 6]], "
                   "\"forbidden\": [{\"min\": [0, 1, 2], \"max\": [3, 4, 5]}], "
                   "\"playable\": {\"min\": [-1, -2, -3], \"max\": [1, 2, 3]}, \"min_distance\": 0.25}}");
  const olx_probe_rules *rules = &scene->probe_rules;
  assert_int_equal(rules->pinned_count, 2);
  assert_true(rules->pinned[1].x == 4.0f && rules->pinned[1].z == 6.0f);
  assert_int_equal(rules->forbidden_count, 1);
  assert_true(rules->forbidden[0].min.y == 1.0f && rules->forbidden[0].max.z == 5.0f);
  assert_true(rules->has_playable && rules->playable.min.x == -1.0f && rules->playable.max.y == 2.0f);
  assert_true(rules->min_distance == 0.25f);
  assert_false(scene->has_probe_volume);
  olx_scene_free(scene);
}

static void description_does_not_change_the_hash_by_cameras_or_probes(void **state) {
  olx_scene *plain = load(*state, "{\"model\": \"square.obj\"}");
  olx_scene *seen =
      load(*state, "{\"model\": \"square.obj\", \"cameras\": [{\"eye\": [0, 0, 1], \"target\": [0, 0, 0]}], "
                   "\"probes\": {\"min\": [0, 0, 0], \"max\": [1, 1, 1]}}");
  olx_scene *lit = load(*state, "{\"model\": \"square.obj\", \"environment\": {\"radiance\": [1, 1, 1]}}");
  assert_true(plain->hash == seen->hash);
  assert_true(plain->hash != lit->hash);
  olx_scene_free(plain);
  olx_scene_free(seen);
  olx_scene_free(lit);
}

static void models_are_found_in_octalux_scenes(void **state) {
  scene_folder elsewhere;
  assert_true(scene_folder_create(&elsewhere));
  scene_folder_write_text(&elsewhere, "other.obj", "v 0 0 0\nv 5 0 0\nv 0 5 0\nf 1 2 3\n");
  const char *before = getenv("OCTALUX_SCENES");
  char *saved = before ? strdup(before) : NULL, folders[600], text[700];
  snprintf(folders, sizeof folders, "/nonexistent::%s", elsewhere.path);
  setenv("OCTALUX_SCENES", folders, 1);
  olx_scene *scene = load(*state, "{\"model\": \"other.obj\"}");
  assert_vec(scene->bounds_max, 5, 5, 0);
  olx_scene_free(scene);
  unsetenv("OCTALUX_SCENES");
  snprintf(text, sizeof text, "{\"model\": \"%s/other.obj\"}", elsewhere.path);
  olx_scene_free(load(*state, text));
  olx_scene *none = NULL;
  const char *path = scene_folder_write_text(*state, "scene.json", "{\"model\": \"other.obj\"}");
  assert_int_equal(olx_scene_load(path, &none), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "scene.json: model: other.obj"));
  if (saved) setenv("OCTALUX_SCENES", saved, 1);
  free(saved);
  scene_folder_remove(&elsewhere);
}

static void wrong_descriptions_are_refused_with_their_place(void **state) {
  const struct {
    const char *keys, *place;
  } wrong[] = {
      {"\"scale\": 0", "scale"},
      {"\"scale\": -1", "scale"},
      {"\"scale\": \"two\"", "scale: expected a finite number"},
      {"\"scale\": 1e999", "scale"},
      {"\"cameras\": {}", "cameras: expected a list"},
      {"\"cameras\": [7]", "cameras[0]: expected an object"},
      {"\"cameras\": [{\"eye\": [0, 0], \"target\": [1, 1, 1]}]", "cameras[0].eye: expected three"},
      {"\"cameras\": [{\"eye\": [0, 0, 0]}]", "cameras[0].target: missing"},
      {"\"cameras\": [{\"eye\": [1, 1, 1], \"target\": [1, 1, 1]}]", "cameras[0].target"},
      {"\"cameras\": [{\"eye\": [0, 0, 0], \"target\": [0, 3, 0]}]", "cameras[0].up"},
      {"\"cameras\": [{\"eye\": [0, 0, 0], \"target\": [1, 0, 0], \"fov_y_degrees\": 180}]",
       "cameras[0].fov_y_degrees"},
      {"\"lights\": [{\"type\": \"lamp\"}]", "lights[0].type"},
      {"\"lights\": [{\"type\": \"sun\", \"direction\": [0, 0, 0], \"irradiance\": [1, 1, 1]}]", "lights[0].direction"},
      {"\"lights\": [{\"type\": \"point\", \"position\": [0, 0, 0], \"intensity\": [1, -1, 1]}]",
       "lights[0].intensity"},
      {"\"lights\": [{\"type\": \"point\", \"position\": [0, 0, 1e39], \"intensity\": [1, 1, 1]}]",
       "lights[0].position"},
      {"\"lights\": [{\"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": [0, 1, 0], \"intensity\": [1, 1, 1], "
       "\"cone_degrees\": [40, 20]}]",
       "lights[0].cone_degrees"},
      {"\"lights\": [{\"type\": \"rect\", \"center\": [0, 0, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [2, 0, 0], "
       "\"radiance\": [1, 1, 1]}]",
       "lights[0].edge_v"},
      {"\"environment\": [1, 1, 1]", "environment: expected an object"},
      {"\"environment\": {\"radiance\": [0, 0, -1]}", "environment.radiance"},
      {"\"environment\": {\"image\": \"gone.hdr\"}", "environment.image: gone.hdr"},
      {"\"environment\": {\"image\": \"four.tga\"}", "four.tga"},
      {"\"environment\": {\"image\": \"four.tga\", \"radiance\": [1, 1, 1]}", "environment.radiance"},
      {"\"materials\": []", "materials: expected an object"},
      {"\"materials\": {\"square\": {\"roughness\": 2}}", "materials.square.roughness"},
      {"\"materials\": {\"square\": {\"base_color\": [2, 0, 0]}}", "materials.square.base_color"},
      {"\"probes\": {\"min\": [0, 0, 0]}", "probes.max: missing"},
      {"\"probes\": {\"min\": [0, 0, 0], \"max\": [1, -1, 1]}", "probes.max"},
      {"\"probes\": {\"grid\": [4, 4, 0]}", "probes.grid"},
      {"\"probes\": {\"pinned\": [[0, 0, 0], [1, 2]]}", "probes.pinned[1]"},
      {"\"probes\": {\"pinned\": 3}", "probes.pinned"},
      {"\"probes\": {\"forbidden\": {}}", "probes.forbidden"},
      {"\"probes\": {\"forbidden\": [{\"min\": [0, 0, 0]}]}", "probes.forbidden[0].max: missing"},
      {"\"probes\": {\"playable\": {\"min\": [0, 0, 0], \"max\": [1, 1, -1]}}", "probes.playable.max"},
      {"\"probes\": {\"min_distance\": -1}", "probes.min_distance"},
      {"\"probes\": {\"grid\": [4, 4, 2.5]}", "probes.grid"},
      {"\"probes\": {\"grid\": [4, 4, 4294967295]}", "probes.grid"},
      {"\"models\": [{\"path\": \"gone.obj\"}]", "models[0].path: gone.obj"},
      {"\"models\": [{\"scale\": 2}]", "models[0].path: missing"},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
    char text[512];
    snprintf(text, sizeof text, "{\"model\": \"square.obj\", %s}", wrong[i].keys);
    olx_scene *scene = NULL;
    const olx_result result = olx_scene_load(scene_folder_write_text(*state, "wrong.json", text), &scene);
    if (result == OLX_OK) fail_msg("accepted: %s", text);
    assert_null(scene);
    if (!strstr(olx_last_error(), "wrong.json") || !strstr(olx_last_error(), wrong[i].place)) {
      fail_msg("%s: \"%s\" does not name it", text, olx_last_error());
    }
  }
}

static void text_that_is_no_description_is_refused(void **state) {
  const char *texts[] = {"",
                         "{",
                         "[]",
                         "null",
                         "{}",
                         "{\"models\": []}",
                         "{\"model\": 3}",
                         "{\"model\": \"\"}",
                         "{\"model\": NaN}",
                         "{\"model\": \"square.obj\"} x",
                         "{\"model\": \"scene.json\"}"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i) {
    olx_scene *scene = NULL;
    assert_int_not_equal(olx_scene_load(scene_folder_write_text(*state, "scene.json", texts[i]), &scene), OLX_OK);
    if (!strstr(olx_last_error(), "scene.json")) fail_msg("%s: \"%s\"", texts[i], olx_last_error());
  }
}

// Returns the distance to the nearest surface; a camera or light inside a wall would see the wall's sides close by.
static float nearest_surface(const olx_scene *scene, olx_vec3 point) {
  float nearest = INFINITY;
  for (uint32_t i = 0; i < 1000; ++i) {
    const olx_ray ray = {
        .origin = point, .direction = olx_sample_sphere(olx_hammersley(i, 1000)), .t_min = 0.0f, .t_max = INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle != OLX_NO_HIT) nearest = olx_min(nearest, hit.t);
  }
  return nearest;
}

static void real_descriptions_put_cameras_into_free_space(void **state) {
  (void)state;
  const char *names[] = {"sponza",      "living-room", "white-room",    "kitchen",     "veach-ajar",
                         "godot-rooms", "small-house", "cornell-faint", "sponza-wang", "temple-wang"};
  char folder[4096];
  if (!scene_files_real("sponza/sponza.gltf", folder, sizeof folder)) {
    print_message("the real scenes are not there: skipped\n");
    skip();
  }
  if (!getenv("OCTALUX_SCENES")) setenv("OCTALUX_SCENES", OLX_SOURCE_DIR "/../shared/scenes", 1);
  for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
    char path[4096];
    snprintf(path, sizeof path, "%s/scenes/%s.json", OLX_SOURCE_DIR, names[i]);
    olx_scene *scene = NULL;
    if (olx_scene_load(path, &scene) != OLX_OK) fail_msg("%s", olx_last_error());
    const olx_scene_info info = olx_scene_describe(scene);
    assert_true(info.cameras >= 1 && info.has_probe_volume);
    assert_true(info.lights >= 1);
    for (uint32_t k = 0; k < info.cameras; ++k) {
      const olx_camera camera = olx_scene_camera(scene, k);
      if (nearest_surface(scene, camera.eye) < 0.2f) fail_msg("%s: camera %s touches a wall", path, camera.name);
    }
    olx_scene_free(scene);
  }
}

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, set_up, scene_folder_tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_FOLDER(model_is_scaled_rotated_and_moved),
      WITH_FOLDER(cameras_keep_order_and_names),
      WITH_FOLDER(scene_without_cameras_is_seen_whole),
      WITH_FOLDER(lights_arrive),
      WITH_FOLDER(environment_is_constant_or_an_image),
      WITH_FOLDER(materials_are_replaced_by_name_over_all),
      WITH_FOLDER(built_in_scenes_are_models),
      WITH_FOLDER(lights_of_built_in_scenes_are_placed),
      WITH_FOLDER(a_texture_keeps_what_is_not_replaced),
      WITH_FOLDER(replaced_color_keeps_the_mask),
      WITH_FOLDER(probe_volume_and_counts),
      WITH_FOLDER(without_probe_volume_the_bounds_are_filled),
      WITH_FOLDER(unknown_keys_warn_with_their_place),
      WITH_FOLDER(description_says_what_placement_keeps_to),
      WITH_FOLDER(description_does_not_change_the_hash_by_cameras_or_probes),
      WITH_FOLDER(models_are_found_in_octalux_scenes),
      WITH_FOLDER(wrong_descriptions_are_refused_with_their_place),
      WITH_FOLDER(text_that_is_no_description_is_refused),
      WITH_FOLDER(real_descriptions_put_cameras_into_free_space),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
