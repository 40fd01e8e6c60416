// Bakes a cooked scene: bake_cooked SCENE.olxs OUT.olx RADIANCE_SIZE IRRADIANCE_SIZE [4x4x4 [cage,bricks [NOISE]]].
// It is the smallest program that bakes: it links Embree and Qhull, but none of the libraries that import scenes or
// write pictures.
#include <octalux/bake.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Parses a mask of the selectors named in `text`; 0 when one is unknown.
static uint32_t parse_selectors(const char *text) {
  uint32_t mask = 0;
  while (*text) {
    const size_t length = strcspn(text, ",");
    uint32_t select = 0;
    while (select < OLX_SELECT_EXHAUSTIVE && (strlen(olx_select_name((olx_select)select)) != length ||
                                              strncmp(olx_select_name((olx_select)select), text, length) != 0))
      select++;
    if (select == OLX_SELECT_EXHAUSTIVE) return 0;
    mask |= 1u << select;
    text += length + (text[length] == ',');
  }
  return mask;
}

static olx_result bake(const olx_scene *scene, int argc, char **argv) {
  olx_bake_settings settings = olx_bake_settings_default(scene);
  settings.radiance_size = (uint32_t)strtoul(argv[3], NULL, 10);
  settings.probe_light = true;
  settings.irradiance_size = (uint32_t)strtoul(argv[4], NULL, 10);
  uint32_t count[3];
  if (argc > 5 && sscanf(argv[5], "%ux%ux%u", &count[0], &count[1], &count[2]) == 3) {
    const olx_result result = olx_scene_probe_grid(scene, count, &settings.grid);
    if (result != OLX_OK) return result;
    settings.irradiance_grid = olx_bake_irradiance_grid(&settings.grid);
  }
  if (argc > 6) settings.select_mask = parse_selectors(argv[6]);
  if (argc > 7) settings.noise = strtof(argv[7], NULL);
  return olx_bake(scene, &settings, argv[2], NULL, NULL);
}

int main(int argc, char **argv) {
  uint32_t count[3];
  if (argc < 5 || argc > 8 || (argc > 5 && sscanf(argv[5], "%ux%ux%u", &count[0], &count[1], &count[2]) != 3) ||
      (argc > 6 && !parse_selectors(argv[6]))) {
    fprintf(stderr, "usage: bake_cooked SCENE.olxs OUT.olx RADIANCE_SIZE IRRADIANCE_SIZE "
                    "[4x4x4 [cage,bricks [NOISE]]]\n");
    return 2;
  }
  olx_scene *scene;
  if (olx_scene_load_cooked(argv[1], &scene) != OLX_OK) {
    fprintf(stderr, "%s\n", olx_last_error());
    return 1;
  }
  const olx_result result = bake(scene, argc, argv);
  if (result != OLX_OK) fprintf(stderr, "%s\n", olx_last_error());
  olx_scene_free(scene);
  return result == OLX_OK ? 0 : 1;
}
