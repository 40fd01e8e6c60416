// Keeps Vulkan drivers loaded, as pinned_drivers.h describes, when it is preloaded into a program that is checked for
// leaks.
#include "pinned_drivers.h"

__attribute__((constructor)) static void keep_drivers(void) { pin_drivers(); }
