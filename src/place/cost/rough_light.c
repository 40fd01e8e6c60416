// Lights surfaces by a few hundred patches without regard to what stands between: the mean of what the patches send,
// weighted by their form factors, so that an enclosure of even light is even.
#include "place/cost/rough_light.h"

#include "core/pack.h"
#include "field/texels.h"

enum {
  MOST_BOUNCES = 8, // further ones change little
  MIDDLE = OLX_TILE_VIEW_TEXELS / 2 + OLX_TILE_VIEW_SIDE / 2
};

static olx_vec3 direction_of(const olx_planned_maps *maps, const olx_tile_place *place, uint32_t i) {
  return olx_texel_direction(place->x + i % OLX_TILE_VIEW_SIDE, place->y + i / OLX_TILE_VIEW_SIDE, maps->size);
}

void olx_rough_light_add(olx_rough_light *light, const olx_planned_maps *maps, const olx_tile_place *place,
                         const olx_tile_view *view) {
  const olx_geometry_texel *middle = &view->geometry[MIDDLE];
  if (!(middle->distance < INFINITY)) return;
  const olx_vec3 direction = direction_of(maps, place, MIDDLE);
  const float cosine = olx_max(-olx_dot(direction, middle->normal), 0.05f);
  olx_rough_source source = {.position =
                                 olx_madd(olx_tile_probe_position(maps, place->probe), direction, middle->distance),
                             .normal = middle->normal,
                             .area = middle->distance * middle->distance / cosine};
  float count = 0.0f;
  for (uint32_t i = 0; i < OLX_TILE_VIEW_TEXELS; i++) {
    if (view->distance[i]) continue;
    const olx_bsdf bsdf = olx_material_unpack((olx_texel_material_codes){view->base[i], view->specular[i]});
    source.albedo = olx_add(source.albedo, bsdf.albedo);
    source.direct = olx_add(source.direct, olx_rgb9e5_unpack(view->direct[i]));
    count += 1.0f;
  }
  source.albedo = olx_scale(source.albedo, 1.0f / count);
  source.direct = olx_scale(source.direct, 1.0f / count);
  source.sent = olx_mul(source.albedo, source.direct);
  light->sources[light->count++] = source;
}

// Returns the irradiance at a point of a surface.
static olx_vec3 light_at(const olx_rough_light *light, olx_vec3 position, olx_vec3 normal) {
  olx_vec3 sum = {0};
  float weights = 0.0f;
  for (uint32_t i = 0; i < light->count; i++) {
    const olx_rough_source *s = &light->sources[i];
    const olx_vec3 way = olx_sub(s->position, position);
    const float square = olx_dot(way, way), here = olx_dot(way, normal), there = -olx_dot(way, s->normal);
    if (here <= 0.0f || there <= 0.0f) continue;
    const float weight = s->area * here * there / olx_square(square);
    sum = olx_madd(sum, s->sent, weight);
    weights += weight;
  }
  return weights > 0.0f ? olx_scale(sum, light->closed / weights) : sum;
}

void olx_rough_light_solve(olx_rough_light *light, uint32_t bounces) {
  olx_vec3 sent[OLX_ROUGH_SOURCES];
  for (uint32_t bounce = 0; bounce < bounces && bounce < MOST_BOUNCES; bounce++) {
    for (uint32_t i = 0; i < light->count; i++) {
      const olx_rough_source *s = &light->sources[i];
      sent[i] = olx_mul(s->albedo, olx_add(s->direct, light_at(light, s->position, s->normal)));
    }
    for (uint32_t i = 0; i < light->count; i++) light->sources[i].sent = sent[i];
  }
}

void olx_rough_light_set(const olx_rough_light *light, const olx_planned_maps *maps, const olx_tile_place *place,
                         olx_tile_view *view) {
  const olx_vec3 probe = olx_tile_probe_position(maps, place->probe);
  for (uint32_t i = 0; i < OLX_TILE_VIEW_TEXELS; i++) {
    const olx_geometry_texel *t = &view->geometry[i];
    if (view->distance[i]) continue;
    const olx_vec3 position = olx_madd(probe, direction_of(maps, place, i), t->distance);
    view->indirect[i] = olx_rgb9e5_pack(light_at(light, position, t->normal));
  }
}
