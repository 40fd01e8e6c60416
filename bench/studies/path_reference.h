// Path-traced pictures that studies keep between runs.
#ifndef OCTALUX_BENCH_PATH_REFERENCE_H
#define OCTALUX_BENCH_PATH_REFERENCE_H

#include <octalux/render.h>

// Path-traces a picture, or loads it when a run before kept one of the same camera, size, bounces and seed. `kept` is
// how the names of kept files begin. On success the caller must free the image.
olx_result path_reference(const olx_scene *scene, const olx_camera *camera, const olx_render_settings *settings,
                          const char *kept, olx_image *image);

#endif
