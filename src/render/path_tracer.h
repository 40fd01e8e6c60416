// The path tracer: the reference for every other renderer (light/path.h).
#ifndef OLX_RENDER_PATH_TRACER_H
#define OLX_RENDER_PATH_TRACER_H

#include "render/camera_sample.h"

void olx_path_render_tile(const olx_render_context *context, olx_tile_rays *rays, olx_camera_sample *samples,
                          olx_render_stats *stats);

#endif
