// Casts the rays of surfels and follows each, through specular reflections, to the surfel whose light it carries.
#include "light/links/links.h"

#include "core/chunk_file.h"
#include "core/hooks.h"
#include "core/pack.h"
#include "core/result.h"
#include "light/links/kept_rays.h"
#include "light/links/link_batch.h"
#include "scene/bvh.h"
#include "scene/direct_light.h"

#include <string.h>

enum {
  SURFELS_PER_JOB = 8,
  SALT_RAY = 0x52415953,
  SALT_CHAIN = 0x48414E43,
  SALT_UNSERVED = 0x554E5356,
  SALT_LAMPS = 0x4C4D5053
};

// What one ray brings.
typedef struct ray_end {
  olx_link link;
  olx_surface_point point; // valid where the link is unserved
  olx_vec3 fixed[OLX_CHAIN_MOST];
  uint64_t needs;        // slots of olx_scene_inputs that it depends on
  olx_brick_set crossed; // bricks that it depends on, where rays are kept
  uint64_t cast;         // rays cast for it
  bool known;            // it need not be cast
} ray_end;

typedef struct cast_job {
  const olx_light_surfels *surfels;
  olx_link_batch *batch;
  olx_fixed_light *fixed;
  olx_point_list *lists; // one per job, or NULL
  uint64_t *rays;        // one per job
  olx_cast_keeping keeping;
  olx_ray_log *log; // of the scene that the surfels lie in; NULL: nothing is kept
  atomic_bool *out_of_memory;
} cast_job;

// A scene with surfels whose rays are recorded, for one thread.
typedef struct watched_surfels {
  olx_ray_log log;
  olx_bvh bvh;
  olx_scene scene;
  olx_light_surfels surfels;
} watched_surfels;

// Has a job's rays recorded from here on.
static void watch_job(cast_job *c, watched_surfels *w) {
  const olx_light_surfels *surfels = c->surfels;
  w->scene = *surfels->scene;
  w->log = (olx_ray_log){.bricks = olx_space_bricks_make(w->scene.bounds_min, w->scene.bounds_max)};
  w->bvh = (olx_bvh){.tree = w->scene.bvh->tree, .log = &w->log};
  w->scene.bvh = &w->bvh;
  w->surfels = *surfels;
  w->surfels.scene = &w->scene;
  c->surfels = &w->surfels;
  c->log = &w->log;
}

static const olx_link no_link = {.end = OLX_LINK_NOWHERE};

static void add_point(cast_job *c, olx_point_list *list, const olx_surface_point *point) {
  if (list->count == list->capacity) {
    const uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
    olx_surface_point *larger = olx_allocate(capacity, sizeof *larger);
    if (!larger) {
      atomic_store(c->out_of_memory, true);
      return;
    }
    for (uint32_t i = 0; i < list->count; i++) larger[i] = list->points[i];
    olx_release(list->points);
    list->points = larger;
    list->capacity = capacity;
  }
  list->points[list->count++] = *point;
}

// The spacing of a surfel's rays where they end, as a share of their length.
static const float RAY_FOOTPRINT = 0.3f;

// A surfel of a larger cell serves a ray when the side of that cell is at most this share of the ray's length.
static const float MOST_SERVED = 0.5f;

// A surfel whose cell is larger than this share of the ray's length is too coarse for the direct light at the ray's
// end, because edges of shadows cross the cell.
static const float MOST_LIT_SIDE = 0.3f;

