// Shades the surface that a texel stores for a ray's direction, with highlights of lights without area, whose shadows
// are inferred from stored direct light. Its twin is shaders/lib/texel_shade.glsl.
#include "trace/texel_shade.h"

#include "field/lights.h"

// A texel's surface, prepared for shading.
typedef struct texel_surface {
  olx_bsdf bsdf;
  olx_vec3 position, normal;
  olx_vec3 view;   // unit, to the eye
  float cosine;    // of the angle between normal and view
  olx_vec3 direct; // irradiance, W/m^2
} texel_surface;

// The light of those lights without area that stored direct light may come from.
typedef struct possible_light {
  olx_vec3 irradiance;
  olx_vec3 specular; // radiance towards the eye
} possible_light;

// Returns specular radiance towards the eye per irradiance on a surface that faces the light; the cosine at the surface
// is included.
static olx_vec3 highlight(const texel_surface *s, olx_vec3 to_light, float cosine_light) {
  const float alpha = sqrtf(olx_square(s->bsdf.alpha) + olx_square(OLX_STORED_NORMAL_ERROR));
  const olx_vec3 half = olx_normalize(olx_add(s->view, to_light)), off = olx_cross(half, s->normal);
  const float sine2 = olx_dot(off, off), along = olx_dot(half, s->normal), a2 = alpha * alpha;
  const float d = sine2 + along * along * a2;
  const float g = 1.0f / (1.0f + olx_ggx_lambda(alpha, s->cosine) + olx_ggx_lambda(alpha, cosine_light));
  return olx_scale(olx_fresnel(&s->bsdf, olx_dot(s->view, half)), a2 * g / (4.0f * OLX_PI * d * d * s->cosine));
}

// Returns the largest share of light that can be part of stored light: in no colour channel more than that has.
// Channels that are far darker than the brightest say nothing, because stored light has no room for them.
static float share_within(olx_vec3 stored, olx_vec3 light) {
  const float least = olx_max3(light) * OLX_STORED_LIGHT_RANGE;
  float share = 1.0f;
  if (light.x > least) share = olx_min(share, stored.x / light.x);
  if (light.y > least) share = olx_min(share, stored.y / light.y);
  if (light.z > least) share = olx_min(share, stored.z / light.z);
  return share;
}

// Returns how much of a light shines on a surface whose direct light has room for a share of it. Where there is little
// room a shadow is more likely than a faint light, because other lights and the sky reach into shadows too. On the edge
// of a shadow, where all shares are as likely, the mean is kept.
static float likely_share(float room) { return olx_clamp(2.0f * room - 0.5f, 0.0f, 1.0f); }

static possible_light light_of_lamps(const olx_field *field, const texel_surface *s) {
  possible_light sum = {.irradiance = olx_splat(0.0f)};
  if (field->surfaces.light_count > OLX_MOST_HIGHLIGHTS) return sum;
  const bool shines = s->bsdf.alpha > 0.0f && olx_bsdf_has_specular(&s->bsdf);
  for (uint32_t i = 0; i < field->surfaces.light_count; i++) {
    const olx_light_arrival light = olx_field_light_arrival(&field->surfaces.lights[i], s->position);
    const float cosine = olx_dot(light.direction, s->normal);
    if (!(cosine > 0.0f)) continue;
    const olx_vec3 irradiance = olx_scale(light.irradiance, cosine);
    const float share = likely_share(share_within(s->direct, irradiance));
    sum.irradiance = olx_madd(sum.irradiance, irradiance, share);
    if (!shines) continue;
    sum.specular = olx_madd(sum.specular, olx_mul(light.irradiance, highlight(s, light.direction, cosine)), share);
  }
  // A damaged file may hold a light whose sum is not finite.
  return olx_finite(sum.irradiance) && olx_finite(sum.specular) ? sum : (possible_light){.irradiance = olx_splat(0.0f)};
}

// Returns the direct irradiance of the side that a ray meets. A ray that has gone behind the stored surface, or meets
// it from behind, meets a surface or a side that the probe did not see. Its direct light is not stored, and is taken to
// be none.
static olx_vec3 direct_light(const olx_field *field, uint32_t probe, size_t texel, float along_normal, bool vanished) {
  const bool behind = vanished || along_normal > OLX_STORED_NORMAL_ERROR;
  return behind ? olx_splat(0.0f) : olx_texel_direct(field, probe, texel);
}

olx_texel_light olx_texel_shade(const olx_field *field, uint32_t probe, size_t texel, olx_vec3 position,
                                olx_vec3 direction, bool vanished) {
  texel_surface s = {.bsdf = olx_texel_material(field, probe, texel),
                     .position = position,
                     .normal = olx_texel_normal(field, probe, texel),
                     .view = olx_negate(direction)};
  const float along_normal = olx_dot(s.normal, direction);
  s.direct = direct_light(field, probe, texel, along_normal, vanished);
  s.cosine = olx_max(fabsf(along_normal), 1e-3f);
  // The ray's origin adds one more surface to the light's way, so the last stored bounce is left out.
  const olx_vec3 all = olx_madd(s.direct, olx_texel_indirect(field, probe, texel), 1.0f - field->info.bounces.last);
  olx_texel_light light = {.reflected = olx_scale(olx_mul(olx_bsdf_diffuse(&s.bsdf, s.cosine), all), 1.0f / OLX_PI)};
  if (!olx_bsdf_has_specular(&s.bsdf)) return light;
  const possible_light lamps = light_of_lamps(field, &s);
  const float share = share_within(s.direct, lamps.irradiance);
  light.reflected = olx_madd(light.reflected, lamps.specular, share);
  const olx_vec3 rest = olx_max_each(olx_madd(all, lamps.irradiance, -share), olx_splat(0.0f));
  light.lobe = olx_scale(olx_mul(olx_bsdf_specular_albedo(&s.bsdf, s.cosine), rest), 1.0f / OLX_PI);
  return light;
}
