// Twin of src/trace/trace.c: traces a ray against the whole field, probe after probe until one resolves it (McGuire et
// al. 2017, Listing 1).
//
// SPDX-License-Identifier: MIT
#ifndef OLX_TRACE_GLSL
#define OLX_TRACE_GLSL

#include "bricks.glsl"
#include "cage.glsl"
#include "probe_trace.glsl"
#include "select.glsl"
#include "settings.glsl"
#include "sight.glsl"
#include "texel_shade.glsl"
#include "voronoi.glsl"


struct olx_trace_hit {
  uint status;           // OLX_TRACE_*
  float distance_metres; // along the ray; infinite for a miss to the sky
  vec3 position;
  vec3 normal;   // of the surface, on the side of the probe that saw it
  vec3 radiance; // reflected by the surface along the ray; 0 for a miss
  vec3 lobe;     // the part of it from the specular lobe (octalux/sample.h)
  vec3 emission; // sent by an emitter towards the probe, or by the sky along the ray
  bool emitter;  // the ray ends at an emitter or in the sky
  uint probe;    // the probe that resolved the ray, or OLX_NO_PROBE
  ivec2 texel;   // of the probe's maps
  float footprint_metres;
  uint texel_steps, probes_tried;
};

struct olx_search {
  olx_sample_settings settings;
  vec3 origin, direction;
  float t, t_max; // the ray is known to be clear up to t
  float lost;     // where the probe that followed it farthest lost it
  uint attempts;
  uvec4 asked; // a bit for each tried probe, by its number modulo OLX_REMEMBERED
  uint steps;
  // The answer that resolved the ray; until then, the best guess: the surface behind which it vanished by the smallest
  // gap.
  olx_probe_answer answer;
  uint answered; // the probe of that answer, or OLX_NO_PROBE
};

bool olx_usable(olx_search s, uint probe) {
  return s.settings.keep_buried || (olx_probe_flags(probe) & OLX_PROBE_BURIED) == 0u;
}

// Returns whether a ray can be marched: its direction is a unit vector, and the squares of its numbers are finite.
bool olx_is_ray(vec3 origin, vec3 direction, float t_max) {
  float length = olx_dot(direction, direction);
  return olx_dot(origin, origin) < OLX_INFINITY && length > 0.9 && length < 1.1 && t_max > 0.0;
}

bool olx_was_asked(olx_search s, uint probe) {
  uint bit = probe % OLX_REMEMBERED, word = bit >> 5;
  uint asked = word == 0u ? s.asked.x : word == 1u ? s.asked.y : word == 2u ? s.asked.z : s.asked.w;
  return (asked >> (bit & 31u) & 1u) != 0u;
}

void olx_remember(inout olx_search s, uint probe) {
  uint bit = probe % OLX_REMEMBERED;
  s.asked |= uvec4(equal(uvec4(bit >> 5), uvec4(0u, 1u, 2u, 3u))) << (bit & 31u);
  s.attempts++;
}

vec3 olx_ray_point(olx_search s, float t) {
  precise vec3 point = s.origin + s.direction * t;
  return point;
}

// Returns the squared distance of a probe from the ray's line.
float olx_line_distance_squared(olx_search s, uint probe) {
  precise vec3 offset = olx_probe_position(probe) - s.origin;
  precise vec3 foot = offset + s.direction * -olx_dot(offset, s.direction);
  return olx_dot(foot, foot);
}

// Returns whether a probe sees the ray's origin or, once other probes have lost the ray, the place where they did.
bool olx_sees(olx_search s, uint probe) {
  if (s.attempts == 0u) return olx_probe_sees(probe, s.origin, OLX_SIGHT_START, s.direction);
  return olx_probe_sees(probe, olx_ray_point(s, s.lost), OLX_SIGHT_STUCK, vec3(0.0));
}

// Traces the ray through one probe's map. Returns true when that resolves it.
bool olx_ask(inout olx_search s, uint probe) {
  olx_remember(s, probe);
  precise vec3 origin = s.origin - olx_probe_position(probe);
  olx_probe_answer answer =
      olx_trace_probe(probe, olx_probe_ray(origin, s.direction, s.t, s.t_max), s.settings.tracer);
  s.steps += answer.steps;
  // A ray lost in front of the stored surface has gone behind nothing, so it ends there.
  if (answer.status == OLX_TRACE_UNKNOWN && answer.gap < 0.0) answer.status = OLX_TRACE_HIT;
  bool settled = answer.status != OLX_TRACE_UNKNOWN;
  if (settled || s.answered == OLX_NO_PROBE || answer.gap < s.answer.gap) {
    s.answer = answer;
    s.answered = probe;
  }
  if (settled) return true;
  precise vec3 lost = origin + s.direction * answer.t;
  precise float footprint = OLX_TEXEL_ANGLE / float(olx_field.n) * sqrt(olx_dot(lost, lost));
  precise float before = answer.t - OLX_HAND_OVER_FOOTPRINTS * footprint;
  s.t = max(s.t, before);
  s.lost = max(s.lost, answer.t);
  return false;
}

