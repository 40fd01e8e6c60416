#include "trace/probe_trace.h"

// Half floats are off by up to 2^-11 of their value.
static const float DISTANCE_PRECISION = 0x1p-11f;
// How far from a texel's centre its surfel may be hit, in texels.
static const float NEIGHBOURHOOD_TEXELS = 1.5f;

// What is fixed for one ray and one probe. r^2(t) = miss^2 + (t - closest)^2.
typedef struct march {
  const olx_field *field;
  const uint16_t *distance, *coarse;
  uint32_t probe;
  const olx_probe_ray *ray;
  float closest, miss_squared;
  float texel_angle_scale; // texel solid angle = this / |q|^3
  uint32_t steps;
} march;

// One coordinate of the ray's image on one face of the octahedron, in texels: (n0 + n1 t) / (d0 + d1 t). It is monotone.
typedef struct image_axis {
  float n0, n1;
  float begin;         // image where the piece begins
  int32_t step;        // -1, 0, 1: the direction of travel
  int32_t first, last; // texels of the quadrant, inclusive
} image_axis;

// A part of the ray whose image lies on one face of the octahedron.
typedef struct piece {
  image_axis u, v;
  float d0, d1; // |P(t)|_1 = d0 + d1 t
  float t_begin, t_end;
} piece;

// The texel the march stands in, and the ray's parameter where it entered it.
typedef struct cell {
  int32_t x, y;
  float t;
} cell;

static float radius_squared(const march *m, float t) {
  const float along = t - m->closest;
  return m->miss_squared + along * along;
}

// The ray's greatest squared distance from the probe over [t0, t1]: it is convex in t, so one of the ends.
static float farthest_squared(const march *m, float t0, float t1) {
  return olx_max(radius_squared(m, t0), radius_squared(m, t1));
}

static float nearest_squared(const march *m, float t0, float t1) {
  return radius_squared(m, olx_clamp(m->closest, t0, t1));
}

// Sign of a coordinate o + d t just after t.
static float sign_after(float o, float d, float t) {
  if (d == 0.0f) return olx_sign_not_zero(o);
  return t >= -o / d ? olx_sign_not_zero(d) : -olx_sign_not_zero(d);
}

// Images that move by less than this over a piece stand still: below it rounding decides the direction.
static const float STILL_TEXELS = 1e-3f;

static float image_at(const piece *p, const image_axis *a, float t) {
  return (a->n0 + a->n1 * t) / (p->d0 + p->d1 * t);
}

// Closer to the probe than this share of the way there, rounding decides the image; the ray is in front of everything then.
static const float CENTRE_SHARE = 1e-4f;

static void set_axis(const piece *p, image_axis *a, float sign, int32_t n) {
  const int32_t half = n / 2;
  const float centre = CENTRE_SHARE * fabsf(p->d0);
  const bool from_centre = p->d0 + p->d1 * p->t_begin <= centre;
  const bool to_centre = isfinite(p->t_end) && p->d0 + p->d1 * p->t_end <= centre;
  const float begin = image_at(p, a, p->t_begin);
  const float end = isfinite(p->t_end) ? image_at(p, a, p->t_end) : a->n1 / p->d1;
  const float travel = from_centre || to_centre ? 0.0f : end - begin;
  a->begin = from_centre ? end : begin;
  a->step = travel > STILL_TEXELS ? 1 : travel < -STILL_TEXELS ? -1 : 0;
  a->first = sign > 0.0f ? half : 0;
  a->last = sign > 0.0f ? n - 1 : half - 1;
}

static piece make_piece(const march *m, float t_begin, float t_end) {
  const olx_vec3 o = m->ray->origin, d = m->ray->direction;
  const float sx = sign_after(o.x, d.x, t_begin), sy = sign_after(o.y, d.y, t_begin),
              sz = sign_after(o.z, d.z, t_begin);
  const float d0 = sx * o.x + sy * o.y + sz * o.z, d1 = sx * d.x + sy * d.y + sz * d.z;
  float u0 = o.x, u1 = d.x, v0 = o.z, v1 = d.z;
  if (sy < 0.0f) { // the lower half is folded outwards: 1 - |z| on x, 1 - |x| on z
    u0 = sx * d0 - sx * sz * o.z;
    u1 = sx * d1 - sx * sz * d.z;
    v0 = sz * d0 - sx * sz * o.x;
    v1 = sz * d1 - sx * sz * d.x;
  }
  const float half = 0.5f * (float)m->field->n;
  piece p = {
      .u = {.n0 = half * (u0 + d0), .n1 = half * (u1 + d1)},
      .v = {.n0 = half * (v0 + d0), .n1 = half * (v1 + d1)},
      .d0 = d0,
      .d1 = d1,
      .t_begin = t_begin,
      .t_end = t_end,
  };
  set_axis(&p, &p.u, sx, (int32_t)m->field->n);
  set_axis(&p, &p.v, sz, (int32_t)m->field->n);
  return p;
}

