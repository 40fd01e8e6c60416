// Traces a ray against what one probe sees (McGuire et al. 2017, section 4.1, singleProbeTrace; docs/maths.md
// "Marching").
#ifndef OLX_TRACE_PROBE_TRACE_H
#define OLX_TRACE_PROBE_TRACE_H

#include "trace/probe_ray.h"

olx_probe_answer olx_trace_probe(const olx_field *field, uint32_t probe, const olx_probe_ray *ray, olx_tracer tracer);

// Marches many rays at once, each through the map of its job's probe; answers[i] belongs to jobs[i].
void olx_trace_probes(const olx_field *field, const olx_probe_job *jobs, uint32_t count, olx_tracer tracer,
                      olx_probe_answer *answers);

#endif
