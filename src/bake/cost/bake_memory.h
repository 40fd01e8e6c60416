// The limit on a bake's memory.
#ifndef OLX_BAKE_BAKE_MEMORY_H
#define OLX_BAKE_BAKE_MEMORY_H

#include <octalux/bake.h>

#include <limits.h>

// Makes a bake obey settings->memory_limit_bytes: lowers the number of threads, and sets `link_folder` to where links
// are to be kept in files, or to "" where they fit in memory. OLX_ERROR_MEMORY when that is not enough. `path` is of
// the field or, for a part, of its work folder.
olx_result olx_bake_keep_limit(const olx_scene *scene, olx_bake_settings *settings, const char *path,
                               const olx_progress *progress, char link_folder[PATH_MAX]);

#endif
