// Packs lights without area as a field stores them (LITE), and evaluates them, without shadows. Its twin is
// shaders/lib/lights.glsl.
#ifndef OLX_FIELD_LIGHTS_H
#define OLX_FIELD_LIGHTS_H

#include "field/field_data.h"

// Returns whether light arrives at a place from many directions: the light has an area, or is the sky.
static inline bool olx_light_varies(const olx_light *light) { return light->type >= OLX_LIGHT_RECT; }

// Packs a light without area.
olx_field_light olx_field_light_pack(const olx_light *light);
// Returns the light that was packed.
olx_light olx_field_light_unpack(const olx_field_light *packed);

// What a surface receives from one light.
typedef struct olx_light_arrival {
  olx_vec3 direction;  // unit, from the surface to the light
  olx_vec3 irradiance; // W/m^2 on a surface that faces the light, without shadows
} olx_light_arrival;

// Returns the share of a spot's light at an angle of this cosine off its axis (docs/maths.md, "Lights").
static inline float olx_spot_falloff(float cosine_inner, float cosine_outer, float cosine) {
  if (cosine >= cosine_inner) return 1.0f;
  if (cosine <= cosine_outer) return 0.0f;
  return olx_square((cosine - cosine_outer) / (cosine_inner - cosine_outer));
}

static inline float olx_field_light_cone(const olx_field_light *light, float cosine) {
  return light->type == OLX_LIGHT_SPOT ? olx_spot_falloff(light->cosine_inner, light->cosine_outer, cosine) : 1.0f;
}

static inline olx_light_arrival olx_field_light_arrival(const olx_field_light *light, olx_vec3 position) {
  if (light->type == OLX_LIGHT_SUN) return (olx_light_arrival){olx_negate(light->direction), light->emission};
  const olx_vec3 away = olx_sub(light->position, position);
  const float inverse = 1.0f / olx_max(olx_length(away), 0x1p-60f);
  const olx_vec3 direction = olx_scale(away, inverse);
  const float cone = olx_field_light_cone(light, -olx_dot(direction, light->direction));
  return (olx_light_arrival){direction, olx_scale(light->emission, cone * olx_square(inverse))};
}

#endif
