// Tests that cooked scenes come back to the last bit, and that files that are not cooked scenes are refused with a
// message.
#include "cooked_scenes.h"
#include "core/hooks.h"
#include "core/sampling.h"
#include "scene/cooked/texel_code.h"
#include "tiny_scenes.h"

#include <octalux/bake.h>

#include <math.h>

typedef struct fixture {
  scene_folder folder;
  char cooked[400], again[400];
} fixture;

static int set_up(void **state) {
  fixture *f = calloc(1, sizeof *f);
  if (!f || !scene_folder_create(&f->folder)) return 1;
  snprintf(f->cooked, sizeof f->cooked, "%s/scene.olxs", f->folder.path);
  snprintf(f->again, sizeof f->again, "%s/again.olxs", f->folder.path);
  *state = f;
  return 0;
}

static int tear_down(void **state) {
  fixture *f = *state;
  scene_folder_remove(&f->folder);
  free(f);
  return 0;
}

static void assert_same_file(const char *path_a, const char *path_b) {
  cooked_bytes a = cooked_bytes_read(path_a), b = cooked_bytes_read(path_b);
  assert_int_equal(a.size_bytes, b.size_bytes);
  assert_memory_equal(a.bytes, b.bytes, a.size_bytes);
  cooked_bytes_free(&a);
  cooked_bytes_free(&b);
}

static void assert_same_bytes(const void *a, const void *b, size_t size_bytes) {
  if (size_bytes) assert_memory_equal(a, b, size_bytes);
}

static void assert_same_scene(const olx_scene *a, const olx_scene *b) {
  assert_true(a->hash == b->hash); // covers geometry, materials, textures, lights and environment
  assert_int_equal(a->camera_count, b->camera_count);
  for (uint32_t i = 0; i < a->camera_count; i++) {
    assert_string_equal(a->cameras[i].name, b->cameras[i].name);
    assert_same_bytes(&a->cameras[i].eye, &b->cameras[i].eye, 9 * sizeof(float));
    assert_true(a->cameras[i].fov_y_degrees == b->cameras[i].fov_y_degrees);
  }
  for (uint32_t i = 0; i < a->material_count; i++) assert_string_equal(a->materials[i].name, b->materials[i].name);
  assert_int_equal(a->has_probe_volume, b->has_probe_volume);
  assert_int_equal(a->has_probe_count, b->has_probe_count);
  assert_same_bytes(&a->probes_min, &b->probes_min, sizeof a->probes_min);
  assert_same_bytes(&a->probes_max, &b->probes_max, sizeof a->probes_max);
  assert_same_bytes(a->probes_count, b->probes_count, sizeof a->probes_count);
  const olx_probe_rules *p = &a->probe_rules, *q = &b->probe_rules;
  assert_int_equal(p->pinned_count, q->pinned_count);
  assert_int_equal(p->forbidden_count, q->forbidden_count);
  assert_same_bytes(p->pinned, q->pinned, p->pinned_count * sizeof *p->pinned);
  assert_same_bytes(p->forbidden, q->forbidden, p->forbidden_count * sizeof *p->forbidden);
  assert_int_equal(p->has_playable, q->has_playable);
  assert_same_bytes(&p->playable, &q->playable, sizeof p->playable);
  assert_true(p->min_distance == q->min_distance);
  assert_int_equal(a->area_light_count, b->area_light_count);
  assert_int_equal(a->warning_count, b->warning_count);
  for (uint32_t i = 0; i < a->warning_count; i++) assert_string_equal(a->warnings[i], b->warnings[i]);
}

// Cooks a scene, loads and compares it, and cooks the loaded scene again.
static void check_round_trip(const fixture *f, const char *name) {
  olx_scene *scene, *loaded;
  uint64_t file_bytes = 0;
  ASSERT_OK(olx_scene_load(name, &scene));
  ASSERT_OK(olx_scene_cook(scene, f->cooked, &file_bytes));
  ASSERT_OK(olx_scene_load(f->cooked, &loaded));
  assert_same_scene(scene, loaded);
  ASSERT_OK(olx_scene_cook(loaded, f->again, NULL));
  assert_same_file(f->cooked, f->again);
  cooked_bytes bytes = cooked_bytes_read(f->cooked);
  assert_int_equal(bytes.size_bytes, file_bytes);
  cooked_bytes_free(&bytes);
  olx_scene_free(scene);
  olx_scene_free(loaded);
}

