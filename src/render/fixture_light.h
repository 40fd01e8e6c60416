// The light of surfaces near lamps (field/near_lamps.h) in lobes whose light is gathered by rays.
//
// A ray that happens to end a few centimetres from a lamp without area brings thousands of times the mean, which shows
// as a white speck. Such light is therefore estimated in two ways at once: by the rays, and by points drawn from the
// lamp's own rays. Both count by the balance heuristic (Veach and Guibas, Optimally Combining Sampling Techniques,
// SIGGRAPH 1995): the sum keeps the mean, and neither part can exceed the light that one of the points sends. Light
// that the ends reflect as highlights is replaced by that of a matte surface, as in bakes.
#ifndef OLX_RENDER_FIXTURE_LIGHT_H
#define OLX_RENDER_FIXTURE_LIGHT_H

#include "render/camera_sample.h"
#include "scene/direct_light.h"

// Finds the surfaces near the field's lamps: context->lamps. On failure nothing has to be freed; otherwise
// olx_near_lamps_free does.
olx_result olx_fixtures_find(olx_render_context *context);

// Returns the density, in 1/sr, with which rays of the specular lobe are drawn in a direction; 0 for a mirror.
float olx_glossy_density(const olx_shading *shading, olx_vec3 direction);

// Takes from the radiance of a hit the share that points drawn from lamps bring instead. The ray was drawn with
// `density` (1/sr); with 0 the hit stays as it is.
void olx_fixtures_leave(const olx_render_context *context, olx_vec3 direction, float density, olx_trace_hit *hit);

// The lobe of a surface that gathers light.
typedef enum olx_gathering { OLX_GATHER_COSINE, OLX_GATHER_SPECULAR } olx_gathering;

// Returns by one point and one shadow ray an estimate of what olx_fixtures_leave takes from one ray: for the cosine the
// mean radiance, for the specular lobe the radiance that it reflects. 0 for a mirror and without points.
olx_vec3 olx_fixtures_light(const olx_render_context *context, const olx_shading *shading, olx_gathering lobe,
                            float random, uint64_t *rays);

#endif
