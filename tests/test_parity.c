// Shaders against their specification: every function of shaders/lib and its C twin on the same random and edge inputs, on
// whatever Vulkan device there is (a CPU one will do). The C files are included so that their inner functions can be called.
#include "render/denoise.c"
#include "shade/emission.h"
#include "shade/irradiance.c"
#include "trace/march_hiz.c"
#include "trace/probe_trace.c"
#include "trace/surfel.c"
#include "trace/trace.c"

#include "select/voronoi.c"

#include "analytic_field.h"
#include "bake/voronoi_build.h"
#include "core/bsdf.h"
#include "core/sampling.h"
#include "parity_rows.h"
#include "pinned_drivers.h"
#include "vulkan/gpu_field.h"
#include "vulkan_device.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static const uint32_t SPIRV[] = {
#include "parity.spv.inc"
};

typedef struct parity_item {
  float v[16];
  uint32_t u[4];
} parity_item;

// What parity.comp derives from an item; the names are the same.
typedef struct state {
  const olx_field *field;
  const olx_gpu_field *constants;
  const parity_item *item;
  uint32_t index;
  olx_vec3 point, direction, view;
  float random[4];
  uint32_t bits[4];
  uint32_t probe, irradiance_probe, x, y;
  olx_sample_settings settings;
  olx_irradiance_source source;
  uint32_t terms;
  surface_point surface;
  olx_bsdf bsdf;
  olx_probe_ray ray;
  olx_march march;
  olx_vec3 planes;
  olx_piece piece;
  olx_cell cell;
  surfel surfel;
  search search;
  float depths[16 * 12];
  olx_guide guide;
  shown here, there;
  olx_incident light_here, light_there;
  uint32_t pixel_x, pixel_y;
} state;

// What C gives for an item. Words that are floats may differ a little.
typedef struct result {
  uint32_t word[PARITY_RESULTS];
  bool is_float[PARITY_RESULTS];
  uint32_t count;
} result;

static void put_u(result *r, uint32_t x) { r->word[r->count++] = x; }
static void put_i(result *r, int32_t x) { put_u(r, (uint32_t)x); }
static void put_f(result *r, float x) {
  r->is_float[r->count] = true;
  put_u(r, olx_float_bits(x));
}
static void put_2(result *r, olx_vec2 v) {
  put_f(r, v.x);
  put_f(r, v.y);
}
static void put_3(result *r, olx_vec3 v) {
  put_f(r, v.x);
  put_f(r, v.y);
  put_f(r, v.z);
}
static void put_axis(result *r, olx_image_axis a) {
  put_f(r, a.begin);
  put_f(r, a.travel);
  put_i(r, a.step);
  put_i(r, a.ahead);
  put_i(r, a.first);
}
static void put_answer(result *r, const olx_probe_answer *a) {
  put_u(r, a->status);
  put_u(r, (uint32_t)a->texel);
  put_u(r, a->steps);
  put_f(r, a->t);
  put_f(r, a->gap);
}
static void put_hit(result *r, const olx_trace_hit *hit) {
  put_u(r, hit->status);
  put_u(r, hit->probe);
  put_u(r, hit->emitter);
  put_u(r, hit->texel_steps);
  put_u(r, hit->probes_tried);
  put_f(r, hit->distance_metres);
  put_3(r, hit->position);
  put_3(r, hit->normal);
  put_3(r, hit->radiance);
  put_f(r, hit->footprint_metres);
}

static void derive(state *s) {
  const parity_item *item = s->item;
  s->point = olx_v3(item->v[0], item->v[1], item->v[2]);
  s->direction = olx_v3(item->v[3], item->v[4], item->v[5]);
  s->view = olx_v3(item->v[6], item->v[7], item->v[8]);
  memcpy(s->random, &item->v[9], sizeof s->random);
  memcpy(s->bits, item->u, sizeof s->bits);
  s->probe = s->bits[0] % s->field->info.probe_count;
  s->irradiance_probe = s->bits[0] % s->field->info.irradiance_probe_count;
  s->x = s->bits[1] % s->field->n;
  s->y = s->bits[2] % s->field->n;
  s->settings = olx_sample_settings_default();
  s->settings.tracer = (olx_tracer)((s->bits[3] >> 8) % 3u);
  s->settings.visibility = s->bits[3] & 6u ? OLX_VISIBILITY_CHEBYSHEV : OLX_VISIBILITY_NONE;
  s->settings.keep_buried = (s->bits[3] & 8u) != 0;
  s->settings.emitters = (s->bits[3] & 16u) != 0;
  const olx_select selects[] = {OLX_SELECT_EXHAUSTIVE, OLX_SELECT_CAGE, OLX_SELECT_BRICKS, OLX_SELECT_VORONOI,
                                OLX_SELECT_BEST};
  s->settings.select = selects[(s->bits[3] >> 5) % 5u];
  s->source = olx_irradiance_source_of(s->field);
  s->terms = s->settings.visibility == OLX_VISIBILITY_NONE ? OLX_WEIGHT_TRILINEAR : OLX_WEIGHT_ALL;
  s->surface = (surface_point){s->point, s->direction, s->view};
  const olx_vec3 color = olx_v3(fabsf(s->direction.x), fabsf(s->direction.y), fabsf(s->direction.z));
  s->bsdf = olx_bsdf_make(color, s->random[0], s->random[1], s->random[2]);
}

static void derive_march(state *s) {
  const olx_field *f = s->field;
  s->ray = (olx_probe_ray){.origin = olx_sub(s->point, f->probe_positions[s->probe]),
                           .direction = s->direction,
                           .t_min = s->bits[3] & 1u ? 0.0f : s->item->v[13],
                           .t_max = s->bits[3] & 2u ? INFINITY : s->item->v[14]};
  s->march = olx_begin_march(f, s->probe, &s->ray);
  const olx_vec3 o = s->ray.origin, d = s->ray.direction;
  s->planes = olx_v3(plane_at(o.x, d.x), plane_at(o.y, d.y), plane_at(o.z, d.z));
  s->piece = make_piece(&s->march, s->planes, s->ray.t_min, next_cut(s->planes, s->ray.t_min, s->ray.t_max));
  s->cell = (olx_cell){s->piece.u.first, s->piece.v.first, s->piece.t_begin};
  s->surfel = read_surfel(&s->march, (int32_t)s->x, (int32_t)s->y, s->item->v[15]);
}

static void derive_search(state *s) {
  s->search = (search){.field = s->field,
                       .settings = &s->settings,
                       .origin = s->point,
                       .direction = s->direction,
                       .t_max = olx_min(s->item->v[14], leave_bounds(s->field, s->point, s->direction)),
                       .limit = MAX_ATTEMPTS,
                       .fallback_probe = UINT32_MAX};
}

