// Keeps Vulkan drivers loaded: the loader unloads drivers and layers with the instance, and a leak report could then no
// longer name them; leaks.supp lists their names. The validation layers count our own handles.
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
