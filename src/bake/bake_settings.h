// Values derived from a bake's settings alone.
#ifndef OLX_BAKE_BAKE_SETTINGS_H
#define OLX_BAKE_BAKE_SETTINGS_H

#include <octalux/bake.h>

// Returns OLX_ERROR_ARGUMENT for invalid settings, with a message that names the setting and its range.
olx_result olx_bake_check_settings(const olx_bake_settings *settings);
// Returns the selectors that the field stores, one bit each. Every field that can have bricks has them, because
// surfaces with stored light are found by them.
uint32_t olx_bake_select_mask(const olx_bake_settings *settings);
// Returns whether the light of irradiance probes comes from the solution for the whole scene, like that of texels.
bool olx_bake_is_solved(const olx_bake_settings *settings);

#endif
