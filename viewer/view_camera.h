// A flying camera: a position and two angles.
#ifndef OCTALUX_VIEW_CAMERA_H
#define OCTALUX_VIEW_CAMERA_H

#include <octalux/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct view_camera {
  olx_vec3 eye;
  float yaw, pitch; // radians; 0, 0 looks along -z
  float fov_y_degrees;
} view_camera;

view_camera view_camera_of(const olx_camera *camera);
olx_camera view_camera_get(const view_camera *camera);

// Turns the camera by radians; the pitch stops just before straight up or down.
void view_camera_turn(view_camera *camera, float yaw, float pitch);
// Moves the camera by metres: to the right, along the world's up, and in its viewing direction.
void view_camera_move(view_camera *camera, float right, float up, float forward);

#ifdef __cplusplus
}
#endif

#endif
