// What follows from a bake's settings alone.
#ifndef OLX_BAKE_BAKE_SETTINGS_H
#define OLX_BAKE_BAKE_SETTINGS_H

#include <octalux/bake.h>

// OLX_ERROR_ARGUMENT, with a message that names the setting and its range, for settings that no bake can follow.
olx_result olx_bake_check_settings(const olx_bake_settings *settings);
// The selectors that the field gets, a bit each. Bricks are in every field that they can be in: surfaces on which light
// is stored are found by them.
uint32_t olx_bake_select_mask(const olx_bake_settings *settings);
// Whether the light of irradiance probes comes from the solution for the whole scene, as that of texels does.
bool olx_bake_is_solved(const olx_bake_settings *settings);

#endif
