// Small scenes and calls that tests of placement share. Any failure fails the running test.
#ifndef OLX_TESTS_PLACE_FIXTURES_H
#define OLX_TESTS_PLACE_FIXTURES_H

#include "scene/scene_data.h"

#include <octalux/place.h>

// Returns settings that take a fraction of a second.
olx_place_settings quick_settings(const olx_scene *scene, olx_place_method method);
// Return quick settings with a quarter of the surfels, for tests in which it does not matter what probes see.
olx_place_settings quicker_settings(const olx_scene *scene, olx_place_method method);
olx_probe_set place(const olx_scene *scene, const olx_place_settings *settings);
olx_scene *load(const char *name);
uint32_t matte(olx_scene *scene);
// Starts a room of 4 m x 2 m x 4 m around the origin, to be finished.
olx_scene *start_room(void);
// Starts a room of 4 m x 2 m x 4 m around the origin that is divided by a wall from floor to ceiling at x = 0 that
// leaves a gap at one side.
olx_scene *start_divided_room(void);
// Loads the divided room, finished, with rules: two pinned probes, a forbidden box, a playable box, 0.4 m of distance.
olx_scene *load_ruled_room(void);
// Checks that the pinned probes come first, and that every other probe obeys the rules.
void expect_rules_kept(const olx_scene *scene, const olx_probe_set *set);
// Checks that no probe is inside the pillar at the centre of builtin:pillars.
void expect_outside_the_centre_pillar(const olx_probe_set *set);
// Return whether positions, origins, gains and coverage are the same, to the last bit.
bool same_probes(const olx_probe_set *a, const olx_probe_set *b);
bool box_holds(const olx_box *box, olx_vec3 p);
// A progress callback that cancels.
bool refuse(void *user, const char *stage, float done);

#endif
