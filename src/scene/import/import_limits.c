// Limits what files may request while a scene is loaded: the defaults of olx_scene_limits, and the error message for
// exceeding a limit.
#include "scene/import/import_limits.h"

#include "core/result.h"

static const olx_scene_limits defaults = {
    .triangles = 1u << 26, .texels = 1u << 29, .polygon_corners = 2048, .materials = 8192, .nodes = 32768};

olx_scene_limits olx_import_limits(const olx_scene_limits *given) {
  olx_scene_limits limits = *given;
  if (!limits.triangles) limits.triangles = defaults.triangles;
  if (!limits.texels) limits.texels = defaults.texels;
  if (!limits.polygon_corners) limits.polygon_corners = defaults.polygon_corners;
  if (!limits.materials) limits.materials = defaults.materials;
  if (!limits.nodes) limits.nodes = defaults.nodes;
  return limits;
}

// The value of a limit, its name in olx_scene_limits, and what it counts.
typedef struct limit_row {
  uint64_t most;
  const char *name, *what;
} limit_row;

static limit_row row_of(const olx_scene *scene, olx_import_limit limit) {
  const olx_scene_limits limits = olx_import_limits(&scene->load.limits);
  switch (limit) {
  case OLX_LIMIT_TRIANGLES: return (limit_row){limits.triangles, "triangles", "triangles in the scene"};
  case OLX_LIMIT_TEXELS: return (limit_row){limits.texels, "texels", "texels in the scene's images"};
  case OLX_LIMIT_POLYGON_CORNERS: return (limit_row){limits.polygon_corners, "polygon_corners", "corners in a polygon"};
  case OLX_LIMIT_MATERIALS: return (limit_row){limits.materials, "materials", "materials in the scene"};
  case OLX_LIMIT_NODES: break;
  }
  return (limit_row){limits.nodes, "nodes", "nodes in a model"};
}

olx_result olx_import_check_limit(const olx_scene *scene, olx_import_limit limit, uint64_t found, const char *path,
                                  const char *element) {
  const limit_row row = row_of(scene, limit);
  if (found <= row.most) return OLX_OK;
  return olx_fail(OLX_ERROR_UNSUPPORTED,
                  "%s: %s: %llu %s, more than the limit of %llu (--import-limits %s=%llu raises it, or "
                  "olx_scene_limits.%s)",
                  path, element, (unsigned long long)found, row.what, (unsigned long long)row.most, row.name,
                  (unsigned long long)found, row.name);
}

uint64_t olx_scene_texels(const olx_scene *scene) {
  uint64_t texels = (uint64_t)scene->environment.width * scene->environment.height;
  for (uint32_t i = 0; i < scene->texture_count; ++i) {
    texels += (uint64_t)scene->textures[i].width * scene->textures[i].height;
  }
  return texels;
}
