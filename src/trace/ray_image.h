// A ray's image in a probe's map, which all tracers share (docs/maths.md, "Marching"). The ray is cut where it crosses
// the probe's coordinate planes. The image of each piece is a straight line on one face of the octahedron, and s from 0
// to 1 is the share of its length that is marched. All tracers compare values of the same few functions, so skipping
// ahead reaches exactly the texel that stepping would.
#ifndef OLX_TRACE_RAY_IMAGE_H
#define OLX_TRACE_RAY_IMAGE_H

#include "trace/probe_ray.h"

// The plane m . p = 1 along a ray: m . p at parameter t is base + slope t.
typedef struct olx_ray_plane {
  float base, slope;
} olx_ray_plane;

// What is constant for one ray and one probe. The squared distance is r^2(t) = miss^2 + (t - closest)^2.
typedef struct olx_march {
  const olx_field *field;
  const uint16_t *distance, *least;   // distance: NULL in a field of geometry blocks
  const olx_geometry_block *geometry; // blocks of the probe; NULL in a field of texels
  const olx_geometry_block *block;    // the block read last, with its planes where they are one or two
  olx_ray_plane planes[2];
  uint32_t probe;
  const olx_probe_ray *ray;
  float closest, miss_squared;
  uint32_t steps;
} olx_march;

// One coordinate of the image, in texels: begin + travel s. Line k is crossed at s = (k - begin) * inverse. For an
// image that counts as a point, `begin` is the middle of a texel and no line is ever reached.
typedef struct olx_image_axis {
  float begin, travel, inverse;
  int32_t step;          // -1, 0, 1: the direction of travel
  int32_t ahead;         // the line ahead of texel x is x + ahead: 1 or 0
  int32_t first;         // texel where the image begins
} olx_image_axis;

// A part of the ray whose image lies on one face.
typedef struct olx_piece {
  olx_image_axis u, v;
  // t(s) = t_begin + rise s / (near + slope s), because 1 / |P|_1 is linear in s, from near to near + slope.
  float t_begin, t_end, rise, near, slope;
  float sign_x, sign_y, sign_z; // of the octant
  float slack;                  // how far rounding may move t(s), metres
} olx_piece;

typedef int olx_verdict; // OLX_VERDICT_*

// The texel that the march has reached, and the ray's parameter where it entered it.
typedef struct olx_cell {
  int32_t x, y;
  float t;
} olx_cell;

static inline olx_march olx_begin_march(const olx_field *field, uint32_t probe, const olx_probe_ray *ray) {
  const float closest = -olx_dot(ray->origin, ray->direction);
  const olx_vec3 foot = olx_madd(ray->origin, ray->direction, closest);
  return (olx_march){
      .field = field,
      .distance = field->geometry ? NULL : field->distance + field->texels * probe,
      .geometry = field->geometry ? field->geometry + olx_block_at(field, probe, 0, 0).block : NULL,
      .least = field->least + (size_t)field->pyramid.least_nodes * probe,
      .probe = probe,
      .ray = ray,
      .closest = closest,
      .miss_squared = olx_dot(foot, foot),
  };
}

// Returns the answer for a ray that is clear up to its end.
static inline olx_probe_answer olx_probe_clear(const olx_field *field, const olx_probe_ray *ray, uint32_t steps) {
  return (olx_probe_answer){
      .status = OLX_TRACE_MISS, .t = ray->t_max, .texel = olx_texel_towards(field, ray->direction), .steps = steps};
}

// Computes the image of the ray at any parameter, on the face of the piece, in texels; false where the face has none.
static inline bool olx_image_at(const olx_march *m, const olx_piece *p, float t, olx_vec2 *image) {
  const olx_vec3 at = olx_madd(m->ray->origin, m->ray->direction, t);
  const float x = p->sign_x * at.x, z = p->sign_z * at.z, sum = x + p->sign_y * at.y + z;
  if (!(sum > 0.0f)) return false;
  const float inverse = 1.0f / sum, half = 0.5f * (float)m->field->n;
  const bool upper = p->sign_y > 0.0f;
  *image = (olx_vec2){half + half * p->sign_x * (upper ? x * inverse : 1.0f - z * inverse),
                      half + half * p->sign_z * (upper ? z * inverse : 1.0f - x * inverse)};
  return true;
}

// Returns the texel at an image coordinate, within the half of the map on the side of the sign.
static inline int32_t olx_clamp_texel(float sign, float image, uint32_t n) {
  const int32_t first = sign > 0.0f ? (int32_t)n / 2 : 0, last = first + (int32_t)n / 2 - 1;
  return image > (float)last ? last : image > (float)first ? (int32_t)image : first;
}

