// Casts rays from surfaces, and follows each through specular reflections to the surfel whose light it carries.
#include "light/links/ray_ends.h"

#include "core/pack.h"
#include "core/sampling.h"
#include "scene/direct_light.h"
#include "scene/scene_parts.h"

enum { SALT_CHAIN = 0x48414E43, SALT_LAMPS = 0x4C4D5053 };

void olx_ray_caster_watch(olx_ray_caster *c, olx_watched_surfels *w) {
  const olx_light_surfels *surfels = c->surfels;
  w->scene = *surfels->scene;
  w->log = (olx_ray_log){.bricks = olx_space_bricks_make(w->scene.bounds_min, w->scene.bounds_max)};
  w->bvh = *w->scene.bvh;
  w->light_bvh = *w->scene.light_bvh;
  w->bvh.log = w->light_bvh.log = &w->log;
  w->scene.bvh = &w->bvh;
  w->scene.light_bvh = &w->light_bvh;
  w->surfels = *surfels;
  w->surfels.scene = &w->scene;
  c->surfels = &w->surfels;
  c->log = &w->log;
}

// The spacing of a surfel's rays where they end, as a share of their length.
static const float RAY_FOOTPRINT = 0.3f;

// A surfel of a larger cell serves a ray when the side of that cell is at most this share of the ray's length.
static const float MOST_SERVED = 0.5f;

// A surfel whose cell is larger than this share of the ray's length is too coarse for the direct light at the ray's
// end, because edges of shadows may cross the cell.
static const float MOST_LIT_SIDE = 0.3f;

// Returns whether a ray finds the direct light at its end itself, where a surfel serves it with a cell of that side.
// The mean over a cell that the sun reaches in part serves no ray, however long: the parts of the cell that rays from
// one place meet are lit in another share than the whole.
static bool finds_light(const olx_light_surfels *s, uint32_t surfel, float side, float distance) {
  return olx_surfel_is_uneven(s, surfel) || side > MOST_LIT_SIDE * distance;
}

// Links a ray that ends at the diffuse lobe of a surface to the surfel there, which stores the light of the surface. A
// surfel farther away is used where no surfels will be added.
static olx_link link_to(const olx_ray_caster *c, const olx_surface *surface, const olx_ray_hit *hit, olx_vec3 weight,
                        uint32_t chain, float distance, olx_ray_end *end) {
  const olx_light_surfels *s = c->surfels;
  if (olx_max3(weight) <= 0.0f) return olx_ray_end_none().link;
  end->point = olx_surfel_point_make(&s->grid, surface, hit, RAY_FOOTPRINT * distance);
  const float most_side = c->ends_unserved ? MOST_SERVED * distance : INFINITY;
  const olx_surfel_found found = olx_light_surfels_find(s, end->point.key, surface, most_side);
  olx_link link = {.end = OLX_LINK_UNSERVED | chain << OLX_LINK_CHAIN_SHIFT, .weight = olx_rgb9e5_pack(weight)};
  if (found.surfel == OLX_CELL_NONE) return link;
  const float side = olx_max(found.side, s->surfels[found.surfel].side);
  link.end = found.surfel | chain << OLX_LINK_CHAIN_SHIFT;
  if (!finds_light(s, found.surfel, side, distance)) return link;
  link.end |= OLX_LINK_LIT;
  if (!olx_environment_is_even(s->scene) || olx_surfel_sees_sky(s, found.surfel)) link.end |= OLX_LINK_SKY_LIT;
  return link;
}

// A ray on its way from surface to surface.
typedef struct way {
  olx_lobe_ray lobe; // the lobe from which it was drawn
  olx_vec3 origin, throughput;
  olx_ray_hit hit;
  uint32_t chain; // number of surfaces that have passed it on
  bool lit;       // direct light at the last surface already includes emitters
  float distance; // metres; determines how fine the surfels at its end should be
  olx_sampler sampler;
} way;

static const uint64_t lights_needed = UINT64_C(1) << OLX_INPUT_LIGHTS;

// Adds light after `surfaces` surfaces between its emitter and the start of the path.
static void add_light(olx_ray_end *end, uint32_t surfaces, olx_vec3 light) {
  if (surfaces > 0) end->fixed[surfaces - 1] = olx_add(end->fixed[surfaces - 1], light);
}

static void cast_on(const olx_ray_caster *c, way *w, const olx_surface *surface, uint64_t *rays) {
  const olx_ray ray = olx_surface_ray(surface, w->lobe.direction, INFINITY);
  w->origin = surface->position;
  w->chain++;
  ++*rays;
  w->hit = olx_bvh_intersect(c->surfels->scene->light_bvh, &ray);
}

