// Draws a field's probes into an image as small spheres, which surfaces in front of them occlude.
#include "probe_markers.h"

#include <math.h>

typedef struct view {
  olx_vec3 eye, right, up, forward;
  float pixels_per_slope; // pixels from the centre for a slope of 1
} view;

static olx_vec3 subtract(olx_vec3 a, olx_vec3 b) { return (olx_vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static float dot(olx_vec3 a, olx_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static olx_vec3 cross(olx_vec3 a, olx_vec3 b) {
  return (olx_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static olx_vec3 normalize(olx_vec3 a) {
  const float length = sqrtf(dot(a, a));
  return length > 0.0f ? (olx_vec3){a.x / length, a.y / length, a.z / length} : a;
}

static view view_of(const olx_camera *camera, const olx_image *image) {
  view v = {.eye = camera->eye, .forward = normalize(subtract(camera->target, camera->eye))};
  v.right = normalize(cross(v.forward, camera->up));
  v.up = cross(v.right, v.forward);
  const float half_angle = camera->fov_y_degrees * 3.14159265f / 360.0f;
  v.pixels_per_slope = 0.5f * (float)image->height / tanf(half_angle);
  return v;
}

// Radius of markers: small relative to the distance between probes and to the scene.
static float marker_radius(const olx_field_info *info) {
  const olx_vec3 diagonal = subtract(info->scene.bounds_max, info->scene.bounds_min);
  float radius = 0.015f * sqrtf(dot(diagonal, diagonal));
  const float spacing[3] = {info->probes.grid.spacing.x, info->probes.grid.spacing.y, info->probes.grid.spacing.z};
  for (int axis = 0; axis < 3; ++axis) {
    if (info->probes.has_grid && spacing[axis] > 0.0f) radius = fminf(radius, 0.12f * spacing[axis]);
  }
  return radius;
}

static void draw_marker(const view *v, olx_vec3 position, float radius, olx_vec3 color, olx_image *image) {
  const olx_vec3 offset = subtract(position, v->eye);
  const float depth = dot(offset, v->forward);
  if (depth <= 2.0f * radius) return;
  const float center_x = 0.5f * (float)image->width + dot(offset, v->right) / depth * v->pixels_per_slope;
  const float center_y = 0.5f * (float)image->height - dot(offset, v->up) / depth * v->pixels_per_slope;
  const float size = fmaxf(radius / depth * v->pixels_per_slope, 1.5f);
  const float left = fmaxf(center_x - size, 0.0f), right = fminf(center_x + size, (float)image->width - 1.0f);
  const float top = fmaxf(center_y - size, 0.0f), bottom = fminf(center_y + size, (float)image->height - 1.0f);
  for (float y = floorf(top); y <= bottom; ++y) {
    for (float x = floorf(left); x <= right; ++x) {
      const float dx = (x + 0.5f - center_x) / size, dy = (y + 0.5f - center_y) / size;
      const float facing_squared = 1.0f - dx * dx - dy * dy;
      if (facing_squared < 0.0f) continue;
      const float facing = sqrtf(facing_squared), shade = 0.15f + 0.85f * facing;
      const size_t pixel = (size_t)x + image->width * (size_t)y;
      if (image->layers[OLX_LAYER_DEPTH][pixel].x < depth - radius * facing) continue;
      image->layers[OLX_LAYER_BEAUTY][pixel] = (olx_vec3){color.x * shade, color.y * shade, color.z * shade};
      image->layers[OLX_LAYER_DEPTH][pixel].x = depth - radius * facing;
    }
  }
}

void draw_probe_markers(const olx_field *field, const olx_camera *camera, olx_image *image) {
  const olx_field_info info = olx_field_describe(field);
  const view v = view_of(camera, image);
  const float radius = marker_radius(&info);
  const olx_vec3 blue = {0.05f, 0.35f, 0.95f}, red = {0.95f, 0.08f, 0.03f};
  for (uint32_t probe = 0; probe < info.probes.count; ++probe) {
    const olx_vec3 color = olx_field_probe_buried(field, probe) ? red : blue;
    draw_marker(&v, olx_field_probe_position(field, probe), radius, color, image);
  }
}
