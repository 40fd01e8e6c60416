// Settings for solving the light of a scene, and the statistics of a solution (scene_light.h).
#ifndef OLX_LIGHT_LIGHT_SETTINGS_H
#define OLX_LIGHT_LIGHT_SETTINGS_H

#include "core/parallel.h"
#include "light/links/light_bounces.h"
#include "light/surfels/surfel_lookup.h"
#include "scene/scene_parts.h"
#include "work/unit_store.h"

typedef struct olx_scene_light olx_scene_light;

typedef struct olx_scene_light_settings {
  uint32_t bounces;  // surfaces between emitter and lit surface; OLX_BOUNCES_INFINITE: until less than 2^-10 is missing
  float noise;       // upper bound on the standard error of indirect irradiance, as a share of it; default 0.02
  float spacing;     // spacing of surfels, as a share of the geometric mean distance to what they see; default 0.2
  uint32_t map_size; // texels along the side of the probes' maps: surfels are no denser than these texels, or than
                     // those of 64^2 maps
  uint64_t most_links;      // most links in memory; beyond it, rays leave none (final_gather.h); default 2^27
  uint64_t most_final_rays; // most rays of a round of final rays or of records, which leave no links; default 2^28
  uint32_t seed;            // seed of random numbers
  uint32_t threads;         // 0: one per processor
  olx_task *task;           // may be NULL
  bool keep_rays;           // store what rays depend on, and reuse those of another scene that hold; needs a store
  olx_scene_inputs inputs;  // hashes of what rays depend on, with keep_rays
  olx_unit_store *store;    // store of the bake that the light belongs to; NULL: nothing is stored
  const char *link_folder;  // where links are kept in files, to save memory; NULL: in memory
} olx_scene_light_settings;

// Statistics of a solution.
typedef struct olx_scene_light_report {
  uint32_t surfels, hidden_surfels; // all surfels, and those on surfaces that rays hit and no probe sees
  uint32_t records;                 // places between which light is interpolated: visible surfels, and those of parts
                                    // of their cells
  uint32_t bounces;                 // number of times that light was propagated over the links
  uint64_t reused_rays;             // those of `rays` that a work folder had from before an edit of the scene
  uint64_t rays, links, bytes;      // all rays; links; memory of links and surfels
  double noise;       // standard error of interpolated irradiance over irradiance, RMS over visible surfels
  double last_bounce; // share of visible surfels' indirect light that has `bounces` surfaces on its way
  double seconds;     // elapsed time
} olx_scene_light_report;

#endif
