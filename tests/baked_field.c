// Bakes and opens fields for tests, and asserts that the number of threads does not change a byte.
#include "baked_field.h"

#include "field/field_data.h"
#include "scene_files.h"
#include "tiny_scenes.h"

olx_field *baked_field(const olx_scene *scene, const olx_bake_settings *settings, olx_bake_stats *stats) {
  scene_folder folder;
  assert_true(scene_folder_create(&folder));
  char path[512];
  snprintf(path, sizeof path, "%s/field.olx", folder.path);
  ASSERT_OK(olx_bake(scene, settings, path, NULL, stats));
  olx_field *field = NULL;
  ASSERT_OK(olx_field_open(path, &field));
  ASSERT_OK(olx_field_verify(field));
  scene_folder_remove(&folder);
  return field;
}

void baked_field_at_any_threads(const olx_scene *scene, const olx_bake_settings *settings) {
  static const uint32_t threads[] = {1, 2, 5};
  olx_field *first = NULL;
  for (uint32_t i = 0; i < sizeof threads / sizeof threads[0]; i++) {
    olx_bake_settings changed = *settings;
    changed.threads = threads[i];
    olx_field *field = baked_field(scene, &changed, NULL);
    if (first) {
      assert_int_equal(field->size_bytes, first->size_bytes);
      assert_memory_equal(field->data, first->data, first->size_bytes);
      olx_field_close(field);
    } else {
      first = field;
    }
  }
  olx_field_close(first);
}
