// Bake a cooked scene: bake_cooked SCENE.olxs OUT.olx RADIANCE_SIZE IRRADIANCE_SIZE. The least that a machine which bakes must have: this links
// Embree, and none of the libraries that import scenes or write pictures.
#include <octalux/bake.h>

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
  if (argc != 5) {
    fprintf(stderr, "usage: bake_cooked SCENE.olxs OUT.olx RADIANCE_SIZE IRRADIANCE_SIZE\n");
    return 2;
  }
  olx_scene *scene;
  if (olx_scene_load_cooked(argv[1], &scene) != OLX_OK) {
    fprintf(stderr, "%s\n", olx_last_error());
    return 1;
  }
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = (uint32_t)strtoul(argv[3], NULL, 10);
  settings.irradiance_size = (uint32_t)strtoul(argv[4], NULL, 10);
  const olx_result result = olx_bake(scene, &settings, argv[2], NULL, NULL);
  if (result != OLX_OK) fprintf(stderr, "%s\n", olx_last_error());
  olx_scene_free(scene);
  return result == OLX_OK ? 0 : 1;
}