static void derive_denoise(state *s) {
  olx_vec3 tangent, bitangent;
  olx_basis(s->direction, &tangent, &bitangent);
  const float depth = s->item->v[15];
  s->pixel_x = s->bits[1] % 16u;
  s->pixel_y = s->bits[2] % 12u;
  s->depths[s->pixel_x + 16u * s->pixel_y] = depth;
  s->guide = (olx_guide){.width = 16, .height = 12, .depth = s->depths};
  s->guide.camera = (olx_camera_frame){.eye = olx_scale(s->view, 2.0f),
                                       .forward = s->direction,
                                       .right = olx_scale(tangent, 0.5f + s->random[0]),
                                       .up = olx_scale(bitangent, 0.4f + s->random[1])};
  s->here = (shown){s->point, s->direction, depth, s->random[0], 0.01f};
  const olx_vec3 offset = olx_madd(olx_scale(tangent, 0.2f * s->random[2]), s->view,
                                   s->bits[3] & 1u ? 0.02f * s->random[3] : 0.0f);
  s->there = (shown){olx_add(s->point, offset), olx_normalize(olx_madd(s->direction, s->view, 0.5f * s->random[1])), depth,
                     s->random[0] + 0.2f * s->random[1] - 0.1f, 0.01f};
  const olx_vec3 v = s->view, d = s->direction;
  s->light_here = (olx_incident){olx_v3(fabsf(v.x), fabsf(v.y), fabsf(v.z)), s->random[0] - 0.1f};
  s->light_there = (olx_incident){olx_v3(3.0f * fabsf(d.x), 3.0f * fabsf(d.y), 3.0f * fabsf(d.z)), s->random[1] - 0.1f};
  if (s->bits[0] % 32u == 0) s->light_here.light.y = NAN;
  if (s->bits[0] % 32u == 1) s->light_there.light.z = INFINITY;
  if (s->bits[0] % 32u == 2) s->light_there.inverse_distance = INFINITY;
}

static olx_trace_hit some_hit(const state *s) {
  return (olx_trace_hit){.status = (olx_trace_status)(s->bits[0] % 3u),
                         .distance_metres = s->bits[0] & 4u ? INFINITY : s->item->v[15],
                         .position = olx_madd(s->point, s->direction, s->item->v[15]),
                         .normal = s->view,
                         .footprint_metres = 2.0f * s->random[0]};
}

static olx_vec2 pixel_of(const state *s, float dx, float dy) {
  return (olx_vec2){(float)s->pixel_x + dx, (float)s->pixel_y + dy};
}
static olx_lobe lobe_of(const state *s) { return s->bits[3] & 2u ? OLX_LOBE_GLOSSY : OLX_LOBE_DIFFUSE; }
static scales some_scales(const state *s) { return scales_of(s->light_here, 50.0f * s->random[2]); }
static void put_known(result *r, known k) {
  put_3(r, k.incident.light);
  put_f(r, k.incident.inverse_distance);
  put_f(r, k.count);
}

static olx_vec2 random_2(const state *s) { return (olx_vec2){s->random[0], s->random[1]}; }
static olx_vec3 local_view(const state *s) { return olx_v3(s->view.x, s->view.y, fabsf(s->view.z)); }
static size_t texel_of(const state *s) { return olx_map_index(s->field->stride, (int32_t)s->x, (int32_t)s->y); }
static olx_cell texel_cell(const state *s) { return (olx_cell){(int32_t)s->x, (int32_t)s->y, 0.0f}; }
static olx_vec3 from_irradiance_probe(const state *s) {
  return olx_sub(s->point, olx_grid_position(&s->source.grid, s->irradiance_probe));
}
static olx_vec2 ahead_of(const state *s) { return olx_crossings_ahead(&s->piece, s->cell.x, s->cell.y, 0); }
static float cell_exit(const state *s) {
  return olx_parameter_at(&s->piece, olx_min(ahead_of(s).x, ahead_of(s).y));
}
static float cell_far_squared(const state *s) { return olx_farthest_squared(&s->march, s->cell.t, cell_exit(s)); }
static stand first_node(const state *s) {
  return (stand){.x = s->cell.x >> OLX_PYRAMID_FINEST, .y = s->cell.y >> OLX_PYRAMID_FINEST, .s = -1.0f, .t = s->cell.t};
}

static bool has_voronoi(const state *s) { return olx_select_available(s->field, OLX_SELECT_VORONOI); }
static uint32_t tree_of(const state *s) { return has_voronoi(s) ? (uint32_t)olx_voronoi_tree(s->field) : 0; }
static nearest nearest_of(const state *s, uint32_t one) {
  nearest n = {.field = s->field,
               .point = s->point,
               .buried = s->settings.keep_buried,
               .probe = OLX_NO_PROBE,
               .distance = INFINITY};
  consider(&n, one % s->field->info.probe_count);
  return n;
}
static void put_nearest(result *r, const nearest *n) {
  put_u(r, n->probe);
  put_f(r, n->distance);
}

// clang-format off
#define ROW(name, ...) static void row_##name(state *s, result *r) { (void)s; __VA_ARGS__ }

ROW(square, put_f(r, olx_square(s->point.x));)
ROW(sign_not_zero, put_f(r, olx_sign_not_zero(s->direction.x));)
ROW(dot, put_f(r, olx_dot(s->point, s->direction));)
ROW(normalize, put_3(r, olx_normalize(s->bits[3] % 64 == 0 ? olx_splat(0.0f) : s->point));)
ROW(basis, olx_vec3 t, b; olx_basis(s->direction, &t, &b); put_3(r, t); put_3(r, b);)
ROW(from_basis, put_3(r, olx_from_basis(s->view, s->direction));)
ROW(octahedral_encode, put_2(r, olx_octahedral_encode(s->direction));)
ROW(octahedral_point, put_3(r, olx_octahedral_point(random_2(s)));)
ROW(octahedral_decode, put_3(r, olx_octahedral_decode(random_2(s)));)
ROW(texel_solid_angle_near, put_f(r, olx_texel_solid_angle_near(random_2(s), 64));)
ROW(half_unpack, put_f(r, olx_half_unpack((uint16_t)(s->index * 8 + (s->bits[0] & 7u))));)
ROW(normal_unpack, put_3(r, olx_normal_unpack((uint16_t)(s->bits[0] % 255u | s->bits[1] % 255u << 8)));)
ROW(hash, put_u(r, olx_hash(s->bits[0]));)
ROW(hash2, put_u(r, olx_hash2(s->bits[0], s->bits[1]));)
ROW(unit_float, put_f(r, olx_unit_float(s->bits[0]));)
ROW(owen_scramble, put_u(r, olx_owen_scramble(s->bits[0], s->bits[1]));)
ROW(sobol2, put_u(r, olx_sobol2(s->bits[0]));)
ROW(stratified2, put_2(r, olx_stratified2(s->bits[0], s->bits[1]));)
ROW(sample_cosine, put_3(r, olx_sample_cosine(random_2(s)));)
ROW(bsdf_make, put_3(r, s->bsdf.albedo); put_3(r, s->bsdf.f0); put_f(r, s->bsdf.f90); put_f(r, s->bsdf.dielectric_weight);
    put_f(r, s->bsdf.alpha);)
ROW(pow5, put_f(r, olx_pow5(s->random[0]));)
ROW(fresnel, put_3(r, olx_fresnel(&s->bsdf, s->random[3]));)
ROW(bsdf_diffuse, put_3(r, olx_bsdf_diffuse(&s->bsdf, s->random[3]));)
ROW(bsdf_has_specular, const olx_bsdf b = olx_bsdf_make(s->point, 0.0f, 0.5f, (float)(s->bits[0] & 1u));
    put_u(r, olx_bsdf_has_specular(&b));)
ROW(ggx_lambda, put_f(r, olx_ggx_lambda(s->random[0], s->random[1]));)
ROW(ggx_sample_half, put_3(r, olx_ggx_sample_half(s->random[2], local_view(s), random_2(s)));)
ROW(ggx_sample, float weight; float half_cosine; const olx_vec2 random = {s->random[2], s->random[3]};
    put_3(r, olx_ggx_sample(s->bsdf.alpha, local_view(s), random, &weight, &half_cosine)); put_f(r, weight);
    put_f(r, half_cosine);)

