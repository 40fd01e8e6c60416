// Marches a ray through one probe's map texel by texel. This is the plain specification that the faster marchers must
// agree with.
#include "trace/march.h"

olx_verdict olx_march_texels(olx_march *m, const olx_piece *p, olx_probe_answer *answer) {
  olx_cell c = {p->u.first, p->v.first, p->t_begin};
  for (;;) {
    const olx_vec2 s = olx_crossings_ahead(p, c.x, c.y, 0);
    const float s1 = olx_min(s.x, s.y), t1 = olx_parameter_at(p, s1);
    const olx_verdict verdict = olx_visit_texel(m, p, c, t1, olx_farthest_squared(m, c.t, t1), answer);
    if (verdict != OLX_VERDICT_CLEAR || s1 >= 1.0f) return verdict;
    c = olx_next_cell(p, c, s, t1);
  }
}
