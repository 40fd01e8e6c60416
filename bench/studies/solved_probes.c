// Reads the probes for which studies solve the light of a scene: those of a file, or those of the scene's grid.
#include "solved_probes.h"

#include "field/field_data.h"
#include "scene/scene_data.h"

#include <octalux/bake.h>
#include <octalux/place.h>

#include <stdlib.h>
#include <string.h>

static olx_result allocate(solved_probes *probes, uint32_t count) {
  *probes = (solved_probes){malloc(count * sizeof *probes->positions), calloc(count, 1), count};
  return probes->positions && probes->flags ? OLX_OK : OLX_ERROR_MEMORY;
}

static olx_result load_file(const olx_scene *scene, const char *path, solved_probes *probes) {
  olx_probe_set placed;
  olx_result result = olx_probe_set_load(path, scene->origin, &placed);
  if (result != OLX_OK) return result;
  result = allocate(probes, placed.count);
  for (uint32_t i = 0; result == OLX_OK && i < placed.count; i++) probes->positions[i] = placed.probes[i].position;
  olx_probe_set_free(&placed);
  return result;
}

static olx_result take_grid(const olx_scene *scene, solved_probes *probes) {
  const olx_grid g = olx_bake_settings_default(scene).grid;
  const olx_result result = allocate(probes, g.count[0] * g.count[1] * g.count[2]);
  for (uint32_t i = 0; result == OLX_OK && i < probes->count; i++) probes->positions[i] = olx_grid_position(&g, i);
  return result;
}

olx_result solved_probes_load(const olx_scene *scene, const char *path, solved_probes *probes) {
  return strcmp(path, "-") == 0 ? take_grid(scene, probes) : load_file(scene, path, probes);
}
