// Loads scenes from files, descriptions and code, moves those far from the origin into a local frame, and answers
// queries about cameras and the grid of probes.
#include "core/hooks.h"
#include "core/result.h"
#include "scene/bvh.h"
#include "scene/emitters.h"
#include "scene/scene_build.h"
#include "scene/sources.h"

#include <stdio.h>
#include <string.h>

olx_result olx_scene_finish(olx_scene *scene) {
  OLX_TRY(olx_scene_summarize(scene));
  OLX_TRY(olx_bvh_create(scene));
  return olx_emitters_create(scene, &scene->emitters);
}

// Fills an empty scene, and fills it again when its content turns out to lie far from the origin. In the first pass
// positions are known only to a float, which may be too coarse for the origin that the second pass requires.
static olx_result fill_in_local_frame(olx_result (*fill)(const char *name, olx_scene *scene), const char *name,
                                      olx_scene *scene) {
  enum { MOST_TIMES = 4 };
  for (uint32_t times = 1;; ++times) {
    OLX_TRY(fill(name, scene));
    double origin[3];
    if (times == MOST_TIMES || !olx_scene_wants_origin(scene, origin)) return OLX_OK;
    olx_scene_release_arrays(scene);
    *scene = (olx_scene){.load = scene->load, .origin = {origin[0], origin[1], origin[2]}};
  }
}

olx_result olx_scene_load_by(olx_result (*fill)(const char *name, olx_scene *scene), const char *name,
                             const olx_scene_load_settings *settings, olx_scene **scene) {
  *scene = NULL;
  olx_scene *loaded = olx_allocate_zero(1, sizeof *loaded);
  if (!loaded) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", name);
  if (settings) loaded->load = *settings;
  olx_result result = fill_in_local_frame(fill, name, loaded);
  olx_scene_log_warnings(loaded);
  if (result == OLX_OK) result = olx_scene_note_source(loaded, name);
  if (result == OLX_OK) {
    result = olx_scene_finish(loaded);
    if (result != OLX_OK) olx_fail(result, "%s: %s", name, olx_last_error());
  }
  if (result != OLX_OK) {
    olx_scene_free(loaded);
    return result;
  }
  *scene = loaded;
  return OLX_OK;
}

olx_result olx_scene_load_cooked(const char *path, olx_scene **scene) {
  return olx_scene_load_by(olx_scene_read_cooked, path, NULL, scene);
}

void olx_scene_free(olx_scene *scene) {
  if (!scene) return;
  olx_bvh_free(scene);
  olx_emitters_free(scene->emitters);
  olx_scene_release_arrays(scene);
  olx_release(scene);
}

olx_scene_info olx_scene_describe(const olx_scene *scene) {
  return (olx_scene_info){
      .triangles = scene->triangle_count,
      .vertices = scene->vertex_count,
      .materials = scene->material_count,
      .textures = scene->texture_count,
      .lights = scene->light_count + scene->area_light_count,
      .cameras = scene->camera_count,
      .warnings = scene->warning_count,
      .bounds_min = scene->bounds_min,
      .bounds_max = scene->bounds_max,
      .has_probe_volume = scene->has_probe_volume,
      .has_probe_count = scene->has_probe_count,
      .origin = {scene->origin[0], scene->origin[1], scene->origin[2]},
      .hash = scene->hash,
  };
}

const char *olx_scene_warning(const olx_scene *scene, uint32_t index) {
  return index < scene->warning_count ? scene->warnings[index] : NULL;
}

olx_camera olx_scene_camera(const olx_scene *scene, uint32_t index) {
  return index < scene->camera_count ? scene->cameras[index] : (olx_camera){.name = ""};
}

// Returns a camera at a corner above and in front, far enough that the sphere around the bounds fits the field of view.
static olx_camera overview_camera(const olx_scene *scene) {
  const olx_vec3 center = olx_scale(olx_add(scene->bounds_min, scene->bounds_max), 0.5f);
  const float radius = 0.5f * olx_length(olx_sub(scene->bounds_max, scene->bounds_min));
  const float fov_y_degrees = 45.0f, distance = radius / sinf(0.5f * fov_y_degrees * OLX_PI / 180.0f);
  return (olx_camera){
      .name = "overview",
      .eye = olx_madd(center, olx_normalize(olx_v3(0.6f, 0.5f, 1.0f)), distance),
      .target = center,
      .up = {0.0f, 1.0f, 0.0f},
      .fov_y_degrees = fov_y_degrees,
  };
}

static void list_cameras(const olx_scene *scene, char *text, size_t size_bytes) {
  size_t used = 0;
  text[0] = 0;
  for (uint32_t i = 0; i < scene->camera_count && used < size_bytes; ++i) {
    used += (size_t)snprintf(text + used, size_bytes - used, "%s\"%s\"", i ? ", " : "", scene->cameras[i].name);
  }
}

olx_result olx_scene_find_camera(const olx_scene *scene, const char *name, olx_camera *camera) {
  if (!name) {
    *camera = scene->camera_count ? scene->cameras[0] : overview_camera(scene);
    return OLX_OK;
  }
  for (uint32_t i = 0; i < scene->camera_count; ++i) {
    if (strcmp(scene->cameras[i].name, name) == 0) {
      *camera = scene->cameras[i];
      return OLX_OK;
    }
  }
  char names[512];
  list_cameras(scene, names, sizeof names);
  return olx_fail(OLX_ERROR_ARGUMENT, "no camera named \"%s\"; the scene has %s", name, names[0] ? names : "none");
}

// Places probes along one axis: the first and last at the volume's ends, or at the midpoints of equal cells of the
// bounds.
static void place_on_axis(bool volume, float low, float high, uint32_t count, float *origin, float *spacing) {
  if (count == 1) {
    *origin = 0.5f * (low + high);
    *spacing = 0.0f;
  } else if (volume) {
    *origin = low;
    *spacing = (high - low) / (float)(count - 1);
  } else {
    *spacing = (high - low) / (float)count;
    *origin = low + 0.5f * *spacing;
  }
}

olx_result olx_scene_probe_grid(const olx_scene *scene, const uint32_t count[3], olx_grid *grid) {
  const uint32_t four[3] = {4, 4, 4};
  const uint32_t *counts = count ? count : scene->has_probe_count ? scene->probes_count : four;
  const uint64_t plane = (uint64_t)counts[0] * counts[1];
  if (plane == 0 || counts[2] == 0 || plane > UINT32_MAX || plane * counts[2] > UINT32_MAX) {
    return olx_fail(OLX_ERROR_ARGUMENT,
                    "a grid of %u x %u x %u probes: each count must be at least 1, and all "
                    "together must stay below 2^32",
                    counts[0], counts[1], counts[2]);
  }
  const bool volume = scene->has_probe_volume;
  const olx_vec3 low = volume ? scene->probes_min : scene->bounds_min;
  const olx_vec3 high = volume ? scene->probes_max : scene->bounds_max;
  *grid = (olx_grid){.count = {counts[0], counts[1], counts[2]}};
  place_on_axis(volume, low.x, high.x, counts[0], &grid->origin.x, &grid->spacing.x);
  place_on_axis(volume, low.y, high.y, counts[1], &grid->origin.y, &grid->spacing.y);
  place_on_axis(volume, low.z, high.z, counts[2], &grid->origin.z, &grid->spacing.z);
  return OLX_OK;
}
