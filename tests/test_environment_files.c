// Tests images of environments as OpenEXR: their numbers, the repair of invalid numbers, their share of the limit on
// texels, and that exported models have none of their light.
#include "scene_files.h"
#include "tiny_scenes.h"

#include <octalux/export.h>
#include <octalux/render.h>

static void assert_warned(const olx_scene *scene, const char *part) {
  bool found = false;
  for (uint32_t i = 0; i < scene->warning_count; ++i) found |= strstr(scene->warnings[i], part) != NULL;
  assert_true(found);
}

// Checks that an exported model says that its sky is black.
static void assert_exported_black(const olx_scene *scene, const scene_folder *folder) {
  char path[600], bytes[4096] = {0};
  snprintf(path, sizeof path, "%s/made.glb", folder->path);
  ASSERT_OK(olx_export_scene(scene, path, NULL));
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  assert_true(fread(bytes, 1, sizeof bytes - 1, file) > 20);
  fclose(file);
  const char *json = bytes + 20; // behind the file's header and that of its first chunk, which is text
  assert_non_null(strstr(json, "\"sky\":[0,0,0]"));
}

static void environments_are_read_from_exr(void **state) {
  char path[600];
  olx_image image;
  char *model = scene_files_gltf("[{}]", 0, "[{\"mesh\": 0}]", "", false);
  scene_folder_write_text(*state, "made.gltf", model);
  free(model);
  assert_int_equal(olx_image_create(4, 2, 1u << OLX_LAYER_BEAUTY, &image), OLX_OK);
  for (uint32_t i = 0; i < 8; ++i) image.layers[OLX_LAYER_BEAUTY][i] = olx_v3((float)i, 0.5f, i == 7 ? -1.0f : 3000.0f);
  snprintf(path, sizeof path, "%s/sky.exr", ((scene_folder *)*state)->path);
  assert_int_equal(olx_image_save(&image, path), OLX_OK);
  const char *description = scene_folder_write_text(
      *state, "sky.json", "{\"model\": \"made.gltf\", \"environment\": {\"image\": \"sky.exr\", \"gain\": 2}}");
  olx_scene *scene = NULL;
  ASSERT_OK(olx_scene_load(description, &scene));
  assert_int_equal(scene->environment.width, 4);
  assert_int_equal(scene->environment.height, 2);
  for (uint32_t i = 0; i < 8; ++i) {
    const float *texel = scene->environment.texels + 3 * i;
    assert_true(texel[0] == (float)i && texel[1] == 0.5f && texel[2] == (i == 7 ? 0.0f : 3000.0f));
  }
  assert_warned(scene, "sky.exr: 1 numbers were negative or not finite, now 0");
  assert_true(olx_scene_was_read_from(scene, path));
  assert_exported_black(scene, *state);
  olx_scene_free(scene);
  const olx_scene_load_settings few = {.limits = {.texels = 7}};
  assert_int_equal(olx_scene_load_with(description, &few, &scene), OLX_ERROR_UNSUPPORTED);
  assert_non_null(strstr(olx_last_error(), "sky.exr: environment: 8 texels"));
  olx_image_free(&image);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(environments_are_read_from_exr, scene_folder_set_up, scene_folder_tear_down)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
