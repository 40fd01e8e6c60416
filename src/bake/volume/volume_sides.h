// The sides of a cell of the irradiance volume: the parts of its space that surfaces keep apart, and for each part the
// places whose light represents the cell's corners there.
#ifndef OLX_BAKE_VOLUME_SIDES_H
#define OLX_BAKE_VOLUME_SIDES_H

#include "bake/volume/volume_space.h"
#include "field/volume_data.h"

enum { OLX_VOLUME_MOST_SIDES = 8 };

typedef struct olx_volume_side {
  olx_vec3 anchor;                        // a place amid it
  uint32_t corners;                       // bit n: corner n itself is in its space, clear of surfaces
  olx_vec3 stand_ins[OLX_VOLUME_CORNERS]; // places for the other corners: as near to them as surfaces let one come
} olx_volume_side;

typedef struct olx_volume_sides {
  uint32_t root; // an entry whose numbers are those of `splits` and `sides`; 0: no free space
  uint32_t split_count, side_count;
  olx_volume_split splits[OLX_VOLUME_MOST_SIDES * OLX_VOLUME_MOST_SPLITS]; // each before those that it names
  olx_volume_side sides[OLX_VOLUME_MOST_SIDES];
} olx_volume_sides;

olx_vec3 olx_volume_corner(olx_vec3 low, float side, uint32_t corner);

// Finds the sides of the cube with that low corner; places will be looked up `lift` metres in front of their surface.
// The result depends on the arguments alone.
void olx_volume_sides_find(const olx_volume_space *space, olx_vec3 low, float side, float lift,
                           olx_volume_sides *sides);

#endif
