// Whether a tone-mapped picture can be seen at its exposure.
#ifndef OCTALUX_CLI_EXPOSURE_H
#define OCTALUX_CLI_EXPOSURE_H

#include <octalux/render.h>

// Warns where the median of the lit pixels is tone-mapped to white or to black, with an exposure that shows them.
// `path` names the picture. Needs the image's beauty.
void warn_about_exposure(const char *path, const olx_image *image, float exposure);

#endif
