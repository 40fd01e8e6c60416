// Imitates, when it is preloaded, a file system without unnamed files (O_TMPFILE), so that a program has to give its
// temporary files names.
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <sys/syscall.h>
#include <unistd.h>

int openat(int folder, const char *path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if ((flags & O_TMPFILE) != O_TMPFILE) return (int)syscall(SYS_openat, folder, path, flags, mode);
  errno = EOPNOTSUPP;
  return -1;
}
