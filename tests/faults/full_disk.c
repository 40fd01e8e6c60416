// Imitates a disk with faults when it is preloaded: after OCTALUX_DISK_BYTES bytes, writes to regular files fail, as on
// a full disk or with the error number OCTALUX_DISK_ERROR. With OCTALUX_SHORT_WRITES every write takes only the first
// half of its bytes. Space cannot be reserved beforehand.
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static atomic_llong written;

static int is_file(int descriptor) {
  struct stat status;
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

static int fails(int descriptor, size_t size_bytes) {
  const char *limit = getenv("OCTALUX_DISK_BYTES"), *error = getenv("OCTALUX_DISK_ERROR");
  if (!limit || !is_file(descriptor)) return 0;
  if (atomic_fetch_add(&written, (long long)size_bytes) + (long long)size_bytes <= atoll(limit)) return 0;
  errno = error ? atoi(error) : ENOSPC;
  return 1;
}

static size_t taken(int descriptor, size_t size_bytes) {
  return getenv("OCTALUX_SHORT_WRITES") && is_file(descriptor) ? (size_bytes + 1) / 2 : size_bytes;
}

ssize_t write(int descriptor, const void *data, size_t size_bytes) {
  if (fails(descriptor, size_bytes)) return -1;
  return syscall(SYS_write, descriptor, data, taken(descriptor, size_bytes));
}

ssize_t pwrite(int descriptor, const void *data, size_t size_bytes, off_t offset) {
  if (fails(descriptor, size_bytes)) return -1;
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