// Links a ray that ends at the diffuse lobe of a surface to the surfel there, which stores the light of the surface. A
// surfel farther away is used where no surfels will be added.
static olx_link link_to(const cast_job *c, const olx_surface *surface, const olx_ray_hit *hit, olx_vec3 weight,
                        uint32_t chain, float distance, ray_end *end) {
  const olx_light_surfels *s = c->surfels;
  if (olx_max3(weight) <= 0.0f) return no_link;
  end->point = olx_surface_point_make(&s->grid, surface, hit, RAY_FOOTPRINT * distance);
  const float most_side = c->lists ? MOST_SERVED * distance : INFINITY;
  const olx_surfel_found found = olx_light_surfels_find(s, end->point.key, surface, most_side);
  olx_link link = {.end = OLX_LINK_UNSERVED | chain << OLX_LINK_CHAIN_SHIFT, .weight = olx_rgb9e5_pack(weight)};
  if (found.surfel == OLX_CELL_NONE) return link;
  const float side = olx_max(found.side, s->surfels[found.surfel].side);
  link.end = found.surfel | chain << OLX_LINK_CHAIN_SHIFT | (side > MOST_LIT_SIDE * distance ? OLX_LINK_LIT : 0);
  return link;
}

static bool is_unserved(const ray_end *end) { return olx_link_end(&end->link) == OLX_LINK_UNSERVED; }

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
static void add_light(ray_end *end, uint32_t surfaces, olx_vec3 light) {
  if (surfaces > 0) end->fixed[surfaces - 1] = olx_add(end->fixed[surfaces - 1], light);
}

static void cast_on(const cast_job *c, way *w, const olx_surface *surface, uint64_t *rays) {
  const olx_ray ray = olx_surface_ray(surface, w->lobe.direction, INFINITY);
  w->origin = surface->position;
  w->chain++;
  ++*rays;
  w->hit = olx_bvh_intersect(c->surfels->scene->bvh, &ray);
}

// Adds the light that surfaces near lamps send to the start of a ray, times `factor`.
static void add_near_lamps(const cast_job *c, const olx_surface *surface, float factor, olx_sampler *sampler,
                           ray_end *end) {
  const olx_near_lamps *lamps = &c->surfels->lamps;
  if (lamps->count == 0) return;
  end->needs |= lights_needed | lamps->needs;
  const olx_vec3 irradiance = olx_lamp_irradiance(lamps, c->surfels->scene, surface, sampler, &end->cast);
  add_light(end, 1, olx_scale(irradiance, factor / OLX_PI));
}

// Returns the radii of lamps whose direct light the end of a ray leaves out, because points near the lamps stand for
// it.
// A mirror reflects no light of points, but the rays that it reflects find their surfaces.
static const float *dark_of(const cast_job *c, const way *w) {
  return w->chain > 0 && !w->lit && w->lobe.pdf <= 0.0f ? NULL : c->surfels->lamps.radius;
}

static olx_vec3 direct_irradiance(const cast_job *c, way *w, const olx_surface *surface, uint64_t *rays) {
  return olx_direct_irradiance_but(c->surfels->scene, surface, dark_of(c, w), &w->sampler, rays);
}