// The ray's parameter where the image crosses the line between texels k - 1 and k; infinite when that line bounds the
// quadrant or is never crossed.
static float crossing(const piece *p, const image_axis *a, int32_t k) {
  if (a->step == 0 || k <= a->first || k > a->last) return INFINITY;
  const float t = ((float)k * p->d0 - a->n0) / (a->n1 - (float)k * p->d1);
  if (!(p->d0 + p->d1 * t > 0.0f)) return INFINITY; // crossed by the line's other half, behind the probe
  return olx_max(t, p->t_begin);
}

static float next_crossing(const piece *p, const image_axis *a, int32_t x) {
  return crossing(p, a, a->step > 0 ? x + 1 : x);
}

static int32_t quadrant_texel(const image_axis *a, float image) {
  return image > (float)a->last ? a->last : image > (float)a->first ? (int32_t)image : a->first;
}

// The texel along one axis that stepping from texel `from` has reached at parameter t; lines crossed at exactly t count as
// passed when `inclusive`. The image gives a guess; the same crossings that steps use decide, so that skipping ahead lands
// on the very texel that stepping would.
static int32_t advance(const piece *p, const image_axis *a, int32_t from, float t, bool inclusive) {
  if (a->step == 0) return from;
  int32_t x = quadrant_texel(a, image_at(p, a, t));
  if ((x - from) * a->step < 0) x = from;
  while (x != from) { // back while the line into x is not passed yet
    const float entered = next_crossing(p, a, x - a->step);
    if (inclusive ? entered <= t : entered < t) break;
    x -= a->step;
  }
  for (;;) {
    const float left = next_crossing(p, a, x);
    if (inclusive ? left > t : left >= t) return x;
    x += a->step;
  }
}

static size_t texel_index(const march *m, cell c) { return olx_map_index(m->field->stride, c.x, c.y); }

// The surfel of a texel against the ray: f(t) = f0 + f1 t is the ray's height over its plane.
typedef struct surfel {
  float distance;  // stored, metres
  float cosine;    // of the angle under which the probe sees it
  float footprint; // metres: distance times the root of the texel's solid angle
  float f0, f1;
} surfel;

static surfel read_surfel(const march *m, cell c, float distance) {
  const uint32_t n = m->field->n;
  const olx_vec2 uv = {((float)c.x + 0.5f) / (float)n, ((float)c.y + 0.5f) / (float)n};
  const olx_vec3 q = olx_octahedral_point(uv);
  const float length = olx_length(q);
  const olx_vec3 centre = olx_scale(q, 1.0f / length);
  const olx_vec3 normal = olx_texel_normal(m->field, m->probe, texel_index(m, c));
  const float cosine = -olx_dot(normal, centre);
  return (surfel){
      .distance = distance,
      .cosine = cosine,
      .footprint = distance * sqrtf(m->texel_angle_scale / (length * length * length)),
      .f0 = olx_dot(normal, m->ray->origin) + distance * cosine,
      .f1 = olx_dot(normal, m->ray->direction),
  };
}

// How far the ray may be below a surfel's plane and still count as on it.
static float plane_tolerance(const surfel *s) {
  return s->distance * DISTANCE_PRECISION * olx_max(s->cosine, 0.0f) + 0.005f * s->footprint;
}

// The greatest distance that the surface of a texel can have inside it: its plane tilted away by a texel, but no farther
// than the neighbours.
static float depth_limit(const march *m, cell c, const surfel *s) {
  const float sine = sqrtf(olx_max(0.0f, 1.0f - s->cosine * s->cosine));
  const float spread = s->cosine - sine * s->footprint / s->distance;
  const float tilted = spread > 0.0f ? s->distance * s->cosine / spread : INFINITY;
  float neighbours = s->distance;
  for (int32_t dy = -1; dy <= 1; dy++) {
    for (int32_t dx = -1; dx <= 1; dx++) {
      const size_t index = olx_map_index(m->field->stride, c.x + dx, c.y + dy);
      neighbours = olx_max(neighbours, olx_texel_distance(m->field, m->probe, index));
    }
  }
  return olx_min(tilted, neighbours) + s->distance * DISTANCE_PRECISION + s->footprint;
}

