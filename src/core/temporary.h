// A file without a name, or with a temporary one, that becomes a file in its folder all at once. What a killed program
// left behind is removed by the next one that writes in the same folder.
#ifndef OLX_CORE_TEMPORARY_H
#define OLX_CORE_TEMPORARY_H

#include <octalux/base.h>

// Zero-initialise. Where the file system can, the file has no name until it is put into place, so that nothing is left
// of it when the program dies. Elsewhere it is called ".octalux-XXXXXXXX.tmp" and locked (flock) while its program
// lives.
typedef struct olx_temporary {
  bool open;
  int folder, descriptor;
  char name[32]; // in the folder; empty while there is none
} olx_temporary;

// Create the file, open for reading and writing, and remove what dead programs left in the folder. `mode`, a mode_t, is
// reduced by the process's mask. Returns 0, or the error number.
int olx_temporary_create(const char *folder, uint32_t mode, olx_temporary *file);
// Create it in a folder that is open already, which is not searched for what dead programs left.
int olx_temporary_create_at(int folder, uint32_t mode, olx_temporary *file);
// Remove what dead programs left in a folder.
void olx_temporary_reclaim(int folder);
// Whether a file of this name in a folder could be one.
bool olx_is_temporary_name(const char *name);
// Make the content durable, then give the file the name `name` in its folder, in place of what is there, and make that
// durable. Returns 0, or the error number; the file is closed in any case, and removed when it could not be put into
// place.
int olx_temporary_put(olx_temporary *file, const char *name);
// Close and remove the file; nothing happens when it is not open.
void olx_temporary_discard(olx_temporary *file);

#endif
