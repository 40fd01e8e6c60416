// A work folder: the results of units, each in a file that exists completely or not at all and is verified when it is
// read.
//
// The folder belongs to one bake, which its manifest describes line by line, and to one user (mode 0700). Links are
// never followed, and no files are removed except units of stages that the manifest lists, the manifest, and temporary
// files of programs that have ended.
#ifndef OLX_WORK_WORK_FOLDER_H
#define OLX_WORK_WORK_FOLDER_H

#include "work/byte_stream.h"

#include <limits.h>

typedef struct olx_work_folder olx_work_folder;

enum { OLX_UNIT_HEADER_BYTES = 64 }; // size of a unit file's header, before the result

// Everything that a bake depends on, one line each: its name, a space, its value. The line "stages" lists the stages
// whose units the folder may hold. The line "parts-of-scene" lists the lines that hash parts of the scene; two bakes
// may share a folder when all other lines are equal, because each unit has a key of the parts that it depends on.
typedef struct olx_manifest {
  char text[4096];
} olx_manifest;

void olx_manifest_add(olx_manifest *manifest, const char *name, const char *value);
void olx_manifest_add_hash(olx_manifest *manifest, const char *name, uint64_t hash);
// Returns the value of a line; "" when the manifest has no line of that name.
typedef struct olx_manifest_value {
  char text[256];
} olx_manifest_value;
olx_manifest_value olx_manifest_find(const olx_manifest *manifest, const char *name);

// Parts of the scene: the lines that "parts-of-scene" lists, by their order there. 0 stands for all of them, so that a
// unit about which nothing is said depends on everything.
typedef uint32_t olx_scene_parts;
enum { OLX_PARTS_ALL = 0, OLX_MOST_SCENE_PARTS = 8 };
// Returns a key of the parts' values.
uint64_t olx_manifest_key(const olx_manifest *manifest, olx_scene_parts parts);
// Returns the parts that differ between two manifests.
olx_scene_parts olx_manifest_differing(const olx_manifest *a, const olx_manifest *b);
// Writes the names of parts, separated by spaces.
olx_manifest_value olx_manifest_part_names(const olx_manifest *manifest, olx_scene_parts parts);

// The parts of a unit's file name, STAGE-ROUND-UNIT.unit.
typedef struct olx_unit_name {
  const char *stage; // lower-case letters, at most 15
  uint32_t round, unit;
  olx_scene_parts parts; // on which the unit depends; not a part of the file name
} olx_unit_name;

typedef enum olx_unit_state {
  OLX_UNIT_ABSENT = 0,
  OLX_UNIT_STALE, // computed for a scene that differs in the parts that the unit depends on
  OLX_UNIT_STORED // as far as its header says
} olx_unit_state;

typedef enum olx_work_lock {
  OLX_WORK_SHARED = 0, // others with a shared lock may use the folder
  OLX_WORK_ALONE       // fails while another program has the folder open
} olx_work_lock;

typedef struct olx_work_folder_settings {
  const olx_manifest *manifest; // of the bake; NULL: that of the folder, which must exist
  olx_work_lock lock;           // ignored where the file system has no locks
  bool fresh;                   // remove existing units, also those of another bake
  bool edited;                  // accept a folder whose bake differs in parts of the scene
} olx_work_folder_settings;

// Opens a folder, which is created unless it exists. Returns OLX_ERROR_FILE when it is a link, belongs to another user,
// is open to others, is in use, or holds files without a manifest; OLX_ERROR_ARGUMENT when it belongs to another bake,
// with the first line that differs in the message.
olx_result olx_work_folder_open(const char *path, const olx_work_folder_settings *settings, olx_work_folder **folder);
// Closes a folder and keeps its files. NULL is allowed.
void olx_work_folder_close(olx_work_folder *folder);
// Removes all units, the manifest and, when nothing else is left in it, the folder; then closes it. A warning names a
// folder that stays because it holds something else, or because another program keeps it open for seconds. Where a
// program is killed on the way, the next one to open the folder for a bake, whichever bake that is, removes what is
// left.
void olx_work_folder_remove(olx_work_folder *folder);

const olx_manifest *olx_work_folder_manifest(const olx_work_folder *folder);
// Returns the parts of the scene in which the folder's last bake differed from this one.
olx_scene_parts olx_work_folder_edited(const olx_work_folder *folder);
// Removes the units that were computed for scenes before the last edit and do not hold for this one.
void olx_work_folder_tidy(olx_work_folder *folder);
// Returns the total size in bytes of the units that existed when it was opened and that were stored since.
uint64_t olx_work_folder_bytes(const olx_work_folder *folder);

olx_unit_state olx_work_folder_look(const olx_work_folder *folder, const olx_unit_name *name);
// Returns whether the unit is stored for this scene.
bool olx_work_folder_has(const olx_work_folder *folder, const olx_unit_name *name);
// Stores the result of a unit, in place of an existing one.
olx_result olx_work_folder_put(olx_work_folder *folder, const olx_unit_name *name, const void *data, size_t size_bytes);
// Returns whether the result that was stored last found no space on the disk, or within the user's quota.
bool olx_work_folder_is_full(const olx_work_folder *folder);
// Reads the result of a unit; the caller releases *data with olx_release. Returns OLX_ERROR_INCOMPLETE when there is
// none or it is stale, OLX_ERROR_CHECKSUM when it is damaged, OLX_ERROR_FILE when it cannot be read, for which another
// time may be better. Messages name the file.
olx_result olx_work_folder_get(const olx_work_folder *folder, const olx_unit_name *name, void **data,
                               size_t *size_bytes);
// Reads the result of a unit that was computed for another scene; the caller releases *data with olx_release, which is
// NULL where there is no such unit or it is damaged.
void olx_work_folder_get_stale(const olx_work_folder *folder, const olx_unit_name *name, void **data,
                               size_t *size_bytes);
// Removes the result of a unit, where there is one.
void olx_work_folder_drop(olx_work_folder *folder, const olx_unit_name *name);

#endif
