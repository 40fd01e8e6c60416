// Removes noise from the direct light of texels: those of one plane share their mean where they differ by no more than
// the samples within each of them leave uncertain.
#ifndef OLX_BAKE_DIRECT_MERGE_H
#define OLX_BAKE_DIRECT_MERGE_H

#include "bake/capture/capture.h"

// The direct irradiance of a texel, from the samples that lie on its surface.
typedef struct olx_direct_estimate {
  olx_vec3 mean;  // W/m^2
  float squares;  // sum of the squared deviations of the samples' luminance from that of the mean
  uint32_t count; // of samples; 0: the texel sees no surface
} olx_direct_estimate;

// Merges the estimates of the probe that was captured last, one for each texel: squares of 4 x 4 texels, then of four
// such squares, up to 32 x 32 and a sixteenth of the map's side. The mean over all samples does not change.
olx_result olx_direct_merge(const olx_capture *capture, olx_direct_estimate *estimates);

#endif
