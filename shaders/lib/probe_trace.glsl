// Twin of src/trace/probe_trace.c: a ray against what one probe sees (McGuire et al. 2017, section 4.1, singleProbeTrace).
// What decides is `precise`: each crossing must come out the same wherever it is computed.
#ifndef OLX_PROBE_TRACE_GLSL
#define OLX_PROBE_TRACE_GLSL

#include "maps.glsl"

const float OLX_DISTANCE_PRECISION = 1.0 / 2048.0; // of half floats
const float OLX_NEIGHBOURHOOD_TEXELS = 1.5;        // how far from a texel's centre its surfel may be hit
const float OLX_STILL_TEXELS = 1e-3;               // images that move by less stand still
const float OLX_CENTRE_SHARE = 1e-4;               // closer to the probe, rounding decides the image

// A ray relative to a probe: all distances in metres along the unit direction.
struct olx_probe_ray {
  vec3 origin; // from the probe's centre
  vec3 direction;
  float t_min, t_max;
};

struct olx_probe_answer {
  uint status;
  float t;     // HIT: of the hit; UNKNOWN: where the ray went out of sight; MISS: t_max
  ivec2 texel; // HIT: that was hit; UNKNOWN: that hides the ray; MISS: in the ray's direction
  float gap;   // UNKNOWN: how far behind the hiding texel's surface the ray was, in footprints
  uint steps;  // distances read, of texels and of blocks
};

// What is fixed for one ray and one probe. r^2(t) = miss^2 + (t - closest)^2.
struct olx_march {
  olx_probe_ray ray;
  ivec3 map, coarse; // where the probe's maps begin
  float closest, miss_squared;
  float texel_angle_scale; // texel solid angle = this / |q|^3
  uint steps;
};

// One coordinate of the ray's image on one face of the octahedron, in texels: (n0 + n1 t) / (d0 + d1 t).
struct olx_image_axis {
  float n0, n1;
  float begin;     // image where the piece begins
  int step;        // -1, 0, 1: the direction of travel
  int first, last; // texels of the quadrant, inclusive
};

// A part of the ray whose image lies on one face of the octahedron.
struct olx_piece {
  olx_image_axis u, v;
  float d0, d1; // |P(t)|_1 = d0 + d1 t
  float t_begin, t_end;
};

// The texel the march stands in, and the ray's parameter where it entered it.
struct olx_cell {
  ivec2 at;
  float t;
};

float olx_radius_squared(olx_march m, float t) {
  precise float along = t - m.closest;
  precise float squared = m.miss_squared + along * along;
  return squared;
}

// The ray's greatest squared distance from the probe over [t0, t1]: it is convex in t, so one of the ends.
float olx_farthest_squared(olx_march m, float t0, float t1) {
  return max(olx_radius_squared(m, t0), olx_radius_squared(m, t1));
}

float olx_nearest_squared(olx_march m, float t0, float t1) {
  return olx_radius_squared(m, clamp(m.closest, t0, t1));
}

// Sign of a coordinate o + d t just after t.
float olx_sign_after(float o, float d, float t) {
  if (d == 0.0) return olx_sign_not_zero(o);
  precise float zero = -o / d;
  return t >= zero ? olx_sign_not_zero(d) : -olx_sign_not_zero(d);
}

float olx_image_at(olx_piece p, olx_image_axis a, float t) {
  precise float image = (a.n0 + a.n1 * t) / (p.d0 + p.d1 * t);
  return image;
}

void olx_set_axis(olx_piece p, inout olx_image_axis a, float sign, int n) {
  int middle = n / 2;
  bool endless = p.t_end >= OLX_INFINITY;
  precise float centre = OLX_CENTRE_SHARE * abs(p.d0);
  precise float at_begin = p.d0 + p.d1 * p.t_begin, at_end = p.d0 + p.d1 * p.t_end;
  bool from_centre = at_begin <= centre;
  bool to_centre = !endless && at_end <= centre;
  precise float begin = olx_image_at(p, a, p.t_begin);
  precise float end = endless ? a.n1 / p.d1 : olx_image_at(p, a, p.t_end);
  precise float travel = from_centre || to_centre ? 0.0 : end - begin;
  a.begin = from_centre ? end : begin;
  a.step = travel > OLX_STILL_TEXELS ? 1 : travel < -OLX_STILL_TEXELS ? -1 : 0;
  a.first = sign > 0.0 ? middle : 0;
  a.last = sign > 0.0 ? n - 1 : middle - 1;
}

