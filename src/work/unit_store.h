// Work as stages of units. A unit is a pure function of the bake and of the stages before: it makes a result, which a
// work folder can hold, so that another run, or another machine, does not make it again.
//
// A whole bake goes through all stages: what is in the folder is loaded, the rest is made and stored. A part makes its
// share of each stage whose inputs are there. Joining loads everything and makes nothing. Without a store every unit is
// made.
#ifndef OLX_WORK_UNIT_STORE_H
#define OLX_WORK_UNIT_STORE_H

#include "work/work_folder.h"

typedef struct olx_unit_store olx_unit_store;

// What is reported of each unit that is done.
typedef struct olx_unit_done {
  olx_unit_name name;
  uint32_t count; // of units in its stage and round
  bool found;     // loaded, else made
  double seconds; // that making or loading took
} olx_unit_done;

typedef struct olx_unit_store_settings {
  const char *folder;
  const olx_manifest *manifest; // NULL: join what is there
  bool fresh;                   // forget what is there
  uint64_t limit_bytes;         // a whole bake stores no more than that, a part fails beyond it; 0: no bound
  uint32_t part, parts;         // which share to make, from 1 to `parts`; 0: a whole bake
  void (*done)(void *user, const olx_unit_done *unit); // NULL: not wanted. On the thread that works on stages
  void *user;
} olx_unit_store_settings;

// Strings and the manifest are copied. Errors as olx_work_folder_open.
olx_result olx_unit_store_open(const olx_unit_store_settings *settings, olx_unit_store **store);
// `remove`: the folder is not needed any more. NULL is allowed.
void olx_unit_store_close(olx_unit_store *store, bool remove);

bool olx_unit_store_is_part(const olx_unit_store *store); // false for NULL
bool olx_unit_store_joins(const olx_unit_store *store);   // false for NULL
// The folder's manifest, for joining.
const olx_manifest *olx_unit_store_manifest(const olx_unit_store *store);

// One stage in one round: units 0 to count - 1.
typedef struct olx_unit_stage {
  const char *name;
  uint32_t round, count;
  void *user;
  olx_result (*make)(void *user, uint32_t unit); // leaves the result in the user's memory; NULL: it is there
  void (*save)(void *user, uint32_t unit, olx_byte_writer *to); // right after make
  olx_result (*load)(void *user, uint32_t unit,
                     olx_byte_reader *from); // in place of make; what it reads goes with the call
} olx_unit_stage;

// Whether unit 0 of a stage is stored; false for NULL.
bool olx_units_have(const olx_unit_store *store, const char *stage, uint32_t round);

// Whether the units 0 to count - 1 of a stage are stored; false for NULL unless there are none.
bool olx_units_have_all(const olx_unit_store *store, const char *stage, uint32_t count);
// Removes unit 0 of some rounds of a stage. store may be NULL.
void olx_units_forget(olx_unit_store *store, const char *stage, uint32_t first_round, uint32_t rounds);

// A whole bake loads or makes every unit, in order. A part makes those of its own that are missing, and loads none:
// OLX_ERROR_INCOMPLETE when others are missing. A damaged file is named in a warning, and its unit made again, but
// OLX_ERROR_CHECKSUM when joining. store may be NULL.
olx_result olx_units_make(olx_unit_store *store, const olx_unit_stage *stage);
// Loads every unit of a stage that is complete; a part needs that before it reads what olx_units_make left to others.
olx_result olx_units_load(olx_unit_store *store, const olx_unit_stage *stage);
// Stores unit 0 of a stage, which came to be as a part of another unit that is being made; it is not reported. store
// may be NULL.
olx_result olx_unit_keep(olx_unit_store *store, const olx_unit_stage *stage);
// A stage of one unit, whose result is in memory afterwards, whoever makes it.
olx_result olx_unit_once(olx_unit_store *store, const olx_unit_stage *stage);

#endif
