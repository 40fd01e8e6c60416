// Compares the march of a ray through one probe's map in shaders/lib with its C twin (tests/parity.h).
#include "trace/march_hiz.c"
#include "trace/probe_trace.c"
#include "trace/surfel.c"

#include "parity.h"

static const uint32_t CODE[] = {
#include "parity_march.spv.inc"
};

typedef struct march_state {
  olx_probe_ray ray;
  olx_march march;
  olx_vec3 planes;
  olx_piece piece;
  olx_cell cell;
  surfel surfel;
} march_state;

static void derive_march(const parity_state *s, march_state *e) {
  const olx_field *f = s->field;
  e->ray = (olx_probe_ray){.origin = olx_sub(s->point, f->probe_positions[s->probe]),
                           .direction = s->direction,
                           .t_min = s->bits[3] & 1u ? 0.0f : s->item->v[13],
                           .t_max = s->bits[3] & 2u ? INFINITY : s->item->v[14]};
  e->march = olx_begin_march(f, s->probe, &e->ray);
  const olx_vec3 o = e->ray.origin, d = e->ray.direction;
  e->planes = olx_v3(plane_at(o.x, d.x), plane_at(o.y, d.y), plane_at(o.z, d.z));
  e->piece = make_piece(&e->march, e->planes, e->ray.t_min, next_cut(e->planes, e->ray.t_min, e->ray.t_max));
  e->cell = (olx_cell){e->piece.u.first, e->piece.v.first, e->piece.t_begin};
  e->surfel = read_surfel(&e->march, (int32_t)s->x, (int32_t)s->y, s->item->v[15]);
}

static void put_axis(parity_result *r, olx_image_axis a) {
  put_f(r, a.begin);
  put_f(r, a.travel);
  put_i(r, a.step);
  put_i(r, a.ahead);
  put_i(r, a.first);
}

static olx_cell texel_cell(const parity_state *s) { return (olx_cell){(int32_t)s->x, (int32_t)s->y, 0.0f}; }
static olx_vec2 ahead_of(const march_state *e) { return olx_crossings_ahead(&e->piece, e->cell.x, e->cell.y, 0); }
static float cell_exit(const march_state *e) {
  return olx_parameter_at(&e->piece, olx_min(ahead_of(e).x, ahead_of(e).y));
}
static float cell_far_squared(const march_state *e) { return olx_farthest_squared(&e->march, e->cell.t, cell_exit(e)); }

static olx_tracer plain_tracer(const parity_state *s) {
  return s->settings.tracer == OLX_TRACER_TEXEL ? OLX_TRACER_TEXEL : OLX_TRACER_TWO_LEVEL;
}

// Returns where GLSL begins a march: texels are nodes of level -1, and a ray that another probe handed on begins with
// the texel that contains its start.
static stand begin_stand(const march_state *e) {
  const bool first_piece = e->piece.t_begin <= e->ray.t_min, first = first_piece && e->piece.t_begin > 0.0f;
  const uint32_t level = first_piece ? 0 : e->march.field->pyramid.levels - 1;
  const uint32_t shift = first ? 0 : olx_pyramid_shift(level);
  return (stand){.x = e->cell.x >> shift, .y = e->cell.y >> shift, .t = e->cell.t};
}

static void put_stand(parity_result *r, stand at) {
  put_i(r, at.x);
  put_i(r, at.y);
  put_i(r, (int32_t)at.level);
}

// Returns the node after a texel was left: the texel's node of level 0, or the next one outside it.
static stand left_texel(const olx_march *m, int32_t x, int32_t y, int32_t next_x, int32_t next_y) {
  const uint32_t shift = OLX_PYRAMID_FINEST;
  stand at = {.x = x >> shift, .y = y >> shift};
  if (at.x == next_x >> shift && at.y == next_y >> shift) return (stand){.x = next_x, .y = next_y, .level = UINT32_MAX};
  leave(m, &at, next_x >> shift, next_y >> shift, 0.0f, 0.0f, true);
  return at;
}

static stand left_node(const olx_march *m, const parity_state *s) {
  const uint32_t level = s->bits[2] % m->field->pyramid.levels;
  stand at = {
      .x = (int32_t)s->x >> olx_pyramid_shift(level), .y = (int32_t)s->y >> olx_pyramid_shift(level), .level = level};
  leave(m, &at, at.x + (int32_t)(s->bits[0] % 5u) - 2, at.y + (int32_t)(s->bits[1] % 5u) - 2, 0.0f, 0.0f, true);
  return at;
}