olx_piece olx_make_piece(olx_march m, float t_begin, float t_end) {
  vec3 o = m.ray.origin, d = m.ray.direction;
  float sx = olx_sign_after(o.x, d.x, t_begin), sy = olx_sign_after(o.y, d.y, t_begin),
        sz = olx_sign_after(o.z, d.z, t_begin);
  precise float d0 = sx * o.x + sy * o.y + sz * o.z, d1 = sx * d.x + sy * d.y + sz * d.z;
  precise float u0 = o.x, u1 = d.x, v0 = o.z, v1 = d.z;
  if (sy < 0.0) { // the lower half is folded outwards: 1 - |z| on x, 1 - |x| on z
    u0 = sx * d0 - sx * sz * o.z;
    u1 = sx * d1 - sx * sz * d.z;
    v0 = sz * d0 - sx * sz * o.x;
    v1 = sz * d1 - sx * sz * d.x;
  }
  precise float scale = 0.5 * float(olx_field.n);
  precise float un0 = scale * (u0 + d0), un1 = scale * (u1 + d1), vn0 = scale * (v0 + d0), vn1 = scale * (v1 + d1);
  olx_piece p;
  p.d0 = d0;
  p.d1 = d1;
  p.t_begin = t_begin;
  p.t_end = t_end;
  p.u.n0 = un0;
  p.u.n1 = un1;
  p.v.n0 = vn0;
  p.v.n1 = vn1;
  olx_set_axis(p, p.u, sx, int(olx_field.n));
  olx_set_axis(p, p.v, sz, int(olx_field.n));
  return p;
}

// The ray's parameter where the image crosses the line between texels k - 1 and k; infinite when that line bounds the
// quadrant or is never crossed.
float olx_crossing(olx_piece p, olx_image_axis a, int k) {
  if (a.step == 0 || k <= a.first || k > a.last) return OLX_INFINITY;
  precise float t = (float(k) * p.d0 - a.n0) / (a.n1 - float(k) * p.d1);
  precise float norm = p.d0 + p.d1 * t; // negative or NaN: crossed by the line's other half, behind the probe
  return norm > 0.0 ? max(t, p.t_begin) : OLX_INFINITY;
}

float olx_next_crossing(olx_piece p, olx_image_axis a, int x) { return olx_crossing(p, a, a.step > 0 ? x + 1 : x); }

int olx_quadrant_texel(olx_image_axis a, float image) {
  return image > float(a.last) ? a.last : image > float(a.first) ? int(image) : a.first;
}

// The texel along one axis that stepping from texel `from` has reached at parameter t; lines crossed at exactly t count as
// passed when `inclusive`. The image gives a guess; the same crossings that steps use decide.
int olx_advance(olx_piece p, olx_image_axis a, int from, float t, bool inclusive) {
  if (a.step == 0) return from;
  int x = olx_quadrant_texel(a, olx_image_at(p, a, t));
  if ((x - from) * a.step < 0) x = from;
  while (x != from) { // back while the line into x is not passed yet
    float entered = olx_next_crossing(p, a, x - a.step);
    if (inclusive ? entered <= t : entered < t) break;
    x -= a.step;
  }
  for (;;) {
    float left = olx_next_crossing(p, a, x);
    if (inclusive ? left > t : left >= t) return x;
    x += a.step;
  }
}

// The surfel of a texel against the ray: f(t) = f0 + f1 t is the ray's height over its plane.
struct olx_surfel {
  float distance;  // stored, metres
  float cosine;    // of the angle under which the probe sees it
  float footprint; // metres: distance times the root of the texel's solid angle
  float f0, f1;
};

