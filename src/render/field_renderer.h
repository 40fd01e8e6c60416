// The field renderer: camera rays and direct light by real rays, indirect light from a baked field.
#ifndef OLX_RENDER_FIELD_RENDERER_H
#define OLX_RENDER_FIELD_RENDERER_H

#include "render/camera_sample.h"
#include "scene/direct_light.h"

void olx_field_render_tile(const olx_render_context *context, olx_tile_rays *rays, olx_camera_sample *samples,
                           olx_render_stats *stats);

// Returns the direct light of all emitters or, where rays through the field find area lights, of lights without area
// alone.
olx_vec3 olx_field_direct(const olx_render_context *context, const olx_shading *shading, olx_sampler *sampler,
                          olx_render_stats *stats);

// The result of one ray through the field.
typedef struct olx_field_ray_light {
  olx_vec3 light;
  float nearness; // 1 / distance to the hit, 0 without a hit
} olx_field_ray_light;

// Returns the radiance along a cosine-distributed direction: its mean is irradiance / pi.
olx_field_ray_light olx_field_diffuse_ray(const olx_render_context *context, const olx_shading *shading,
                                          olx_vec2 random, olx_render_stats *stats);
// Returns the light that the specular lobe reflects towards `view`.
olx_field_ray_light olx_field_glossy_ray(const olx_render_context *context, const olx_shading *shading, olx_vec3 view,
                                         olx_vec2 random, olx_render_stats *stats);

// Returns the irradiance, without rays, of the surface that `hit` is on: from classic maps with that method; stored at
// surfaces where settings choose that for diffuse light and in fields without probe light; otherwise from irradiance
// probes.
olx_vec3 olx_field_irradiance(const olx_render_context *context, const olx_ray_hit *hit, const olx_shading *shading,
                              olx_vec3 view);

// Returns whether the specular lobe is shaded from irradiance (settings.dim_lobe).
bool olx_field_lobe_is_dim(const olx_render_context *context, const olx_shading *shading);

#endif
