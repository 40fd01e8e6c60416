// Twin of src/trace/texel_shade.c: computes the light that a texel's surface sends towards any eye, not only the probe
// (docs/maths.md, "Light at the end of a ray").
//
// SPDX-License-Identifier: MIT
#ifndef OLX_TEXEL_SHADE_GLSL
#define OLX_TEXEL_SHADE_GLSL

#include "lights.glsl"
#include "texels.glsl"


// A texel's surface, prepared for shading.
struct olx_texel_surface {
  olx_bsdf bsdf;
  vec3 position, normal;
  vec3 view;    // unit, to the eye
  float cosine; // of the angle between normal and view
  vec3 direct;  // irradiance, W/m^2
};

// The light of those lights without area that stored direct light may come from.
struct olx_possible_light {
  vec3 irradiance;
  vec3 specular; // radiance towards the eye
};

// Radiance in W/(sr m^2) that a surface reflects towards an eye.
struct olx_reflection {
  vec3 reflected; // of the diffuse lobe, and the highlights of lights without area
  vec3 lobe;      // of the specular lobe in all other light, as if it came from all directions alike
};

// Returns specular radiance towards the eye per irradiance on a surface that faces the light; the cosine at the surface
// is included.
vec3 olx_highlight(olx_texel_surface s, vec3 to_light, float cosine_light) {
  float alpha = sqrt(olx_square(s.bsdf.alpha) + olx_square(OLX_STORED_NORMAL_ERROR));
  vec3 half_vector = olx_normalize(s.view + to_light), off = cross(half_vector, s.normal);
  float sine2 = olx_dot(off, off), along = olx_dot(half_vector, s.normal), a2 = alpha * alpha;
  float d = sine2 + along * along * a2;
  float g = 1.0 / (1.0 + olx_ggx_lambda(alpha, s.cosine) + olx_ggx_lambda(alpha, cosine_light));
  return olx_fresnel(s.bsdf, olx_dot(s.view, half_vector)) * (a2 * g / (4.0 * OLX_PI * d * d * s.cosine));
}

// Returns the largest share of light that can be part of stored light: in no colour channel more than that has.
// Channels that are far darker than the brightest say nothing, because stored light has no room for them.
float olx_share_within(vec3 stored, vec3 light) {
  float least = max(light.x, max(light.y, light.z)) * OLX_STORED_LIGHT_RANGE;
  float share = 1.0;
  if (light.x > least) share = min(share, stored.x / light.x);
  if (light.y > least) share = min(share, stored.y / light.y);
  if (light.z > least) share = min(share, stored.z / light.z);
  return share;
}

// Returns how much of a light shines on a surface whose direct light has room for a share of it. Where there is little
// room a shadow is more likely than a faint light, because other lights and the sky reach into shadows too. On the edge
// of a shadow, where all shares are as likely, the mean is kept.
float olx_likely_share(float room) { return clamp(2.0 * room - 0.5, 0.0, 1.0); }

olx_possible_light olx_light_of_lamps(olx_texel_surface s) {
  olx_possible_light sum = olx_possible_light(vec3(0.0), vec3(0.0));
  bool shines = s.bsdf.alpha > 0.0 && olx_bsdf_has_specular(s.bsdf);
  for (uint i = 0u; i < olx_field.light_count; i++) {
    olx_light_arrival light = olx_field_light_arrival(olx_field_light_at(i), s.position);
    float cosine = olx_dot(light.direction, s.normal);
    if (!(cosine > 0.0)) continue;
    vec3 irradiance = light.irradiance * cosine;
    float share = olx_likely_share(olx_share_within(s.direct, irradiance));
    sum.irradiance += irradiance * share;
    if (shines) sum.specular += light.irradiance * olx_highlight(s, light.direction, cosine) * share;
  }
  // A damaged file may hold a light whose sum is not finite.
  bool finite = olx_finite(sum.irradiance) && olx_finite(sum.specular);
  return olx_possible_light(finite ? sum.irradiance : vec3(0.0), finite ? sum.specular : vec3(0.0));
}

// Shades a texel's surface. `position` is on that surface, in metres; `direction` is the unit direction of the ray that
// found it. `vanished`: the ray went behind the surface, and no probe can follow it, so direct light is taken to be
// none. The texel must neither see the sky nor be of the border.
olx_reflection olx_texel_shade(ivec3 origin, ivec2 texel, vec3 position, vec3 direction, bool vanished) {
  vec3 normal = olx_texel_normal(origin, texel);
  float along_normal = olx_dot(normal, direction);
  // A ray that has gone behind the stored surface, or meets it from behind, meets a surface or a side that the probe
  // did not see. Its direct light is not stored, and is taken to be none.
  bool behind = vanished || along_normal > OLX_STORED_NORMAL_ERROR;
  vec3 direct = behind ? vec3(0.0) : olx_texel_direct(origin, texel);
  olx_texel_surface s = olx_texel_surface(olx_texel_material(origin, texel), position, normal, -direction,
                                          max(abs(along_normal), 1e-3), direct);
  // The ray's origin adds one more surface to the light's way, so the last stored bounce is left out.
  vec3 all_light = s.direct + olx_texel_indirect(origin, texel) * (1.0 - olx_field.last_bounce);
  olx_reflection light =
      olx_reflection(olx_bsdf_diffuse(s.bsdf, s.cosine) * all_light * (1.0 / OLX_PI), vec3(0.0));
  if (olx_bsdf_has_specular(s.bsdf)) {
    olx_possible_light lamps = olx_light_of_lamps(s);
    float share = olx_share_within(s.direct, lamps.irradiance);
    light.reflected += lamps.specular * share;
    vec3 rest = max(all_light - lamps.irradiance * share, vec3(0.0));
    light.lobe = olx_bsdf_specular_albedo(s.bsdf, s.cosine) * rest * (1.0 / OLX_PI);
  }
  return light;
}

#endif