// Adds the emission that the specular lobe, chosen with probability `share`, reflects, and continues the path; returns
// false when the ray brings nothing.
static bool pass_specular(const cast_job *c, way *w, const olx_shading *shading, float share, ray_end *end,
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
// indirect light.
static bool pass_diffuse(const cast_job *c, way *w, const olx_surface *surface, olx_vec3 weight, ray_end *end,
                         uint64_t *rays) {
  end->needs |= lights_needed | UINT64_C(1) << OLX_INPUT_SURFELS;
  const olx_vec3 irradiance = direct_irradiance(c, w, surface, rays);
  add_light(end, w->chain + 1, olx_scale(olx_mul(weight, irradiance), 1.0f / OLX_PI));
  end->link = no_link;
  if (w->chain + 1 == OLX_CHAIN_MOST) return false;
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
static bool end_way(const cast_job *c, way *w, const olx_surface *surface, olx_vec3 weight, ray_end *end,
                    uint64_t *rays) {
  end->link = link_to(c, surface, &w->hit, weight, w->chain, w->distance, end);
  if (is_unserved(end)) return c->lists;
  if (!(end->link.end & OLX_LINK_LIT) || !olx_link_brings_light(&end->link)) return true;
  end->needs |= lights_needed;
  const olx_vec3 irradiance = direct_irradiance(c, w, surface, rays);
  add_light(end, w->chain + 1, olx_scale(olx_mul(weight, irradiance), 1.0f / OLX_PI));
  return true;
}

// Follows a path from a surface until it ends at a surfel, at the sky, or brings nothing. At a surface with both lobes
// it chooses one at random.
static void follow(const cast_job *c, way *w, ray_end *end, uint64_t *rays) {
  const olx_scene *scene = c->surfels->scene;
  while (w->chain < OLX_CHAIN_MOST) {
    if (w->hit.triangle == OLX_NO_HIT) {
      end->needs |= lights_needed;
      if (!w->lit) add_light(end, w->chain, olx_mul(w->throughput, olx_sky_found(scene, &w->lobe)));
      return;
    }
    const olx_surface surface = olx_surface_at(scene, &w->hit, w->lobe.direction);
    end->needs |= olx_input_of_material(surface.material) | (olx_max3(surface.emission) > 0.0f ? lights_needed : 0);
    if (!w->lit) {
      add_light(end, w->chain, olx_mul(w->throughput, olx_emission_found(scene, &surface, w->origin, &w->lobe)));
    }
    olx_shading shading = olx_shading_make(&surface, w->lobe.direction);
    shading.dark = dark_of(c, w);
    shading.least_alpha = OLX_LEAST_LAMP_ALPHA;
    const float share = shading.has_specular ? shading.specular_share : 0.0f;
    if (share <= 0.0f || (shading.has_diffuse && olx_sampler_next(&w->sampler) >= share)) {
      const olx_vec3 weight = olx_scale(olx_mul(w->throughput, shading.diffuse), 1.0f / (1.0f - share));
      if (end_way(c, w, &surface, weight, end, rays) || !pass_diffuse(c, w, &surface, weight, end, rays)) return;
    } else if (!pass_specular(c, w, &shading, share, end, rays)) {
      return;
    }
  }
}

// How the rays of a surface are drawn: by a pool's density, or evenly without one.
typedef struct ray_plan {
  const olx_ray_pool *pool;
  float factor; // factor on what all rays bring
  uint32_t seed;
} ray_plan;

// Draws a ray about the shading normal, cosine-distributed or by the plan's density, and the factor on the light that
// it brings; returns false when the ray lies below the surface and brings nothing.
static bool make_ray(const olx_surface *surface, const ray_plan *plan, uint32_t index, olx_ray *ray, float *factor) {
  olx_vec2 point = olx_stratified2(index, plan->seed);
  float density = 1.0f;
  if (plan->pool) point = olx_guide_warp(plan->pool, point, &density);
  *factor = plan->factor / density;
  const olx_vec3 local = olx_sample_cosine(point);
  const olx_vec3 direction = olx_normalize(olx_from_basis(local, surface->shading_normal));
  *ray = olx_surface_ray(surface, direction, INFINITY);
  if (local.z > 0.0f && olx_dot(direction, surface->geometric_normal) > 0.0f) return true;
  ray->t_max = -1.0f;
  return false;
}

// Adds the light that a ray brings without its link, and returns its luminance times pi.
static float add_fixed(olx_fixed_light *fixed, const ray_end *end) {
  float luminance = 0.0f;
  for (uint32_t i = 0; i < OLX_CHAIN_MOST; i++) {
    fixed->sum[i] = olx_madd(fixed->sum[i], end->fixed[i], OLX_PI);
    luminance += OLX_PI * olx_luminance(end->fixed[i]);
  }
  fixed->square += luminance * luminance;
  return luminance;
}

// Begins the record of a ray with the way to its hit; a ray that brings nothing is not cast, but begins in a brick.
static void log_first(olx_ray_log *log, const olx_ray *ray, const olx_ray_hit *hit) {
  log->crossed = (olx_brick_set){0};
  const float length = !hit ? 0.0f : hit->triangle == OLX_NO_HIT ? INFINITY : hit->t;
  olx_ray_log_add(log, ray->origin, ray->direction, length);
}

// Casts up to OLX_LINK_PACKET rays of a surface, from index `first` on, but for those whose ends are known, and records
// what each brings. A ray's hit does not depend on which other rays are cast with it.
static void cast_packet(cast_job *c, const olx_surface *surface, const ray_plan *plan, uint32_t first, uint32_t count,
                        ray_end *ends) {
  olx_ray rays[OLX_LINK_PACKET] = {0};
  olx_ray_hit hits[OLX_LINK_PACKET];
  bool valid[OLX_LINK_PACKET];
  float factors[OLX_LINK_PACKET];
  const uint32_t chain_seed = olx_hash2(plan->seed, SALT_CHAIN), lamp_seed = olx_hash2(plan->seed, SALT_LAMPS);
  uint32_t known = 0;
  for (uint32_t i = 0; i < count; i++) known += ends[i].known;
  if (known == count) return;
  for (uint32_t i = 0; i < count; i++) {
    valid[i] = make_ray(surface, plan, first + i, &rays[i], &factors[i]);
    if (ends[i].known) rays[i].t_max = -1.0f;
  }
  olx_bvh_intersect_many(c->surfels->scene->bvh, rays, count, false, hits);
  for (uint32_t i = 0; i < count; i++) {
    if (ends[i].known) continue;
    ends[i] = (ray_end){.link = no_link, .cast = 1};
    if (c->log) log_first(c->log, &rays[i], valid[i] ? &hits[i] : NULL);
    olx_sampler lamps = {.seed = lamp_seed, .index = first + i};
    add_near_lamps(c, surface, plan->factor, &lamps, &ends[i]);
    if (valid[i]) {
      way w = {.lobe = {.direction = rays[i].direction},
               .origin = rays[i].origin,
               .throughput = olx_splat(factors[i]),
               .hit = hits[i],
               .distance = hits[i].t,
               .sampler = {.seed = chain_seed, .index = first + i}};
      follow(c, &w, &ends[i], &ends[i].cast);
    }
    if (c->log) ends[i].crossed = c->log->crossed;
  }
}

static uint32_t seed_of(const olx_light_surfels *s, uint32_t surfel) {
  const uint64_t cell = s->surfels[surfel].cell;
  return olx_hash3(s->seed ^ (uint32_t)cell, (uint32_t)(cell >> 32), SALT_RAY);
}

void olx_link_go_on(const olx_light_surfels *surfels, olx_link_batch *batch, size_t i, const olx_surface *surface,
                    olx_fixed_light *fixed, uint64_t *rays) {
  const cast_job c = {.surfels = surfels};
  const uint32_t surfel = olx_link_surfel(batch, (uint32_t)(i / batch->rays)), ray = (uint32_t)(i % batch->rays);
  olx_link *link = &batch->links[i];
  way w = {.lobe = {.pdf = 1.0f}, // which lobe passed the ray on is not stored: it is taken for none of a mirror
           .chain = olx_link_chain(link),
           .sampler = {.seed = olx_hash2(seed_of(surfels, surfel), SALT_UNSERVED), .index = ray}};
  ray_end end = {.link = no_link};
  if (pass_diffuse(&c, &w, surface, olx_rgb9e5_unpack(link->weight), &end, rays)) follow(&c, &w, &end, rays);
  const float luminance = add_fixed(&fixed[surfel], &end);
  if (batch->fixed) batch->fixed[i] += luminance;
  *link = end.link;
}

olx_vec2 olx_links_ray_point(const olx_light_surfels *surfels, uint32_t surfel, uint32_t ray) {
  return olx_stratified2(ray, seed_of(surfels, surfel));
}

static ray_plan plan_of(const olx_light_surfels *s, const olx_link_batch *batch, uint32_t surfel) {
  return (ray_plan){.pool = batch->guide ? &batch->guide->pools[batch->guide->pool_of[surfel]] : NULL,
                    .factor = olx_link_worth(batch, surfel),
                    .seed = seed_of(s, surfel)};
}

// Returns a hash of everything that the rays of a surfel are drawn from, but for the surfel itself.
static uint64_t check_of(const cast_job *c, const ray_plan *plan) {
  if (!c->keeping.kept) return 0;
  const uint64_t numbers[] = {plan->pool ? olx_content_hash(plan->pool, sizeof *plan->pool) : 0,
                              (uint64_t)plan->seed << 1 | (c->lists != NULL)};
  return olx_content_hash(numbers, sizeof numbers);
}

static uint64_t check_of_packet(uint64_t check, uint32_t first, uint32_t count) {
  const uint64_t numbers[] = {check, (uint64_t)first << 32 | count};
  return olx_content_hash(numbers, sizeof numbers);
}

// Fills in the ends of the packet's rays that were cast for another scene and still hold.
static void take_former(const cast_job *c, uint32_t surfel, uint32_t packet, uint64_t check, uint32_t count,
                        ray_end *ends) {
  olx_former_packet former = olx_former_rays_find(c->keeping.former, surfel, packet, check);
  uint64_t reused = 0;
  for (uint32_t i = 0; former.unit && i < count; i++) {
    const olx_former_ray ray = olx_former_packet_next(&former);
    if (!ray.holds) continue;
    ends[i] = (ray_end){.link = ray.link, .needs = ray.kept.needs, .cast = ray.kept.cast, .known = true};
    ends[i].crossed = ray.kept.crossed;
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) ends[i].fixed[k] = ray.kept.fixed[k];
    if (is_unserved(&ends[i])) ends[i].point = *ray.point;
    reused += ray.kept.cast;
  }
  if (reused) atomic_fetch_add_explicit(c->keeping.reused, reused, memory_order_relaxed);
}

static void keep_end(const cast_job *c, size_t at, const ray_end *end) {
  olx_kept_ray *ray = &c->keeping.kept->rays[at];
  ray->needs = end->needs;
  ray->crossed = end->crossed;
  ray->cast = (uint32_t)end->cast;
  for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) ray->fixed[k] = end->fixed[k];
}

