// A texel as a surface element, and what it says about a ray that reaches its distance (docs/maths.md, "Marching").
#ifndef OLX_TRACE_SURFEL_H
#define OLX_TRACE_SURFEL_H

#include "trace/ray_image.h"

// Block (x, y) of the map, in a field of geometry blocks, with the planes of its texels where they are one or two.
void olx_read_block(olx_march *m, int32_t x, int32_t y);

// |x| + |y| + |z| of a point of the ray.
static inline float olx_octahedral_depth(const olx_march *m, const olx_piece *p, float t) {
  const olx_vec3 sign = {p->sign_x, p->sign_y, p->sign_z};
  return olx_dot(sign, m->ray->origin) + olx_dot(sign, m->ray->direction) * t;
}

// Whether the ray is nowhere behind any plane of the block that was read last over any part of [t0, t1], whatever
// rounding does to the part's ends. Planes of the pool are not read for that.
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

// The texels of block (x, y) from the one on in which the ray is at s, t: by_v as in march_hiz.c. The ray leaves it at
// t1.
olx_verdict olx_visit_block(olx_march *m, const olx_piece *p, int32_t x, int32_t y, float s, float t, bool by_v,
                            float t1, olx_probe_answer *answer);

// Texel c of a field of geometry blocks, which the ray leaves at t1.
olx_verdict olx_visit_plane(olx_march *m, const olx_piece *p, olx_cell c, float t1, olx_probe_answer *answer);

// The ray reaches the stored distance (metres) inside texel c, which it leaves at t1: what does the texel's surfel say?
olx_verdict olx_judge_surfel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float stored,
                             olx_probe_answer *answer);

// Reads texel c and judges its surfel if the ray reaches it; `far_squared` is the ray's greatest squared distance from
// the probe over the texel.
static inline olx_verdict olx_visit_texel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float far_squared,
                                          olx_probe_answer *answer) {
  if (m->geometry) return olx_visit_plane(m, p, c, t1, answer);
  m->steps++;
  const uint32_t code = m->distance[olx_map_index(m->field->stride, c.x, c.y)] & 0x7FFFu;
  const float stored = olx_march_distance(m, code);
  if (far_squared < stored * stored || code == 0x7C00u) return OLX_VERDICT_CLEAR;
  return olx_judge_surfel(m, p, c, t1, stored, answer);
}

// Whether the texel in which a ray begins that another probe has handed on hides it, as it often does.
static inline olx_verdict olx_visit_first(olx_march *m, const olx_piece *p, olx_probe_answer *answer) {
  const olx_cell c = {p->u.first, p->v.first, p->t_begin};
  const olx_vec2 s = olx_crossings_ahead(p, c.x, c.y, 0);
  const float t1 = olx_parameter_at(p, olx_min(s.x, s.y));
  return olx_visit_texel(m, p, c, t1, olx_farthest_squared(m, c.t, t1), answer);
}

#endif
