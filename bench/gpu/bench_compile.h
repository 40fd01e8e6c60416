// octalux-bench-gpu --compile: statistics of a device's compiler for each of Octalux's pipelines.
#ifndef OCTALUX_BENCH_COMPILE_H
#define OCTALUX_BENCH_COMPILE_H

#include "gpu_device.h"

// Makes the pipelines for a field, those of relighting and of the baseline as far as the field holds what they need,
// and prints what VK_KHR_pipeline_executable_properties reports of each (where the device has it), and the processor
// time that making it took. Nothing is run, so the device, which was opened with `compile_only`, need not exist.
// With `quick`, pipelines of other tracers, selectors and light at hits, and of the baseline, are left out.
// Returns false with the reason in device->problem.
bool bench_compile(gpu_device *device, const char *field_path, bool quick, bool json);

#endif
