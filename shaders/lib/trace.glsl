// Twin of src/trace/trace.c: a ray against the whole field, probe after probe until one knows (McGuire et al. 2017,
// Listing 1).
#ifndef OLX_TRACE_GLSL
#define OLX_TRACE_GLSL

#include "bricks.glsl"
#include "cage.glsl"
#include "probe_trace.glsl"
#include "select.glsl"
#include "settings.glsl"
#include "sight.glsl"
#include "voronoi.glsl"

const float OLX_HAND_OVER_FOOTPRINTS = 0.5;
const float OLX_VANISHED_FOOTPRINTS = 1.5;
const float OLX_OFF_LINE = 4.0;

struct olx_trace_hit {
  uint status;           // OLX_TRACE_*
  float distance_metres; // along the ray; infinite for a miss to the sky
  vec3 position;
  vec3 normal;   // of the surface, towards the probe that saw it
  vec3 radiance; // of the sky for a miss
  bool emitter;  // the radiance comes straight from an emitter or the sky
  uint probe;    // that answered, or OLX_NO_PROBE
  float footprint_metres;
  uint texel_steps, probes_tried;
};

struct olx_search {
  olx_sample_settings settings;
  vec3 origin, direction;
  float t, t_max; // the ray is known to be free up to t
  float lost;     // where the probe that followed it farthest lost it
  uint attempts, limit;
  uint steps;
  // The best guess should no probe know: the occluder behind which the ray vanished by the smallest gap.
  olx_probe_answer fallback;
  uint fallback_probe;
};

// The probes that the search has asked. Not in olx_search: compilers copy structs, and this is long.
uint olx_asked[OLX_MAX_ATTEMPTS];

bool olx_usable(olx_search s, uint probe) {
  return s.settings.keep_buried || (olx_probes[probe].flags & OLX_PROBE_BURIED) == 0u;
}

// Whether the march can follow a ray at all: a unit direction, and numbers whose squares are finite.
bool olx_is_ray(vec3 origin, vec3 direction, float t_max) {
  float length = olx_dot(direction, direction);
  return olx_dot(origin, origin) < OLX_INFINITY && length > 0.9 && length < 1.1 && t_max > 0.0;
}

bool olx_was_asked(olx_search s, uint probe) {
  for (uint i = 0u; i < s.attempts; i++) {
    if (olx_asked[i] == probe) return true;
  }
  return false;
}

vec3 olx_ray_point(olx_search s, float t) {
  precise vec3 point = s.origin + s.direction * t;
  return point;
}

// Squared distance of a probe from the ray's line.
float olx_line_distance_squared(olx_search s, uint probe) {
  precise vec3 offset = olx_probe_position(probe) - s.origin;
  precise vec3 foot = offset + s.direction * -olx_dot(offset, s.direction);
  return olx_dot(foot, foot);
}

// Whether a probe sees where the ray begins or, once others have lost it, where that was.
bool olx_sees(olx_search s, uint probe) {
  if (s.attempts == 0u) return olx_probe_sees(probe, s.origin, OLX_SIGHT_START, s.direction);
  return olx_probe_sees(probe, olx_ray_point(s, s.lost), OLX_SIGHT_STUCK, vec3(0.0));
}

// Ask one probe. True when it settles the ray.
bool olx_ask(inout olx_search s, uint probe, inout olx_probe_answer answer) {
  olx_asked[s.attempts++] = probe;
  precise vec3 origin = s.origin - olx_probe_position(probe);
  answer = olx_trace_probe(probe, olx_probe_ray(origin, s.direction, s.t, s.t_max), s.settings.tracer);
  s.steps += answer.steps;
  // Lost in front of what the probe stores there, the ray has gone behind nothing: it ends.
  if (answer.status == OLX_TRACE_UNKNOWN && answer.gap < 0.0) answer.status = OLX_TRACE_HIT;
  if (answer.status != OLX_TRACE_UNKNOWN) return true;
  if (s.fallback_probe == OLX_NO_PROBE || answer.gap < s.fallback.gap) {
    s.fallback = answer;
    s.fallback_probe = probe;
  }
  precise vec3 lost = origin + s.direction * answer.t;
  precise float footprint = OLX_TEXEL_ANGLE / float(olx_field.n) * sqrt(olx_dot(lost, lost));
  precise float before = answer.t - OLX_HAND_OVER_FOOTPRINTS * footprint;
  s.t = max(s.t, before);
  s.lost = max(s.lost, answer.t);
  return false;
}