// Finds the first texel of a piece whose stored distance the ray reaches, without a pyramid.
static bool find_texel(const march_state *e, olx_cell *c, float *stored) {
  for (;;) {
    const olx_vec2 s = olx_crossings_ahead(&e->piece, c->x, c->y, 0);
    const float s1 = olx_min(s.x, s.y), t1 = olx_parameter_at(&e->piece, s1);
    const olx_field *f = e->march.field;
    olx_march m = e->march;
    if (f->geometry && olx_reaches_plane(&m, *c, t1, stored)) return true;
    *stored = olx_texel_distance(f, e->march.probe, olx_map_index(f->stride, c->x, c->y));
    if (!f->geometry && olx_farthest_squared(&e->march, c->t, t1) >= *stored * *stored && *stored < INFINITY)
      return true;
    if (s1 >= 1.0f) return false;
    *c = olx_next_cell(&e->piece, *c, s, t1);
  }
}

// Writes the texel and gap of an answer for rays that meet something.
static void put_answer_of_ray(parity_result *r, const olx_probe_answer *a) {
  put_u(r, a->status);
  put_u(r, a->steps);
  if (a->status == OLX_TRACE_MISS) return;
  put_answer(r, a);
}

// clang-format off
#define MARCH_ROW(name, ...)                                                                                           \
  static void row_##name(parity_state *s, parity_result *r) {                                                          \
    march_state derived, *e = &derived;                                                                                \
    derive_march(s, e);                                                                                                \
    __VA_ARGS__                                                                                                        \
  }

MARCH_ROW(axis_step, put_i(r, e->piece.u.step); put_i(r, e->piece.v.step);)
MARCH_ROW(axis_ahead, put_i(r, e->piece.u.ahead); put_i(r, e->piece.v.ahead);)
MARCH_ROW(radius_squared, put_f(r, olx_radius_squared(&e->march, s->random[0]));)
MARCH_ROW(farthest_squared, put_f(r, olx_farthest_squared(&e->march, s->random[0], s->random[0] + s->random[1]));)
MARCH_ROW(reach_squared, put_f(r, olx_reach_squared(&e->march, &e->piece, s->random[0], s->random[0] + s->random[1]));)
MARCH_ROW(nearest_squared, put_f(r, olx_nearest_squared(&e->march, s->random[0], s->random[0] + s->random[1]));)
MARCH_ROW(clamp_texel, put_i(r, olx_clamp_texel(s->view.x, s->point.x * 8.0f, s->field->n));)
MARCH_ROW(image_at, olx_vec2 image = {0}; put_u(r, olx_image_at(&e->march, &e->piece, e->ray.t_min, &image));
    put_2(r, image);)
MARCH_ROW(parameter_at, put_f(r, olx_parameter_at(&e->piece, s->random[0]));)
MARCH_ROW(crossing, put_f(r, olx_crossing(&e->piece.u, (int32_t)s->x));)
MARCH_ROW(texel_at, put_i(r, olx_texel_at(&e->piece.u, s->random[0], (s->bits[3] & 4u) != 0));)
MARCH_ROW(pyramid_shift, put_u(r, olx_pyramid_shift(s->bits[0] & 3u));)
MARCH_ROW(pyramid_index, const uint32_t side = 2u << (s->bits[0] & 7u);
    put_u(r, olx_pyramid_index(side, s->bits[1] % side, s->bits[2] % side));)
MARCH_ROW(least_squared, put_f(r, olx_least_squared(&e->march, 0, (int32_t)s->x >> OLX_PYRAMID_FINEST,
                                              (int32_t)s->y >> OLX_PYRAMID_FINEST)); put_u(r, e->march.steps);)
MARCH_ROW(read_surfel, put_f(r, e->surfel.distance); put_f(r, e->surfel.footprint); put_f(r, e->surfel.slack);
    put_f(r, e->surfel.cosine); put_f(r, e->surfel.f0); put_f(r, e->surfel.f1);)
MARCH_ROW(plane_tolerance, put_f(r, plane_tolerance(&e->surfel));)
MARCH_ROW(beyond_reach, put_u(r, beyond_reach(&e->march, texel_cell(s), &e->surfel, 4.0f * s->random[0]));
    put_u(r, e->march.steps);)
MARCH_ROW(supported, put_u(r, supported(&e->march, &e->piece, e->cell, &e->surfel, e->ray.t_min + 0.1f * s->random[0]));
    put_u(r, e->march.steps);)
MARCH_ROW(judge_height, olx_probe_answer a = {0};
    put_u(r, judge_height(&e->march, &e->piece, e->cell, cell_exit(e), &e->surfel, &a)); put_f(r, a.t);)
MARCH_ROW(judge_surfel, olx_probe_answer a = {0};
    put_u(r, olx_judge_surfel(&e->march, &e->piece, e->cell, cell_exit(e), s->item->v[15], &a)); put_answer(r, &a);)
