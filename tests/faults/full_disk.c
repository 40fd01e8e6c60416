// Imitates a disk with faults when it is preloaded: after OCTALUX_DISK_BYTES bytes, writes to regular files fail, as on
// a full disk or with the error number OCTALUX_DISK_ERROR; with OCTALUX_DISK_FOLDER only to files whose path has these
// words. With OCTALUX_SHORT_WRITES every write takes only the first half of its bytes. Space cannot be reserved
// beforehand.
//
// OCTALUX_SYNCS counts the calls of fsync that succeed. Then, with OCTALUX_POWER_LOSS, the power goes: the process
// ends, files lose half of what was written since they were last synced, and renames since their folder was last synced
// are undone. Without it, each further fsync fails with an error of the device. With OCTALUX_NO_RENAMES renames fail.
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { MOST_FILES = 1024, LONGEST_PATH = 512 };

static atomic_llong written;
static atomic_int syncs;
static atomic_bool unsynced[MOST_FILES]; // by descriptor
static int closed[MOST_FILES];           // copies of descriptors that were closed before they were synced
static int closed_count;
// The last rename since a folder was synced: descriptors of the folder and the target that it replaced, or -1.
static int renamed_folder = -1, replaced = -1;
static char renamed_to[LONGEST_PATH];

static int is_file(int descriptor) {
  struct stat status;
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

// Returns whether a file is on the disk with faults. Files without a name have a path, too.
static bool is_on_disk(int descriptor) {
  const char *folder = getenv("OCTALUX_DISK_FOLDER");
  char link[64], path[LONGEST_PATH] = "";
  if (!folder) return true;
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  return readlink(link, path, sizeof path - 1) > 0 && strstr(path, folder);
}

static int fails(int descriptor, size_t size_bytes) {
  const char *limit = getenv("OCTALUX_DISK_BYTES"), *error = getenv("OCTALUX_DISK_ERROR");
  if (!limit || !is_file(descriptor) || !is_on_disk(descriptor)) return 0;
  if (atomic_fetch_add(&written, (long long)size_bytes) + (long long)size_bytes <= atoll(limit)) return 0;
  errno = error ? atoi(error) : ENOSPC;
  return 1;
}

static size_t taken(int descriptor, size_t size_bytes) {
  return getenv("OCTALUX_SHORT_WRITES") && is_file(descriptor) ? (size_bytes + 1) / 2 : size_bytes;
}

ssize_t write(int descriptor, const void *data, size_t size_bytes) {
  if (fails(descriptor, size_bytes)) return -1;
  if (descriptor < MOST_FILES) unsynced[descriptor] = true;
  return syscall(SYS_write, descriptor, data, taken(descriptor, size_bytes));
}

ssize_t pwrite(int descriptor, const void *data, size_t size_bytes, off_t offset) {
  if (fails(descriptor, size_bytes)) return -1;
  if (descriptor < MOST_FILES) unsynced[descriptor] = true;
  return syscall(SYS_pwrite64, descriptor, data, taken(descriptor, size_bytes), offset);
}

ssize_t pwrite64(int descriptor, const void *data, size_t size_bytes, off_t offset) {
  return pwrite(descriptor, data, size_bytes, offset);
}

int fallocate(int descriptor, int mode, off_t offset, off_t size_bytes) {
  (void)descriptor, (void)mode, (void)offset, (void)size_bytes;
  errno = EOPNOTSUPP;
  return -1;
}

int fallocate64(int descriptor, int mode, off_t offset, off_t size_bytes) {
  return fallocate(descriptor, mode, offset, size_bytes);
}

// ---- Syncing and renaming

static void lose_half(int descriptor) {
  struct stat status;
  if (is_file(descriptor) && fstat(descriptor, &status) == 0) (void)!ftruncate(descriptor, status.st_size / 2);
}

// Undoes the last rename: the folder has the replaced file again, or none.
static void undo_rename(void) {
  if (renamed_folder < 0) return;
  unlinkat(renamed_folder, renamed_to, 0);
  if (replaced < 0) return;
  const int copy = openat(renamed_folder, renamed_to, O_WRONLY | O_CREAT | O_EXCL, 0600);
  char bytes[4096];
  off_t at = 0;
  for (ssize_t got; copy >= 0 && (got = pread(replaced, bytes, sizeof bytes, at)) > 0; at += got) {
    (void)!syscall(SYS_write, copy, bytes, (size_t)got);
  }
}

static _Noreturn void lose_power(void) {
  for (int i = 0; i < MOST_FILES; i++) {
    if (unsynced[i]) lose_half(i);
  }
  for (int i = 0; i < closed_count; i++) lose_half(closed[i]);
  undo_rename();
  syscall(SYS_exit_group, 99);
  abort();
}

int fsync(int descriptor) {
  const char *limit = getenv("OCTALUX_SYNCS");
  if (limit && atomic_fetch_add(&syncs, 1) >= atoi(limit)) {
    if (getenv("OCTALUX_POWER_LOSS")) lose_power();
    if (is_file(descriptor)) {
      errno = EIO;
      return -1;
    }
  }
  if (descriptor < MOST_FILES) unsynced[descriptor] = false;
  if (!is_file(descriptor)) renamed_folder = -1;
  return (int)syscall(SYS_fsync, descriptor);
}

int close(int descriptor) {
  if (descriptor >= 0 && descriptor < MOST_FILES && unsynced[descriptor]) {
    unsynced[descriptor] = false;
    if (getenv("OCTALUX_POWER_LOSS") && is_file(descriptor) && closed_count < MOST_FILES) {
      closed[closed_count++] = fcntl(descriptor, F_DUPFD_CLOEXEC, MOST_FILES);
    }
  }
  return (int)syscall(SYS_close, descriptor);
}

int renameat(int from_folder, const char *from, int to_folder, const char *to) {
  if (getenv("OCTALUX_NO_RENAMES")) {
    errno = EIO;
    return -1;
  }
  if (getenv("OCTALUX_POWER_LOSS")) {
    replaced = openat(to_folder, to, O_RDONLY | O_CLOEXEC);
    renamed_folder = fcntl(to_folder, F_DUPFD_CLOEXEC, MOST_FILES);
    snprintf(renamed_to, sizeof renamed_to, "%s", to);
  }
  return (int)syscall(SYS_renameat, from_folder, from, to_folder, to);
}
