// Compares light stored at surfaces in shaders/lib with its C twin (tests/parity.h).
#include "field/texels.h"
#include "shade/irradiance.c"
#include "shade/surface_irradiance.c"

#include "parity.h"

static const uint32_t CODE[] = {
#include "parity_surface.spv.inc"
};

// The values that parity_surface.comp derives from an item in the same way.
typedef struct surface_state {
  olx_surface_point p;
  probe_view view;
  int32_t first_x, first_y;
} surface_state;

static void derive_surface(parity_state *s, surface_state *e) {
  const float distance = olx_texel_distance(s->field, s->probe, texel_of(s));
  e->p = (olx_surface_point){.position = s->point, .geometric_normal = s->direction, .view = s->view};
  if ((s->bits[3] & 7u) != 0 && distance < INFINITY) {
    const float size = 0.2f * distance / (float)s->field->n;
    const olx_vec3 aside =
        olx_v3((s->random[0] - 0.5f) * size, (s->random[1] - 0.5f) * size, (s->random[2] - 0.5f) * size);
    const olx_vec3 centre = olx_texel_direction(s->x, s->y, s->field->n);
    e->p.geometric_normal = olx_texel_normal(s->field, s->probe, texel_of(s));
    e->p.position = olx_add(olx_madd(s->field->probe_positions[s->probe], centre, distance), aside);
  }
  const olx_vec3 n = e->p.geometric_normal;
  e->p.vertex_normal = n;
  e->p.shading_normal = s->bits[3] & 0x10000u ? olx_normalize(olx_madd(n, s->view, 0.5f)) : n;
  s->settings.surface_tolerance = s->bits[3] & 0x20000u ? s->random[3] : 0.0f;
  e->view = view_from(s->field, s->settings.surface_tolerance, s->probe, &e->p);
  const uint32_t corner = s->bits[0] >> 16;
  e->first_x = (int32_t)s->x - (int32_t)(corner & 1u);
  e->first_y = (int32_t)s->y - (int32_t)(corner >> 1 & 1u);
}

static bool see(const parity_state *s, const surface_state *e, int32_t x, int32_t y, seen_texel *t) {
  *t = (seen_texel){.distance = 0.0f};
  if (see_texel(s->field, &e->view, olx_map_index(s->field->stride, x, y), x, y, t)) return true;
  // The shader continues with a texel of the sky as if it were at the probe.
  int32_t sx, sy;
  olx_border_source(x, y, (int32_t)s->field->n, &sx, &sy);
  t->distance = 0.0f;
  t->normal = olx_texel_normal(s->field, s->probe, olx_map_index(s->field->stride, x, y));
  t->facing = -olx_dot(t->normal, olx_texel_direction((uint32_t)sx, (uint32_t)sy, s->field->n));
  t->step = e->view.offset;
  t->away = olx_length(t->step);
  return false;
}

// Returns a word of the volume: its structure, followed by its light.
static uint32_t volume_word(const parity_state *s, uint32_t index) {
  const olx_volume *v = &s->field->volume;
  if (!v->header) return 0;
  const uint32_t *words = (const uint32_t *)(const void *)v->header;
  const uint32_t count = (uint32_t)(v->index - words) + v->header->size[0] * v->header->size[1] * v->header->size[2];
  uint32_t word;
  memcpy(&word, index < count ? words + index : (const uint32_t *)(const void *)v->irradiance + (index - count), 4);
  return word;
}

typedef struct fallen {
  olx_vec3 from, to;
} fallen;

// Returns the light where none is stored, with the item's direction and its view as normals; irradiance probes are
// weighted for the direction.
static fallen fall_back(const parity_state *s) {
  const olx_surface_point p = {.position = s->point, .geometric_normal = s->direction, .view = s->view};
  olx_volume_light_at volume;
  if (olx_volume_gather(s->field, p.position, p.geometric_normal, &volume)) {
    return (fallen){olx_volume_towards(&volume, s->direction), olx_volume_bent(&volume, s->direction, s->view)};
  }
  const olx_irradiance_weights w = olx_irradiance_weigh(&s->source, terms_of(&s->settings), s->settings.keep_buried,
                                                        s->point, s->direction, s->view);
  const olx_bilinear from = olx_bilinear_at(olx_octahedral_encode(s->direction), s->source.irradiance_n),
                     to = olx_bilinear_at(olx_octahedral_encode(s->view), s->source.irradiance_n);
  fallen f = {{0, 0, 0}, {0, 0, 0}};
  for (uint32_t i = 0; i < w.count; i++) {
    f.from = olx_madd(f.from, map_irradiance(&s->source, w.probe[i], &from), w.weight[i]);
    f.to = olx_madd(f.to, map_irradiance(&s->source, w.probe[i], &to), w.weight[i]);
  }
  return f;
}

