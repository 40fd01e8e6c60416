// Computes a pinhole camera's frame from eye, target and field of view, and directions through points of its image.
#include "render/camera.h"

#include "core/result.h"

olx_result olx_camera_frame_make(const olx_camera *camera, uint32_t width, uint32_t height, olx_camera_frame *frame) {
  if (!(camera->fov_y_degrees > 0.0f && camera->fov_y_degrees < 180.0f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "camera \"%s\": a field of view of %g degrees is not between 0 and 180",
                    camera->name, (double)camera->fov_y_degrees);
  }
  const olx_vec3 forward = olx_normalize(olx_sub(camera->target, camera->eye));
  if (!olx_is_position(camera->eye) || !(olx_dot(forward, forward) > 0.5f)) {
    return olx_fail(OLX_ERROR_ARGUMENT, "camera \"%s\": eye and target do not define a direction within 2e7 m",
                    camera->name);
  }
  olx_vec3 right = olx_cross(forward, olx_normalize(camera->up));
  if (!(olx_length(right) > 1e-4f)) {
    olx_vec3 bitangent;
    olx_basis(forward, &right, &bitangent);
  }
  right = olx_normalize(right);
  const float half_height = tanf(camera->fov_y_degrees * (OLX_PI / 360.0f));
  *frame = (olx_camera_frame){
      .eye = camera->eye,
      .forward = forward,
      .right = olx_scale(right, half_height * (float)width / (float)height),
      .up = olx_scale(olx_cross(right, forward), half_height),
  };
  return OLX_OK;
}

olx_vec3 olx_camera_direction(const olx_camera_frame *frame, float x, float y) {
  const olx_vec3 across = olx_madd(frame->forward, frame->right, 2.0f * x - 1.0f);
  return olx_normalize(olx_madd(across, frame->up, 1.0f - 2.0f * y));
}
