// Path-traces reference pictures for studies, and keeps them for the next run.
#include "path_reference.h"

#include <stdio.h>

olx_result path_reference(const olx_scene *scene, const olx_camera *camera, const olx_render_settings *settings,
                          const char *kept, olx_image *image) {
  char path[512];
  snprintf(path, sizeof path, "%s-%s-%ux%u-%u-%u.exr", kept, camera->name, settings->width, settings->height,
           settings->bounces, settings->seed);
  FILE *there = fopen(path, "rb");
  if (there) {
    fclose(there);
    return olx_image_load(path, image);
  }
  const olx_result result = olx_render(scene, NULL, camera, settings, NULL, image, NULL);
  return result == OLX_OK ? olx_image_save(image, path) : result;
}
