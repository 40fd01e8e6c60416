// The options for sampling a field that `render` and `audit` share.
#ifndef OCTALUX_CLI_SAMPLE_OPTIONS_H
#define OCTALUX_CLI_SAMPLE_OPTIONS_H

#include "options.h"

#include <octalux/sample.h>

// The words of the options are in the order of the library's enumerations.
typedef struct sample_options {
  uint32_t tracer, select, visibility, hits;
  bool keep_buried;
} sample_options;

#define SAMPLE_OPTIONS_DEFAULT                                                                                         \
  { .tracer = OLX_TRACER_HIZ, .select = OLX_SELECT_BEST, .visibility = OLX_VISIBILITY_CHEBYSHEV, .hits = OLX_HITS_SHADED }

#define SAMPLE_OPTION_ROWS(s)                                                                                           \
  {                                                                                                                     \
      "--tracer", OPTION_CHOICE, &(s).tracer, "texel|two-level|hiz", "how rays march through probes; default hiz", 0,   \
      0},                                                                                                               \
      {"--select",                                                                                                      \
       OPTION_CHOICE,                                                                                                   \
       &(s).select,                                                                                                     \
       "cage|voronoi|octree|bricks|exhaustive|best",                                                                    \
       "which probes answer; default best: of those baked in",                                                          \
       0,                                                                                                               \
       0},                                                                                                              \
      {"--visibility",                                                                                                  \
       OPTION_CHOICE,                                                                                                   \
       &(s).visibility,                                                                                                 \
       "none|chebyshev",                                                                                                \
       "whether irradiance probes that do not see a point are left out; default chebyshev",                             \
       0,                                                                                                               \
       0},                                                                                                              \
      {"--hits",                                                                                                        \
       OPTION_CHOICE,                                                                                                   \
       &(s).hits,                                                                                                       \
       "shaded|stored",                                                                                                 \
       "light where rays end: of the surface there, or as a probe saw it; default shaded",            \
       0,                                                                                                               \
       0},                                                                                                              \
  {                                                                                                                     \
    "--keep-buried", OPTION_FLAG, &(s).keep_buried, NULL, "also ask probes inside geometry", 0, 0                       \
  }

static inline olx_sample_settings resolve_sample_options(const sample_options *given) {
  olx_sample_settings settings = olx_sample_settings_default();
  settings.tracer = (olx_tracer)given->tracer;
  settings.select = (olx_select)given->select;
  settings.visibility = (olx_visibility)given->visibility;
  settings.hits = (olx_hits)given->hits;
  settings.keep_buried = given->keep_buried;
  return settings;
}

#endif
