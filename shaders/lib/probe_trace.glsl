// Twin of src/trace/probe_trace.c, ray_image.h, surfel.c and the three tracers: traces a ray against what one probe
// sees (McGuire et al. 2017, section 4.1; Wang 2018, section 4.3). Values that decide are `precise`, because each
// crossing must be the same wherever it is computed.
//
// SPDX-License-Identifier: MIT
#ifndef OLX_PROBE_TRACE_GLSL
#define OLX_PROBE_TRACE_GLSL

#include "maps.glsl"


// A ray relative to a probe: all distances in metres along the unit direction.
struct olx_probe_ray {
  vec3 origin; // from the probe's centre
  vec3 direction;
  float t_min, t_max;
};

struct olx_probe_answer {
  uint status;
  float t;     // HIT: of the hit; UNKNOWN: where the ray became hidden; MISS: t_max
  ivec2 texel; // HIT: the one hit; UNKNOWN: the one that hides the ray; MISS: the one in the ray's direction
  float gap;   // UNKNOWN: how far the ray was behind the hiding texel's surface, in footprints
  uint steps;  // number of distances read, of texels and of blocks
};

// What is constant for one ray and one probe. The squared distance is r^2(t) = miss^2 + (t - closest)^2.
struct olx_march {
  olx_probe_ray ray;
  ivec3 map;  // where the probe's map begins
  uint least; // where the probe's pyramid begins
  float closest, miss_squared;
  uint steps;
  ivec2 place; // of the geometry block read last; negative: none
  uvec4 block;
};

// One coordinate of the image, in texels: begin + travel s. Line k is crossed at s = (k - begin) * inverse. For an
// image that counts as a point, `begin` is the middle of a texel and no line is ever reached.
struct olx_image_axis {
  float begin, travel, inverse;
  int first; // texel where the image begins
};

// A part of the ray whose image lies on one face of the octahedron.
struct olx_piece {
  olx_image_axis u, v;
  float t_begin, t_end, rise, near, slope; // t(s) = t_begin + rise s / (near + slope s)
  vec3 sign;                               // of the octant
};

// The texel that the march has reached, and the ray's parameter where it entered it.
struct olx_cell {
  ivec2 at;
  float t;
};


// Returns the direction of travel along an axis: -1, 0, 1.
int olx_axis_step(olx_image_axis a) { return int(a.travel > 0.0) - int(a.travel < 0.0); }

// Returns the number of the line ahead of texel x, minus x.
int olx_axis_ahead(olx_image_axis a) { return int(a.travel >= 0.0); }

float olx_radius_squared(olx_march m, float t) {
  precise float along = t - m.closest;
  precise float squared = m.miss_squared + along * along;
  return squared;
}

// Returns the ray's greatest squared distance from the probe over [t0, t1]. It is convex in t, so it is at one of the
// ends.
float olx_farthest_squared(olx_march m, float t0, float t1) {
  return max(olx_radius_squared(m, t0), olx_radius_squared(m, t1));
}

// Bounds the squared distance from the probe over [t0, t1] from above. The bound holds for any part of the interval,
// even when rounding moves the part's ends.
float olx_reach_squared(olx_march m, olx_piece p, float t0, float t1) {
  // This is how far rounding may move t(s), in metres.
  precise float slack = p.t_end < OLX_INFINITY ? OLX_PARAMETER_ROUNDING * p.t_end : 0.0;
  precise float along = max(m.closest - t0, t1 - m.closest) + slack;
  precise float squared = (m.miss_squared + along * along) * (1.0 + 1.0 / 65536.0);
  return squared;
}

float olx_nearest_squared(olx_march m, float t0, float t1) {
  return olx_radius_squared(m, clamp(m.closest, t0, t1));
}

// Returns the texel at an image coordinate, within the half of the map on the side of the sign.
int olx_clamp_texel(float sign, float image, int n) {
  int first = sign > 0.0 ? n / 2 : 0, last = first + n / 2 - 1;
  return image > float(last) ? last : image > float(first) ? int(image) : first;
}

