// Checks and keeps the lights of a relighter, for its shadow rays and in the form that fields store, and finds the
// surfaces near its lamps.
#include "relight/relit_lights.h"

#include "core/hooks.h"
#include "core/result.h"
#include "field/texels.h"

#include <octalux/sample.h>

#include <string.h>

enum { LAMP_RAYS = 256, ALL_LAMP_RAYS = 4096, PACKET = 64 };

olx_result olx_relit_lights_create(const olx_relight_settings *settings, olx_relit_lights *lights) {
  *lights = (olx_relit_lights){.settings = settings,
                               .lights = olx_allocate_zero(OLX_RELIT_MOST_LIGHTS, sizeof *lights->lights),
                               .packed = olx_allocate_zero(OLX_RELIT_MOST_LIGHTS, sizeof *lights->packed)};
  return lights->lights && lights->packed ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for lights");
}

void olx_relit_lights_free(olx_relit_lights *lights) {
  olx_release(lights->lights);
  olx_release(lights->packed);
  olx_near_lamps_free(&lights->lamps);
}

static bool is_light(const olx_light *l) {
  const bool finite = olx_finite(l->emission) && olx_is_position(l->position) && olx_finite(l->direction) &&
                      olx_finite(l->edge_u) && olx_finite(l->edge_v);
  if ((uint32_t)l->type > OLX_LIGHT_SKY || !finite) return false;
  if (l->emission.x < 0.0f || l->emission.y < 0.0f || l->emission.z < 0.0f) return false;
  if (olx_max3(l->emission) > OLX_MOST_EMISSION) return false;
  if (l->type == OLX_LIGHT_SUN || l->type == OLX_LIGHT_SPOT) {
    if (fabsf(olx_length(l->direction) - 1.0f) > 1e-3f) return false;
  }
  return l->type != OLX_LIGHT_SPOT ||
         (l->cosine_outer >= -1.0f && l->cosine_outer <= l->cosine_inner && l->cosine_inner <= 1.0f);
}

static void add(olx_relit_lights *lights, const olx_light *light) {
  lights->lights[lights->count] = *light;
  lights->rays += olx_relit_samples(lights, lights->count++);
  if (olx_light_varies(light)) lights->varying = true;
  else lights->packed[lights->packed_count++] = olx_field_light_pack(light);
}

// ---- Surfaces near lamps

// Returns the surface that a ray from a lamp hits. Its position lies off the surface, like the start of a texel's rays.
static olx_lamp_sight sight_of(const olx_field *field, const olx_trace_hit *hit, olx_vec3 direction) {
  if (hit->status == OLX_TRACE_MISS) return (olx_lamp_sight){.distance = INFINITY};
  olx_lamp_sight sight = {.distance = hit->distance_metres,
                          .known = hit->status == OLX_TRACE_HIT && olx_dot(hit->normal, direction) < 0.0f};
  if (!sight.known) return sight;
  const float seen_from = olx_length(olx_sub(hit->position, field->probe_positions[hit->probe]));
  const olx_bsdf bsdf = olx_texel_material(field, hit->probe, hit->texel);
  sight.position = olx_madd(hit->position, hit->normal, OLX_OFF_SURFACE * seen_from);
  sight.normal = hit->normal;
  sight.albedo = olx_bsdf_lamp_albedo(&bsdf);
  return sight;
}

static void look(const void *user, olx_vec3 from, const olx_vec3 *directions, uint32_t count, olx_lamp_sight *sights) {
  const olx_field *field = user;
  const olx_sample_settings settings = olx_sample_settings_default();
  olx_vec3 origins[PACKET];
  olx_trace_hit hits[PACKET];
  for (uint32_t i = 0; i < PACKET; i++) origins[i] = from;
  for (uint32_t first = 0; first < count; first += PACKET) {
    const uint32_t size = count - first < PACKET ? count - first : PACKET;
    olx_trace_rays(field, &settings, size, origins, directions + first, INFINITY, hits);
    for (uint32_t i = 0; i < size; i++) sights[first + i] = sight_of(field, &hits[i], directions[first + i]);
  }
}

static olx_result find_lamps(const olx_field *field, const olx_light *lights, uint32_t count, olx_near_lamps *lamps) {
  const olx_lamp_view view = {.look = look, .user = field, .all_rays = ALL_LAMP_RAYS, .rays = LAMP_RAYS};
  return olx_near_lamps_create(lamps, lights, count, &view);
}

olx_result olx_relit_lights_set(olx_relit_lights *lights, const olx_field *field, const olx_light *given,
                                uint32_t count) {
  if (count > OLX_RELIT_MOST_LIGHTS) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: %u lights: at most %d", count, OLX_RELIT_MOST_LIGHTS);
  }
  for (uint32_t i = 0; i < count; i++) {
    if (is_light(&given[i])) continue;
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: light %u: its type, a number or a direction is out of range", i);
  }
  olx_near_lamps lamps;
  OLX_TRY(find_lamps(field, given, count, &lamps));
  olx_near_lamps_free(&lights->lamps);
  lights->lamps = lamps;
  lights->count = lights->packed_count = lights->rays = 0;
  lights->varying = false;
  for (uint32_t i = 0; i < count; i++) add(lights, &given[i]);
  return OLX_OK;
}
