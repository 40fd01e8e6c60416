// Reads environments from OpenEXR files.
#ifndef OLX_SCENE_ENVIRONMENT_FILE_H
#define OLX_SCENE_ENVIRONMENT_FILE_H

#include "scene/scene_data.h"

// Reads channels R, G and B of an OpenEXR image into width, height and texels of `environment`. An image beyond the
// scene's limit of texels is rejected.
olx_result olx_environment_read_exr(const char *path, const olx_scene *scene, olx_environment *environment);

#endif