// Computes the image of the ray at any parameter, on the face of the piece, in texels; false where the face has none.
bool olx_image_at(olx_march m, olx_piece p, float t, out vec2 image) {
  precise vec3 at = p.sign * (m.ray.origin + m.ray.direction * t);
  precise float sum = at.x + at.y + at.z;
  image = vec2(0.0);
  if (!(sum > 0.0)) return false;
  precise float inverse = 1.0 / sum, middle = 0.5 * float(olx_field.n);
  precise vec2 q = p.sign.y > 0.0 ? at.xz * inverse : 1.0 - at.zx * inverse;
  precise vec2 result = middle + middle * p.sign.xz * q;
  image = result;
  return true;
}

// Returns the ray's parameter at s; for s of 1 and more, the end of the piece.
float olx_parameter_at(olx_piece p, float s) {
  precise float t = p.t_begin + p.rise * s / (p.near + p.slope * s);
  return s >= 1.0 ? p.t_end : t;
}

// Returns the s at which the image crosses the line between texels k - 1 and k. Lines beyond the end of the piece give
// 1 or more.
float olx_crossing(olx_image_axis a, int k) {
  precise float s = (float(k) - a.begin) * a.inverse;
  return s;
}

// Returns the texel along one axis that stepping has reached at s; a line crossed exactly at s counts as passed when
// `inclusive`. A guess from the image is off by one texel at most; the crossings that steps compare then decide.
int olx_texel_at(olx_image_axis a, float s, bool inclusive) {
  precise float image = a.begin + a.travel * s;
  int x = int(image), step = olx_axis_step(a), ahead = olx_axis_ahead(a);
  if ((x - a.first) * step <= 0) {
    x = a.first;
  } else {
    float entered = olx_crossing(a, x + 1 - ahead);
    if (!(inclusive ? entered <= s : entered < s)) x -= step;
  }
  float left = olx_crossing(a, x + ahead);
  return (inclusive ? left <= s : left < s) ? x + step : x;
}

int olx_pyramid_shift(int level) { return OLX_PYRAMID_FINEST + OLX_PYRAMID_STEP * level; }

// Returns the index of a node within its level. Tiles of 4 x 4 nodes keep the children of one parent together.
uint olx_pyramid_index(uint side, uvec2 node) {
  if (side < 4u) return node.y * side + node.x;
  return ((node.y >> 2) * (side >> 2) + (node.x >> 2)) * 16u + (node.y & 3u) * 4u + (node.x & 3u);
}

// Returns the smallest squared distance in a node of the pyramid.
float olx_least_squared(inout olx_march m, int level, ivec2 node) {
  m.steps++;
  uint at = m.least + olx_field.pyramid_first[level] +
            olx_pyramid_index(olx_field.n >> uint(olx_pyramid_shift(level)), uvec2(node));
  uint code = olx_word(at >> 1) >> (at & 1u) * 16u & 0x7FFFu;
  precise float distance = min(olx_half_unpack(code), 65536.0) * olx_field.distance_scale; // the limit is for the sky
  precise float squared = distance * distance;
  return squared;
}

// The surfel of a texel in relation to the ray: f(t) = f0 + f1 t is the ray's height above its plane.
struct olx_surfel {
  float distance;  // stored, metres
  float footprint; // metres: distance times the square root of the texel's solid angle
  float slack;     // uncertainty of its depth, metres
  float cosine;    // of the angle at which the probe sees it
  float f0, f1;
};

olx_surfel olx_read_surfel(olx_march m, ivec2 at, float distance) {
  precise float inverse_n = 1.0 / float(olx_field.n);
  precise vec2 uv = (vec2(at) + 0.5) * inverse_n;
  precise vec3 q = olx_octahedral_point(uv);
  precise float inverse_length = 1.0 / sqrt(olx_dot(q, q));
  precise float footprint = distance * 2.0 * inverse_n * inverse_length * sqrt(inverse_length);
  precise float slack = distance * OLX_DISTANCE_PRECISION + footprint;
  vec3 normal = olx_texel_normal(m.map, at);
  precise float cosine = -olx_dot(normal, q) * inverse_length;
  precise float f0 = olx_dot(normal, m.ray.origin) + distance * cosine;
  return olx_surfel(distance, footprint, slack, cosine, f0, olx_dot(normal, m.ray.direction));
}

