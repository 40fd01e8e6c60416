// Renders the tiles of a path-traced image in layers: the light that each lobe of the surface hit by a camera ray
// reflects.
#include "render/path_tracer.h"

#include "light/path.h"

static void shade(olx_path *p, const olx_ray_hit *hit, olx_vec3 direction, olx_sky_guide *sky,
                  olx_camera_sample *sample) {
  const olx_surface surface = olx_surface_at(p->scene, hit, direction);
  olx_shading shading = olx_shading_make(&surface, direction);
  shading.sky = sky;
  sample->emission = surface.emission;
  sample->albedo = surface.bsdf.albedo;
  sample->normal = surface.shading_normal;
  const olx_sampler first = p->sampler;
  const olx_lobes lit = olx_direct_light_sampled(p->scene, &shading, OLX_MIS_EACH_LOBE, &p->sampler, &p->rays);
  sample->direct = olx_add(lit.diffuse, lit.specular);
  if (shading.has_diffuse) {
    p->sampler = olx_sampler_split(&first, 0);
    const olx_lobe_ray lobe = olx_lobe_ray_diffuse(&shading, olx_sampler_next2(&p->sampler));
    const olx_path_light light = olx_path_lobe(p, &surface, &lobe);
    sample->direct = olx_add(sample->direct, light.direct);
    sample->indirect_diffuse = light.indirect;
  }
  if (shading.has_specular) {
    p->sampler = olx_sampler_split(&first, 1);
    const olx_lobe_ray lobe = olx_lobe_ray_specular(&shading, olx_sampler_next2(&p->sampler));
    const olx_path_light light = olx_path_lobe(p, &surface, &lobe);
    sample->direct = olx_add(sample->direct, light.direct);
    sample->indirect_glossy = light.indirect;
  }
}

void olx_path_render_tile(const olx_render_context *context, olx_tile_rays *rays, olx_camera_sample *samples,
                          olx_render_stats *stats) {
  olx_path p = {
      .scene = context->scene,
      .bounces = context->settings->bounces,
      .emitters_can_be_hit = olx_emitters_can_be_hit(context->scene),
  };
  for (uint32_t i = 0; i < rays->count; i++) {
    if (rays->hits[i].triangle == OLX_NO_HIT) continue;
    p.sampler = rays->sky ? olx_sky_guide_sampler(rays->sky, &rays->samplers[i]) : rays->samplers[i];
    shade(&p, &rays->hits[i], rays->directions[i], rays->sky, &samples[i]);
  }
  stats->rays += p.rays;
}
