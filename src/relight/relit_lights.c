// Checks and keeps the lights of a relighter, for its shadow rays and in the form that fields store.
#include "relight/relit_lights.h"

#include "core/hooks.h"
#include "core/result.h"

#include <string.h>

olx_result olx_relit_lights_create(const olx_relight_settings *settings, olx_relit_lights *lights) {
  *lights = (olx_relit_lights){.settings = settings,
                               .lights = olx_allocate_zero(OLX_RELIT_MOST_LIGHTS, sizeof *lights->lights),
                               .packed = olx_allocate_zero(OLX_RELIT_MOST_LIGHTS, sizeof *lights->packed)};
  return lights->lights && lights->packed ? OLX_OK : olx_fail(OLX_ERROR_MEMORY, "relight: out of memory for lights");
}

void olx_relit_lights_free(olx_relit_lights *lights) {
  olx_release(lights->lights);
  olx_release(lights->packed);
}

static bool is_light(const olx_light *l) {
  const bool finite = olx_finite(l->emission) && olx_is_position(l->position) && olx_finite(l->direction) &&
                      olx_finite(l->edge_u) && olx_finite(l->edge_v);
  if ((uint32_t)l->type > OLX_LIGHT_SKY || !finite) return false;
  if (l->emission.x < 0.0f || l->emission.y < 0.0f || l->emission.z < 0.0f) return false;
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

olx_result olx_relit_lights_set(olx_relit_lights *lights, const olx_light *given, uint32_t count) {
  if (count > OLX_RELIT_MOST_LIGHTS) {
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: %u lights: at most %d", count, OLX_RELIT_MOST_LIGHTS);
  }
  for (uint32_t i = 0; i < count; i++) {
    if (is_light(&given[i])) continue;
    return olx_fail(OLX_ERROR_ARGUMENT, "relight: light %u: its type, a number or a direction is out of range", i);
  }
  lights->count = lights->packed_count = lights->rays = 0;
  lights->varying = false;
  for (uint32_t i = 0; i < count; i++) add(lights, &given[i]);
  return OLX_OK;
}
