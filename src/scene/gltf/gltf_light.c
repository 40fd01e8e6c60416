// Imports cameras and lights of glTF nodes, which look along their -z with their y up. Photometric values of lights are
// used as radiometric ones, one to one.
#include "scene/gltf/gltf_light.h"

#include "core/name.h"
#include "core/result.h"
#include "scene/scene_build.h"

#include <stdio.h>
#include <string.h>

// Returns the node's name, otherwise that of its camera or light, otherwise a default.
static const char *name_of(const cJSON *node, const cJSON *item, const char *otherwise) {
  const char *names[] = {olx_json_text(node, "name"), olx_json_text(item, "name")};
  return names[0][0] ? names[0] : names[1][0] ? names[1] : otherwise;
}

static olx_result skip_camera(const olx_gltf *gltf, const olx_camera *camera, const char *why) {
  olx_scene_warn(gltf->scene, "%s: camera \"%s\" skipped: %s", gltf->path, camera->name, why);
  return OLX_OK;
}

olx_result olx_gltf_add_camera(const olx_gltf *gltf, uint32_t node, const olx_affine *transform) {
  const cJSON *element = gltf->nodes.elements[node];
  olx_scene *scene = gltf->scene;
  uint32_t index;
  float fov_y;
  char name[32];
  olx_gltf_index(element, "camera", gltf->cameras.count, &index);
  if (index == OLX_GLTF_NONE) return OLX_OK;
  const cJSON *item = gltf->cameras.elements[index];
  snprintf(name, sizeof name, "camera %u", scene->camera_count + 1);
  olx_camera camera = {.eye = olx_affine_point(transform, olx_splat(0.0f))};
  olx_copy_name(name_of(element, item, name), camera.name, sizeof camera.name);
  if (!olx_json_float(olx_json_member(olx_json_member(item, "perspective"), "yfov"), &fov_y) ||
      !(fov_y > 0.0f && fov_y < OLX_PI)) {
    return skip_camera(gltf, &camera, "only perspective cameras are supported");
  }
  const olx_vec3 forward = olx_normalize(olx_affine_vector(transform, olx_v3(0.0f, 0.0f, -1.0f)));
  camera.target = olx_add(camera.eye, forward);
  camera.up = olx_normalize(olx_affine_vector(transform, olx_v3(0.0f, 1.0f, 0.0f)));
  camera.fov_y_degrees = fov_y * 180.0f / OLX_PI;
  if (!olx_scene_holds(scene, camera.eye) || !(olx_length(olx_cross(forward, camera.up)) > 1e-3f)) {
    return skip_camera(gltf, &camera, "its transform is degenerate");
  }
  return olx_scene_add_camera(scene, &camera);
}

// Reads a light from an item of KHR_lights_punctual; false when its values are invalid.
static bool read_light(const cJSON *item, const olx_affine *transform, olx_light *light) {
  float color[3] = {1.0f, 1.0f, 1.0f}, intensity = 1.0f, inner = 0.0f, outer = OLX_PI / 4.0f;
  const cJSON *spot = olx_json_member(item, "spot");
  const char *type = olx_json_text(item, "type");
  const bool sun = strcmp(type, "directional") == 0, point = strcmp(type, "point") == 0;
  olx_json_floats(olx_json_member(item, "color"), color, 3);
  olx_json_float(olx_json_member(item, "intensity"), &intensity);
  olx_json_float(olx_json_member(spot, "innerConeAngle"), &inner);
  olx_json_float(olx_json_member(spot, "outerConeAngle"), &outer);
  *light = (olx_light){.type = sun     ? OLX_LIGHT_SUN
                               : point ? OLX_LIGHT_POINT
                                       : OLX_LIGHT_SPOT,
                       .position = olx_affine_point(transform, olx_splat(0.0f)),
                       .direction = olx_normalize(olx_affine_vector(transform, olx_v3(0.0f, 0.0f, -1.0f))),
                       .emission = olx_scale(olx_load3(color), intensity),
                       .cosine_inner = cosf(inner),
                       .cosine_outer = cosf(outer)};
  const olx_vec3 e = light->emission;
  return (sun || point || strcmp(type, "spot") == 0) && e.x >= 0.0f && e.y >= 0.0f && e.z >= 0.0f &&
         olx_max3(e) <= OLX_MOST_EMISSION && inner >= 0.0f && inner <= outer && outer <= OLX_PI;
}

void olx_gltf_add_light(const olx_gltf *gltf, uint32_t node, const olx_affine *transform) {
  const cJSON *element = gltf->nodes.elements[node];
  uint32_t index;
  olx_light light;
  olx_gltf_index(olx_gltf_extension(element, "KHR_lights_punctual"), "light", gltf->lights.count, &index);
  if (index == OLX_GLTF_NONE) return;
  const cJSON *item = gltf->lights.elements[index];
  if (read_light(item, transform, &light) && olx_scene_add_light(gltf->scene, &light) == OLX_OK) return;
  olx_scene_warn(gltf->scene, "%s: light \"%s\" skipped: its type, intensity, cone or transform is not usable",
                 gltf->path, name_of(element, item, ""));
}
