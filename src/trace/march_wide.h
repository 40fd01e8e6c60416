// Hi-Z marching of eight rays at once. Answers equal those of single rays to the last bit and step.
#ifndef OLX_TRACE_MARCH_WIDE_H
#define OLX_TRACE_MARCH_WIDE_H

#include "core/wide.h"
#include "trace/probe_ray.h"

#if OLX_WIDE

// Returns whether this machine and this field's maps allow marching eight rays at once.
bool olx_march_wide_available(const olx_field *field);

void olx_march_wide(const olx_field *field, const olx_probe_job *jobs, uint32_t count, olx_probe_answer *answers);

#endif

#endif
