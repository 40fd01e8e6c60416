// Finds the box of interest. The bounds of a model end where its outermost surfaces are, so that a camera in front of a
// house without ground sees walls that no probe within the bounds could see.
#include "place/space/space_box.h"

#include "core/result.h"
#include "scene/bvh.h"
#include "scene/surface.h"

#define LARGEST_REACH 0.125f // of the diagonal: how far space beyond the scene matters
#define LEAST_ROOM 0.0625f   // of the diagonal: outer surfaces have less room in front of them, within the bounds
#define LEAST_OUTER 0.01f // least share of a camera's looks that end at outer surfaces where space beyond them matters
enum { SIDES = 6 };       // of a box: side 2 * axis is the lower one

olx_vec3 olx_look_direction(const olx_camera *camera, uint32_t i) {
  const olx_vec3 forward = olx_normalize(olx_sub(camera->target, camera->eye));
  const olx_vec3 right = olx_normalize(olx_cross(forward, camera->up)), up = olx_cross(right, forward);
  const float half = tanf(0.5f * camera->fov_y_degrees * OLX_PI / 180.0f);
  const float x = ((float)(i % OLX_LOOKS_ALONG) + 0.5f) * (2.0f / OLX_LOOKS_ALONG) - 1.0f;
  const float y = ((float)(i / OLX_LOOKS_ALONG) + 0.5f) * (2.0f / OLX_LOOKS_ALONG) - 1.0f;
  return olx_normalize(olx_madd(olx_madd(forward, right, x * half), up, y * half));
}

// Returns how far a position is beyond a side of the box; negative within it.
static float beyond(const olx_box *box, int side, olx_vec3 p) {
  const olx_vec3 over = side & 1 ? olx_sub(p, box->max) : olx_sub(box->min, p);
  return side < 2 ? over.x : side < 4 ? over.y : over.z;
}

// Returns the side through which the normal at a point of a surface leaves the box, or SIDES when it does so far away.
static int outer_side(const olx_box *box, float diagonal, olx_vec3 p, olx_vec3 normal) {
  float nearest = LEAST_ROOM * diagonal;
  int found = SIDES;
  for (int side = 0; side < SIDES; side++) {
    const float speed = side & 1 ? olx_component(normal, side / 2) : -olx_component(normal, side / 2);
    if (!(speed > 0.0f) || -beyond(box, side, p) >= nearest * speed) continue;
    nearest = -beyond(box, side, p) / speed;
    found = side;
  }
  return found;
}

// Counts, for each side, the looks of a camera beyond it that end at outer surfaces of that side.
static void count_outer(const olx_scene *scene, const olx_camera *camera, const olx_box *box, uint32_t counts[SIDES]) {
  const float diagonal = olx_length(olx_sub(box->max, box->min));
  for (uint32_t i = 0; i < OLX_LOOKS; i++) {
    const olx_ray ray = {camera->eye, olx_look_direction(camera, i), 0.0f, INFINITY};
    const olx_ray_hit hit = olx_bvh_intersect(scene->bvh, &ray);
    if (hit.triangle == OLX_NO_HIT) continue;
    const olx_surface surface = olx_surface_at(scene, &hit, ray.direction);
    const int side = outer_side(box, diagonal, surface.position, surface.geometric_normal);
    if (side < SIDES && beyond(box, side, camera->eye) > 0.0f) counts[side]++;
  }
}

static bool is_outside(const olx_box *box, olx_vec3 p) {
  for (int side = 0; side < SIDES; side++) {
    if (beyond(box, side, p) > 0.0f) return true;
  }
  return false;
}

static void move_side(olx_box *box, int side, float by) {
  float *const sides[SIDES] = {&box->min.x, &box->max.x, &box->min.y, &box->max.y, &box->min.z, &box->max.z};
  *sides[side] += side & 1 ? by : -by;
}

// Extends the scene's bounds towards cameras beyond them that see outer surfaces, and up to those that look down on it.
static void reach_to_cameras(const olx_scene *scene, olx_box *box) {
  const olx_box bounds = *box;
  const float most = LARGEST_REACH * olx_length(olx_sub(box->max, box->min));
  float reach[SIDES] = {0.0f};
  for (uint32_t i = 0; i < scene->camera_count; i++) {
    const olx_camera *camera = &scene->cameras[i];
    uint32_t counts[SIDES] = {0};
    if (!is_outside(&bounds, camera->eye)) continue;
    count_outer(scene, camera, &bounds, counts);
    counts[3] = OLX_LOOKS; // what lies uppermost is open to a camera above it, however deep it lies
    for (int side = 0; side < SIDES; side++) {
      if ((float)counts[side] < LEAST_OUTER * OLX_LOOKS) continue;
      reach[side] = olx_max(reach[side], olx_min(beyond(&bounds, side, camera->eye), most));
    }
  }
  for (int side = 0; side < SIDES; side++) move_side(box, side, reach[side]);
}

olx_result olx_space_box(const olx_scene *scene, olx_box *box) {
  const olx_probe_rules *rules = &scene->probe_rules;
  *box = (olx_box){scene->bounds_min, scene->bounds_max};
  const float diagonal = olx_length(olx_sub(box->max, box->min));
  if (rules->has_playable) {
    box->min = olx_max_each(rules->playable.min, olx_add(box->min, olx_splat(-diagonal)));
    box->max = olx_min_each(rules->playable.max, olx_add(box->max, olx_splat(diagonal)));
  } else {
    reach_to_cameras(scene, box);
  }
  const olx_vec3 extent = olx_sub(box->max, box->min);
  if (extent.x > 0.0f && extent.y > 0.0f && extent.z > 0.0f) return OLX_OK;
  if (!rules->has_playable) {
    return olx_fail(OLX_ERROR_EMPTY,
                    "nowhere to place probes: the scene is flat, its bounds hold no volume; a playable "
                    "box in its description can say where to look");
  }
  return olx_fail(OLX_ERROR_EMPTY, "nowhere to place probes: the playable box holds no volume near the scene");
}