// Returns a probe of the point's brick, or of its cage in a field without bricks; UINT32_MAX: there is none.
static uint32_t near_probe(const parity_state *s, const surface_state *e, uint32_t place) {
  const olx_field *field = s->field;
  if (field->bricks.header) {
    const uint32_t probe = olx_bricks_probe(olx_bricks_list(&field->bricks, e->p.position), place);
    return probe == OLX_BRICK_NO_PROBE ? UINT32_MAX : probe;
  }
  const olx_cage cage = olx_cage_at(&field->info.probes.grid, e->p.position);
  return olx_cage_has(&cage, place) ? olx_cage_probe(&field->info.probes.grid, &cage, place) : UINT32_MAX;
}

static void put_ranking(const parity_state *s, const surface_state *e, parity_result *r) {
  olx_sample_settings settings = s->settings;
  settings.max_probes = OLX_MOST_RANKED;
  ranking list;
  settings.select = s->bits[3] & 1u ? OLX_SELECT_EXHAUSTIVE : OLX_SELECT_BEST;
  if (settings.select == OLX_SELECT_EXHAUSTIVE) rank_all(s->field, &settings, &e->p, &list);
  else rank_near(s->field, &settings, &e->p, &list);
  for (uint32_t i = 0; i < 6; i++) {
    put_u(r, i < list.count ? list.probes[i].probe : UINT32_MAX);
    put_f(r, i < list.count ? list.probes[i].weight : 0.0f);
  }
}

static void put_light(parity_result *r, olx_vec3 irradiance, uint32_t probes) {
  put_u(r, probes);
  put_3(r, irradiance);
}

static void put_mixed(parity_result *r, const blend *b) {
  uint32_t probes = 0;
  const olx_vec3 light = mix(b, &probes);
  put_light(r, light, probes);
}

static blend some_blend(const parity_state *s) {
  blend b = {.count = 0};
  const olx_vec3 d = olx_v3(fabsf(s->direction.x), fabsf(s->direction.y), fabsf(s->direction.z));
  for (uint32_t i = 0; i <= s->bits[2] % 4u; i++) {
    const float share = i == 1 ? 1e-6f : s->random[i];
    const texel_light light = {olx_add(d, olx_splat((float)i)), share};
    add_light(&b, &light, s->random[(i + 1) % 4]);
  }
  return b;
}

static olx_vec3 step_from(const parity_state *s, const surface_state *e) {
  int32_t x, y;
  olx_border_source(e->first_x, e->first_y, (int32_t)s->field->n, &x, &y);
  const olx_vec3 centre = olx_texel_direction((uint32_t)x, (uint32_t)y, s->field->n);
  return olx_madd(e->view.offset, centre, -(1.0f + s->random[0]));
}

// clang-format off
#define SURFACE_ROW(name, ...)                                                                                         \
  static void row_##name(parity_state *s, parity_result *r) {                                                          \
    surface_state derived, *e = &derived;                                                                              \
    derive_surface(s, e);                                                                                              \
    __VA_ARGS__                                                                                                        \
  }

SURFACE_ROW(texel_indirect, put_3(r, olx_texel_indirect(s->field, s->probe, texel_of(s)));)
SURFACE_ROW(rank_weight, put_f(r, rank_weight(s->field, &s->settings, &e->p, s->probe));)
SURFACE_ROW(has_bricks, put_u(r, s->field->bricks.header != NULL);)
SURFACE_ROW(ranked_count, put_u(r, 8); put_u(r, s->field->info.probes.count);)
SURFACE_ROW(ranked_probe, put_u(r, near_probe(s, e, s->bits[2] % 8));
    put_u(r, s->bits[2] % s->field->info.probes.count);)
SURFACE_ROW(rank_next, put_ranking(s, e, r);)
SURFACE_ROW(view_from, put_3(r, e->view.offset); put_3(r, e->view.normal); put_f(r, e->view.angle);
    put_f(r, e->view.miss);
    const uint32_t side = s->constants->maps_a_side; const uint32_t map = s->probe % (side * side);
    put_u(r, map % side * s->field->stride + 1); put_u(r, map / side * s->field->stride + 1);
    put_u(r, s->probe / (side * side));)
