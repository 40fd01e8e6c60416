// A surfel of the visibility atlas, and a rating of how well a probe sees it.
#ifndef OLX_PLACE_SURFEL_SIGHT_H
#define OLX_PLACE_SURFEL_SIGHT_H

#include "scene/scene_data.h"

// The conditions under which a probe sees a surfel well.
typedef struct olx_sight {
  float min_cosine;    // cosine between the surfel's normal and the direction to the probe
  float max_footprint; // metres: longest side of a texel's footprint
  float texel_radians; // mean angle that a texel of the probe's map spans
} olx_sight;

// Creates a sight. max_footprint: a share of `diagonal`, both in metres.
olx_sight olx_sight_create(float diagonal, float min_cosine, float max_footprint, uint32_t resolution);

typedef enum olx_surfel_fate {
  OLX_SURFEL_FIT,        // seen well from a position that allows a probe
  OLX_SURFEL_GRAZING,    // seen from such positions, but never well
  OLX_SURFEL_RESTRICTED, // seen from the space that matters, but from no position that allows a probe
  OLX_SURFEL_UNSEEN,
  OLX_SURFEL_UNASKED // not determined yet
} olx_surfel_fate;

// One side of a surface at a point.
typedef struct olx_surfel {
  olx_vec3 position; // slightly off the surface, on the side of the normal
  olx_vec3 normal;   // unit, geometric
  olx_vec3 from;     // OLX_SPREAD_RAYS: the origin of the ray that found it
  uint32_t triangle;
  olx_surfel_fate fate;
} olx_surfel;

// The least quality at which a surfel counts as seen.
#define OLX_QUALITY_LEAST 208
// Returns the quality at which a surfel is seen from `place` without occlusion: 0 when it faces away, is seen at a
// grazing angle or with too large a footprint; otherwise from OLX_QUALITY_LEAST to 255, higher for steep angles and
// small distances.
uint8_t olx_sight_quality(const olx_sight *sight, olx_vec3 place, const olx_surfel *surfel);

#endif
