// Compares the search of a ray through one probe after another in shaders/lib with its C twin (tests/parity.h).
#include "trace/trace.c"

#include "parity.h"

static const uint32_t CODE[] = {
#include "parity_search.spv.inc"
};

typedef struct search_state {
  search search;
} search_state;

static void derive_search(const parity_state *s, search_state *e) {
  e->search = (search){.field = s->field,
                       .settings = &s->settings,
                       .origin = s->point,
                       .direction = s->direction,
                       .t_max = olx_min(s->item->v[14], leave_bounds(s->field, s->point, s->direction)),
                       .limit = s->settings.max_probes,
                       .fallback_probe = UINT32_MAX};
}

// Makes a search that has just begun, or one that has tried some probes and lost the ray somewhere.
static void ask_some(const parity_state *s, search *of) {
  if (!(s->bits[1] & 1u)) return;
  for (uint32_t i = 0; i < 3; i++) remember(of, s->bits[i] >> 12 & 15u);
  of->t = of->lost = 0.5f * s->random[1];
}

static bool has_bricks(const parity_state *s) { return s->field->bricks.header != NULL; }
static uint32_t last_asked(const parity_state *s) { return s->bits[2] % s->field->info.probes.count; }

static uint32_t best_that_sees(const parity_state *s, const search *of) {
  return s->bits[0] & 1u || !has_bricks(s) ? nearest_that_sees(of) : next_listed(of);
}

static uint32_t next_probe(const parity_state *s, const search *of) {
  return s->bits[0] & 1u ? nearest_that_sees(of) : next_selected(of, last_asked(s));
}

static void put_light(parity_result *r, const olx_trace_hit *hit) {
  put_3(r, hit->radiance);
  put_3(r, hit->lobe);
  put_3(r, hit->emission);
}

static void put_hit(parity_result *r, const olx_trace_hit *hit) {
  put_u(r, hit->status);
  put_u(r, hit->probe);
  put_u(r, hit->emitter);
  put_u(r, hit->texel_steps);
  put_u(r, hit->probes_tried);
  put_f(r, hit->distance_metres);
  put_3(r, hit->position);
  put_3(r, hit->normal);
  put_light(r, hit);
  put_f(r, hit->footprint_metres);
}

// clang-format off
#define SEARCH_ROW(name, ...)                                                                                          \
  static void row_##name(parity_state *s, parity_result *r) {                                                          \
    search_state derived, *e = &derived;                                                                               \
    derive_search(s, e);                                                                                               \
    __VA_ARGS__                                                                                                        \
  }

SEARCH_ROW(usable, put_u(r, usable(&e->search, s->probe));)
SEARCH_ROW(is_ray, put_u(r, is_ray(s->point, olx_scale(s->direction, 0.85f + 0.3f * s->random[0]),
        s->random[1] - 0.1f));)
SEARCH_ROW(was_asked, for (uint32_t i = 0; i < 4; i++) remember(&e->search, s->bits[i] & 127u);
    put_u(r, was_asked(&e->search, s->bits[0] >> 8 & 127u)); put_u(r, was_asked(&e->search, s->bits[0] & 127u));)
SEARCH_ROW(remember, remember(&e->search, s->bits[0]); put_u(r, e->search.attempts);
    for (uint32_t i = 0; i < 4; i++) put_u(r, e->search.asked[i]);)
SEARCH_ROW(ray_point, put_3(r, ray_point(&e->search, s->random[0]));)
SEARCH_ROW(line_distance_squared, put_f(r, line_distance_squared(&e->search, s->probe));)
SEARCH_ROW(sees, put_u(r, sees(&e->search, s->probe));)
SEARCH_ROW(probe_sees, put_u(r, olx_probe_sees(s->field, s->probe, s->point, s->random[0],
        s->bits[0] & 1u ? &s->direction : NULL));)
SEARCH_ROW(ask, olx_probe_answer a = {0}; put_u(r, ask(&e->search, s->probe, &a)); put_u(r, e->search.attempts);
    put_f(r, e->search.t); put_f(r, e->search.lost); put_answer(r, &a);)
SEARCH_ROW(first_corner, const olx_grid *grid = &s->field->info.probes.grid;
    const olx_cage cage = olx_cage_at(grid, s->point);
    put_u(r, first_corner(&e->search, grid, &cage));)
SEARCH_ROW(next_corner, ask_some(s, &e->search); put_u(r, next_corner(&e->search));)
SEARCH_ROW(next_neighbour, ask_some(s, &e->search);
    put_u(r, has_voronoi(s) ? next_neighbour(&e->search, last_asked(s)) : 0);)
