// Creates temporary files: unnamed where the file system supports them (O_TMPFILE), else named and locked, so that
// files still being written can be distinguished from files that a dead program left.
#include "core/temporary.h"

#include "core/sampling.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define PREFIX ".octalux-"
#define SUFFIX ".tmp"

enum {
  TAG_DIGITS = 8,
  MACHINE_DIGITS = 4,
  NAME_LENGTH = sizeof PREFIX - 1 + TAG_DIGITS + sizeof SUFFIX - 1,
  NAME_ATTEMPTS = 100
};

// Returns the digits of this machine, with which its names begin.
static uint32_t machine_tag(void) {
  char host[256] = "";
  uint32_t hash = 0;
  gethostname(host, sizeof host - 1);
  for (const char *c = host; *c; c++) hash = olx_hash2(hash, (uint8_t)*c);
  return hash >> 16;
}

void olx_temporary_name(uint32_t attempt, char name[32]) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  snprintf(name, 32, PREFIX "%04x%04x" SUFFIX, machine_tag(),
           olx_hash3((uint32_t)getpid(), (uint32_t)now.tv_nsec, attempt) >> 16);
}

// Returns whether this machine may have made a temporary file.
static bool may_be_ours(const char *name) {
  char tag[MACHINE_DIGITS + 1];
  snprintf(tag, sizeof tag, "%04x", machine_tag());
  return strncmp(name + sizeof PREFIX - 1, tag, MACHINE_DIGITS) == 0;
}

bool olx_is_temporary_name(const char *name) {
  const char *tag = name + sizeof PREFIX - 1;
  return strlen(name) == NAME_LENGTH && strncmp(name, PREFIX, sizeof PREFIX - 1) == 0 &&
         strspn(tag, "0123456789abcdef") == TAG_DIGITS && strcmp(tag + TAG_DIGITS, SUFFIX) == 0;
}

// Removes a temporary file unless its program holds the lock.
static void reclaim_file(int folder, const char *name) {
  const int descriptor = openat(folder, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  struct stat opened, named;
  if (descriptor < 0) return;
  if (fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode) && flock(descriptor, LOCK_EX | LOCK_NB) == 0 &&
      fstatat(folder, name, &named, AT_SYMLINK_NOFOLLOW) == 0 && named.st_dev == opened.st_dev &&
      named.st_ino == opened.st_ino) {
    unlinkat(folder, name, 0);
  }
  close(descriptor);
}

void olx_temporary_reclaim(int folder, bool of_all_machines) {
  const int descriptor = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR *entries = descriptor < 0 ? NULL : fdopendir(descriptor);
  if (!entries) {
    if (descriptor >= 0) close(descriptor);
    return;
  }
  for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
    const char *name = entry->d_name;
    if (olx_is_temporary_name(name) && (of_all_machines || may_be_ours(name))) reclaim_file(folder, name);
  }
  closedir(entries);
}

static void own_path(int descriptor, char path[64]) { snprintf(path, 64, "/proc/self/fd/%d", descriptor); }

// Creates an unnamed file that can be named later; -1 where that is not supported.
static int create_unnamed(int folder, mode_t mode) {
  const int descriptor = openat(folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
  char path[64];
  if (descriptor < 0) return -1;
  own_path(descriptor, path);
  if (access(path, F_OK) == 0) {
    flock(descriptor, LOCK_EX | LOCK_NB); // protects the file for the moment in which it has a temporary name
    return descriptor;
  }
  close(descriptor);
  return -1;
}

// Locks a file that was just created. Returns false when another program has mistaken it for a dead program's file and
// removes it.
static bool lock_named(int descriptor) {
  struct stat status;
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  return fstat(descriptor, &status) == 0 && status.st_nlink > 0;
}

static int create_named(int folder, mode_t mode, char name[32]) {
  for (uint32_t attempt = 0; attempt < NAME_ATTEMPTS; attempt++) {
    olx_temporary_name(attempt, name);
    const int descriptor = openat(folder, name, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (descriptor < 0 && errno != EEXIST) break;
    if (descriptor >= 0 && lock_named(descriptor)) return descriptor;
    if (descriptor >= 0) close(descriptor);
  }
  name[0] = 0;
  return -1;
}

// Creates the file in file->folder, and closes the folder on failure.
static int create_in_folder(mode_t mode, olx_temporary *file) {
  file->descriptor = create_unnamed(file->folder, mode);
  if (file->descriptor < 0) file->descriptor = create_named(file->folder, mode, file->name);
  if (file->descriptor < 0) {
    const int error = errno;
    close(file->folder);
    return error;
  }
  file->open = true;
  return 0;
}

int olx_temporary_create(const char *folder, uint32_t mode, olx_temporary *file) {
  *file = (olx_temporary){.open = false};
  // A folder that may be written but not read can be neither searched for leftover files nor synced.
  file->folder = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file->folder < 0 && errno == EACCES) file->folder = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
  if (file->folder < 0) return errno;
  olx_temporary_reclaim(file->folder, false);
  return create_in_folder(mode, file);
}

int olx_temporary_create_at(int folder, uint32_t mode, olx_temporary *file) {
  *file = (olx_temporary){.folder = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  return file->folder < 0 ? errno : create_in_folder(mode, file);
}

// Gives an unnamed file a temporary name.
static int link_unnamed(olx_temporary *file) {
  char path[64];
  own_path(file->descriptor, path);
  for (uint32_t attempt = 0; attempt < NAME_ATTEMPTS; attempt++) {
    olx_temporary_name(attempt, file->name);
    if (linkat(AT_FDCWD, path, file->folder, file->name, AT_SYMLINK_FOLLOW) == 0) return 0;
    if (errno != EEXIST) break;
  }
  file->name[0] = 0;
  return -1;
}

static void close_both(olx_temporary *file) {
  close(file->descriptor);
  close(file->folder);
  file->open = false;
}

// Orders the steps for a power failure: the content is durable before the file has a name, the temporary name before
// the final one, and the final one before success is reported. A folder that cannot be synced is left to its file
// system.
int olx_temporary_put(olx_temporary *file, const char *name) {
  int error = 0;
  if (fsync(file->descriptor) != 0 || (!file->name[0] && link_unnamed(file) != 0)) {
    error = errno;
  } else {
    fsync(file->folder);
    if (renameat(file->folder, file->name, file->folder, name) != 0) error = errno;
  }
  if (error) {
    olx_temporary_discard(file);
    return error;
  }
  fsync(file->folder);
  close_both(file);
  return 0;
}

void olx_temporary_discard(olx_temporary *file) {
  if (!file->open) return;
  if (file->name[0]) unlinkat(file->folder, file->name, 0);
  close_both(file);
}