ROW(probe_position, put_3(r, s->field->probe_positions[s->probe]);)
ROW(irradiance_probe_position, put_3(r, olx_grid_position(&s->source.grid, s->irradiance_probe));)
ROW(map_corner, put_u(r, s->probe % 9 % 3 * s->field->n); put_u(r, s->probe % 9 / 3 * s->field->n); put_u(r, s->probe / 9);)
ROW(map_origin, const uint32_t side = s->constants->maps_a_side;
    put_u(r, s->probe % side * s->field->stride + 1); put_u(r, s->probe / side % side * s->field->stride + 1);
    put_u(r, s->probe / side / side);)
ROW(texel_towards, put_u(r, (uint32_t)olx_texel_towards(s->field, s->direction));)
ROW(texel_distance_bits, put_u(r, s->field->distance[s->field->texels * s->probe + texel_of(s)]);)
ROW(texel_distance, put_f(r, olx_texel_distance(s->field, s->probe, texel_of(s)));)
ROW(texel_emits, put_u(r, olx_texel_emits(s->field, s->probe, texel_of(s)));)
ROW(texel_normal, put_3(r, olx_texel_normal(s->field, s->probe, texel_of(s)));)
ROW(texel_radiance, put_3(r, olx_texel_radiance(s->field, s->probe, texel_of(s)));)
ROW(irradiance_coordinate, const uint32_t side = s->constants->irradiance_maps_a_side;
    const float n = (float)s->field->irradiance_n; const float stride = n + 2.0f; const uint32_t p = s->irradiance_probe;
    put_f(r, ((float)(p % side) * stride + 1.0f + s->random[0] * n) / ((float)side * stride));
    put_f(r, ((float)(p / side % side) * stride + 1.0f + s->random[1] * n) / ((float)side * stride));
    put_f(r, (float)(p / side / side));)
ROW(cage_at, const olx_cage cage = olx_cage_at(&s->source.grid, s->point); put_u(r, cage.base[0]); put_u(r, cage.base[1]);
    put_u(r, cage.base[2]); put_u(r, cage.corner_mask); put_f(r, cage.alpha[0]); put_f(r, cage.alpha[1]);
    put_f(r, cage.alpha[2]);)
ROW(cage_has, const olx_cage cage = olx_cage_at(&s->source.grid, s->point); put_u(r, olx_cage_has(&cage, s->bits[0] & 7u));)
ROW(cage_probe, const olx_cage cage = olx_cage_at(&s->source.grid, s->point);
    put_u(r, olx_cage_probe(&s->source.grid, &cage, s->bits[0] & cage.corner_mask));)
ROW(cage_weight, const olx_cage cage = olx_cage_at(&s->source.grid, s->point);
    put_f(r, olx_cage_weight(&cage, s->bits[0] & 7u));)
ROW(select_available, put_u(r, olx_select_available(s->field, (olx_select)(s->bits[0] % 5u)));)
ROW(select_resolve, put_u(r, olx_select_resolve(s->field, (olx_select)(s->bits[0] % 6u)));)
ROW(sample_settings_default, const olx_sample_settings d = olx_sample_settings_default(); put_u(r, d.tracer);
    put_u(r, d.select); put_u(r, d.visibility); put_u(r, d.max_probes); put_u(r, d.keep_buried); put_u(r, d.emitters);)

ROW(probe_code_bytes, put_u(r, olx_probe_code_bytes(s->bits[0] % 512u));)
ROW(probe_code, const uint32_t count = s->field->info.probe_count;
    put_u(r, has_voronoi(s) ? olx_probe_code(olx_voronoi_codes(s->field), olx_probe_code_bytes(count),
                                             s->bits[0] % (tree_of(s) + count)) : 0);)
ROW(voronoi_tree, put_u(r, tree_of(s));)
ROW(middle, const uint32_t begin = s->bits[0] & 0xFFu; put_u(r, olx_middle(begin, begin + (s->bits[1] & 0xFFFFu)));)
ROW(consider, nearest n = nearest_of(s, s->bits[1]); consider(&n, s->probe); put_nearest(r, &n);)
ROW(search_tree, nearest n = nearest_of(s, s->bits[1]); if (has_voronoi(s)) { search_tree(&n); put_nearest(r, &n); })
ROW(voronoi_nearest, put_u(r, has_voronoi(s) ? olx_voronoi_nearest(s->field, s->point, s->settings.keep_buried) : 0);)
ROW(choice_texel, put_u(r, choice_texel(1.2f * s->random[0] - 0.1f, 4u << (s->bits[0] & 3u)));)
ROW(voronoi_neighbours, uint32_t choices[OLX_CHOICES] = {0};
    if (has_voronoi(s)) olx_voronoi_neighbours(s->field, s->probe, olx_scale(s->direction, s->item->v[15]), choices);
    for (uint32_t i = 0; i < OLX_CHOICES; i++) put_u(r, choices[i]);)

ROW(radius_squared, put_f(r, olx_radius_squared(&s->march, s->random[0]));)
ROW(farthest_squared, put_f(r, olx_farthest_squared(&s->march, s->random[0], s->random[0] + s->random[1]));)
ROW(reach_squared, put_f(r, olx_reach_squared(&s->march, &s->piece, s->random[0], s->random[0] + s->random[1]));)
ROW(nearest_squared, put_f(r, olx_nearest_squared(&s->march, s->random[0], s->random[0] + s->random[1]));)
ROW(clamp_texel, put_i(r, olx_clamp_texel(s->view.x, s->point.x * 8.0f, s->field->n));)
ROW(image_at, olx_vec2 image = {0}; put_u(r, olx_image_at(&s->march, &s->piece, s->ray.t_min, &image)); put_2(r, image);)
ROW(parameter_at, put_f(r, olx_parameter_at(&s->piece, s->random[0]));)
ROW(crossing, put_f(r, olx_crossing(&s->piece.u, (int32_t)s->x));)
ROW(texel_at, put_i(r, olx_texel_at(&s->piece.u, s->random[0], (s->bits[3] & 4u) != 0));)
ROW(pyramid_shift, put_u(r, olx_pyramid_shift(s->bits[0] & 3u));)
ROW(pyramid_index, const uint32_t side = 2u << (s->bits[0] & 7u);
    put_u(r, olx_pyramid_index(side, s->bits[1] % side, s->bits[2] % side));)
ROW(least_squared, put_f(r, olx_least_squared(&s->march, 0, (int32_t)s->x >> OLX_PYRAMID_FINEST,
                                              (int32_t)s->y >> OLX_PYRAMID_FINEST)); put_u(r, s->march.steps);)
ROW(read_surfel, put_f(r, s->surfel.distance); put_f(r, s->surfel.footprint); put_f(r, s->surfel.slack);
    put_f(r, s->surfel.cosine); put_f(r, s->surfel.f0); put_f(r, s->surfel.f1);)
ROW(plane_tolerance, put_f(r, plane_tolerance(&s->surfel));)
ROW(beyond_reach, put_u(r, beyond_reach(&s->march, texel_cell(s), &s->surfel, 4.0f * s->random[0])); put_u(r, s->march.steps);)
ROW(supported, put_u(r, supported(&s->march, &s->piece, s->cell, &s->surfel, s->ray.t_min + 0.1f * s->random[0]));
    put_u(r, s->march.steps);)
ROW(judge_height, olx_probe_answer a = {0};
    put_u(r, judge_height(&s->march, &s->piece, s->cell, cell_exit(s), &s->surfel, &a)); put_f(r, a.t);)
