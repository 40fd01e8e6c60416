// Records the files that a scene was read from by device and inode, so that an output under any name, or through any
// link, is recognized as one of them.
#include "scene/sources.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>
#include <sys/stat.h>

struct olx_scene_source {
  dev_t device;
  ino_t inode;
};

olx_result olx_scene_note_source(olx_scene *scene, const char *path) {
  struct stat status;
  if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) return OLX_OK;
  const uint32_t count = scene->source_count;
  if ((count & (count - 1)) == 0) { // grows the capacity to the next power of two
    struct olx_scene_source *grown = olx_allocate(count ? 2 * (size_t)count : 1, sizeof *grown);
    if (!grown) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
    if (count) memcpy(grown, scene->sources, count * sizeof *grown);
    olx_release(scene->sources);
    scene->sources = grown;
  }
  scene->sources[scene->source_count++] = (struct olx_scene_source){status.st_dev, status.st_ino};
  return OLX_OK;
}

bool olx_scene_was_read_from(const olx_scene *scene, const char *path) {
  struct stat status;
  if (stat(path, &status) != 0) return false;
  for (uint32_t i = 0; i < scene->source_count; i++) {
    if (scene->sources[i].device == status.st_dev && scene->sources[i].inode == status.st_ino) return true;
  }
  return false;
}

olx_result olx_scene_check_output(const olx_scene *scene, const char *path) {
  if (!olx_scene_was_read_from(scene, path)) return OLX_OK;
  return olx_fail(OLX_ERROR_FILE, "%s: cannot write: the scene was read from it", path);
}

void olx_scene_release_sources(olx_scene *scene) { olx_release(scene->sources); }
