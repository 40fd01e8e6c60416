// Vulkan's loader unloads drivers and layers when an instance goes, and a leak report can then no longer name them:
// tests keep them loaded, and leaks.supp knows their names. Our own handles are counted by the validation layers.
#ifndef OLX_TESTS_PINNED_DRIVERS_H
#define OLX_TESTS_PINNED_DRIVERS_H

#include <dlfcn.h>

static inline void pin_drivers(void) {
  static const char *const names[] = {"libvulkan.so.1", "libvulkan_lvp.so", "libVkLayer_khronos_validation.so"};
  for (int i = 0; i < 3; i++) {
    void *library = dlopen(names[i], RTLD_LAZY | RTLD_LOCAL | RTLD_NODELETE);
    if (library) dlclose(library);
  }
}

#endif