// Returns how far below a surfel's plane the ray may be and still count as on it, in metres.
float olx_plane_tolerance(olx_surfel s) {
  precise float tolerance = s.distance * OLX_DISTANCE_PRECISION * max(s.cosine, 0.0) + 0.005 * s.footprint;
  return tolerance;
}

// Returns whether a squared distance from the probe is beyond the surface inside a texel. The surface reaches as far as
// its plane tilted away by a texel, but no farther than its neighbours, which are read only when the tilted plane does
// not decide.
bool olx_beyond_reach(inout olx_march m, ivec2 at, olx_surfel s, float radius_squared) {
  precise float own = s.distance + s.slack;
  precise float own_squared = own * own;
  if (radius_squared <= own_squared) return false;
  precise float sine = sqrt(max(0.0, 1.0 - s.cosine * s.cosine));
  precise float spread = s.cosine - sine * s.footprint / s.distance;
  precise float tilted = (spread > 0.0 ? s.distance * s.cosine / spread : OLX_INFINITY) + s.slack;
  precise float tilted_squared = tilted * tilted;
  if (radius_squared > tilted_squared) return true;
  float farthest = 0.0;
  for (int i = 0; i < 9; i++) farthest = max(farthest, olx_texel_distance(m.map, at + ivec2(i % 3 - 1, i / 3 - 1)));
  m.steps += 8u;
  precise float limit = farthest + s.slack;
  precise float limit_squared = limit * limit;
  return radius_squared > limit_squared;
}

// Returns whether the ray's image at t lies within the neighbourhood of a texel, and the texel at that image sees a
// surface about as far away. If that texel sees far beyond the point, the plane ends at an edge between the two texels.
bool olx_supported(inout olx_march m, olx_piece p, ivec2 at, olx_surfel s, float t) {
  vec2 image;
  if (!olx_image_at(m, p, t, image)) return false;
  precise vec2 off = image - (vec2(at) + 0.5);
  if (abs(off.x) > OLX_NEIGHBOURHOOD_TEXELS || abs(off.y) > OLX_NEIGHBOURHOOD_TEXELS) return false;
  int n = int(olx_field.n);
  m.steps++;
  float stored = olx_texel_distance(
      m.map, ivec2(olx_clamp_texel(p.sign.x, image.x, n), olx_clamp_texel(p.sign.z, image.y, n)));
  precise float slope = 1.0 / max(s.cosine, 0.1);
  precise float reach = sqrt(olx_radius_squared(m, t)) + s.footprint * slope;
  return stored <= reach;
}

// Judges a ray above, on or below the surfel's plane in texel c, which it leaves at t1. A ray that is lost behind the
// end of the plane is lost where it crosses it.
int olx_judge_height(inout olx_march m, olx_piece p, olx_cell c, float t1, olx_surfel s,
                     inout olx_probe_answer answer) {
  float tolerance = olx_plane_tolerance(s);
  precise float height0 = s.f0 + s.f1 * c.t;
  precise float plane = -s.f0 / s.f1;
  if (height0 >= -tolerance) {
    precise float height1 = s.f0 + s.f1 * t1;
    if (t1 >= OLX_INFINITY) height1 = s.f1 < 0.0 ? -OLX_INFINITY : OLX_INFINITY;
    if (height1 >= -tolerance) return OLX_VERDICT_CLEAR; // above the plane throughout the texel
    answer.t = clamp(plane, c.t, t1);
    return olx_beyond_reach(m, c.at, s, olx_radius_squared(m, answer.t)) ? OLX_VERDICT_HIDDEN : OLX_VERDICT_HIT;
  }
  if (s.f1 >= 0.0) {
    // Below, but rising: a ray that has just left this surface is still within the error of rounding and curvature. One
    // that began farther below passes through the surface from behind.
    return -min(height0, s.f0) <= 0.5 * s.footprint ? OLX_VERDICT_CLEAR : OLX_VERDICT_HIDDEN;
  }
  // A ray taken over from another probe may have slipped through this surface by that probe's tolerance, but no ray
  // starts behind the surface that it is about to hit.
  float slip = m.ray.t_min > 0.0 ? s.footprint : 0.0;
  precise float height_min = s.f0 + s.f1 * m.ray.t_min;
  if (plane < m.ray.t_min && height_min < -slip) return OLX_VERDICT_HIDDEN;
  if (!olx_supported(m, p, c.at, s, plane)) return OLX_VERDICT_HIDDEN;
  answer.t = max(plane, m.ray.t_min);
  return OLX_VERDICT_HIT;
}

