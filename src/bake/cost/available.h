// The memory and the disk space that the machine has left.
#ifndef OLX_BAKE_AVAILABLE_H
#define OLX_BAKE_AVAILABLE_H

#include <octalux/base.h>

// Returns the bytes of memory that can be allocated without swapping: of the machine, or of the control group that this
// process is in, whichever is less. UINT64_MAX when it is not known.
uint64_t olx_available_memory(void);
// Returns what is left to the control group whose files are in `folder`: files that it has read or written are kept in
// memory as long as nothing else needs it, and do not count. UINT64_MAX when the group has no limit, or none is known.
uint64_t olx_available_to_group(const char *folder);

// Memory of this process in bytes: what it holds now, with the most that its program and libraries will be read into,
// and the most that it held at any time. 0 when it is not known.
typedef struct olx_process_memory {
  uint64_t now, most;
} olx_process_memory;

olx_process_memory olx_own_memory(void);

// Returns the bytes that a new file at `path` may take. UINT64_MAX when it is not known, or when `path` is not a
// regular file.
uint64_t olx_available_disk(const char *path);

#endif
