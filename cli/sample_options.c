// Holds the options for sampling a field that `render`, `audit` and `view` share.
#include "sample_options.h"

#include <octalux/sample.h>

// The words are in the order of the library's enumerations.
const option sample_options[] = {
    {"--tracer", OPTION_CHOICE, offsetof(olx_sample_settings, tracer), "texel|two-level|hiz",
     "how rays march through probes; default hiz"},
    {"--select", OPTION_CHOICE, offsetof(olx_sample_settings, select), "cage|voronoi|octree|bricks|exhaustive|best",
     "selector of probes; default best: the best of those that the field stores"},
    {"--visibility", OPTION_CHOICE, offsetof(olx_sample_settings, visibility), "none|chebyshev",
     "whether irradiance probes that do not see a point are left out; default chebyshev"},
    {"--hits", OPTION_CHOICE, offsetof(olx_sample_settings, hits), "shaded|stored",
     "light where rays end: of the surface there, or as a probe saw it; default shaded"},
    {"--keep-buried", OPTION_FLAG, offsetof(olx_sample_settings, keep_buried), NULL,
     "also query probes inside geometry"},
    {0}};
