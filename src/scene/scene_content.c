// Gives access to the content of a scene. It is separate from the ray caster, so that a program which only draws needs
// no Embree.
#include "core/hooks.h"
#include "core/result.h"
#include "scene/scene_build.h"

// The content is the first member, so that its address is also that of the whole.
typedef struct loaded_content {
  olx_scene_content content;
  olx_scene scene;
} loaded_content;

olx_scene_content olx_scene_get_content(const olx_scene *scene) {
  return (olx_scene_content){
      .vertex_count = scene->vertex_count,
      .triangle_count = scene->triangle_count,
      .material_count = scene->material_count,
      .texture_count = scene->texture_count,
      .light_count = scene->light_count,
      .camera_count = scene->camera_count,
      .positions = scene->positions,
      .normals = scene->normals,
      .uvs = scene->uvs,
      .second_uvs = scene->second_uvs,
      .colors = scene->colors,
      .tangents = scene->tangents,
      .indices = scene->indices,
      .material_index = scene->material_index,
      .materials = scene->materials,
      .textures = scene->textures,
      .lights = scene->lights,
      .cameras = scene->cameras,
      .environment = &scene->environment,
      .bounds_min = scene->bounds_min,
      .bounds_max = scene->bounds_max,
      .origin = {scene->origin[0], scene->origin[1], scene->origin[2]},
      .hash = scene->hash,
  };
}

olx_result olx_scene_content_load(const char *path, olx_scene_content **content) {
  *content = NULL;
  loaded_content *loaded = olx_allocate_zero(1, sizeof *loaded);
  if (!loaded) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  olx_result result = olx_scene_read_cooked(path, &loaded->scene);
  olx_scene_log_warnings(&loaded->scene);
  if (result == OLX_OK) {
    result = olx_scene_summarize(&loaded->scene);
    if (result != OLX_OK) olx_fail(result, "%s: %s", path, olx_last_error());
  }
  loaded->content = olx_scene_get_content(&loaded->scene);
  if (result != OLX_OK) {
    olx_scene_content_free(&loaded->content);
    return result;
  }
  *content = &loaded->content;
  return OLX_OK;
}

void olx_scene_content_free(olx_scene_content *content) {
  if (!content) return;
  loaded_content *loaded = (loaded_content *)content;
  olx_scene_release_arrays(&loaded->scene);
  olx_release(loaded);
}
