// Keeps Vulkan drivers loaded, as pinned_drivers.h says, when it is preloaded into a program whose leaks are looked
// for.
#include "pinned_drivers.h"

__attribute__((constructor)) static void keep_drivers(void) { pin_drivers(); }