// Judges by the surfel of texel c a ray that reaches the stored distance (metres) inside the texel, which it leaves at
// t1.
int olx_judge_surfel(inout olx_march m, olx_piece p, olx_cell c, float t1, float stored,
                     inout olx_probe_answer answer) {
  olx_surfel s = olx_read_surfel(m, c.at, stored);
  float nearest_squared = olx_nearest_squared(m, c.t, t1);
  answer.texel = c.at;
  answer.t = c.t;
  int verdict = OLX_VERDICT_HIDDEN;
  if (!olx_beyond_reach(m, c.at, s, nearest_squared)) verdict = olx_judge_height(m, p, c, t1, s, answer);
  if (answer.t > c.t) nearest_squared = olx_radius_squared(m, answer.t);
  precise float gap = (sqrt(nearest_squared) - stored) / s.footprint;
  if (verdict == OLX_VERDICT_HIDDEN) answer.gap = gap;
  return verdict;
}

// Reads the geometry block at `place`.
void olx_read_block(inout olx_march m, ivec2 place) {
  if (m.place == place) return;
  m.place = place;
  m.block = olx_geometry_block(m.map, place);
  m.steps++;
}

// Returns whether the ray is in front of or on a plane all over [t0, t1]. The sky is clear.
bool olx_plane_clears(olx_march m, vec3 plane, float t0, float t1) {
  float base = olx_dot(plane, m.ray.origin), slope = olx_dot(plane, m.ray.direction);
  precise float begin = base + slope * t0, end = base + slope * t1;
  bool ends_behind = t1 < OLX_INFINITY ? end > 1.0 : slope > 0.0;
  return !ends_behind && !(begin > 1.0);
}

// Returns |x| + |y| + |z| of the ray's point at t, relative to the probe.
float olx_octahedral_depth(olx_march m, olx_piece p, float t) {
  precise float depth = olx_dot(p.sign, m.ray.origin) + olx_dot(p.sign, m.ray.direction) * t;
  return depth;
}

// Returns whether the ray is in front of or on every plane of the block read last, over [t0, t1] and any part of it,
// even when rounding moves the part's ends. Planes in the pool are not read: the block's greatest inverse depth is used
// instead.
bool olx_block_clears(olx_march m, olx_piece p, float t0, float t1) {
  precise float slack = p.t_end < OLX_INFINITY ? OLX_PARAMETER_ROUNDING * p.t_end : 0.0;
  precise float begin = t0 - slack, end = t1 + slack;
  uint form = m.block.w >> 30, n = olx_field.n;
  uvec2 place = uvec2(m.place);
  bool clears = form <= OLX_GEOMETRY_TWO;
  if (form == OLX_GEOMETRY_POOL) {
    precise float depth = max(olx_octahedral_depth(m, p, begin), olx_octahedral_depth(m, p, end));
    precise float share = depth * olx_geometry_nearest(m.block);
    return t1 < OLX_INFINITY && share < 1.0 - 1.0 / 65536.0;
  }
  for (uint i = 0u; i <= form && clears; i++) {
    vec3 plane = uintBitsToFloat(m.block.xyz);
    if (form == OLX_GEOMETRY_TWO) plane = olx_plane_decode(i == 0u ? m.block.xz : m.block.yw, n, place);
    clears = olx_plane_clears(m, plane, begin, end);
  }
  return clears;
}

// Returns whether the ray reaches the plane of a texel of a field of geometry blocks, over [t0, t1]; `stored` receives
// the texel's distance.
bool olx_reaches_plane(inout olx_march m, ivec2 at, float t0, float t1, out float stored) {
  stored = OLX_INFINITY;
  olx_read_block(m, at >> OLX_PYRAMID_FINEST);
  if (m.block.w >> 30 > OLX_GEOMETRY_TWO) m.steps++;
  vec3 plane = olx_plane_in_block(m.block, at);
  if (olx_plane_clears(m, plane, t0, t1)) return false;
  stored = olx_plane_distance(plane, olx_texel_direction(uvec2(at), olx_field.n));
  precise float stored_squared = stored * stored;
  return !(olx_farthest_squared(m, t0, t1) < stored_squared || stored >= OLX_INFINITY);
}

