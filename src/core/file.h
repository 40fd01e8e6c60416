// Files that are never left half written, and files mapped into memory. file_posix.c has them for POSIX, file_plain.c
// reads by what C17 has and writes nothing; a port to another system writes one such file.
#ifndef OLX_CORE_FILE_H
#define OLX_CORE_FILE_H

#include "core/temporary.h"

#include <octalux/base.h>

// An output being written: a temporary file beside its final place, or a stream. Zero-initialise.
typedef struct olx_output_file {
  bool stream;
  int descriptor;
  char *path; // as it was given, for messages
  char *name; // of the file in its folder
  olx_temporary temporary;
  bool replaces; // a file of this owner, group and mode, as POSIX has them
  uint32_t owner, group, mode;
} olx_output_file;

// Open an output that is written in any order. Links are followed to the file they lead to, which is replaced at the
// commit. OLX_ERROR_FILE for standard output ("-") and for whatever else is no regular file.
olx_result olx_output_open(const char *path, olx_output_file *file);
// Open an output that is written from its begin to its end, by olx_output_write alone: then standard output ("-"),
// character devices and pipes are written as they are, without a temporary file.
olx_result olx_output_open_in_order(const char *path, olx_output_file *file);
olx_result olx_output_write(olx_output_file *file, const void *data, size_t size_bytes);
olx_result olx_output_write_at(olx_output_file *file, uint64_t offset, const void *data, size_t size_bytes);
// Claim the space the file will need, so that a disk too full is known at the start; where the file system cannot,
// nothing happens.
olx_result olx_output_reserve(olx_output_file *file, uint64_t size_bytes);
// Sync the file, put it into place with the owner and mode of the file it replaces, where that is permitted, and sync
// the folder. Whatever comes back, the output is closed.
olx_result olx_output_commit(olx_output_file *file);
// Close the output and remove the temporary file; nothing happens after a commit.
void olx_output_discard(olx_output_file *file);

// A read-only mapping of a whole file; of an empty one, `data` is an address all the same, at which nothing may be
// read. Zero-initialise.
typedef struct olx_mapped_file {
  const void *data;
  size_t size_bytes;
} olx_mapped_file;

olx_result olx_map_file(const char *path, olx_mapped_file *file);
void olx_unmap_file(olx_mapped_file *file);

#endif