static void cast_surfel(cast_job *c, uint32_t n, uint32_t job) {
  const olx_light_surfels *s = c->surfels;
  olx_link_batch *batch = c->batch;
  const uint32_t number = olx_link_surfel(batch, n);
  const olx_light_surfel *surfel = &s->surfels[number];
  const olx_surface surface = olx_surface_point_surface(s->scene, &surfel->point);
  const ray_plan plan = plan_of(s, batch, number);
  const uint64_t check = check_of(c, &plan);
  const uint32_t packets = (batch->rays + OLX_LINK_PACKET - 1) / OLX_LINK_PACKET;
  for (uint32_t k = 0; k < packets; k++) {
    const uint32_t first = k * OLX_LINK_PACKET, left = batch->rays - first;
    const uint32_t count = left < OLX_LINK_PACKET ? left : OLX_LINK_PACKET;
    ray_end ends[OLX_LINK_PACKET];
    for (uint32_t i = 0; i < count; i++) ends[i] = (ray_end){.link = no_link};
    if (c->keeping.kept) {
      const uint64_t own = check_of_packet(check, batch->first_ray + first, count);
      c->keeping.kept->checks[(size_t)n * packets + k] = own;
      take_former(c, number, k, own, count, ends);
    }
    cast_packet(c, &surface, &plan, batch->first_ray + first, count, ends);
    for (uint32_t i = 0; i < count; i++) {
      const size_t at = (size_t)n * batch->rays + first + i;
      batch->links[at] = ends[i].link;
      const float fixed = add_fixed(&c->fixed[number], &ends[i]);
      if (batch->fixed) batch->fixed[at] = fixed;
      if (c->lists && is_unserved(&ends[i])) add_point(c, &c->lists[job], &ends[i].point);
      c->rays[job] += ends[i].cast;
      if (c->keeping.kept) keep_end(c, at, &ends[i]);
    }
  }
}

