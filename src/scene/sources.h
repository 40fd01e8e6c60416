// The files that a scene was read from, so that no output destroys one of them.
#ifndef OLX_SCENE_SOURCES_H
#define OLX_SCENE_SOURCES_H

#include "scene/scene_data.h"

// Records that a file belongs to the scene. A path that leads to no regular file is ignored.
olx_result olx_scene_note_source(olx_scene *scene, const char *path);

// Rejects an output that is one of the scene's files.
olx_result olx_scene_check_output(const olx_scene *scene, const char *path);

void olx_scene_release_sources(olx_scene *scene);

#endif
