// Loads a scene by the command line's options: limits of imports, and whether models may refer to files outside their
// folder.
#include "scene_options.h"

#include <stdlib.h>
#include <string.h>

const option scene_loading_options[] = {
    {"--allow-outside", OPTION_FLAG, offsetof(scene_options, allow_outside), NULL,
     "read files that a model names wherever they are, not in its parent folder alone"},
    {"--import-limits", OPTION_TEXT, offsetof(scene_options, import_limits), "NAME=N,...",
     "raise a limit of imports: triangles, texels, polygon_corners, materials, nodes"},
    {0}};

static bool set_limit(olx_scene_limits *limits, const char *name, size_t length, unsigned long long value) {
  const struct {
    const char *name;
    uint64_t *wide;
    uint32_t *narrow;
  } rows[] = {{"triangles", &limits->triangles, NULL},
              {"texels", &limits->texels, NULL},
              {"polygon_corners", NULL, &limits->polygon_corners},
              {"materials", NULL, &limits->materials},
              {"nodes", NULL, &limits->nodes}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) {
    if (strlen(rows[i].name) != length || strncmp(rows[i].name, name, length) != 0) continue;
    if (rows[i].wide) *rows[i].wide = value;
    else *rows[i].narrow = value < UINT32_MAX ? (uint32_t)value : UINT32_MAX;
    return true;
  }
  return false;
}

// Parses limits of the form "NAME=N,NAME=N".
static bool parse_limits(const char *text, olx_scene_limits *limits) {
  for (;;) {
    const size_t length = strcspn(text, "=");
    if (text[length] != '=' || text[length + 1] < '0' || text[length + 1] > '9') return false;
    char *end;
    const unsigned long long value = strtoull(text + length + 1, &end, 10);
    if (value == 0 || (*end && *end != ',') || !set_limit(limits, text, length, value)) return false;
    if (!*end) return true;
    text = end + 1;
  }
}

int load_scene(const char *command, const char *name, const scene_options *options, olx_scene **scene) {
  olx_scene_load_settings settings = olx_scene_load_settings_default();
  settings.allow_outside = options->allow_outside;
  settings.instructions = (olx_instructions)options->instructions;
  if (options->import_limits && !parse_limits(options->import_limits, &settings.limits)) {
    return usage_error(command,
                       "--import-limits: '%s' is not NAME=N,... where NAME is triangles, texels, polygon_corners, "
                       "materials or nodes and N a number above 0",
                       options->import_limits);
  }
  return olx_scene_load_with(name, &settings, scene) == OLX_OK ? EXIT_DONE : library_failure(command);
}
