// A texel as a surface element, and its verdict on a ray that reaches its distance (docs/maths.md, "Marching").
#ifndef OLX_TRACE_SURFEL_H
#define OLX_TRACE_SURFEL_H

#include "trace/ray_image.h"

// Reads block (x, y) of the map, in a field of geometry blocks, and its planes where they are one or two.
void olx_read_block(olx_march *m, int32_t x, int32_t y);

// Returns |x| + |y| + |z| of the ray's point at t, relative to the probe.
static inline float olx_octahedral_depth(const olx_march *m, const olx_piece *p, float t) {
  const olx_vec3 sign = {p->sign_x, p->sign_y, p->sign_z};
  return olx_dot(sign, m->ray->origin) + olx_dot(sign, m->ray->direction) * t;
}

// Returns whether the ray is in front of or on every plane of the block read last, over [t0, t1] and any part of it,
// even when rounding moves the part's ends. Planes in the pool are not read: the block's greatest inverse depth is used
// instead.
static inline bool olx_block_clears(const olx_march *m, const olx_piece *p, float t0, float t1) {
  const uint32_t form = m->block->words[3] >> 30;
  const float begin = t0 - p->slack, end = t1 + p->slack;
  if (form == OLX_GEOMETRY_POOL) {
    const float depth = olx_max(olx_octahedral_depth(m, p, begin), olx_octahedral_depth(m, p, end));
    return t1 < INFINITY && depth * olx_geometry_nearest(m->block) < 1.0f - 0x1p-16f;
  }
  return form <= OLX_GEOMETRY_TWO && olx_plane_clears(m->planes[0], begin, end) &&
         (form == OLX_GEOMETRY_ONE || olx_plane_clears(m->planes[1], begin, end));
}

// Visits the texels of block (x, y), from the one that the ray has reached at s, t; by_v is that of march_hiz.c. The
// ray leaves the block at t1.
olx_verdict olx_visit_block(olx_march *m, const olx_piece *p, int32_t x, int32_t y, float s, float t, bool by_v,
                            float t1, olx_probe_answer *answer);

// Returns whether the ray reaches the plane of texel c of a field of geometry blocks, which it leaves at t1; *stored
// receives the texel's distance in metres.
bool olx_reaches_plane(olx_march *m, olx_cell c, float t1, float *stored);

// Judges by the surfel of texel c a ray that reaches the stored distance (metres) inside the texel, which it leaves at
// t1.
olx_verdict olx_judge_surfel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float stored,
                             olx_probe_answer *answer);

// Reads texel c, which the ray leaves at t1, and returns whether the ray reaches what it sees; *stored receives the
// texel's distance in metres. `far_squared` is the ray's greatest squared distance from the probe over the texel.
static inline bool olx_reaches_texel(olx_march *m, olx_cell c, float t1, float far_squared, float *stored) {
  if (m->geometry) return olx_reaches_plane(m, c, t1, stored);
  m->steps++;
  const uint32_t code = m->distance[olx_map_index(m->field->stride, c.x, c.y)] & 0x7FFFu;
  *stored = olx_march_distance(m, code);
  return !(far_squared < *stored * *stored || code == 0x7C00u);
}

// Reads texel c and judges the ray by its surfel if the ray reaches it; the parameters are those of olx_reaches_texel.
static inline olx_verdict olx_visit_texel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float far_squared,
                                          olx_probe_answer *answer) {
  float stored;
  return olx_reaches_texel(m, c, t1, far_squared, &stored) ? olx_judge_surfel(m, p, c, t1, stored, answer)
                                                            : OLX_VERDICT_CLEAR;
}

// Judges a ray taken over from another probe by the texel in which it begins, which often hides it.
static inline olx_verdict olx_visit_first(olx_march *m, const olx_piece *p, olx_probe_answer *answer) {
  const olx_cell c = {p->u.first, p->v.first, p->t_begin};
  const olx_vec2 s = olx_crossings_ahead(p, c.x, c.y, 0);
  const float t1 = olx_parameter_at(p, olx_min(s.x, s.y));
  return olx_visit_texel(m, p, c, t1, olx_farthest_squared(m, c.t, t1), answer);
}

#endif