// Reads a texel and returns whether the ray reaches what it sees, over [t0, t1]; `stored` receives the texel's
// distance.
bool olx_reaches_texel(inout olx_march m, ivec2 at, float t0, float t1, out float stored) {
  if (olx_geometry_in_blocks()) return olx_reaches_plane(m, at, t0, t1, stored);
  m.steps++;
  stored = olx_texel_distance(m.map, at);
  precise float stored_squared = stored * stored;
  return !(olx_farthest_squared(m, t0, t1) < stored_squared || stored >= OLX_INFINITY);
}

// Returns the texel after c, where s holds the crossings of the lines ahead and t1 is the ray's parameter at the nearer
// one.
olx_cell olx_next_cell(olx_piece p, olx_cell c, vec2 s, float t1) {
  return olx_cell(c.at + (s.x <= s.y ? ivec2(olx_axis_step(p.u), 0) : ivec2(0, olx_axis_step(p.v))), t1);
}

// Returns where the image crosses the lines ahead of a node of 2^shift texels, along both axes.
vec2 olx_crossings_ahead(olx_piece p, ivec2 node, int shift) {
  return vec2(olx_crossing(p.u, (node.x + olx_axis_ahead(p.u)) << shift),
              olx_crossing(p.v, (node.y + olx_axis_ahead(p.v)) << shift));
}

// Visits every texel, without a pyramid: the reference.
int olx_march_texels(inout olx_march m, olx_piece p, inout olx_probe_answer answer) {
  olx_cell c = olx_cell(ivec2(p.u.first, p.v.first), p.t_begin);
  for (;;) {
    vec2 s = olx_crossings_ahead(p, c.at, 0);
    float s1 = min(s.x, s.y), t1 = olx_parameter_at(p, s1);
    int verdict = OLX_VERDICT_CLEAR;
    float stored;
    if (olx_reaches_texel(m, c.at, c.t, t1, stored)) verdict = olx_judge_surfel(m, p, c, t1, stored, answer);
    if (verdict != OLX_VERDICT_CLEAR || s1 >= 1.0) return verdict;
    c = olx_next_cell(p, c, s, t1);
  }
}

// Skips blocks whose smallest distance is beyond the ray. Blocks and texels take turns in one loop that judges no
// surfel, so that little is kept while one is judged; the texel judged clear is then left without being read again.
int olx_march_two_level(inout olx_march m, olx_piece p, inout olx_probe_answer answer) {
  int level = olx_field.pyramid_levels > 1u ? 1 : 0, shift = olx_pyramid_shift(level), verdict = OLX_VERDICT_CLEAR;
  olx_cell c = olx_cell(ivec2(p.u.first, p.v.first), p.t_begin);
  bool inside = false, found = false; // inside a block that the ray reaches; at a texel that it reaches
  do {
    bool judged = found, ended = false;
    float stored = OLX_INFINITY;
    found = false;
    while (!found && !ended) {
      vec2 s = olx_crossings_ahead(p, inside ? c.at : c.at >> shift, inside ? 0 : shift);
      float s1 = min(s.x, s.y), t1 = olx_parameter_at(p, s1);
      if (inside) {
        if (!judged) found = olx_reaches_texel(m, c.at, c.t, t1, stored);
        judged = false;
        ended = s1 >= 1.0;
        if (!found && !ended) {
          olx_cell next = olx_next_cell(p, c, s, t1);
          inside = next.at >> shift == c.at >> shift;
          c = next;
        }
      } else if (olx_reach_squared(m, p, c.t, t1) < olx_least_squared(m, level, c.at >> shift)) {
        ended = s1 >= 1.0;
        bool by_v = s.x > s.y; // ties step along u first
        if (!ended) c = olx_cell(ivec2(olx_texel_at(p.u, s1, true), olx_texel_at(p.v, s1, by_v)), t1);
      } else {
        inside = true;
      }
    }
    if (found) {
      vec2 s = olx_crossings_ahead(p, c.at, 0);
      verdict = olx_judge_surfel(m, p, c, olx_parameter_at(p, min(s.x, s.y)), stored, answer);
    }
  } while (found && verdict == OLX_VERDICT_CLEAR);
  return verdict;
}

