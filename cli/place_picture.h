// A picture of a placement: skeleton, probes and uncovered surfaces in the scene.
#ifndef OCTALUX_CLI_PLACE_PICTURE_H
#define OCTALUX_CLI_PLACE_PICTURE_H

#include <octalux/place.h>

typedef struct place_picture {
  const char *path, *camera; // camera NULL: the scene's first, or an overview
  uint32_t size[2];
} place_picture;

// Whether the scene has the camera that is asked for.
olx_result find_picture_camera(const olx_scene *scene, const place_picture *picture);
// The set has to be placed with settings.marks.
olx_result draw_place_picture(const olx_scene *scene, const olx_probe_set *set, const place_picture *picture);

#endif
