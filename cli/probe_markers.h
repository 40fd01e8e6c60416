// Draws light field probes into an image at their positions.
#ifndef OCTALUX_CLI_PROBE_MARKERS_H
#define OCTALUX_CLI_PROBE_MARKERS_H

#include <octalux/render.h>

// Draws the field's probes as small spheres, blue, or red when buried (inside geometry), occluded by surfaces in front
// of them. Needs the image's beauty and depth.
void draw_probe_markers(const olx_field *field, const olx_camera *camera, olx_image *image);

#endif
