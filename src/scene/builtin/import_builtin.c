// Imports a built-in scene as a part of another scene, placed as the description says.
#include "scene/affine.h"
#include "scene/builtin/builtin.h"
#include "scene/import/import.h"
#include "scene/local_frame.h"

#include <string.h>

// The probe volume of a scene, which a built-in scene imported into it must not change.
typedef struct probe_volume {
  bool has_volume, has_count;
  olx_vec3 min, max;
  uint32_t count[3];
} probe_volume;

static probe_volume keep_volume(const olx_scene *scene) {
  return (probe_volume){scene->has_probe_volume,
                        scene->has_probe_count,
                        scene->probes_min,
                        scene->probes_max,
                        {scene->probes_count[0], scene->probes_count[1], scene->probes_count[2]}};
}

static void restore_volume(olx_scene *scene, const probe_volume *kept) {
  scene->has_probe_volume = kept->has_volume;
  scene->has_probe_count = kept->has_count;
  scene->probes_min = kept->min;
  scene->probes_max = kept->max;
  for (int i = 0; i < 3; ++i) scene->probes_count[i] = kept->count[i];
}

// Builds a built-in scene around 0, before it is placed.
static olx_result build_at_zero(const char *name, olx_scene *scene) {
  const olx_scene before = *scene;
  memset(scene->origin, 0, sizeof scene->origin);
  const olx_result result = olx_builtin_build(name, scene);
  memcpy(scene->origin, before.origin, sizeof scene->origin);
  scene->made_of = before.made_of;
  scene->is_made = before.is_made;
  return result;
}

// Scales the light of points and spots, so that a scaled scene is as bright as before.
static void place_light(const olx_affine *transform, float scale, olx_light *light) {
  if (light->type != OLX_LIGHT_POINT) light->direction = olx_normalize(olx_affine_vector(transform, light->direction));
  if (light->type == OLX_LIGHT_SUN) return;
  light->position = olx_affine_point(transform, light->position);
  light->emission = olx_scale(light->emission, scale * scale);
}

olx_result olx_import_builtin(const char *name, const olx_placement *placement, olx_scene *scene) {
  const uint32_t first_vertex = scene->vertex_count, first_camera = scene->camera_count,
                 first_light = scene->light_count;
  const probe_volume kept = keep_volume(scene);
  const olx_result result = build_at_zero(name, scene);
  restore_volume(scene, &kept);
  if (result != OLX_OK) return result;
  const olx_affine transform = olx_affine_from_placement(placement, scene->origin),
                   normals = olx_affine_normals(&transform);
  for (uint32_t i = first_vertex; i < scene->vertex_count; ++i) {
    scene->positions[i] = olx_affine_point(&transform, scene->positions[i]);
    olx_scene_include(scene, scene->positions[i]);
    scene->normals[i] = olx_normalize(olx_affine_vector(&normals, scene->normals[i]));
  }
  for (uint32_t i = first_camera; i < scene->camera_count; ++i) {
    olx_camera *camera = &scene->cameras[i];
    camera->eye = olx_affine_point(&transform, camera->eye);
    camera->target = olx_affine_point(&transform, camera->target);
    camera->up = olx_normalize(olx_affine_vector(&transform, camera->up));
  }
  for (uint32_t i = first_light; i < scene->light_count; ++i) {
    place_light(&transform, placement->scale, &scene->lights[i]);
  }
  return OLX_OK;
}
