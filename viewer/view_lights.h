// The movable lights of a scene, and their conversion for the rasteriser and a relighter.
#ifndef OCTALUX_VIEW_LIGHTS_H
#define OCTALUX_VIEW_LIGHTS_H

#include "lamp_samples.h"
#include "view_state.h"

// Returns the lights as in the scene.
view_lights view_lights_of(const olx_scene_content *content);
bool view_lights_same(const view_lights *a, const view_lights *b);

// Moves point and spot lights to a position, and turns a sun to that direction. Values that give no direction are
// ignored.
void view_lights_place(view_lights *lights, uint32_t light, olx_vec3 to);
// Turns suns around the sky by `right` and up by `up` radians; other lights move by metres in the frame of a camera's
// yaw.
void view_lights_move(view_lights *lights, uint32_t light, float right, float up, float away, float yaw);

// Makes the lamps of a scene whose lights have changed: as many of each kind as before, with as many views. Returns
// false when memory runs out.
bool view_lights_lamps(const olx_scene_content *content, const view_lights *lights, const lamp_settings *settings,
                       lamp_list *list);
// Applies the changes to the lights of olx_scene_relight_lights, in which the scene's lights without area come first.
void view_lights_relit(const view_lights *lights, olx_light *relit, uint32_t count);

#endif
