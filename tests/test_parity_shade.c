// Compares irradiance, glossy light and the denoiser in shaders/lib with their C twins (tests/parity.h).
#include "render/denoise.c"
#include "shade/emission.h"
#include "shade/glossy.h"
#include "shade/irradiance.c"

#include "core/sampling.h"
#include "parity.h"

static const uint32_t SHADE_CODE[] = {
#include "parity_shade.spv.inc"
};
static const uint32_t DENOISE_CODE[] = {
#include "parity_denoise.spv.inc"
};

typedef struct shade_state {
  uint32_t terms;
  surface_point surface;
} shade_state;

static void derive_shade(const parity_state *s, shade_state *e) {
  e->terms = s->settings.visibility == OLX_VISIBILITY_NONE ? OLX_WEIGHT_TRILINEAR : OLX_WEIGHT_ALL;
  e->surface = (surface_point){s->point, s->direction, s->view};
}

typedef struct denoise_state {
  float depths[16 * 12];
  olx_guide guide;
  shown here, there;
  olx_incident light_here, light_there;
  uint32_t pixel_x, pixel_y;
} denoise_state;

static void derive_denoise(const parity_state *s, denoise_state *e) {
  olx_vec3 tangent, bitangent;
  olx_basis(s->direction, &tangent, &bitangent);
  const float depth = s->item->v[15];
  e->pixel_x = s->bits[1] % 16u;
  e->pixel_y = s->bits[2] % 12u;
  e->depths[e->pixel_x + 16u * e->pixel_y] = depth;
  e->guide = (olx_guide){.width = 16, .height = 12, .depth = e->depths};
  e->guide.camera = (olx_camera_frame){.eye = olx_scale(s->view, 2.0f),
                                       .forward = s->direction,
                                       .right = olx_scale(tangent, 0.5f + s->random[0]),
                                       .up = olx_scale(bitangent, 0.4f + s->random[1])};
  e->here = (shown){s->point, s->direction, depth, s->random[0], 0.01f};
  const olx_vec3 offset =
      olx_madd(olx_scale(tangent, 0.2f * s->random[2]), s->view, s->bits[3] & 1u ? 0.02f * s->random[3] : 0.0f);
  e->there = (shown){olx_add(s->point, offset), olx_normalize(olx_madd(s->direction, s->view, 0.5f * s->random[1])),
                     depth, s->random[0] + 0.2f * s->random[1] - 0.1f, 0.01f};
  const olx_vec3 v = s->view, d = s->direction;
  e->light_here = (olx_incident){olx_v3(fabsf(v.x), fabsf(v.y), fabsf(v.z)), s->random[0] - 0.1f};
  e->light_there = (olx_incident){olx_v3(3.0f * fabsf(d.x), 3.0f * fabsf(d.y), 3.0f * fabsf(d.z)), s->random[1] - 0.1f};
  if (s->bits[0] % 32u == 0) e->light_here.light.y = NAN;
  if (s->bits[0] % 32u == 1) e->light_there.light.z = INFINITY;
  if (s->bits[0] % 32u == 2) e->light_there.inverse_distance = INFINITY;
}

static olx_trace_hit some_hit(const parity_state *s) {
  return (olx_trace_hit){.status = (olx_trace_status)(s->bits[0] % 3u),
                         .distance_metres = s->bits[0] & 4u ? INFINITY : s->item->v[15],
                         .position = olx_madd(s->point, s->direction, s->item->v[15]),
                         .normal = s->view,
                         .footprint_metres = 2.0f * s->random[0]};
}

static olx_vec2 pixel_of(const denoise_state *e, float dx, float dy) {
  return (olx_vec2){(float)e->pixel_x + dx, (float)e->pixel_y + dy};
}
static olx_lobe lobe_of(const parity_state *s) { return s->bits[3] & 2u ? OLX_LOBE_GLOSSY : OLX_LOBE_DIFFUSE; }
static scales some_scales(const parity_state *s, const denoise_state *e) {
  return scales_of(e->light_here, 50.0f * s->random[2]);
}
static olx_vec3 from_irradiance_probe(const parity_state *s) {
  return olx_sub(s->point, olx_grid_position(&s->source.grid, s->irradiance_probe));
}
static void put_known(parity_result *r, known k) {
  put_3(r, k.incident.light);
  put_f(r, k.incident.inverse_distance);
  put_f(r, k.count);
}

// clang-format off
#define SHADE_ROW(name, ...)                                                                                           \
  static void row_##name(parity_state *s, parity_result *r) {                                                          \
    shade_state derived, *e = &derived;                                                                                \
    derive_shade(s, e);                                                                                                \
    __VA_ARGS__                                                                                                        \
  }

SHADE_ROW(map_irradiance, const olx_bilinear b = olx_bilinear_at(random_2(s), s->field->irradiance_n);
    put_3(r, map_irradiance(&s->source, s->irradiance_probe, &b));)
