// Computes the radiance that the surface of a texel sends to its probe: the texel's light through the diffuse lobe or
// through the average of both lobes over views, and what mirrors reflect.
#include "bake/capture/texel_radiance.h"

#include "light/path.h"
#include "light/ray_light.h"
#include "scene/bvh.h"

bool olx_texel_is_mirror(const olx_bsdf *bsdf) { return bsdf->alpha <= OLX_SHARP_ALPHA && olx_bsdf_has_specular(bsdf); }

olx_vec3 olx_texel_reflected(const olx_bsdf *bsdf, float cosine, olx_vec3 irradiance) {
  const olx_vec3 albedo = olx_texel_is_mirror(bsdf) ? olx_bsdf_diffuse(bsdf, cosine) : olx_bsdf_matte(bsdf).albedo;
  return olx_scale(olx_mul(albedo, irradiance), 1.0f / OLX_PI);
}

// Returns the light that arrives along the lobe's ray.
static olx_vec3 arriving(const olx_lobe_source *source, const olx_surface *surface, const olx_lobe_ray *lobe,
                         olx_sampler *sampler, uint64_t *rays) {
  const olx_scene *scene = source->scene;
  const olx_ray ray = olx_surface_ray(surface, lobe->direction, INFINITY);
  const olx_ray_hit hit = olx_bvh_intersect(scene->light_bvh, &ray);
  ++*rays;
  if (hit.triangle == OLX_NO_HIT) return olx_sky_found(scene, lobe);
  const olx_surface found = olx_surface_at(scene, &hit, lobe->direction);
  const olx_vec3 emission = olx_emission_found(scene, &found, surface->position, lobe);
  return olx_add(emission, olx_ray_light(scene, source->light, source->bounces, &ray, &hit, sampler, rays));
}

static olx_vec3 traced(const olx_lobe_source *source, const olx_surface *surface, const olx_lobe_ray *lobe,
                       const olx_sampler *sampler, uint64_t *rays) {
  olx_path path = {.scene = source->scene,
                   .bounces = source->bounces,
                   .emitters_can_be_hit = olx_emitters_can_be_hit(source->scene),
                   .sampler = *sampler};
  const olx_path_light light = olx_path_lobe(&path, surface, lobe);
  *rays += path.rays;
  return olx_add(light.direct, light.indirect);
}

olx_vec3 olx_texel_mirrored(const olx_lobe_source *source, const olx_surface *surface, olx_vec3 direction,
                            olx_sampler *sampler, uint64_t *rays) {
  const olx_shading shading = olx_shading_make(surface, direction);
  olx_vec3 sum = olx_direct_light_sampled(source->scene, &shading, OLX_MIS_EACH_LOBE, sampler, rays).specular;
  const olx_lobe_ray lobe = olx_lobe_ray_specular(&shading, olx_sampler_next2(sampler));
  if (olx_max3(lobe.weight) <= 0.0f) return sum;
  // Paths weigh what they find by the lobe themselves.
  if (!source->light) return olx_add(sum, traced(source, surface, &lobe, sampler, rays));
  return olx_add(sum, olx_mul(lobe.weight, arriving(source, surface, &lobe, sampler, rays)));
}
