// Marches a ray through one probe's map by a pyramid of smallest distances: ascends a level where the ray stays in
// front of a whole node, and descends where it may reach a stored surface.
#include "trace/march.h"

// The node that the march has reached, and where the ray entered it.
typedef struct stand {
  int32_t x, y;
  uint32_t level;
  float s, t;
  bool by_v; // entered across a line of v: lines of both axes up to s are passed, else not those of v at s
} stand;

// Steps over the nearest line ahead, and ascends a level if that leaves the parent node too.
static inline void leave(const olx_march *m, stand *at, int32_t x, int32_t y, float s, float t, bool by_v) {
  const bool left_parent = ((x ^ at->x) | (y ^ at->y)) >> OLX_PYRAMID_STEP;
  const uint32_t up = left_parent && at->level + 1 < m->field->pyramid.levels;
  *at = (stand){.x = x >> (OLX_PYRAMID_STEP * up),
                .y = y >> (OLX_PYRAMID_STEP * up),
                .level = at->level + up,
                .s = s,
                .t = t,
                .by_v = by_v};
}

// Visits the texels of a level 0 node, from the one that the march has reached. Texels that the ray passes nearer than
// the node's smallest distance are not read, because the ray is in front of them.
static olx_verdict march_node(olx_march *m, const olx_piece *p, stand *at, float least_squared,
                              olx_probe_answer *answer) {
  olx_cell c = {olx_texel_at(&p->u, at->s, true), olx_texel_at(&p->v, at->s, at->by_v), at->t};
  const size_t begin = m->field->texels * m->probe + olx_map_index(m->field->stride, c.x, c.y);
  __builtin_prefetch(m->field->normal + begin); // a hit nearby will read this
  for (;;) {
    const olx_vec2 s = olx_crossings_ahead(p, c.x, c.y, 0);
    const float s1 = olx_min(s.x, s.y), t1 = olx_parameter_at(p, s1);
    const float far_squared = olx_farthest_squared(m, c.t, t1);
    if (!(far_squared < least_squared)) {
      const olx_verdict verdict = olx_visit_texel(m, p, c, t1, far_squared, answer);
      if (verdict != OLX_VERDICT_CLEAR) return verdict;
    }
    at->s = s1;
    if (s1 >= 1.0f) return OLX_VERDICT_CLEAR;
    c = olx_next_cell(p, c, s, t1);
    const int32_t x = c.x >> OLX_PYRAMID_FINEST, y = c.y >> OLX_PYRAMID_FINEST;
    if (x == at->x && y == at->y) continue;
    leave(m, at, x, y, s1, t1, s.x > s.y);
    return OLX_VERDICT_CLEAR;
  }
}

olx_verdict olx_march_hiz(olx_march *m, const olx_piece *p, olx_probe_answer *answer) {
  const bool first_piece = p->t_begin <= m->ray->t_min;
  if (first_piece && p->t_begin > 0.0f) {
    const olx_verdict verdict = olx_visit_first(m, p, answer);
    if (verdict != OLX_VERDICT_CLEAR) return verdict;
  }
  // A ray begins at a surface, where only the smallest nodes are clear, and enters later faces in open space.
  const uint32_t begin_level = first_piece ? 0 : m->field->pyramid.levels - 1,
                 begin_shift = olx_pyramid_shift(begin_level);
  stand at = {.x = p->u.first >> begin_shift,
              .y = p->v.first >> begin_shift,
              .level = begin_level,
              .s = -1.0f, // before every line
              .t = p->t_begin};
  for (;;) {
    const olx_vec2 s = olx_crossings_ahead(p, at.x, at.y, olx_pyramid_shift(at.level));
    const float s1 = olx_min(s.x, s.y), t1 = olx_parameter_at(p, s1);
    const bool block = at.level == 0 && m->geometry; // a block, which is clear unless it ends the ray
    const float least_squared = block ? INFINITY : olx_least_squared(m, at.level, at.x, at.y);
    if (block) {
      const olx_verdict verdict = olx_visit_block(m, p, at.x, at.y, at.s, at.t, at.by_v, t1, answer);
      if (verdict != OLX_VERDICT_CLEAR) return verdict;
    }
    if (block || olx_reach_squared(m, p, at.t, t1) < least_squared) {
      if (s1 >= 1.0f) return OLX_VERDICT_CLEAR;
      const bool by_v = s.x > s.y;
      leave(m, &at, at.x + (by_v ? 0 : p->u.step), at.y + (by_v ? p->v.step : 0), s1, t1, by_v);
    } else if (at.level > 0) {
      at.level--;
      const uint32_t below = olx_pyramid_shift(at.level);
      at.x = olx_texel_at(&p->u, at.s, true) >> below;
      at.y = olx_texel_at(&p->v, at.s, at.by_v) >> below;
    } else {
      const olx_verdict verdict = march_node(m, p, &at, least_squared, answer);
      if (verdict != OLX_VERDICT_CLEAR || at.s >= 1.0f) return verdict;
    }
  }
}