// Whether parameter t of the ray lies within the neighbourhood of a texel, on the map.
static bool near_texel(const piece *p, cell c, float t) {
  const float u = image_at(p, &p->u, t) - ((float)c.x + 0.5f), v = image_at(p, &p->v, t) - ((float)c.y + 0.5f);
  return fabsf(u) <= NEIGHBOURHOOD_TEXELS && fabsf(v) <= NEIGHBOURHOOD_TEXELS;
}

// Whether the texel in which the ray meets a neighbour's plane sees a surface about there too. When it sees far past that
// point, the plane ends before it: an edge lies between the two texels.
static bool supported(const march *m, const piece *p, const surfel *s, float t) {
  const cell c = {quadrant_texel(&p->u, image_at(p, &p->u, t)), quadrant_texel(&p->v, image_at(p, &p->v, t)), t};
  const float stored = olx_texel_distance(m->field, m->probe, texel_index(m, c));
  const float slope = 1.0f / olx_max(s->cosine, 0.1f);
  return stored <= sqrtf(radius_squared(m, t)) + s->footprint * slope;
}

typedef enum verdict { VERDICT_CLEAR, VERDICT_HIT, VERDICT_HIDDEN } verdict;

// The ray reaches the stored distance inside a texel, between t0 and t1: what does the texel's surfel say?
static verdict judge(const march *m, const piece *p, cell c, float t1, float stored, olx_probe_answer *answer) {
  const float t0 = c.t;
  const surfel s = read_surfel(m, c, stored);
  const float tolerance = plane_tolerance(&s);
  const float height0 = s.f0 + s.f1 * t0;
  const float height1 = isfinite(t1) ? s.f0 + s.f1 * t1 : s.f1 < 0.0f ? -INFINITY : INFINITY;
  const float nearest = sqrtf(nearest_squared(m, t0, t1));
  answer->texel = texel_index(m, c);
  answer->gap = (nearest - s.distance) / s.footprint;
  answer->t = t0;
  const float limit = depth_limit(m, c, &s);
  if (nearest > limit) return VERDICT_HIDDEN;
  if (height0 >= -tolerance) {
    if (height1 >= -tolerance) return VERDICT_CLEAR; // above the plane all through the texel
    const float t = olx_clamp(-s.f0 / s.f1, t0, t1);
    if (radius_squared(m, t) > limit * limit) return VERDICT_HIDDEN;
    answer->t = t;
    return VERDICT_HIT;
  }
  if (s.f1 >= 0.0f) {
    // Below, but rising: a ray that just left this surface is still within what rounding and curvature explain. One that began
    // farther below comes through the surface from behind.
    return -olx_min(height0, s.f0) <= 0.5f * s.footprint ? VERDICT_CLEAR : VERDICT_HIDDEN;
  }
  const float t = -s.f0 / s.f1;
  // A ray handed on by another probe may have slipped through this surface by that probe's tolerance, but no ray starts
  // behind what it is about to hit.
  const float slip = m->ray->t_min > 0.0f ? s.footprint : 0.0f;
  if (t < m->ray->t_min && s.f0 + s.f1 * m->ray->t_min < -slip) return VERDICT_HIDDEN;
  if (!near_texel(p, c, t) || !supported(m, p, &s, t)) return VERDICT_HIDDEN;
  answer->t = olx_max(t, m->ray->t_min);
  return VERDICT_HIT;
}

static verdict visit_texel(march *m, const piece *p, cell c, float t1, olx_probe_answer *answer) {
  m->steps++;
  const float stored = olx_half_unpack(m->distance[texel_index(m, c)] & 0x7FFFu) * m->field->distance_scale;
  if (farthest_squared(m, c.t, t1) < stored * stored || stored == INFINITY) return VERDICT_CLEAR;
  return judge(m, p, c, t1, stored, answer);
}

// Whether the ray stays in front of everything in the block around c until it leaves the block at t1. The margin covers the
// rounding of squared distances at the ends of shorter intervals.
static bool block_clear(march *m, cell c, float t1) {
  m->steps++;
  const int32_t block = (int32_t)m->field->block;
  const uint16_t stored = m->coarse[(size_t)(c.y / block) * m->field->coarse_n + (size_t)(c.x / block)];
  const float smallest = olx_half_unpack(stored) * m->field->distance_scale;
  return farthest_squared(m, c.t, t1) * (1.0f + 1e-5f) < smallest * smallest;
}

// The line by which the image leaves the block along one axis.
static float block_crossing(const piece *p, const image_axis *a, int32_t x, int32_t block) {
  const int32_t first = x / block * block;
  return crossing(p, a, a->step > 0 ? first + block : first);
}

