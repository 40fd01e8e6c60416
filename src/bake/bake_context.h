// The context that all stages of a bake share: scene, settings, threads and progress.
#ifndef OLX_BAKE_BAKE_CONTEXT_H
#define OLX_BAKE_BAKE_CONTEXT_H

#include "bake/probe_sets.h"
#include "core/parallel.h"

#include <octalux/bake.h>

typedef struct olx_bake_context {
  const olx_scene *scene;
  const olx_bake_settings *settings; // validated
  olx_probe_sets probes;
  float distance_scale; // metres, the unit of stored distances: the scene's diagonal
  olx_task task;        // progress of the bake
} olx_bake_context;

// Runs a parallel loop of the bake on its threads; each job adds `units` to the progress.
static inline olx_result olx_bake_for(olx_bake_context *context, uint32_t count, olx_job job, void *user,
                                      uint64_t units) {
  return olx_parallel_for(count, context->settings->threads, job, user, &context->task, units);
}

#endif