// Takes a sample of the light that surfaces near lamps send to the start of a ray.
static void sample_lamps(const olx_ray_caster *c, const olx_surface *surface, const olx_ray_draw *draw,
                         olx_ray_end *end) {
  const olx_near_lamps *lamps = &c->surfels->lamps;
  end->needs |= UINT64_C(1) << OLX_INPUT_NEAR_LAMPS; // also where there are none yet
  if (lamps->count == 0) return;
  olx_sampler sampler = {.seed = olx_hash2(draw->seed, SALT_LAMPS), .index = draw->index};
  end->needs |= lights_needed | lamps->needs;
  const olx_vec3 irradiance = olx_lamp_irradiance(lamps, c->surfels->scene, surface, &sampler, &end->cast);
  end->near = olx_scale(irradiance, 1.0f / OLX_PI);
}

// Returns the radii of lamps whose direct light the end of a ray leaves out, because points near the lamps stand for
// it, or add_lamps adds it.
// A mirror reflects no light of points, but the rays that it reflects find their surfaces.
static const float *dark_of(const olx_ray_caster *c, const way *w) {
  return w->chain > 0 && !w->lit && w->lobe.pdf <= 0.0f ? NULL : c->surfels->lamps.radius;
}

// Adds the share of the light of surfaces near lamps that their points leave to rays which end close by.
static void add_lamps(const olx_ray_caster *c, const way *w, const olx_surface *surface, olx_ray_end *end,
                      uint64_t *rays) {
  const olx_light_surfels *s = c->surfels;
  if (!dark_of(c, w)) return;
  const olx_vec3 light = olx_lamp_light_found(&s->lamps, s->scene, surface, w->lobe.direction, w->hit.t, rays);
  add_light(end, w->chain + 1, olx_mul(w->throughput, light));
}

// Rays that are passed on meet an even sky, so that it is not sampled. Samples would rarely find it through a small
// window.
static olx_direct_kinds sampled_kinds(const olx_ray_caster *c) {
  return olx_environment_is_even(c->surfels->scene) ? OLX_DIRECT_BUT_SKY : OLX_DIRECT_ALL;
}

// Returns the radiance of the sky that a ray meets behind its last surface.
static olx_vec3 sky_met(const olx_ray_caster *c, const way *w) {
  const olx_scene *scene = c->surfels->scene;
  if (olx_environment_is_even(scene)) return olx_environment_radiance(scene, w->lobe.direction);
  return w->lit ? olx_splat(0.0f) : olx_sky_found(scene, &w->lobe);
}

static olx_vec3 direct_irradiance(const olx_ray_caster *c, way *w, const olx_surface *surface, olx_direct_kinds kinds,
                                  uint64_t *rays) {
  const olx_direct_query query = {.kinds = kinds, .dark = dark_of(c, w)};
  return olx_direct_irradiance_of(c->surfels->scene, surface, &query, &w->sampler, rays);
}

// Adds the emission that the specular lobe, chosen with probability `share`, reflects, and continues the path; returns
// false when the ray brings nothing.
static bool pass_specular(const olx_ray_caster *c, way *w, const olx_shading *shading, float share, olx_ray_end *end,
                          uint64_t *rays) {
  const olx_scene *scene = c->surfels->scene;
  w->throughput = olx_scale(w->throughput, 1.0f / share);
  end->needs |= lights_needed;
  const olx_lobes found = olx_direct_light_sampled(scene, shading, OLX_MIS_EACH_LOBE, &w->sampler, rays);
  add_light(end, w->chain + 1, olx_mul(w->throughput, found.specular));
  if (c->surfels->lamps.count > 0 && w->chain + 1 < OLX_CHAIN_MOST) {
    const olx_lobes near = olx_lamp_light(&c->surfels->lamps, scene, shading, &w->sampler, rays);
    end->needs |= c->surfels->lamps.needs;
    add_light(end, w->chain + 2, olx_mul(w->throughput, near.specular));
  }
  w->lobe = olx_lobe_ray_specular(shading, olx_sampler_next2(&w->sampler));
  w->lit = false;
  w->throughput = olx_mul(w->throughput, w->lobe.weight);
  if (olx_max3(w->throughput) <= 0.0f) return false;
  cast_on(c, w, shading->surface, rays);
  return true;
}

