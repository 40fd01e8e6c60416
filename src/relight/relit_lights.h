// The lights of a relighter.
#ifndef OLX_RELIGHT_RELIT_LIGHTS_H
#define OLX_RELIGHT_RELIT_LIGHTS_H

#include "field/lights.h"
#include "field/near_lamps.h"

#include <octalux/relight.h>

enum {
  OLX_RELIT_MOST_LIGHTS = 256,
  OLX_RELIT_MOST_LAMP_POINTS = OLX_RELIT_MOST_LIGHTS * OLX_LEAST_LAMP_RAYS,
};

typedef struct olx_relit_lights {
  const olx_relight_settings *settings;
  olx_light *lights;
  olx_field_light *packed; // those without area, as fields store them
  uint32_t count, packed_count;
  uint32_t rays;        // from a place to all of them, at most, for a sample of its direct light
  bool varying;         // light of some arrives from many directions
  olx_near_lamps lamps; // surfaces near lamps, as the field shows them: surfels get their light from the lamps' points
} olx_relit_lights;

olx_result olx_relit_lights_create(const olx_relight_settings *settings, olx_relit_lights *lights);
void olx_relit_lights_free(olx_relit_lights *lights);

// Sets the lights, and finds the surfaces near lamps by rays through `field`. OLX_ERROR_ARGUMENT, with a message, when
// there are too many or one is out of range; they then stay as they were, and so they do when memory runs out.
olx_result olx_relit_lights_set(olx_relit_lights *lights, const olx_field *field, const olx_light *given,
                                uint32_t count);

// Returns the number of shadow rays from a place to a light.
static inline uint32_t olx_relit_samples(const olx_relit_lights *lights, uint32_t light) {
  return olx_light_varies(&lights->lights[light]) ? lights->settings->light_samples : 1;
}

// Returns the number of shadow rays from a point of a surfel, at most, for a sample of its direct light: to all lights,
// and then to surfaces near lamps.
static inline uint32_t olx_relit_surfel_rays(const olx_relit_lights *lights) {
  return lights->rays + (lights->lamps.count > 0 ? OLX_LAMP_SAMPLES : 0);
}

#endif