// The corner to begin with: the probe nearest to the ray's line.
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

// Ask the probes of the cage around the ray's free end, and of each further cage the ray advances into.
bool olx_search_cages(inout olx_search s, inout uint probe, inout olx_probe_answer answer) {
  for (;;) {
    olx_cage cage = olx_cage_at(olx_field.grid, olx_ray_point(s, s.lost));
    uint corner = olx_first_corner(s, cage);
    bool moved = false;
    for (uint i = 0u; i < 8u && !moved; i++, corner = (corner + 3u) & 7u) {
      if (!olx_cage_has(cage, corner)) continue;
      probe = olx_cage_probe(olx_field.grid, cage, corner);
      if (!olx_usable(s, probe) || olx_was_asked(s, probe)) continue;
      if (s.attempts >= s.limit) return false;
      if (olx_ask(s, probe, answer)) return true;
      moved = olx_cage_at(olx_field.grid, olx_ray_point(s, s.lost)).base != cage.base;
    }
    if (!moved) return false;
  }
}

// Ask the nearest probe, then from probe to probe the neighbour in whose direction the ray went out of sight.
bool olx_search_voronoi(inout olx_search s, inout uint probe, inout olx_probe_answer answer) {
  uint next = olx_voronoi_nearest(s.origin, s.settings.keep_buried);
  while (next != OLX_NO_PROBE && s.attempts < s.limit) {
    probe = next;
    if (olx_ask(s, probe, answer)) return true;
    precise vec3 stuck = olx_ray_point(s, s.t) - olx_probe_position(probe);
    uvec4 choices = olx_voronoi_neighbours(probe, stuck);
    next = OLX_NO_PROBE;
    for (uint i = 0u; i < OLX_CHOICES && next == OLX_NO_PROBE; i++) {
      if (choices[i] != OLX_NO_PROBE && olx_usable(s, choices[i]) && !olx_was_asked(s, choices[i])) next = choices[i];
    }
  }
  return false;
}

// Of the probes that the bricks list for where the ray stands, the best that sees it: to begin with one near the origin
// and the ray's line, later the nearest. Costs are read and written by constant indices alone, and so stay in registers.
bool olx_next_listed(olx_search s, out uint next) {
  vec3 place = s.origin;
  if (s.attempts > 0u) place = olx_ray_point(s, s.lost);
  uint list = olx_bricks_list(place);
  float cost[OLX_BRICK_PROBES];
  for (uint i = 0u; i < OLX_BRICK_PROBES; i++) {
    uint probe = olx_bricks_probe(list, i);
    cost[i] = OLX_INFINITY;
    if (probe == OLX_BRICK_NO_PROBE) continue;
    precise vec3 offset = olx_probe_position(probe) - place;
    precise float from_line = s.attempts == 0u ? OLX_OFF_LINE * olx_line_distance_squared(s, probe) : 0.0;
    precise float total = olx_dot(offset, offset) + from_line;
    cost[i] = total;
  }
  next = OLX_BRICK_NO_PROBE;
  for (;;) {
    uint best = 0u;
    float least = OLX_INFINITY;
    for (uint i = 0u; i < OLX_BRICK_PROBES; i++) {
      best = cost[i] < least ? i : best;
      least = min(cost[i], least);
    }
    if (least >= OLX_INFINITY) return false;
    for (uint i = 0u; i < OLX_BRICK_PROBES; i++) cost[i] = i == best ? OLX_INFINITY : cost[i];
    uint probe = olx_bricks_probe(list, best);
    if (!olx_usable(s, probe) || olx_was_asked(s, probe)) continue;
    next = probe;
    if (olx_sees(s, probe)) return true;
  }
}

bool olx_search_bricks(inout olx_search s, inout uint probe, inout olx_probe_answer answer) {
  while (s.attempts < s.limit && olx_next_listed(s, probe)) {
    if (olx_ask(s, probe, answer)) return true;
  }
  return false;
}