// Returns the corner to begin with: the probe nearest to the ray's line.
uint olx_first_corner(olx_search s, olx_cage cage) {
  uint best = 0u;
  float best_distance = OLX_INFINITY;
  for (uint corner = 0u; corner < 8u; corner++) {
    if (!olx_cage_has(cage, corner)) continue;
    float distance = olx_line_distance_squared(s, olx_cage_probe(olx_field.grid, cage, corner));
    if (distance < best_distance) {
      best_distance = distance;
      best = corner;
    }
  }
  return best;
}

// Returns the next probe of the cage around the place to which the ray is followed. Corners are taken in steps of
// three, so that each is far from the last.
uint olx_next_corner(olx_search s) {
  olx_cage cage = olx_cage_at(olx_field.grid, olx_ray_point(s, s.lost));
  uint corner = olx_first_corner(s, cage);
  for (uint i = 0u; i < 8u; i++, corner = (corner + 3u) & 7u) {
    if (!olx_cage_has(cage, corner)) continue;
    uint probe = olx_cage_probe(olx_field.grid, cage, corner);
    if (olx_usable(s, probe) && !olx_was_asked(s, probe)) return probe;
  }
  return OLX_NO_PROBE;
}

// Returns the nearest probe at first; later, the neighbour of the last tried probe in the direction in which the ray
// was lost.
uint olx_next_neighbour(olx_search s, uint last) {
  if (s.attempts == 0u) return olx_voronoi_nearest(s.origin, s.settings.keep_buried);
  precise vec3 stuck = olx_ray_point(s, s.t) - olx_probe_position(last);
  uvec4 choices = olx_voronoi_neighbours(last, stuck);
  for (uint i = 0u; i < OLX_CHOICES; i++) {
    if (choices[i] != OLX_NO_PROBE && olx_usable(s, choices[i]) && !olx_was_asked(s, choices[i])) return choices[i];
  }
  return OLX_NO_PROBE;
}

// Returns the best probe that sees the sought place. From the probes that the bricks list there, the first is one near
// the origin and the ray's line, and later ones are the nearest; from all probes, it is the nearest. Costs are
// recomputed for each probe and not stored.
uint olx_best_that_sees(olx_search s, bool everywhere) {
  vec3 place = s.origin;
  if (s.attempts > 0u) place = olx_ray_point(s, s.lost);
  uint list = everywhere ? 0u : olx_bricks_list(place), best = OLX_NO_PROBE;
  uint count = everywhere ? olx_field.probe_count : OLX_BRICK_PROBES;
  float least = OLX_INFINITY;
  for (uint i = 0u; i < count; i++) {
    uint probe = i;
    if (!everywhere) probe = olx_bricks_probe(list, i);
    if (!everywhere && probe == OLX_BRICK_NO_PROBE) break;
    if (!olx_usable(s, probe) || olx_was_asked(s, probe)) continue;
    precise vec3 offset = olx_probe_position(probe) - place;
    precise float from_line = everywhere || s.attempts > 0u ? 0.0 : OLX_OFF_LINE * olx_line_distance_squared(s, probe);
    precise float cost = olx_dot(offset, offset) + from_line;
    if (cost >= least || !olx_sees(s, probe)) continue;
    least = cost;
    best = probe;
  }
  return best;
}

// Returns the next probe to try: the selector's or, with `everywhere`, any that sees the place where the ray was lost.
// This function and those that it calls return OLX_NO_PROBE when there is none.
uint olx_next_probe(olx_search s, bool everywhere, uint last) {
  uint select = olx_select_resolve(s.settings.select);
  if (everywhere || select == OLX_SELECT_BRICKS) return olx_best_that_sees(s, everywhere);
  if (select == OLX_SELECT_CAGE) return olx_next_corner(s);
  if (select == OLX_SELECT_VORONOI) return olx_next_neighbour(s, last);
  return OLX_NO_PROBE;
}

// Tries probe after probe, first those of the selector, then a few others. Returns true when one resolves the ray. Rays
// are traced at one place in the code, because compilers inline the whole march there; rays for which the selector has
// no more probes wait until all rays beside them are as far.
bool olx_search_probes(inout olx_search s) {
  bool settled = false, exhaustive = olx_select_resolve(s.settings.select) == OLX_SELECT_EXHAUSTIVE;
  uint last = OLX_NO_PROBE, most = s.settings.max_probes, left_out = 0u;
  for (uint part = 0u; part < 2u; part++) {
    if (part != 0u && s.attempts > 0u && !exhaustive) { // counted as tries, so that no other limit is kept
      left_out = max(most - min(most, OLX_MOST_FAR), s.attempts) - s.attempts;
      s.attempts += left_out;
    }
    while (!settled && s.attempts < most) {
      uint next = olx_next_probe(s, part != 0u, last);
      if (next == OLX_NO_PROBE) break;
      last = next;
      settled = olx_ask(s, next);
    }
  }
  s.attempts -= left_out;
  return settled;
}

