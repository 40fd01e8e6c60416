// A texel as a surface element, and what it says about a ray that reaches its distance (docs/maths.md, "Marching").
#ifndef OLX_TRACE_SURFEL_H
#define OLX_TRACE_SURFEL_H

#include "trace/ray_image.h"

// The ray reaches the stored distance (metres) inside texel c, which it leaves at t1: what does the texel's surfel say?
olx_verdict olx_judge_surfel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float stored,
                             olx_probe_answer *answer);

// The same for a texel that is yet to be read; `far_squared` is the ray's greatest squared distance over it.
static inline olx_verdict olx_visit_texel(olx_march *m, const olx_piece *p, olx_cell c, float t1, float far_squared,
                                          olx_probe_answer *answer) {
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