static void test_built_in_scenes_come_back(void **state) {
  for (uint32_t i = 0; olx_builtin_name(i); i++) {
    char name[64];
    snprintf(name, sizeof name, "builtin:%s", olx_builtin_name(i));
    check_round_trip(*state, name);
  }
}

static void test_a_scene_with_everything_comes_back(void **state) {
  const fixture *f = *state;
  const char *path = cooked_scenes_everything(&f->folder);
  olx_scene *scene;
  ASSERT_OK(olx_scene_load(path, &scene));
  // The scene has every feature that the test relies on.
  assert_true(scene->texture_count >= 2 && scene->light_count == 3 && scene->camera_count == 2);
  assert_true(scene->environment.texels && scene->warning_count > 0 && scene->probe_rules.pinned_count == 2);
  olx_scene_free(scene);
  check_round_trip(f, path);
}

// Content that is read alone, and the content of the loaded scene, agree with the original scene.
static void test_content_is_read_without_a_ray_caster(void **state) {
  const fixture *f = *state;
  olx_scene *scene;
  olx_scene_content *loaded;
  assert_int_equal(olx_scene_load(cooked_scenes_everything(&f->folder), &scene), OLX_OK);
  assert_int_equal(olx_scene_cook(scene, f->cooked, NULL), OLX_OK);
  assert_int_equal(olx_scene_content_load(f->cooked, &loaded), OLX_OK);
  const olx_scene_content own = olx_scene_get_content(scene), *a = loaded, *b = &own;
  assert_true(a->hash == b->hash && b->hash == scene->hash);
  assert_int_equal(a->vertex_count, b->vertex_count);
  assert_int_equal(a->triangle_count, b->triangle_count);
  assert_int_equal(a->texture_count, b->texture_count);
  assert_same_bytes(a->positions, b->positions, a->vertex_count * sizeof *a->positions);
  assert_same_bytes(a->indices, b->indices, 3 * a->triangle_count * sizeof *a->indices);
  assert_int_equal(a->material_count, b->material_count);
  for (uint32_t i = 0; i < a->material_count; i++) assert_string_equal(a->materials[i].name, b->materials[i].name);
  assert_int_equal(a->light_count, scene->light_count);
  assert_int_equal(a->camera_count, scene->camera_count);
  assert_same_bytes(&a->bounds_min, &b->bounds_min, sizeof a->bounds_min);
  assert_same_bytes(&a->bounds_max, &b->bounds_max, sizeof a->bounds_max);
  assert_ptr_equal(b->positions, scene->positions);
  olx_scene_content_free(loaded);
  olx_scene_free(scene);
  assert_int_not_equal(olx_scene_content_load(f->again, &loaded), OLX_OK);
  assert_null(loaded);
  assert_non_null(strstr(olx_last_error(), f->again));
  olx_scene_content_free(NULL);
}

static void test_a_cooked_scene_needs_no_source(void **state) {
  const fixture *f = *state;
  olx_scene *scene, *loaded;
  ASSERT_OK(olx_scene_load(cooked_scenes_everything(&f->folder), &scene));
  ASSERT_OK(olx_scene_cook(scene, f->cooked, NULL));
  const char *const sources[] = {"everything.json", "square.obj", "square.mtl", "four.tga", "sky.hdr"};
  for (size_t i = 0; i < sizeof sources / sizeof *sources; i++) {
    char path[400];
    snprintf(path, sizeof path, "%s/%s", f->folder.path, sources[i]);
    assert_int_equal(remove(path), 0);
  }
  ASSERT_OK(olx_scene_load_cooked(f->cooked, &loaded));
  assert_same_scene(scene, loaded);
  olx_scene_free(scene);
  olx_scene_free(loaded);
}

static void bake_to(const char *scene_name, const char *path) {
  olx_scene *scene;
  ASSERT_OK(olx_scene_load(scene_name, &scene));
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = 32;
  settings.irradiance_size = 8;
  settings.bounces = 0;
  settings.grid.count[0] = settings.grid.count[1] = settings.grid.count[2] = 1;
  settings.irradiance_grid = settings.grid;
  ASSERT_OK(olx_bake(scene, &settings, path, NULL, NULL));
  olx_scene_free(scene);
}