static inline float olx_radius_squared(const olx_march *m, float t) {
  const float along = t - m->closest;
  return m->miss_squared + along * along;
}

// Returns the ray's greatest squared distance from the probe over [t0, t1]. It is convex in t, so it is at one of the
// ends.
static inline float olx_farthest_squared(const olx_march *m, float t0, float t1) {
  return olx_max(olx_radius_squared(m, t0), olx_radius_squared(m, t1));
}

static inline float olx_nearest_squared(const olx_march *m, float t0, float t1) {
  return olx_radius_squared(m, olx_clamp(m->closest, t0, t1));
}

// Returns the ray's parameter at s; for s of 1 and more, the end of the piece.
static inline float olx_parameter_at(const olx_piece *p, float s) {
  return s >= 1.0f ? p->t_end : p->t_begin + p->rise * s / (p->near + p->slope * s);
}

// Bounds the squared distance from the probe over [t0, t1] from above. The bound holds for any part of the interval,
// even when rounding moves the part's ends.
static inline float olx_reach_squared(const olx_march *m, const olx_piece *p, float t0, float t1) {
  const float along = olx_max(m->closest - t0, t1 - m->closest) + p->slack;
  return (m->miss_squared + along * along) * (1.0f + 0x1p-16f);
}

// Decodes a stored distance into metres; the sky decodes to 65536 distance scales.
static inline float olx_march_distance(const olx_march *m, uint32_t code) {
  return olx_bits_float((code & 0x7FFFu) << 13) * 0x1p112f * m->field->distance_scale;
}

// Returns the smallest squared distance in a node of the pyramid.
static inline float olx_least_squared(olx_march *m, uint32_t level, int32_t x, int32_t y) {
  const olx_pyramid_shape *shape = &m->field->pyramid;
  m->steps++;
  const uint32_t node = shape->first[level] + olx_pyramid_index(shape->side[level], (uint32_t)x, (uint32_t)y);
  return olx_square(olx_march_distance(m, m->least[node]));
}

// Returns the s at which the image crosses the line between texels k - 1 and k. Lines beyond the end of the piece give
// 1 or more.
static inline float olx_crossing(const olx_image_axis *a, int32_t k) { return ((float)k - a->begin) * a->inverse; }

// Returns where the image crosses the lines ahead of a node of 2^shift texels, along both axes.
static inline olx_vec2 olx_crossings_ahead(const olx_piece *p, int32_t x, int32_t y, uint32_t shift) {
  return (olx_vec2){olx_crossing(&p->u, (x + p->u.ahead) << shift), olx_crossing(&p->v, (y + p->v.ahead) << shift)};
}

// Returns the texel after c, where s holds the crossings of the lines ahead and t1 is the ray's parameter at the nearer
// one.
static inline olx_cell olx_next_cell(const olx_piece *p, olx_cell c, olx_vec2 s, float t1) {
  const bool by_v = s.x > s.y;
  return (olx_cell){c.x + (by_v ? 0 : p->u.step), c.y + (by_v ? p->v.step : 0), t1};
}

static inline olx_ray_plane olx_plane_along(const olx_probe_ray *ray, olx_vec3 plane) {
  return (olx_ray_plane){olx_dot(plane, ray->origin), olx_dot(plane, ray->direction)};
}

// Returns whether the ray is in front of or on a plane all over [t0, t1]. Rounding keeps the order of t, so the ends
// decide. The sky is clear.
static inline bool olx_plane_clears(olx_ray_plane plane, float t0, float t1) {
  const bool ends_behind = t1 < INFINITY ? plane.base + plane.slope * t1 > 1.0f : plane.slope > 0.0f;
  return !ends_behind && !(plane.base + plane.slope * t0 > 1.0f);
}

// Returns the texel along one axis that stepping has reached at s; a line crossed exactly at s counts as passed when
// `inclusive`. A guess from the image is off by one texel at most; the crossings that steps compare then decide.
static inline int32_t olx_texel_at(const olx_image_axis *a, float s, bool inclusive) {
  int32_t x = (int32_t)(a->begin + a->travel * s);
  if ((x - a->first) * a->step <= 0) x = a->first;
  else {
    const float entered = olx_crossing(a, x + 1 - a->ahead);
    if (!(inclusive ? entered <= s : entered < s)) x -= a->step;
  }
  const float left = olx_crossing(a, x + a->ahead);
  return (inclusive ? left <= s : left < s) ? x + a->step : x;
}

#endif