ROW(judge_surfel, olx_probe_answer a = {0};
    put_u(r, olx_judge_surfel(&s->march, &s->piece, s->cell, cell_exit(s), s->item->v[15], &a)); put_answer(r, &a);)
ROW(visit_texel, olx_probe_answer a = {0};
    put_u(r, olx_visit_texel(&s->march, &s->piece, s->cell, cell_exit(s), cell_far_squared(s), &a)); put_answer(r, &a);
    put_u(r, s->march.steps);)
ROW(next_cell, const olx_cell c = olx_next_cell(&s->piece, s->cell, random_2(s), cell_exit(s)); put_i(r, c.x); put_i(r, c.y);
    put_f(r, c.t);)
ROW(crossings_ahead, put_2(r, olx_crossings_ahead(&s->piece, s->cell.x >> 2, s->cell.y >> 2, 2));)
ROW(march_texels, olx_probe_answer a = {0}; put_u(r, olx_march_texels(&s->march, &s->piece, &a)); put_answer(r, &a);)
ROW(march_two_level, olx_probe_answer a = {0}; put_u(r, olx_march_two_level(&s->march, &s->piece, &a)); put_answer(r, &a);
    put_u(r, s->march.steps);)
ROW(leave, stand at = first_node(s); const int32_t x = at.x + (int32_t)(s->bits[0] % 5u) - 2;
    const int32_t y = at.y + (int32_t)(s->bits[1] % 5u) - 2; leave(&s->march, &at, x, y, s->random[0], cell_exit(s), true);
    put_i(r, at.x); put_i(r, at.y); put_u(r, at.level);)
ROW(march_node, olx_probe_answer a = {0}; stand at = first_node(s);
    put_u(r, march_node(&s->march, &s->piece, &at, 0.04f, &a)); put_answer(r, &a); put_i(r, at.x); put_i(r, at.y);)
ROW(visit_first, olx_probe_answer a = {0}; put_u(r, olx_visit_first(&s->march, &s->piece, &a)); put_answer(r, &a);)
ROW(march_hiz, olx_probe_answer a = {0}; put_u(r, olx_march_hiz(&s->march, &s->piece, &a)); put_answer(r, &a);
    put_u(r, s->march.steps);)
ROW(march_piece, olx_probe_answer a = {0}; put_u(r, march_piece(&s->march, &s->piece, s->settings.tracer, &a));
    put_answer(r, &a);)
ROW(end_at, const piece_end end = end_at(&s->march, &s->piece, s->ray.t_min + 0.3f * s->random[0]); put_f(r, end.u);
    put_f(r, end.v); put_f(r, end.inverse); put_u(r, end.centre);)
ROW(make_axis, put_axis(r, make_axis(s->point.x * 8.0f, s->point.y * 8.0f, s->view.x, s->field->n));)
ROW(plane_at, put_f(r, plane_at(s->point.x, s->direction.x));)
ROW(sign_after, put_f(r, sign_after(s->ray.origin.x, s->ray.direction.x, s->planes.x, s->random[0]));)
ROW(make_piece, put_axis(r, s->piece.u); put_axis(r, s->piece.v); put_f(r, s->piece.near); put_f(r, s->piece.slope);
    put_f(r, s->piece.rise);)
ROW(next_cut, put_f(r, next_cut(s->planes, s->ray.t_min, s->ray.t_max));)
ROW(begin_march, put_f(r, s->march.closest); put_f(r, s->march.miss_squared);
    put_u(r, s->field->pyramid.least_nodes * s->probe);)
ROW(trace_probe, const olx_probe_answer a = olx_trace_probe(s->field, s->probe, &s->ray, s->settings.tracer);
    put_answer(r, &a);)

ROW(usable, put_u(r, usable(&s->search, s->probe));)
ROW(is_ray, put_u(r, is_ray(s->point, olx_scale(s->direction, 0.85f + 0.3f * s->random[0]), s->random[1] - 0.1f));)
ROW(was_asked, for (uint32_t i = 0; i < 4; i++) s->search.asked[s->search.attempts++] = s->bits[i] & 7u;
    put_u(r, was_asked(&s->search, s->bits[0] >> 8 & 7u));)
ROW(ray_point, put_3(r, ray_point(&s->search, s->random[0]));)
ROW(line_distance_squared, put_f(r, line_distance_squared(&s->search, s->probe));)
ROW(sees, put_u(r, sees(&s->search, s->probe));)
ROW(probe_sees, put_u(r, olx_probe_sees(s->field, s->probe, s->point, s->random[0], s->bits[0] & 1u ? &s->direction : NULL));)
ROW(ask, olx_probe_answer a = {0}; put_u(r, ask(&s->search, s->probe, &a)); put_u(r, s->search.attempts);
    put_f(r, s->search.t); put_f(r, s->search.lost); put_answer(r, &a);)
ROW(first_corner, const olx_grid *grid = &s->field->info.grid; const olx_cage cage = olx_cage_at(grid, s->point);
    put_u(r, first_corner(&s->search, grid, &cage));)
ROW(search_cages, olx_probe_answer a = {0}; uint32_t found = 0; put_u(r, search_cages(&s->search, &found, &a));
    put_u(r, s->search.attempts); put_f(r, s->search.t);)
ROW(bricks_list, const uint32_t *words = s->field->select_data[OLX_SELECT_BRICKS];
    put_u(r, words ? (uint32_t)(olx_bricks_list(&s->field->bricks, s->point) - words) : 0);)
ROW(bricks_probe, const bool some = s->field->bricks.header != NULL;
    put_u(r, some ? olx_bricks_probe(olx_bricks_list(&s->field->bricks, s->point), s->bits[0] & 7u) : 0);)
ROW(next_listed, uint32_t found = OLX_BRICK_NO_PROBE; const bool some = s->field->bricks.header != NULL;
    put_u(r, some && next_listed(&s->search, &found)); put_u(r, some ? found : 0);)
ROW(search_bricks, olx_probe_answer a = {0}; uint32_t found = 0;
    put_u(r, s->field->bricks.header && search_bricks(&s->search, &found, &a)); put_u(r, s->search.attempts);
    put_f(r, s->search.t);)
ROW(search_voronoi, olx_probe_answer a = {0}; uint32_t found = 0;
    put_u(r, has_voronoi(s) && search_voronoi(&s->search, &found, &a)); put_u(r, s->search.attempts); put_f(r, s->search.t);)
ROW(search_everywhere, olx_probe_answer a = {0}; uint32_t found = 0; put_u(r, search_everywhere(&s->search, &found, &a));
    put_u(r, s->search.attempts); put_f(r, s->search.t);)
ROW(search_selected, olx_probe_answer a = {0}; uint32_t found = 0; put_u(r, search_selected(&s->search, &found, &a));
    put_u(r, s->search.attempts); put_f(r, s->search.t);)
ROW(sky_radiance, put_3(r, sky_radiance(&s->search));)
ROW(describe, const olx_probe_answer a = {.status = (olx_trace_status)(s->bits[1] % 3u), .t = s->random[0], .texel = texel_of(s)};
    const olx_trace_hit hit = describe(&s->search, s->probe, &a, s->item->v[14]); put_hit(r, &hit);)
ROW(leave_bounds, put_f(r, leave_bounds(s->field, s->point, s->direction));)
ROW(trace, const olx_trace_hit hit = olx_trace(s->field, &s->settings, s->point, s->direction, s->item->v[14]);
    put_hit(r, &hit);)

