// The only reflection model: Lambert and GGX with one split of energy, used by the path tracer, the baker and the
// runtime.
//
// Specular: GGX, alpha = roughness^2, height-correlated Smith, Schlick's Fresnel with F0 and F90. Diffuse: Lambert,
// scaled by (1 - metallic) and by 1 - F(normal . view) of the dielectric, a factor of the view alone, so that diffuse
// light is albedo * irradiance / pi whether the irradiance is interpolated, traced or path traced.
//
// Directions are in the shading frame (normal = +z), unit, pointing away from the surface.
// Its twin is shaders/lib/bsdf.glsl.
#ifndef OLX_CORE_BSDF_H
#define OLX_CORE_BSDF_H

#include "core/vec.h"

typedef struct olx_bsdf {
  olx_vec3 albedo; // base colour * (1 - metallic)
  olx_vec3 f0;
  float f90;
  float dielectric_weight; // specular weight, as in olx_bsdf_diffuse
  float alpha;             // of GGX; 0 is a mirror
} olx_bsdf;

static inline olx_bsdf olx_bsdf_make(olx_vec3 base_color, float metallic, float roughness, float specular_weight) {
  return (olx_bsdf){
      .albedo = olx_scale(base_color, 1.0f - metallic),
      .f0 = olx_mix3(olx_splat(0.04f * specular_weight), base_color, metallic),
      .f90 = olx_mix(specular_weight, 1.0f, metallic),
      .dielectric_weight = specular_weight,
      .alpha = roughness < OLX_MIRROR_ROUGHNESS ? 0.0f : roughness * roughness,
  };
}

static inline float olx_pow5(float x) {
  const float x2 = x * x;
  return x2 * x2 * x;
}

static inline olx_vec3 olx_fresnel(const olx_bsdf *b, float cosine) {
  const float p = olx_pow5(olx_clamp(1.0f - cosine, 0.0f, 1.0f));
  return olx_add(olx_scale(b->f0, 1.0f - p), olx_splat(b->f90 * p));
}

// Returns the diffuse lobe's reflectance for an eye at normal . view: outgoing radiance is this times irradiance / pi.
static inline olx_vec3 olx_bsdf_diffuse(const olx_bsdf *b, float cosine_view) {
  const float p = olx_pow5(olx_clamp(1.0f - cosine_view, 0.0f, 1.0f));
  return olx_scale(b->albedo, 1.0f - b->dielectric_weight * (0.04f + 0.96f * p));
}

static inline bool olx_bsdf_has_specular(const olx_bsdf *b) { return b->f90 > 0.0f; }

// Returns the specular lobe's reflectance in uniform light towards an eye at normal . view. For a mirror it is
// Fresnel's factor; rough lobes reflect less, at grazing angles far less. The lobe's integral is fitted by polynomials
// in roughness and cosine, with an error of 0.005 (RMS) where F0 is small and 0.03 where it is 1.
static inline olx_vec3 olx_bsdf_specular_albedo(const olx_bsdf *b, float cosine_view) {
  const float m = olx_clamp(cosine_view, 0.0f, 1.0f), m2 = m * m, a = b->alpha, r = sqrtf(a);
  const float lost = a * (0.469f + 1.058f * m - 1.429f * m2 + r * (-0.389f + 0.254f * m + 0.754f * m2));
  const float spread = a * (11.661f - 87.714f * m + 111.745f * m2 + r * (11.937f + 73.136f * m - 134.926f * m2));
  const float grazing = olx_pow5(1.0f - m) / olx_max(1.0f + spread, 1.0f);
  return olx_add(olx_scale(b->f0, olx_max(1.0f - lost - grazing, 0.0f)), olx_splat(b->f90 * grazing));
}

// Returns whether the specular lobe is rough and reflects less than `share` towards an eye at normal . view. Such a
// lobe receives the mean light of all directions.
static inline bool olx_lobe_is_dim(const olx_bsdf *b, float cosine_view, float share) {
  return b->alpha > 0.0f && olx_max3(olx_fresnel(b, cosine_view)) < share;
}

static inline olx_vec3 olx_dim_light(const olx_bsdf *b, float cosine_view, olx_vec3 irradiance) {
  return olx_scale(olx_mul(olx_bsdf_specular_albedo(b, cosine_view), irradiance), 1.0f / OLX_PI);
}

static inline float olx_ggx_distribution(float alpha, olx_vec3 half) {
  // The form 1 - cos^2 would cancel near the normal, where smooth surfaces have their whole lobe.
  const float sine2 = half.x * half.x + half.y * half.y, a2 = alpha * alpha, d = sine2 + half.z * half.z * a2;
  return a2 / (OLX_PI * d * d);
}

