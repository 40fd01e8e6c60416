// Small scenes and calls that tests of placement share. Any failure fails the running test.
#ifndef OLX_TESTS_PLACE_FIXTURES_H
#define OLX_TESTS_PLACE_FIXTURES_H

#include "scene/scene_data.h"

#include <octalux/place.h>

// Settings that take a fraction of a second.
olx_place_settings quick_settings(const olx_scene *scene, olx_place_method method);
olx_probe_set place(const olx_scene *scene, const olx_place_settings *settings);
olx_scene *load(const char *name);
uint32_t matte(olx_scene *scene);
// A room of 4 m x 2 m x 4 m around the origin, to be finished.
olx_scene *start_room(void);
// The same, divided by a wall from floor to ceiling at x = 0 that leaves a gap at one side.
olx_scene *start_divided_room(void);
// Same positions, origins, gains and coverage, to the last bit.
bool same_probes(const olx_probe_set *a, const olx_probe_set *b);
bool box_holds(const olx_box *box, olx_vec3 p);
// A progress report that cancels.
bool refuse(void *user, const char *stage, float done);

#endif
