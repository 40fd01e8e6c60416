// Imitates a full disk when it is preloaded: after OCTALUX_DISK_BYTES bytes, writes to regular files fail. Space cannot
// be reserved beforehand.
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static atomic_llong written;

static int is_full(int descriptor, size_t size_bytes) {
  struct stat status;
  const char *limit = getenv("OCTALUX_DISK_BYTES");
  if (!limit || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  if (atomic_fetch_add(&written, (long long)size_bytes) + (long long)size_bytes <= atoll(limit)) return 0;
  errno = ENOSPC;
  return 1;
}

ssize_t write(int descriptor, const void *data, size_t size_bytes) {
  if (is_full(descriptor, size_bytes)) return -1;
  return syscall(SYS_write, descriptor, data, size_bytes);
}

ssize_t pwrite(int descriptor, const void *data, size_t size_bytes, off_t offset) {
  if (is_full(descriptor, size_bytes)) return -1;
  return syscall(SYS_pwrite64, descriptor, data, size_bytes, offset);
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