olx_surfel olx_read_surfel(olx_march m, ivec2 at, float distance) {
  precise vec2 uv = (vec2(at) + 0.5) / float(olx_field.n);
  precise vec3 q = olx_octahedral_point(uv);
  precise float length = sqrt(olx_dot(q, q));
  precise vec3 centre = q * (1.0 / length);
  vec3 normal = olx_texel_normal(m.map, at);
  precise float cosine = -olx_dot(normal, centre);
  precise float footprint = distance * sqrt(m.texel_angle_scale / (length * length * length));
  precise float f0 = olx_dot(normal, m.ray.origin) + distance * cosine;
  return olx_surfel(distance, cosine, footprint, f0, olx_dot(normal, m.ray.direction));
}

// How far the ray may be below a surfel's plane and still count as on it.
float olx_plane_tolerance(olx_surfel s) {
  precise float tolerance = s.distance * OLX_DISTANCE_PRECISION * max(s.cosine, 0.0) + 0.005 * s.footprint;
  return tolerance;
}

// The greatest distance that the surface of a texel can have inside it: its plane tilted away by a texel, but no farther
// than the neighbours.
float olx_depth_limit(olx_march m, ivec2 at, olx_surfel s) {
  precise float sine = sqrt(max(0.0, 1.0 - s.cosine * s.cosine));
  precise float spread = s.cosine - sine * s.footprint / s.distance;
  precise float tilted = spread > 0.0 ? s.distance * s.cosine / spread : OLX_INFINITY;
  float neighbours = s.distance;
  for (int dy = -1; dy <= 1; dy++) {
    for (int dx = -1; dx <= 1; dx++) neighbours = max(neighbours, olx_texel_distance(m.map, at + ivec2(dx, dy)));
  }
  precise float limit = min(tilted, neighbours) + s.distance * OLX_DISTANCE_PRECISION + s.footprint;
  return limit;
}

// Whether parameter t of the ray lies within the neighbourhood of a texel, on the map.
bool olx_near_texel(olx_piece p, ivec2 at, float t) {
  precise vec2 off = vec2(olx_image_at(p, p.u, t), olx_image_at(p, p.v, t)) - (vec2(at) + 0.5);
  return abs(off.x) <= OLX_NEIGHBOURHOOD_TEXELS && abs(off.y) <= OLX_NEIGHBOURHOOD_TEXELS;
}

// Whether the texel in which the ray meets a neighbour's plane sees a surface about there too. When it sees far past that
// point, the plane ends before it: an edge lies between the two texels.
bool olx_supported(olx_march m, olx_piece p, olx_surfel s, float t) {
  ivec2 at = ivec2(olx_quadrant_texel(p.u, olx_image_at(p, p.u, t)), olx_quadrant_texel(p.v, olx_image_at(p, p.v, t)));
  float stored = olx_texel_distance(m.map, at);
  precise float slope = 1.0 / max(s.cosine, 0.1);
  precise float reach = sqrt(olx_radius_squared(m, t)) + s.footprint * slope;
  return stored <= reach;
}

#define OLX_VERDICT_CLEAR 0
#define OLX_VERDICT_HIT 1
#define OLX_VERDICT_HIDDEN 2