static void test_a_bake_from_the_cooked_scene_has_the_same_bytes(void **state) {
  const fixture *f = *state;
  char field_a[400], field_b[400];
  snprintf(field_a, sizeof field_a, "%s/a.olx", f->folder.path);
  snprintf(field_b, sizeof field_b, "%s/b.olx", f->folder.path);
  const char *const names[] = {"builtin:cornell-glossy", cooked_scenes_everything(&f->folder)};
  for (size_t i = 0; i < 2; i++) {
    olx_scene *scene;
    ASSERT_OK(olx_scene_load(names[i], &scene));
    ASSERT_OK(olx_scene_cook(scene, f->cooked, NULL));
    olx_scene_free(scene);
    bake_to(names[i], field_a);
    bake_to(f->cooked, field_b);
    assert_same_file(field_a, field_b);
  }
}

// ---- texels

static olx_texture make_texture(uint32_t width, uint32_t height) {
  const olx_texture t = {.width = width, .height = height, .texels = olx_allocate_zero((size_t)width * height, 4)};
  assert_non_null(t.texels);
  return t;
}

enum { PATTERN_FLAT, PATTERN_RAMP, PATTERN_NOISE, PATTERN_EDGES, PATTERN_COUNT };

static void draw_pattern(const olx_texture *t, int pattern, uint32_t channels) {
  for (uint32_t i = 0; i < t->width * t->height; i++) {
    const uint32_t x = i % t->width, y = i / t->width;
    uint8_t *rgba = t->texels + 4 * i;
    for (uint32_t c = 0; c < 4; c++) {
      const uint32_t of = channels == 1 && c < 3 ? 0 : c; // the three channels of grey are the same
      const uint32_t values[PATTERN_COUNT] = {77, (x + y) / 2 + 40 * of, olx_hash3(x, y, of),
                                              ((x / 3 + y / 2 + of) & 1) * 255};
      rgba[c] = (uint8_t)(c == 3 && channels < 4 ? 255 : values[pattern]);
    }
  }
}

static void test_texels_come_back_whatever_they_are(void **state) {
  (void)state;
  const uint32_t sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {16, 16}, {37, 21}};
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    for (int pattern = 0; pattern < PATTERN_COUNT; pattern++) {
      for (uint32_t channels = 1; channels <= 4; channels += channels == 1 ? 2 : 1) {
        olx_texture t = make_texture(sizes[s][0], sizes[s][1]), back = make_texture(sizes[s][0], sizes[s][1]);
        draw_pattern(&t, pattern, channels);
        assert_true(olx_texel_channels(&t) <= channels);
        olx_byte_buffer code = {0};
        assert_true(olx_texel_encode(&t, channels, &code));
        assert_true(olx_texel_decode(code.data, code.size_bytes, channels, &back));
        assert_memory_equal(t.texels, back.texels, (size_t)t.width * t.height * 4);
        // Code that is one byte shorter or longer is refused.
        assert_false(olx_texel_decode(code.data, code.size_bytes - 1, channels, &back));
        uint8_t *longer = calloc(code.size_bytes + 1, 1);
        memcpy(longer, code.data, code.size_bytes);
        assert_false(olx_texel_decode(longer, code.size_bytes + 1, channels, &back));
        free(longer);
        olx_release(code.data);
        olx_release(t.texels);
        olx_release(back.texels);
      }
    }
  }
}

static void test_texels_store_the_channels_that_they_need(void **state) {
  (void)state;
  for (uint32_t channels = 1; channels <= 4; channels += channels == 1 ? 2 : 1) {
    olx_texture t = make_texture(8, 8);
    draw_pattern(&t, PATTERN_NOISE, channels);
    assert_int_equal(olx_texel_channels(&t), channels);
    olx_release(t.texels);
  }
}

static void test_smooth_texels_shrink_and_noise_hardly_grows(void **state) {
  (void)state;
  olx_texture t = make_texture(128, 128);
  olx_byte_buffer smooth = {0}, noise = {0};
  draw_pattern(&t, PATTERN_RAMP, 3);
  assert_true(olx_texel_encode(&t, 3, &smooth));
  assert_true(smooth.size_bytes < 128 * 128 * 3 / 4);
  draw_pattern(&t, PATTERN_NOISE, 3);
  assert_true(olx_texel_encode(&t, 3, &noise));
  assert_true(noise.size_bytes < 128 * 128 * 3 * 9 / 8);
  olx_release(smooth.data);
  olx_release(noise.data);
  olx_release(t.texels);
}

// ---- refusals