static olx_vec3 gathered(const ray_end *end, const olx_passed_light *light) {
  olx_vec3 sum = {0};
  for (uint32_t k = 0; k < OLX_CHAIN_MOST && k < light->bounces; k++) sum = olx_madd(sum, end->fixed[k], OLX_PI);
  if (olx_link_brings_light(&end->link)) {
    const uint32_t at = olx_link_end(&end->link);
    const olx_vec3 passed = end->link.end & OLX_LINK_LIT ? olx_sub(light->all[at], light->direct[at]) : light->all[at];
    sum = olx_add(sum, olx_mul(olx_rgb9e5_unpack(end->link.weight), passed));
  }
  const float luminance = olx_luminance(sum);
  return luminance > light->most ? olx_scale(sum, light->most / luminance) : sum;
}

// Returns a hash of everything that the rays of a gather are drawn from.
static uint64_t check_of_gather(const olx_surface *surface, const ray_plan *plan) {
  const uint64_t numbers[] = {plan->pool ? olx_content_hash(plan->pool, sizeof *plan->pool) : 0,
                              (uint64_t)surface->triangle << 32 | plan->seed};
  const olx_vec3 place[] = {surface->position, surface->geometric_normal, surface->shading_normal,
                            olx_splat(surface->epsilon)};
  const uint64_t hashes[] = {olx_content_hash(numbers, sizeof numbers), olx_content_hash(place, sizeof place)};
  return olx_content_hash(hashes, sizeof hashes);
}

