// Marches a ray through one probe's map in two levels (McGuire et al. 2017): skips blocks of texels in front of which
// the ray stays, and visits the texels of all other blocks.
#include "trace/march.h"

olx_verdict olx_march_two_level(olx_march *m, const olx_piece *p, olx_probe_answer *answer) {
  const uint32_t level = m->field->pyramid.levels > 1 ? 1 : 0, shift = olx_pyramid_shift(level);
  olx_cell c = {p->u.first, p->v.first, p->t_begin};
  for (;;) {
    // Skip whole blocks while the ray stays in front of everything in them.
    const int32_t block_x = c.x >> shift, block_y = c.y >> shift;
    olx_vec2 s = olx_crossings_ahead(p, block_x, block_y, shift);
    float s1 = olx_min(s.x, s.y), t1 = olx_parameter_at(p, s1);
    if (olx_reach_squared(m, p, c.t, t1) < olx_least_squared(m, level, block_x, block_y)) {
      if (s1 >= 1.0f) return OLX_VERDICT_CLEAR;
      const bool by_v = s.x > s.y; // ties step along u first
      c = (olx_cell){olx_texel_at(&p->u, s1, true), olx_texel_at(&p->v, s1, by_v), t1};
      continue;
    }
    // Visit the texels of this block in order.
    do {
      s = olx_crossings_ahead(p, c.x, c.y, 0);
      s1 = olx_min(s.x, s.y);
      t1 = olx_parameter_at(p, s1);
      const olx_verdict verdict = olx_visit_texel(m, p, c, t1, olx_farthest_squared(m, c.t, t1), answer);
      if (verdict != OLX_VERDICT_CLEAR || s1 >= 1.0f) return verdict;
      c = olx_next_cell(p, c, s, t1);
    } while (c.x >> shift == block_x && c.y >> shift == block_y);
  }
}
