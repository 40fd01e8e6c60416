// Packs lights for a field: the bake packs those of a scene, and a relighter those that replace them. What a type of
// light does not use becomes 0.
#include "field/lights.h"

#include <assert.h>

olx_field_light olx_field_light_pack(const olx_light *light) {
  assert(!olx_light_varies(light));
  olx_field_light packed = {.type = light->type, .emission = light->emission};
  if (light->type != OLX_LIGHT_SUN) packed.position = light->position;
  if (light->type != OLX_LIGHT_POINT) packed.direction = light->direction;
  if (light->type == OLX_LIGHT_SPOT) {
    packed.cosine_inner = light->cosine_inner;
    packed.cosine_outer = light->cosine_outer;
  }
  return packed;
}

olx_light olx_field_light_unpack(const olx_field_light *packed) {
  return (olx_light){.type = (olx_light_type)packed->type,
                     .emission = packed->emission,
                     .position = packed->position,
                     .direction = packed->direction,
                     .cosine_inner = packed->cosine_inner,
                     .cosine_outer = packed->cosine_outer};
}