MARCH_ROW(read_block, if (!s->field->geometry) return; for (uint32_t k = 0; k < 2; k++)
    olx_read_block(&e->march, (int32_t)s->x / 4, (int32_t)s->y / 4);
    for (uint32_t k = 0; k < 4; k++) put_u(r, e->march.block->words[k]); put_u(r, e->march.steps);)
MARCH_ROW(octahedral_depth, put_f(r, olx_octahedral_depth(&e->march, &e->piece, s->random[0]));)
MARCH_ROW(plane_clears, const olx_vec3 d = s->direction;
    put_u(r, olx_plane_clears(olx_plane_along(&e->ray, olx_scale(d, s->random[2])), s->random[0],
                              s->random[0] + s->random[1]));
    put_u(r, olx_plane_clears(olx_plane_along(&e->ray, olx_scale(olx_v3(d.z, d.x, d.y), s->random[2])), s->random[0],
                              INFINITY));)
MARCH_ROW(block_clears, if (!s->field->geometry) return;
    olx_read_block(&e->march, (int32_t)s->x / 4, (int32_t)s->y / 4);
    put_u(r, olx_block_clears(&e->march, &e->piece, s->random[0], s->random[0] + s->random[1]));)
MARCH_ROW(reaches_plane, if (!s->field->geometry) return; float stored;
    const bool reached = olx_reaches_plane(&e->march, e->cell, cell_exit(e), &stored); put_u(r, reached);
    put_u(r, e->march.steps); if (reached) put_f(r, stored);)
MARCH_ROW(reaches_texel, float stored;
    const bool reached = olx_reaches_texel(&e->march, e->cell, cell_exit(e), cell_far_squared(e), &stored);
    put_u(r, reached); put_u(r, e->march.steps); if (reached) put_f(r, stored);)
MARCH_ROW(next_cell, const olx_cell c = olx_next_cell(&e->piece, e->cell, random_2(s), cell_exit(e)); put_i(r, c.x);
    put_i(r, c.y);
    put_f(r, c.t);)
MARCH_ROW(crossings_ahead, put_2(r, olx_crossings_ahead(&e->piece, e->cell.x >> 2, e->cell.y >> 2, 2));)
MARCH_ROW(march_texels, olx_probe_answer a = {0}; put_u(r, olx_march_texels(&e->march, &e->piece, &a));
    put_answer(r, &a);)
MARCH_ROW(march_two_level, olx_probe_answer a = {0}; put_u(r, olx_march_two_level(&e->march, &e->piece, &a));
    put_answer(r, &a);
    put_u(r, e->march.steps);)
MARCH_ROW(march_piece, olx_probe_answer a = {0}; put_u(r, march_piece(&e->march, &e->piece, plain_tracer(s), &a));
    put_answer(r, &a);)
MARCH_ROW(end_at, const piece_end end = end_at(&e->march, &e->piece, e->ray.t_min + 0.3f * s->random[0]);
    put_f(r, end.u);
    put_f(r, end.v); put_f(r, end.inverse); put_u(r, end.centre);)
MARCH_ROW(make_axis, put_axis(r, make_axis(s->point.x * 8.0f, s->point.y * 8.0f, s->view.x, s->field->n));)
MARCH_ROW(plane_at, put_f(r, plane_at(s->point.x, s->direction.x));)
MARCH_ROW(planes_of, put_3(r, e->planes);)
MARCH_ROW(sign_after, put_f(r, sign_after(e->ray.origin.x, e->ray.direction.x, e->planes.x, s->random[0]));)
MARCH_ROW(make_piece, put_axis(r, e->piece.u); put_axis(r, e->piece.v); put_f(r, e->piece.near);
    put_f(r, e->piece.slope);
    put_f(r, e->piece.rise);)
MARCH_ROW(next_cut, put_f(r, next_cut(e->planes, e->ray.t_min, e->ray.t_max));)
MARCH_ROW(begin_stand, const stand at = begin_stand(e); put_i(r, at.x); put_i(r, at.y); put_f(r, at.t);)
MARCH_ROW(enter, const int32_t level = (int32_t)(s->bits[0] % 3u) - 1, shift = OLX_PYRAMID_STEP * (level + 1);
    put_i(r, olx_texel_at(&e->piece.u, s->random[0], true) >> shift);
    put_i(r, olx_texel_at(&e->piece.v, s->random[0], (s->bits[1] & 1u) != 0) >> shift);)
