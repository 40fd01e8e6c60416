// Bakes a scene into a field, and renders a picture from the field: bake_and_render SCENE FIELD.olx PICTURE.png.
#include <octalux/bake.h>
#include <octalux/render.h>

#include <stdio.h>

static olx_result run(const char *scene_name, const char *field_path, const char *picture_path) {
  olx_scene *scene = NULL;
  olx_field *field = NULL;
  olx_image image = {0};
  olx_camera camera;
  olx_result result = olx_scene_load(scene_name, &scene);
  if (result != OLX_OK) return result;

  olx_bake_settings bake = olx_bake_settings_default(scene);
  bake.radiance_size = 64;
  result = olx_bake(scene, &bake, field_path, NULL, NULL);
  if (result == OLX_OK) result = olx_field_open(field_path, &field);
  if (result == OLX_OK) result = olx_scene_find_camera(scene, NULL, &camera);

  olx_render_settings render = olx_render_settings_default(OLX_METHOD_FIELD);
  render.width = 160;
  render.height = 120;
  if (result == OLX_OK) result = olx_render(scene, field, &camera, &render, NULL, &image, NULL);
  if (result == OLX_OK) result = olx_image_save(&image, picture_path);

  olx_image_free(&image);
  olx_field_close(field);
  olx_scene_free(scene);
  return result;
}

int main(int argc, char **argv) {
  if (argc != 4) {
    fprintf(stderr, "usage: bake_and_render SCENE FIELD.olx PICTURE.png\n");
    return 2;
  }
  if (run(argv[1], argv[2], argv[3]) == OLX_OK) return 0;
  fprintf(stderr, "bake_and_render: %s\n", olx_last_error());
  return 1;
}
