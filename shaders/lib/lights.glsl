// Twin of src/field/lights.h: evaluates the lights without area that a field stores, without shadows.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_LIGHTS_GLSL
#define OLX_LIGHTS_GLSL

#include "maps.glsl"

struct olx_field_light {
  uint type;
  vec3 position;  // metres; of point and spot
  vec3 direction; // of travel, unit; of sun and spot
  vec3 emission;  // sun: irradiance on a surface facing it; point, spot: radiant intensity
  float cosine_inner, cosine_outer;
};

// What a surface receives from one light.
struct olx_light_arrival {
  vec3 direction;  // unit, from the surface to the light
  vec3 irradiance; // W/m^2 on a surface that faces the light, without shadows
};

vec3 olx_word_vector(uint word) {
  return uintBitsToFloat(uvec3(olx_word(word), olx_word(word + 1u), olx_word(word + 2u)));
}

olx_field_light olx_field_light_at(uint index) {
  uint first = olx_field.lights_first + OLX_FIELD_LIGHT_WORDS * index;
  return olx_field_light(olx_word(first), olx_word_vector(first + 1u), olx_word_vector(first + 4u),
                         olx_word_vector(first + 7u), uintBitsToFloat(olx_word(first + 10u)),
                         uintBitsToFloat(olx_word(first + 11u)));
}

// Returns the share of a spot's light at an angle of this cosine off its axis (docs/maths.md, "Lights").
float olx_field_light_cone(olx_field_light light, float cosine) {
  float share = olx_square((cosine - light.cosine_outer) / (light.cosine_inner - light.cosine_outer));
  share = cosine <= light.cosine_outer ? 0.0 : share;
  return light.type != OLX_LIGHT_SPOT || cosine >= light.cosine_inner ? 1.0 : share;
}

olx_light_arrival olx_field_light_arrival(olx_field_light light, vec3 position) {
  vec3 away = light.position - position;
  float inverse = 1.0 / max(sqrt(olx_dot(away, away)), 8.673617379884035e-19);
  vec3 direction = away * inverse;
  float cone = olx_field_light_cone(light, -olx_dot(direction, light.direction));
  bool sun = light.type == OLX_LIGHT_SUN;
  return olx_light_arrival(sun ? -light.direction : direction,
                           sun ? light.emission : light.emission * (cone * olx_square(inverse)));
}

#endif
