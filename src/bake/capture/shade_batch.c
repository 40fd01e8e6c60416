// Lights many surface points at once: direct light by shadow rays to drawn emitters, diffuse light from irradiance
// maps, and specular reflections by rays that are cast in packets.
#include "bake/capture/shade_batch.h"

#include "bake/capture/texel_radiance.h"
#include "core/result.h"
#include "core/sampling.h"
#include "scene/bvh.h"

// Salts of the hashes from which independent random numbers are drawn.
enum {
  SALT_LIGHT = 0x1000,
  SALT_PICK = 0x2000,
  SALT_LOBE = 0x3000,
  SALT_SURVIVE = 0x4000,
  SALT_COSINE = 0x5000,
  SALT_DARK = 0x7000,
  SALT_BAKE = 0x42414B45
};

// One point in SCOUT_SHARE decides whether a tile sees a light; where it seems not to, one in DARK_SHARE sends shadow
// rays.
enum { SCOUT_SHARE = 4, DARK_SHARE = 8 };
#define NO_RAY UINT32_MAX

// A light's density over solid angle, in units of the most that the diffuse lobe has, beyond which rays of that lobe
// need not look for it, and beyond which few do.
static const float small_light = 8.0f, large_light = 1.0f;
static const float few_scattered = 0.25f;

static void bound_emitters(olx_shade_context *context) {
  const olx_scene *scene = context->scene;
  context->least_light_pdf = INFINITY;
  context->lights_min = olx_splat(INFINITY);
  context->lights_max = olx_splat(-INFINITY);
  for (uint32_t t = 0; t < scene->triangle_count; t++) {
    const float pdf = olx_emitters_area_pdf(scene, t);
    if (pdf <= 0.0f) continue;
    context->least_light_pdf = olx_min(context->least_light_pdf, pdf);
    for (uint32_t i = 0; i < 3; i++) {
      const olx_vec3 p = scene->positions[scene->indices[3 * (size_t)t + i]];
      context->lights_min = olx_min_each(context->lights_min, p);
      context->lights_max = olx_max_each(context->lights_max, p);
    }
  }
}

float olx_shade_scattering(const olx_shade_context *context, const olx_surface *surface) {
  if (!context->reflected_lights) return 0.0f;
  if (olx_environment_lit(context->scene)) return 1.0f;
  if (context->least_light_pdf == INFINITY) return 0.0f;
  const olx_vec3 p = surface->position;
  const olx_vec3 away = olx_sub(p, olx_min_each(olx_max_each(p, context->lights_min), context->lights_max));
  const float density = olx_dot(away, away) * context->least_light_pdf * OLX_PI;
  return density > small_light ? 0.0f : density > large_light ? few_scattered : 1.0f;
}

void olx_shade_context_begin(olx_shade_context *context, const olx_scene *scene, uint32_t seed) {
  *context = (olx_shade_context){.scene = scene,
                                 .sample = olx_sample_settings_default(),
                                 .seed = seed ? olx_hash2(seed, SALT_BAKE) : 0,
                                 .group_count = olx_emitters_group_count(scene)};
  for (uint32_t g = 0; g < context->group_count; g++) {
    if (olx_emitters_group_varies(scene, g)) context->reflected_lights = true;
  }
  bound_emitters(context);
  olx_scratch_pool_begin(&context->pool, sizeof(olx_shade_scratch));
  atomic_init(&context->rays, 0);
  atomic_init(&context->out_of_memory, false);
}

void olx_shade_context_end(olx_shade_context *context) { olx_scratch_pool_end(&context->pool); }

olx_shade_scratch *olx_shade_scratch_take(olx_shade_context *context) {
  olx_shade_scratch *scratch = olx_scratch_take(&context->pool);
  if (!scratch) atomic_store(&context->out_of_memory, true);
  return scratch;
}

void olx_shade_scratch_give(olx_shade_context *context, olx_shade_scratch *scratch) {
  olx_scratch_give(&context->pool, scratch);
}

olx_result olx_shade_check_memory(olx_shade_context *context) {
  if (!atomic_load(&context->out_of_memory)) return OLX_OK;
  return olx_fail(OLX_ERROR_MEMORY, "bake: out of memory for the work of a thread");
}

void olx_shade_batch_begin(olx_shade_batch *batch, uint32_t light_samples) {
  batch->count = 0;
  batch->light_samples = light_samples;
  batch->sparing = false;
  batch->averages_lobes = false;
}

