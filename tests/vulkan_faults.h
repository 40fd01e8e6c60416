// Replacements for functions of the device in a context: one call that creates something fails when a test wants it to,
// and pipelines are empty. Pipelines that are never run do not need their shaders, which take long to compile.
#ifndef OLX_TESTS_VULKAN_FAULTS_H
#define OLX_TESTS_VULKAN_FAULTS_H

#include "gpu_device.h"
#include "vulkan/vulkan_functions.h"

typedef struct vulkan_faults {
  const gpu_device *device;
  int calls_left;        // calls until the one that fails, which finds 0 here; negative: no call fails
  VkResult failure;      // the result of the failing call
  uint32_t pipelines;    // number of pipelines created so far
  VkPipelineCache cache; // the cache that the last pipeline was created with
} vulkan_faults;

extern vulkan_faults faults;

// Install empty pipelines alone, or all replacements. No call fails until a test sets `calls_left`.
void faults_empty_pipelines(const gpu_device *device, olx_vulkan_functions *functions);
void faults_install(const gpu_device *device, olx_vulkan_functions *functions);

#endif
