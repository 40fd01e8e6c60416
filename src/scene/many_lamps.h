// Draws one of many point and spot lights for a place, about in proportion to the light that each would send there.
//
// Lamps are sorted into clusters of neighbours. A cluster far away counts as one light, one nearby as the sum of its
// lamps, so that a draw reads few of the lamps and the probabilities are still about right everywhere. Nothing here
// knows what stands between, so a lamp in another room may seem to be the strongest by far. Two bounds keep the room's
// own lamps likely: a lamp closer to the place than a quarter of the distance to its nearest neighbour counts as if it
// were that far away, and an eighth of all draws takes any lamp.
#ifndef OLX_SCENE_MANY_LAMPS_H
#define OLX_SCENE_MANY_LAMPS_H

#include "scene/scene_data.h"

typedef struct olx_many_lamps olx_many_lamps;

// Takes all point and spot lights of a scene. *lamps becomes NULL when none of them shines.
olx_result olx_many_lamps_create(const olx_scene *scene, olx_many_lamps **lamps);
void olx_many_lamps_free(olx_many_lamps *lamps);

// Draws a lamp for a place by a random number in [0, 1). Returns its probability, 0 when no lamp reaches the place;
// every lamp that can reach it has at least an eighth of an even share. *light receives its number in the scene.
float olx_many_lamps_draw(const olx_many_lamps *lamps, olx_vec3 position, float random, uint32_t *light);

#endif
