// Work divided into stages of units. A unit is a pure function of the bake and of the stages before: it computes a
// result that a work folder can store, so that another run, or another machine, need not compute it again.
//
// A whole bake runs all stages: it loads what the folder has, and computes and stores the rest. A part computes its
// share of each stage whose inputs are complete; one that may wait also helps other parts (unit_deal.h), and waits for
// what only they can store. Joining loads everything and computes nothing. Without a store every
// unit is computed.
#ifndef OLX_WORK_UNIT_STORE_H
#define OLX_WORK_UNIT_STORE_H

#include "work/work_folder.h"

typedef struct olx_unit_store olx_unit_store;

// The report of a finished unit.
typedef struct olx_unit_done {
  olx_unit_name name;
  uint32_t count; // number of units in its stage and round
  bool found;     // loaded; otherwise computed
  const char
      *why; // why it was computed: "new", "damaged", "unreadable", or the parts of the scene that changed; "" when
            // loaded
  double seconds; // time to compute or load it
  uint64_t bytes; // size of its result; 0 where it was not stored
} olx_unit_done;

typedef struct olx_unit_store_settings {
  const char *folder;
  const olx_manifest *manifest; // NULL: join the units in the folder
  bool fresh;                   // discard the units in the folder
  bool edited;                  // accept a folder whose bake differs in parts of the scene, and reuse what still holds
  uint64_t limit_bytes;         // most bytes that a whole bake stores; a part fails beyond it, and both do the same
                                // where the disk is full; 0: no limit
  uint32_t part, parts;         // share to compute, from 1 to `parts`; 0: a whole bake
  void (*done)(void *user, const olx_unit_done *unit); // may be NULL; called on the thread that runs stages
  bool (*wait)(void *user, double waited_seconds);     // olx_bake_work.wait; NULL: a part never waits
  void *user;
} olx_unit_store_settings;

// Opens a store. Strings and the manifest are copied. Errors are those of olx_work_folder_open.
olx_result olx_unit_store_open(const olx_unit_store_settings *settings, olx_unit_store **store);
// Removes units that do not hold for this scene, once all that do are stored. NULL is allowed.
void olx_unit_store_tidy(olx_unit_store *store);
// Closes a store; with `remove`, deletes its folder. NULL is allowed.
void olx_unit_store_close(olx_unit_store *store, bool remove);

bool olx_unit_store_is_part(const olx_unit_store *store); // false for NULL
bool olx_unit_store_joins(const olx_unit_store *store);   // false for NULL
// Returns the folder's manifest, for joining.
const olx_manifest *olx_unit_store_manifest(const olx_unit_store *store);

// One stage in one round: units 0 to count - 1.
typedef struct olx_unit_stage {
  const char *name;
  uint32_t round, count;
  void *user;
  olx_result (*make)(void *user, uint32_t unit); // computes the result in the user's memory; NULL: it is there already
  void (*save)(void *user, uint32_t unit, olx_byte_writer *to); // called right after `make`
  olx_result (*load)(void *user, uint32_t unit,
                     olx_byte_reader *from); // replaces `make`; what it reads is valid only during the call
  olx_scene_parts parts; // parts of the scene that its units depend on, with those of the stages before; 0: all
} olx_unit_stage;

// Returns whether unit 0 of a stage is stored; false for a NULL store.
bool olx_units_have(const olx_unit_store *store, const olx_unit_stage *stage);

// Reads a unit that was computed for another scene. *data is NULL where the unit is not stored; otherwise the caller
// releases it with olx_release. Returns false where the stage has no unit of this number. store may be NULL.
bool olx_units_read_stale(const olx_unit_store *store, const olx_unit_stage *stage, uint32_t unit, void **data,
                          size_t *size_bytes);
// Returns whether the units 0 to count - 1 of a stage are stored; false for a NULL store, unless count is 0.
bool olx_units_have_all(const olx_unit_store *store, const char *stage, uint32_t count);
// Removes unit 0 of some rounds of a stage. store may be NULL.
void olx_units_forget(olx_unit_store *store, const char *stage, uint32_t first_round, uint32_t rounds);

// Runs a stage. A whole bake loads or computes every unit, in order. A part computes those of its own units that are
// missing, and loads none; it returns OLX_ERROR_INCOMPLETE when units of others are missing. A damaged file is named in
// a warning and removed, and its unit recomputed, but joining returns OLX_ERROR_CHECKSUM. A file that cannot be read is
// named and its unit recomputed, too, but the file stays until that replaces it, and joining returns OLX_ERROR_FILE.
// store may be NULL.
olx_result olx_units_make(olx_unit_store *store, const olx_unit_stage *stage);
// Waits until every unit of a stage is stored. Returns OLX_ERROR_INCOMPLETE when some are missing and the
// store may not wait for them. store may be NULL.
olx_result olx_units_await(olx_unit_store *store, const olx_unit_stage *stage);
// Loads every unit of a complete stage. A part needs it to read the units that olx_units_make left to others.
// OLX_ERROR_INCOMPLETE when some are missing or were damaged; OLX_ERROR_FILE when one, which stays, cannot be read.
olx_result olx_units_load(olx_unit_store *store, const olx_unit_stage *stage);
// Stores unit 0 of a stage that was computed as a part of another unit; it is not reported. store may be NULL.
olx_result olx_unit_keep(olx_unit_store *store, const olx_unit_stage *stage);
// Runs a stage of one unit, after which its result is in memory.
olx_result olx_unit_once(olx_unit_store *store, const olx_unit_stage *stage);

// Parts that never wait share a mark in the folder: the stage that lets none of them go on while units are missing.
// Whoever heeds it learns what is missing without loading the stages before. A part whose share is missing, or that
// finds no mark or one that has been overtaken, has to run the stages to find out. store may be NULL.
//
// Leaves a mark of the stage for which OLX_ERROR_INCOMPLETE was returned last. The caller must not have gone on to other
// stages since, and no other part may be able to.
olx_result olx_units_leave_mark(olx_unit_store *store);
// Returns OLX_ERROR_INCOMPLETE when units of the marked stage are missing and other parts have to compute all of them.
olx_result olx_units_heed_mark(olx_unit_store *store);

#endif
