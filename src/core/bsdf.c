// Tabulates the share of light that a specular lobe reflects, averaged over views. It becomes part of a diffuse albedo
// where light is stored independently of direction.
#include "core/bsdf.h"

// The specular light that leaves a surface in uniform light, averaged over the hemisphere of views, at roughness 0, 0.1
// .. 1: first for Fresnel reflectance 1, then weighted with Schlick's (1 - cos)^5.
static const float FULL_ALBEDO[] = {1.0f,     0.99952f, 0.99405f, 0.97674f, 0.94045f, 0.88244f,
                                    0.80303f, 0.70738f, 0.60400f, 0.50215f, 0.40868f};
static const float GRAZING_ALBEDO[] = {0.04762f, 0.04703f, 0.04302f, 0.03534f, 0.02643f, 0.01857f,
                                       0.01262f, 0.00849f, 0.00573f, 0.00392f, 0.00272f};

static float look_up(const float table[], float roughness) {
  const float x = olx_clamp(roughness, 0.0f, 1.0f) * 10.0f, first = olx_min(floorf(x), 9.0f);
  return olx_mix(table[(int)first], table[(int)first + 1], x - first);
}

olx_vec3 olx_bsdf_lamp_albedo(const olx_bsdf *b) {
  olx_bsdf seen = *b;
  if (seen.alpha <= 0.0f) {
    seen.f0 = olx_splat(0.0f);
    seen.f90 = 0.0f;
  }
  return olx_bsdf_matte(&seen).albedo;
}

olx_bsdf olx_bsdf_matte(const olx_bsdf *b) {
  const float roughness = sqrtf(b->alpha), full = look_up(FULL_ALBEDO, roughness),
              grazing = look_up(GRAZING_ALBEDO, roughness);
  const olx_vec3 specular = olx_add(olx_scale(b->f0, full - grazing), olx_splat(b->f90 * grazing));
  const float diffuse = 1.0f - b->dielectric_weight * (0.04f + 0.96f * GRAZING_ALBEDO[0]);
  return (olx_bsdf){.albedo = olx_madd(specular, b->albedo, diffuse)};
}
