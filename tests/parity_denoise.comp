// Rows of the denoiser.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/denoise.glsl"
#include "parity.glsl"

// Two neighbouring pixels, mostly of one surface, and the surface attributes there.
const vec2 PICTURE = vec2(16.0, 12.0);
olx_camera_frame camera;
olx_shown here, there;
olx_incident light_here, light_there;
vec2 pixel;

void derive_denoise() {
  vec3 tangent, bitangent;
  olx_basis(direction, tangent, bitangent);
  camera = olx_camera_frame(view * 2.0, direction, tangent * (0.5 + random.x), bitangent * (0.4 + random.y));
  pixel = vec2(bits.yz % uvec2(16u, 12u));
  here = olx_shown(point, direction, item.v[15], random.x, 0.01);
  precise vec3 offset = tangent * (0.2 * random.z) + view * ((bits.w & 1u) != 0u ? 0.02 * random.w : 0.0);
  precise vec3 beside = point + offset;
  vec3 normal = olx_normalize(direction + view * (0.5 * random.y));
  there = olx_shown(beside, normal, item.v[15], random.x + 0.2 * random.y - 0.1, 0.01);
  light_here = olx_incident(abs(view), random.x - 0.1);
  light_there = olx_incident(abs(direction) * 3.0, random.y - 0.1);
  if (bits.x % 32u == 0u) light_here.light.y = uintBitsToFloat(0x7FC00000u);
  if (bits.x % 32u == 1u) light_there.light.z = OLX_INFINITY;
  if (bits.x % 32u == 2u) light_there.inverse_distance = OLX_INFINITY;
}

void put_incident(olx_incident i) { put(i.light), put(i.inverse_distance); }

// Returns a hit that may be on an emitter, from its front or its back, or on the sky.
olx_trace_hit some_hit() {
  float distance = (bits.x & 4u) != 0u ? OLX_INFINITY : item.v[15];
  return olx_trace_hit(bits.x % 3u, distance, point + direction * item.v[15], view, direction, vec3(0.0), view, true,
                       0u, ivec2(0), 2.0 * random.x, 1u, 1u);
}

void denoise_rows() {
  derive_denoise();
  vec2 at;
  bool seen, glossy = (bits.w & 2u) != 0u;
  float reach = (bits.w & 4u) != 0u ? 0.0 : 2.5 * random.z, pixels = float(bits.y % 12u);
  olx_known known;
  olx_scales scales = olx_scales_of(light_here, 50.0 * random.z);
  switch (row) {
  case ROW_olx_finite: put(olx_finite(light_here.light)), put(olx_finite(light_there.light)); break;
  case ROW_olx_lobe_is_dim: put(olx_lobe_is_dim(bsdf, random.w, random.z)); break;
  case ROW_olx_dim_light: put(olx_dim_light(bsdf, random.w, abs(view))); break;
  case ROW_olx_emission_faces: put(olx_emission_faces(some_hit(), point)); break;
  case ROW_olx_light_found: put(olx_light_found(settings, some_hit(), point)); break;
  case ROW_olx_nearness: put(olx_nearness(some_hit())); break;
  case ROW_olx_nothing_known: known = olx_nothing_known(), put_incident(known.incident), put(known.count); break;
  case ROW_olx_guide_position: put(olx_guide_position(camera, PICTURE, pixel, item.v[15])); break;
  case ROW_olx_guide_project:
    seen = olx_guide_project(camera, PICTURE, point, at), put(seen), put(seen ? at : vec2(0.0));
    break;
  case ROW_olx_pixel_angle: put(olx_pixel_angle(camera, PICTURE)); break;
  case ROW_olx_plane_fit: put(olx_plane_fit(there.position - here.position, here.normal, 0.01 * here.depth)); break;
  case ROW_olx_is_sample: put(olx_is_sample(light_here)), put(olx_is_sample(light_there)); break;
  case ROW_olx_same_surface: put(olx_same_surface(here, there)); break;
  case ROW_olx_settle: put(olx_settle(pixel.x + 0.04 * random.x - 0.02)); break;
  case ROW_olx_stands_still: put(olx_stands_still(pixel + 0.02 * random.xy, pixel)); break;
  case ROW_olx_bilinear_weight: put(olx_bilinear_weight(pixel + random.xy, bits.x & 3u)); break;
  case ROW_olx_mix_sample:
    known = olx_mix_sample(olx_known(light_here, 60.0 * random.z), light_there, (bits.w & 1u) != 0u ? 0.98 : 0.0);
    put_incident(known.incident), put(known.count);
    break;
  case ROW_olx_scales_of: put(scales.inverse_distance), put(scales.narrowing), put(scales.known); break;
  case ROW_olx_gaussian: put(olx_gaussian(9.0 * random.x)); break;
  case ROW_olx_reach_weight: put(olx_reach_weight(glossy, 0.1 + random.y, here, random.z, random.w, pixels)); break;
  case ROW_olx_tap_weight:
    put(olx_tap_weight(glossy, 12.0, reach, here, scales, there, light_there.inverse_distance, pixels));
    break;
  }
}

void main() {
  begin();
  denoise_rows();
}