// Ask whichever other probes see the place where the ray is stuck, nearest first.
bool olx_search_everywhere(inout olx_search s, inout uint probe, inout olx_probe_answer answer) {
  while (s.attempts < s.limit) {
    vec3 place = s.origin;
    if (s.attempts > 0u) place = olx_ray_point(s, s.lost);
    float best_distance = OLX_INFINITY;
    for (uint i = 0u; i < olx_field.probe_count; i++) {
      if (!olx_usable(s, i) || olx_was_asked(s, i)) continue;
      precise vec3 offset = olx_probe_position(i) - place;
      float distance = olx_dot(offset, offset);
      if (distance >= best_distance || !olx_sees(s, i)) continue;
      best_distance = distance;
      probe = i;
    }
    if (best_distance >= OLX_INFINITY) return false;
    if (olx_ask(s, probe, answer)) return true;
  }
  return false;
}

// The sky's radiance in the ray's direction, from the first probe that sees it there; 0 when none does.
vec3 olx_sky_radiance(vec3 direction) {
  ivec2 texel = olx_texel_towards(direction);
  for (uint probe = 0u; probe < olx_field.probe_count; probe++) {
    ivec3 map = olx_map_origin(probe);
    if (olx_texel_distance(map, texel) >= OLX_INFINITY) return olx_texel_radiance(map, texel);
  }
  return vec3(0.0);
}

olx_trace_hit olx_describe(olx_search s, uint probe, olx_probe_answer answer, float t_max) {
  olx_trace_hit hit = olx_trace_hit(answer.status, answer.t, olx_ray_point(s, answer.t), vec3(0.0), vec3(0.0), false,
                                    probe, 0.0, s.steps, s.attempts);
  if (answer.status == OLX_TRACE_MISS) {
    if (s.t_max >= t_max) return hit; // ends in free space
    hit.distance_metres = OLX_INFINITY;
    hit.emitter = true;
    hit.radiance = olx_sky_radiance(s.direction);
    return hit;
  }
  ivec3 map = olx_map_origin(probe);
  hit.radiance = olx_texel_radiance(map, answer.texel);
  hit.emitter = olx_texel_emits(map, answer.texel);
  hit.normal = olx_texel_normal(map, answer.texel);
  vec2 uv = olx_octahedral_encode(hit.position - olx_probe_position(probe));
  hit.footprint_metres = olx_texel_distance(map, answer.texel) * sqrt(olx_texel_solid_angle_near(uv, olx_field.n));
  return hit;
}

// Where the ray leaves the scene's bounds for good, widened by what two texels on the far side of the scene span, so
// that walls which are the bounds are met before; 0 when the bounds lie behind the ray.
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

// Ask the probes that the selector names.
bool olx_search_selected(inout olx_search s, inout uint probe, inout olx_probe_answer answer) {
  switch (olx_select_resolve(s.settings.select)) {
  case OLX_SELECT_CAGE: return olx_search_cages(s, probe, answer);
  case OLX_SELECT_BRICKS: return olx_search_bricks(s, probe, answer);
  case OLX_SELECT_VORONOI: return olx_search_voronoi(s, probe, answer);
  default: return false;
  }
}

// What does the ray from `origin` (metres) along the unit vector `direction` see first, within t_max_metres
// (OLX_INFINITY for no limit)?
olx_trace_hit olx_trace(olx_sample_settings settings, vec3 origin, vec3 direction, float t_max_metres) {
  vec3 none = vec3(0.0);
  olx_trace_hit nothing = olx_trace_hit(OLX_TRACE_UNKNOWN, 0.0, none, none, none, false, OLX_NO_PROBE, 0.0, 0u, 0u);
  if (!olx_is_ray(origin, direction, t_max_metres)) return nothing;
  olx_probe_answer answer = olx_probe_answer(OLX_TRACE_UNKNOWN, 0.0, ivec2(0), 0.0, 0u);
  float t_max = min(t_max_metres, olx_leave_bounds(origin, direction));
  uint limit = min(settings.max_probes, OLX_MAX_ATTEMPTS);
  olx_search s = olx_search(settings, origin, direction, 0.0, t_max, 0.0, 0u, limit, 0u, answer, OLX_NO_PROBE);
  uint probe = 0u;
  if (olx_search_selected(s, probe, answer) || olx_search_everywhere(s, probe, answer)) {
    return olx_describe(s, probe, answer, t_max_metres);
  }
  if (s.fallback_probe != OLX_NO_PROBE && s.fallback.gap < OLX_VANISHED_FOOTPRINTS) s.fallback.status = OLX_TRACE_HIT;
  if (s.fallback_probe != OLX_NO_PROBE) return olx_describe(s, s.fallback_probe, s.fallback, t_max_metres);
  nothing.probes_tried = s.attempts;
  return nothing;
}

#endif
