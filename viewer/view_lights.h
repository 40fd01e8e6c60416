// The lights that hands may move, and what the rasteriser and a relighter make of them.
#ifndef OCTALUX_VIEW_LIGHTS_H
#define OCTALUX_VIEW_LIGHTS_H

#include "lamp_samples.h"
#include "view_state.h"

// The lights as the scene has them.
view_lights view_lights_of(const olx_scene_content *content);
bool view_lights_same(const view_lights *a, const view_lights *b);

// Point and spot lights go to that place; a sun shines that way. Numbers that give no direction change nothing.
void view_lights_place(view_lights *lights, uint32_t light, olx_vec3 to);
// Suns go around the sky by `right` and up by `up` radians; other lights move by metres in the frame of a camera's yaw.
void view_lights_move(view_lights *lights, uint32_t light, float right, float up, float away, float yaw);

// The lamps of a scene whose lights have changed: as many of each kind as before, with as many views. False: out of
// memory.
bool view_lights_lamps(const olx_scene_content *content, const view_lights *lights, const lamp_settings *settings,
                       lamp_list *list);
// Change what olx_scene_relight_lights gave in the same way; the scene's lights without area come first there.
void view_lights_relit(const view_lights *lights, olx_relight_light *relit, uint32_t count);

#endif
