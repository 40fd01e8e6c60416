// octalux view: hands over to octalux-view, the program beside this one, so that the command line links neither a
// window system nor C++.
#include "commands.h"
#include "options.h"
#include "stop.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

int command_view(int argc, char **argv) {
  (void)argc;
  static const char name[] = "octalux-view";
  char path[PATH_MAX + sizeof name];
  const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX);
  if (length < 0) return failure("view", "cannot tell where this program lies: %s", strerror(errno));
  path[length] = 0;
  char *slash = strrchr(path, '/');
  memcpy(slash ? slash + 1 : path, name, sizeof name);
  argv[0] = path;
  stop_hand_over();
  execv(path, argv);
  if (errno != ENOENT) return failure("view", "%s: %s", path, strerror(errno));
  return failure("view", "%s is not there: this build has no viewer (it needs GLFW, Dear ImGui and Vulkan)", path);
}