SHADE_ROW(map_moments, put_2(r, map_moments(&s->source, s->irradiance_probe, s->direction));)
SHADE_ROW(chebyshev, put_f(r, chebyshev(&s->source, s->irradiance_probe, from_irradiance_probe(s)));)
SHADE_ROW(visibility, put_f(r, visibility(&s->source, e->terms, s->irradiance_probe, from_irradiance_probe(s),
        &e->surface));)
SHADE_ROW(probe_weight, put_f(r, probe_weight(&s->source, e->terms, s->irradiance_probe, from_irradiance_probe(s),
        &e->surface));)
SHADE_ROW(irradiance_usable, put_u(r,
        s->settings.keep_buried || !(s->source.flags[s->irradiance_probe] & OLX_PROBE_BURIED));)
SHADE_ROW(nearest_visible, const olx_cage cage = olx_cage_at(&s->source.grid, s->point); uint32_t found = 0;
    const bool seen = nearest_visible(&s->source, e->terms, s->settings.keep_buried, &e->surface, &cage, &found);
    put_u(r, seen); put_u(r, seen ? found : 0);)
SHADE_ROW(add_from_afar, const olx_cage cage = olx_cage_at(&s->source.grid, s->point);
    olx_irradiance_weights w = {.count = 0};
    add_from_afar(&s->source, e->terms, s->settings.keep_buried, &e->surface, &cage, 1.0f, &w);
    const olx_bilinear b = olx_bilinear_at(olx_octahedral_encode(s->direction), s->field->irradiance_n);
    olx_vec3 sum = {0};
    for (uint32_t i = 0; i < w.count; i++) sum = olx_madd(sum, map_irradiance(&s->source, w.probe[i], &b), w.weight[i]);
    put_3(r, sum);)
SHADE_ROW(irradiance, put_3(r, olx_irradiance(s->field, &s->settings, s->point, s->direction, s->view));)
SHADE_ROW(glossy_draw, float weight; float half_cosine; olx_vec3 drawn;
    put_u(r, olx_glossy_draw(s->direction, s->view, s->random[2], random_2(s), &drawn, &weight, &half_cosine));
    put_f(r, weight); put_f(r, half_cosine); if (weight > 0.0f) put_3(r, drawn);)
SHADE_ROW(glossy, float weight; float half_cosine; olx_trace_hit hit;
    const olx_vec3 light = olx_glossy(s->field, &s->settings, s->point, s->direction, s->view, s->random[2],
                                      random_2(s), &weight, &half_cosine, &hit);
    put_3(r, light);
    put_f(r, weight); put_f(r, half_cosine); put_u(r, hit.status); put_u(r, hit.probe); put_f(r, hit.distance_metres);)
#define DENOISE_ROW(name, ...)                                                                                         \
  static void row_##name(parity_state *s, parity_result *r) {                                                          \
    denoise_state derived, *e = &derived;                                                                              \
    derive_denoise(s, e);                                                                                              \
    __VA_ARGS__                                                                                                        \
  }

DENOISE_ROW(finite, put_u(r, olx_finite(e->light_here.light)); put_u(r, olx_finite(e->light_there.light));)
DENOISE_ROW(lobe_is_dim, put_u(r, olx_lobe_is_dim(&s->bsdf, s->random[3], s->random[2]));)
DENOISE_ROW(dim_light, const olx_vec3 v = s->view; const olx_vec3 light = olx_v3(fabsf(v.x), fabsf(v.y), fabsf(v.z));
    put_3(r, olx_dim_light(&s->bsdf, s->random[3], light));)
DENOISE_ROW(emission_faces, const olx_trace_hit hit = some_hit(s); put_u(r, olx_emission_faces(&hit, s->point));)
DENOISE_ROW(light_found, olx_trace_hit hit = some_hit(s); hit.radiance = s->direction; hit.emission = s->view;
    put_3(r, olx_light_found(&s->settings, &hit, s->point));)
DENOISE_ROW(nearness, const olx_trace_hit hit = some_hit(s); put_f(r, olx_nearness(&hit));)
DENOISE_ROW(nothing_known, put_known(r, nothing_known);)
DENOISE_ROW(guide_position, put_3(r, olx_guide_position(&e->guide, e->pixel_x, e->pixel_y));)
DENOISE_ROW(guide_project, olx_vec2 at; const bool seen = olx_guide_project(&e->guide, s->point, &at); put_u(r, seen);
    put_2(r, seen ? at : (olx_vec2){0});)
DENOISE_ROW(pixel_angle, put_f(r, pixel_angle(&e->guide));)
DENOISE_ROW(plane_fit, put_f(r, plane_fit(olx_sub(e->there.position, e->here.position), e->here.normal,
        0.01f * e->here.depth));)
