// Computes the matrices of a camera's view with reversed infinite depth.
#include "raster_view.h"

#include <math.h>
#include <string.h>

static olx_vec3 scale(olx_vec3 v, float s) { return (olx_vec3){v.x * s, v.y * s, v.z * s}; }

static float dot(olx_vec3 a, olx_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static olx_vec3 cross(olx_vec3 a, olx_vec3 b) {
  return (olx_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static olx_vec3 normalize(olx_vec3 v) { return scale(v, 1.0f / sqrtf(dot(v, v))); }

// Returns the axis farthest from the direction, so that a camera that looks along its up vector still has a right
// vector.
static olx_vec3 any_up(olx_vec3 forward) {
  return fabsf(forward.y) < 0.7f ? (olx_vec3){0.0f, 1.0f, 0.0f} : (olx_vec3){0.0f, 0.0f, 1.0f};
}

bool raster_view_make(const olx_camera *camera, uint32_t width, uint32_t height, float near_metres, raster_view *view) {
  const olx_vec3 e = camera->eye, t = camera->target;
  const olx_vec3 forward = normalize((olx_vec3){t.x - e.x, t.y - e.y, t.z - e.z});
  const float tangent = tanf(camera->fov_y_degrees * 0.00872664626f);
  if (!(dot(forward, forward) > 0.5f) || !isfinite(dot(e, e)) || !(tangent > 0.0f) || !isfinite(tangent)) return false;
  olx_vec3 right = cross(forward, normalize(camera->up));
  if (!(dot(right, right) > 1e-8f)) right = cross(forward, any_up(forward));
  right = normalize(right);
  const olx_vec3 up = cross(right, forward);
  *view = (raster_view){.near_metres = near_metres, .right = right, .up = up, .forward = forward};
  // Per metre of distance, half of the picture is half_width metres wide and half_height metres high.
  const float half_height = tangent, half_width = tangent * (float)width / (float)height;
  const olx_vec3 x = scale(right, 1.0f / half_width), y = scale(up, -1.0f / half_height);
  const float m[16] = {x.x,        y.x,        0.0f,        forward.x, // columns: clip = (x, y, near, distance)
                       x.y,        y.y,        0.0f,        forward.y, //
                       x.z,        y.z,        0.0f,        forward.z, //
                       -dot(x, e), -dot(y, e), near_metres, -dot(forward, e)};
  memcpy(view->world_to_clip, m, sizeof m);
  // A pixel's surface is eye + distance * (forward + x right - y up), and its depth near / distance.
  const olx_vec3 r = scale(right, half_width), u = scale(up, half_height), n = scale(e, 1.0f / near_metres);
  const float inverse[16] = {r.x,       r.y,       r.z,       0.0f, -u.x, -u.y,
                             -u.z,      0.0f,      n.x,       n.y,  n.z,  1.0f / near_metres,
                             forward.x, forward.y, forward.z, 0.0f};
  memcpy(view->lit.clip_to_world, inverse, sizeof inverse);
  view->lit.eye = e;
  view->lit.empty_depth = 0.0f;
  return true;
}

float raster_view_near(olx_vec3 low, olx_vec3 high) {
  const olx_vec3 d = {high.x - low.x, high.y - low.y, high.z - low.z};
  return fmaxf(1e-3f * sqrtf(dot(d, d)), 1e-6f);
}
