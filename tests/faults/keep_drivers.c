// Preloaded into a program whose leaks are looked for: keeps the drivers loaded, as pinned_drivers.h says.
#include "pinned_drivers.h"

__attribute__((constructor)) static void keep_drivers(void) { pin_drivers(); }
