// The work folder of a bake: what names the bake in it, and when it is opened and goes away.
#ifndef OLX_BAKE_BAKE_WORK_H
#define OLX_BAKE_BAKE_WORK_H

#include "work/unit_store.h"

#include <octalux/bake.h>

// *store is NULL where the settings name no folder.
olx_result olx_bake_work_open(const olx_scene *scene, const olx_bake_settings *settings, olx_unit_store **store);
// Closes the store; the folder goes away when the field is written, unless it is to be kept.
void olx_bake_work_close(olx_unit_store *store, const olx_bake_work *work, olx_result result);

// Everything that results depend on: the scene, the settings, the format, this build, Embree, and the machine's
// arithmetic.
olx_manifest olx_bake_manifest(const olx_scene *scene, const olx_bake_settings *settings);

// A name of this build of the library, by which no other build goes.
typedef struct olx_build_name {
  char text[64];
} olx_build_name;

olx_build_name olx_name_build(void);

#endif
