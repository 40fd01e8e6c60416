// The work folder of a bake: the manifest that identifies the bake, and when the folder is opened and removed.
#ifndef OLX_BAKE_BAKE_WORK_H
#define OLX_BAKE_BAKE_WORK_H

#include "work/unit_store.h"

#include <octalux/bake.h>

// Returns whether a work folder can keep the results of a bake with these settings.
bool olx_bake_can_be_kept(const olx_bake_settings *settings);

// Checks what the settings say of the work folder, without looking at the folder itself.
olx_result olx_bake_work_check(const olx_bake_settings *settings);
// Refuses an output in the work folder itself, which would replace a result there, or be removed with the folder.
olx_result olx_bake_check_apart(const char *path, const char *folder);
// Opens the store of the bake's units; *store is NULL where the settings name no folder.
olx_result olx_bake_work_open(const olx_scene *scene, const olx_bake_settings *settings, olx_unit_store **store);
// Closes the store. The folder is removed once the field is written, unless the settings keep it.
void olx_bake_work_close(olx_unit_store *store, const olx_bake_work *work, olx_result result);

// Describes everything that results depend on: the scene, the settings, the format, this build, Embree, and the
// machine's arithmetic.
olx_manifest olx_bake_manifest(const olx_scene *scene, const olx_bake_settings *settings);

// A name that identifies this build of the library.
typedef struct olx_build_name {
  char text[64];
} olx_build_name;

olx_build_name olx_name_build(void);

#endif