ROW(map_irradiance, const olx_bilinear b = olx_bilinear_at(random_2(s), s->field->irradiance_n);
    put_3(r, map_irradiance(&s->source, s->irradiance_probe, &b));)
ROW(map_moments, put_2(r, map_moments(&s->source, s->irradiance_probe, s->direction));)
ROW(chebyshev, put_f(r, chebyshev(&s->source, s->irradiance_probe, from_irradiance_probe(s)));)
ROW(visibility, put_f(r, visibility(&s->source, s->terms, s->irradiance_probe, from_irradiance_probe(s), &s->surface));)
ROW(probe_weight, put_f(r, probe_weight(&s->source, s->terms, s->irradiance_probe, from_irradiance_probe(s), &s->surface));)
ROW(irradiance_usable, put_u(r, s->settings.keep_buried || !(s->source.flags[s->irradiance_probe] & OLX_PROBE_BURIED));)
ROW(nearest_visible, const olx_cage cage = olx_cage_at(&s->source.grid, s->point); uint32_t found = 0;
    const bool seen = nearest_visible(&s->source, s->terms, s->settings.keep_buried, &s->surface, &cage, &found);
    put_u(r, seen); put_u(r, seen ? found : 0);)
ROW(add_from_afar, const olx_cage cage = olx_cage_at(&s->source.grid, s->point); olx_irradiance_weights w = {.count = 0};
    add_from_afar(&s->source, s->terms, s->settings.keep_buried, &s->surface, &cage, 1.0f, &w);
    const olx_bilinear b = olx_bilinear_at(olx_octahedral_encode(s->direction), s->field->irradiance_n); olx_vec3 sum = {0};
    for (uint32_t i = 0; i < w.count; i++) sum = olx_madd(sum, map_irradiance(&s->source, w.probe[i], &b), w.weight[i]);
    put_3(r, sum);)
ROW(irradiance, put_3(r, olx_irradiance(s->field, &s->settings, s->point, s->direction, s->view));)
ROW(glossy, float weight; float half_cosine; olx_trace_hit hit;
    put_3(r, olx_glossy(s->field, &s->settings, s->point, s->direction, s->view, s->random[2], random_2(s), &weight,
                        &half_cosine, &hit));
    put_f(r, weight); put_f(r, half_cosine); put_u(r, hit.status); put_u(r, hit.probe); put_f(r, hit.distance_metres);)

ROW(finite, put_u(r, olx_finite(s->light_here.light)); put_u(r, olx_finite(s->light_there.light));)
ROW(lobe_is_dim, put_u(r, olx_lobe_is_dim(&s->bsdf, s->random[3], s->random[2]));)
ROW(dim_light, const olx_vec3 v = s->view; const olx_vec3 light = olx_v3(fabsf(v.x), fabsf(v.y), fabsf(v.z));
    put_3(r, olx_dim_light(&s->bsdf, s->random[3], light));)
ROW(emission_counts, const olx_trace_hit hit = some_hit(s); put_u(r, olx_emission_counts(&s->settings, &hit, s->point));)
ROW(nearness, const olx_trace_hit hit = some_hit(s); put_f(r, olx_nearness(&hit));)
ROW(nothing_known, put_known(r, nothing_known);)
ROW(guide_position, put_3(r, olx_guide_position(&s->guide, s->pixel_x, s->pixel_y));)
ROW(guide_project, olx_vec2 at; const bool seen = olx_guide_project(&s->guide, s->point, &at); put_u(r, seen);
    put_2(r, seen ? at : (olx_vec2){0});)
ROW(pixel_angle, put_f(r, pixel_angle(&s->guide));)
ROW(plane_fit, put_f(r, plane_fit(olx_sub(s->there.position, s->here.position), s->here.normal, 0.01f * s->here.depth));)
ROW(is_sample, put_u(r, is_sample(s->light_here)); put_u(r, is_sample(s->light_there));)
ROW(same_surface, put_u(r, same_surface(&s->here, &s->there));)
ROW(settle, put_f(r, settle((float)s->pixel_x + 0.04f * s->random[0] - 0.02f));)
ROW(stands_still, put_u(r, stands_still(pixel_of(s, 0.02f * s->random[0], 0.02f * s->random[1]), pixel_of(s, 0, 0)));)
ROW(bilinear_weight, put_f(r, bilinear_weight(pixel_of(s, s->random[0], s->random[1]), s->bits[0] & 3u));)
ROW(mix_sample, const known past = {s->light_here, 60.0f * s->random[2]};
    put_known(r, mix_sample(past, s->light_there, s->bits[3] & 1u ? 0.98f : 0.0f));)
ROW(scales_of, const scales k = some_scales(s); put_f(r, k.inverse_distance); put_f(r, k.narrowing);)
ROW(gaussian, put_f(r, gaussian(9.0f * s->random[0]));)
ROW(reach_weight, put_f(r, reach_weight(lobe_of(s), 0.1f + s->random[1], &s->here, s->random[2], s->random[3],
                                        (float)(s->bits[1] % 12u)));)
ROW(tap_weight, const olx_lobe_filter filter = {.radius_pixels = 12, .reach = s->bits[3] & 4u ? 0.0f : 2.5f * s->random[2]};
    put_f(r, tap_weight(&filter, lobe_of(s), &s->here, some_scales(s), &s->there, s->light_there.inverse_distance,
                        (float)(s->bits[1] % 12u)));)
// clang-format on

// One function: how much its floats may differ, relative to their size and at least 1, and the share of items that may give
// anything else. Devices round divisions and roots differently, so what hangs on a comparison is allowed one item in a
// thousand; a lobe's edge and a variance (a difference of squares) magnify rounding.
typedef struct parity_row {
  uint32_t number;
  const char *name;
  void (*evaluate)(state *s, result *r);
  float bound;
  double allowed;
} parity_row;

#define PARITY(name, bound, allowed) {ROW_olx_##name, #name, row_##name, bound, allowed}