// Returns the sky's radiance in the ray's direction, from the first probe that sees it there; 0 when none does.
vec3 olx_sky_radiance(vec3 direction) {
  ivec2 texel = olx_texel_towards(direction);
  vec3 radiance = vec3(0.0);
  for (uint probe = 0u; probe < olx_field.probe_count; probe++) {
    ivec3 map = olx_map_origin(probe);
    if (olx_texel_distance(map, texel) < OLX_INFINITY) continue;
    radiance = olx_texel_emission(probe, texel);
    break;
  }
  return radiance;
}

// Returns the hit of a ray for which no probe has any data.
olx_trace_hit olx_unknown_hit(uint status, float distance_metres) {
  vec3 none = vec3(0.0);
  return olx_trace_hit(status, distance_metres, none, none, none, none, none, false, OLX_NO_PROBE, ivec2(0), 0.0,
                       0u, 0u);
}

// Reads the light stored in the hit's texel. A ray that vanished behind an emitter does not meet it.
void olx_read_light(olx_search s, bool vanished, inout olx_trace_hit hit) {
  ivec3 map = olx_map_origin(hit.probe);
  hit.emitter = !vanished && olx_texel_emits(hit.probe, hit.texel);
  if (hit.emitter) hit.emission = olx_texel_emission(hit.probe, hit.texel);
  bool stored = s.settings.hits != OLX_HITS_SHADED;
  if (stored && !hit.emitter) hit.radiance = olx_texel_radiance(map, hit.texel);
  // For a texel that emits, stored radiance is the sum of emitted and reflected light.
  if (!stored || hit.emitter) {
    olx_reflection light = olx_texel_shade(map, hit.texel, hit.position, s.direction, vanished);
    hit.radiance = light.reflected + light.lobe;
    if (!stored) hit.lobe = light.lobe;
  }
}

// Describes the search's answer for a ray with the limit t_max; `vanished`: no probe resolved it, and the answer is the
// best guess.
olx_trace_hit olx_describe(olx_search s, float t_max, bool vanished) {
  olx_probe_answer answer = s.answer;
  olx_trace_hit hit = olx_unknown_hit(answer.status, answer.t);
  hit.position = olx_ray_point(s, answer.t);
  hit.probe = s.answered;
  hit.texel_steps = s.steps;
  hit.probes_tried = s.attempts;
  if (answer.status != OLX_TRACE_MISS) {
    ivec3 map = olx_map_origin(s.answered);
    hit.texel = answer.texel;
    // This is read first, so that compilers reuse in the following lines what is decoded here.
    olx_texel_geometry seen = olx_texel_geometry_of(map, answer.texel);
    hit.normal = seen.normal;
    olx_read_light(s, vanished, hit);
    vec2 uv = olx_octahedral_encode(hit.position - olx_probe_position(s.answered));
    hit.footprint_metres = seen.distance * sqrt(olx_texel_solid_angle_near(uv, olx_field.n));
  } else if (s.t_max < t_max) { // otherwise it ends in free space
    hit.distance_metres = OLX_INFINITY;
    hit.emitter = true;
    hit.emission = olx_sky_radiance(s.direction);
  }
  return hit;
}

// Returns where the ray leaves the scene's bounds for good; 0 when they lie behind it. The bounds are widened by the
// width of two texels on the far side of the scene, so that walls that coincide with the bounds are hit first.
float olx_leave_bounds(vec3 origin, vec3 direction) {
  precise float room = olx_field.distance_scale * 2.0 * OLX_TEXEL_ANGLE / float(olx_field.n);
  float t = OLX_INFINITY;
  for (int axis = 0; axis < 3; axis++) {
    float d = direction[axis];
    if (d == 0.0) continue;
    precise float wall = d > 0.0 ? olx_field.scene_max[axis] + room : olx_field.scene_min[axis] - room;
    precise float leave = (wall - origin[axis]) / d;
    t = min(t, leave);
  }
  return max(t, 0.0);
}

// Traces the ray from `origin` (metres) along the unit vector `direction` to its first hit within t_max_metres
// (OLX_INFINITY for no limit).
olx_trace_hit olx_trace(olx_sample_settings settings, vec3 origin, vec3 direction, float t_max_metres) {
  olx_trace_hit hit = olx_unknown_hit(OLX_TRACE_UNKNOWN, 0.0);
  if (olx_is_ray(origin, direction, t_max_metres)) {
    olx_probe_answer unknown = olx_probe_answer(OLX_TRACE_UNKNOWN, 0.0, ivec2(0), 0.0, 0u);
    float t_max = min(t_max_metres, olx_leave_bounds(origin, direction));
    olx_search s =
        olx_search(settings, origin, direction, 0.0, t_max, 0.0, 0u, uvec4(0u), 0u, unknown, OLX_NO_PROBE);
    bool settled = olx_search_probes(s);
    if (!settled && s.answer.gap < OLX_VANISHED_FOOTPRINTS) s.answer.status = OLX_TRACE_HIT;
    hit.probes_tried = s.attempts;
    if (s.answered != OLX_NO_PROBE) hit = olx_describe(s, t_max_metres, !settled);
  }
  return hit;
}

#endif