// Lobes wider than OLX_SHARP_ALPHA contribute their average over views to light that is looked at from elsewhere.
void olx_shade_refresh(olx_shade_batch *batch, uint32_t i) {
  const olx_bsdf *b = &batch->surface[i].bsdf;
  const bool matte = batch->averages_lobes && b->alpha > OLX_SHARP_ALPHA;
  const float cosine = olx_dot(batch->surface[i].shading_normal, batch->view[i]);
  batch->reflects[i] = olx_bsdf_has_specular(b) && !matte;
  batch->diffuse[i] = olx_scale(matte ? olx_bsdf_matte(b).albedo : olx_bsdf_diffuse(b, cosine), 1.0f / OLX_PI);
}

uint32_t olx_shade_append(olx_shade_context *context, olx_shade_batch *batch, const olx_ray_hit *hit,
                          olx_vec3 direction, uint32_t seed, uint32_t sequence) {
  const uint32_t i = batch->count++;
  batch->surface[i] = olx_surface_near(context->scene, hit, direction, i > 0 ? &batch->surface[i - 1] : NULL);
  batch->view[i] = olx_negate(direction);
  batch->seed[i] = olx_shade_key(context, seed);
  batch->sequence[i] = sequence;
  olx_shade_refresh(batch, i);
  batch->radiance[i] = olx_splat(0.0f);
  batch->scattered[i] = 0.0f;
  batch->lit_like[i] = i;
  return i;
}

// Paths that carry this much always go on.
static const float full_survival = 0.25f;

static olx_vec3 to_local(olx_vec3 v, olx_vec3 tangent, olx_vec3 bitangent, olx_vec3 normal) {
  return olx_v3(olx_dot(v, tangent), olx_dot(v, bitangent), olx_dot(v, normal));
}

// Returns a shadow ray's share, by the balance heuristic, of light that a reflected ray drawn with density `pdf` can
// find too.
static float shadow_share(const olx_light_sample *light, uint32_t samples, float pdf) {
  const float density = light->pdf * (float)samples;
  return light->delta ? 1.0f : density / (density + pdf);
}

// Returns the light that an unoccluded sample sends to the eye.
static olx_vec3 reflected_light(const olx_shade_batch *batch, uint32_t i, const olx_light_sample *light,
                                uint32_t samples) {
  const olx_surface *s = &batch->surface[i];
  const float cosine = olx_dot(s->shading_normal, light->direction);
  const float diffuse_share = shadow_share(light, samples, batch->scattered[i] * cosine / OLX_PI);
  olx_vec3 sum = olx_scale(batch->diffuse[i], cosine * diffuse_share);
  if (batch->reflects[i] && s->bsdf.alpha > 0.0f) {
    olx_vec3 tangent, bitangent;
    olx_basis(s->shading_normal, &tangent, &bitangent);
    const olx_vec3 l = to_local(light->direction, tangent, bitangent, s->shading_normal);
    const olx_vec3 v = to_local(batch->view[i], tangent, bitangent, s->shading_normal);
    const float share = light->delta ? 1.0f : shadow_share(light, samples, olx_ggx_pdf(s->bsdf.alpha, v, l));
    sum = olx_madd(sum, olx_bsdf_specular(&s->bsdf, v, l), share);
  }
  return olx_mul(sum, olx_scale(light->emission, 1.0f / (float)samples));
}

// The rays of one batch towards one light group.
typedef struct light_rays {
  uint32_t group, samples; // the group's index; the number of shadow rays that a point sends to it
  bool varies;
  uint32_t count; // collected so far
  float gain;     // of what they bring
} light_rays;

// Shadow ray `sample` of point `i`.
static void collect_light(const olx_shade_context *context, olx_shade_scratch *scratch, const olx_shade_batch *batch,
                          light_rays *rays, uint32_t i, uint32_t sample) {
  const olx_surface *s = &batch->surface[i];
  olx_light_sample *light = &scratch->light[rays->count];
  olx_vec2 random = {0.5f, 0.5f};
  float pick = 0.5f;
  if (rays->varies) {
    const uint32_t index = batch->sequence[i] * rays->samples + sample;
    random = olx_stratified2(index, olx_hash2(batch->seed[i], SALT_LIGHT + rays->group));
    pick = olx_unit_float(index * 2654435769u + olx_hash2(batch->seed[i], SALT_PICK + rays->group));
  }
  if (!olx_emitters_sample(context->scene, rays->group, s->position, random, pick, light)) return;
  if (olx_dot(s->geometric_normal, light->direction) <= 0.0f) return;
  if (olx_dot(s->shading_normal, light->direction) <= 0.0f) return;
  scratch->rays[rays->count] = light->infinite ? olx_surface_ray(s, light->direction, INFINITY)
                                               : olx_surface_ray_to(s, light->target, light->epsilon_end);
  scratch->lit_point[rays->count++] = i;
}

