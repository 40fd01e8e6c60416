// What all steps of a bake work with.
#ifndef OLX_BAKE_BAKE_CONTEXT_H
#define OLX_BAKE_BAKE_CONTEXT_H

#include "bake/probe_sets.h"
#include "core/parallel.h"

#include <octalux/bake.h>

typedef struct olx_bake_context {
  const olx_scene *scene;
  const olx_bake_settings *settings; // checked
  olx_probe_sets probes;
  float distance_scale; // metres, by which files hold distances: the scene's diagonal
  olx_task task;        // its progress
} olx_bake_context;

// Runs a loop of the bake on its threads; each job counts as `units` of progress.
static inline olx_result olx_bake_for(olx_bake_context *context, uint32_t count, olx_job job, void *user,
                                      uint64_t units) {
  return olx_parallel_for(count, context->settings->threads, job, user, &context->task, units);
}

#endif
