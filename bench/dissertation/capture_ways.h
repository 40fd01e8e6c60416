// The time of capturing light field probes by rays and by cube maps.
#ifndef OCTALUX_BENCH_CAPTURE_WAYS_H
#define OCTALUX_BENCH_CAPTURE_WAYS_H

#include "experiment.h"

// Bakes the field again with probes that a Vulkan device rasterises, and adds a table with the times of both; without a
// device the table has those of `cast` alone.
olx_result compare_capture(bench *b, const olx_scene *scene, const bench_probes *probes, const bench_bake *bake,
                           const bench_field *cast);

#endif
