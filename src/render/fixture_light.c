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

static olx_vec3 irradiance_at(const olx_field_light *light, olx_vec3 position, olx_vec3 normal) {
  const olx_light_arrival arrival = olx_field_light_arrival(light, position);
  return olx_scale(arrival.irradiance, olx_max(olx_dot(arrival.direction, normal), 0.0f));
}

// Returns the greatest share of its irradiance under a lamp that a surface can have as the mean of a disc. `height`: of
// the lamp, `distance`: of the lamp from the place of the irradiance, of which the share is taken.
static float share_of_disc(float radius, float height, float distance) {
  const float edge = sqrtf(olx_square(radius) + olx_square(height)); // from the lamp to a disc below it
  return olx_min(1.0f, 2.0f * distance * olx_square(distance) / (edge * (edge + height) * height));
}

// Returns about the most that the texel of a hit can hold, as the mean of its footprint, of the light of the lamps that
// are near.
static olx_vec3 light_nearby(const olx_render_context *context, const olx_trace_hit *hit) {
  olx_vec3 sum = olx_splat(0.0f);
  for (uint32_t i = 0; i < context->field->surfaces.light_count; i++) {
    const olx_field_light *light = &context->field->surfaces.lights[i];
    const float radius = context->lamps.radius[i];
    const olx_vec3 way = olx_sub(light->position, hit->position);
    const float height = olx_dot(way, hit->normal);
    if (!(radius > 0.0f) || !(olx_dot(way, way) < radius * radius) || !(height > 0.0f)) continue;
    const olx_vec3 along = olx_madd(way, hit->normal, -height);
    const float side = olx_length(along), step = olx_min(side, TEXEL_REACH * hit->footprint_metres);
    const olx_vec3 nearest = side > 0.0f ? olx_madd(hit->position, along, step / side) : hit->position;
    const float distance = sqrtf(olx_square(height) + olx_square(side - step));
    const float share = share_of_disc(hit->footprint_metres / sqrtf(OLX_PI), height, distance);
    sum = olx_madd(sum, irradiance_at(light, nearest, hit->normal), share);
  }
  return sum;
}

static float share_of(float part, float all) { return all > 0.0f ? part / all : 0.0f; }

void olx_fixtures_leave(const olx_render_context *context, olx_vec3 direction, float density, olx_trace_hit *hit) {
  const olx_near_lamps *lamps = &context->lamps;
  const olx_field *field = context->field;
  if (lamps->count == 0 || !(density > 0.0f) || hit->status == OLX_TRACE_MISS || hit->probe == UINT32_MAX) return;
  const float cosine = -olx_dot(direction, hit->normal);
  if (!(cosine > 0.0f)) return;
  const olx_vec3 stored = olx_texel_direct(field, hit->probe, hit->texel),
                 of_lamps = olx_min_each(light_nearby(context, hit), stored);
  if (!(olx_max3(of_lamps) > 0.0f)) return;
  const olx_bsdf bsdf = olx_texel_material(field, hit->probe, hit->texel);
  const float reflected = olx_luminance(olx_mul(olx_bsdf_lamp_albedo(&bsdf), of_lamps)) * (1.0f / OLX_PI);
  // Both densities are per square metre of the surface that the ray hit. That of points is the mean of the texel's
  // footprint, as its light is: at the hit itself it can be much lower, and the light of the whole footprint would stay.
  const float of_points = reflected / lamps->light, of_ray = density * cosine / olx_square(hit->distance_metres);
  const float taken = of_points / (of_points + of_ray);
  const olx_vec3 all =
      olx_madd(stored, olx_texel_indirect(field, hit->probe, hit->texel), 1.0f - field->info.bounces.last);
  const olx_vec3 share = {share_of(of_lamps.x, all.x), share_of(of_lamps.y, all.y), share_of(of_lamps.z, all.z)};
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
  return olx_bvh_occluded(context->scene->light_bvh, &ray) ? dark : light;
}
