// Files that are never left half written, and files mapped into memory.
#ifndef OLX_CORE_FILE_H
#define OLX_CORE_FILE_H

#include <octalux/base.h>

// A file being written beside its final place. Zero-initialise.
typedef struct olx_output_file {
  int descriptor;
  char *path, *temporary_path;
} olx_output_file;

// Create a temporary file in the directory of `path`.
olx_result olx_output_open(const char *path, olx_output_file *file);
olx_result olx_output_write(olx_output_file *file, const void *data, size_t size_bytes);
olx_result olx_output_write_at(olx_output_file *file, uint64_t offset, const void *data, size_t size_bytes);
// Claim the space the file will need, so that a disk too full is known at the start; where the file system cannot, nothing
// happens.
olx_result olx_output_reserve(olx_output_file *file, uint64_t size_bytes);
// Sync, rename over `path`, sync the directory. Whatever comes back, the file is closed.
olx_result olx_output_commit(olx_output_file *file);
// Remove the temporary file; nothing happens after a commit.
void olx_output_discard(olx_output_file *file);

// A read-only mapping of a whole file. Zero-initialise.
typedef struct olx_mapped_file {
  const void *data;
  size_t size_bytes;
} olx_mapped_file;

olx_result olx_map_file(const char *path, olx_mapped_file *file);
void olx_unmap_file(olx_mapped_file *file);

#endif