// The ray reaches the stored distance inside a texel, between c.t and t1: what does the texel's surfel say?
int olx_judge(olx_march m, olx_piece p, olx_cell c, float t1, float stored, inout olx_probe_answer answer) {
  float t0 = c.t;
  olx_surfel s = olx_read_surfel(m, c.at, stored);
  float tolerance = olx_plane_tolerance(s);
  precise float height0 = s.f0 + s.f1 * t0;
  precise float height1 = s.f0 + s.f1 * t1;
  if (t1 >= OLX_INFINITY) height1 = s.f1 < 0.0 ? -OLX_INFINITY : OLX_INFINITY;
  precise float nearest = sqrt(olx_nearest_squared(m, t0, t1));
  answer.texel = c.at;
  answer.gap = (nearest - s.distance) / s.footprint;
  answer.t = t0;
  precise float limit = olx_depth_limit(m, c.at, s);
  if (nearest > limit) return OLX_VERDICT_HIDDEN;
  precise float plane = -s.f0 / s.f1;
  if (height0 >= -tolerance) {
    if (height1 >= -tolerance) return OLX_VERDICT_CLEAR; // above the plane all through the texel
    float t = clamp(plane, t0, t1);
    precise float limit_squared = limit * limit;
    if (olx_radius_squared(m, t) > limit_squared) return OLX_VERDICT_HIDDEN;
    answer.t = t;
    return OLX_VERDICT_HIT;
  }
  if (s.f1 >= 0.0) {
    // Below, but rising: a ray that just left this surface is still within what rounding and curvature explain. One that began
    // farther below comes through the surface from behind.
    return -min(height0, s.f0) <= 0.5 * s.footprint ? OLX_VERDICT_CLEAR : OLX_VERDICT_HIDDEN;
  }
  // A ray handed on by another probe may have slipped through this surface by that probe's tolerance, but no ray starts
  // behind what it is about to hit.
  float slip = m.ray.t_min > 0.0 ? s.footprint : 0.0;
  precise float height_min = s.f0 + s.f1 * m.ray.t_min;
  if (plane < m.ray.t_min && height_min < -slip) return OLX_VERDICT_HIDDEN;
  if (!olx_near_texel(p, c.at, plane) || !olx_supported(m, p, s, plane)) return OLX_VERDICT_HIDDEN;
  answer.t = max(plane, m.ray.t_min);
  return OLX_VERDICT_HIT;
}

int olx_visit_texel(inout olx_march m, olx_piece p, olx_cell c, float t1, inout olx_probe_answer answer) {
  m.steps++;
  float stored = olx_texel_distance(m.map, c.at);
  precise float stored_squared = stored * stored;
  if (olx_farthest_squared(m, c.t, t1) < stored_squared || stored >= OLX_INFINITY) return OLX_VERDICT_CLEAR;
  return olx_judge(m, p, c, t1, stored, answer);
}

// Whether the ray stays in front of everything in the block around c until it leaves the block at t1. The margin covers the
// rounding of squared distances at the ends of shorter intervals.
bool olx_block_clear(inout olx_march m, olx_cell c, float t1) {
  m.steps++;
  uint stored = texelFetch(olx_coarse_maps, m.coarse + ivec3(c.at / int(olx_field.block), 0), 0).r;
  precise float smallest = olx_half_unpack(stored) * olx_field.distance_scale;
  precise float farthest = olx_farthest_squared(m, c.t, t1) * (1.0 + 1e-5), smallest_squared = smallest * smallest;
  return farthest < smallest_squared;
}

// The line by which the image leaves the block along one axis.
float olx_block_crossing(olx_piece p, olx_image_axis a, int x, int block) {
  int first = x / block * block;
  return olx_crossing(p, a, a.step > 0 ? first + block : first);
}

// The first texel beyond the block along one axis.
int olx_beyond_block(olx_image_axis a, int x, int block) {
  return a.step > 0 ? (x / block + 1) * block : x / block * block - 1;
}

