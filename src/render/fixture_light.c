// Weighs rays that end near lamps against points drawn from the lamps.
#include "render/fixture_light.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/lights.h"
#include "field/texels.h"
#include "light/surfels/lamp_light.h"
#include "scene/bvh.h"

// A texel's light is a mean over this many footprints to each side: blocks of texels are stored together.
static const float TEXEL_REACH = 2.0f;

olx_result olx_fixtures_find(olx_render_context *context) {
  const olx_field *field = context->field;
  const uint32_t count = field->surfaces.light_count;
  context->lamps = (olx_near_lamps){0};
  if (count == 0) return OLX_OK;
  olx_light *lights = olx_allocate_zero(count, sizeof *lights);
  if (!lights) return olx_fail(OLX_ERROR_MEMORY, "render: no memory for %u lights", count);
  for (uint32_t i = 0; i < count; i++) lights[i] = olx_field_light_unpack(&field->surfaces.lights[i]);
  const olx_result result = olx_lamp_light_create(&context->lamps, context->scene, lights, count);
  olx_release(lights);
  return result;
}

float olx_glossy_density(const olx_shading *s, olx_vec3 direction) {
  const float alpha = s->surface->bsdf.alpha;
  return alpha > 0.0f ? olx_ggx_pdf(alpha, s->view, olx_shading_local(s, direction)) : 0.0f;
}

// The irradiance of a hit by the lamps that it is near, without shadows.
typedef struct near_light {
  olx_vec3 here;
  olx_vec3 most; // about the most that the texel's mean can hold
} near_light;

static olx_vec3 irradiance_at(const olx_field_light *light, olx_vec3 position, olx_vec3 normal) {
  const olx_light_arrival arrival = olx_field_light_arrival(light, position);
  return olx_scale(arrival.irradiance, olx_max(olx_dot(arrival.direction, normal), 0.0f));
}

static near_light light_nearby(const olx_render_context *context, const olx_trace_hit *hit) {
  near_light sum = {.here = olx_splat(0.0f), .most = olx_splat(0.0f)};
  for (uint32_t i = 0; i < context->field->surfaces.light_count; i++) {
    const olx_field_light *light = &context->field->surfaces.lights[i];
    const float radius = context->lamps.radius[i];
    const olx_vec3 way = olx_sub(light->position, hit->position);
    if (!(radius > 0.0f) || !(olx_dot(way, way) < radius * radius)) continue;
    const olx_vec3 along = olx_madd(way, hit->normal, -olx_dot(way, hit->normal));
    const float side = olx_length(along), step = olx_min(side, TEXEL_REACH * hit->footprint_metres);
    const olx_vec3 nearest = side > 0.0f ? olx_madd(hit->position, along, step / side) : hit->position;
    sum.here = olx_add(sum.here, irradiance_at(light, hit->position, hit->normal));
    sum.most = olx_add(sum.most, irradiance_at(light, nearest, hit->normal));
  }
  return sum;
}

static float share_of(float most, float stored, float all) { return all > 0.0f ? olx_min(most, stored) / all : 0.0f; }

void olx_fixtures_leave(const olx_render_context *context, olx_vec3 direction, float density, olx_trace_hit *hit) {
  const olx_near_lamps *lamps = &context->lamps;
  const olx_field *field = context->field;
  if (lamps->count == 0 || !(density > 0.0f) || hit->status == OLX_TRACE_MISS || hit->probe == UINT32_MAX) return;
  const float cosine = -olx_dot(direction, hit->normal);
  if (!(cosine > 0.0f)) return;
  const near_light near = light_nearby(context, hit);
  if (!(olx_max3(near.here) > 0.0f)) return;
  const olx_bsdf bsdf = olx_texel_material(field, hit->probe, hit->texel);
  const float reflected = olx_luminance(olx_mul(olx_bsdf_matte(&bsdf).albedo, near.here)) * (1.0f / OLX_PI);
  // Both densities are per square metre of the surface that the ray hit.
  const float of_points = reflected / lamps->light, of_ray = density * cosine / olx_square(hit->distance_metres);
  const float taken = of_points / (of_points + of_ray);
  const olx_vec3 stored = olx_texel_direct(field, hit->probe, hit->texel);
  const olx_vec3 all =
      olx_madd(stored, olx_texel_indirect(field, hit->probe, hit->texel), 1.0f - field->info.bounces.last);
  const olx_vec3 share = {share_of(near.most.x, stored.x, all.x), share_of(near.most.y, stored.y, all.y),
                          share_of(near.most.z, stored.z, all.z)};
  const olx_vec3 from_lamps = olx_mul(olx_sub(hit->radiance, hit->lobe), share);
  hit->radiance = olx_madd(hit->radiance, from_lamps, -taken);
}

olx_vec3 olx_fixtures_light(const olx_render_context *context, const olx_shading *s, olx_gathering lobe, float random,
                            uint64_t *rays) {
  const olx_bsdf *bsdf = &s->surface->bsdf;
  const olx_vec3 dark = olx_splat(0.0f);
  if (context->lamps.count == 0 || (lobe == OLX_GATHER_SPECULAR && bsdf->alpha <= 0.0f)) return dark;
  float probability;
  const olx_lamp_point *p = olx_near_lamps_pick(&context->lamps, random, &probability);
  const olx_ray ray = olx_surface_ray_to(s->surface, p->position, 0.0f);
  const float cosine = -olx_dot(ray.direction, p->normal);
  const olx_vec3 local = olx_shading_local(s, ray.direction);
  if (!(cosine > 0.0f) || !(local.z > 0.0f) || !(olx_dot(ray.direction, s->surface->geometric_normal) > 0.0f)) {
    return dark;
  }
  const float diffuse = local.z * (1.0f / OLX_PI);
  const float density = lobe == OLX_GATHER_COSINE ? diffuse : olx_ggx_pdf(bsdf->alpha, s->view, local);
  const olx_vec3 reflected = lobe == OLX_GATHER_COSINE ? olx_splat(diffuse) : olx_bsdf_specular(bsdf, s->view, local);
  const float of_both = p->density * olx_square(ray.t_max) + density * cosine; // times the squared distance
  const olx_vec3 light = olx_scale(olx_mul(p->intensity, reflected), cosine * p->density / (probability * of_both));
  if (!(olx_max3(light) > 0.0f) || !olx_finite(light)) return dark;
  ++*rays;
  return olx_bvh_occluded(context->scene->bvh, &ray) ? dark : light;
}