// Marches one piece by every texel or by blocks.
int olx_march_piece(inout olx_march m, olx_piece p, uint tracer, inout olx_probe_answer answer) {
  if (tracer == OLX_TRACER_TEXEL) return olx_march_texels(m, p, answer);
  return olx_march_two_level(m, p, answer);
}

// One end of a piece.
struct olx_piece_end {
  vec2 image;
  float inverse; // 1 / |P|_1; 0 at infinity
  bool centre;   // too close to the probe's centre to have an image
};

olx_piece_end olx_end_at(olx_march m, vec3 sign, float t) {
  vec3 o = m.ray.origin, d = m.ray.direction;
  bool endless = t >= OLX_INFINITY;
  precise vec3 along = o + d * t;
  precise vec3 at = sign * (endless ? d : along);
  precise float sum = at.x + at.y + at.z;
  precise float least = OLX_CENTRE_SHARE * (abs(o.x) + abs(o.y) + abs(o.z));
  bool centre = !endless && sum <= least;
  precise float inverse = 1.0 / (centre ? max(least, 1.0 / OLX_NEVER) : sum), middle = 0.5 * float(olx_field.n);
  precise vec2 q = sign.y > 0.0 ? at.xz * inverse : 1.0 - at.zx * inverse;
  precise vec2 image = middle + middle * sign.xz * clamp(q, 0.0, 1.0);
  return olx_piece_end(image, endless ? 0.0 : inverse, centre);
}

olx_image_axis olx_make_axis(float begin, float end, float sign, int n) {
  precise float travel = end - begin;
  int first = olx_clamp_texel(sign, begin, n);
  // Lines ahead of a point are never crossed, and those behind always have been.
  if (!(abs(travel) > OLX_STILL_TEXELS)) return olx_image_axis(float(first) + 0.5, 0.0, OLX_NEVER, first);
  // Slightly more than 1 / travel, so that rounding never puts a line from `end` on before the end.
  precise float inverse = (1.0 + 1.0 / 2097152.0) / travel;
  return olx_image_axis(begin, travel, inverse, first);
}

// Returns where the ray crosses the plane through the probe across one axis; -infinity when it is parallel to it.
float olx_plane_at(float o, float d) {
  precise float t = -o / d;
  return d == 0.0 ? -OLX_INFINITY : t;
}

// Returns the ray's parameters at the three coordinate planes through the probe.
vec3 olx_planes_of(olx_probe_ray ray) {
  return vec3(olx_plane_at(ray.origin.x, ray.direction.x), olx_plane_at(ray.origin.y, ray.direction.y),
              olx_plane_at(ray.origin.z, ray.direction.z));
}

// Returns the sign of a coordinate o + d t just after t; `plane` is where it is zero.
float olx_sign_after(float o, float d, float plane, float t) {
  if (d == 0.0) return olx_sign_not_zero(o);
  return t >= plane ? olx_sign_not_zero(d) : -olx_sign_not_zero(d);
}

olx_piece olx_make_piece(olx_march m, vec3 planes, float t_begin, float t_end) {
  vec3 o = m.ray.origin, d = m.ray.direction;
  bool endless = t_end >= OLX_INFINITY;
  olx_piece p;
  p.t_begin = t_begin;
  p.t_end = t_end;
  p.sign = vec3(olx_sign_after(o.x, d.x, planes.x, t_begin), olx_sign_after(o.y, d.y, planes.y, t_begin),
                olx_sign_after(o.z, d.z, planes.z, t_begin));
  olx_piece_end begin = olx_end_at(m, p.sign, t_begin), end = olx_end_at(m, p.sign, t_end);
  // The image of the other end represents the whole piece.
  if (begin.centre) begin.image = end.image;
  if (begin.centre || end.centre) end.image = begin.image;
  int n = int(olx_field.n);
  p.u = olx_make_axis(begin.image.x, end.image.x, p.sign.x, n);
  p.v = olx_make_axis(begin.image.y, end.image.y, p.sign.z, n);
  precise float slope = end.inverse - begin.inverse, rise = (t_end - t_begin) * end.inverse;
  precise float endless_rise = 1.0 / (p.sign.x * d.x + p.sign.y * d.y + p.sign.z * d.z);
  p.near = begin.inverse;
  p.slope = slope;
  p.rise = endless ? endless_rise : rise;
  return p;
}

