// Reads texels of any map of any probe, by the map's name.
#ifndef OLX_EXPORT_MAP_TEXELS_H
#define OLX_EXPORT_MAP_TEXELS_H

#include "core/vec.h"

#include <octalux/export.h>

// Returns the number of channels with data: 1 or 3.
uint32_t olx_map_channels(olx_map map);
// Returns the number of texels along a side of a map, without border.
uint32_t olx_map_side(const olx_field *field, olx_map map);
// Returns OLX_ERROR_ARGUMENT when the field has no such map, or no such probe.
olx_result olx_map_check(const olx_field *field, olx_map map, uint32_t probe);
// Returns the value of texel (x, y), below olx_map_side; scalars are in x.
olx_vec3 olx_map_texel(const olx_field *field, olx_map map, uint32_t probe, uint32_t x, uint32_t y);

#endif
