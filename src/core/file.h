// Files that are never left half written, and files mapped into memory. file_posix.c implements them for POSIX.
// file_plain.c reads with C17 alone and writes nothing. A port to another system adds one such file.
#ifndef OLX_CORE_FILE_H
#define OLX_CORE_FILE_H

#include "core/temporary.h"

#include <octalux/base.h>

// An output that is being written: a temporary file beside its final place, or a stream. Must be zero-initialised.
typedef struct olx_output_file {
  bool stream;
  int descriptor;
  char *path; // as the caller gave it, for messages
  char *name; // of the file within its folder
  olx_temporary temporary;
  bool replaces; // it replaces a file with this owner, group and mode (POSIX)
  uint32_t owner, group, mode;
} olx_output_file;

// Opens an output that is written in any order. Links are followed to the file to which they lead, which is replaced at
// the commit. OLX_ERROR_FILE for standard output ("-") and for anything else that is not a regular file.
olx_result olx_output_open(const char *path, olx_output_file *file);
// Opens an output that is written from beginning to end, by olx_output_write alone. Standard output ("-"), character
// devices and pipes are then written directly, without a temporary file.
olx_result olx_output_open_in_order(const char *path, olx_output_file *file);
olx_result olx_output_write(olx_output_file *file, const void *data, size_t size_bytes);
olx_result olx_output_write_at(olx_output_file *file, uint64_t offset, const void *data, size_t size_bytes);
// Reserves the space that the file will need, so that a full disk is noticed at the start. Has no effect where the file
// system does not support it.
olx_result olx_output_reserve(olx_output_file *file, uint64_t size_bytes);
// Syncs the file, renames it into place with the owner and mode of the file that it replaces, where that is permitted,
// and syncs the folder. Closes the output in any case.
olx_result olx_output_commit(olx_output_file *file);
// Closes the output and removes the temporary file; has no effect after a commit.
void olx_output_discard(olx_output_file *file);

// Bytes whose place in an output is known only at its end: a temporary file in the output's folder, which takes no
// memory.
// Must be zero-initialised.
typedef struct olx_spool {
  olx_temporary file;
  uint64_t size_bytes;
} olx_spool;

// Appends bytes. The output must be open, and not a stream.
olx_result olx_spool_append(olx_spool *spool, const olx_output_file *output, const void *data, size_t size_bytes);
// Reads bytes that were appended.
olx_result olx_spool_read(const olx_spool *spool, const olx_output_file *output, uint64_t offset, void *data,
                          size_t size_bytes);
// Removes the file; has no effect when nothing was appended.
void olx_spool_discard(olx_spool *spool);

// A read-only mapping of a whole file. For an empty file, `data` is a non-NULL address that must not be read. Must be
// zero-initialised.
typedef struct olx_mapped_file {
  const void *data;
  size_t size_bytes;
} olx_mapped_file;

olx_result olx_map_file(const char *path, olx_mapped_file *file);
void olx_unmap_file(olx_mapped_file *file);

#endif
