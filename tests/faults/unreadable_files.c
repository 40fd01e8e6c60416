// Imitates, when it is preloaded, files that cannot be opened for reading for now: OCTALUX_UNREADABLE is the name of
// one within its folder.
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

int openat(int folder, const char *path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  const char *name = getenv("OCTALUX_UNREADABLE");
  if (!name || strcmp(path, name) != 0) return (int)syscall(SYS_openat, folder, path, flags, mode);
  errno = EMFILE;
  return -1;
}
