// octalux view: starts octalux-view, the program beside this one, so that the command line links neither a window
// system nor C++.
#include "commands.h"
#include "companion.h"

int command_view(int argc, char **argv) {
  (void)argc;
  return start_companion("view", "octalux-view", "this build has no viewer (it needs GLFW, Dear ImGui and Vulkan)",
                         argv);
}
