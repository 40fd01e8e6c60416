// An image of a placement: skeleton, probes and uncovered surfaces in the scene.
#ifndef OCTALUX_CLI_PLACE_PICTURE_H
#define OCTALUX_CLI_PLACE_PICTURE_H

#include <octalux/place.h>

typedef struct place_picture {
  const char *path, *camera; // camera NULL: the scene's first camera, or an overview
  uint32_t size[2];
} place_picture;

// Checks that the scene has the requested camera.
olx_result find_picture_camera(const olx_scene *scene, const place_picture *picture);
// Draws the image. The set must have been placed with settings.marks.
olx_result draw_place_picture(const olx_scene *scene, const olx_probe_set *set, const place_picture *picture);

#endif
