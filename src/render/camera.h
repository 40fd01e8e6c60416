// The pinhole camera of the renderers.
#ifndef OLX_RENDER_CAMERA_H
#define OLX_RENDER_CAMERA_H

#include "core/vec.h"

#include <octalux/scene.h>

typedef struct olx_camera_frame {
  olx_vec3 eye, forward;
  olx_vec3 right, up; // from the middle of the image plane at distance 1 to its right and top edge
} olx_camera_frame;

// Computes a camera's frame. Returns OLX_ERROR_ARGUMENT when eye and target coincide, or when the field of view is not
// between 0 and 180 degrees.
olx_result olx_camera_frame_make(const olx_camera *camera, uint32_t width, uint32_t height, olx_camera_frame *frame);

// Returns the unit direction through the point (x, y) of the image, 0..1 from left to right and from top to bottom.
olx_vec3 olx_camera_direction(const olx_camera_frame *frame, float x, float y);

#endif
