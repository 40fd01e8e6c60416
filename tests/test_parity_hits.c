// Compares light at the end of a ray in shaders/lib with its C twin (tests/parity.h), on materials of all kinds, marked
// and unmarked texels, and lights of every type.
#include "shade/further.c"
#include "trace/texel_shade.c"

#include "core/sampling.h"
#include "parity.h"

static const uint32_t CODE[] = {
#include "parity_hits.spv.inc"
};

static olx_vec3 absolute(olx_vec3 v) { return olx_v3(fabsf(v.x), fabsf(v.y), fabsf(v.z)); }

static texel_surface some_surface(const parity_state *s) {
  return (texel_surface){.bsdf = olx_texel_material(s->field, s->probe, texel_of(s)),
                         .position = s->point,
                         .normal = s->direction,
                         .view = s->view,
                         .cosine = olx_max(fabsf(olx_dot(s->direction, s->view)), 1e-3f),
                         .direct = absolute(s->view)};
}

static olx_field_light some_light(const parity_state *s) {
  const uint32_t count = s->field->surfaces.light_count;
  if (count > 0) return s->field->surfaces.lights[s->bits[1] % count];
  return (olx_field_light){.type = s->bits[0] % 3u,
                           .position = s->view,
                           .direction = s->direction,
                           .emission = absolute(s->view),
                           .cosine_inner = 0.5f + 0.4f * s->random[0],
                           .cosine_outer = 0.4f * s->random[1]};
}

// The place of a texel of indirect light in an image; all bits for a tile of sky.
typedef struct surface_place {
  uint32_t x, y, layer;
} surface_place;

static surface_place place_of_surface(const parity_state *s) {
  const uint32_t side = s->constants->maps_a_side, map = s->probe % (side * side), stride = s->field->stride;
  if (!s->constants->tiled) {
    return (surface_place){map % side * stride + 1 + s->x, map / side * stride + 1 + s->y, s->probe / (side * side)};
  }
  const olx_texel_block at = olx_tiled_texel(s->field, OLX_SURFACE_INDIRECT, s->probe, texel_of(s));
  const uint32_t block = (uint32_t)at.block, row = 1u << OLX_POOL_ROW_BITS;
  if (block == OLX_NO_BLOCK) return (surface_place){UINT32_MAX, UINT32_MAX, UINT32_MAX};
  return (surface_place){block % row * 4 + at.texel % 4, block / row % row * 4 + at.texel / 4, block / row / row};
}

static olx_trace_hit some_hit(const parity_state *s, olx_trace_status status) {
  const olx_vec3 d = s->direction, lobe = s->bits[3] & 0x70000u ? absolute(s->view) : olx_splat(0.0f);
  return (olx_trace_hit){.status = status,
                         .distance_metres = s->item->v[15],
                         .position = s->point,
                         .normal = d,
                         .lobe = lobe,
                         .radiance = olx_add(absolute(d), lobe),
                         .emission = absolute(olx_v3(d.y, d.z, d.x)),
                         .probe = s->bits[3] & 0x80000u || status == OLX_TRACE_HIT ? s->probe : UINT32_MAX,
                         .texel = (uint32_t)texel_of(s),
                         .footprint_metres = 0.1f * s->random[3]};
}

// clang-format off
ROW(rgb9e5_unpack, put_3(r, olx_rgb9e5_unpack(s->bits[3]));)
ROW(texel_material, const olx_bsdf b = olx_texel_material(s->field, s->probe, texel_of(s)); put_3(r, b.albedo);
    put_3(r, b.f0); put_f(r, b.f90); put_f(r, b.dielectric_weight); put_f(r, b.alpha);)
ROW(surface_at, const surface_place at = place_of_surface(s); put_u(r, at.x); put_u(r, at.y); put_u(r, at.layer);)
ROW(texel_direct, put_3(r, olx_texel_direct(s->field, s->probe, texel_of(s)));)
ROW(texel_emission, put_3(r, olx_texel_emission(s->field, s->probe, texel_of(s)));)
ROW(word_vector, const olx_field_surfaces *f = &s->field->surfaces;
    put_3(r, f->light_count ? f->lights[0].emission : olx_splat(0.0f));)
