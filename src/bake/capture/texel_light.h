// Indirect irradiance at the texels of a light field probe, from the solved light of the scene.
#ifndef OLX_BAKE_TEXEL_LIGHT_H
#define OLX_BAKE_TEXEL_LIGHT_H

#include "bake/capture/capture.h"
#include "light/scene_light.h"

// Fills irradiance (size^2, W/m^2, for vertex normals; 0 for the sky) for the probe that was captured last. In blocks
// of 4 x 4 texels that lie on one plane it is looked up at the corners and interpolated between them. `rows` has one
// element for each row of blocks, to keep what gathers found; it may be NULL.
olx_result olx_light_texels(const olx_capture *capture, const olx_scene_light *light, olx_gather_row *rows,
                           olx_vec3 *irradiance);

#endif