// March one piece. Every texel is visited in order; with the coarse map, whole blocks that are clear are skipped, and the
// texels that remain are visited as they would have been.
int olx_march_piece(inout olx_march m, olx_piece p, bool two_level, inout olx_probe_answer answer) {
  int block = int(olx_field.block);
  olx_cell c;
  c.at = ivec2(olx_quadrant_texel(p.u, p.u.begin), olx_quadrant_texel(p.v, p.v.begin));
  c.t = p.t_begin;
  float tx = olx_next_crossing(p, p.u, c.at.x), ty = olx_next_crossing(p, p.v, c.at.y);
  bool entered_block = two_level;
  for (;;) {
    if (entered_block) {
      float bx = olx_block_crossing(p, p.u, c.at.x, block), by = olx_block_crossing(p, p.v, c.at.y, block);
      float t1 = min(min(bx, by), p.t_end);
      if (olx_block_clear(m, c, t1)) {
        if (t1 >= p.t_end) return OLX_VERDICT_CLEAR;
        if (bx <= by) { // ties step in x first, as below
          c.at = ivec2(olx_beyond_block(p.u, c.at.x, block), olx_advance(p, p.v, c.at.y, t1, false));
        } else {
          c.at = ivec2(olx_advance(p, p.u, c.at.x, t1, true), olx_beyond_block(p.v, c.at.y, block));
        }
        c.t = t1;
        tx = olx_next_crossing(p, p.u, c.at.x);
        ty = olx_next_crossing(p, p.v, c.at.y);
        continue;
      }
    }
    float t1 = min(min(tx, ty), p.t_end);
    int result = olx_visit_texel(m, p, c, t1, answer);
    if (result != OLX_VERDICT_CLEAR) return result;
    if (t1 >= p.t_end) return OLX_VERDICT_CLEAR;
    ivec2 from = c.at / block;
    c.t = t1;
    if (tx <= ty) {
      c.at.x += p.u.step;
      tx = olx_next_crossing(p, p.u, c.at.x);
    } else {
      c.at.y += p.v.step;
      ty = olx_next_crossing(p, p.v, c.at.y);
    }
    entered_block = two_level && from != c.at / block;
  }
}

// Parameters at which the ray crosses the probe's coordinate planes inside (t_min, t_max), in ascending order; those outside
// are infinite.
vec3 olx_cut(olx_probe_ray ray) {
  vec3 cuts;
  for (int i = 0; i < 3; i++) {
    precise float plane = -ray.origin[i] / ray.direction[i];
    cuts[i] = plane > ray.t_min && plane < ray.t_max ? plane : OLX_INFINITY;
  }
  float low = min(cuts.x, cuts.y), high = max(cuts.x, cuts.y);
  return vec3(min(low, cuts.z), max(low, min(high, cuts.z)), max(high, cuts.z));
}

// What is fixed for the march of a ray through a probe's map.
olx_march olx_begin_march(uint probe, olx_probe_ray ray) {
  olx_march m;
  precise float closest = -olx_dot(ray.origin, ray.direction);
  precise vec3 foot = ray.origin + ray.direction * closest;
  m.ray = ray;
  m.map = olx_map_origin(probe);
  m.coarse = olx_map_corner(probe, olx_field.n / olx_field.block, olx_field.maps_a_side);
  m.closest = closest;
  m.miss_squared = olx_dot(foot, foot);
  m.texel_angle_scale = 4.0 / (float(olx_field.n) * float(olx_field.n));
  m.steps = 0u;
  return m;
}

olx_probe_answer olx_trace_probe(uint probe, olx_probe_ray ray, uint tracer) {
  olx_march m = olx_begin_march(probe, ray);
  vec3 cuts = olx_cut(ray);
  olx_probe_answer answer = olx_probe_answer(OLX_TRACE_MISS, ray.t_max, ivec2(0), 0.0, 0u);
  float t = ray.t_min;
  for (int i = 0; i < 4; i++) {
    float t_end = i < 3 ? min(cuts[i], ray.t_max) : ray.t_max;
    if (t_end <= t) continue;
    olx_piece p = olx_make_piece(m, t, t_end);
    int result = olx_march_piece(m, p, tracer == OLX_TRACER_TWO_LEVEL, answer);
    if (result != OLX_VERDICT_CLEAR) {
      answer.status = result == OLX_VERDICT_HIT ? OLX_TRACE_HIT : OLX_TRACE_UNKNOWN;
      answer.steps = m.steps;
      return answer;
    }
    t = t_end;
  }
  answer.texel = olx_texel_towards(ray.direction);
  answer.t = ray.t_max;
  answer.gap = 0.0;
  answer.steps = m.steps;
  return answer;
}

#endif