// Casts the collected shadow rays, and returns how many met nothing.
static uint32_t cast_light(olx_shade_context *context, olx_shade_scratch *scratch, const light_rays *rays) {
  uint32_t lit = 0;
  olx_bvh_occluded_many(context->scene->light_bvh, scratch->rays, rays->count, !rays->varies, scratch->occluded);
  atomic_fetch_add_explicit(&context->rays, rays->count, memory_order_relaxed);
  for (uint32_t k = 0; k < rays->count; k++) lit += !scratch->occluded[k];
  return lit;
}

// Adds the light of unoccluded rays to the points that sent them.
static void add_light(olx_shade_scratch *scratch, olx_shade_batch *batch, light_rays *rays) {
  for (uint32_t k = 0; k < rays->count; k++) {
    if (scratch->occluded[k]) continue;
    const uint32_t i = scratch->lit_point[k];
    batch->radiance[i] = olx_add(batch->radiance[i], reflected_light(batch, i, &scratch->light[k], rays->samples));
  }
  rays->count = 0;
}

// Adds a light to all points of a batch, where points that are lit alike share the shadow ray of one of them.
static void add_shared_light(olx_shade_scratch *scratch, olx_shade_batch *batch, light_rays *rays) {
  for (uint32_t i = 0; i < batch->count; i++) scratch->ray_of[i] = NO_RAY;
  for (uint32_t k = 0; k < rays->count; k++) {
    if (!scratch->occluded[k]) scratch->ray_of[scratch->lit_point[k]] = k;
  }
  for (uint32_t i = 0; i < batch->count; i++) {
    const uint32_t k = scratch->ray_of[batch->lit_like[i]];
    if (k == NO_RAY || olx_dot(batch->surface[i].shading_normal, scratch->light[k].direction) <= 0.0f) continue;
    const olx_vec3 light = reflected_light(batch, i, &scratch->light[k], rays->samples);
    batch->radiance[i] = olx_madd(batch->radiance[i], light, rays->gain);
  }
  rays->count = 0;
}

// Casts the first rays of few points. When none of them finds the light, only a few other points send rays, which
// represent all of them.
static void add_light_sparingly(olx_shade_context *context, olx_shade_scratch *scratch, olx_shade_batch *batch,
                                light_rays *rays) {
  uint32_t number = 0;
  for (uint32_t i = 0; i < batch->count; i++) {
    if (batch->lit_like[i] == i && number++ % SCOUT_SHARE == 0) collect_light(context, scratch, batch, rays, i, 0);
  }
  const bool dark = cast_light(context, scratch, rays) == 0;
  add_shared_light(scratch, batch, rays);
  rays->gain = dark ? DARK_SHARE : 1.0f;
  for (uint32_t sample = 0; sample < rays->samples; sample++) {
    number = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
      if (batch->lit_like[i] != i || (number++ % SCOUT_SHARE == 0 && sample == 0)) continue;
      if (dark && olx_hash3(batch->seed[i], batch->sequence[i], SALT_DARK + rays->group) % DARK_SHARE != 0) continue;
      collect_light(context, scratch, batch, rays, i, sample);
    }
    cast_light(context, scratch, rays);
    add_shared_light(scratch, batch, rays);
  }
}

void olx_shade_direct(olx_shade_context *context, olx_shade_scratch *scratch, olx_shade_batch *batch) {
  for (uint32_t group = 0; group < context->group_count; group++) {
    const bool varies = olx_emitters_group_varies(context->scene, group);
    light_rays rays = {
        .group = group, .samples = varies ? batch->light_samples : 1, .varies = varies, .count = 0, .gain = 1.0f};
    if (varies && batch->sparing) {
      add_light_sparingly(context, scratch, batch, &rays);
      continue;
    }
    for (uint32_t sample = 0; sample < rays.samples; sample++) {
      for (uint32_t i = 0; i < batch->count; i++) collect_light(context, scratch, batch, &rays, i, sample);
      cast_light(context, scratch, &rays);
      add_light(scratch, batch, &rays);
    }
  }
}

static const olx_irradiance_source *irradiance_of(const olx_shade_context *context, uint32_t bounce) {
  return olx_bounce_source(context->bounces, bounce);
}

