// Twin of src/core/bsdf.h: Lambert and GGX with one split of energy. Directions are in the shading frame (normal = +z).
//
// SPDX-License-Identifier: MIT
#ifndef OLX_BSDF_GLSL
#define OLX_BSDF_GLSL

#include "vec.glsl"

struct olx_bsdf {
  vec3 albedo; // base colour * (1 - metallic)
  vec3 f0;
  float f90;
  float dielectric_weight;
  float alpha; // of GGX; 0 is a mirror
};

olx_bsdf olx_bsdf_make(vec3 base_color, float metallic, float roughness, float specular_weight) {
  olx_bsdf b;
  b.albedo = base_color * (1.0 - metallic);
  b.f0 = mix(vec3(0.04 * specular_weight), base_color, metallic);
  b.f90 = mix(specular_weight, 1.0, metallic);
  b.dielectric_weight = specular_weight;
  b.alpha = roughness < OLX_MIRROR_ROUGHNESS ? 0.0 : roughness * roughness;
  return b;
}

float olx_pow5(float x) {
  float x2 = x * x;
  return x2 * x2 * x;
}

vec3 olx_fresnel(olx_bsdf b, float cosine) {
  float p = olx_pow5(clamp(1.0 - cosine, 0.0, 1.0));
  return b.f0 * (1.0 - p) + vec3(b.f90 * p);
}

// Returns the diffuse lobe's reflectance for an eye at normal . view: outgoing radiance is this times irradiance / pi.
vec3 olx_bsdf_diffuse(olx_bsdf b, float cosine_view) {
  float p = olx_pow5(clamp(1.0 - cosine_view, 0.0, 1.0));
  return b.albedo * (1.0 - b.dielectric_weight * (0.04 + 0.96 * p));
}

bool olx_bsdf_has_specular(olx_bsdf b) { return b.f90 > 0.0; }

// Returns the specular lobe's reflectance in uniform light towards an eye at normal . view. For a mirror it is
// Fresnel's factor; rough lobes reflect less, at grazing angles far less.
vec3 olx_bsdf_specular_albedo(olx_bsdf b, float cosine_view) {
  float m = clamp(cosine_view, 0.0, 1.0), m2 = m * m, a = b.alpha, r = sqrt(a);
  float lost = a * (0.469 + 1.058 * m - 1.429 * m2 + r * (-0.389 + 0.254 * m + 0.754 * m2));
  float spread = a * (11.661 - 87.714 * m + 111.745 * m2 + r * (11.937 + 73.136 * m - 134.926 * m2));
  float grazing = olx_pow5(1.0 - m) / max(1.0 + spread, 1.0);
  return b.f0 * max(1.0 - lost - grazing, 0.0) + vec3(b.f90 * grazing);
}

// Returns whether the specular lobe is rough and reflects less than `share` towards an eye at normal . view. Such a
// lobe receives the mean light of all directions.
bool olx_lobe_is_dim(olx_bsdf b, float cosine_view, float share) {
  vec3 f = olx_fresnel(b, cosine_view);
  return b.alpha > 0.0 && max(f.x, max(f.y, f.z)) < share;
}

vec3 olx_dim_light(olx_bsdf b, float cosine_view, vec3 irradiance) {
  return olx_bsdf_specular_albedo(b, cosine_view) * irradiance * (1.0 / OLX_PI);
}

// Returns Smith's lambda.
float olx_ggx_lambda(float alpha, float cosine) {
  float c2 = cosine * cosine, a2 = alpha * alpha;
  return 0.5 * (sqrt(1.0 + a2 * max(1.0 - c2, 0.0) / max(c2, 1e-12)) - 1.0);
}

// Draws a half vector from the distribution of visible normals (Heitz 2018).
vec3 olx_ggx_sample_half(float alpha, vec3 view, vec2 random) {
  vec3 v = olx_normalize(vec3(alpha * view.x, alpha * view.y, view.z));
  float lensq = v.x * v.x + v.y * v.y;
  vec3 t1 = lensq > 0.0 ? vec3(-v.y, v.x, 0.0) * (1.0 / sqrt(lensq)) : vec3(1.0, 0.0, 0.0);
  vec3 t2 = cross(v, t1);
  vec2 disk = sqrt(random.x) * olx_turn(random.y);
  float p1 = disk.x, s = 0.5 * (1.0 + v.z);
  float p2 = (1.0 - s) * sqrt(max(0.0, 1.0 - p1 * p1)) + s * disk.y;
  float p3 = sqrt(max(0.0, 1.0 - p1 * p1 - p2 * p2));
  vec3 n = t1 * p1 + t2 * p2 + v * p3;
  return olx_normalize(vec3(alpha * n.x, alpha * n.y, max(1e-6, n.z)));
}

// Draws a direction from the specular lobe. weight is BRDF times cosine over pdf for Fresnel reflectance 1, or 0 below
// the surface; half_cosine is the cosine for the Fresnel term.
vec3 olx_ggx_sample(float alpha, vec3 view, vec2 random, out float weight, out float half_cosine) {
  if (alpha <= 0.0) {
    weight = view.z > 0.0 ? 1.0 : 0.0;
    half_cosine = view.z;
    return vec3(-view.x, -view.y, view.z);
  }
  vec3 half_vector = olx_ggx_sample_half(alpha, view, random);
  vec3 light = reflect(-view, half_vector);
  half_cosine = olx_dot(view, half_vector);
  weight = 0.0;
  if (view.z > 0.0 && light.z > 0.0) {
    float lambda_view = olx_ggx_lambda(alpha, view.z);
    weight = (1.0 + lambda_view) / (1.0 + lambda_view + olx_ggx_lambda(alpha, light.z));
  }
  return light;
}

#endif