// March one piece. Every texel is visited in order; with the coarse map, whole blocks that are clear are skipped, and the
// texels that remain are visited as they would have been.
static verdict march_piece(march *m, const piece *p, bool two_level, olx_probe_answer *answer) {
  const int32_t block = (int32_t)m->field->block;
  cell c = {quadrant_texel(&p->u, p->u.begin), quadrant_texel(&p->v, p->v.begin), p->t_begin};
  float tx = next_crossing(p, &p->u, c.x), ty = next_crossing(p, &p->v, c.y);
  bool entered_block = two_level;
  for (;;) {
    if (entered_block) {
      const float bx = block_crossing(p, &p->u, c.x, block), by = block_crossing(p, &p->v, c.y, block);
      const float t1 = olx_min(olx_min(bx, by), p->t_end);
      if (block_clear(m, c, t1)) {
        if (t1 >= p->t_end) return VERDICT_CLEAR;
        const bool by_x = bx <= by; // ties step in x first, as below
        c = by_x ? (cell){(p->u.step > 0 ? (c.x / block + 1) * block : c.x / block * block - 1),
                          advance(p, &p->v, c.y, t1, false), t1}
                 : (cell){advance(p, &p->u, c.x, t1, true),
                          (p->v.step > 0 ? (c.y / block + 1) * block : c.y / block * block - 1), t1};
        tx = next_crossing(p, &p->u, c.x);
        ty = next_crossing(p, &p->v, c.y);
        continue;
      }
    }
    const float t1 = olx_min(olx_min(tx, ty), p->t_end);
    const verdict result = visit_texel(m, p, c, t1, answer);
    if (result != VERDICT_CLEAR) return result;
    if (t1 >= p->t_end) return VERDICT_CLEAR;
    const cell from = c;
    c.t = t1;
    if (tx <= ty) {
      c.x += p->u.step;
      tx = next_crossing(p, &p->u, c.x);
    } else {
      c.y += p->v.step;
      ty = next_crossing(p, &p->v, c.y);
    }
    entered_block = two_level && (from.x / block != c.x / block || from.y / block != c.y / block);
  }
}

// Parameters at which the ray crosses the probe's coordinate planes inside (t_min, t_max), sorted; returns how many.
static uint32_t cut(const olx_probe_ray *ray, float cuts[3]) {
  const float planes[3] = {-ray->origin.x / ray->direction.x, -ray->origin.y / ray->direction.y,
                           -ray->origin.z / ray->direction.z};
  uint32_t count = 0;
  for (uint32_t i = 0; i < 3; i++) {
    if (!(planes[i] > ray->t_min && planes[i] < ray->t_max)) continue;
    uint32_t at = count++;
    for (; at > 0 && cuts[at - 1] > planes[i]; at--) cuts[at] = cuts[at - 1];
    cuts[at] = planes[i];
  }
  return count;
}

olx_probe_answer olx_trace_probe(const olx_field *field, uint32_t probe, const olx_probe_ray *ray, olx_tracer tracer) {
  const float closest = -olx_dot(ray->origin, ray->direction);
  const olx_vec3 foot = olx_madd(ray->origin, ray->direction, closest);
  march m = {
      .field = field,
      .distance = field->distance + field->texels * probe,
      .coarse = field->coarse + (size_t)field->coarse_n * field->coarse_n * probe,
      .probe = probe,
      .ray = ray,
      .closest = closest,
      .miss_squared = olx_dot(foot, foot),
      .texel_angle_scale = 4.0f / ((float)field->n * (float)field->n),
  };
  float cuts[3];
  const uint32_t cut_count = cut(ray, cuts);
  olx_probe_answer answer = {.status = OLX_TRACE_MISS, .t = ray->t_max};
  float t = ray->t_min;
  for (uint32_t i = 0; i <= cut_count; i++) {
    const float t_end = i < cut_count ? cuts[i] : ray->t_max;
    if (t_end <= t) continue;
    const piece p = make_piece(&m, t, t_end);
    const verdict result = march_piece(&m, &p, tracer == OLX_TRACER_TWO_LEVEL, &answer);
    if (result != VERDICT_CLEAR) {
      answer.status = result == VERDICT_HIT ? OLX_TRACE_HIT : OLX_TRACE_UNKNOWN;
      answer.steps = m.steps;
      return answer;
    }
    t = t_end;
  }
  answer.texel = olx_texel_towards(field, ray->direction);
  answer.t = ray->t_max;
  answer.gap = 0.0f;
  answer.steps = m.steps;
  return answer;
}