// Adds the direct light of a surface that no surfel serves, times `weight` over pi, and continues with a ray for the
// indirect light, which also meets an even sky.
static bool pass_diffuse(const olx_ray_caster *c, way *w, const olx_surface *surface, olx_vec3 weight, olx_ray_end *end,
                         uint64_t *rays) {
  end->needs |= lights_needed | UINT64_C(1) << OLX_INPUT_SURFELS;
  const bool last = w->chain + 1 == OLX_CHAIN_MOST; // no ray goes on, which could meet the sky
  const olx_vec3 irradiance = direct_irradiance(c, w, surface, last ? OLX_DIRECT_ALL : sampled_kinds(c), rays);
  add_light(end, w->chain + 1, olx_scale(olx_mul(weight, irradiance), 1.0f / OLX_PI));
  end->link = olx_ray_end_none().link;
  if (last) return false;
  if (c->surfels->lamps.count > 0) {
    const olx_vec3 near = olx_lamp_irradiance(&c->surfels->lamps, c->surfels->scene, surface, &w->sampler, rays);
    end->needs |= c->surfels->lamps.needs;
    add_light(end, w->chain + 2, olx_scale(olx_mul(weight, near), 1.0f / OLX_PI));
  }
  w->lobe.direction = olx_from_basis(olx_sample_cosine(olx_sampler_next2(&w->sampler)), surface->shading_normal);
  w->lit = true;
  w->throughput = weight;
  if (olx_dot(w->lobe.direction, surface->geometric_normal) <= 0.0f) return false;
  cast_on(c, w, surface, rays);
  w->distance = w->hit.t;
  return true;
}

// Ends the path at a diffuse lobe when a surfel serves it, or when surfels will be added for it; returns false when the
// path must continue.
static bool end_way(const olx_ray_caster *c, way *w, const olx_surface *surface, olx_vec3 weight, olx_ray_end *end,
                    uint64_t *rays) {
  end->link = link_to(c, surface, &w->hit, weight, w->chain, w->distance, end);
  if (olx_ray_end_is_unserved(end)) return c->ends_unserved;
  if (!(end->link.end & OLX_LINK_LIT) || !olx_link_brings_light(&end->link)) return true;
  end->needs |= lights_needed;
  const olx_direct_kinds kinds = end->link.end & OLX_LINK_SKY_LIT ? OLX_DIRECT_ALL : OLX_DIRECT_BUT_SKY;
  const olx_vec3 irradiance = direct_irradiance(c, w, surface, kinds, rays);
  add_light(end, w->chain + 1, olx_scale(olx_mul(weight, irradiance), 1.0f / OLX_PI));
  return true;
}

// Follows a path from a surface until it ends at a surfel, at the sky, or brings nothing. At a surface with both lobes
// it chooses one at random. The last surface that it may reach counts as matte, so that no light is lost there.
static void follow(const olx_ray_caster *c, way *w, olx_ray_end *end, uint64_t *rays) {
  const olx_scene *scene = c->surfels->scene;
  while (w->chain < OLX_CHAIN_MOST) {
    if (w->hit.triangle == OLX_NO_HIT) {
      if (w->chain == 0) return;
      end->needs |= lights_needed;
      add_light(end, w->chain, olx_mul(w->throughput, sky_met(c, w)));
      return;
    }
    const olx_surface surface = olx_surface_at(scene, &w->hit, w->lobe.direction);
    end->needs |= olx_input_of_material(surface.material);
    if (w->chain > 0 && olx_max3(surface.emission) > 0.0f) end->needs |= lights_needed;
    if (w->chain > 0 && !w->lit) {
      add_light(end, w->chain, olx_mul(w->throughput, olx_emission_found(scene, &surface, w->origin, &w->lobe)));
    }
    add_lamps(c, w, &surface, end, rays);
    olx_shading shading = olx_shading_make(&surface, w->lobe.direction);
    shading.dark = dark_of(c, w);
    shading.kinds = sampled_kinds(c);
    shading.least_alpha = OLX_LEAST_LAMP_ALPHA;
    const bool last = w->chain + 1 == OLX_CHAIN_MOST;
    const float share = shading.has_specular && !last ? shading.specular_share : 0.0f;
    if (share <= 0.0f || (shading.has_diffuse && olx_sampler_next(&w->sampler) >= share)) {
      const olx_vec3 reflectance = last ? olx_shading_albedo(&shading) : shading.diffuse,
                     weight = olx_scale(olx_mul(w->throughput, reflectance), 1.0f / (1.0f - share));
      if (end_way(c, w, &surface, weight, end, rays) || !pass_diffuse(c, w, &surface, weight, end, rays)) return;
    } else if (!pass_specular(c, w, &shading, share, end, rays)) {
      return;
    }
  }
}

