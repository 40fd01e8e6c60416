// Makes a temporary place for a work folder, and replaces the calls of the file system that work folders use, so that
// tests see and fail them.
#include "faults/work_place.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cmocka.h>

work_disk_calls work_disk;

static void note(char call) {
  if (work_disk.count + 1 < WORK_DISK_MOST_CALLS) work_disk.calls[work_disk.count++] = call;
}

ssize_t write(int descriptor, const void *data, size_t size_bytes) {
  if (descriptor > 2) note('w');
  if (descriptor > 2 && work_disk.write_error) {
    errno = work_disk.write_error;
    return -1;
  }
  return syscall(SYS_write, descriptor, data, size_bytes);
}

int openat(int folder, const char *name, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  const bool spoilt = work_disk.spoilt && strcmp(name, work_disk.spoilt) == 0;
  if (spoilt && work_disk.open_error) {
    errno = work_disk.open_error;
    return -1;
  }
  const int descriptor = (int)syscall(SYS_openat, folder, name, flags, mode);
  if (spoilt) work_disk.descriptor = descriptor;
  else if (descriptor == work_disk.descriptor) work_disk.descriptor = 0;
  return descriptor;
}

ssize_t read(int descriptor, void *data, size_t size_bytes) {
  if (work_disk.read_error && work_disk.descriptor > 0 && descriptor == work_disk.descriptor) {
    errno = work_disk.read_error;
    return -1;
  }
  return syscall(SYS_read, descriptor, data, size_bytes);
}

int fsync(int descriptor) {
  struct stat status;
  note(fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode) ? 'f' : 's');
  return (int)syscall(SYS_fsync, descriptor);
}

int renameat(int from_folder, const char *from, int to_folder, const char *to) {
  note('r');
  return (int)syscall(SYS_renameat2, from_folder, from, to_folder, to, 0);
}

int unlinkat(int folder, const char *name, int flags) {
  note(strcmp(name, "manifest-0-0.unit") == 0 ? 'm' : 'u');
  if (work_disk.most_unlinks && work_disk.unlinks == work_disk.most_unlinks) return -1;
  work_disk.unlinks++;
  return (int)syscall(SYS_unlinkat, folder, name, flags);
}

int work_place_create(void **state) {
  work_place *p = calloc(1, sizeof *p);
  const char *base = getenv("TMPDIR");
  snprintf(p->parent, sizeof p->parent, "%s/octalux-work-XXXXXX", base && *base ? base : "/tmp");
  if (!mkdtemp(p->parent)) return -1;
  snprintf(p->folder, sizeof p->folder, "%s/work", p->parent);
  memset(&work_disk, 0, sizeof work_disk);
  *state = p;
  return 0;
}

int work_place_remove(void **state) {
  work_place *p = *state;
  char command[300];
  snprintf(command, sizeof command, "rm -rf '%s'", p->parent);
  const int result = system(command);
  free(p);
  return result;
}

const char *work_place_file(work_place *p, const char *name) {
  snprintf(p->file, sizeof p->file, "%s/%s", p->folder, name);
  return p->file;
}

uint32_t count_files(const char *folder) {
  DIR *entries = opendir(folder);
  uint32_t count = 0;
  assert_non_null(entries);
  while (readdir(entries)) count++;
  closedir(entries);
  return count - 2; // without . and ..
}

bool file_exists(const char *path) {
  struct stat status;
  return lstat(path, &status) == 0;
}

olx_manifest work_place_manifest(const char *scene, const char *instructions) {
  olx_manifest manifest = {""};
  olx_manifest_add(&manifest, "scene", scene);
  olx_manifest_add(&manifest, "instructions", instructions);
  olx_manifest_add(&manifest, "stages", "manifest cast probe awaited");
  return manifest;
}

olx_result work_place_open_as(const work_place *p, const olx_manifest *manifest, olx_work_lock lock, bool fresh,
                              olx_work_folder **folder) {
  const olx_work_folder_settings settings = {.manifest = manifest, .lock = lock, .fresh = fresh};
  return olx_work_folder_open(p->folder, &settings, folder);
}

olx_work_folder *work_place_open(const work_place *p) {
  const olx_manifest manifest = work_place_manifest("a", "avx2");
  olx_work_folder *folder;
  assert_int_equal(work_place_open_as(p, &manifest, OLX_WORK_ALONE, false, &folder), OLX_OK);
  return folder;
}

void put_unit_text(olx_work_folder *folder, const olx_unit_name *name, const char *text) {
  assert_int_equal(olx_work_folder_put(folder, name, text, strlen(text)), OLX_OK);
}

void holds_unit_text(const olx_work_folder *folder, const olx_unit_name *name, const char *text) {
  void *data;
  size_t size_bytes;
  assert_int_equal(olx_work_folder_get(folder, name, &data, &size_bytes), OLX_OK);
  assert_int_equal(size_bytes, strlen(text));
  assert_memory_equal(data, text, size_bytes);
  olx_release(data);
}

void flip_byte(const char *path, long at) {
  FILE *file = fopen(path, "r+");
  assert_non_null(file);
  fseek(file, at, SEEK_SET);
  const int byte = fgetc(file);
  fseek(file, at, SEEK_SET);
  fputc(byte ^ 1, file);
  fclose(file);
}