static const parity_row ROWS[] = {
    PARITY(square, 2e-6f, 0),
    PARITY(sign_not_zero, 2e-6f, 0),
    PARITY(dot, 2e-6f, 0),
    PARITY(normalize, 2e-6f, 0),
    PARITY(basis, 2e-6f, 0),
    PARITY(from_basis, 2e-6f, 0),
    PARITY(octahedral_encode, 2e-6f, 0),
    PARITY(octahedral_point, 2e-6f, 0),
    PARITY(octahedral_decode, 2e-6f, 0),
    PARITY(texel_solid_angle_near, 2e-6f, 0),
    PARITY(half_unpack, 2e-6f, 0),
    PARITY(normal_unpack, 2e-6f, 0),
    PARITY(hash, 2e-6f, 0),
    PARITY(hash2, 2e-6f, 0),
    PARITY(unit_float, 2e-6f, 0),
    PARITY(owen_scramble, 2e-6f, 0),
    PARITY(sobol2, 2e-6f, 0),
    PARITY(stratified2, 2e-6f, 0),
    PARITY(sample_cosine, 2e-6f, 0),
    PARITY(bsdf_make, 2e-6f, 0),
    PARITY(pow5, 2e-6f, 0),
    PARITY(fresnel, 2e-6f, 0),
    PARITY(bsdf_diffuse, 2e-6f, 0),
    PARITY(bsdf_has_specular, 2e-6f, 0),
    PARITY(ggx_lambda, 2e-6f, 0),
    PARITY(ggx_sample_half, 1e-4f, 0),
    PARITY(ggx_sample, 1e-4f, 0),
    PARITY(probe_position, 1e-6f, 0),
    PARITY(irradiance_probe_position, 1e-6f, 0),
    PARITY(map_corner, 1e-6f, 0),
    PARITY(map_origin, 1e-6f, 0),
    PARITY(texel_towards, 1e-6f, 1e-3),
    PARITY(texel_distance_bits, 1e-6f, 0),
    PARITY(texel_distance, 1e-6f, 0),
    PARITY(texel_emits, 1e-6f, 0),
    PARITY(texel_normal, 1e-6f, 0),
    PARITY(texel_radiance, 1e-6f, 0),
    PARITY(irradiance_coordinate, 1e-6f, 0),
    PARITY(cage_at, 1e-6f, 0),
    PARITY(cage_has, 1e-6f, 0),
    PARITY(cage_probe, 1e-6f, 0),
    PARITY(cage_weight, 1e-6f, 0),
    PARITY(select_available, 1e-6f, 0),
    PARITY(select_resolve, 1e-6f, 0),
    PARITY(sample_settings_default, 1e-6f, 0),
    PARITY(probe_code_bytes, 1e-6f, 0),
    PARITY(probe_code, 1e-6f, 0),
    PARITY(voronoi_tree, 1e-6f, 0),
    PARITY(middle, 1e-6f, 0),
    PARITY(consider, 1e-6f, 0),
    PARITY(search_tree, 1e-6f, 0),
    PARITY(voronoi_nearest, 1e-6f, 0),
    PARITY(choice_texel, 1e-6f, 0),
    PARITY(voronoi_neighbours, 1e-6f, 1e-3),
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
    PARITY(visit_texel, 1e-5f, 1e-3),
    PARITY(next_cell, 1e-5f, 1e-3),
    PARITY(crossings_ahead, 1e-5f, 1e-3),
    PARITY(march_texels, 1e-5f, 1e-3),
    PARITY(march_two_level, 1e-5f, 1e-3),
    PARITY(leave, 1e-5f, 1e-3),
    PARITY(march_node, 1e-5f, 1e-3),
    PARITY(visit_first, 1e-5f, 1e-3),
    PARITY(march_hiz, 1e-5f, 1e-3),
    PARITY(march_piece, 1e-5f, 1e-3),
    PARITY(end_at, 1e-5f, 1e-3),
    PARITY(make_axis, 1e-5f, 1e-3),
    PARITY(plane_at, 1e-5f, 1e-3),
    PARITY(sign_after, 1e-5f, 1e-3),
    PARITY(make_piece, 1e-5f, 1e-3),
    PARITY(next_cut, 1e-5f, 1e-3),
    PARITY(begin_march, 1e-5f, 1e-3),
    PARITY(trace_probe, 1e-5f, 1e-3),
    PARITY(usable, 1e-5f, 1e-3),
    PARITY(is_ray, 1e-5f, 1e-3),
    PARITY(was_asked, 1e-5f, 1e-3),
    PARITY(ray_point, 1e-5f, 1e-3),
    PARITY(line_distance_squared, 1e-5f, 1e-3),
    PARITY(sees, 1e-5f, 1e-3),
    PARITY(ask, 1e-5f, 1e-3),
    PARITY(first_corner, 1e-5f, 1e-3),
    PARITY(search_cages, 1e-5f, 1e-3),
    PARITY(search_everywhere, 1e-5f, 1e-3),
    PARITY(search_selected, 1e-5f, 1e-3),
    PARITY(sky_radiance, 1e-5f, 1e-3),
    PARITY(describe, 1e-5f, 1e-3),
    PARITY(leave_bounds, 1e-5f, 1e-3),
    PARITY(trace, 1e-5f, 1e-3),
    PARITY(bricks_list, 1e-5f, 1e-3),
    PARITY(bricks_probe, 1e-5f, 1e-3),
    PARITY(next_listed, 1e-5f, 1e-3),
    PARITY(search_bricks, 1e-5f, 1e-3),
    PARITY(search_voronoi, 1e-5f, 1e-3),
    PARITY(probe_sees, 1e-5f, 1e-3),
    PARITY(map_irradiance, 1e-4f, 1e-3),
    PARITY(map_moments, 1e-4f, 1e-3),
    PARITY(chebyshev, 1e-4f, 1e-3),
    PARITY(visibility, 1e-4f, 1e-3),
    PARITY(probe_weight, 1e-4f, 1e-3),
    PARITY(irradiance_usable, 1e-4f, 1e-3),
    PARITY(nearest_visible, 1e-4f, 1e-3),
    PARITY(add_from_afar, 1e-4f, 1e-3),
    PARITY(irradiance, 1e-4f, 1e-3),
    PARITY(glossy, 1e-4f, 1e-3),
    PARITY(finite, 1e-5f, 0),
    PARITY(lobe_is_dim, 1e-5f, 1e-3),
    PARITY(dim_light, 1e-5f, 0),
    PARITY(emission_counts, 1e-5f, 1e-3),
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

enum { ROW_COUNT = sizeof ROWS / sizeof ROWS[0] };

// Rooms and grids that between them have every kind of texel, block and cage; the last has so many probes that maps share layers.
typedef struct parity_field {
  const char *name;
  analytic_scene scene;
  olx_grid grid;
  uint32_t n, irradiance_n;
  bool bricks, voronoi;
} parity_field;

static const analytic_box ROOM = {{0, 0, 0}, {4, 3, 5}};
#define FURNITURE {{{0.9f, 0.0f, 1.1f}, {1.7f, 1.3f, 2.1f}}, {{2.3f, 0.0f, 2.6f}, {3.1f, 2.1f, 3.3f}}}

// Bricks over the room with lists at random: what matters is that both sides read the same.
enum { BRICKS = 12, DIVIDED = 6, LISTS = 32, BRICK_WORDS = 16 + BRICKS + DIVIDED * OLX_BRICK_CELL_WORDS + 4 * LISTS };

static void add_bricks(olx_field *field, uint32_t words[BRICK_WORDS]) {
  const olx_bricks_header header = {
      .origin = {-0.1f, -0.1f, -0.1f}, .cell_metres = 0.52f, .size = {2, 2, 3}, .divided = DIVIDED, .lists = LISTS};
  memcpy(words, &header, sizeof header);
  uint32_t *word = words + 16;
  for (uint32_t i = 0; i < BRICKS; i++) *word++ = i % 2 ? OLX_BRICK_DIVIDED | i / 2 : olx_hash(i) % LISTS;
  for (uint32_t i = 0; i < DIVIDED * OLX_BRICK_CELL_WORDS; i++) {
    *word++ = olx_hash2(i, 1) % LISTS | (olx_hash2(i, 2) % LISTS) << 16;
  }
  for (uint32_t i = 0; i < LISTS; i++) { // a rotation of the probes, some of them
    const uint32_t count = field->info.probe_count < 8 ? field->info.probe_count : 8, length = olx_hash2(i, 3) % (count + 1);
    for (uint32_t k = 0; k < 4; k++, word++) {
      const uint32_t low = 2 * k < length ? (2 * k + i) % count : OLX_BRICK_NO_PROBE,
                     high = 2 * k + 1 < length ? (2 * k + 1 + i) % count : OLX_BRICK_NO_PROBE;
      *word = low | high << 16;
    }
  }
  field->select_data[OLX_SELECT_BRICKS] = words;
  field->select_bytes[OLX_SELECT_BRICKS] = BRICK_WORDS * sizeof words[0];
  field->info.select_mask |= 1u << OLX_SELECT_BRICKS;
  if (olx_bricks_open(words, BRICK_WORDS * sizeof words[0], field->info.probe_count, "bricks", &field->bricks) != OLX_OK) {
    fail_msg("%s", olx_last_error());
  }
}

// The maps and the tree as the baker makes them, in memory that is the caller's to release.
static void *add_voronoi(olx_field *field) {
  const olx_selector_input input = {.positions = field->probe_positions,
                                    .flags = field->probe_flags,
                                    .count = field->info.probe_count,
                                    .radiance_size = field->n,
                                    .distance_scale = field->distance_scale,
                                    .threads = 1};
  void *data = NULL;
  const olx_result built = olx_voronoi_build(&input, &data, &field->select_bytes[OLX_SELECT_VORONOI]);
  if (built != OLX_OK) fail_msg("%s", olx_last_error());
  field->select_data[OLX_SELECT_VORONOI] = data;
  field->info.select_mask |= 1u << OLX_SELECT_VORONOI;
  return data;
}

static olx_field *make_field(const parity_field *p) {
  olx_field *field = analytic_field_make(&p->scene, &p->grid, p->n, p->irradiance_n);
  uint16_t *distance = (uint16_t *)(uintptr_t)field->distance;
  for (size_t i = 0; i < field->texels * field->info.probe_count; i += 7) distance[i] |= 0x8000u; // emitters
  uint8_t *flags = (uint8_t *)(uintptr_t)field->probe_flags;
  for (uint32_t i = 0; i < field->info.probe_count; i += 5) flags[i] = OLX_PROBE_BURIED;
  return field;
}

// Random items, and among them directions along axes and in coordinate planes, points on walls, and numbers at their ends.
static void fill_items(parity_item *items) {
  for (uint32_t i = 0; i < PARITY_ITEMS; i++) {
    parity_item *item = &items[i];
    for (uint32_t k = 0; k < 4; k++) item->u[k] = olx_hash3(i, k, 99);
    const olx_vec2 p = olx_stratified2(i, 1), q = olx_stratified2(i, 2);
    olx_vec3 point = olx_v3(0.02f + 3.96f * p.x, 0.02f + 2.96f * p.y, 0.02f + 4.96f * q.x);
    olx_vec3 direction = olx_sample_sphere(olx_stratified2(i, 3));
    if (i % 16 == 3) direction = olx_v3(0.0f, i & 32 ? -1.0f : 1.0f, 0.0f);
    if (i % 16 == 5) direction = olx_v3(i & 32 ? 0.6f : -1.0f, 0.0f, i & 32 ? 0.8f : 0.0f);
    if (i % 16 == 7) point.y = 0.0f;
    if (i % 64 == 9) point = olx_madd(point, direction, 3.0f);
    const olx_vec3 view = olx_from_basis(olx_sample_cosine(olx_stratified2(i, 4)), direction);
    const olx_vec2 a = olx_stratified2(i, 5), b = olx_stratified2(i, 6), c = olx_stratified2(i, 7);
    const float values[16] = {point.x, point.y, point.z, direction.x, direction.y, direction.z, view.x, view.y, view.z,
                              a.x, a.y, b.x, b.y, 0.3f * q.y, i % 4 ? INFINITY : 0.5f + 4.0f * c.x, 0.1f + 3.0f * c.y};
    memcpy(item->v, values, sizeof values);
    if (i % 64 == 11) item->v[9] = item->v[10] = 0.0f;
    if (i % 64 == 13) item->v[11] = 0.01f; // a mirror
  }
}

typedef struct harness {
  vulkan_device device;
  const char *problem; // why there is no device
  shared_buffer items, results;
  VkDescriptorSetLayout set_layout;
  VkDescriptorPool pool;
  VkDescriptorSet set;
  VkShaderModule module;
  VkPipelineLayout layout;
  VkPipeline pipelines[PARITY_GROUPS];
} harness;

static harness gpu;

static void make_set(void) {
  vulkan_device *d = &gpu.device;
  VkDescriptorSetLayoutBinding bindings[2];
  for (uint32_t i = 0; i < 2; i++) {
    bindings[i] = (VkDescriptorSetLayoutBinding){.binding = i,
                                                 .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                                 .descriptorCount = 1,
                                                 .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
  }
  const VkDescriptorSetLayoutCreateInfo layout = {
      .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 2, .pBindings = bindings};
  assert_int_equal(d->CreateDescriptorSetLayout(d->host.device, &layout, NULL, &gpu.set_layout), VK_SUCCESS);
  const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2};
  const VkDescriptorPoolCreateInfo pool = {
      .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 1, .pPoolSizes = &size};
  assert_int_equal(d->CreateDescriptorPool(d->host.device, &pool, NULL, &gpu.pool), VK_SUCCESS);
  const VkDescriptorSetAllocateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = gpu.pool,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &gpu.set_layout};
  assert_int_equal(d->AllocateDescriptorSets(d->host.device, &set, &gpu.set), VK_SUCCESS);
  const VkDescriptorBufferInfo buffers[2] = {{gpu.items.buffer, 0, VK_WHOLE_SIZE}, {gpu.results.buffer, 0, VK_WHOLE_SIZE}};
  for (uint32_t i = 0; i < 2; i++) {
    const VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                        .dstSet = gpu.set,
                                        .dstBinding = i,
                                        .descriptorCount = 1,
                                        .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                        .pBufferInfo = &buffers[i]};
    d->UpdateDescriptorSets(d->host.device, 1, &write, 0, NULL);
  }
}

