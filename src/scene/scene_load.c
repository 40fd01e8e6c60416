// Loads a scene by its name. It is separate from everything else, so that a program which only loads cooked scenes
// needs no importers.
#include "core/result.h"
#include "scene/builtin/builtin.h"
#include "scene/import/import.h"
#include "scene/import/import_limits.h"
#include "scene/scene_build.h"

#include <string.h>
#include <strings.h>

static const char *extension_of(const char *path) {
  const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
  return dot && (!slash || dot > slash) ? dot : "";
}

static olx_result fill_scene(const char *name, olx_scene *scene) {
  const size_t prefix = sizeof OLX_BUILTIN_PREFIX - 1;
  if (strncmp(name, OLX_BUILTIN_PREFIX, prefix) == 0) return olx_builtin_build(name + prefix, scene);
  const char *extension = extension_of(name);
  if (strcasecmp(extension, ".olxs") == 0) return olx_scene_read_cooked(name, scene);
  if (strcasecmp(extension, ".json") == 0) return olx_import_description(name, scene);
  if (strcasecmp(extension, ".gltf") == 0 || strcasecmp(extension, ".glb") == 0 || strcasecmp(extension, ".obj") == 0) {
    const olx_placement as_it_is = {.scale = 1.0f};
    return olx_import_model(name, &as_it_is, scene);
  }
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: not a scene: expected .gltf, .glb, .obj, .json, .olxs or builtin:NAME",
                  name);
}

olx_scene_load_settings olx_scene_load_settings_default(void) {
  return (olx_scene_load_settings){.limits = olx_import_limits(&(olx_scene_limits){0})};
}

olx_result olx_scene_load_with(const char *name, const olx_scene_load_settings *settings, olx_scene **scene) {
  return olx_scene_load_by(fill_scene, name, settings, scene);
}

olx_result olx_scene_load(const char *name, olx_scene **scene) { return olx_scene_load_with(name, NULL, scene); }
