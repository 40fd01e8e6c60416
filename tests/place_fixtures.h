// Small scenes and calls that tests of placement share. Any failure fails the running test.
#ifndef OLX_TESTS_PLACE_FIXTURES_H
#define OLX_TESTS_PLACE_FIXTURES_H

#include "scene/scene_data.h"

#include <octalux/place.h>

// Settings that take a fraction of a second.
olx_place_settings quick_settings(const olx_scene *scene, olx_place_method method);
// Quick settings with a quarter of the surfels, for tests in which it does not matter what probes see.
olx_place_settings quicker_settings(const olx_scene *scene, olx_place_method method);
olx_probe_set place(const olx_scene *scene, const olx_place_settings *settings);
olx_scene *load(const char *name);
uint32_t matte(olx_scene *scene);
// A room of 4 m x 2 m x 4 m around the origin, to be finished.
olx_scene *start_room(void);
// That room divided by a wall from floor to ceiling at x = 0 that leaves a gap at one side.
olx_scene *start_divided_room(void);
// The divided room, finished, with rules: two pinned probes, a forbidden box, a box that is playable, 0.4 m of
// distance.
olx_scene *load_ruled_room(void);
// The pinned probes come first, and every other probe keeps to the rules.
void expect_rules_kept(const olx_scene *scene, const olx_probe_set *set);
// Of builtin:pillars, in whose centre a pillar stands.
void expect_outside_the_centre_pillar(const olx_probe_set *set);
// Same positions, origins, gains and coverage, to the last bit.
bool same_probes(const olx_probe_set *a, const olx_probe_set *b);
bool box_holds(const olx_box *box, olx_vec3 p);
// A progress report that cancels.
bool refuse(void *user, const char *stage, float done);

#endif