DENOISE_ROW(is_sample, put_u(r, is_sample(e->light_here)); put_u(r, is_sample(e->light_there));)
DENOISE_ROW(same_surface, put_u(r, same_surface(&e->here, &e->there));)
DENOISE_ROW(settle, put_f(r, settle((float)e->pixel_x + 0.04f * s->random[0] - 0.02f));)
DENOISE_ROW(stands_still, const olx_vec2 beside = pixel_of(e, 0.02f * s->random[0], 0.02f * s->random[1]);
    put_u(r, stands_still(beside, pixel_of(e, 0, 0)));)
DENOISE_ROW(bilinear_weight, put_f(r, bilinear_weight(pixel_of(e, s->random[0], s->random[1]), s->bits[0] & 3u));)
DENOISE_ROW(mix_sample, const known past = {e->light_here, 60.0f * s->random[2]};
    put_known(r, mix_sample(past, e->light_there, s->bits[3] & 1u ? 0.98f : 0.0f));)
DENOISE_ROW(scales_of, const scales k = some_scales(s, e); put_f(r, k.inverse_distance); put_f(r, k.narrowing);
    put_u(r, k.known);)
DENOISE_ROW(gaussian, put_f(r, gaussian(9.0f * s->random[0]));)
DENOISE_ROW(reach_weight, put_f(r, reach_weight(lobe_of(s), 0.1f + s->random[1], &e->here, s->random[2], s->random[3],
                                        (float)(s->bits[1] % 12u)));)
DENOISE_ROW(tap_weight, const olx_lobe_filter filter = {.radius_pixels = 12,
        .reach = s->bits[3] & 4u ? 0.0f : 2.5f * s->random[2]};
    put_f(r, tap_weight(&filter, lobe_of(s), &e->here, some_scales(s, e), &e->there, e->light_there.inverse_distance,
                        (float)(s->bits[1] % 12u)));)
// clang-format on

static const parity_row ROWS[] = {
    PARITY(map_irradiance, 1e-4f, 1e-3),
    PARITY(map_moments, 1e-4f, 1e-3),
    PARITY(chebyshev, 1e-4f, 1e-3),
    PARITY(visibility, 1e-4f, 1e-3),
    PARITY(probe_weight, 1e-4f, 1e-3),
    PARITY(irradiance_usable, 1e-4f, 1e-3),
    PARITY(nearest_visible, 1e-4f, 1e-3),
    PARITY(add_from_afar, 1e-4f, 1e-3),
    PARITY(irradiance, 1e-4f, 1e-3),
    PARITY(glossy_draw, 1e-4f, 1e-3),
    PARITY(glossy, 1e-4f, 1e-3),
    PARITY(finite, 1e-5f, 0),
    PARITY(lobe_is_dim, 1e-5f, 1e-3),
    PARITY(dim_light, 1e-5f, 0),
    PARITY(emission_faces, 1e-5f, 1e-3),
    PARITY(light_found, 1e-5f, 1e-3),
    PARITY(nearness, 1e-5f, 0),
    PARITY(nothing_known, 1e-5f, 0),
    PARITY(guide_position, 1e-5f, 0),
    PARITY(guide_project, 1e-5f, 1e-3),
    PARITY(pixel_angle, 1e-5f, 0),
    PARITY(plane_fit, 1e-5f, 0),
    PARITY(is_sample, 1e-5f, 0),
    PARITY(same_surface, 1e-5f, 1e-3),
    PARITY(settle, 1e-5f, 1e-3),
    PARITY(stands_still, 1e-5f, 1e-3),
    PARITY(bilinear_weight, 1e-5f, 1e-3),
    PARITY(mix_sample, 1e-5f, 0),
    PARITY(scales_of, 1e-5f, 0),
    PARITY(gaussian, 1e-5f, 0),
    PARITY(reach_weight, 1e-5f, 0),
    PARITY(tap_weight, 1e-5f, 0),
};
static const parity_code CODES[] = {
    {ROWS_OF_SHADE, {SHADE_CODE, sizeof SHADE_CODE}},
    {ROWS_OF_DENOISE, {DENOISE_CODE, sizeof DENOISE_CODE}},
};
// llvmpipe ends loops after 65535 iterations, which the search of glossy light over many probes can exceed.
static const parity_range ROOMS[PARITY_ROOMS] = {
    [PARITY_FURNISHED_ROOM] = {ROWS_OF_SEARCH, ROWS_OF_DENOISE},
    [PARITY_OPEN_COURT] = {ROWS_OF_SEARCH, ROWS_OF_SHADE},
    [PARITY_MANY_PROBES] = {ROWS_OF_SEARCH, ROW_olx_glossy},
};

int main(void) { return parity_run(&(parity_suite){ROWS, PARITY_COUNT(ROWS), CODES, PARITY_COUNT(CODES), ROOMS}); }
