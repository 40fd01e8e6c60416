// The box of interest: the part of space that placement floods and the irradiance volume fills.
#ifndef OLX_PLACE_SPACE_BOX_H
#define OLX_PLACE_SPACE_BOX_H

#include "scene/scene_data.h"

#define OLX_LOOKS_ALONG 48u                           // looks along the height and the width of a camera's image
#define OLX_LOOKS (OLX_LOOKS_ALONG * OLX_LOOKS_ALONG) // directions in which a camera outside the box looks

// Returns the unit direction of look `i` of OLX_LOOKS, which are spread evenly over a square image.
olx_vec3 olx_look_direction(const olx_camera *camera, uint32_t i);

// Finds the box: the playable one, as far as it is near the scene, or else the scene's bounds, with space beyond them
// from which cameras look at surfaces that can be seen from nowhere else. Returns OLX_ERROR_EMPTY when it has no
// volume.
olx_result olx_space_box(const olx_scene *scene, olx_box *box);

#endif
