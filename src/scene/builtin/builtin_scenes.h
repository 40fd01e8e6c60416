// The functions that builtin.c selects from; each fills an empty scene.
#ifndef OLX_SCENE_BUILTIN_SCENES_H
#define OLX_SCENE_BUILTIN_SCENES_H

#include "scene/scene_data.h"

olx_result olx_build_cornell(olx_scene *scene);
olx_result olx_build_cornell_glossy(olx_scene *scene);
olx_result olx_build_furnace(olx_scene *scene);
olx_result olx_build_two_rooms_sealed(olx_scene *scene);
// Builds the two rooms with a wall of this thickness in metres, off the middle.
olx_result olx_build_two_rooms_sealed_of(olx_scene *scene, float thickness);
olx_result olx_build_two_rooms_gap(olx_scene *scene);
// The width in metres of the gap in the scene two-rooms-gap.
#define OLX_ROOMS_GAP 0.8f
// Builds the two rooms with a gap of this width in metres in the wall.
olx_result olx_build_two_rooms_gap_of(olx_scene *scene, float gap);
olx_result olx_build_parlour(olx_scene *scene);
olx_result olx_build_pillars(olx_scene *scene);
olx_result olx_build_labyrinth(olx_scene *scene);
olx_result olx_build_holodeck(olx_scene *scene);
olx_result olx_build_area_light(olx_scene *scene);
olx_result olx_build_temple(olx_scene *scene);
olx_result olx_build_statue(olx_scene *scene);
olx_result olx_build_flat(olx_scene *scene);

#endif
