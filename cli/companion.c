// Starts another program of the project, so that this one need not link the other's libraries.
#include "companion.h"

#include "options.h"
#include "stop.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { LONGEST_NAME = 64 };

int start_companion(const char *command, const char *program, const char *missing, char **argv) {
  char path[PATH_MAX + LONGEST_NAME];
  const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX);
  if (length < 0) return failure(command, "cannot tell where this program lies: %s", strerror(errno));
  path[length] = 0;
  char *slash = strrchr(path, '/');
  snprintf(slash ? slash + 1 : path, LONGEST_NAME, "%s", program);
  argv[0] = path;
  stop_hand_over();
  execv(path, argv);
  if (errno != ENOENT) return failure(command, "%s: %s", path, strerror(errno));
  return failure(command, "%s is not there: %s", path, missing);
}
