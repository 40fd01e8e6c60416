// A file that has no name or a temporary one until it is put into place in its folder atomically. Files that a killed
// program left behind are removed by the next program that writes to the same folder.
#ifndef OLX_CORE_TEMPORARY_H
#define OLX_CORE_TEMPORARY_H

#include <octalux/base.h>

// A temporary file; must be zero-initialised. Where the file system supports it, the file has no name until it is put
// into place, so that nothing remains when the program dies. Elsewhere it is called ".octalux-XXXXXXXX.tmp", where
// the first digits tell the machine, and is locked (flock) while its program lives.
typedef struct olx_temporary {
  bool open;
  int folder, descriptor;
  char name[32]; // in the folder; empty for a file without one
} olx_temporary;

// Creates the file, open for reading and writing, and removes files that dead programs of this machine left in the
// folder. `mode`, a mode_t, is reduced by the process's mask. Returns 0 or the error number.
int olx_temporary_create(const char *folder, uint32_t mode, olx_temporary *file);
// Creates the file in an open folder, which is not searched for files that dead programs left.
int olx_temporary_create_at(int folder, uint32_t mode, olx_temporary *file);
// Removes the files that dead programs left in a folder: those of this machine, or of all, whose locks are not known
// everywhere on some file systems that machines share.
void olx_temporary_reclaim(int folder, bool of_all_machines);
// Draws the name of a temporary file of this machine, another one for each attempt.
void olx_temporary_name(uint32_t attempt, char name[32]);
// Returns whether a file of this name in a folder could be a temporary file.
bool olx_is_temporary_name(const char *name);
// Makes the content durable, gives the file the name `name` in its folder in place of any file there, and makes that
// durable too. Returns 0 or the error number. The file is closed in any case, and removed when it could not be put into
// place.
int olx_temporary_put(olx_temporary *file, const char *name);
// Closes and removes the file; has no effect when it is not open.
void olx_temporary_discard(olx_temporary *file);

#endif