// Returns whether a ray of a gather still holds, and gives its link the surfel's number of now.
static bool still_holds(const olx_gather_row *row, const olx_gather_kind *kind, const olx_light_surfels *surfels,
                        olx_link *link) {
  if (kind->needs & row->changed || olx_link_end(link) == OLX_LINK_UNSERVED) return false;
  if (row->earlier && olx_brick_sets_meet(&kind->crossed, &row->earlier->changed)) return false;
  return olx_link_still_ends(link, NULL, row->earlier, surfels);
}

// Fills in the ends of rays that were cast for another scene and still hold.
static void take_gather(olx_gather_row *row, uint64_t check, const olx_light_surfels *surfels,
                        ray_end ends[OLX_GATHER_RAYS]) {
  olx_kept_gather former;
  for (uint32_t i = 0; i < OLX_GATHER_RAYS; i++) ends[i] = (ray_end){.link = no_link};
  olx_gather_kind table[OLX_GATHER_RAYS];
  if (!row || !olx_gather_row_find(row, check, &former) || !olx_gather_read_kinds(&former, table)) return;
  for (uint32_t i = 0; i < OLX_GATHER_RAYS; i++) {
    olx_link link = former.links[i];
    if (former.kinds[i] >= former.kind_count) continue;
    const olx_gather_kind *kind = &table[former.kinds[i]];
    if (!still_holds(row, kind, surfels, &link)) continue;
    ends[i] = (ray_end){.link = link, .needs = kind->needs, .crossed = kind->crossed, .known = true};
    row->reused++;
  }
  for (uint32_t i = 0; i < former.light_count; i++) {
    const olx_gather_light *light = &former.lights[i];
    if (light->ray < OLX_GATHER_RAYS && light->surfaces < OLX_CHAIN_MOST && ends[light->ray].known) {
      ends[light->ray].fixed[light->surfaces] = light->light;
    }
  }
}

