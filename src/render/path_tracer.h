// Path tracing: the judge of everything else. Next-event estimation with multiple importance sampling, Russian roulette.
//
// `bounces` counts surfaces between the emitter and the shaded surface: 0 leaves no indirect light, 1 is the light of
// surfaces that are lit directly, OLX_BOUNCES_INFINITE all of it.
#ifndef OLX_RENDER_PATH_TRACER_H
#define OLX_RENDER_PATH_TRACER_H

#include "render/camera_sample.h"

void olx_path_render_tile(const olx_render_context *context, olx_tile_rays *rays, olx_camera_sample *samples,
                          olx_render_stats *stats);

// Indirect irradiance in W/m^2 (emitters and sky excluded) at `position` with geometric normal `normal`, from `paths`
// cosine-distributed paths that start `epsilon` off the surface. Depends on the arguments alone.
olx_vec3 olx_path_irradiance(const olx_scene *scene, olx_vec3 position, olx_vec3 normal, float epsilon,
                             uint32_t bounces, uint32_t paths, uint32_t seed);

#endif