static int open_harness(void **unused) {
  (void)unused;
  vulkan_device *d = &gpu.device;
  pin_drivers();
  gpu.problem = vulkan_device_open(d, false);
  if (gpu.problem) return 0;
  const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  assert_int_equal(shared_buffer_create(d, sizeof(parity_item) * PARITY_ITEMS, usage, &gpu.items), VK_SUCCESS);
  assert_int_equal(shared_buffer_create(d, 4u * PARITY_RESULTS * PARITY_ITEMS, usage, &gpu.results), VK_SUCCESS);
  fill_items(gpu.items.mapped);
  make_set();
  const VkShaderModuleCreateInfo module = {
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = sizeof SPIRV, .pCode = SPIRV};
  assert_int_equal(d->CreateShaderModule(d->host.device, &module, NULL, &gpu.module), VK_SUCCESS);
  return 0;
}

static int close_harness(void **unused) {
  (void)unused;
  vulkan_device *d = &gpu.device;
  if (gpu.problem) return 0;
  for (uint32_t i = 0; i < PARITY_GROUPS; i++) d->DestroyPipeline(d->host.device, gpu.pipelines[i], NULL);
  d->DestroyPipelineLayout(d->host.device, gpu.layout, NULL);
  d->DestroyShaderModule(d->host.device, gpu.module, NULL);
  d->DestroyDescriptorPool(d->host.device, gpu.pool, NULL);
  d->DestroyDescriptorSetLayout(d->host.device, gpu.set_layout, NULL);
  shared_buffer_destroy(d, &gpu.items);
  shared_buffer_destroy(d, &gpu.results);
  vulkan_device_close(d);
  return 0;
}