static uint8_t kind_of(olx_gather_kind table[OLX_GATHER_RAYS], uint32_t *count, const ray_end *end) {
  const olx_gather_kind wanted = {end->needs, end->crossed};
  uint32_t i = 0;
  while (i < *count && memcmp(&table[i], &wanted, sizeof wanted) != 0) i++;
  if (i == *count) table[(*count)++] = wanted;
  return (uint8_t)i;
}

static void keep_gather(olx_gather_row *row, uint64_t check, const ray_end ends[OLX_GATHER_RAYS]) {
  olx_link links[OLX_GATHER_RAYS];
  olx_gather_kind table[OLX_GATHER_RAYS];
  uint8_t kinds[OLX_GATHER_RAYS];
  olx_gather_light lights[OLX_GATHER_RAYS * OLX_CHAIN_MOST];
  uint64_t needs[OLX_GATHER_RAYS];
  uint8_t bricks[OLX_GATHER_RAYS * OLX_KIND_BYTES];
  olx_kept_gather kept = {.links = links, .kinds = kinds, .needs = needs, .bricks = bricks, .lights = lights};
  for (uint32_t i = 0; i < OLX_GATHER_RAYS; i++) {
    links[i] = ends[i].link;
    kinds[i] = kind_of(table, &kept.kind_count, &ends[i]);
    for (uint32_t k = 0; k < OLX_CHAIN_MOST; k++) {
      const olx_vec3 light = ends[i].fixed[k];
      if (olx_max3(light) == 0.0f) continue;
      lights[kept.light_count++] = (olx_gather_light){(uint16_t)i, (uint16_t)k, light};
    }
  }
  for (uint32_t i = 0; i < kept.kind_count; i++) {
    needs[i] = table[i].needs;
    kept.brick_count += olx_gather_write_bricks(&table[i].crossed, bricks + kept.brick_count, &needs[i]);
  }
  olx_gather_row_keep(row, check, &kept);
}

olx_vec3 olx_links_gather(const olx_light_surfels *surfels, const olx_surface *surface, const olx_ray_pool *pool,
                          uint32_t seed, const olx_passed_light *light, olx_gather_row *row) {
  watched_surfels watched;
  cast_job c = {.surfels = surfels};
  const ray_plan plan = {.pool = pool, .factor = 1.0f, .seed = seed};
  const uint64_t check = row ? check_of_gather(surface, &plan) : 0;
  ray_end ends[OLX_GATHER_RAYS];
  olx_vec3 sum = {0};
  if (row) watch_job(&c, &watched);
  take_gather(row, check, surfels, ends);
  for (uint32_t first = 0; first < OLX_GATHER_RAYS; first += OLX_LINK_PACKET) {
    cast_packet(&c, surface, &plan, first, OLX_LINK_PACKET, ends + first);
  }
  for (uint32_t i = 0; i < OLX_GATHER_RAYS; i++) sum = olx_add(sum, gathered(&ends[i], light));
  if (row) keep_gather(row, check, ends);
  if (row) row->rays += OLX_GATHER_RAYS;
  return olx_scale(sum, 1.0f / OLX_GATHER_RAYS);
}

olx_vec3 olx_links_gather_one(const olx_light_surfels *surfels, const olx_surface *surface, const olx_ray_pool *pool,
                              uint32_t seed, const olx_passed_light *light) {
  cast_job c = {.surfels = surfels};
  const ray_plan plan = {.pool = pool, .factor = 1.0f, .seed = seed};
  ray_end end = {.link = no_link};
  cast_packet(&c, surface, &plan, 0, 1, &end);
  return gathered(&end, light);
}

