// Surfaces that rays of the irradiance fit's points meet and no irradiance probe sees: their ends, merged until they fit the
// places that a field has for them.
#ifndef OLX_BAKE_HIDDEN_SURFACES_H
#define OLX_BAKE_HIDDEN_SURFACES_H

#include "field/relight_data.h"

// Where a ray ended.
typedef struct olx_ray_end {
  olx_vec3 position, normal, albedo; // a little off the surface, which faces the ray
} olx_ray_end;

// The ends of one probe's rays.
typedef struct olx_hidden_input {
  const olx_ray_end *ends; // `count` of them; only those at which rays[i] is OLX_FIT_RAY_UNKNOWN are read
  uint32_t *rays, count;
  olx_vec3 probe;     // its position
  float angle;        // what a surface of the probe's map takes of its view, in radians along a side
  float least_length; // of what is merged, metres
  uint32_t first;     // number of the first hidden surface
  uint32_t most;      // places
} olx_hidden_input;

// Merges ends in their order into at most `most` surfaces and gives their numbers to the rays. Ends in one plane that lie within
// the size of a surface of the map from the first one there are one; the size grows until there are few enough. What finds no
// place even then stays OLX_FIT_RAY_UNKNOWN. All of surfaces[most] is written, empty places as such. False: out of memory.
bool olx_hidden_merge(const olx_hidden_input *input, olx_hidden_surface *surfaces);

#endif
