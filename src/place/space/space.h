// The space that matters: where the viewer can be, and where in it probes are allowed.
#ifndef OLX_PLACE_SPACE_H
#define OLX_PLACE_SPACE_H

#include "place/space/space_data.h"

// Opens a tile of a world whose space is found, with `overlap` voxels around it. The world must outlive it. A tile that
// the viewer cannot reach has no starts and no places, and its distances are not filled.
olx_result olx_space_open(olx_world *world, uint32_t tile, uint32_t overlap, uint32_t threads, olx_space *space);
void olx_space_free(olx_space *space);

// Draws a position evenly from the space that the viewer can reach: start `nth` of start_count, random numbers from
// `seed`. Returns false when the position drawn is outside that space: outside the box, or behind the surface in a
// fringe voxel.
bool olx_space_draw(const olx_space *space, size_t nth, uint32_t seed, olx_vec3 *place);

// Returns whether a probe is allowed at a position: in space that matters, outside forbidden boxes, at least
// min_distance and half a voxel from surfaces. Whether it is buried (inside geometry) is a separate query, because that
// takes many rays.
bool olx_space_allows(const olx_space *space, olx_vec3 p);
bool olx_space_is_inside_geometry(const olx_space *space, olx_vec3 p);

// Returns whether the rules of the description (playable and forbidden boxes, distance to surfaces) allow a probe at a
// position, wherever the viewer can be.
bool olx_rules_allow(const olx_scene *scene, olx_vec3 p);

#endif