MARCH_ROW(leave, const int32_t x = e->cell.x + (int32_t)(s->bits[0] % 33u) - 16;
    const int32_t y = e->cell.y + (int32_t)(s->bits[1] % 33u) - 16;
    put_stand(r, left_texel(&e->march, e->cell.x, e->cell.y, x, y)); put_stand(r, left_node(&e->march, s)); )
MARCH_ROW(find_texel, float stored = INFINITY; olx_cell c = e->cell; const bool found = find_texel(e, &c, &stored);
    put_u(r, found);
    if (found) put_i(r, c.x), put_i(r, c.y), put_f(r, c.t), put_f(r, stored);)
MARCH_ROW(march_hiz, const olx_probe_answer a = olx_trace_probe(s->field, s->probe, &e->ray, OLX_TRACER_HIZ);
    put_answer_of_ray(r, &a);)
MARCH_ROW(march_pieces, const olx_probe_answer a = olx_trace_probe(s->field, s->probe, &e->ray, plain_tracer(s));
    put_answer_of_ray(r, &a);)
MARCH_ROW(begin_march, put_f(r, e->march.closest); put_f(r, e->march.miss_squared);
    put_u(r, s->field->pyramid.least_nodes * s->probe);)
MARCH_ROW(trace_probe, const olx_probe_answer a = olx_trace_probe(s->field, s->probe, &e->ray, s->settings.tracer);
    put_answer(r, &a);)

static const parity_row ROWS[] = {
    PARITY(axis_step, 1e-5f, 1e-3),
    PARITY(axis_ahead, 1e-5f, 1e-3),
    PARITY(radius_squared, 1e-5f, 1e-3),
    PARITY(farthest_squared, 1e-5f, 1e-3),
    PARITY(reach_squared, 1e-5f, 1e-3),
    PARITY(nearest_squared, 1e-5f, 1e-3),
    PARITY(clamp_texel, 1e-5f, 1e-3),
    PARITY(image_at, 1e-5f, 1e-3),
    PARITY(parameter_at, 1e-5f, 1e-3),
    PARITY(crossing, 1e-5f, 1e-3),
    PARITY(texel_at, 1e-5f, 1e-3),
    PARITY(pyramid_shift, 1e-5f, 1e-3),
    PARITY(pyramid_index, 1e-5f, 1e-3),
    PARITY(least_squared, 1e-5f, 1e-3),
    PARITY(read_surfel, 1e-5f, 1e-3),
    PARITY(plane_tolerance, 1e-5f, 1e-3),
    PARITY(beyond_reach, 1e-5f, 1e-3),
    PARITY(supported, 1e-5f, 1e-3),
    PARITY(judge_height, 1e-5f, 1e-3),
    PARITY(judge_surfel, 1e-5f, 1e-3),
    PARITY(read_block, 1e-5f, 0),
    PARITY(octahedral_depth, 1e-5f, 0),
    PARITY(plane_clears, 1e-5f, 1e-3),
    PARITY(block_clears, 1e-5f, 1e-3),
    PARITY(reaches_plane, 1e-5f, 1e-3),
    PARITY(reaches_texel, 1e-5f, 1e-3),
    PARITY(next_cell, 1e-5f, 1e-3),
    PARITY(crossings_ahead, 1e-5f, 1e-3),
    PARITY(march_texels, 1e-5f, 1e-3),
    PARITY(march_two_level, 1e-5f, 1e-3),
    PARITY(march_piece, 1e-5f, 1e-3),
    PARITY(end_at, 1e-5f, 1e-3),
    PARITY(make_axis, 1e-5f, 1e-3),
    PARITY(plane_at, 1e-5f, 1e-3),
    PARITY(planes_of, 1e-5f, 1e-3),
    PARITY(sign_after, 1e-5f, 1e-3),
    PARITY(make_piece, 1e-5f, 1e-3),
    PARITY(next_cut, 1e-5f, 1e-3),
    PARITY(begin_stand, 1e-5f, 1e-3),
    PARITY(enter, 1e-5f, 1e-3),
    PARITY(leave, 1e-5f, 1e-3),
    PARITY(find_texel, 1e-5f, 1e-3),
    PARITY(march_hiz, 1e-5f, 1e-3),
    PARITY(march_pieces, 1e-5f, 1e-3),
    PARITY(begin_march, 1e-5f, 1e-3),
    PARITY(trace_probe, 1e-5f, 1e-3),
};
// clang-format on
static const parity_code CODES[] = {{ROWS_OF_MARCH, {CODE, sizeof CODE}}};
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {ROWS_OF_FIELD, ROWS_OF_MARCH},
    [PARITY_OPEN_COURT] = {ROWS_OF_FIELD, ROWS_OF_MARCH},
    [PARITY_MANY_PROBES] = {ROWS_OF_FIELD, ROWS_OF_MARCH},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
