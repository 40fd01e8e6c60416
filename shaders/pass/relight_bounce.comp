// Carries light over links to the surfels whose turn it is, and sums for each workgroup how much it changed.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "relight_set.glsl"

shared vec2 lanes[OLX_RELIGHT_GROUP];

// Returns the luminance of light that a surfel's specular lobe sends to a place, as the irradiance that would make a
// white matte surface in its place as bright.
float specular_light(uint surfel, float light, vec3 place) {
  vec4 reflectance = surfel_reflectance(surfel);
  vec3 beam = state_vector(relight.beams + 3u * surfel), away = place - surfel_point(surfel, 0u);
  float strength = sqrt(olx_dot(beam, beam)), distance_metres = sqrt(olx_dot(away, away));
  float everywhere = reflectance.y * max(light - strength, 0.0);
  if (strength <= 0.0 || reflectance.y <= 0.0 || !(distance_metres > 0.0)) return everywhere;
  return everywhere + strength * olx_specular_brightness(surfel_normal(surfel), reflectance.z, reflectance.w,
                                                         away * (1.0 / distance_metres), beam * (1.0 / strength));
}

vec3 find_highlights(uint surfel) {
  uint end = structure[relight.link_starts + surfel + 1u];
  vec3 place = surfel_point(surfel, 0u), sum = vec3(0.0);
  for (uint i = structure[relight.link_starts + surfel]; i < end; i++) {
    uint link = relight.links + 2u * i, from = structure[link] & 0xFFFFFFu, straight = structure[link] >> 24;
    vec3 direct = state_vector(relight.direct + 3u * from);
    float light = olx_luminance(direct), diffuse = surfel_reflectance(from).x;
    if (straight == 0u || light <= 0.0 || diffuse <= 0.0) continue;
    float weight =
        olx_luminance(olx_rgb9e5_unpack(structure[link + 1u])) * (float(straight) * (1.0 / 255.0)) / diffuse;
    sum += direct * (weight * specular_light(from, light, place) / light);
  }
  return sum;
}

vec3 gather(uint surfel) {
  uint end = structure[relight.link_starts + surfel + 1u], at = relight.highlights + 3u * surfel;
  if ((call.flags & OLX_CALL_SHINES) != 0u) set_state(at, find_highlights(surfel));
  vec3 sum = state_vector(at) + state_vector(relight.near + 3u * surfel);
  for (uint i = structure[relight.link_starts + surfel]; i < end; i++) {
    uint link = relight.links + 2u * i;
    sum += olx_rgb9e5_unpack(structure[link + 1u]) * state_vector(relight.values + 3u * (structure[link] & 0xFFFFFFu));
  }
  return sum;
}

// Follows the links of a surfel; returns the luminance of the change, and of all light.
vec2 follow_links(uint surfel) {
  uint at = relight.irradiance + 3u * surfel;
  vec3 before = state_vector(at), now = gather(surfel), direct = state_vector(relight.direct + 3u * surfel);
  set_state(at, now);
  return vec2(olx_luminance(abs(now - before)), olx_luminance(now + direct));
}

// Returns the sum over the workgroup, in a fixed order of threads, so that every run gives the same bits.
vec2 sum_of_group(vec2 own) {
  lanes[gl_LocalInvocationIndex] = own;
  for (uint count = OLX_RELIGHT_GROUP / 2u; count > 0u; count /= 2u) {
    barrier();
    if (gl_LocalInvocationIndex < count) lanes[gl_LocalInvocationIndex] += lanes[gl_LocalInvocationIndex + count];
  }
  return lanes[0];
}

void main() {
  if (group_index() * OLX_RELIGHT_GROUP >= call.count) return;
  uint thread = thread_index();
  vec2 own = vec2(0.0);
  if (thread < call.count) own = follow_links(surfel_of(thread));
  vec2 sum = sum_of_group(own);
  if (gl_LocalInvocationIndex != 0u) return;
  state[relight.sums + 2u * group_index()] = floatBitsToUint(sum.x);
  state[relight.sums + 2u * group_index() + 1u] = floatBitsToUint(sum.y);
}