SURFACE_ROW(see_texel, seen_texel t; const bool seen = see(s, e, e->first_x, e->first_y, &t); put_u(r, seen);
    if (seen) { put_f(r, t.distance); put_f(r, t.facing); put_3(r, t.normal); put_3(r, t.step); put_f(r, t.away); })
SURFACE_ROW(packing_error, seen_texel t; see(s, e, (int32_t)s->x, (int32_t)s->y, &t); put_f(r, packing_error(&t));)
SURFACE_ROW(texel_agrees, seen_texel t;
    put_f(r, see(s, e, e->first_x, e->first_y, &t) ? texel_agrees(&e->view, &t) : 0.0f);)
SURFACE_ROW(passes, seen_texel t; seen_texel o; see(s, e, (int32_t)s->x, (int32_t)s->y, &t);
    see(s, e, e->first_x, e->first_y, &o); put_f(r, passes(t.step, &o));)
SURFACE_ROW(texel_step, put_3(r, step_from(s, e));)
SURFACE_ROW(read_texels,
    const texel_light light = read_texels(s->field, s->settings.surface_tolerance, s->probe, &e->p);
    put_3(r, light.sum); put_f(r, light.share);)
SURFACE_ROW(blend_add, const blend b = some_blend(s); put_u(r, b.count); put_f(r, b.best);
    for (uint32_t i = 0; i < 4; i++) {
      const bool there = i < b.count;
      if (i < 2) put_3(r, there ? b.irradiance[i] : olx_splat(0.0f));
      put_f(r, there ? b.weight[i] : 0.0f);
    })
SURFACE_ROW(mix, const blend b = some_blend(s); put_mixed(r, &b);)
SURFACE_ROW(gather, blend b = {.count = 0}; const bool own = gather(s->field, &s->settings, &e->p, &b);
    put_u(r, b.count); put_f(r, b.best); put_u(r, b.count > 0 && own); if (b.count > 0) put_mixed(r, &b);)
SURFACE_ROW(map_irradiance_both, const float *v = s->random;
    const olx_bilinear a = olx_bilinear_at((olx_vec2){v[0], v[1]}, s->field->irradiance_n);
    const olx_bilinear b = olx_bilinear_at((olx_vec2){v[2], v[3]}, s->field->irradiance_n);
    put_3(r, map_irradiance(&s->source, s->irradiance_probe, &a));
    put_3(r, map_irradiance(&s->source, s->irradiance_probe, &b));)
SURFACE_ROW(irradiance_both, const olx_irradiance_weights w = olx_irradiance_weigh(&s->source, terms_of(&s->settings),
        s->settings.keep_buried, s->point, s->direction, s->view);
    put_3(r, weighted_irradiance(&s->source, &w, s->direction));
    put_3(r, weighted_irradiance(&s->source, &w, s->view));)
SURFACE_ROW(change, put_f(r, change(s->random[0], s->random[1])); put_f(r, change(0.0f, s->random[0]));
    put_f(r, change(0.0f, 0.0f));)
SURFACE_ROW(bend, const olx_vec3 d = s->direction; const float *v = s->random;
    put_3(r, bend(olx_v3(fabsf(d.x), fabsf(d.y), fabsf(d.z)),
                  (const olx_vec3[2]){{v[0], v[1], v[2]}, {v[1], v[2], v[3]}}, v[3]));)
SURFACE_ROW(has_volume, put_u(r, s->field->volume.header != NULL);)
SURFACE_ROW(volume_word, put_u(r, volume_word(s, s->bits[0] % 400u));)
SURFACE_ROW(fallen_back, const fallen f = fall_back(s); put_3(r, f.from); put_3(r, f.to);)
SURFACE_ROW(stored_light, olx_surface_light light = {.probes = 0};
    put_u(r, s->bits[2] & 1u ? stored_light(s->field, &s->settings, &e->p, &light) : false);
    put_light(r, light.irradiance, light.probes);)
SURFACE_ROW(complete_light, const olx_vec3 d = s->direction;
    olx_surface_light light = {{fabsf(d.x), fabsf(d.y), fabsf(d.z)}, 2};
    complete_light(s->field, &s->settings, &e->p, (s->bits[2] & 2u) != 0, &light);
    put_light(r, light.irradiance, light.probes);)
