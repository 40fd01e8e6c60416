// Reads whole files into memory with nothing but C17. It writes none, because C17 cannot put a file into place
// atomically.
#include "core/file.h"

#include "core/hooks.h"
#include "core/result.h"

#include <stdio.h>
#include <string.h>

static olx_result refuse(const char *path) {
  return olx_fail(OLX_ERROR_UNSUPPORTED, "%s: this build writes no files (OCTALUX_SYSTEM is plain)", path);
}

olx_result olx_output_open(const char *path, olx_output_file *file) {
  *file = (olx_output_file){.descriptor = -1};
  return refuse(path);
}

olx_result olx_output_open_in_order(const char *path, olx_output_file *file) { return olx_output_open(path, file); }

olx_result olx_output_write(olx_output_file *file, const void *data, size_t size_bytes) {
  (void)data, (void)size_bytes;
  return refuse(file->path ? file->path : "output");
}

olx_result olx_output_write_at(olx_output_file *file, uint64_t offset, const void *data, size_t size_bytes) {
  (void)offset;
  return olx_output_write(file, data, size_bytes);
}

olx_result olx_output_reserve(olx_output_file *file, uint64_t size_bytes) {
  return olx_output_write(file, NULL, (size_t)size_bytes);
}

olx_result olx_output_commit(olx_output_file *file) { return olx_output_write(file, NULL, 0); }

void olx_output_discard(olx_output_file *file) { *file = (olx_output_file){.descriptor = -1}; }

olx_result olx_spool_append(olx_spool *spool, const olx_output_file *output, const void *data, size_t size_bytes) {
  (void)spool, (void)data, (void)size_bytes;
  return refuse(output->path ? output->path : "output");
}

olx_result olx_spool_read(const olx_spool *spool, const olx_output_file *output, uint64_t offset, void *data,
                          size_t size_bytes) {
  (void)spool, (void)offset, (void)data, (void)size_bytes;
  return refuse(output->path ? output->path : "output");
}

void olx_spool_discard(olx_spool *spool) { *spool = (olx_spool){0}; }

olx_result olx_output_check(const char *path, bool in_order) {
  (void)in_order;
  return refuse(path);
}

olx_result olx_write_file(const char *path, const void *data, size_t size_bytes) {
  (void)data, (void)size_bytes;
  return refuse(path);
}

// Compares paths, because C17 cannot determine whether two paths name the same file.
bool olx_same_file(const char *a, const char *b) { return strcmp(a, b) == 0; }

static olx_result read_whole(const char *path, FILE *stream, olx_mapped_file *file) {
  const long size_bytes = fseek(stream, 0, SEEK_END) == 0 ? ftell(stream) : -1;
  if (size_bytes < 0 || fseek(stream, 0, SEEK_SET) != 0) {
    return olx_fail(OLX_ERROR_FILE, "%s: cannot read: its size is not known", path);
  }
  if (size_bytes == 0) {
    file->data = "";
    return OLX_OK;
  }
  void *data = olx_allocate((size_t)size_bytes, 1);
  if (!data) return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  if (fread(data, 1, (size_t)size_bytes, stream) != (size_t)size_bytes) {
    olx_release(data);
    return olx_fail(OLX_ERROR_FILE, "%s: cannot read: it ends early", path);
  }
  *file = (olx_mapped_file){.data = data, .size_bytes = (size_t)size_bytes};
  return OLX_OK;
}

olx_result olx_map_file(const char *path, olx_mapped_file *file) {
  *file = (olx_mapped_file){0};
  FILE *stream = fopen(path, "rb");
  if (!stream) return olx_fail(OLX_ERROR_FILE, "%s: cannot open", path);
  const olx_result result = read_whole(path, stream, file);
  fclose(stream);
  return result;
}

void olx_unmap_file(olx_mapped_file *file) {
  if (file->size_bytes > 0) olx_release((void *)(uintptr_t)file->data);
  *file = (olx_mapped_file){0};
}
