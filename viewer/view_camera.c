// Turns and moves the camera with which the viewer flies through a scene.
#include "view_camera.h"

#include <math.h>

static const float STEEPEST = 1.55f; // slightly less than straight up

static olx_vec3 forward_of(const view_camera *c) {
  return (olx_vec3){sinf(c->yaw) * cosf(c->pitch), sinf(c->pitch), -cosf(c->yaw) * cosf(c->pitch)};
}

view_camera view_camera_of(const olx_camera *camera) {
  const float x = camera->target.x - camera->eye.x, y = camera->target.y - camera->eye.y,
              z = camera->target.z - camera->eye.z;
  view_camera made = {.eye = camera->eye, .fov_y_degrees = camera->fov_y_degrees};
  view_camera_turn(&made, atan2f(x, -z), atan2f(y, hypotf(x, z)));
  return made;
}

olx_camera view_camera_get(const view_camera *camera) {
  const olx_vec3 forward = forward_of(camera);
  return (olx_camera){.name = "flying",
                      .eye = camera->eye,
                      .target = {camera->eye.x + forward.x, camera->eye.y + forward.y, camera->eye.z + forward.z},
                      .up = {0, 1, 0},
                      .fov_y_degrees = camera->fov_y_degrees};
}

void view_camera_turn(view_camera *camera, float yaw, float pitch) {
  camera->yaw = remainderf(camera->yaw + yaw, 6.2831853f);
  camera->pitch = fminf(fmaxf(camera->pitch + pitch, -STEEPEST), STEEPEST);
}

void view_camera_move(view_camera *camera, float right, float up, float forward) {
  const olx_vec3 ahead = forward_of(camera);
  camera->eye.x += cosf(camera->yaw) * right + ahead.x * forward;
  camera->eye.y += up + ahead.y * forward;
  camera->eye.z += sinf(camera->yaw) * right + ahead.z * forward;
}
