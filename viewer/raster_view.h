// The view of a camera, as shaders and Octalux's passes need it. Depth is reversed and infinite: near / distance along
// the viewing axis, 0 where no surface is.
#ifndef OCTALUX_VIEWER_RASTER_VIEW_H
#define OCTALUX_VIEWER_RASTER_VIEW_H

#include <octalux/scene.h>
#include <octalux/vulkan.h>

typedef struct raster_view {
  float world_to_clip[16]; // by columns
  olx_vulkan_view lit;     // the inverse, for olx_vulkan_record_*
  float near_metres;
  olx_vec3 right, up, forward; // unit vectors
} raster_view;

// Computes the view. Returns false when the camera's eye, target and angle define none.
bool raster_view_make(const olx_camera *camera, uint32_t width, uint32_t height, float near_metres, raster_view *view);

// Returns a near plane suitable for a scene: a share of the diagonal of its bounds.
float raster_view_near(olx_vec3 bounds_min, olx_vec3 bounds_max);

#endif