static olx_vec3 irradiance_at(const olx_shade_context *context, const olx_shade_batch *batch, uint32_t point,
                              uint32_t bounce) {
  const olx_surface *s = &batch->surface[point];
  if (context->light) return olx_scene_light_irradiance_before(context->light, s);
  return olx_irradiance_from(irradiance_of(context, bounce), &context->sample, s->position, s->shading_normal,
                             batch->view[point]);
}

void olx_shade_diffuse(olx_shade_context *context, olx_shade_batch *batch, uint32_t bounce) {
  const float share_squared = olx_square(context->share_distance);
  uint32_t last = UINT32_MAX;
  olx_vec3 irradiance = {0};
  for (uint32_t i = 0; i < batch->count; i++) {
    if (olx_max3(batch->diffuse[i]) <= 0.0f) continue;
    const olx_surface *s = &batch->surface[i];
    bool shared = false;
    if (last != UINT32_MAX && batch->seed[last] == batch->seed[i]) {
      const olx_vec3 step = olx_sub(s->position, batch->surface[last].position);
      shared = olx_dot(step, step) < share_squared &&
               olx_dot(s->shading_normal, batch->surface[last].shading_normal) > 0.995f;
    }
    if (!shared) {
      irradiance = irradiance_at(context, batch, i, bounce);
      last = i;
    }
    batch->radiance[i] = olx_add(batch->radiance[i], olx_mul(batch->diffuse[i], irradiance));
  }
}

// Draws a ray from the diffuse lobe; returns false when it lies below the surface.
static bool scatter_path(const olx_shade_batch *batch, olx_shade_path *path, olx_ray *ray) {
  const uint32_t i = path->from;
  const olx_surface *s = &batch->surface[i];
  const olx_vec3 local = olx_sample_cosine(olx_stratified2(batch->sequence[i], olx_hash2(batch->seed[i], SALT_COSINE)));
  path->direction = olx_normalize(olx_from_basis(local, s->shading_normal));
  if (local.z <= 0.0f || olx_dot(path->direction, s->geometric_normal) <= 0.0f) return false;
  path->pdf = batch->scattered[i] * local.z / OLX_PI;
  *ray = olx_surface_ray(s, path->direction, INFINITY);
  return true;
}

// Draws the ray by which a path continues from `batch`; returns false when the path ends there.
static bool reflect_path(const olx_shade_batch *batch, olx_shade_path *path, uint32_t depth, olx_ray *ray) {
  const uint32_t i = path->from;
  const olx_surface *s = &batch->surface[i];
  const uint32_t seed = olx_hash3(batch->seed[i], SALT_LOBE, depth);
  olx_vec3 tangent, bitangent;
  olx_basis(s->shading_normal, &tangent, &bitangent);
  const olx_vec3 view = to_local(batch->view[i], tangent, bitangent, s->shading_normal);
  float weight, half_cosine;
  const olx_vec3 local =
      olx_ggx_sample(s->bsdf.alpha, view, olx_stratified2(batch->sequence[i], seed), &weight, &half_cosine);
  if (weight <= 0.0f) return false;
  path->direction = olx_normalize(olx_add(olx_add(olx_scale(tangent, local.x), olx_scale(bitangent, local.y)),
                                          olx_scale(s->shading_normal, local.z)));
  if (olx_dot(path->direction, s->geometric_normal) <= 0.0f) return false;
  path->pdf = s->bsdf.alpha > 0.0f ? olx_ggx_pdf(s->bsdf.alpha, view, local) : 0.0f;
  path->throughput = olx_scale(olx_mul(path->throughput, olx_fresnel(&s->bsdf, half_cosine)), weight);
  if (depth > 1) {
    // Paths that carry little end at random, and the survivors carry their share.
    const float survival = olx_min(1.0f, olx_max3(path->throughput) / full_survival);
    if (olx_unit_float(olx_hash3(batch->seed[i] + batch->sequence[i], SALT_SURVIVE, depth)) >= survival) return false;
    path->throughput = olx_scale(path->throughput, 1.0f / survival);
  }
  *ray = olx_surface_ray(s, path->direction, INFINITY);
  return true;
}

// Returns the reflected ray's share of light that shadow rays sample too.
static float light_share(const olx_shade_batch *from, const olx_shade_path *path, float light_pdf) {
  return path->pdf > 0.0f ? path->pdf / (path->pdf + light_pdf * (float)from->light_samples) : 1.0f;
}