// One pipeline for each group of rows; good for every field, since all their set layouts are alike.
static void make_pipelines(const olx_vulkan_field *field) {
  vulkan_device *d = &gpu.device;
  if (gpu.layout) return;
  const VkDescriptorSetLayout sets[] = {olx_vulkan_field_set_layout(field), gpu.set_layout};
  const VkPushConstantRange range = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(uint32_t)};
  const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                             .setLayoutCount = 2,
                                             .pSetLayouts = sets,
                                             .pushConstantRangeCount = 1,
                                             .pPushConstantRanges = &range};
  assert_int_equal(d->CreatePipelineLayout(d->host.device, &layout, NULL, &gpu.layout), VK_SUCCESS);
  for (uint32_t group = 0; group < PARITY_GROUPS; group++) {
    const VkSpecializationMapEntry entry = {0, 0, sizeof group};
    const VkSpecializationInfo constants = {1, &entry, sizeof group, &group};
    const VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = gpu.module,
                  .pName = "main",
                  .pSpecializationInfo = &constants},
        .layout = gpu.layout,
    };
    assert_int_equal(d->CreateComputePipelines(d->host.device, VK_NULL_HANDLE, 1, &info, NULL, &gpu.pipelines[group]),
                     VK_SUCCESS);
  }
}

enum { CORE_GROUP = 1, FIELD_GROUP = 2, MARCH_GROUP = 4, SEARCH_GROUP = 8, SHADE_GROUP = 16, ALL_GROUPS = 63 };

static uint32_t group_of(uint32_t row) {
  const uint32_t ends[PARITY_GROUPS] = {ROWS_OF_CORE,   ROWS_OF_FIELD, ROWS_OF_MARCH,
                                        ROWS_OF_SEARCH, ROWS_OF_SHADE, ROWS_OF_DENOISE};
  uint32_t group = 0;
  while (row >= ends[group]) group++;
  return group;
}

// Run one row of parity.comp over all items.
static void run_row(const olx_vulkan_field *field, uint32_t row) {
  vulkan_device *d = &gpu.device;
  const VkDescriptorSet sets[] = {olx_vulkan_field_set(field), gpu.set};
  assert_int_equal(device_commands_begin(d), VK_SUCCESS);
  d->CmdBindPipeline(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, gpu.pipelines[group_of(row)]);
  d->CmdBindDescriptorSets(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, gpu.layout, 0, 2, sets, 0, NULL);
  d->CmdPushConstants(d->commands, gpu.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof row, &row);
  d->CmdDispatch(d->commands, PARITY_ITEMS / 64, 1, 1);
  device_barrier(d, NULL, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_UNDEFINED);
  assert_int_equal(device_commands_run(d), VK_SUCCESS);
}

static float difference(uint32_t a_bits, uint32_t b_bits) {
  const float a = olx_bits_float(a_bits), b = olx_bits_float(b_bits);
  if (a == b || (isnan(a) && isnan(b))) return 0.0f;
  const float d = fabsf(a - b) / olx_max(fabsf(b), 1.0f);
  return d < INFINITY ? d : INFINITY;
}

// Compare a row's results; true when it keeps what it promises.
static bool judge_row(const olx_field *field, const olx_vulkan_field *uploaded, const parity_row *row) {
  uint32_t bad = 0, first = 0;
  float worst = 0.0f;
  for (uint32_t i = 0; i < PARITY_ITEMS; i++) {
    state s = {.field = field,
               .constants = &uploaded->constants,
               .item = (const parity_item *)gpu.items.mapped + i,
               .index = i};
    derive(&s);
    if (row->number >= ROWS_OF_FIELD && row->number < ROWS_OF_MARCH) derive_march(&s);
    if (row->number >= ROWS_OF_MARCH && row->number < ROWS_OF_SEARCH) derive_search(&s);
    if (row->number >= ROWS_OF_SHADE) derive_denoise(&s);
    result r = {.count = 0};
    row->evaluate(&s, &r);
    const uint32_t *words = (const uint32_t *)gpu.results.mapped + (size_t)PARITY_RESULTS * i;
    float largest = 0.0f;
    for (uint32_t k = 0; k < r.count; k++) {
      const float d = r.is_float[k] ? difference(words[k], r.word[k]) : words[k] == r.word[k] ? 0.0f : INFINITY;
      largest = olx_max(largest, d);
    }
    if (largest <= row->bound) worst = olx_max(worst, largest);
    else if (bad++ == 0) first = i;
  }
  const double share = (double)bad / PARITY_ITEMS;
  print_message("  %-28s off by %.2g at most, %.4f %% apart\n", row->name, (double)worst, 100.0 * share);
  if (share <= row->allowed) return true;
  print_error("%s: %u of %d items differ by more than %g, item %u first\n", row->name, bad, PARITY_ITEMS,
              (double)row->bound, first);
  return false;
}

// The rows of some groups, a bit each.
static void compare(const parity_field *p, uint32_t groups) {
  if (gpu.problem) {
    print_message("skipped: %s\n", gpu.problem);
    skip();
  }
  vulkan_device *d = &gpu.device;
  olx_field *field = make_field(p);
  _Alignas(64) uint32_t bricks[BRICK_WORDS];
  if (p->bricks) add_bricks(field, bricks);
  void *voronoi = p->voronoi ? add_voronoi(field) : NULL;
  olx_vulkan_field *uploaded = NULL;
  if (olx_vulkan_field_create(&d->host, field, &uploaded) != OLX_OK) fail_msg("%s", olx_last_error());
  make_pipelines(uploaded);
  print_message("%s on %s\n", p->name, d->name);
  uint32_t failures = 0;
  for (uint32_t i = 0; i < ROW_COUNT; i++) {
    if (!(groups >> group_of(ROWS[i].number) & 1u)) continue;
    if (ROWS[i].number == ROW_olx_glossy && !(groups & SEARCH_GROUP)) continue;
    run_row(uploaded, ROWS[i].number);
    failures += !judge_row(field, uploaded, &ROWS[i]);
  }
  olx_vulkan_field_destroy(uploaded);
  analytic_field_free(field);
  olx_release(voronoi);
  assert_int_equal(failures, 0);
}

static void in_a_furnished_room(void **unused) {
  (void)unused;
  const parity_field p = {"furnished room, 2 x 2 x 2 probes, 64 texels", {.room = ROOM, .box_count = 2, .boxes = FURNITURE},
                          {{0.5f, 0.5f, 0.5f}, {3.0f, 2.0f, 4.0f}, {2, 2, 2}}, 64, 16, true, true};
  compare(&p, ALL_GROUPS);
}

static void in_an_open_court(void **unused) {
  (void)unused;
  const parity_field p = {"open court, 3 x 1 x 2 probes, 32 texels",
                          {.room = ROOM, .open = true, .box_count = 2, .boxes = FURNITURE},
                          {{0.5f, 1.2f, 0.5f}, {1.5f, 0.0f, 4.0f}, {3, 1, 2}}, 32, 8, true, false};
  compare(&p, FIELD_GROUP | MARCH_GROUP | SEARCH_GROUP | SHADE_GROUP);
}

static void where_maps_share_layers(void **unused) {
  (void)unused;
  const parity_field p = {"many probes, 8 texels", {.room = ROOM, .box_count = 2, .boxes = FURNITURE},
                          {{0.1f, 0.1f, 0.1f}, {0.3f, 0.23f, 0.38f}, {13, 13, 13}}, 8, 8, false, true};
  // llvmpipe ends loops after 65535 turns, which a search over so many probes can exceed.
  compare(&p, FIELD_GROUP | MARCH_GROUP | SHADE_GROUP);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(in_a_furnished_room),
      cmocka_unit_test(in_an_open_court),
      cmocka_unit_test(where_maps_share_layers),
  };
  return cmocka_run_group_tests(tests, open_harness, close_harness);
}
