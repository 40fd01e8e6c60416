// Draws an image of a placement: the scene with the skeleton of free space, the probes, and surfaces that stay
// uncovered.
#include "place_picture.h"

#include <octalux/render.h>

#include <math.h>
#include <stdlib.h>

enum { ORDER_SKELETON, ORDER_SURFACE, ORDER_PROBE };

static olx_vec3 mix(olx_vec3 a, olx_vec3 b, float t) {
  return (olx_vec3){a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t};
}

// Returns a colour from violet in narrow places to pale yellow in wide ones.
static olx_vec3 skeleton_color(float radius, float largest) {
  const olx_vec3 narrow = {0.10f, 0.03f, 0.30f}, middle = {0.03f, 0.30f, 0.30f}, wide = {0.85f, 0.80f, 0.25f};
  const float t = largest > 0.0f ? sqrtf(radius / largest) : 0.0f;
  return t < 0.5f ? mix(narrow, middle, 2.0f * t) : mix(middle, wide, 2.0f * t - 1.0f);
}

static olx_vec3 probe_color(const olx_placed_probe *probe) {
  if (probe->buried) return (olx_vec3){0.02f, 0.02f, 0.02f};
  switch (probe->origin) {
  case OLX_ORIGIN_PINNED: return (olx_vec3){1.0f, 1.0f, 1.0f};
  case OLX_ORIGIN_GRID: return (olx_vec3){0.8f, 0.1f, 0.7f};
  case OLX_ORIGIN_SKELETON: return (olx_vec3){0.05f, 0.75f, 0.85f};
  case OLX_ORIGIN_SPACE: return (olx_vec3){0.08f, 0.22f, 1.0f};
  case OLX_ORIGIN_TARGET: return (olx_vec3){0.40f, 0.12f, 1.0f};
  case OLX_ORIGIN_MOVED: return (olx_vec3){0.10f, 0.75f, 0.12f};
  }
  return (olx_vec3){1.0f, 1.0f, 1.0f};
}

static olx_diagram_mark small_mark(const olx_place_mark *mark, float largest) {
  const olx_vec3 red = {0.95f, 0.03f, 0.02f}, orange = {1.0f, 0.32f, 0.01f}, yellow = {0.95f, 0.85f, 0.03f};
  const olx_vec3 surface = mark->kind == OLX_MARK_MISSED ? red : mark->kind == OLX_MARK_HOPELESS ? orange : yellow;
  const bool skeleton = mark->kind == OLX_MARK_SKELETON;
  return (olx_diagram_mark){.position = mark->position,
                            .color = skeleton ? skeleton_color(mark->radius, largest) : surface,
                            .least_pixels = skeleton ? 1.2f : 2.0f,
                            .most_pixels = skeleton ? 1.2f : 2.0f,
                            .order = skeleton ? ORDER_SKELETON : ORDER_SURFACE};
}

static uint32_t list_marks(const olx_probe_set *set, float diagonal, olx_diagram_mark *marks) {
  uint32_t count = 0;
  float largest = 0.0f;
  for (uint32_t i = 0; i < set->mark_count; ++i) largest = fmaxf(largest, set->marks[i].radius);
  for (uint32_t i = 0; i < set->mark_count; ++i) {
    marks[count] = small_mark(&set->marks[i], largest);
    marks[count++].radius = 1e-3f * diagonal; // so that they do not occlude dots on surfaces
  }
  for (uint32_t i = 0; i < set->count; ++i) {
    marks[count++] = (olx_diagram_mark){.position = set->probes[i].position,
                                        .color = probe_color(&set->probes[i]),
                                        .radius = 0.008f * diagonal,
                                        .least_pixels = 5.0f,
                                        .most_pixels = 16.0f,
                                        .order = ORDER_PROBE};
  }
  return count;
}

// Chooses the camera; NULL means an overview.
static olx_result choose_camera(const olx_scene *scene, const place_picture *picture, olx_camera *storage,
                                const olx_camera **camera) {
  *camera = NULL;
  if (!picture->camera && olx_scene_describe(scene).cameras == 0) return OLX_OK;
  *camera = storage;
  return olx_scene_find_camera(scene, picture->camera, storage);
}

olx_result find_picture_camera(const olx_scene *scene, const place_picture *picture) {
  olx_camera storage;
  const olx_camera *camera;
  return choose_camera(scene, picture, &storage, &camera);
}

olx_result draw_place_picture(const olx_scene *scene, const olx_probe_set *set, const place_picture *picture) {
  const olx_scene_info info = olx_scene_describe(scene);
  const float x = info.bounds_max.x - info.bounds_min.x, y = info.bounds_max.y - info.bounds_min.y,
              z = info.bounds_max.z - info.bounds_min.z;
  olx_diagram_settings settings = {.width = picture->size[0] ? picture->size[0] : 1280,
                                   .height = picture->size[1] ? picture->size[1] : 720,
                                   .threads = set->settings.threads};
  olx_camera storage;
  uint32_t drawn;
  olx_result result = choose_camera(scene, picture, &storage, &settings.camera);
  if (result != OLX_OK) return result;
  olx_diagram_mark *marks = malloc(((size_t)set->mark_count + set->count) * sizeof *marks);
  if (!marks) return OLX_ERROR_MEMORY;
  settings.mark_count = list_marks(set, sqrtf(x * x + y * y + z * z), marks);
  settings.marks = marks;
  result = olx_diagram_save(scene, &settings, picture->path, &drawn);
  free(marks);
  return result;
}