// Returns the next parameter after t at which the ray crosses one of these planes, or t_max.
float olx_next_cut(vec3 planes, float t, float t_max) {
  float next = t_max;
  if (planes.x > t) next = min(next, planes.x);
  if (planes.y > t) next = min(next, planes.y);
  if (planes.z > t) next = min(next, planes.z);
  return next;
}

// The node that the march through the pyramid has reached, and where the ray entered it. Texels are nodes of level -1.
struct olx_stand {
  ivec2 at;
  int level;
  float s, t;
  // True when the node was entered across a line of v: then the lines of both axes up to s are passed, otherwise not
  // those of v at s.
  bool by_v;
  float least_squared; // of the node of level 0 around a texel: texels that the ray passes nearer are not read
  bool first;          // a texel that is read before anything else
  bool judged;         // a texel whose surfel has been judged clear
};

// Returns where the march over a piece begins: at a small node for the first piece, because a ray begins at a surface,
// and at a large one in the open space of later pieces. A ray taken over from another probe begins at its first texel,
// which often hides it.
olx_stand olx_begin_stand(olx_march m, olx_piece p) {
  bool first_piece = p.t_begin <= m.ray.t_min, first = first_piece && p.t_begin > 0.0;
  int level = first ? -1 : first_piece ? 0 : int(olx_field.pyramid_levels) - 1;
  ivec2 texel = ivec2(p.u.first, p.v.first);
  return olx_stand(texel >> olx_pyramid_shift(level), level, -1.0, p.t_begin, false, 0.0, first, false);
}

// Descends to the child node that the march has reached.
void olx_enter(olx_piece p, inout olx_stand at) {
  at.level--;
  at.at = ivec2(olx_texel_at(p.u, at.s, true), olx_texel_at(p.v, at.s, at.by_v)) >> olx_pyramid_shift(at.level);
}

// Steps over the nearest line ahead, and ascends a level if that leaves the parent node too; from a texel whose level 0
// node is left as well, it ascends two.
void olx_leave(inout olx_stand at, ivec2 next, float s, float t, bool by_v) {
  ivec2 sides = next ^ at.at;
  int left = (sides.x | sides.y) >> OLX_PYRAMID_STEP, highest = int(olx_field.pyramid_levels) - 1;
  int up = left == 0 ? 0 : at.level < 0 && left >> OLX_PYRAMID_STEP != 0 ? 2 : 1;
  up = min(up, highest - at.level);
  at = olx_stand(next >> OLX_PYRAMID_STEP * up, at.level + up, s, t, by_v, at.least_squared, false, false);
}

// Moves on to the next texel whose stored distance the ray reaches. Nodes and texels take turns in one loop that judges
// no surfel, so that rays side by side wait little for each other. Returns false at the end of the piece.
bool olx_find_texel(inout olx_march m, olx_piece p, inout olx_stand at, out float stored) {
  bool found = false, blocks = olx_geometry_in_blocks();
  stored = OLX_INFINITY;
  for (;;) {
    vec2 s = olx_crossings_ahead(p, at.at, olx_pyramid_shift(at.level));
    float s1 = min(s.x, s.y), t1 = olx_parameter_at(p, s1);
    bool enter = false;
    if (blocks && at.level == 0) {
      olx_read_block(m, at.at);
      enter = !olx_block_clears(m, p, at.t, t1);
    } else if (at.level >= 0) {
      at.least_squared = olx_least_squared(m, at.level, at.at);
      enter = !(olx_reach_squared(m, p, at.t, t1) < at.least_squared);
    } else if (blocks && !at.judged) {
      found = olx_reaches_plane(m, at.at, at.t, t1, stored);
    } else if (!at.judged) {
      float far_squared = olx_farthest_squared(m, at.t, t1);
      if (!(far_squared < at.least_squared)) {
        m.steps++;
        stored = olx_texel_distance(m.map, at.at);
        precise float stored_squared = stored * stored;
        found = !(far_squared < stored_squared || stored >= OLX_INFINITY);
      }
    }
    if (found || (!enter && !at.first && s1 >= 1.0)) break;
    if (enter) {
      olx_enter(p, at);
    } else if (at.first) {
      at = olx_stand(at.at >> OLX_PYRAMID_FINEST, 0, -1.0, p.t_begin, false, 0.0, false, false);
    } else {
      bool by_v = s.x > s.y;
      olx_leave(at, at.at + (by_v ? ivec2(0, olx_axis_step(p.v)) : ivec2(olx_axis_step(p.u), 0)), s1, t1, by_v);
    }
  }
  return found;
}