ROW(field_light_at, const olx_field_light l = some_light(s); put_u(r, l.type); put_3(r, l.position);
    put_3(r, l.direction); put_3(r, l.emission); put_f(r, l.cosine_inner); put_f(r, l.cosine_outer);)
ROW(field_light_cone, const olx_field_light l = some_light(s);
    put_f(r, olx_field_light_cone(&l, 2.0f * s->random[2] - 1.0f));)
ROW(field_light_arrival, const olx_field_light l = some_light(s);
    const olx_light_arrival a = olx_field_light_arrival(&l, s->point); put_3(r, a.direction); put_3(r, a.irradiance);)
ROW(highlight, const texel_surface t = some_surface(s); put_3(r, highlight(&t, s->view, s->random[0]));)
ROW(light_of_lamps, const texel_surface t = some_surface(s);
    const possible_light lamps = light_of_lamps(s->field, &t); put_3(r, lamps.irradiance); put_3(r, lamps.specular);)
ROW(share_within, put_f(r, share_within(absolute(s->direction), olx_v3(s->random[0], 0.0f, s->random[1])));)
ROW(likely_share, put_f(r, likely_share(s->random[0]));)
ROW(texel_shade,
    const olx_texel_light light = olx_texel_shade(s->field, s->probe, texel_of(s), s->point, s->direction,
                                                  s->bits[0] % 3u == 0u);
    put_3(r, light.reflected); put_3(r, light.lobe);)
ROW(further_draw, const olx_trace_hit hit = some_hit(s, OLX_TRACE_HIT); olx_further_ray ray;
    const bool drawn = olx_further_draw(s->field, &hit, olx_negate(s->view), random_2(s), &ray); put_u(r, drawn);
    if (drawn) { put_3(r, ray.origin); put_3(r, ray.direction); put_3(r, ray.weight); })
ROW(further_light, const olx_trace_hit first = some_hit(s, OLX_TRACE_HIT);
    const olx_trace_hit found = some_hit(s, (olx_trace_status)(s->bits[2] % 3u));
    const olx_further_ray ray = {olx_madd(s->point, s->direction, 0.5f - s->random[0]), s->view,
                                 olx_v3(s->random[0], s->random[1], s->random[2])};
    put_3(r, olx_further_light(&first, &ray, &found));)

static const parity_row ROWS[] = {
    PARITY(rgb9e5_unpack, 0, 0),
    PARITY(texel_material, 2e-6f, 0),
    PARITY(surface_at, 0, 0),
    PARITY(texel_direct, 0, 0),
    PARITY(texel_emission, 0, 0),
    PARITY(word_vector, 0, 0),
    PARITY(field_light_at, 0, 0),
    PARITY(field_light_cone, 1e-5f, 0),
    PARITY(field_light_arrival, 1e-5f, 0),
    PARITY(highlight, 1e-4f, 0),
    PARITY(light_of_lamps, 1e-4f, 1e-3),
    PARITY(share_within, 1e-5f, 0),
    PARITY(likely_share, 1e-6f, 0),
    PARITY(texel_shade, 1e-4f, 1e-3),
    PARITY(further_draw, 1e-4f, 1e-3),
    PARITY(further_light, 1e-5f, 1e-3),
};
// clang-format on
static const parity_code CODES[] = {{ROWS_OF_HITS, {CODE, sizeof CODE}}};
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {ROWS_OF_SURFACE, ROWS_OF_HITS},
    [PARITY_OPEN_COURT] = {ROWS_OF_SURFACE, ROWS_OF_HITS},
    [PARITY_MANY_PROBES] = {ROWS_OF_SURFACE, ROWS_OF_HITS},
    [PARITY_ROOM_OF_BLOCKS] = {ROWS_OF_SURFACE, ROWS_OF_HITS},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