static cooked_bytes cook_everything(const fixture *f) {
  olx_scene *scene;
  ASSERT_OK(olx_scene_load(cooked_scenes_everything(&f->folder), &scene));
  ASSERT_OK(olx_scene_cook(scene, f->cooked, NULL));
  olx_scene_free(scene);
  return cooked_bytes_read(f->cooked);
}

static void expect_refusal(const fixture *f, cooked_bytes file, olx_result wanted, const char *message) {
  olx_scene *scene = (olx_scene *)1;
  const char *path = scene_folder_write(&f->folder, "bad.olxs", file.bytes, file.size_bytes);
  assert_int_equal(olx_scene_load(path, &scene), wanted);
  assert_null(scene);
  if (!strstr(olx_last_error(), message) || !strstr(olx_last_error(), "bad.olxs")) {
    fail_msg("\"%s\" does not say \"%s\" of bad.olxs", olx_last_error(), message);
  }
}

static void test_files_that_are_no_cooked_scenes_are_refused(void **state) {
  const fixture *f = *state;
  cooked_bytes file = cook_everything(f);
  expect_refusal(f, (cooked_bytes){file.bytes, 0}, OLX_ERROR_FORMAT, "too short for a cooked scene");
  file.bytes[1] ^= 1;
  expect_refusal(f, file, OLX_ERROR_FORMAT, "not a cooked scene");
  file.bytes[1] ^= 1;
  ((olx_file_header *)file.bytes)->version = 2;
  expect_refusal(f, file, OLX_ERROR_VERSION, "newer");
  ((olx_file_header *)file.bytes)->version = 1;
  for (size_t size_bytes = 0; size_bytes < file.size_bytes; size_bytes += 61) {
    olx_scene *scene;
    const char *path = scene_folder_write(&f->folder, "short.olxs", file.bytes, size_bytes);
    assert_int_not_equal(olx_scene_load(path, &scene), OLX_OK);
  }
  cooked_bytes_free(&file);
}

static void test_a_flipped_bit_anywhere_is_found(void **state) {
  const fixture *f = *state;
  cooked_bytes file = cook_everything(f);
  for (size_t i = 0; i < file.size_bytes; i += 7) {
    file.bytes[i] ^= (uint8_t)(1u << i % 8);
    olx_scene *scene;
    const char *path = scene_folder_write(&f->folder, "flipped.olxs", file.bytes, file.size_bytes);
    assert_int_not_equal(olx_scene_load(path, &scene), OLX_OK);
    file.bytes[i] ^= (uint8_t)(1u << i % 8);
  }
  cooked_bytes_free(&file);
}

// Changes one number of a chunk, with all checksums right, and checks that the file is refused.
#define EXPECT_REFUSED(chunk, type, member, value, message)                                                            \
  do {                                                                                                                 \
    type *record_ = (void *)cooked_bytes_chunk(file, (chunk)).bytes;                                                   \
    const type before_ = *record_;                                                                                     \
    record_->member = (value);                                                                                         \
    cooked_bytes_seal(file);                                                                                           \
    expect_refusal(f, file, OLX_ERROR_FORMAT, (message));                                                              \
    *record_ = before_;                                                                                                \
    cooked_bytes_seal(file);                                                                                           \
  } while (0)

typedef struct material_record {
  uint32_t material;
} material_record;

typedef struct triangle_record {
  uint32_t corner[3];
} triangle_record;