// Descends and ascends the whole pyramid along all pieces of a ray. A ray that reaches the next face and one that has a
// surfel to judge do so in the same iteration. Coordinate planes are recomputed for each piece, so that less is kept
// between.
int olx_march_hiz(inout olx_march m, inout olx_probe_answer answer) {
  // These initial values are never read; without them, compilers keep those of the ray's last probe.
  olx_image_axis axis = olx_image_axis(0.0, 0.0, 0.0, 0);
  olx_piece p = olx_piece(axis, axis, 0.0, 0.0, 0.0, 0.0, 0.0, vec3(0.0));
  olx_stand at = olx_stand(ivec2(0), 0, 0.0, 0.0, false, 0.0, false, false);
  int verdict = OLX_VERDICT_CLEAR;
  bool found = false;
  p.t_end = m.ray.t_min;
  for (;;) {
    if (!found) {
      if (!(p.t_end < m.ray.t_max)) break;
      vec3 planes = olx_planes_of(m.ray);
      p = olx_make_piece(m, planes, p.t_end, olx_next_cut(planes, p.t_end, m.ray.t_max));
      at = olx_begin_stand(m, p);
    }
    float stored;
    found = olx_find_texel(m, p, at, stored);
    if (!found) continue;
    vec2 s = olx_crossings_ahead(p, at.at, 0);
    float t1 = olx_parameter_at(p, min(s.x, s.y));
    verdict = olx_judge_surfel(m, p, olx_cell(at.at, at.t), t1, stored, answer);
    if (verdict != OLX_VERDICT_CLEAR) break;
    at.judged = true;
  }
  return verdict;
}

// Marches face after face with the tracers that use no full pyramid.
int olx_march_pieces(inout olx_march m, uint tracer, inout olx_probe_answer answer) {
  vec3 planes = olx_planes_of(m.ray);
  for (float t = m.ray.t_min; t < m.ray.t_max;) {
    float t_end = olx_next_cut(planes, t, m.ray.t_max);
    int verdict = olx_march_piece(m, olx_make_piece(m, planes, t, t_end), tracer, answer);
    if (verdict != OLX_VERDICT_CLEAR) return verdict;
    t = t_end;
  }
  return OLX_VERDICT_CLEAR;
}

// Computes what is constant for the march of a ray through a probe's map.
olx_march olx_begin_march(uint probe, olx_probe_ray ray) {
  olx_march m;
  precise float closest = -olx_dot(ray.origin, ray.direction);
  precise vec3 foot = ray.origin + ray.direction * closest;
  m.ray = ray;
  m.map = olx_map_origin(probe);
  m.least = probe * olx_field.least_nodes;
  m.closest = closest;
  m.miss_squared = olx_dot(foot, foot);
  m.steps = 0u;
  m.place = ivec2(-1);
  m.block = uvec4(0u);
  return m;
}

olx_probe_answer olx_trace_probe(uint probe, olx_probe_ray ray, uint tracer) {
  olx_march m = olx_begin_march(probe, ray);
  olx_probe_answer answer = olx_probe_answer(OLX_TRACE_MISS, ray.t_max, ivec2(0), 0.0, 0u);
  bool plain = tracer == OLX_TRACER_TEXEL || tracer == OLX_TRACER_TWO_LEVEL;
  int verdict = plain ? olx_march_pieces(m, tracer, answer) : olx_march_hiz(m, answer);
  answer.steps = m.steps;
  if (verdict != OLX_VERDICT_CLEAR) {
    answer.status = verdict == OLX_VERDICT_HIT ? OLX_TRACE_HIT : OLX_TRACE_UNKNOWN;
    return answer;
  }
  answer.texel = olx_texel_towards(ray.direction);
  answer.t = ray.t_max;
  answer.gap = 0.0;
  return answer;
}

#endif
