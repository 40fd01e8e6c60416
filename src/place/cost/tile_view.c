// Casts the rays of single tiles of light field maps, with the samples of material and direct light that the bake
// takes.
#include "place/cost/tile_view.h"

#include "core/pack.h"
#include "field/texels.h"
#include "scene/bvh.h"
#include "scene/direct_light.h"
#include "scene/emitters.h"
#include "scene/texel_samples.h"

enum {
  SIDE = OLX_TILE_VIEW_SIDE,
  TEXELS = OLX_TILE_VIEW_TEXELS,
  MOST_SAMPLES = 64, // of a texel
};
// A texel of a map.
typedef struct texel_place {
  uint32_t probe, x, y;
  olx_vec3 position; // of the probe
} texel_place;

// The material's numbers and direct light, summed over the samples that lie on the texel's surface.
typedef struct surface_sums {
  olx_vec3 base_color, direct;
  float roughness, metallic, count;
} surface_sums;

olx_vec3 olx_tile_probe_position(const olx_planned_maps *maps, uint32_t probe) {
  return maps->positions ? maps->positions[probe] : olx_grid_position(maps->grid, probe);
}

static void add_sample(const olx_planned_maps *maps, const texel_place *t, uint32_t k, const olx_ray_hit *hit,
                       const olx_surface *surface, surface_sums *sums) {
  const olx_surface s = olx_texel_smooth_surface(maps->scene, hit, surface);
  const uint32_t lights = maps->light_samples;
  const olx_sampler first =
      olx_texel_light_sampler(t->probe, maps->seed, t->x, t->y, maps->size, maps->samples, k, lights);
  olx_vec3 direct = olx_splat(0.0f);
  uint64_t rays = 0;
  for (uint32_t i = 0; i < lights; i++) {
    olx_sampler sampler = {.seed = first.seed, .index = first.index + i};
    direct = olx_add(direct, olx_direct_irradiance(maps->scene, &s, NULL, &sampler, &rays));
  }
  sums->base_color = olx_add(sums->base_color, s.base_color);
  sums->roughness += s.roughness;
  sums->metallic += s.metallic;
  sums->direct = olx_madd(sums->direct, direct, 1.0f / (float)lights);
  sums->count += 1.0f;
}

// Looks at a texel's material and at the light that reaches it directly.
static void view_surface(const olx_planned_maps *maps, const texel_place *t, const olx_ray_hit *hit,
                         const olx_surface *middle, olx_tile_view *view, uint32_t i) {
  const uint32_t count = maps->samples * maps->samples;
  const float tolerance = olx_texel_tolerance(middle, hit->t, maps->size);
  olx_ray rays[MOST_SAMPLES];
  olx_ray_hit hits[MOST_SAMPLES];
  for (uint32_t k = 0; k < count; k++) {
    const olx_vec3 direction = olx_texel_sample_direction(t->x, t->y, maps->size, maps->samples, k);
    rays[k] = (olx_ray){t->position, direction, 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(maps->scene->bvh, rays, count, true, hits);
  surface_sums sums = {.count = 0.0f};
  for (uint32_t k = 0; k < count; k++) {
    if (hits[k].triangle == OLX_NO_HIT) continue;
    const olx_surface sample = olx_surface_near(maps->scene, &hits[k], rays[k].direction, middle);
    if (olx_texel_is_on_surface(middle, &sample, tolerance)) add_sample(maps, t, k, &hits[k], &sample, &sums);
  }
  if (sums.count == 0.0f) add_sample(maps, t, 0, hit, middle, &sums);
  const float share = 1.0f / sums.count;
  const olx_texel_material_codes codes = olx_material_pack(olx_scale(sums.base_color, share), sums.roughness * share,
                                                           sums.metallic * share, middle->bsdf.dielectric_weight);
  view->base[i] = codes.base;
  view->specular[i] = codes.specular;
  view->direct[i] = olx_rgb9e5_pack(olx_scale(sums.direct, share));
}

static void view_texel(const olx_planned_maps *maps, const texel_place *t, const olx_ray *ray, const olx_ray_hit *hit,
                       olx_tile_view *view, uint32_t i) {
  if (hit->triangle == OLX_NO_HIT) {
    view->geometry[i] = (olx_geometry_texel){.distance = INFINITY};
    view->emission[i] = olx_rgb9e5_pack(olx_environment_radiance(maps->scene, ray->direction));
    view->distance[i] = 0x7C00u;
    return;
  }
  const olx_surface surface = olx_surface_at(maps->scene, hit, ray->direction);
  view->geometry[i] = (olx_geometry_texel){hit->t, surface.geometric_normal};
  view->emission[i] = olx_rgb9e5_pack(surface.emission);
  view_surface(maps, t, hit, &surface, view, i);
}

void olx_tile_view_make(const olx_planned_maps *maps, const olx_tile_place *place, olx_tile_view *view) {
  const olx_vec3 position = olx_tile_probe_position(maps, place->probe);
  olx_ray rays[TEXELS];
  olx_ray_hit hits[TEXELS];
  for (uint32_t i = 0; i < TEXELS; i++) {
    const olx_vec3 direction = olx_texel_direction(place->x + i % SIDE, place->y + i / SIDE, maps->size);
    rays[i] = (olx_ray){position, direction, 0.0f, INFINITY};
  }
  olx_bvh_intersect_many(maps->scene->bvh, rays, TEXELS, true, hits);
  *view = (olx_tile_view){.base = {0}};
  for (uint32_t i = 0; i < TEXELS; i++) {
    const texel_place t = {place->probe, place->x + i % SIDE, place->y + i / SIDE, position};
    view_texel(maps, &t, &rays[i], &hits[i], view, i);
  }
}
