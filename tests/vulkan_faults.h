// Functions that take the place of the device's own in a context: of all calls that make something one fails, when a
// test wants it to, and pipelines are empty. Those that are never run do not need their shaders, which take long to
// compile.
#ifndef OLX_TESTS_VULKAN_FAULTS_H
#define OLX_TESTS_VULKAN_FAULTS_H

#include "gpu_device.h"
#include "vulkan/vulkan_functions.h"

typedef struct vulkan_faults {
  const gpu_device *device;
  int calls_left;        // the call that finds 0 here fails; none does while it is negative
  VkResult failure;      // what it gives
  uint32_t pipelines;    // made so far
  VkPipelineCache cache; // that the last of them went through
} vulkan_faults;

extern vulkan_faults faults;

// Empty pipelines alone; and all of it. No call fails until a test says which.
void faults_empty_pipelines(const gpu_device *device, olx_vulkan_functions *functions);
void faults_install(const gpu_device *device, olx_vulkan_functions *functions);

#endif