static void test_numbers_that_cannot_be_are_refused_by_name(void **state) {
  const fixture *f = *state;
  cooked_bytes file = cook_everything(f);
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, triangles, 0, "triangles");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, triangles, 1000, "chunk TRIS");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, environment_width, 1 << 20, "environment");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, environment_radiance[0], -1.0f, "environment");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, probes_max[1], -7.0f, "volume of probes");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, probes_count[2], 0, "count of probes");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, playable_min[0], NAN, "playable");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, probe_flags, 8, "flags");
  EXPECT_REFUSED(OLX_COOKED_INFO, olx_cooked_info, warning_count, 7, "warning 1");
  EXPECT_REFUSED(OLX_COOKED_POSITIONS, olx_vec3, y, INFINITY, "vertex 0");
  EXPECT_REFUSED(OLX_COOKED_NORMALS, olx_vec3, z, 7.0f, "vertex 0");
  EXPECT_REFUSED(OLX_COOKED_UVS, olx_vec2, x, NAN, "vertex 0");
  EXPECT_REFUSED(OLX_COOKED_TRIANGLES, triangle_record, corner[1], 4000000000u, "triangle 0");
  EXPECT_REFUSED(OLX_COOKED_TRIANGLE_MATERIALS, material_record, material, 99, "triangle 0");
  EXPECT_REFUSED(OLX_COOKED_MATERIALS, olx_cooked_material, normal_texture, 99, "material 0");
  EXPECT_REFUSED(OLX_COOKED_MATERIALS, olx_cooked_material, roughness, 1.5f, "material 0");
  EXPECT_REFUSED(OLX_COOKED_MATERIALS, olx_cooked_material, emission[0], INFINITY, "material 0");
  EXPECT_REFUSED(OLX_COOKED_MATERIALS, olx_cooked_material, name[127], 'x', "material 0");
  EXPECT_REFUSED(OLX_COOKED_TEXTURES, olx_cooked_texture, width, 0, "texture 0");
  EXPECT_REFUSED(OLX_COOKED_TEXTURES, olx_cooked_texture, width, 16384, "texture 0");
  EXPECT_REFUSED(OLX_COOKED_TEXTURES, olx_cooked_texture, height, 3, "texture 0");
  EXPECT_REFUSED(OLX_COOKED_TEXTURES, olx_cooked_texture, channels, 2, "texture 0");
  EXPECT_REFUSED(OLX_COOKED_LIGHTS, olx_cooked_light, type, 3, "light 0");
  EXPECT_REFUSED(OLX_COOKED_LIGHTS, olx_cooked_light, direction[1], 0.0f, "light 0");
  EXPECT_REFUSED(OLX_COOKED_LIGHTS, olx_cooked_light, cosine_outer, 2.0f, "light 0");
  EXPECT_REFUSED(OLX_COOKED_CAMERAS, olx_cooked_camera, fov_y_degrees, 180.0f, "camera 0");
  EXPECT_REFUSED(OLX_COOKED_ENVIRONMENT, olx_vec3, x, -1.0f, "environment texel 0");
  EXPECT_REFUSED(OLX_COOKED_PINNED, olx_vec3, x, NAN, "pinned probe 0");
  EXPECT_REFUSED(OLX_COOKED_FORBIDDEN, olx_vec3, x, 5.0f, "forbidden box 0");
  olx_scene *scene; // the file loads once it is unchanged again
  ASSERT_OK(olx_scene_load(scene_folder_write(&f->folder, "good.olxs", file.bytes, file.size_bytes), &scene));
  olx_scene_free(scene);
  cooked_bytes_free(&file);
}

static void test_chunks_of_later_versions(void **state) {
  const fixture *f = *state;
  cooked_bytes file = cook_everything(f);
  olx_file_chunk *last = (olx_file_chunk *)(file.bytes + sizeof(olx_file_header)) + OLX_COOKED_WARNINGS;
  last->type = OLX_FOUR_CC('N', 'E', 'W', 'S');
  cooked_bytes_seal(file);
  expect_refusal(f, file, OLX_ERROR_FORMAT, "no chunk WARN");
  cooked_bytes_free(&file);
}

static void test_what_cannot_be_written_leaves_nothing(void **state) {
  const fixture *f = *state;
  olx_scene *scene;
  char path[500];
  snprintf(path, sizeof path, "%s/none/scene.olxs", f->folder.path);
  ASSERT_OK(olx_scene_load("builtin:furnace", &scene));
  assert_int_equal(olx_scene_cook(scene, path, NULL), OLX_ERROR_FILE);
  assert_non_null(strstr(olx_last_error(), "none/scene.olxs"));
  olx_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_built_in_scenes_come_back, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_a_scene_with_everything_comes_back, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_content_is_read_without_a_ray_caster, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_a_cooked_scene_needs_no_source, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_a_bake_from_the_cooked_scene_has_the_same_bytes, set_up, tear_down),
      cmocka_unit_test(test_texels_come_back_whatever_they_are),
      cmocka_unit_test(test_texels_store_the_channels_that_they_need),
      cmocka_unit_test(test_smooth_texels_shrink_and_noise_hardly_grows),
      cmocka_unit_test_setup_teardown(test_files_that_are_no_cooked_scenes_are_refused, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_a_flipped_bit_anywhere_is_found, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_numbers_that_cannot_be_are_refused_by_name, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_chunks_of_later_versions, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_what_cannot_be_written_leaves_nothing, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
