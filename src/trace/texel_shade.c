// Shades the surface that a texel stores for a ray's direction: the diffuse and the specular lobe in direct and
// indirect light, and the highlights of lights without area, whose shadows are inferred from stored direct light.
// Its twin is shaders/lib/texel_shade.glsl.
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

// The light of all lights without area, as if nothing shadowed the surface.
typedef struct unshadowed {
  olx_vec3 irradiance;
  olx_vec3 specular; // radiance towards the eye
} unshadowed;

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

static unshadowed light_without_shadows(const olx_field *field, const texel_surface *s) {
  unshadowed sum = {.irradiance = olx_splat(0.0f)};
  if (field->surfaces.light_count > OLX_MOST_HIGHLIGHTS) return sum;
  const bool shines = s->bsdf.alpha > 0.0f && olx_bsdf_has_specular(&s->bsdf);
  for (uint32_t i = 0; i < field->surfaces.light_count; i++) {
    const olx_light_arrival light = olx_field_light_arrival(&field->surfaces.lights[i], s->position);
    const float cosine = olx_dot(light.direction, s->normal);
    if (!(cosine > 0.0f)) continue;
    sum.irradiance = olx_madd(sum.irradiance, light.irradiance, cosine);
    if (shines) sum.specular = olx_add(sum.specular, olx_mul(light.irradiance, highlight(s, light.direction, cosine)));
  }
  // A damaged file may hold a light whose sum is not finite.
  return olx_finite(sum.irradiance) && olx_finite(sum.specular) ? sum : (unshadowed){.irradiance = olx_splat(0.0f)};
}

// Returns the share of unshadowed light that arrives: in each colour channel at most what is stored.
static float lit_share(olx_vec3 stored, olx_vec3 most) {
  float share = 1.0f;
  if (most.x > 0.0f) share = olx_min(share, stored.x / most.x);
  if (most.y > 0.0f) share = olx_min(share, stored.y / most.y);
  if (most.z > 0.0f) share = olx_min(share, stored.z / most.z);
  return share;
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
  const unshadowed free = light_without_shadows(field, &s);
  const float share = lit_share(s.direct, free.irradiance);
  light.reflected = olx_madd(light.reflected, free.specular, share);
  const olx_vec3 rest = olx_max_each(olx_madd(all, free.irradiance, -share), olx_splat(0.0f));
  light.lobe = olx_scale(olx_mul(olx_bsdf_specular_albedo(&s.bsdf, s.cosine), rest), 1.0f / OLX_PI);
  return light;
}