SEARCH_ROW(best_that_sees, ask_some(s, &e->search); put_u(r, best_that_sees(s, &e->search));)
SEARCH_ROW(next_probe, ask_some(s, &e->search); put_u(r, next_probe(s, &e->search));)
SEARCH_ROW(search_probes, olx_probe_answer a = {0}; uint32_t found = OLX_NO_PROBE;
    const bool settled = search_probes(&e->search, false, &found, &a) || search_probes(&e->search, true, &found, &a);
    put_u(r, settled); put_u(r, e->search.attempts); put_f(r, e->search.t);
    put_u(r, settled ? found : e->search.fallback_probe);)
SEARCH_ROW(bricks_list, const uint32_t *words = s->field->select_data[OLX_SELECT_BRICKS];
    put_u(r, words ? (uint32_t)(olx_bricks_list(&s->field->bricks, s->point) - words) : 0);)
SEARCH_ROW(bricks_probe, const bool some = s->field->bricks.header != NULL;
    put_u(r, some ? olx_bricks_probe(olx_bricks_list(&s->field->bricks, s->point), s->bits[0] & 7u) : 0);)
SEARCH_ROW(sky_radiance, put_3(r, sky_radiance(&e->search));)
SEARCH_ROW(describe, const olx_probe_answer a = {.status = (olx_trace_status)(s->bits[1] % 3u), .t = s->random[0],
        .texel = texel_of(s)};
    const olx_trace_hit hit = describe(&e->search, s->probe, &a, s->item->v[14], s->bits[2] % 2u == 0u); put_hit(r, &hit);)
SEARCH_ROW(read_light, olx_trace_hit hit = {.position = s->point}; read_light(&e->search, s->probe, texel_of(s), s->bits[2] % 2u == 0u, &hit);
    put_u(r, hit.emitter); put_light(r, &hit);)
SEARCH_ROW(unknown_hit, put_u(r, NOTHING_KNOWN.status); put_u(r, NOTHING_KNOWN.probe); put_u(r, NOTHING_KNOWN.emitter);
    put_f(r, NOTHING_KNOWN.distance_metres); put_light(r, &NOTHING_KNOWN);)
SEARCH_ROW(leave_bounds, put_f(r, leave_bounds(s->field, s->point, s->direction));)
SEARCH_ROW(trace, const olx_trace_hit hit = olx_trace(s->field, &s->settings, s->point, s->direction, s->item->v[14]);
    put_hit(r, &hit);)

static const parity_row ROWS[] = {
    PARITY(usable, 1e-5f, 1e-3),
    PARITY(is_ray, 1e-5f, 1e-3),
    PARITY(was_asked, 1e-5f, 1e-3),
    PARITY(remember, 1e-5f, 1e-3),
    PARITY(ray_point, 1e-5f, 1e-3),
    PARITY(line_distance_squared, 1e-5f, 1e-3),
    PARITY(sees, 1e-5f, 1e-3),
    PARITY(ask, 1e-5f, 1e-3),
    PARITY(first_corner, 1e-5f, 1e-3),
    PARITY(next_corner, 1e-5f, 1e-3),
    PARITY(next_neighbour, 1e-5f, 1e-3),
    PARITY(best_that_sees, 1e-5f, 1e-3),
    PARITY(next_probe, 1e-5f, 1e-3),
    PARITY(search_probes, 1e-5f, 1e-3),
    PARITY(sky_radiance, 1e-5f, 1e-3),
    PARITY(describe, 1e-4f, 1e-3),
    PARITY(read_light, 1e-4f, 1e-3),
    PARITY(unknown_hit, 1e-5f, 0),
    PARITY(leave_bounds, 1e-5f, 1e-3),
    PARITY(trace, 1e-4f, 1e-3),
    PARITY(bricks_list, 1e-5f, 1e-3),
    PARITY(bricks_probe, 1e-5f, 1e-3),
    PARITY(probe_sees, 1e-5f, 1e-3),
};
// clang-format on
static const parity_code CODES[] = {{ROWS_OF_SEARCH, {CODE, sizeof CODE}}};
// The room with many probes is left out: llvmpipe ends loops after 65535 iterations, which a search over so many can
// exceed.
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {ROWS_OF_MARCH, ROWS_OF_SEARCH},
    [PARITY_OPEN_COURT] = {ROWS_OF_MARCH, ROWS_OF_SEARCH},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