// Returns the light that a ray gets from the emitter or the sky at its end.
static olx_vec3 light_at_end(const olx_shade_context *context, const olx_shade_batch *from, const olx_shade_path *path,
                             const olx_surface *end) {
  if (!end) {
    const olx_vec3 sky = olx_environment_radiance(context->scene, path->direction);
    return olx_scale(sky, light_share(from, path, olx_environment_pdf(context->scene, path->direction)));
  }
  const float pdf = olx_emitters_surface_pdf(context->scene, end, from->surface[path->from].position, path->direction);
  return olx_scale(end->emission, light_share(from, path, pdf));
}

// Adds the light of emitters and of the sky at the ends of paths, when `lights` is set. When `surfaces` is set, appends
// the surfaces that reflections met to `to`, and their paths to `next`. Returns the number of these.
static uint32_t end_paths(olx_shade_context *context, olx_shade_scratch *scratch, const olx_shade_batch *from,
                          const olx_shade_path *paths, uint32_t count, bool lights, bool surfaces, olx_shade_batch *to,
                          olx_shade_path *next) {
  const olx_scene *scene = context->scene;
  olx_shade_batch_begin(to, 1);
  for (uint32_t k = 0; k < count; k++) {
    const olx_shade_path *path = &paths[k];
    const olx_ray_hit *hit = &scratch->hits[k];
    olx_surface met;
    const olx_surface *end = NULL;
    if (hit->triangle == OLX_NO_HIT) {
      if (!olx_environment_lit(scene)) continue;
    } else if (surfaces && !path->diffuse) {
      const uint32_t seed = olx_hash2(from->seed[path->from], from->sequence[path->from]);
      const uint32_t i = olx_shade_append(context, to, hit, path->direction, seed, 0);
      next[i] = *path;
      next[i].from = i;
      end = &to->surface[i];
    } else {
      if (!olx_hit_emits(scene, hit)) continue;
      met = olx_surface_at(scene, hit, path->direction);
      end = &met;
    }
    if (!lights || (end && olx_max3(end->emission) <= 0.0f)) continue;
    olx_vec3 light = olx_mul(path->throughput, light_at_end(context, from, path, end));
    if (path->diffuse) light = olx_mul(light, olx_scale(from->diffuse[path->from], OLX_PI));
    scratch->roots.radiance[path->root] = olx_add(scratch->roots.radiance[path->root], light);
  }
  return to->count;
}

void olx_shade_reflections(olx_shade_context *context, olx_shade_scratch *scratch, uint32_t count, uint32_t bounces,
                           uint32_t what) {
  olx_shade_batch *roots = &scratch->roots, *from = roots;
  for (uint32_t depth = 1; count > 0; depth++) {
    const bool lights = context->reflected_lights && (depth > 1 || (what & OLX_REFLECT_LIGHTS));
    const bool surfaces = (what & OLX_REFLECT_BOUNCES) && depth <= bounces;
    if (!lights && !surfaces) return;
    olx_shade_path *paths = scratch->paths[(depth - 1) & 1], *next = scratch->paths[depth & 1];
    olx_shade_batch *to = &scratch->reflected[depth & 1];
    uint32_t alive = 0;
    for (uint32_t k = 0; k < count; k++) {
      olx_ray *ray = &scratch->rays[alive];
      if (!(paths[k].diffuse ? scatter_path(from, &paths[k], ray) : reflect_path(from, &paths[k], depth, ray)))
        continue;
      paths[alive++] = paths[k];
    }
    olx_bvh_intersect_many(context->scene->light_bvh, scratch->rays, alive, false, scratch->hits);
    atomic_fetch_add_explicit(&context->rays, alive, memory_order_relaxed);
    count = end_paths(context, scratch, from, paths, alive, lights, surfaces, to, next);
    if (!surfaces) return;
    olx_shade_direct(context, scratch, to);
    if (bounces > depth) {
      const uint32_t earlier = depth + 1 < OLX_KEPT_BOUNCES ? depth + 1 : OLX_KEPT_BOUNCES;
      olx_shade_diffuse(context, to, bounces - earlier);
    }
    uint32_t specular = 0;
    for (uint32_t i = 0; i < count; i++) {
      olx_vec3 *sum = &roots->radiance[next[i].root];
      *sum = olx_add(*sum, olx_mul(next[i].throughput, to->radiance[i]));
      if (to->reflects[i]) next[specular++] = next[i];
    }
    count = specular;
    from = to;
  }
}