olx_ray_sum olx_links_add_up(const olx_light_surfels *surfels, uint32_t surfel, const olx_ray_guide *guide,
                             uint32_t first, uint32_t count, const olx_passed_light *light, uint64_t *rays) {
  cast_job c = {.surfels = surfels};
  const olx_link_batch batch = {.guide = guide};
  const ray_plan plan = plan_of(surfels, &batch, surfel);
  const olx_surface surface = olx_surface_point_surface(surfels->scene, &surfels->surfels[surfel].point);
  olx_ray_sum sum = {.worth = plan.factor * (float)count};
  double mean = 0.0, square = 0.0;
  for (uint32_t done = 0; done < count; done += OLX_LINK_PACKET) {
    const uint32_t packet = count - done < OLX_LINK_PACKET ? count - done : OLX_LINK_PACKET;
    ray_end ends[OLX_LINK_PACKET] = {0};
    cast_packet(&c, &surface, &plan, first + done, packet, ends);
    for (uint32_t i = 0; i < packet; i++) {
      const olx_vec3 brought = gathered(&ends[i], light);
      const double luminance = (double)olx_luminance(brought);
      sum.light = olx_add(sum.light, brought);
      mean += luminance / count;
      square += luminance * luminance;
      *rays += ends[i].cast;
    }
  }
  sum.squares = (float)fmax(0.0, square - count * mean * mean);
  return sum;
}

static void cast_some(void *user, uint32_t job) {
  cast_job c = *(const cast_job *)user;
  watched_surfels watched;
  const uint32_t first = job * SURFELS_PER_JOB;
  const uint32_t end = first + SURFELS_PER_JOB < c.batch->count ? first + SURFELS_PER_JOB : c.batch->count;
  if (c.keeping.kept) watch_job(&c, &watched);
  for (uint32_t n = first; n < end; n++) cast_surfel(&c, n, job);
  olx_link_batch_rest(c.batch, first, end);
}

// Concatenates the lists of jobs, in the order of jobs.
static olx_result join_lists(const olx_point_list *lists, uint32_t jobs, olx_point_list *all) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < jobs; i++) count += lists[i].count;
  *all = (olx_point_list){.points = olx_allocate(count, sizeof *all->points), .capacity = count};
  if (!all->points) return olx_fail(OLX_ERROR_MEMORY, "light: out of memory for %u points of surfaces", count);
  for (uint32_t i = 0; i < jobs; i++) {
    for (uint32_t k = 0; k < lists[i].count; k++) all->points[all->count++] = lists[i].points[k];
  }
  return OLX_OK;
}

olx_result olx_links_cast(const olx_light_surfels *surfels, olx_link_batch *batch, olx_fixed_light *fixed,
                          olx_point_list *unserved, const olx_cast_keeping *keeping, uint64_t *rays) {
  const uint32_t jobs = (batch->count + SURFELS_PER_JOB - 1) / SURFELS_PER_JOB;
  atomic_bool out_of_memory = false;
  cast_job c = {.surfels = surfels,
                .batch = batch,
                .out_of_memory = &out_of_memory,
                .fixed = fixed,
                .lists = unserved ? olx_allocate_zero(jobs, sizeof *c.lists) : NULL,
                .rays = olx_allocate_zero(jobs, sizeof *c.rays)};
  if (keeping) c.keeping = *keeping;
  olx_result result = OLX_OK;
  if (!c.rays || (unserved && !c.lists)) result = olx_fail(OLX_ERROR_MEMORY, "light: out of memory for casting rays");
  if (result == OLX_OK) result = olx_parallel_for(jobs, surfels->threads, cast_some, &c, surfels->task, 0);
  if (result == OLX_OK && atomic_load(&out_of_memory)) {
    result = olx_fail(OLX_ERROR_MEMORY, "light: out of memory for points of surfaces");
  }
  if (result == OLX_OK && unserved) result = join_lists(c.lists, jobs, unserved);
  for (uint32_t i = 0; c.rays && i < jobs; i++) *rays += c.rays[i];
  for (uint32_t i = 0; c.lists && i < jobs; i++) olx_release(c.lists[i].points);
  olx_release(c.lists);
  olx_release(c.rays);
  return result;
}