SURFACE_ROW(surface_light_from, olx_surface_light light = {.probes = 0}; blend b = {.count = 0};
    if (s->bits[2] & 1u) gather(s->field, &s->settings, &e->p, &b);
    if (b.count > 0) light = olx_surface_light_at(s->field, &s->settings, &e->p);
    const bool bent = (s->bits[3] & 0x10000u) != 0;
    // Without another source light is even over the hemisphere.
    const olx_vec3 none[2] = {{0}};
    if (b.count > 0 && bent) light.irradiance = bend(mix(&b, &(uint32_t){0}), none,
                                                     olx_dot(e->p.vertex_normal, e->p.shading_normal));
    put_u(r, light.probes); put_3(r, light.irradiance);)
SURFACE_ROW(volume_source, put_u(r, s->field->volume.header ? 2 : 4);)
SURFACE_ROW(volume_irradiance, put_3(r, olx_volume_irradiance(s->field, s->point, s->direction));)
SURFACE_ROW(surface_light_at, if (s->bits[3] & 0x40000u) s->settings.max_probes = 0;
    const olx_surface_light light = olx_surface_light_at(s->field, &s->settings, &e->p);
    put_light(r, light.irradiance, light.probes);)
SURFACE_ROW(surface_irradiance, put_3(r, olx_surface_irradiance(s->field, &s->settings, e->p.position,
        e->p.geometric_normal, e->p.shading_normal, s->view));)
SURFACE_ROW(replace, for (uint32_t i = 0; i < 4; i++) put_f(r, i == (s->bits[0] & 3u) ? 2.0f : s->random[i]);)
SURFACE_ROW(component, put_f(r, s->random[s->bits[0] & 3u]);)
SURFACE_ROW(positive, uint32_t bits = 0;
    for (uint32_t i = 0; i < 4; i++) bits |= (uint32_t)(s->random[i] > 0.5f) << i;
    put_u(r, bits);)
// clang-format on

static const parity_row ROWS[] = {
    PARITY(texel_indirect, 0, 0),
    PARITY(rank_weight, 1e-5f, 1e-3),
    PARITY(has_bricks, 0, 0),
    PARITY(ranked_count, 0, 0),
    PARITY(ranked_probe, 0, 1e-4),
    PARITY(rank_next, 1e-5f, 1e-3),
    PARITY(view_from, 1e-5f, 1e-3),
    PARITY(see_texel, 1e-5f, 1e-3),
    PARITY(packing_error, 1e-5f, 1e-3),
    PARITY(texel_agrees, 1e-3f, 1e-3),
    PARITY(passes, 1e-3f, 1e-3),
    PARITY(texel_step, 1e-5f, 1e-5),
    PARITY(read_texels, 1e-3f, 1e-3),
    PARITY(blend_add, 1e-5f, 0),
    PARITY(mix, 1e-5f, 1e-3),
    PARITY(gather, 1e-3f, 1e-3),
    PARITY(map_irradiance_both, 1e-4f, 1e-3),
    PARITY(irradiance_both, 1e-4f, 1e-3),
    PARITY(change, 1e-5f, 0),
    PARITY(bend, 1e-5f, 0),
    PARITY(has_volume, 0, 0),
    PARITY(volume_word, 0, 0),
    PARITY(fallen_back, 1e-4f, 1e-3),
    PARITY(stored_light, 1e-3f, 1e-3),
    PARITY(complete_light, 1e-3f, 1e-3),
    PARITY(surface_light_from, 1e-3f, 1e-3),
    PARITY(volume_source, 0, 0),
    PARITY(volume_irradiance, 1e-4f, 1e-3),
    PARITY(surface_light_at, 1e-3f, 1e-3),
    PARITY(surface_irradiance, 1e-3f, 1e-3),
    PARITY(replace, 0, 0),
    PARITY(component, 0, 0),
    PARITY(positive, 0, 0),
};
static const parity_code CODES[] = {{ROWS_OF_SURFACE, {CODE, sizeof CODE}}};
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {ROWS_OF_CLASSIC, ROWS_OF_SURFACE},
    [PARITY_OPEN_COURT] = {ROWS_OF_CLASSIC, ROWS_OF_SURFACE},
    [PARITY_MANY_PROBES] = {ROWS_OF_CLASSIC, ROWS_OF_SURFACE},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