// Makes the ray of a draw; its t_max is negative when it lies below the surface and brings nothing.
static olx_ray make_ray(const olx_surface *surface, const olx_ray_draw *draw) {
  const olx_vec3 local = olx_sample_cosine(draw->point);
  const olx_vec3 direction = olx_normalize(olx_from_basis(local, surface->shading_normal));
  olx_ray ray = olx_surface_ray(surface, direction, INFINITY);
  if (local.z <= 0.0f || olx_dot(direction, surface->geometric_normal) <= 0.0f) ray.t_max = -1.0f;
  return ray;
}

// Begins the record of a ray with the way to its hit; a ray that brings nothing is not cast, but begins in a brick.
static void log_first(olx_ray_log *log, const olx_ray *ray, const olx_ray_hit *hit) {
  log->crossed = (olx_brick_set){0};
  const float length = !hit ? 0.0f : hit->triangle == OLX_NO_HIT ? INFINITY : hit->t;
  olx_ray_log_add(log, ray->origin, ray->direction, length);
}

static void follow_first(const olx_ray_caster *c, const olx_ray_draw *draw, const olx_ray *ray, const olx_ray_hit *hit,
                         olx_ray_end *end) {
  way w = {.lobe = {.direction = ray->direction},
           .origin = ray->origin,
           .throughput = olx_splat(1.0f),
           .hit = *hit,
           .distance = hit->t,
           .sampler = {.seed = olx_hash2(draw->seed, SALT_CHAIN), .index = draw->index}};
  follow(c, &w, end, &end->cast);
}

static olx_ray_end find_end(const olx_ray_caster *c, const olx_surface *surface, const olx_ray_draw *draw,
                            const olx_ray *ray, const olx_ray_hit *hit) {
  olx_ray_end end = olx_ray_end_none();
  const bool valid = ray->t_max >= 0.0f;
  end.cast = 1;
  if (c->log) log_first(c->log, ray, valid ? hit : NULL);
  sample_lamps(c, surface, draw, &end);
  if (valid) follow_first(c, draw, ray, hit, &end);
  if (c->log) end.crossed = c->log->crossed;
  return end;
}

void olx_ray_ends_cast(const olx_ray_caster *c, const olx_surface *surface, const olx_ray_draw *draws, uint32_t count,
                       olx_ray_end *ends) {
  olx_ray rays[OLX_LINK_PACKET] = {0};
  olx_ray_hit hits[OLX_LINK_PACKET];
  uint32_t numbers[OLX_LINK_PACKET], cast = 0;
  for (uint32_t i = 0; i < count; i++) {
    if (ends[i].known) continue;
    rays[cast] = make_ray(surface, &draws[i]);
    numbers[cast++] = i;
  }
  olx_bvh_intersect_many(c->surfels->scene->light_bvh, rays, cast, false, hits);
  olx_surfaces_prefetch(c->surfels->scene, hits, cast);
  for (uint32_t k = 0; k < cast; k++) {
    const uint32_t i = numbers[k];
    ends[i] = find_end(c, surface, &draws[i], &rays[k], &hits[k]);
  }
}

olx_ray_end olx_ray_end_go_on(const olx_light_surfels *surfels, const olx_surface *surface, uint32_t chain,
                              olx_vec3 weight, uint32_t seed, uint32_t index, uint64_t *rays) {
  const olx_ray_caster c = {.surfels = surfels};
  way w = {.lobe = {.pdf = 1.0f}, // which lobe passed the ray on is not stored: it is taken for none of a mirror
           .chain = chain,
           .sampler = {.seed = seed, .index = index}};
  olx_ray_end end = olx_ray_end_none();
  if (pass_diffuse(&c, &w, surface, weight, &end, rays)) follow(&c, &w, &end, rays);
  return end;
}

olx_vec3 olx_ray_end_light(const olx_ray_end *end, float factor, float near_factor, const olx_passed_light *light) {
  olx_vec3 sum = {0}, near = light->bounces > 0 ? end->near : (olx_vec3){0};
  for (uint32_t k = 0; k < OLX_CHAIN_MOST && k < light->bounces; k++) sum = olx_madd(sum, end->fixed[k], OLX_PI);
  if (olx_link_brings_light(&end->link)) {
    const uint32_t at = olx_link_end(&end->link);
    olx_vec3 passed = light->all[at];
    if (end->link.end & OLX_LINK_LIT)
      passed = olx_add(olx_sub(passed, light->direct.all[at]), olx_direct_of_link(&end->link, &light->direct));
    sum = olx_add(sum, olx_mul(olx_rgb9e5_unpack(end->link.weight), passed));
  }
  return olx_madd(olx_scale(sum, factor), near, near_factor * OLX_PI);
}
