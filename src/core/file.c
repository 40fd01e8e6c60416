#include "core/file.h"

#include "core/hooks.h"
#include "core/result.h"
#include "core/sampling.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { TEMPORARY_NAME_ATTEMPTS = 100 };

// As mkstemp, but with the rights any new file gets: asking for the process's mask would change it under other threads.
static int create_temporary(const char *path, char *name, size_t size_bytes) {
  for (uint32_t attempt = 0; attempt < TEMPORARY_NAME_ATTEMPTS; attempt++) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    const uint32_t tag = olx_hash3((uint32_t)getpid(), (uint32_t)now.tv_nsec, attempt);
    snprintf(name, size_bytes, "%s.tmp-%08x", path, tag);
    const int descriptor = open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

olx_result olx_output_open(const char *path, olx_output_file *file) {
  *file = (olx_output_file){.descriptor = -1};
  const size_t size_bytes = strlen(path) + 16;
  file->path = olx_copy_string(path);
  file->temporary_path = olx_allocate(size_bytes, 1);
  if (!file->path || !file->temporary_path) {
    olx_output_discard(file);
    return olx_fail(OLX_ERROR_MEMORY, "%s: out of memory", path);
  }
  file->descriptor = create_temporary(path, file->temporary_path, size_bytes);
  if (file->descriptor < 0) {
    const int error = errno;
    olx_output_discard(file);
    return olx_fail(OLX_ERROR_FILE, "%s: cannot create: %s", path, strerror(error));
  }
  return OLX_OK;
}

static olx_result write_all(olx_output_file *file, bool at, uint64_t offset, const void *data, size_t size_bytes) {
  const char *bytes = data;
  while (size_bytes > 0) {
    const ssize_t written = at ? pwrite(file->descriptor, bytes, size_bytes, (off_t)offset)
                               : write(file->descriptor, bytes, size_bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return olx_fail(OLX_ERROR_FILE, "%s: cannot write: %s", file->path, strerror(errno));
    bytes += written;
    offset += (uint64_t)written;
    size_bytes -= (size_t)written;
  }
  return OLX_OK;
}

olx_result olx_output_write(olx_output_file *file, const void *data, size_t size_bytes) {
  return write_all(file, false, 0, data, size_bytes);
}

olx_result olx_output_write_at(olx_output_file *file, uint64_t offset, const void *data, size_t size_bytes) {
  return write_all(file, true, offset, data, size_bytes);
}

olx_result olx_output_reserve(olx_output_file *file, uint64_t size_bytes) {
  while (fallocate(file->descriptor, 0, 0, (off_t)size_bytes) != 0) {
    if (errno == EINTR) continue;
    if (errno == EOPNOTSUPP || errno == ENOSYS) break;
    return olx_fail(OLX_ERROR_FILE, "%s: cannot reserve %llu bytes: %s", file->path, (unsigned long long)size_bytes,
                    strerror(errno));
  }
  return OLX_OK;
}

static void sync_directory(const char *path) {
  char directory[4096];
  snprintf(directory, sizeof directory, "%s", path);
  char *slash = strrchr(directory, '/');
  if (slash == directory) slash[1] = 0;
  else if (slash) *slash = 0;
  else snprintf(directory, sizeof directory, ".");
  const int descriptor = open(directory, O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return;
  (void)!fsync(descriptor);
  close(descriptor);
}

olx_result olx_output_commit(olx_output_file *file) {
  olx_result result = OLX_OK;
  if (fsync(file->descriptor) != 0) {
    result = olx_fail(OLX_ERROR_FILE, "%s: cannot sync: %s", file->path, strerror(errno));
  } else if (rename(file->temporary_path, file->path) != 0) {
    result = olx_fail(OLX_ERROR_FILE, "%s: cannot rename into place: %s", file->path, strerror(errno));
  } else {
    sync_directory(file->path);
    olx_release(file->temporary_path);
    file->temporary_path = NULL;
  }
  olx_output_discard(file);
  return result;
}

void olx_output_discard(olx_output_file *file) {
  if (file->path && file->descriptor >= 0) close(file->descriptor);
  if (file->temporary_path && file->descriptor >= 0) unlink(file->temporary_path);
  olx_release(file->temporary_path);
  olx_release(file->path);
  *file = (olx_output_file){.descriptor = -1};
}

olx_result olx_write_file(const char *path, const void *data, size_t size_bytes) {
  olx_output_file file;
  OLX_TRY(olx_output_open(path, &file));
  const olx_result result = olx_output_write(&file, data, size_bytes);
  if (result != OLX_OK) {
    olx_output_discard(&file);
    return result;
  }
  return olx_output_commit(&file);
}

olx_result olx_map_file(const char *path, olx_mapped_file *file) {
  *file = (olx_mapped_file){0};
  const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); // a pipe must not wait for its writer
  if (descriptor < 0) return olx_fail(OLX_ERROR_FILE, "%s: cannot open: %s", path, strerror(errno));
  struct stat status;
  olx_result result = OLX_OK;
  if (fstat(descriptor, &status) != 0) {
    result = olx_fail(OLX_ERROR_FILE, "%s: cannot read: %s", path, strerror(errno));
  } else if (!S_ISREG(status.st_mode)) {
    result = olx_fail(OLX_ERROR_FILE, "%s: not a regular file", path);
  } else if (status.st_size > 0) {
    void *data = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_SHARED, descriptor, 0);
    if (data == MAP_FAILED) {
      result = olx_fail(OLX_ERROR_FILE, "%s: cannot map: %s", path, strerror(errno));
    } else {
      *file = (olx_mapped_file){.data = data, .size_bytes = (size_t)status.st_size};
    }
  }
  close(descriptor);
  return result;
}

void olx_unmap_file(olx_mapped_file *file) {
  if (file->data) munmap((void *)(uintptr_t)file->data, file->size_bytes);
  *file = (olx_mapped_file){0};
}