// Returns Smith's lambda.
static inline float olx_ggx_lambda(float alpha, float cosine) {
  const float c2 = cosine * cosine, a2 = alpha * alpha;
  return 0.5f * (sqrtf(1.0f + a2 * olx_max(1.0f - c2, 0.0f) / olx_max(c2, 1e-12f)) - 1.0f);
}

// Returns the specular BRDF times the cosine at `light`, for alpha > 0.
static inline olx_vec3 olx_bsdf_specular(const olx_bsdf *b, olx_vec3 view, olx_vec3 light) {
  if (view.z <= 0.0f || light.z <= 0.0f) return olx_splat(0.0f);
  const olx_vec3 half = olx_normalize(olx_add(view, light));
  const float g = 1.0f / (1.0f + olx_ggx_lambda(b->alpha, view.z) + olx_ggx_lambda(b->alpha, light.z));
  return olx_scale(olx_fresnel(b, olx_dot(view, half)), olx_ggx_distribution(b->alpha, half) * g / (4.0f * view.z));
}

// Returns the density over solid angle with which olx_ggx_sample_half and a reflection draw `light`.
static inline float olx_ggx_pdf(float alpha, olx_vec3 view, olx_vec3 light) {
  if (view.z <= 0.0f || light.z <= 0.0f) return 0.0f;
  const olx_vec3 half = olx_normalize(olx_add(view, light));
  return olx_ggx_distribution(alpha, half) / ((1.0f + olx_ggx_lambda(alpha, view.z)) * 4.0f * view.z);
}

// Draws a half vector from the distribution of visible normals (Heitz 2018).
static inline olx_vec3 olx_ggx_sample_half(float alpha, olx_vec3 view, olx_vec2 random) {
  const olx_vec3 v = olx_normalize(olx_v3(alpha * view.x, alpha * view.y, view.z));
  const float lensq = v.x * v.x + v.y * v.y;
  const olx_vec3 t1 = lensq > 0.0f ? olx_scale(olx_v3(-v.y, v.x, 0.0f), 1.0f / sqrtf(lensq)) : olx_v3(1.0f, 0.0f, 0.0f);
  const olx_vec3 t2 = olx_cross(v, t1);
  const float r = sqrtf(random.x), phi = 2.0f * OLX_PI * random.y, p1 = r * cosf(phi), s = 0.5f * (1.0f + v.z);
  const float p2 = (1.0f - s) * sqrtf(olx_max(0.0f, 1.0f - p1 * p1)) + s * r * sinf(phi);
  const float p3 = sqrtf(olx_max(0.0f, 1.0f - p1 * p1 - p2 * p2));
  const olx_vec3 n = olx_add(olx_add(olx_scale(t1, p1), olx_scale(t2, p2)), olx_scale(v, p3));
  return olx_normalize(olx_v3(alpha * n.x, alpha * n.y, olx_max(1e-6f, n.z)));
}

// Draws a direction from the specular lobe. *weight is BRDF times cosine over pdf for Fresnel reflectance 1, or 0 below
// the surface; *half_cosine is the cosine for the Fresnel term.
static inline olx_vec3 olx_ggx_sample(float alpha, olx_vec3 view, olx_vec2 random, float *weight, float *half_cosine) {
  if (alpha <= 0.0f) {
    *weight = view.z > 0.0f ? 1.0f : 0.0f;
    *half_cosine = view.z;
    return olx_v3(-view.x, -view.y, view.z);
  }
  const olx_vec3 half = olx_ggx_sample_half(alpha, view, random);
  const olx_vec3 light = olx_reflect(olx_negate(view), half);
  *half_cosine = olx_dot(view, half);
  *weight = 0.0f;
  if (view.z > 0.0f && light.z > 0.0f) {
    const float lambda_view = olx_ggx_lambda(alpha, view.z);
    *weight = (1.0f + lambda_view) / (1.0f + lambda_view + olx_ggx_lambda(alpha, light.z));
  }
  return light;
}

// Returns the Lambertian surface that reflects the same share of uniform light, averaged over views: the best model of
// a surface when the view is unknown. The result has no specular lobe, and applying the function to it changes nothing.
olx_bsdf olx_bsdf_matte(const olx_bsdf *bsdf);
// Returns the albedo of that surface for light from lamps without area, of which a mirror shows none.
olx_vec3 olx_bsdf_lamp_albedo(const olx_bsdf *bsdf);

#endif
