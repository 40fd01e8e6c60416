// A work folder: results of units, each in a file that is there whole or not at all and is checked when it is read.
//
// The folder belongs to one bake, which its manifest describes line by line, and to one user (mode 0700). No links are
// followed, and no file is removed but units of stages that the manifest lists, the manifest, and temporary files of
// programs that are dead.
#ifndef OLX_WORK_WORK_FOLDER_H
#define OLX_WORK_WORK_FOLDER_H

#include "work/byte_stream.h"

#include <limits.h>

typedef struct olx_work_folder olx_work_folder;

enum { OLX_UNIT_HEADER_BYTES = 64 }; // of a file, before the result

// What a bake depends on, one line a thing: its name, a space, its value. Two bakes may share a folder when all lines
// are equal. The line "stages" lists the stages whose units the folder may hold.
typedef struct olx_manifest {
  char text[4096];
} olx_manifest;

void olx_manifest_add(olx_manifest *manifest, const char *name, const char *value);
void olx_manifest_add_hash(olx_manifest *manifest, const char *name, uint64_t hash);
// The value of a line, "" when there is none of that name.
typedef struct olx_manifest_value {
  char text[256];
} olx_manifest_value;
olx_manifest_value olx_manifest_find(const olx_manifest *manifest, const char *name);

// What names a unit's file, STAGE-ROUND-UNIT.unit.
typedef struct olx_unit_name {
  const char *stage; // lower-case letters, at most 15
  uint32_t round, unit;
} olx_unit_name;

typedef enum olx_work_lock {
  OLX_WORK_SHARED = 0, // with others that share it
  OLX_WORK_ALONE       // refused while anyone else has the folder open
} olx_work_lock;

typedef struct olx_work_folder_settings {
  const olx_manifest *manifest; // of the bake; NULL: that of the folder, which must be there
  olx_work_lock lock;           // where the file system has none, nothing is locked
  bool fresh;                   // remove units that are there, also those of another bake
} olx_work_folder_settings;

// Opens a folder, which is made unless it is there. OLX_ERROR_FILE when it is a link, another user's, open to others,
// in use, or holds files without a manifest; OLX_ERROR_ARGUMENT when it is another bake's, with the first line that
// differs in the message.
olx_result olx_work_folder_open(const char *path, const olx_work_folder_settings *settings, olx_work_folder **folder);
// NULL is allowed. Files stay.
void olx_work_folder_close(olx_work_folder *folder);
// Removes all units, the manifest and, when nothing else is left in it, the folder; and closes it. A folder that stays
// because it holds something else is named in a warning.
void olx_work_folder_remove(olx_work_folder *folder);

const olx_manifest *olx_work_folder_manifest(const olx_work_folder *folder);
const char *olx_work_folder_path(const olx_work_folder *folder);
// Bytes of all units that were there when it was opened, and that were put since.
uint64_t olx_work_folder_bytes(const olx_work_folder *folder);

// Whether there is a file for the unit.
bool olx_work_folder_has(const olx_work_folder *folder, const olx_unit_name *name);
// Stores the result of a unit, in place of what is there.
olx_result olx_work_folder_put(olx_work_folder *folder, const olx_unit_name *name, const void *data, size_t size_bytes);
// Reads the result of a unit; *data is the caller's, to be given to olx_release. OLX_ERROR_FILE when there is none,
// OLX_ERROR_CHECKSUM when it is damaged. Messages name the file.
olx_result olx_work_folder_get(const olx_work_folder *folder, const olx_unit_name *name, void **data,
                               size_t *size_bytes);
// Removes the result of a unit, where there is one.
void olx_work_folder_drop(olx_work_folder *folder, const olx_unit_name *name);

#endif
