// The field renderer: camera rays and direct light with real rays, indirect light from a baked field.
#ifndef OLX_RENDER_FIELD_RENDERER_H
#define OLX_RENDER_FIELD_RENDERER_H

#include "render/camera_sample.h"

void olx_field_render_tile(const olx_render_context *context, olx_tile_rays *rays, olx_camera_sample *samples,
                           olx_render_stats *stats);

#endif
